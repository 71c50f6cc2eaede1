//! Streams: what one is made with, and what a domain has.

mod info;
mod opening;
mod spec;

pub use info::StreamInfo;
pub use spec::StreamSpec;

pub(crate) use info::list;
pub(crate) use opening::{Opened, open, open_or_create};

use crate::{FrameHeader, node::Ipc};
use iceoryx2::service::port_factory::{event, publish_subscribe};

/// The frames of a stream.
pub(crate) type Frames = publish_subscribe::PortFactory<Ipc, [u8], FrameHeader>;
/// The event service beside it, by which subscribers are woken.
pub(crate) type Events = event::PortFactory<Ipc>;
