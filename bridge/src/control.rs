//! [`SimulationControl`]: commands to a running simulation, and their results.

use std::time::{Duration, Instant};

use crate::{
    Error, Node, Publisher, StreamSpec, Subscriber, clock,
    payload::{SimulationCommand, SimulationResult},
};

/// Interval at which [`SimulationControl::call`] checks that the simulator is still running while it waits for a
/// result.
const PATIENCE: Duration = Duration::from_millis(100);

/// The client side of simulation control: sends a command and waits for its result.
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
    /// The publisher of commands, and the longest text that it can send.
    sender: Option<(Publisher, usize)>,
}

impl SimulationControl {
    /// Opens the control streams of a domain. The simulator may start later.
    ///
    /// # Errors
    /// [`Error::TooManySubscribers`] and the other errors of [`Subscriber::take`].
    pub fn open(node: &Node) -> Result<Self, Error> {
        let mut results = node.subscriber(StreamSpec::SIMULATION_RESULT)?;
        results.take()?;
        Ok(Self { node: node.clone(), results, answered_ns: 0, sender: None })
    }

    /// Returns true if a simulator is listening now; never blocks.
    ///
    /// # Errors
    /// The errors of [`Subscriber::take`].
    pub fn is_connected(&mut self) -> Result<bool, Error> {
        // The first pass closes the stream of a simulator that has ended; the second finds its successor.
        for _ in 0..2 {
            // No call is waiting, so results that arrive now are stale.
            while self.results.take()?.is_some() {}
            if self.results.publishers() > 0 {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Returns when the last result was sent, on the clock of
    /// [`FrameHeader::publish_mono_ns`](crate::FrameHeader); 0 before the first result. Frames published after this time
    /// show the effect of the command.
    #[must_use]
    pub fn answered_ns(&self) -> u64 {
        self.answered_ns
    }

    /// Sends a command, with a text if its operation has one, and waits for its result. Sets the command's `text_len`.
    ///
    /// Returns `None` if no simulator or no result appears within `timeout`, or if the simulator ends meanwhile.
    ///
    /// # Errors
    /// If the streams cannot be opened, or there is no memory for the text.
    pub fn call(
        &mut self,
        command: &SimulationCommand,
        text: &str,
        timeout: Duration,
    ) -> Result<Option<SimulationResult>, Error> {
        self.call_while(command, text, timeout, || true)
    }

    /// Does the same as [`call`](Self::call), but returns `None` as soon as `go_on` returns false. `go_on` is called at
    /// least every 100 ms, so that a program can end even if the simulator does not answer.
    ///
    /// # Errors
    /// The errors of [`call`](Self::call).
    pub fn call_while(
        &mut self,
        command: &SimulationCommand,
        text: &str,
        timeout: Duration,
        mut go_on: impl FnMut() -> bool,
    ) -> Result<Option<SimulationResult>, Error> {
        let deadline = clock::deadline(timeout);
        // Without a simulator, opening a publisher would create the stream and nothing would read it. Checking the
        // connection also discards old results.
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
            // Close the old publisher first: the stream has few publisher slots.
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
