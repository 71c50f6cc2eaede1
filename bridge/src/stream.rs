//! Streams: how one is opened, and what a domain has.

mod attributes;
mod info;
mod opening;
pub(crate) mod ports;
mod versions;

pub use info::StreamInfo;

pub(crate) use opening::{Opened, open, open_or_create};

use crate::{FrameHeader, domain::Ipc};
use iceoryx2::service::port_factory::{event, publish_subscribe};

/// The frames of a stream.
pub(crate) type Frames = publish_subscribe::PortFactory<Ipc, [u8], FrameHeader>;
/// The event service beside it, by which subscribers are woken.
pub(crate) type Events = event::PortFactory<Ipc>;
