//! The other end of a topic, and the way to it.

use std::net::SocketAddrV4;

use crate::guid::Guid;

/// Where datagrams go.
pub(crate) trait Link {
    /// Sends the parts as one datagram.
    fn send(&mut self, to: SocketAddrV4, parts: [&[u8]; 3]);
}

/// A reader that a writer is matched with, or a writer that a reader is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Peer {
    pub(crate) guid: Guid,
    pub(crate) address: SocketAddrV4,
    pub(crate) reliable: bool,
    pub(crate) transient: bool,
    /// Who made its program.
    pub(crate) vendor: [u8; 2],
}
