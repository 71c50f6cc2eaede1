//! Streams: opening one, and listing those of a domain.

mod attributes;
mod info;
mod opening;
pub(crate) mod ports;
mod versions;

pub use info::StreamInfo;

pub(crate) use opening::{Opened, open, open_or_create};

use crate::{FrameHeader, domain::Ipc};
use iceoryx2::service::port_factory::{event, publish_subscribe};

/// The publish-subscribe service that carries a stream's frames.
pub(crate) type Frames = publish_subscribe::PortFactory<Ipc, [u8], FrameHeader>;
/// The event service of a stream, which wakes its subscribers.
pub(crate) type Events = event::PortFactory<Ipc>;
