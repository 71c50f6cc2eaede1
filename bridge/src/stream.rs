//! Streams: what one is made with, and what a domain has.

use iceoryx2::{
    port::backpressure_strategy::BackpressureStrategy,
    prelude::{AttributeSpecifier, CallbackProgression},
    service::{
        Service as _,
        attribute::{AttributeKey, AttributeSet, AttributeValue},
        builder::{
            event::{EventCreateError, EventOpenError, EventOpenOrCreateError},
            publish_subscribe::{PublishSubscribeCreateError, PublishSubscribeOpenError},
        },
        port_factory::{PortFactory as _, event, publish_subscribe},
        static_config::messaging_pattern::MessagingPattern,
    },
};
use std::time::{Duration, Instant};

use crate::{
    Encoding, Error, FrameHeader, Kind, Lossless, Node, Text,
    domain::{canonical_topic, service_name, topic_of_service},
    node::Ipc,
    versions,
};

pub(crate) type Frames = publish_subscribe::PortFactory<Ipc, [u8], FrameHeader>;
pub(crate) type Events = event::PortFactory<Ipc>;

const KIND: &str = "kind";
const ENCODING: &str = "encoding";
const RATE: &str = "rate_hz";
const FRAME_ID: &str = "frame_id";
const LAYERS: &str = "layers";

/// What a stream is made with.
///
/// Its pool of `max_subscribers · (buffer + borrowed) + history + loaned` frames must fit into what is free of
/// `/dev/shm`; what two subscribers need of it is taken at once, the rest as more come.
#[derive(Clone, Debug, PartialEq)]
pub struct StreamSpec {
    /// The ROS topic name, with or without a leading slash.
    pub topic: String,
    /// What it carries.
    pub kind: Kind,
    /// How it is coded.
    pub encoding: Encoding,
    /// The frame that the data are given in; at most 63 bytes.
    pub frame_id: String,
    /// Frames per second that are intended; `None` when they come as they come.
    pub rate_hz: Option<f64>,
    /// Layers of a lidar; `None` for what has none.
    pub layers: Option<u32>,
    /// Largest payload in bytes.
    pub max_payload_len: usize,
    /// Publishers at a time: 1 for what the robot says, more for what it is told.
    pub max_publishers: usize,
    /// Subscribers at a time.
    pub max_subscribers: usize,
    /// Frames that wait for a subscriber; the oldest gives way to a new one.
    pub buffer: usize,
    /// Frames that a subscriber may hold at a time.
    pub borrowed: usize,
    /// Frames that may be loaned and unsent at a time.
    pub loaned: usize,
    /// Frames that a late subscriber is given at first.
    pub history: usize,
    /// Whom the publisher waits for; nobody if it is `None`: who is slow loses the oldest of its waiting frames.
    pub lossless: Option<Lossless>,
}

impl StreamSpec {
    /// A stream from the robot: one publisher, 8 subscribers, buffer 2, 2 held, 2 loaned, history 1, overflow.
    #[must_use]
    pub fn new(topic: impl Into<String>, kind: Kind, encoding: Encoding, max_payload_len: usize) -> Self {
        Self {
            topic: topic.into(),
            kind,
            encoding,
            frame_id: String::new(),
            rate_hz: None,
            layers: None,
            max_payload_len,
            max_publishers: 1,
            max_subscribers: 8,
            buffer: 2,
            borrowed: 2,
            loaned: 2,
            history: 1,
            lossless: None,
        }
    }

    /// A stream of up to `max_count` structs of this kind. Its buffer is deeper than that of pictures: they are
    /// small, every one counts (transforms, odometry), and after a long picture several come at once.
    #[must_use]
    pub fn structs(topic: impl Into<String>, kind: Kind, max_count: usize) -> Self {
        let elem_size = kind.struct_size().unwrap_or(1);
        Self { buffer: 16, ..Self::new(topic, kind, Encoding::Struct, elem_size * max_count.max(1)) }
    }

    /// A stream to the robot: velocity commands from up to 8 senders, no history, a deeper buffer.
    #[must_use]
    pub fn velocity_command(topic: impl Into<String>) -> Self {
        Self::command(topic, Kind::VelocityCommand)
    }

    /// A stream to the robot of single structs of this kind, made as that of velocity commands.
    #[must_use]
    pub fn command(topic: impl Into<String>, kind: Kind) -> Self {
        Self { max_publishers: 8, history: 0, ..Self::structs(topic, kind, 1) }
    }

    /// The stream by which other processes control a simulation, of which the simulator makes the receiving end:
    /// [`SimulationCommand`](crate::payload::SimulationCommand)s from up to 8 senders, each followed by at most
    /// `text_len` bytes of text. A sender opens it for the longest text that it is going to send.
    #[must_use]
    pub fn simulation_command(text_len: usize) -> Self {
        let command = Self::structs(Self::SIMULATION_COMMAND, Kind::SimulationCommand, 1);
        let max_payload_len = command.max_payload_len + text_len;
        Self { max_publishers: 8, max_subscribers: 2, history: 0, max_payload_len, ..command }
    }

    /// The stream of the answers to it.
    #[must_use]
    pub fn simulation_result() -> Self {
        Self { history: 0, ..Self::structs(Self::SIMULATION_RESULT, Kind::SimulationResult, 1) }
    }

    /// Topic of the commands to a simulation.
    pub const SIMULATION_COMMAND: &'static str = "simulation/command";
    /// Topic of the answers to them.
    pub const SIMULATION_RESULT: &'static str = "simulation/result";
    /// Topic of the settings of sensors.
    pub const SENSOR_SETTINGS: &'static str = "simulation/sensor_settings";
    /// Topic of the poses and velocities of all models.
    pub const MODEL_STATES: &'static str = "simulation/model_states";
    /// Topic of the poses and velocities of all links.
    pub const LINK_STATES: &'static str = "simulation/link_states";

    /// The stream of the settings of this many sensors: sent at the start and after each change, and given to whoever
    /// comes later.
    #[must_use]
    pub fn sensor_settings(sensors: usize) -> Self {
        Self { buffer: 4, ..Self::structs(Self::SENSOR_SETTINGS, Kind::SensorSettings, sensors) }
    }

    /// The same with this frame.
    #[must_use]
    pub fn frame_id(mut self, frame_id: impl Into<String>) -> Self {
        self.frame_id = frame_id.into();
        self
    }

    /// The same with this intended rate.
    #[must_use]
    pub fn rate_hz(mut self, rate_hz: f64) -> Self {
        self.rate_hz = Some(rate_hz);
        self
    }

    /// The same with so many layers.
    #[must_use]
    pub fn layers(mut self, layers: u32) -> Self {
        self.layers = Some(layers);
        self
    }

    /// Bytes of shared memory that one publisher's pool takes when all of its frames have been used.
    #[must_use]
    pub fn pool_bytes(&self) -> u64 {
        // A frame's own header, iceoryx2's and alignment.
        let frame_bytes = (self.max_payload_len + size_of::<FrameHeader>() + 64).next_multiple_of(64);
        self.pool_frames() * frame_bytes as u64
    }

    /// Frames in one publisher's pool.
    pub(crate) fn pool_frames(&self) -> u64 {
        (self.max_subscribers * (self.buffer + self.borrowed) + self.history + self.loaned) as u64
    }

    /// The header that every frame of the stream begins with.
    pub(crate) fn header(&self) -> Result<FrameHeader, Error> {
        Ok(FrameHeader { frame_id: Text::new(&self.frame_id)?, ..FrameHeader::new(self.kind, self.encoding) })
    }

    pub(crate) fn backpressure(&self) -> BackpressureStrategy {
        if self.lossless.is_some() {
            BackpressureStrategy::RetryUntilDelivered
        } else {
            BackpressureStrategy::DiscardData
        }
    }

    fn attributes(&self) -> Result<AttributeSpecifier, Error> {
        let pairs = [
            Some((KIND, self.kind.to_string())),
            Some((ENCODING, self.encoding.to_string())),
            self.rate_hz.map(|rate| (RATE, rate.to_string())),
            self.layers.map(|layers| (LAYERS, layers.to_string())),
            (!self.frame_id.is_empty()).then(|| (FRAME_ID, self.frame_id.clone())),
        ];
        let mut attributes = AttributeSpecifier::new();
        for (key, value) in pairs.into_iter().flatten() {
            let failed = |error| Error::transport(format!("describing {}", self.topic), error);
            let key = AttributeKey::try_from(key).map_err(|error| failed(format!("{error:?}")))?;
            let value =
                AttributeValue::try_from(value.as_str()).map_err(|error| failed(format!("{error:?}")))?;
            attributes = attributes.define(&key, &value).map_err(|error| failed(format!("{error:?}")))?;
        }
        Ok(attributes)
    }
}

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
    /// [`StreamSpec::SENSOR_SETTINGS`].
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
}

/// How opening a stream went.
pub(crate) enum Opened {
    Yes(Frames, Events),
    /// It does not exist (any more, or not yet completely).
    NotThere,
}

/// Opens a stream that somebody else has made.
pub(crate) fn open(node: &Node, topic: &str) -> Result<Opened, Error> {
    let deadline = Instant::now() + node.patience();
    loop {
        match try_open(node, topic) {
            Err(Error::Permission { .. }) if Instant::now() < deadline => {
                std::thread::sleep(Duration::from_millis(2));
            }
            opened => return opened,
        }
    }
}

fn try_open(node: &Node, topic: &str) -> Result<Opened, Error> {
    use PublishSubscribeOpenError as E;
    let name = service_name(topic)?;
    let opened =
        node.iox().service_builder(&name).publish_subscribe::<[u8]>().user_header::<FrameHeader>().open();
    match opened {
        Ok(frames) => match events(node, topic)? {
            Some(events) => Ok(Opened::Yes(frames, events)),
            None => Ok(Opened::NotThere),
        },
        Err(E::DoesNotExist | E::IsMarkedForDestruction | E::HangsInCreation | E::Interrupt) => {
            Ok(Opened::NotThere)
        }
        Err(E::InsufficientPermissions) => Err(node.refused(&format!("opening {topic}"))),
        Err(E::ExceedsMaxNumberOfNodes) => {
            Err(Error::TooManySubscribers { topic: topic.to_owned(), max: MAX_NODES })
        }
        Err(
            error @ (E::VersionMismatch
            | E::IncompatibleTypes
            | E::ServiceInCorruptedState
            | E::IncompatibleMessagingPattern
            | E::UnableToAcquireTypeDefinition
            | E::InvalidTypeDefinition),
        ) => Err(versions::incompatible(node, topic, error)),
        Err(error) => Err(node.failed(format!("opening {topic}"), error)),
    }
}

/// Processes that may have one stream open at a time: subscribers, publishers, and those who only look.
const MAX_NODES: usize = 40;

/// Opens a stream, or makes it when it does not exist.
pub(crate) fn open_or_create(node: &Node, spec: &StreamSpec) -> Result<(Frames, Events), Error> {
    use PublishSubscribeCreateError as E;
    let topic = canonical_topic(&spec.topic)?;
    let name = service_name(topic)?;
    let deadline = Instant::now() + Duration::from_secs(3);
    loop {
        let problem = match open(node, topic) {
            Ok(Opened::Yes(frames, events)) => {
                check_against(spec, topic, node, &frames)?;
                return Ok((frames, events));
            }
            Ok(Opened::NotThere) => None,
            // Half of a killed maker's stream is there until it has been cleaned up.
            Err(error @ Error::Incompatible { .. }) => Some(error),
            Err(error) => return Err(error),
        };
        if problem.is_none() {
            let created = node
                .iox()
                .service_builder(&name)
                .publish_subscribe::<[u8]>()
                .user_header::<FrameHeader>()
                .max_publishers(spec.max_publishers)
                .max_subscribers(spec.max_subscribers)
                .max_nodes(MAX_NODES)
                .subscriber_max_buffer_size(spec.buffer)
                .subscriber_max_borrowed_samples(spec.borrowed)
                .history_size(spec.history)
                .enable_safe_overflow(spec.lossless.is_none())
                .create_with_attributes(&spec.attributes()?);
            match created {
                Ok(frames) => {
                    if let Some(events) = events(node, topic)? {
                        node.settle();
                        return Ok((frames, events));
                    }
                    if Instant::now() >= deadline {
                        let detail = "another process hangs while it makes them";
                        return Err(node.failed(format!("making the events of {topic}"), detail));
                    }
                }
                Err(E::InsufficientPermissions) => return Err(node.refused(&format!("making {topic}"))),
                // Somebody was quicker, or another is just taking it down.
                Err(
                    E::AlreadyExists
                    | E::IsBeingCreatedByAnotherInstance
                    | E::HangsInCreation
                    | E::ServiceInCorruptedState
                    | E::Interrupt,
                ) if Instant::now() < deadline => {}
                Err(error) => return Err(node.failed(format!("making {topic}"), error)),
            }
        }
        match problem {
            Some(error) if Instant::now() >= deadline => return Err(error),
            _ => {}
        }
        node.clean_up_dead();
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// The event service beside a stream; `None` when another process is just making or removing it, or was killed while
/// it did.
fn events(node: &Node, topic: &str) -> Result<Option<Events>, Error> {
    use EventCreateError as C;
    use EventOpenError as O;
    use EventOpenOrCreateError as E;
    let name = service_name(topic)?;
    let deadline = Instant::now() + node.patience().max(Duration::from_millis(50));
    loop {
        match node.iox().service_builder(&name).event().open_or_create() {
            Ok(events) => return Ok(Some(events)),
            Err(_) if Instant::now() < deadline => std::thread::sleep(Duration::from_millis(5)),
            Err(
                E::SystemInFlux
                | E::EventOpenError(
                    O::DoesNotExist
                    | O::HangsInCreation
                    | O::IsMarkedForDestruction
                    | O::ServiceInCorruptedState
                    | O::Interrupt,
                )
                | E::EventCreateError(
                    C::AlreadyExists
                    | C::IsBeingCreatedByAnotherInstance
                    | C::ServiceInCorruptedState
                    | C::Interrupt,
                ),
            ) => {
                node.clean_up_dead();
                return Ok(None);
            }
            Err(error) => return Err(node.failed(format!("opening the events of {topic}"), error)),
        }
    }
}

/// Whether a stream that others keep open since an earlier publisher can be used for `spec`.
fn check_against(spec: &StreamSpec, topic: &str, node: &Node, frames: &Frames) -> Result<(), Error> {
    let found = frames.static_config();
    let too_small = [
        ("subscribers", found.max_subscribers(), spec.max_subscribers),
        ("buffered frames", found.subscriber_max_buffer_size(), spec.buffer),
        ("held frames", found.subscriber_max_borrowed_samples(), spec.borrowed),
        ("frames of history", found.history_size(), spec.history),
    ]
    .into_iter()
    .find(|(_, found, wanted)| found < wanted);
    let incompatible = |detail| {
        Err(Error::Incompatible { topic: topic.to_owned(), domain: node.domain().to_string(), detail })
    };
    if let Some((what, found, wanted)) = too_small {
        return incompatible(format!(
            "it was made with {found} {what}, {wanted} are asked for; close its consumers"
        ));
    }
    if found.has_safe_overflow() == spec.lossless.is_some() {
        return incompatible(
            "it was made with the other of lossless and overflow; close its consumers".to_owned(),
        );
    }
    let kind = attribute(frames.attributes(), KIND);
    if kind.as_deref().is_some_and(|kind| kind != spec.kind.as_str()) {
        tracing::warn!(topic, ?kind, "consumers keep this stream open from a publisher of another kind");
    }
    Ok(())
}

fn attribute(attributes: &AttributeSet, key: &str) -> Option<String> {
    let key = AttributeKey::try_from(key).ok()?;
    attributes.key_value(&key, 0).map(ToString::to_string)
}

pub(crate) fn list(node: &Node) -> Result<Vec<StreamInfo>, Error> {
    let mut topics = Vec::new();
    Ipc::list(node.config(), |details| {
        let details = details.static_details;
        if matches!(details.messaging_pattern(), MessagingPattern::PublishSubscribe(_))
            && let Some(topic) = topic_of_service(details.name().as_str())
        {
            topics.push(topic.to_owned());
        }
        CallbackProgression::Continue
    })
    .map_err(|error| node.failed(format!("listing domain \"{}\"", node.domain()), error))?;
    topics.sort_unstable();
    let mut streams = Vec::with_capacity(topics.len());
    for topic in topics {
        // Gone since, or somebody else's: not to be listed.
        if let Ok(Opened::Yes(frames, _)) = open(node, &topic) {
            streams.push(describe(topic, &frames));
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
    }
}
