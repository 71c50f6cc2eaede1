//! [`Simulator`]: the simulator that services send commands to.

use belvedere_bridge::payload::{SimulationCommand, SimulationResult};
use belvedere_bridge::{Error, Node, SimulationControl};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Longest wait for a simulator to appear: its streams are found a moment after it has started.
const GRACE: Duration = Duration::from_millis(300);
/// Time without a command after which the streams to the simulator, which have few places, are closed.
const QUIET: Duration = Duration::from_secs(3);

/// The simulator of a domain. It may start later, and end and start again.
pub(super) struct Simulator {
    node: Node,
    control: Option<SimulationControl>,
    used: Instant,
    /// Set if the node ends, so that it need not wait for an answer.
    stop: Arc<AtomicBool>,
}

impl Simulator {
    pub(super) fn new(node: &Node, stop: &Arc<AtomicBool>) -> Self {
        Self { node: node.clone(), control: None, used: Instant::now(), stop: stop.clone() }
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
        let result = self.ask(command, text, timeout)?;
        if result.done == 1 { Ok(result) } else { Err(result.reason.as_str().to_owned()) }
    }

    /// Does the same as [`call`](Self::call), but also returns the result of a command that the simulator refuses.
    ///
    /// # Errors
    /// A sentence, if there is no result.
    pub(super) fn ask(
        &mut self,
        command: &SimulationCommand,
        text: &str,
        timeout: Duration,
    ) -> Result<SimulationResult, String> {
        let result = self.send(command, text, timeout).map_err(|error| {
            self.control = None;
            error.to_string()
        })?;
        self.used = Instant::now();
        result.ok_or_else(|| self.silence(timeout))
    }

    /// Closes the streams to the simulator if they have not been used for a while.
    pub(super) fn tend(&mut self) {
        if self.control.is_some() && self.used.elapsed() > QUIET {
            self.rest();
        }
    }

    /// Closes the streams to the simulator until they are needed again.
    pub(super) fn rest(&mut self) {
        self.control = None;
    }

    /// Returns the node in the domain of the simulator.
    pub(super) fn node(&self) -> &Node {
        &self.node
    }

    /// Returns true if the node of ROS 2 is ending, so that no answer need be waited for.
    pub(super) fn is_ending(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
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
        let deadline = Instant::now() + GRACE;
        while !control.is_connected()? {
            if Instant::now() >= deadline || self.stop.load(Ordering::Relaxed) {
                return Ok(None);
            }
            std::thread::sleep(Duration::from_millis(10));
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
