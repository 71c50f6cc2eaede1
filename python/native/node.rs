//! Membership of a domain, and its streams.

use crate::failures::raised;
use crate::own::Own;
use crate::sender::Sender;
use crate::subscriber::Subscriber;
use belvedere_bridge::{Domain, Encoding, Kind, StreamInfo};
use pyo3::prelude::*;

#[pyclass(frozen, module = "belvedere._native")]
pub(crate) struct Node(Own<belvedere_bridge::Node>);

/// A stream: topic, kind, encoding, rate, frame, layers; `None` for values that its publisher did not declare.
type Stream = (String, Option<&'static str>, Option<&'static str>, Option<f64>, Option<String>, Option<u32>);

#[pymethods]
impl Node {
    #[new]
    fn new(py: Python<'_>, domain: &str, name: &str) -> PyResult<Self> {
        let domain = Domain::new(domain).map_err(raised)?;
        let node = py.detach(|| belvedere_bridge::Node::open(&domain, name)).map_err(raised)?;
        Ok(Self(Own::new(node)))
    }

    /// Lists the streams of the domain, by topic.
    fn streams(&self, py: Python<'_>) -> PyResult<Vec<Stream>> {
        let streams = self.0.with(py, |node| node.streams())?.map_err(raised)?;
        Ok(streams.into_iter().map(described).collect())
    }

    fn subscriber(&self, py: Python<'_>, topic: &str) -> PyResult<Subscriber> {
        self.0.with(py, |node| node.subscriber(topic))?.map_err(raised).map(Subscriber::new)
    }

    /// Creates the publisher of a stream of structs, by the number of the kind.
    fn sender(&self, py: Python<'_>, topic: &str, kind: u16) -> PyResult<Sender> {
        Sender::new(self.0.with(py, |node| node.clone())?, topic, kind)
    }

    /// Removes what killed processes of the domain left.
    fn clean_up_dead(&self, py: Python<'_>) -> PyResult<()> {
        self.0.with(py, |node| node.clean_up_dead())
    }
}

fn described(stream: StreamInfo) -> Stream {
    (
        stream.topic,
        stream.kind.map(Kind::as_str),
        stream.encoding.map(Encoding::as_str),
        stream.rate_hz,
        Some(stream.frame_id).filter(|frame| !frame.is_empty()),
        stream.layers,
    )
}
