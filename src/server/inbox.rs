//! [`Inbox`]: receives commands to the simulation and sends their results.

use belvedere_bridge::payload::{SimulationCommand, SimulationResult};
use belvedere_bridge::{Error, Frame, Node, Operation, Publisher, StreamSpec, Subscriber, Text};
use std::time::Duration;

/// Longest text of a command, in bytes. Descriptions are short because meshes are separate files.
pub(crate) const MAX_TEXT_BYTES: usize = 4 << 20;

/// A command as it was received.
#[derive(Debug, Clone)]
pub(crate) struct Request {
    /// Its fixed part.
    pub(crate) command: SimulationCommand,
    /// Its text, or the reason why it cannot be read.
    pub(crate) text: Result<String, String>,
}

impl Request {
    fn of(frame: &Frame) -> Option<Self> {
        let command: SimulationCommand = match frame.message() {
            Ok(command) => command,
            Err(error) => {
                tracing::warn!(%error, "received a frame that is not a simulation command");
                return None;
            }
        };
        let len = command.text_len as usize;
        let bytes = frame.payload().get(size_of::<SimulationCommand>()..).unwrap_or_default();
        let text = if len > MAX_TEXT_BYTES {
            Err(format!("its text is {len} bytes long, the limit is {MAX_TEXT_BYTES}"))
        } else {
            match bytes.get(..len) {
                // Copied before it is checked, because the sender may still write to the shared memory.
                Some(text) => String::from_utf8(text.to_vec()).map_err(|error| {
                    format!("its text is not UTF-8 from byte {} on", error.utf8_error().valid_up_to())
                }),
                None => Err(format!("its text is cut off: {len} bytes announced, {} received", bytes.len())),
            }
        };
        Some(Self { command, text })
    }

    /// Returns the operation, if this version knows it.
    pub(crate) fn operation(&self) -> Option<Operation> {
        Operation::from_wire(self.command.operation)
    }
}

/// The receiving end of commands and the sending end of results.
#[derive(Debug)]
pub(crate) struct Inbox {
    commands: Subscriber,
    results: Publisher,
}

impl Inbox {
    /// Opens both streams.
    ///
    /// # Errors
    /// Errors of the bridge.
    pub(crate) fn open(node: &Node) -> Result<Self, Error> {
        // Commands first: a client that sees the stream of results can rely on its commands being received.
        let commands = node.command_subscriber(&StreamSpec::simulation_command(0))?;
        let results = node.publisher(&StreamSpec::simulation_result())?;
        Ok(Self { commands, results })
    }

    /// Takes the oldest waiting command. A command that cannot be read is dropped with a warning.
    pub(crate) fn take(&mut self) -> Option<Request> {
        loop {
            match self.commands.take() {
                Ok(Some(frame)) => {
                    if let Some(request) = Request::of(&frame) {
                        return Some(request);
                    }
                }
                Ok(None) => return None,
                Err(error @ Error::Frame { .. }) => {
                    tracing::warn!(%error, "a simulation command was refused");
                }
                Err(error) => {
                    tracing::warn!(%error, "simulation commands cannot be read");
                    return None;
                }
            }
        }
    }

    /// Sleeps until a command arrives, for at most this long.
    pub(crate) fn wait(&mut self, at_most: Duration) {
        if let Err(error) = self.commands.wait(at_most) {
            tracing::warn!(%error, "simulation commands cannot be read");
            std::thread::sleep(at_most);
        }
    }

    /// Sends a command's result at a simulated time.
    pub(crate) fn answer(&self, command: &SimulationCommand, time_ns: u64, outcome: &Result<(), String>) {
        self.tell(command, time_ns, outcome.as_ref().map(|()| "").map_err(String::as_str));
    }

    /// Sends the answer to a query at a simulated time.
    pub(crate) fn tell(&self, command: &SimulationCommand, time_ns: u64, outcome: Result<&str, &str>) {
        let result = SimulationResult {
            id: command.id,
            time_ns,
            done: outcome.is_ok().into(),
            operation: command.operation,
            reserved: 0,
            reason: Text::cut(match outcome {
                Ok(text) | Err(text) => text,
            }),
        };
        if let Err(error) = self.results.send_structs(time_ns, &[result]) {
            tracing::warn!(%error, "a simulation command could not be answered");
        }
    }
}
