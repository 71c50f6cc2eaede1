//! [`Listing`]: the streams of the domain, which one thread looks up for all clients.

use belvedere_bridge::{Node, StreamInfo};
use serde_json::{Value, json};
use std::sync::{Arc, Mutex, PoisonError};

/// The current streams.
#[derive(Debug)]
pub(super) struct Listing {
    node: Node,
    now: Mutex<(u64, Arc<Vec<StreamInfo>>)>,
}

impl Listing {
    pub(super) fn new(node: Node) -> Self {
        Self { node, now: Mutex::default() }
    }

    /// Looks up the streams again. Subscriber counts are cleared, so that they do not count as changes.
    pub(super) fn look(&self) {
        let streams = match self.node.streams() {
            Ok(streams) => streams,
            Err(error) => {
                tracing::debug!(%error, "streams cannot be listed");
                return;
            }
        };
        let streams: Vec<_> =
            streams.into_iter().map(|stream| StreamInfo { subscribers: 0, ..stream }).collect();
        let mut now = self.now.lock().unwrap_or_else(PoisonError::into_inner);
        if *now.1 != streams {
            *now = (now.0 + 1, Arc::new(streams));
        }
    }

    /// Returns the edition, which increases with each change, and the streams.
    pub(super) fn now(&self) -> (u64, Arc<Vec<StreamInfo>>) {
        self.now.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// Converts streams to the JSON that is sent to the page.
pub(super) fn to_json(streams: &[StreamInfo]) -> Value {
    let streams = streams.iter().map(|stream| {
        json!({
            "topic": stream.topic,
            "kind": stream.kind.map(|kind| kind.to_string()),
            "encoding": stream.encoding.map(|encoding| encoding.to_string()),
            "frameId": stream.frame_id,
            "rateHz": stream.rate_hz,
            "layers": stream.layers,
            "publishers": stream.publishers,
        })
    });
    streams.collect()
}
