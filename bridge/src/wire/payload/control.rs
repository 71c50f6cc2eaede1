//! Commands to a running simulation, their results, and what stands where in it.

use bytemuck::Zeroable as _;

use super::Message;
use crate::{
    session,
    wire::{Kind, Operation, Text, layout::wire_structs},
};

wire_structs! {
    /// What a simulator is to do. A text of `text_len` bytes follows it in the payload.
    pub struct SimulationCommand, 320 bytes, of [Kind::SimulationCommand] {
        /// Chosen at random by the sender; the result names it.
        pub id: u64 = 0,
        /// An [`Operation`]'s number.
        pub operation: u16 = 8,
        /// 0.
        pub reserved: u16 = 10,
        /// Bytes of UTF-8 that follow this struct, without a NUL: the model to be spawned, the settings to
        /// be changed. 0 for other operations.
        pub text_len: u32 = 12,
        /// Steps of physics to run.
        pub steps: u64 = 16,
        /// The model that is meant; of a sensor's settings, the sensor, or a topic that it sends.
        pub name: Text<64> = 24,
        /// The frame that pose and velocity are given in: a model, `model::link`, or nothing for the world.
        pub reference: Text<64> = 88,
        /// Of the model's frame, metres.
        pub position: [f64; 3] = 152,
        /// Of the model's frame, x y z w; four zeros are no rotation.
        pub orientation: [f64; 4] = 176,
        /// Of the model's origin, along the axes of the reference, metres per second.
        pub linear: [f64; 3] = 208,
        /// About the axes of the reference, radians per second.
        pub angular: [f64; 3] = 232,
        /// Of what is spawned: it stands before its topics and frames; nothing for none.
        pub robot_namespace: Text<64> = 256,
    }

    /// What became of a [`SimulationCommand`].
    pub struct SimulationResult, 512 bytes, of [Kind::SimulationResult] {
        /// The command's.
        pub id: u64 = 0,
        /// Simulated time after it.
        pub time_ns: u64 = 8,
        /// 1 when it was done, 0 when it was refused.
        pub done: u16 = 16,
        /// The command's.
        pub operation: u16 = 18,
        /// 0.
        pub reserved: u32 = 20,
        /// Why it was refused; nothing when it was done.
        pub reason: Text<488> = 24,
    }

    /// Where a model or a link is, and how it moves.
    pub struct ModelState, 232 bytes, of [Kind::ModelStates] {
        /// The model's name; `model::link` for a link. Twice as long as other names since it is made of two.
        pub name: Text<128> = 0,
        /// In the world, metres.
        pub position: [f64; 3] = 128,
        /// In the world, x y z w.
        pub orientation: [f64; 4] = 152,
        /// Of its origin, along the world's axes, metres per second.
        pub linear: [f64; 3] = 184,
        /// About the world's axes, radians per second.
        pub angular: [f64; 3] = 208,
    }
}

impl SimulationCommand {
    /// A command with an id that no other has, all else 0.
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
