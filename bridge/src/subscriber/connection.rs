//! [`Connection`]: a subscriber's ports during one life of a stream.

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

/// A subscriber's ports and their services. Fields are dropped in this order: ports before services.
pub(crate) struct Connection {
    /// Shared with the frames that were received through it: see [`Frame`](crate::Frame).
    pub(crate) port: Arc<Own<FramePort>>,
    pub(crate) listener: Listener<Ipc>,
    pub(crate) frames: Frames,
    _events: Events,
    pub(crate) since_mono_ns: u64,
}

impl Connection {
    /// Connects to a stream, or creates it if `owned` has its specification. Returns `None` if there is no stream to
    /// connect to.
    pub(crate) fn open(node: &Node, topic: &str, owned: Option<&StreamSpec>) -> Result<Option<Self>, Error> {
        Error::check_open_files(|| format!("subscribing to {topic}"))?;
        room::check_room_for_books(topic)?;
        let (frames, events) = match owned {
            Some(spec) => stream::open_or_create(node, spec)?,
            None => match stream::open(node, topic)? {
                Opened::Yes(frames, events) if frames.dynamic_config().number_of_publishers() > 0 => {
                    (frames, events)
                }
                // A stream without a publisher is a remnant, which other subscribers are about to close.
                Opened::Yes(..) | Opened::NotThere => return Ok(None),
            },
        };
        // The listener first, so that every subscriber that a publisher sees can be woken.
        let listener = events
            .listener_builder()
            .create()
            .map_err(|error| node.keeper().failed(format!("opening the events of {topic}"), error))?;
        if node.keeper().is_shared() {
            // A notifier may have tried to connect before the new socket was opened to the group. It retries only if
            // the list of listeners changes, so add a listener and drop it.
            node.keeper().settle();
            drop(events.listener_builder().create());
        }
        let config = frames.static_config();
        let history = config.history_size().min(config.subscriber_max_buffer_size());
        let create = || frames.subscriber_builder().history_request(history).create();
        let port = match create() {
            Err(SubscriberCreateError::ExceedsMaxSupportedSubscribers) => {
                // The slots may belong to killed subscribers.
                node.clean_up_dead();
                create()
            }
            created => created,
        };
        let port = match port {
            // Another process is cleaning up a killed subscriber: its slot is free at the next attempt.
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

    /// Returns the number of publishers now.
    pub(crate) fn publishers(&self) -> usize {
        self.frames.dynamic_config().number_of_publishers()
    }
}
