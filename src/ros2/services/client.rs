//! [`Client`]: asks the simulator, and sends it commands.

use super::refusal::Refusal;
use belvedere_bridge::payload::{ModelState, SimulationCommand, SimulationResult};
use belvedere_bridge::{Node, Operation, SimulationControl, StreamSpec, Text};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Longest wait for an answer between two frames. A frame that takes seconds to render delays it.
pub(super) const PATIENCE: Duration = Duration::from_secs(10);
/// Longest wait for a simulator to appear: its streams are found a moment after it has started.
const GRACE: Duration = Duration::from_millis(300);
/// Interval at which a wait looks whether to stop.
const NAP: Duration = Duration::from_millis(100);

/// What a simulation says of itself, and of one model.
#[derive(Debug, Clone)]
pub(super) struct Description {
    words: String,
    /// Simulated time.
    pub(super) time_ns: u64,
}

impl Description {
    /// Returns true if the simulation says this word of itself or of the model.
    pub(super) fn is(&self, word: &str) -> bool {
        self.words.split(' ').any(|known| known == word)
    }
}

/// The states of all models at one time.
pub(super) struct States {
    pub(super) stamp_ns: u64,
    pub(super) models: Vec<ModelState>,
}

/// A client of the simulator of a domain, which may come and go.
pub(super) struct Client {
    node: Node,
    control: Option<SimulationControl>,
    stop: Arc<AtomicBool>,
    no_commands: bool,
    /// True if a client has set the state "paused" while the simulation stood at its start, where it is otherwise
    /// called "stopped".
    pub(super) is_paused_at_start: bool,
}

impl Client {
    pub(super) fn new(node: &Node, stop: &Arc<AtomicBool>, no_commands: bool) -> Self {
        Self {
            node: node.clone(),
            control: None,
            stop: stop.clone(),
            no_commands,
            is_paused_at_start: false,
        }
    }

    /// Returns true if no request may change the simulation.
    pub(super) fn only_reads(&self) -> bool {
        self.no_commands
    }

    /// Closes the streams to the simulator, which have few places, until they are needed again.
    pub(super) fn rest(&mut self) {
        self.control = None;
    }

    /// Refuses what would change the simulation if this is forbidden, or if there is no simulator that could be changed.
    pub(super) fn may_change(&mut self) -> Result<Description, Refusal> {
        if self.no_commands {
            return Err(Refusal::unsupported(
                "belvedere ros2 was started with --no-commands, so it changes nothing; start it without this option",
            ));
        }
        self.describe("")
    }

    /// Does the same as [`may_change`](Self::may_change), and refuses what a replay cannot do.
    pub(super) fn may_change_models(&mut self) -> Result<Description, Refusal> {
        let description = self.may_change()?;
        if description.is("replay") {
            return Err(Refusal::unsupported("this is a replay, which can only be paused, resumed and stepped"));
        }
        Ok(description)
    }

    /// Asks the simulator to describe itself and, unless `name` is empty, this model.
    ///
    /// # Errors
    /// "Not found" if there is no such model.
    pub(super) fn describe(&mut self, name: &str) -> Result<Description, Refusal> {
        let mut query = SimulationCommand::new(Operation::Query);
        query.name = Text::new(name).map_err(|why| Refusal::not_found(format!("'{name}': {why}")))?;
        let answer = self.send(&query, "", PATIENCE)?;
        let words = answer.reason.as_str().to_owned();
        match answer.done {
            1 => Ok(Description { words, time_ns: answer.time_ns }),
            _ if name.is_empty() => Err(Refusal::failed(words)),
            _ => Err(Refusal::not_found(words)),
        }
    }

    /// Sends a command and waits until it is done. The caller has asked before whether it may.
    pub(super) fn command(
        &mut self,
        command: &SimulationCommand,
        text: &str,
        patience: Duration,
    ) -> Result<(), Refusal> {
        let answer = self.send(command, text, patience)?;
        if answer.done == 1 { Ok(()) } else { Err(Refusal::failed(answer.reason.as_str())) }
    }

    fn send(
        &mut self,
        command: &SimulationCommand,
        text: &str,
        patience: Duration,
    ) -> Result<SimulationResult, Refusal> {
        let stop = self.stop.clone();
        let go_on = || !stop.load(Ordering::Relaxed);
        let control = match &mut self.control {
            Some(control) => control,
            none => none.insert(SimulationControl::open(&self.node)?),
        };
        let deadline = Instant::now() + GRACE;
        while !control.is_connected()? {
            if Instant::now() >= deadline || !go_on() {
                let domain = self.node.domain();
                return Err(Refusal::failed(format!(
                    "no simulator runs in the domain '{domain}'; start one with belvedere run"
                )));
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        let answer = control.call_while(command, text, patience, go_on);
        let is_there = control.is_connected();
        // A stream that has failed is opened again for the next request.
        if answer.is_err() || is_there.is_err() {
            self.control = None;
        }
        if let Some(answer) = answer? {
            return Ok(answer);
        }
        Err(Refusal::failed(if !go_on() {
            "belvedere ros2 is ending".to_owned()
        } else if is_there? {
            format!("the simulator has not answered within {} s", patience.as_secs())
        } else {
            "the simulator has ended before it answered".to_owned()
        }))
    }

    /// Returns the states of all models now.
    pub(super) fn states(&mut self) -> Result<States, Refusal> {
        let topic = StreamSpec::MODEL_STATES;
        let is_published = |stream: &belvedere_bridge::StreamInfo| stream.topic == topic && stream.publishers > 0;
        if !self.node.streams()?.iter().any(is_published) {
            // The reason why: no simulator, or a replay without this stream.
            self.describe("")?;
            return Err(Refusal::unsupported(format!("there is no stream {topic} here: the recording lacks it")));
        }
        let mut subscriber = self.node.subscriber(topic)?;
        let deadline = Instant::now() + PATIENCE;
        while !self.stop.load(Ordering::Relaxed) && Instant::now() < deadline {
            subscriber.wait(NAP)?;
            if let Some(frame) = subscriber.take_newest()? {
                let models = frame.view().structs().map(Iterator::collect);
                let models = models.map_err(|error| Refusal::failed(error.to_string()))?;
                return Ok(States { stamp_ns: frame.header().stamp_ns, models });
            }
            if subscriber.publishers() == 0 {
                return Err(Refusal::failed("the simulator has ended before it answered"));
            }
        }
        Err(Refusal::failed(format!("the simulator has sent no states within {} s", PATIENCE.as_secs())))
    }
}
