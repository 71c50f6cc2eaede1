//! Writes datagrams.

use std::time::Duration;

use super::kind;
use crate::bytes::Append;
use crate::guid::{EntityId, Guid, Prefix, SampleIdentity};
use crate::numbers::NumberSet;
use crate::parameters::{List, id};

/// Version 2.3, and no vendor's number, as the OMG has given none.
const VERSION: [u8; 2] = [2, 3];
const VENDOR: [u8; 2] = [0, 0];

/// Where a submessage goes: to one reader or writer, or to all that are matched (`EntityId::UNKNOWN`).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) reader: EntityId,
    pub(crate) writer: EntityId,
}

/// A datagram in the making.
pub(crate) struct Encoder<'a>(&'a mut Vec<u8>);

impl<'a> Encoder<'a> {
    /// Begins a datagram in an empty buffer. `Prefix::UNKNOWN` is for every participant that gets it.
    pub(crate) fn new(buffer: &'a mut Vec<u8>, from: Prefix, to: Prefix) -> Encoder<'a> {
        buffer.clear();
        buffer.extend_from_slice(b"RTPS");
        buffer.extend_from_slice(&VERSION);
        buffer.extend_from_slice(&VENDOR);
        buffer.extend_from_slice(&from.0);
        let mut encoder = Encoder(buffer);
        if to != Prefix::UNKNOWN {
            encoder.submessage(kind::INFO_DST, 0, 0, |body| body.extend_from_slice(&to.0));
        }
        encoder
    }

    /// Goes on behind a payload that is sent from elsewhere: the buffer begins with a submessage.
    pub(crate) fn behind(buffer: &'a mut Vec<u8>) -> Encoder<'a> {
        buffer.clear();
        Encoder(buffer)
    }

    /// `behind` bytes of the submessage are sent from elsewhere.
    fn submessage(&mut self, kind: u8, flags: u8, behind: usize, write: impl FnOnce(&mut Vec<u8>)) {
        self.0.extend_from_slice(&[kind, flags | 1, 0, 0]);
        let at = self.0.len();
        write(self.0);
        let length = (self.0.len() - at + behind) as u16;
        self.0[at - 2..at].copy_from_slice(&length.to_le_bytes());
    }

    /// When the samples that follow were written, since 1970.
    pub(crate) fn time(&mut self, time: Duration) {
        self.submessage(kind::INFO_TS, 0, 0, |body| {
            body.put_u32(time.as_secs() as u32);
            body.put_u32(((u64::from(time.subsec_nanos()) << 32) / 1_000_000_000) as u32);
        });
    }

    /// A sample whose `length` bytes follow from elsewhere.
    pub(crate) fn data(
        &mut self,
        place: Place,
        sequence: i64,
        related: Option<SampleIdentity>,
        length: usize,
    ) {
        let flags = if related.is_some() { 4 | 2 } else { 4 };
        self.submessage(kind::DATA, flags, length, |body| {
            data_head(body, 16, place, sequence);
            relation(body, related);
        });
    }

    /// A sample of discovery, with its key beside it.
    pub(crate) fn keyed(&mut self, place: Place, sequence: i64, key: Guid, disposed: bool, payload: &[u8]) {
        let flags = if disposed { 2 | 8 } else { 2 | 4 };
        self.submessage(kind::DATA, flags, 0, |body| {
            data_head(body, 16, place, sequence);
            let mut list = List(body);
            list.guid(id::KEY_HASH, key);
            if disposed {
                list.bytes(id::STATUS_INFO, &[0, 0, 0, 3]);
            }
            list.end();
            body.extend_from_slice(payload);
        });
    }

    /// `count` fragments of `size` bytes, from number `first` on, of a sample of `total` bytes. Their `length` bytes
    /// follow from elsewhere.
    pub(crate) fn fragments(
        &mut self,
        place: Place,
        sequence: i64,
        related: Option<SampleIdentity>,
        (first, count, size): (u32, u16, u16),
        total: u32,
        length: usize,
    ) {
        let flags = if related.is_some() { 2 } else { 0 };
        self.submessage(kind::DATA_FRAG, flags, length, |body| {
            data_head(body, 28, place, sequence);
            body.put_u32(first);
            body.put_u16(count);
            body.put_u16(size);
            body.put_u32(total);
            relation(body, related);
        });
    }

    /// Which samples there are. The reader is to answer.
    pub(crate) fn heartbeat(&mut self, place: Place, first: i64, last: i64, count: u32) {
        self.submessage(kind::HEARTBEAT, 0, 0, |body| {
            entities(body, place);
            body.put_sequence(first);
            body.put_sequence(last);
            body.put_u32(count);
        });
    }

    /// The samples from `start` to before `end` will not come.
    pub(crate) fn gap(&mut self, place: Place, start: i64, end: i64) {
        self.submessage(kind::GAP, 0, 0, |body| {
            entities(body, place);
            body.put_sequence(start);
            NumberSet::empty(end).put_sequences(body);
        });
    }

    /// Which samples a reader has, and which it asks for. Unless `is_final`, the writer is to answer.
    pub(crate) fn acknack(&mut self, place: Place, missing: &NumberSet, count: u32, is_final: bool) {
        self.submessage(kind::ACKNACK, if is_final { 2 } else { 0 }, 0, |body| {
            entities(body, place);
            missing.put_sequences(body);
            body.put_u32(count);
        });
    }

    /// Which fragments of a sample a reader asks for.
    pub(crate) fn nack_fragments(&mut self, place: Place, sequence: i64, missing: &NumberSet, count: u32) {
        self.submessage(kind::NACK_FRAG, 0, 0, |body| {
            entities(body, place);
            body.put_sequence(sequence);
            missing.put_fragments(body);
            body.put_u32(count);
        });
    }
}

fn entities(body: &mut Vec<u8>, place: Place) {
    body.extend_from_slice(&place.reader.0);
    body.extend_from_slice(&place.writer.0);
}

/// The inline parameters of a sample that belongs to another one.
fn relation(body: &mut Vec<u8>, related: Option<SampleIdentity>) {
    if let Some(related) = related {
        List(body)
            .sample_identity(id::RELATED_SAMPLE_IDENTITY, related)
            .sample_identity(id::OLD_RELATED_SAMPLE_IDENTITY, related)
            .end();
    }
}

/// What samples and fragments begin with. `to_inline` bytes lead from behind its field to the inline parameters.
fn data_head(body: &mut Vec<u8>, to_inline: u16, place: Place, sequence: i64) {
    body.put_u16(0);
    body.put_u16(to_inline);
    entities(body, place);
    body.put_sequence(sequence);
}
