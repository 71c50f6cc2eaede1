//! [`SimulationControl`]: commands to a running simulation, and their results.

use std::time::{Duration, Instant};

use crate::{
    Error, Node, Publisher, StreamSpec, Subscriber, clock,
    payload::{SimulationCommand, SimulationResult},
};

/// Time between two looks whether the simulator is still there while its result is waited for.
const PATIENCE: Duration = Duration::from_millis(100);

/// The commanding end of a simulation: sends a command and waits for its result.
///
/// ```no_run
/// use belvedere_bridge::{Domain, Node, Operation, SimulationControl, payload::SimulationCommand};
/// use std::time::Duration;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let node = Node::open(&Domain::default(), "my-script")?;
/// let mut control = SimulationControl::open(&node)?;
/// let pause = SimulationCommand::new(Operation::Pause);
/// match control.call(&pause, "", Duration::from_secs(5))? {
///     Some(result) if result.done == 1 => println!("paused at {} ns", result.time_ns),
///     Some(result) => println!("refused: {}", result.reason),
///     None => println!("no simulator answers"),
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct SimulationControl {
    node: Node,
    results: Subscriber,
    answered_ns: u64,
    /// The sending end, and the longest text that it can send.
    sender: Option<(Publisher, usize)>,
}

impl SimulationControl {
    /// Gets ready to control the simulation of a domain, whether it runs already or not.
    ///
    /// # Errors
    /// [`Error::TooManySubscribers`] and others of [`Subscriber::take`].
    pub fn open(node: &Node) -> Result<Self, Error> {
        let mut results = node.subscriber(StreamSpec::SIMULATION_RESULT)?;
        results.take()?;
        Ok(Self { node: node.clone(), results, answered_ns: 0, sender: None })
    }

    /// Whether there is a simulator that listens now; never sleeps.
    ///
    /// # Errors
    /// As [`Subscriber::take`].
    pub fn is_connected(&mut self) -> Result<bool, Error> {
        // One that has ended is let go by the first look, and its successor found by the second.
        for _ in 0..2 {
            // What comes now answers nobody who waits.
            while self.results.take()?.is_some() {}
            if self.results.publishers() > 0 {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// When the last result was sent, on the clock of [`FrameHeader::publish_mono_ns`](crate::FrameHeader); 0 before the
    /// first. What was sent later shows what the command has changed.
    #[must_use]
    pub fn answered_ns(&self) -> u64 {
        self.answered_ns
    }

    /// Sends a command, with a text if its operation has one, and waits for its result; `None` when there was no
    /// simulator, or no result, within `timeout`, or the simulator has ended meanwhile. Its `text_len` is set here.
    ///
    /// # Errors
    /// When the streams cannot be opened, or there is no memory for the text.
    pub fn call(
        &mut self,
        command: &SimulationCommand,
        text: &str,
        timeout: Duration,
    ) -> Result<Option<SimulationResult>, Error> {
        self.call_while(command, text, timeout, || true)
    }

    /// Does the same as [`call`](Self::call), and stops waiting, with `None`, as soon as `go_on` returns false. It is called
    /// at least every 100 ms, so that a program that has to end need not wait for a simulator that does not answer.
    ///
    /// # Errors
    /// As [`call`](Self::call).
    pub fn call_while(
        &mut self,
        command: &SimulationCommand,
        text: &str,
        timeout: Duration,
        mut go_on: impl FnMut() -> bool,
    ) -> Result<Option<SimulationResult>, Error> {
        let deadline = clock::deadline(timeout);
        // Without a simulator a sender would make the stream, and talk to itself. Old results are cleared away.
        while !self.is_connected()? {
            if Instant::now() >= deadline || !go_on() {
                return Ok(None);
            }
            self.results.wait(Duration::from_millis(5))?;
        }
        let mut command = *command;
        command.text_len = u32::try_from(text.len()).unwrap_or(u32::MAX);
        self.send(&command, text)?;
        loop {
            while let Some(frame) = self.results.take()? {
                match frame.message::<SimulationResult>() {
                    Ok(result) if result.id == command.id => {
                        self.answered_ns = frame.header().publish_mono_ns;
                        return Ok(Some(result));
                    }
                    _ => {}
                }
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() || self.results.publishers() == 0 || !go_on() {
                return Ok(None);
            }
            self.results.wait(left.min(PATIENCE))?;
        }
    }

    fn send(&mut self, command: &SimulationCommand, text: &str) -> Result<(), Error> {
        let sender = match self.sender.take() {
            Some((sender, longest)) if longest >= text.len() => (sender, longest),
            // Closed before the new one is opened: places for senders are few.
            other => {
                drop(other);
                (self.node.publisher(&StreamSpec::simulation_command(text.len()))?, text.len())
            }
        };
        let (sender, _) = self.sender.insert(sender);
        let bytes = bytemuck::bytes_of(command);
        let mut frame = sender.loan(bytes.len() + text.len())?;
        let (head, tail) = frame.payload_mut().split_at_mut(bytes.len());
        head.copy_from_slice(bytes);
        tail.copy_from_slice(text.as_bytes());
        let header = frame.header_mut();
        (header.width, header.height) = (1, 1);
        header.elem_stride = bytes.len() as u32;
        header.row_stride = header.elem_stride;
        frame.send()?;
        Ok(())
    }
}
