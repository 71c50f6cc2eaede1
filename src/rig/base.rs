//! The streams of a Kobuki's driver in addition to odometry, under the names that they have on the robot and in Gazebo:
//! inertial measurements, events, and the core sensors.

use super::channel::Channel;
use super::outlet::Outlet;
use super::{Opening, RigContext, RigError};
use crate::entities::EntityId;
use crate::robot::contact::Contact;
use crate::robot::imu::{Imu as ImuUnit, ImuReading};
use crate::robot::kobuki::Report;
use crate::robot::{Kobuki, Robot};
use belvedere_bridge::payload::{CoreSensors, Imu, RobotEvent};
use belvedere_bridge::{Kind, StreamSpec};

/// Topic of the inertial measurements.
pub const IMU_TOPIC: &str = "/mobile_base/sensors/imu_data";
/// Topic of the core sensors.
pub const CORE_TOPIC: &str = "/mobile_base/sensors/core";
/// Topic of the bumper events.
pub const BUMPER_TOPIC: &str = "/mobile_base/events/bumper";
/// Topic of the cliff events.
pub const CLIFF_TOPIC: &str = "/mobile_base/events/cliff";
/// Topic of the wheel-drop events.
pub const WHEEL_DROP_TOPIC: &str = "/mobile_base/events/wheel_drop";

/// A full battery in tenths of a volt: Kobuki's driver regards 16.5 V as full.
const BATTERY_FULL: u8 = 165;

/// The streams of the base. The base reports at this channel's rate, so no change is missed.
pub(super) struct BaseChannel {
    id: EntityId,
    imu: Outlet,
    core: Outlet,
    bumper: Outlet,
    cliff: Outlet,
    wheel_drop: Outlet,
    /// The state according to the events sent so far. It is kept after a reset, because it is the state that consumers
    /// know.
    reported: Contact,
}

impl BaseChannel {
    pub(super) fn open(opening: &Opening<'_>) -> Result<Self, RigError> {
        let rate = opening.rate.hz();
        let model = &opening.entity.model;
        let frame = &model.links[ImuUnit::mount(model)].name;
        let event = |topic| opening.open(&StreamSpec::structs(topic, Kind::RobotEvent, 1));
        Ok(Self {
            id: opening.id,
            imu: opening.open(&StreamSpec::structs(IMU_TOPIC, Kind::Imu, 1).rate_hz(rate).frame_id(frame))?,
            core: opening.open(&StreamSpec::structs(CORE_TOPIC, Kind::CoreSensors, 1).rate_hz(rate))?,
            bumper: event(BUMPER_TOPIC)?,
            cliff: event(CLIFF_TOPIC)?,
            wheel_drop: event(WHEEL_DROP_TOPIC)?,
            reported: Contact::default(),
        })
    }

    /// Sends an event for each change, and the last event to new subscribers.
    fn send_events(&mut self, stamp_ns: u64, contact: &Contact) {
        use RobotEvent as E;
        let sides = [E::LEFT, E::CENTRE, E::RIGHT];
        let event = |source, index, state: bool, value: u16| E {
            source,
            index,
            state: state.into(),
            value: value.into(),
        };
        for (side, index) in sides.into_iter().enumerate() {
            if contact.bumper[side] != self.reported.bumper[side] {
                self.bumper.send_structs(stamp_ns, &[event(E::BUMPER, index, contact.bumper[side], 0)]);
            }
            if contact.cliff[side] != self.reported.cliff[side] {
                let (state, reading) = (contact.cliff[side], contact.bottom[side]);
                self.cliff.send_structs(stamp_ns, &[event(E::CLIFF, index, state, reading)]);
            }
        }
        for (side, index) in [E::LEFT, E::RIGHT].into_iter().enumerate() {
            if contact.wheel_drop[side] != self.reported.wheel_drop[side] {
                let state = contact.wheel_drop[side];
                self.wheel_drop.send_structs(stamp_ns, &[event(E::WHEEL_DROP, index, state, 0)]);
            }
        }
        self.reported = *contact;
        for outlet in [&self.bumper, &self.cliff, &self.wheel_drop] {
            outlet.update();
        }
    }
}

impl Channel for BaseChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        vec![&self.imu, &self.core, &self.bumper, &self.cliff, &self.wheel_drop]
    }

    fn publish(&mut self, context: &mut RigContext<'_>, _frame: u64) {
        let Some(base) = context
            .entities
            .robot(self.id)
            .and_then(Robot::base)
            .and_then(|base| base.downcast_ref::<Kobuki>())
        else {
            return;
        };
        let report = base.report_at(context.stamp_ns);
        let stamp_ns = report.odometry.stamp_ns;
        self.imu.send_structs(stamp_ns, &[imu(&report.imu)]);
        self.core.send_structs(stamp_ns, &[core_sensors(report)]);
        self.send_events(stamp_ns, &report.contact);
    }
}

fn imu(reading: &ImuReading) -> Imu {
    Imu {
        orientation: reading.orientation.to_array(),
        angular_velocity: reading.angular_velocity_rad_s.to_array(),
        linear_acceleration: reading.linear_acceleration_m_s2.to_array(),
        orientation_covariance: ImuReading::TURN_COVARIANCE,
        angular_velocity_covariance: ImuReading::TURN_COVARIANCE,
        linear_acceleration_covariance: ImuReading::ACCELERATION_COVARIANCE,
    }
}

fn core_sensors(report: &Report) -> CoreSensors {
    let bits = |sides: &[bool], values: &[u8]| {
        sides.iter().zip(values).filter(|(is_set, _)| **is_set).map(|(_, value)| value).sum()
    };
    let contact = &report.contact;
    let [left, centre, right] = contact.bottom;
    CoreSensors {
        time_stamp: (report.odometry.stamp_ns / 1_000_000) as u16,
        bumper: bits(&contact.bumper, &[4, 2, 1]),
        wheel_drop: bits(&contact.wheel_drop, &[2, 1]),
        cliff: bits(&contact.cliff, &[4, 2, 1]),
        buttons: 0,
        left_encoder: report.encoders[0],
        right_encoder: report.encoders[1],
        left_pwm: 0,
        right_pwm: 0,
        charger: 0,
        battery: BATTERY_FULL,
        bottom: [right, centre, left],
    }
}
