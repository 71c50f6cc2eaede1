//! Datagrams: what their submessages say (8.3, 9.4).

use crate::bytes::Bytes;
use crate::guid::{EntityId, Guid, Prefix, SampleIdentity};
use crate::numbers::NumberSet;
use crate::parameters::{Parameters, id};

mod encode;

pub(crate) use encode::{Encoder, Place};

/// The kinds of submessages (9.4.5.1.1).
mod kind {
    pub(crate) const ACKNACK: u8 = 0x06;
    pub(crate) const HEARTBEAT: u8 = 0x07;
    pub(crate) const GAP: u8 = 0x08;
    pub(crate) const INFO_TS: u8 = 0x09;
    pub(crate) const INFO_SRC: u8 = 0x0C;
    pub(crate) const INFO_DST: u8 = 0x0E;
    pub(crate) const NACK_FRAG: u8 = 0x12;
    pub(crate) const DATA: u8 = 0x15;
    pub(crate) const DATA_FRAG: u8 = 0x16;
}

/// No sequence number is as large as this: what is added to one fits.
const MOST: i64 = 1 << 62;

/// What a submessage says, with the readers or writers that it is from and for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Submessage<'a> {
    pub(crate) reader: EntityId,
    pub(crate) writer: EntityId,
    pub(crate) content: Content<'a>,
}

/// What a submessage says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Content<'a> {
    /// A whole sample.
    Data { sequence: i64, about: About, payload: &'a [u8] },
    /// Some fragments of a sample: `first` counts from 1, and all but the last fragment have `size` bytes.
    Fragments { sequence: i64, about: About, first: u32, size: u16, total: u32, payload: &'a [u8] },
    /// Samples that will not come: from `start` to before the base of the set, and those in the set.
    Gap { start: i64, list: NumberSet },
    /// Which samples a writer has.
    Heartbeat { first: i64, last: i64, count: u32, is_final: bool },
    /// Which samples a reader has: all before the base of the set. It asks for those in the set.
    AckNack { missing: NumberSet, count: u32, is_final: bool },
    /// Which fragments of a sample a reader lacks.
    NackFragments { sequence: i64, missing: NumberSet, count: u32 },
}

/// What a sample is about, beside its payload.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct About {
    /// The key, if it is given beside the payload.
    pub(crate) key: Option<Guid>,
    /// What the key names is gone.
    pub(crate) disposed: bool,
    /// The payload is the key alone.
    pub(crate) is_key: bool,
    /// The sample that this one belongs to.
    pub(crate) related: Option<SampleIdentity>,
}

/// Goes through the submessages of a datagram. What is malformed ends it.
#[derive(Debug)]
pub(crate) struct Message<'a> {
    rest: &'a [u8],
    pub(crate) source: Prefix,
    /// Who made the program of the source.
    pub(crate) vendor: [u8; 2],
    pub(crate) destination: Prefix,
}

impl<'a> Message<'a> {
    /// A datagram that begins as one of RTPS 2.
    pub(crate) fn new(datagram: &'a [u8]) -> Option<Message<'a>> {
        let mut bytes = Bytes::new(datagram, true);
        if bytes.array()? != *b"RTPS" || bytes.array::<2>()?[0] != 2 {
            return None;
        }
        let (vendor, source) = (bytes.array()?, bytes.prefix()?);
        Some(Message { rest: bytes.rest(), source, vendor, destination: Prefix::UNKNOWN })
    }

    /// The next submessage that says something to a reader or writer.
    pub(crate) fn next(&mut self) -> Option<Submessage<'a>> {
        loop {
            let &[kind, flags, ..] = self.rest else { return None };
            let little = flags & 1 == 1;
            let mut bytes = Bytes::new(self.rest.get(2..)?, little);
            let length = usize::from(bytes.u16()?);
            let has_no_body = matches!(kind, kind::INFO_TS | 0x01) && length == 0;
            let rest = bytes.rest();
            // A length of 0 means "to the end", but for submessages that may be empty.
            let length = if length == 0 && !has_no_body { rest.len() } else { length };
            let (body, rest) = rest.split_at_checked(length)?;
            self.rest = rest;
            let mut bytes = Bytes::new(body, little);
            match kind {
                kind::INFO_DST => self.destination = bytes.prefix()?,
                kind::INFO_SRC => {
                    bytes.take(6)?;
                    (self.vendor, self.source) = (bytes.array()?, bytes.prefix()?);
                }
                kind::DATA => return data(bytes, flags, little),
                kind::DATA_FRAG => return fragments(bytes, flags, little),
                kind::HEARTBEAT | kind::ACKNACK | kind::NACK_FRAG | kind::GAP => {
                    return state(kind, flags, bytes);
                }
                _ => {}
            }
        }
    }
}

/// A whole sample.
fn data(mut bytes: Bytes<'_>, flags: u8, little: bool) -> Option<Submessage<'_>> {
    bytes.u16()?;
    let to_inline = usize::from(bytes.u16()?);
    let after = bytes;
    let (reader, writer, sequence) = (bytes.entity()?, bytes.entity()?, bytes.sequence()?);
    let (mut about, payload) = inline(after, to_inline, flags, little)?;
    about.is_key = flags & 8 != 0;
    let payload = if flags & 0b1100 == 0 { &[] } else { payload };
    (1..MOST).contains(&sequence).then_some(Submessage {
        reader,
        writer,
        content: Content::Data { sequence, about, payload },
    })
}

/// Fragments of a sample.
fn fragments(mut bytes: Bytes<'_>, flags: u8, little: bool) -> Option<Submessage<'_>> {
    bytes.u16()?;
    let to_inline = usize::from(bytes.u16()?);
    let after = bytes;
    let (reader, writer, sequence) = (bytes.entity()?, bytes.entity()?, bytes.sequence()?);
    let (first, count, size, total) = (bytes.u32()?, bytes.u16()?, bytes.u16()?, bytes.u32()?);
    let (about, payload) = inline(after, to_inline, flags, little)?;
    let start = u64::from(first.checked_sub(1)?) * u64::from(size);
    if !(1..MOST).contains(&sequence) || size == 0 || count == 0 || start >= u64::from(total) {
        return None;
    }
    // What is behind the fragments or the sample is padding.
    let length = (u64::from(count) * u64::from(size)).min(u64::from(total) - start);
    let payload = payload.get(..usize::try_from(length).ok()?)?;
    let content = Content::Fragments { sequence, about, first, size, total, payload };
    Some(Submessage { reader, writer, content })
}

/// Steps over inline parameters, if there are any, and says what of them counts here.
fn inline(mut bytes: Bytes<'_>, to_inline: usize, flags: u8, little: bool) -> Option<(About, &[u8])> {
    bytes.take(to_inline)?;
    let mut about = About::default();
    if flags & 2 == 0 {
        return Some((about, bytes.rest()));
    }
    let mut parameters = Parameters::new(bytes.rest(), little);
    while let Some((id, mut value)) = parameters.next().ok()? {
        match id {
            id::KEY_HASH => about.key = value.guid(),
            // Big endian whatever the flags say: bit 0 is "disposed", bit 1 "unregistered".
            id::STATUS_INFO => about.disposed = value.array::<4>()?[3] & 3 != 0,
            id::RELATED_SAMPLE_IDENTITY | id::OLD_RELATED_SAMPLE_IDENTITY => {
                let identity = value.guid().zip(value.sequence());
                about.related = identity.map(|(writer, sequence)| SampleIdentity { writer, sequence });
            }
            _ => {}
        }
    }
    Some((about, parameters.rest()))
}

/// What says which samples there are.
fn state(kind: u8, flags: u8, mut bytes: Bytes<'_>) -> Option<Submessage<'_>> {
    let (reader, writer) = (bytes.entity()?, bytes.entity()?);
    let is_final = flags & 2 != 0;
    let content = match kind {
        kind::HEARTBEAT => {
            let (first, last, count) = (bytes.sequence()?, bytes.sequence()?, bytes.u32()?);
            if first <= 0 || last < first - 1 || last >= MOST {
                return None;
            }
            Content::Heartbeat { first, last, count, is_final }
        }
        kind::ACKNACK => {
            Content::AckNack { missing: NumberSet::sequences(&mut bytes)?, count: bytes.u32()?, is_final }
        }
        kind::NACK_FRAG => {
            let sequence = bytes.sequence()?;
            Content::NackFragments {
                sequence,
                missing: NumberSet::fragments(&mut bytes)?,
                count: bytes.u32()?,
            }
        }
        _ => {
            let start = bytes.sequence()?;
            let list = NumberSet::sequences(&mut bytes)?;
            if start <= 0 || list.base() < start {
                return None;
            }
            Content::Gap { start, list }
        }
    };
    Some(Submessage { reader, writer, content })
}
