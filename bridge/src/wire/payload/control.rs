//! Commands to a running simulation, their results, and what stands where in it.

use std::mem::{offset_of, size_of};

use bytemuck::{Pod, Zeroable};

use super::Message;
use crate::{
    session,
    wire::{Kind, Operation, Text},
};

/// What a simulator is to do. A text of `text_len` bytes follows it in the payload.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct SimulationCommand {
    /// Chosen at random by the sender; the result names it.
    pub id: u64,
    /// An [`Operation`]'s number.
    pub operation: u16,
    /// 0.
    pub reserved: u16,
    /// Bytes of UTF-8 that follow this struct, without a NUL: the model to be spawned, the settings to
    /// be changed. 0 for other operations.
    pub text_len: u32,
    /// Steps of physics to run.
    pub steps: u64,
    /// The model that is meant; of a sensor's settings, the sensor, or a topic that it sends.
    pub name: Text<64>,
    /// The frame that pose and velocity are given in: a model, `model::link`, or nothing for the world.
    pub reference: Text<64>,
    /// Of the model's frame, metres.
    pub position: [f64; 3],
    /// Of the model's frame, x y z w; four zeros are no rotation.
    pub orientation: [f64; 4],
    /// Of the model's origin, along the axes of the reference, metres per second.
    pub linear: [f64; 3],
    /// About the axes of the reference, radians per second.
    pub angular: [f64; 3],
    /// Of what is spawned: it stands before its topics and frames; nothing for none.
    pub robot_namespace: Text<64>,
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

/// What became of a [`SimulationCommand`].
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct SimulationResult {
    /// The command's.
    pub id: u64,
    /// Simulated time after it.
    pub time_ns: u64,
    /// 1 when it was done, 0 when it was refused.
    pub done: u16,
    /// The command's.
    pub operation: u16,
    /// 0.
    pub reserved: u32,
    /// Why it was refused; nothing when it was done.
    pub reason: Text<488>,
}

/// Where a model or a link is, and how it moves.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct ModelState {
    /// The model's name; `model::link` for a link. Twice as long as other names since it is made of two.
    pub name: Text<128>,
    /// In the world, metres.
    pub position: [f64; 3],
    /// In the world, x y z w.
    pub orientation: [f64; 4],
    /// Of its origin, along the world's axes, metres per second.
    pub linear: [f64; 3],
    /// About the world's axes, radians per second.
    pub angular: [f64; 3],
}

impl Message for SimulationCommand {
    const KINDS: &'static [Kind] = &[Kind::SimulationCommand];
}
impl Message for SimulationResult {
    const KINDS: &'static [Kind] = &[Kind::SimulationResult];
}
impl Message for ModelState {
    const KINDS: &'static [Kind] = &[Kind::ModelStates];
}

// The wire format, as in `payload.rs`.
const _: () = {
    assert!(size_of::<SimulationCommand>() == 320);
    assert!(offset_of!(SimulationCommand, id) == 0);
    assert!(offset_of!(SimulationCommand, operation) == 8);
    assert!(offset_of!(SimulationCommand, reserved) == 10);
    assert!(offset_of!(SimulationCommand, text_len) == 12);
    assert!(offset_of!(SimulationCommand, steps) == 16);
    assert!(offset_of!(SimulationCommand, name) == 24);
    assert!(offset_of!(SimulationCommand, reference) == 88);
    assert!(offset_of!(SimulationCommand, position) == 152);
    assert!(offset_of!(SimulationCommand, orientation) == 176);
    assert!(offset_of!(SimulationCommand, linear) == 208);
    assert!(offset_of!(SimulationCommand, angular) == 232);
    assert!(offset_of!(SimulationCommand, robot_namespace) == 256);

    assert!(size_of::<SimulationResult>() == 512);
    assert!(offset_of!(SimulationResult, id) == 0);
    assert!(offset_of!(SimulationResult, time_ns) == 8);
    assert!(offset_of!(SimulationResult, done) == 16);
    assert!(offset_of!(SimulationResult, operation) == 18);
    assert!(offset_of!(SimulationResult, reserved) == 20);
    assert!(offset_of!(SimulationResult, reason) == 24);

    assert!(size_of::<ModelState>() == 232);
    assert!(offset_of!(ModelState, name) == 0);
    assert!(offset_of!(ModelState, position) == 128);
    assert!(offset_of!(ModelState, orientation) == 152);
    assert!(offset_of!(ModelState, linear) == 184);
    assert!(offset_of!(ModelState, angular) == 208);
};
