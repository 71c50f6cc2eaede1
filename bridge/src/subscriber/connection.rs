//! [`Connection`]: a subscriber's ports at one life of a stream.

use std::sync::Arc;

use iceoryx2::{
    port::{listener::Listener, subscriber::SubscriberCreateError},
    service::port_factory::PortFactory as _,
};

use super::frame::FramePort;
use crate::{
    Error, Node, StreamSpec, clock,
    domain::{Ipc, room},
    own::Own,
    stream::{self, Events, Frames, Opened, ports},
};

/// Ports before their services: fields are dropped in this order.
pub(crate) struct Connection {
    /// Shared with the frames that came through it, see [`Frame`](crate::Frame).
    pub(crate) port: Arc<Own<FramePort>>,
    pub(crate) listener: Listener<Ipc>,
    pub(crate) frames: Frames,
    _events: Events,
    pub(crate) since_mono_ns: u64,
}

impl Connection {
    /// Connects to a stream, which is made when `owned` says how; `None` while there is none to connect to.
    pub(crate) fn open(node: &Node, topic: &str, owned: Option<&StreamSpec>) -> Result<Option<Self>, Error> {
        Error::check_open_files(|| format!("subscribing to {topic}"))?;
        room::check_room_for_books(topic)?;
        let (frames, events) = match owned {
            Some(spec) => stream::open_or_create(node, spec)?,
            None => match stream::open(node, topic)? {
                Opened::Yes(frames, events) if frames.dynamic_config().number_of_publishers() > 0 => {
                    (frames, events)
                }
                // Without a publisher it is a remnant that other subscribers are about to let go.
                Opened::Yes(..) | Opened::NotThere => return Ok(None),
            },
        };
        // The listener first: who is seen as a subscriber is then sure to be woken.
        let listener = events
            .listener_builder()
            .create()
            .map_err(|error| node.keeper().failed(format!("opening the events of {topic}"), error))?;
        if node.keeper().is_shared() {
            // A notifier may have tried before the new socket was opened to the group, and tries again only when the list
            // of listeners changes: so one is added and dropped.
            node.keeper().settle();
            drop(events.listener_builder().create());
        }
        let config = frames.static_config();
        let history = config.history_size().min(config.subscriber_max_buffer_size());
        let create = || frames.subscriber_builder().history_request(history).create();
        let port = match create() {
            Err(SubscriberCreateError::ExceedsMaxSupportedSubscribers) => {
                // The places may be those of subscribers that were killed.
                node.clean_up_dead();
                create()
            }
            created => created,
        };
        let port = match port {
            // Another process is just cleaning up after one that was killed: its place is free at the next look.
            Err(SubscriberCreateError::ExceedsMaxSupportedSubscribers)
                if ports::place_of_the_dead(node, &frames) =>
            {
                return Ok(None);
            }
            port => port,
        };
        let port = port.map_err(|error| match error {
            SubscriberCreateError::ExceedsMaxSupportedSubscribers => {
                Error::TooManySubscribers { topic: topic.to_owned(), max: config.max_subscribers() }
            }
            error => node.keeper().failed(format!("subscribing to {topic}"), error),
        })?;
        Ok(Some(Self {
            port: Arc::new(Own::new(port)),
            listener,
            frames,
            _events: events,
            since_mono_ns: clock::mono_ns(),
        }))
    }

    /// Publishers now.
    pub(crate) fn publishers(&self) -> usize {
        self.frames.dynamic_config().number_of_publishers()
    }
}
