//! The sending end of a stream that another process creates and reads.

use crate::errors::of;
use crate::failures::raised;
use crate::own::Own;
use belvedere_bridge::{Error, Kind, Node, Publisher, StreamSpec};
use pyo3::prelude::*;

#[pyclass(frozen, module = "belvedere._native")]
pub(crate) struct Sender(Own<End>);

struct End {
    node: Node,
    topic: String,
    kind: Kind,
    /// Present while the stream has a receiver.
    publisher: Option<Publisher>,
}

impl Sender {
    pub(crate) fn new(node: Node, topic: &str, kind: u16) -> PyResult<Self> {
        let kind = Kind::from_wire(kind).ok_or_else(|| of("kind", format_args!("there is none {kind}")))?;
        // Check the name now, and not at the first message.
        let topic = StreamSpec::command(topic, kind).name().map_err(raised)?.to_owned();
        Ok(Self(Own::new(End { node, topic, kind, publisher: None })))
    }
}

impl End {
    /// Opens the stream if it has a receiver, and again if the receiver was restarted, or for longer texts. A missing
    /// stream is not created: to other processes it would look as if it had a receiver.
    fn connect(&mut self, tail_len: usize) -> Result<Option<&Publisher>, Error> {
        let spec = match self.kind {
            Kind::SimulationCommand => StreamSpec::simulation_command(tail_len),
            kind => StreamSpec::command(self.topic.as_str(), kind),
        };
        if self.publisher.as_ref().is_some_and(|publisher| publisher.subscribers() == 0) {
            self.publisher = None;
            self.node.clean_up_dead();
        }
        // Close the old publisher first: the stream has few publisher slots.
        self.publisher.take_if(|publisher| publisher.max_payload_len() < spec.max_payload_len);
        if self.publisher.is_none() {
            let is_taken = self.node.stream(&self.topic)?.is_some_and(|stream| stream.subscribers > 0);
            if !is_taken {
                return Ok(None);
            }
            self.publisher = Some(self.node.publisher(&spec)?);
        }
        Ok(self.publisher.as_ref())
    }

    fn send(&mut self, command: &[u8], tail: &[u8]) -> Result<bool, Error> {
        let Some(publisher) = self.connect(tail.len())? else { return Ok(false) };
        let mut frame = publisher.loan(command.len() + tail.len())?;
        let (head, rest) = frame.payload_mut().split_at_mut(command.len());
        head.copy_from_slice(command);
        rest.copy_from_slice(tail);
        frame.header_mut().set_packed(1, 1);
        frame.send()?;
        Ok(true)
    }
}

#[pymethods]
impl Sender {
    #[getter]
    fn topic(&self, py: Python<'_>) -> PyResult<String> {
        self.0.with(py, |end| end.topic.clone())
    }

    /// Sends the bytes of a struct and of the text after it. Returns false if there is no receiver.
    fn send(&self, py: Python<'_>, command: &[u8], tail: &[u8]) -> PyResult<bool> {
        self.0.with(py, |end| end.send(command, tail))?.map_err(raised)
    }

    /// Returns true if the stream has a receiver; never sleeps.
    fn is_taken(&self, py: Python<'_>) -> PyResult<bool> {
        self.0.with(py, |end| Ok(end.connect(0)?.is_some()))?.map_err(raised)
    }

    /// Closes the stream; the next `send` opens it again.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        self.0.with(py, |end| end.publisher = None)
    }
}
