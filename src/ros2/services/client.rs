//! [`Client`]: what services ask the simulator, and which commands they may send it.

use super::refusal::Refusal;
use super::simulator::Simulator;
use belvedere_bridge::payload::{ModelState, SimulationCommand};
use belvedere_bridge::{Operation, StreamSpec, Text};
use std::time::{Duration, Instant};

/// Longest wait for an answer between two frames. A frame that takes seconds to render delays it.
pub(super) const PATIENCE: Duration = Duration::from_secs(10);
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

    /// Returns the number of the model's category in `simulation_interfaces/msg/EntityCategory`.
    pub(super) fn category(&self) -> u8 {
        let numbers = [("robot", 1), ("actor", 4), ("static", 5)];
        numbers.iter().find(|(word, _)| self.is(word)).map_or(0, |(_, number)| *number)
    }
}

/// The states of all models at one time.
pub(super) struct States {
    pub(super) stamp_ns: u64,
    pub(super) models: Vec<ModelState>,
}

/// What requests of a service may do with the simulator.
pub(super) struct Client<'a> {
    pub(super) simulator: &'a mut Simulator,
    /// True if nothing may be changed.
    pub(super) no_commands: bool,
    /// True if a client has set the state "paused" while the simulation stood at its start, where it is otherwise
    /// called "stopped".
    pub(super) is_paused_at_start: &'a mut bool,
}

impl Client<'_> {
    /// Returns true if no request may change the simulation.
    pub(super) fn only_reads(&self) -> bool {
        self.no_commands
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
            return Err(Refusal::unsupported(
                "this is a replay, which can only be paused, resumed and stepped",
            ));
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
        let answer = self.simulator.ask(&query, "", PATIENCE).map_err(Refusal::failed)?;
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
        self.simulator.call(command, text, patience).map(drop).map_err(Refusal::failed)
    }

    /// Returns the states of all models now.
    pub(super) fn states(&mut self) -> Result<States, Refusal> {
        let topic = StreamSpec::MODEL_STATES;
        let is_published =
            |stream: &belvedere_bridge::StreamInfo| stream.topic == topic && stream.publishers > 0;
        if !self.simulator.node().streams()?.iter().any(is_published) {
            // The reason why: no simulator, or a replay without this stream.
            self.describe("")?;
            return Err(Refusal::unsupported(format!(
                "there is no stream {topic} here: the recording lacks it"
            )));
        }
        let mut subscriber = self.simulator.node().subscriber(topic)?;
        let deadline = Instant::now() + PATIENCE;
        while !self.simulator.is_ending() && Instant::now() < deadline {
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
