//! [`StreamInfo`]: the streams of a domain.

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

/// A stream that exists.
#[derive(Clone, Debug, PartialEq)]
pub struct StreamInfo {
    /// Its topic, without a leading slash.
    pub topic: String,
    /// What it carries, if its maker said so and this version knows it.
    pub kind: Option<Kind>,
    /// How it is coded, likewise.
    pub encoding: Option<Encoding>,
    /// Frames per second that were intended when it was made; the rate of a sensor may have been changed since, see
    /// [`StreamSpec::SENSOR_SETTINGS`](crate::StreamSpec::SENSOR_SETTINGS).
    pub rate_hz: Option<f64>,
    /// Layers of a lidar, if its maker said so.
    pub layers: Option<u32>,
    /// The frame that the data are given in.
    pub frame_id: String,
    /// Publishers now: 0 when only subscribers are left of it.
    pub publishers: usize,
    /// Subscribers now.
    pub subscribers: usize,
    /// Largest payload in bytes; 0 without a publisher.
    pub max_payload_len: usize,
    /// Frames that a late subscriber is given at first.
    pub history: usize,
}

impl Node {
    /// What is published in the domain, by topic.
    ///
    /// # Errors
    /// [`Error::Transport`] when the services cannot be listed, [`Error::TooManyProcesses`] when one of them cannot be
    /// looked at, [`Error::TooManyOpenFiles`].
    pub fn streams(&self) -> Result<Vec<StreamInfo>, Error> {
        list(self)
    }

    /// The stream of a topic, if it exists.
    ///
    /// # Errors
    /// [`Error::InvalidTopic`]; [`Error::Incompatible`] and [`Error::Permission`] when it cannot be opened.
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
            // Gone since, or somebody else's: not to be listed.
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
