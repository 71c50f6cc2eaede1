//! Names of participants, readers and writers on the wire (DDSI-RTPS 2.3, 9.3.1).

/// The twelve bytes that all readers and writers of a participant share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Prefix(pub [u8; 12]);

impl Prefix {
    /// As a destination: every participant.
    pub const UNKNOWN: Prefix = Prefix([0; 12]);
}

/// A reader or writer within its participant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EntityId(pub [u8; 4]);

impl EntityId {
    /// As a destination: every reader that is matched with the writer.
    pub const UNKNOWN: EntityId = EntityId([0; 4]);
    pub(crate) const PARTICIPANT: EntityId = EntityId([0, 0, 1, 0xC1]);
    pub(crate) const SPDP_WRITER: EntityId = EntityId([0, 1, 0, 0xC2]);
    pub(crate) const PUBLICATIONS_WRITER: EntityId = EntityId([0, 0, 3, 0xC2]);
    pub(crate) const PUBLICATIONS_READER: EntityId = EntityId([0, 0, 3, 0xC7]);
    pub(crate) const SUBSCRIPTIONS_WRITER: EntityId = EntityId([0, 0, 4, 0xC2]);
    pub(crate) const SUBSCRIPTIONS_READER: EntityId = EntityId([0, 0, 4, 0xC7]);

    /// The `number`-th writer of a user's topic; topics of ROS have no key.
    pub(crate) fn user_writer(number: u32) -> EntityId {
        let [_, a, b, c] = number.to_be_bytes();
        EntityId([a, b, c, 0x03])
    }

    /// The `number`-th reader of a user's topic.
    pub(crate) fn user_reader(number: u32) -> EntityId {
        let [_, a, b, c] = number.to_be_bytes();
        EntityId([a, b, c, 0x04])
    }
}

/// The name of a sample in a whole domain. A reply has the name of its request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SampleIdentity {
    pub(crate) writer: Guid,
    pub(crate) sequence: i64,
}

/// The name of a participant, reader or writer in a whole domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Guid {
    /// Its participant.
    pub prefix: Prefix,
    /// Which of the participant's readers and writers.
    pub entity: EntityId,
}

impl Guid {
    pub(crate) fn new(prefix: Prefix, entity: EntityId) -> Guid {
        Guid { prefix, entity }
    }

    /// The sixteen bytes of the wire.
    pub fn bytes(self) -> [u8; 16] {
        let mut bytes = [0; 16];
        bytes[..12].copy_from_slice(&self.prefix.0);
        bytes[12..].copy_from_slice(&self.entity.0);
        bytes
    }

    /// From the sixteen bytes of the wire.
    pub(crate) fn of(bytes: [u8; 16]) -> Guid {
        let [a, b, c, d, e, f, g, h, i, j, k, l, w, x, y, z] = bytes;
        Guid::new(Prefix([a, b, c, d, e, f, g, h, i, j, k, l]), EntityId([w, x, y, z]))
    }
}
