//! Numbers in datagrams, in either byte order. Nothing here panics: what is not there is `None`.

use crate::guid::{EntityId, Guid, Prefix};

/// Reads numbers one after the other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bytes<'a> {
    rest: &'a [u8],
    little: bool,
}

impl<'a> Bytes<'a> {
    pub(crate) fn new(rest: &'a [u8], little: bool) -> Bytes<'a> {
        Bytes { rest, little }
    }

    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    pub(crate) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.rest.split_at_checked(count)?;
        self.rest = rest;
        Some(taken)
    }

    pub(crate) fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    pub(crate) fn u16(&mut self) -> Option<u16> {
        let bytes = self.array()?;
        Some(if self.little { u16::from_le_bytes(bytes) } else { u16::from_be_bytes(bytes) })
    }

    pub(crate) fn u32(&mut self) -> Option<u32> {
        let bytes = self.array()?;
        Some(if self.little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    /// A sequence number: the upper half comes first in both byte orders.
    pub(crate) fn sequence(&mut self) -> Option<i64> {
        let upper = self.u32()? as i32;
        Some(i64::from(upper) << 32 | i64::from(self.u32()?))
    }

    pub(crate) fn entity(&mut self) -> Option<EntityId> {
        self.array().map(EntityId)
    }

    pub(crate) fn prefix(&mut self) -> Option<Prefix> {
        self.array().map(Prefix)
    }

    pub(crate) fn guid(&mut self) -> Option<Guid> {
        self.array().map(Guid::of)
    }

    /// A string with its length, which counts the zero at its end.
    pub(crate) fn string(&mut self) -> Option<String> {
        let length = self.u32()? as usize;
        let bytes = self.take(length)?;
        let bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        String::from_utf8(bytes.to_vec()).ok()
    }
}

/// Appends numbers in little endian, as in all that is sent.
pub(crate) trait Append {
    fn put_u16(&mut self, value: u16);
    fn put_u32(&mut self, value: u32);
    fn put_sequence(&mut self, value: i64);
    /// A string with its length, which counts the zero at its end.
    fn put_string(&mut self, value: &str);
    /// Zeros, until the length is a multiple of four.
    fn pad(&mut self);
}

impl Append for Vec<u8> {
    fn put_u16(&mut self, value: u16) {
        self.extend_from_slice(&value.to_le_bytes());
    }

    fn put_u32(&mut self, value: u32) {
        self.extend_from_slice(&value.to_le_bytes());
    }

    fn put_sequence(&mut self, value: i64) {
        self.put_u32((value >> 32) as u32);
        self.put_u32(value as u32);
    }

    fn put_string(&mut self, value: &str) {
        self.put_u32(value.len() as u32 + 1);
        self.extend_from_slice(value.as_bytes());
        self.push(0);
    }

    fn pad(&mut self) {
        self.resize(self.len().next_multiple_of(4), 0);
    }
}
