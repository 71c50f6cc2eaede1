//! The service `StepSimulation`.

use super::client::Client;
use super::refusal::{Refusal, result};
use crate::ros2::cdr::Cdr;
use belvedere_bridge::payload::SimulationCommand;
use belvedere_bridge::{Operation, RosBytes};
use std::time::Duration;

/// Steps may take as long as they like. The wait ends when the simulator or this node ends.
const FOREVER: Duration = Duration::from_secs(365 * 86_400);

/// Runs physics steps, and answers when they are done.
pub(super) fn step_simulation(client: &mut Client<'_>, request: &[u8], reply: &mut RosBytes<'_>) {
    let outcome = step(client, request);
    // The streams to the simulator have few places, and steps are rare.
    client.simulator.rest();
    result(reply, outcome);
}

fn step(client: &mut Client<'_>, request: &[u8]) -> Result<(), Refusal> {
    let steps = Cdr::new(request)?.u64()?;
    let state = client.may_change()?;
    if !state.is("paused") {
        return Err(Refusal::failed("the simulation is not paused; set its state to STATE_PAUSED (2) first"));
    }
    let command = SimulationCommand { steps, ..SimulationCommand::new(Operation::Step) };
    client.command(&command, "", FOREVER)
}
