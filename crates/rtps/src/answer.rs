//! What a reply must know of its request.

use crate::guid::{Guid, Prefix, SampleIdentity};

/// Where a reply goes, and how it names its request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Answer {
    /// The participant of the client, the only one that gets the reply.
    pub(crate) client: Prefix,
    /// The client's reader of replies, if the request says which one it is.
    pub(crate) reader: Option<Guid>,
    /// The name of the request, beside the reply: the way of `rmw_fastrtps`.
    pub(crate) related: Option<SampleIdentity>,
    /// The name of the request, before the values of the reply: the way of `rmw_cyclonedds`.
    pub(crate) header: Option<[u8; 16]>,
}
