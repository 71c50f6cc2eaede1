//! Opening or creating a stream.

use super::{
    Events, Frames,
    attributes::{attributes, declared_kind},
    ports, versions,
};
use crate::{Error, FrameHeader, Node, StreamSpec, domain::service_name, topic::canonical_topic};
use iceoryx2::service::{
    builder::{
        event::{EventCreateError, EventOpenError},
        publish_subscribe::{PublishSubscribeCreateError, PublishSubscribeOpenError},
    },
    port_factory::PortFactory as _,
};
use std::time::{Duration, Instant};

/// The maximum number of processes that have one stream open: subscribers, publishers, and those that only list it.
const MAX_NODES: usize = 40;

/// An upper bound on the time until a waiting consumer closes the stream of a publisher that has ended.
const LETTING_GO: Duration = Duration::from_millis(500);

/// The result of opening a stream.
pub(crate) enum Opened {
    Yes(Frames, Events),
    /// The stream does not exist, is being removed, or is not complete yet.
    NotThere,
}

/// Opens an existing stream.
pub(crate) fn open(node: &Node, topic: &str) -> Result<Opened, Error> {
    let deadline = Instant::now() + node.keeper().patience();
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
        Err(E::InsufficientPermissions) => Err(node.keeper().refused(&format!("opening {topic}"))),
        Err(E::ExceedsMaxNumberOfNodes) => {
            Err(Error::TooManyProcesses { topic: topic.to_owned(), max: MAX_NODES })
        }
        Err(
            error @ (E::VersionMismatch
            | E::IncompatibleTypes
            | E::ServiceInCorruptedState
            | E::IncompatibleMessagingPattern
            | E::UnableToAcquireTypeDefinition
            | E::InvalidTypeDefinition),
        ) => Err(versions::incompatible(node, topic, error)),
        Err(error) => Err(node.keeper().failed(format!("opening {topic}"), error)),
    }
}

/// Opens a stream, or creates it if it does not exist.
pub(crate) fn open_or_create(node: &Node, spec: &StreamSpec) -> Result<(Frames, Events), Error> {
    use PublishSubscribeCreateError as E;
    let topic = canonical_topic(&spec.topic)?;
    let name = service_name(topic)?;
    let begun = Instant::now();
    let deadline = begun + Duration::from_secs(3);
    loop {
        let problem = match open(node, topic) {
            Ok(Opened::Yes(frames, events)) => match check_against(spec, topic, node, &frames) {
                Ok(()) => return Ok((frames, events)),
                // Consumers that wait for frames close the stream in a moment, and a dead publisher is cleaned up.
                Err(error) => Some(error),
            },
            Ok(Opened::NotThere) => None,
            // An incomplete stream of a killed process exists until it has been cleaned up.
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
                .create_with_attributes(&attributes(spec)?);
            match created {
                Ok(frames) => {
                    if let Some(events) = events(node, topic)? {
                        node.keeper().settle();
                        return Ok((frames, events));
                    }
                    if Instant::now() >= deadline {
                        let detail = "another process hangs while it creates them";
                        return Err(node.keeper().failed(format!("creating the events of {topic}"), detail));
                    }
                }
                Err(E::InsufficientPermissions) => {
                    return Err(node.keeper().refused(&format!("making {topic}")));
                }
                // Another process was faster, or is removing the stream.
                Err(
                    E::AlreadyExists
                    | E::IsBeingCreatedByAnotherInstance
                    | E::HangsInCreation
                    | E::ServiceInCorruptedState
                    | E::Interrupt,
                ) if Instant::now() < deadline => {}
                Err(error) => return Err(node.keeper().failed(format!("making {topic}"), error)),
            }
        }
        match problem {
            Some(error) => {
                let patience = match &error {
                    Error::Incompatible { .. } => deadline - begun,
                    _ => LETTING_GO,
                };
                if begun.elapsed() >= patience {
                    return Err(error);
                }
            }
            // It can be neither opened nor created.
            None => node.keeper().remove_deserted_streams(),
        }
        node.clean_up_dead();
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Opens the event service of a stream, or creates it. Returns `None` if another process is creating or removing it, or
/// was killed while it did.
fn events(node: &Node, topic: &str) -> Result<Option<Events>, Error> {
    use EventCreateError as C;
    use EventOpenError as O;
    let name = service_name(topic)?;
    let builder = || node.iox().service_builder(&name).event();
    let deadline = Instant::now() + node.keeper().patience().max(Duration::from_millis(50));
    loop {
        let failed = match builder().open() {
            Ok(events) => return Ok(Some(events)),
            Err(O::DoesNotExist) => match builder().max_nodes(MAX_NODES).create() {
                Ok(events) => return Ok(Some(events)),
                Err(
                    C::AlreadyExists
                    | C::IsBeingCreatedByAnotherInstance
                    | C::ServiceInCorruptedState
                    | C::Interrupt,
                ) => None,
                Err(error) => Some(format!("{error:?}")),
            },
            Err(
                O::HangsInCreation | O::IsMarkedForDestruction | O::ServiceInCorruptedState | O::Interrupt,
            ) => None,
            Err(O::ExceedsMaxNumberOfNodes) => {
                return Err(Error::TooManyProcesses { topic: topic.to_owned(), max: MAX_NODES });
            }
            Err(error) => Some(format!("{error:?}")),
        };
        if Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(5));
            continue;
        }
        if let Some(detail) = failed {
            return Err(node.keeper().failed(format!("opening the events of {topic}"), detail));
        }
        node.clean_up_dead();
        return Ok(None);
    }
}

/// Checks that a stream that others keep open from an earlier publisher fits `spec`.
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
    let kept_open = |difference| {
        if found.max_publishers() == 1 && frames.dynamic_config().number_of_publishers() > 0 {
            let holder = ports::publisher(node, frames);
            let (topic, domain) = (topic.to_owned(), node.domain().to_string());
            return Err(Error::DomainInUse { topic, domain, holder });
        }
        let consumers = ports::consumers(node, frames);
        let holders: Vec<_> = consumers.iter().map(|(_, consumer)| consumer.to_string()).collect();
        let holders = if holders.is_empty() { "another process".to_owned() } else { holders.join(", ") };
        let (topic, domain) = (topic.to_owned(), node.domain().to_string());
        Err(Error::KeptOpen { topic, domain, difference, holders })
    };
    if let Some((what, found, wanted)) = too_small {
        return kept_open(format!("it was created with {found} {what}, but {wanted} are requested"));
    }
    if found.has_safe_overflow() == spec.lossless.is_some() {
        return kept_open(if spec.lossless.is_some() {
            "it was created to drop frames of slow consumers, but this run waits for them (--wait-for, --record)"
                .to_owned()
        } else {
            "it was created to wait for slow consumers (--wait-for, --record), but this run drops their frames"
                .to_owned()
        });
    }
    let kind = declared_kind(frames);
    if kind.as_deref().is_some_and(|kind| kind != spec.kind.as_str()) {
        tracing::warn!(topic, ?kind, "consumers keep this stream open from a publisher of another kind");
    }
    Ok(())
}
