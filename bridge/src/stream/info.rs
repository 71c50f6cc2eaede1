//! [`StreamInfo`]: a description of each stream of a domain.

use super::{
    Frames,
    attributes::{ENCODING, FRAME_ID, KIND, LAYERS, RATE, attribute},
    opening::{Opened, open},
};
use crate::{
    Encoding, Error, Kind, Node,
    domain::{Ipc, topic_of_service},
    topic::canonical_topic,
};
use iceoryx2::{
    prelude::CallbackProgression,
    service::{
        Service as _, port_factory::PortFactory as _, static_config::messaging_pattern::MessagingPattern,
    },
};

/// An existing stream.
#[derive(Clone, Debug, PartialEq)]
pub struct StreamInfo {
    /// Its topic, without a leading slash.
    pub topic: String,
    /// The kind of its frames, if its creator declared it and this version knows it.
    pub kind: Option<Kind>,
    /// The encoding of its payload, under the same conditions.
    pub encoding: Option<Encoding>,
    /// The intended frames per second, as declared when it was created. The rate of a sensor may have changed since: see
    /// [`StreamSpec::SENSOR_SETTINGS`](crate::StreamSpec::SENSOR_SETTINGS).
    pub rate_hz: Option<f64>,
    /// Layers of a lidar, if its creator declared them.
    pub layers: Option<u32>,
    /// The coordinate frame of the data.
    pub frame_id: String,
    /// Publishers now; 0 if only subscribers keep the stream open.
    pub publishers: usize,
    /// Subscribers now.
    pub subscribers: usize,
    /// Largest payload in bytes; 0 without a publisher.
    pub max_payload_len: usize,
    /// Frames that a late subscriber receives when it connects.
    pub history: usize,
}

impl Node {
    /// Returns the streams of the domain, by topic.
    ///
    /// # Errors
    /// [`Error::Transport`] if the services cannot be listed, [`Error::TooManyProcesses`] if one of them cannot be
    /// opened, [`Error::TooManyOpenFiles`].
    pub fn streams(&self) -> Result<Vec<StreamInfo>, Error> {
        list(self)
    }

    /// Returns the stream of a topic, if it exists.
    ///
    /// # Errors
    /// [`Error::InvalidTopic`]; [`Error::Incompatible`] and [`Error::Permission`] if it cannot be opened.
    pub fn stream(&self, topic: &str) -> Result<Option<StreamInfo>, Error> {
        let topic = canonical_topic(topic)?;
        match open(self, topic)? {
            Opened::Yes(frames, _) => Ok(Some(describe(topic.to_owned(), &frames))),
            Opened::NotThere => Ok(None),
        }
    }
}

fn list(node: &Node) -> Result<Vec<StreamInfo>, Error> {
    let mut topics = Vec::new();
    Ipc::list(node.keeper().config(), |details| {
        let details = details.static_details;
        if matches!(details.messaging_pattern(), MessagingPattern::PublishSubscribe(_))
            && let Some(topic) = topic_of_service(details.name().as_str())
        {
            topics.push(topic.to_owned());
        }
        CallbackProgression::Continue
    })
    .map_err(|error| node.keeper().failed(format!("listing domain \"{}\"", node.domain()), error))?;
    topics.sort_unstable();
    let mut streams = Vec::with_capacity(topics.len());
    for topic in topics {
        match open(node, &topic) {
            Ok(Opened::Yes(frames, _)) => streams.push(describe(topic, &frames)),
            Err(error @ (Error::TooManyProcesses { .. } | Error::TooManyOpenFiles { .. })) => {
                return Err(error);
            }
            // The stream has gone since, or is not a Belvedere stream: leave it out.
            Ok(Opened::NotThere) | Err(_) => {}
        }
    }
    Ok(streams)
}

fn describe(topic: String, frames: &Frames) -> StreamInfo {
    let attributes = frames.attributes();
    let ports = frames.dynamic_config();
    let mut max_payload_len = 0;
    ports.list_publishers(|publisher| {
        max_payload_len = max_payload_len.max(publisher.max_slice_len);
        CallbackProgression::Continue
    });
    StreamInfo {
        topic,
        kind: attribute(attributes, KIND).and_then(|text| text.parse().ok()),
        encoding: attribute(attributes, ENCODING).and_then(|text| text.parse().ok()),
        rate_hz: attribute(attributes, RATE).and_then(|text| text.parse().ok()),
        layers: attribute(attributes, LAYERS).and_then(|text| text.parse().ok()),
        frame_id: attribute(attributes, FRAME_ID).unwrap_or_default(),
        publishers: ports.number_of_publishers(),
        subscribers: ports.number_of_subscribers(),
        max_payload_len,
        history: frames.static_config().history_size(),
    }
}
