//! Streams: what one is made with, and what a domain has.

mod attributes;
mod info;
mod lossless;
mod opening;
pub(crate) mod ports;
mod spec;
mod versions;

pub use info::StreamInfo;
pub use lossless::Lossless;
pub use spec::StreamSpec;

pub(crate) use opening::{Opened, open, open_or_create};

use crate::{FrameHeader, domain::Ipc};
use iceoryx2::service::port_factory::{event, publish_subscribe};

/// The frames of a stream.
pub(crate) type Frames = publish_subscribe::PortFactory<Ipc, [u8], FrameHeader>;
/// The event service beside it, by which subscribers are woken.
pub(crate) type Events = event::PortFactory<Ipc>;
