//! [`Simulator`]: the simulator that services send commands to.

use belvedere_bridge::payload::{SimulationCommand, SimulationResult};
use belvedere_bridge::{Error, Node, SimulationControl};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The simulator of a domain. It may start later, and end and start again.
pub(super) struct Simulator {
    node: Node,
    control: Option<SimulationControl>,
    /// Set if the node ends, so that it need not wait for an answer.
    stop: Arc<AtomicBool>,
}

impl Simulator {
    pub(super) fn new(node: &Node, stop: &Arc<AtomicBool>) -> Self {
        Self { node: node.clone(), control: None, stop: stop.clone() }
    }

    /// Sends a command, with a text if its operation has one, and waits for its result.
    ///
    /// # Errors
    /// The reason, in a sentence: the simulator's, or that no simulator runs, or that it does not answer in time.
    pub(super) fn call(
        &mut self,
        command: &SimulationCommand,
        text: &str,
        timeout: Duration,
    ) -> Result<SimulationResult, String> {
        let result = self.send(command, text, timeout).map_err(|error| {
            self.control = None;
            error.to_string()
        })?;
        match result {
            Some(result) if result.done == 1 => Ok(result),
            Some(result) => Err(result.reason.as_str().to_owned()),
            None => Err(self.silence(timeout)),
        }
    }

    fn send(
        &mut self,
        command: &SimulationCommand,
        text: &str,
        timeout: Duration,
    ) -> Result<Option<SimulationResult>, Error> {
        let control = match &mut self.control {
            Some(control) => control,
            none => none.insert(SimulationControl::open(&self.node)?),
        };
        if !control.is_connected()? {
            return Ok(None);
        }
        control.call_while(command, text, timeout, || !self.stop.load(Ordering::Relaxed))
    }

    /// Returns why there was no result.
    fn silence(&mut self, waited: Duration) -> String {
        let domain = self.node.domain();
        let is_there = self.control.as_mut().is_some_and(|control| control.is_connected().unwrap_or(false));
        if is_there {
            format!("the simulator in domain '{domain}' did not answer within {} s", waited.as_secs())
        } else {
            self.absence()
        }
    }

    /// Returns the sentence that no simulator is there.
    pub(super) fn absence(&self) -> String {
        format!("no simulator runs in domain '{}'; start one with belvedere run", self.node.domain())
    }
}
