//! What a Kobuki base reports and is commanded.

use super::Message;
use crate::wire::{
    Kind,
    fields::{Describe, Fields, RosType},
    layout::wire_structs,
};

const BUMPER_EVENT: &str = include_str!("../../../ros1/kobuki_msgs/msg/BumperEvent.msg");
const CLIFF_EVENT: &str = include_str!("../../../ros1/kobuki_msgs/msg/CliffEvent.msg");
const WHEEL_DROP_EVENT: &str = include_str!("../../../ros1/kobuki_msgs/msg/WheelDropEvent.msg");
const SENSOR_STATE: &str = include_str!("../../../ros1/kobuki_msgs/msg/SensorState.msg");
const MOTOR_POWER: &str = include_str!("../../../ros1/kobuki_msgs/msg/MotorPower.msg");

wire_structs! {
    /// A change of state of a base's bumper, cliff sensor or wheel (`kobuki_msgs/BumperEvent`, `CliffEvent`,
    /// `WheelDropEvent`).
    with #[derive(PartialEq, Eq)]
    pub struct RobotEvent, 16 bytes, of [Kind::RobotEvent] {
        /// [`RobotEvent::BUMPER`], [`RobotEvent::CLIFF`] or [`RobotEvent::WHEEL_DROP`].
        pub source: u32 = 0,
        /// [`RobotEvent::LEFT`], [`RobotEvent::CENTRE`] or [`RobotEvent::RIGHT`]. (`kobuki_msgs` numbers the right wheel 1.)
        pub index: u32 = 4,
        /// The new state: 0 released, floor, raised; 1 pressed, cliff, dropped.
        pub state: u32 = 8,
        /// The reading of a cliff sensor, as in [`CoreSensors::bottom`]; 0 for other sources.
        pub value: u32 = 12,
    }

    /// The state of a base's own sensors, 50 times a second (`kobuki_msgs/SensorState`). In the bits of bumper and
    /// cliff, 1 is right, 2 is centre, 4 is left; in those of the wheels, 1 is right, 2 is left.
    with #[derive(PartialEq, Eq)]
    pub struct CoreSensors, 20 bytes, of [Kind::CoreSensors] {
        /// Time in milliseconds; wraps around.
        pub time_stamp: u16 = 0,
        /// Bits of the pressed bumpers.
        pub bumper: u8 = 2,
        /// Bits of the dropped wheels.
        pub wheel_drop: u8 = 3,
        /// Bits of the cliff sensors that see no floor.
        pub cliff: u8 = 4,
        /// Bits of the pressed buttons: 1, 2, 4.
        pub buttons: u8 = 5,
        /// Ticks of the left wheel; wraps around.
        pub left_encoder: u16 = 6,
        /// Ticks of the right wheel; wraps around.
        pub right_encoder: u16 = 8,
        /// Duty cycle of the left motor; always 0, since it is not simulated.
        pub left_pwm: i8 = 10,
        /// Duty cycle of the right motor; always 0, since it is not simulated.
        pub right_pwm: i8 = 11,
        /// State of charge control: 0 discharging, 2 charged, 6 charging; plus 16 if an adapter is connected.
        pub charger: u8 = 12,
        /// Battery voltage in tenths of a volt.
        pub battery: u8 = 13,
        /// Readings of the cliff sensors' 12-bit converters: right, centre, left; smaller is farther.
        pub bottom: [u16; 3] = 14,
    }

    /// A command to restart odometry at zero from the current pose.
    with #[derive(Default, PartialEq, Eq)]
    pub struct ResetOdometry, 8 bytes, of [Kind::ResetOdometry] {
        /// Reserved; 0.
        pub reserved: u64 = 0,
    }

    /// A command to enable or disable the motors (`kobuki_msgs/MotorPower`).
    with #[derive(Default, PartialEq, Eq)]
    pub struct MotorPower, 4 bytes, of [Kind::MotorPower] {
        /// 0 off, else on.
        pub state: u32 = 0,
    }
}

impl RobotEvent {
    /// Source: a bumper.
    pub const BUMPER: u32 = 0;
    /// Source: a cliff sensor.
    pub const CLIFF: u32 = 1;
    /// Source: a wheel.
    pub const WHEEL_DROP: u32 = 2;
    /// Index: on the left.
    pub const LEFT: u32 = 0;
    /// Index: in front.
    pub const CENTRE: u32 = 1;
    /// Index: on the right.
    pub const RIGHT: u32 = 2;
}

impl RobotEvent {
    /// Returns the number in the event's message: `places` are those of left, centre and right. `None` for an event of
    /// another source, of a place where nothing is, or of an unknown state.
    fn place(&self, source: u32, places: [Option<u8>; 3]) -> Option<u8> {
        (self.source == source && self.state <= 1).then_some(())?;
        *places.get(self.index as usize)?
    }
}

impl Describe for RobotEvent {
    const ROS: &'static [RosType] = &[
        RosType::in_file("kobuki_msgs/BumperEvent", "ffe360cd50f14f9251d9844083e72ac5", BUMPER_EVENT)
            .of_topic("bumper"),
        RosType::in_file("kobuki_msgs/CliffEvent", "c5b106efbb1427a94f517c5e05f06295", CLIFF_EVENT)
            .of_topic("cliff"),
        RosType::in_file("kobuki_msgs/WheelDropEvent", "e102837d89384d67669a0df86b63f33b", WHEEL_DROP_EVENT)
            .of_topic("wheel_drop"),
    ];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        match fields.ros() {
            Some("kobuki_msgs/BumperEvent") => {
                fields.put("bumper", self.place(Self::BUMPER, [Some(0), Some(1), Some(2)])?);
                fields.put("state", self.state as u8);
            }
            Some("kobuki_msgs/CliffEvent") => {
                fields.put("sensor", self.place(Self::CLIFF, [Some(0), Some(1), Some(2)])?);
                fields.put("state", self.state as u8);
                fields.put("bottom", self.value as u16);
            }
            Some(_) => {
                fields.put("wheel", self.place(Self::WHEEL_DROP, [Some(0), None, Some(1)])?);
                fields.put("state", self.state as u8);
            }
            None => {
                // Words, since a bumper's 1 means something else than a cliff sensor's.
                let (source, states) = match self.source {
                    Self::BUMPER => ("bumper", ["released", "pressed"]),
                    Self::CLIFF => ("cliff", ["floor", "cliff"]),
                    Self::WHEEL_DROP => ("wheel_drop", ["raised", "dropped"]),
                    _ => ("unknown", ["unknown"; 2]),
                };
                let places = ["left", "centre", "right"];
                fields.put("source", source);
                fields.put("index", places.get(self.index as usize).copied().unwrap_or("unknown"));
                fields.put("state", states.get(self.state as usize).copied().unwrap_or("unknown"));
                fields.put("value", self.value);
            }
        }
        Some(())
    }
}

impl Describe for CoreSensors {
    const ROS: &'static [RosType] =
        &[RosType::in_file("kobuki_msgs/SensorState", "430a4bfd78449c8740bfef32b26613a6", SENSOR_STATE)];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.header(None);
        fields.put("time_stamp", self.time_stamp);
        fields.put("bumper", self.bumper);
        fields.put("wheel_drop", self.wheel_drop);
        fields.put("cliff", self.cliff);
        fields.put("left_encoder", self.left_encoder);
        fields.put("right_encoder", self.right_encoder);
        fields.put("left_pwm", self.left_pwm);
        fields.put("right_pwm", self.right_pwm);
        fields.put("buttons", self.buttons);
        fields.put("charger", self.charger);
        fields.put("battery", self.battery);
        fields.put("bottom", &self.bottom[..]);
        if fields.ros().is_some() {
            // Motors and inputs, which are not simulated.
            fields.put("current", &[0_u8; 2][..]);
            fields.put("over_current", 0_u8);
            fields.put("digital_input", 0_u16);
            fields.put("analog_input", &[0_u16; 4][..]);
        }
        Some(())
    }
}

impl Describe for ResetOdometry {
    const ROS: &'static [RosType] = &[RosType::new("std_msgs/Empty", "d41d8cd98f00b204e9800998ecf8427e")];

    fn describe(&self, _: &mut dyn Fields) -> Option<()> {
        Some(())
    }
}

impl Describe for MotorPower {
    const ROS: &'static [RosType] =
        &[RosType::in_file("kobuki_msgs/MotorPower", "8f77c0161e0f2021493136bb5f3f0e51", MOTOR_POWER)];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        match fields.ros() {
            Some(_) => fields.put("state", self.state as u8),
            None => fields.put("state", self.state),
        }
        Some(())
    }
}
