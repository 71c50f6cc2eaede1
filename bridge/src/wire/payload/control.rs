//! Commands to a running simulation, their results, and the states of its models.

use bytemuck::Zeroable as _;

use super::{Message, each};
use crate::{
    session,
    wire::{
        Kind, Operation, Text,
        fields::{Describe, Fields, RosType, Value},
        layout::wire_structs,
    },
};

/// The two types differ only in their names.
const STATES_MD5: &str = "48c080191eb15c41858319b4d8a609c2";
const MODEL_STATES: &str = include_str!("../../../ros1/gazebo_msgs/msg/ModelStates.msg");
const LINK_STATES: &str = include_str!("../../../ros1/gazebo_msgs/msg/LinkStates.msg");

wire_structs! {
    /// A command to a simulator. A text of `text_len` bytes follows it in the payload.
    pub struct SimulationCommand, 320 bytes, of [Kind::SimulationCommand] {
        /// A random number chosen by the sender; the result repeats it.
        pub id: u64 = 0,
        /// The number of an [`Operation`].
        pub operation: u16 = 8,
        /// Reserved; 0.
        pub reserved: u16 = 10,
        /// Length of the UTF-8 text that follows this struct, without a NUL: the model to be spawned, or the settings
        /// to be changed. 0 for other operations.
        pub text_len: u32 = 12,
        /// Number of physics steps to run.
        pub steps: u64 = 16,
        /// Name of the model; for settings, name of the sensor or of a topic that it publishes.
        pub name: Text<64> = 24,
        /// The reference frame of pose and velocity: a model, `model::link`, or empty for the world.
        pub reference: Text<64> = 88,
        /// Position of the model's frame, metres.
        pub position: [f64; 3] = 152,
        /// Orientation of the model's frame, x y z w; four zeros mean no rotation.
        pub orientation: [f64; 4] = 176,
        /// Velocity of the model's origin along the axes of the reference, metres per second.
        pub linear: [f64; 3] = 208,
        /// Angular velocity about the axes of the reference, radians per second.
        pub angular: [f64; 3] = 232,
        /// Prefix of the topics and frames of a spawned robot; empty for none.
        pub robot_namespace: Text<64> = 256,
    }

    /// The result of a [`SimulationCommand`].
    pub struct SimulationResult, 512 bytes, of [Kind::SimulationResult] {
        /// The id of the command.
        pub id: u64 = 0,
        /// Simulated time after the command.
        pub time_ns: u64 = 8,
        /// 1 if the command was executed, 0 if it was refused.
        pub done: u16 = 16,
        /// The operation of the command.
        pub operation: u16 = 18,
        /// Reserved; 0.
        pub reserved: u32 = 20,
        /// The reason for a refusal, or the answer to a query; empty otherwise.
        pub reason: Text<488> = 24,
    }

    /// The pose and velocity of a model or a link.
    pub struct ModelState, 232 bytes, of [Kind::ModelStates] {
        /// The model's name, or `model::link` for a link. It is twice as long as other names, since it is made of two.
        pub name: Text<128> = 0,
        /// Position in the world, metres.
        pub position: [f64; 3] = 128,
        /// Orientation in the world, x y z w.
        pub orientation: [f64; 4] = 152,
        /// Velocity of its origin along the world's axes, metres per second.
        pub linear: [f64; 3] = 184,
        /// Angular velocity about the world's axes, radians per second.
        pub angular: [f64; 3] = 208,
    }
}

impl SimulationCommand {
    /// Creates a command with a unique id, an identity orientation, and zeros otherwise.
    #[must_use]
    pub fn new(operation: Operation) -> Self {
        Self {
            id: session::random(),
            operation: operation.to_wire(),
            orientation: [0.0, 0.0, 0.0, 1.0],
            ..Self::zeroed()
        }
    }
}

impl Describe for SimulationCommand {
    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.put("id", self.id);
        describe_operation(self.operation, fields);
        fields.put("steps", self.steps);
        fields.put("name", self.name.as_str());
        fields.put("reference_frame", self.reference.as_str());
        fields.pose("pose", self.position, self.orientation);
        fields.twist("twist", self.linear, self.angular);
        fields.put("text_len", self.text_len);
        Some(())
    }
}

impl Describe for SimulationResult {
    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.put("id", self.id);
        describe_operation(self.operation, fields);
        fields.put("done", self.done == 1);
        fields.put("reason", self.reason.as_str());
        fields.value("time", Value::Time(self.time_ns));
        Some(())
    }
}

fn describe_operation(number: u16, fields: &mut dyn Fields) {
    match Operation::from_wire(number) {
        Some(operation) => fields.put("operation", operation.as_str()),
        None => fields.put("operation", number),
    }
}

impl Describe for ModelState {
    const ROS: &'static [RosType] = &[
        RosType::in_file("gazebo_msgs/ModelStates", STATES_MD5, MODEL_STATES).of_topic("model_states"),
        RosType::in_file("gazebo_msgs/LinkStates", STATES_MD5, LINK_STATES).of_topic("link_states"),
    ];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.put("name", self.name.as_str());
        fields.pose("pose", self.position, self.orientation);
        fields.twist("twist", self.linear, self.angular);
        Some(())
    }

    fn describe_all(messages: &[Self], fields: &mut dyn Fields) -> Option<()> {
        if fields.ros().is_none() {
            return each("states", "belvedere/ModelState", messages, fields);
        }
        let names: Vec<&str> = messages.iter().map(|state| state.name.as_str()).collect();
        fields.put("name", &names[..]);
        fields.list("pose", "geometry_msgs/Pose", messages.len(), &mut |index, fields| {
            fields.point("position", messages[index].position);
            fields.quaternion("orientation", messages[index].orientation);
        });
        fields.list("twist", "geometry_msgs/Twist", messages.len(), &mut |index, fields| {
            fields.vector("linear", messages[index].linear);
            fields.vector("angular", messages[index].angular);
        });
        Some(())
    }
}
