//! Parameter lists, in which discovery puts all that it says (9.4.2.11).

use std::net::{Ipv4Addr, SocketAddrV4};
use std::time::Duration;

use crate::bytes::{Append, Bytes};
use crate::guid::{Guid, SampleIdentity};

const SENTINEL: u16 = 0x0001;

/// What a parameter is about (table 9.13).
pub(crate) mod id {
    pub(crate) const LEASE_DURATION: u16 = 0x0002;
    pub(crate) const TOPIC_NAME: u16 = 0x0005;
    pub(crate) const TYPE_NAME: u16 = 0x0007;
    pub(crate) const DOMAIN_ID: u16 = 0x000F;
    pub(crate) const PROTOCOL_VERSION: u16 = 0x0015;
    pub(crate) const VENDOR_ID: u16 = 0x0016;
    pub(crate) const RELIABILITY: u16 = 0x001A;
    pub(crate) const LIVELINESS: u16 = 0x001B;
    pub(crate) const DURABILITY: u16 = 0x001D;
    pub(crate) const DEADLINE: u16 = 0x0023;
    pub(crate) const USER_DATA: u16 = 0x002C;
    pub(crate) const UNICAST_LOCATOR: u16 = 0x002F;
    pub(crate) const DEFAULT_UNICAST_LOCATOR: u16 = 0x0031;
    pub(crate) const METATRAFFIC_UNICAST_LOCATOR: u16 = 0x0032;
    pub(crate) const METATRAFFIC_MULTICAST_LOCATOR: u16 = 0x0033;
    pub(crate) const HISTORY: u16 = 0x0040;
    pub(crate) const PARTICIPANT_GUID: u16 = 0x0050;
    pub(crate) const BUILTIN_ENDPOINT_SET: u16 = 0x0058;
    pub(crate) const ENDPOINT_GUID: u16 = 0x005A;
    pub(crate) const ENTITY_NAME: u16 = 0x0062;
    pub(crate) const KEY_HASH: u16 = 0x0070;
    pub(crate) const STATUS_INFO: u16 = 0x0071;
    /// Which sample this one belongs to: by the standard of remote procedure calls, and as Fast DDS had it before.
    pub(crate) const RELATED_SAMPLE_IDENTITY: u16 = 0x0083;
    pub(crate) const OLD_RELATED_SAMPLE_IDENTITY: u16 = 0x800F;
}

/// What stands before a parameter list that is a payload: its encoding, in little endian.
pub(crate) const ENCAPSULATION: [u8; 4] = [0, 3, 0, 0];

/// The parameters of a payload with their ids, until the sentinel. A list that is cut gives `None` at its end.
pub(crate) fn of_payload(payload: &[u8]) -> Option<Parameters<'_>> {
    let (head, rest) = payload.split_at_checked(4)?;
    let little = match head[..2] {
        [0, 2] => false,
        [0, 3] => true,
        _ => return None,
    };
    Some(Parameters { bytes: Bytes::new(rest, little), little })
}

/// Goes through a parameter list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parameters<'a> {
    bytes: Bytes<'a>,
    little: bool,
}

impl<'a> Parameters<'a> {
    /// The list that begins here, as inline parameters do.
    pub(crate) fn new(rest: &'a [u8], little: bool) -> Parameters<'a> {
        Parameters { bytes: Bytes::new(rest, little), little }
    }

    /// What follows the list, once its sentinel was read.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.bytes.rest()
    }

    /// The next parameter; `Ok(None)` after the last one, and an error in a list that is cut.
    pub(crate) fn next(&mut self) -> Result<Option<(u16, Bytes<'a>)>, Cut> {
        let id = self.bytes.u16().ok_or(Cut)?;
        let length = self.bytes.u16().ok_or(Cut)?;
        if id == SENTINEL {
            return Ok(None);
        }
        let value = self.bytes.take(usize::from(length)).ok_or(Cut)?;
        Ok(Some((id, Bytes::new(value, self.little))))
    }
}

/// A list without an end.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Cut;

/// A duration of the wire; the largest one means "for ever", and is `Duration::MAX`.
pub(crate) fn duration(value: &mut Bytes<'_>) -> Option<Duration> {
    let (seconds, fraction) = (value.u32()?, value.u32()?);
    if seconds >= 0x7FFF_FFFF {
        return Some(Duration::MAX);
    }
    Some(Duration::new(u64::from(seconds), ((u64::from(fraction) * 1_000_000_000) >> 32) as u32))
}

/// A locator of the wire, if it is of UDP over IPv4; others are `None`.
pub(crate) fn locator(value: &mut Bytes<'_>) -> Option<SocketAddrV4> {
    let (kind, port) = (value.u32()?, value.u32()?);
    let address: [u8; 16] = value.array()?;
    let [.., a, b, c, d] = address;
    let port = u16::try_from(port).ok().filter(|&port| port > 0)?;
    (kind == 1).then(|| SocketAddrV4::new(Ipv4Addr::new(a, b, c, d), port))
}

/// Writes a parameter list.
pub(crate) struct List<'a>(pub(crate) &'a mut Vec<u8>);

impl List<'_> {
    fn with(&mut self, id: u16, write: impl FnOnce(&mut Vec<u8>)) -> &mut Self {
        self.0.put_u16(id);
        let at = self.0.len();
        self.0.put_u16(0);
        write(self.0);
        // The length of every parameter is a multiple of four.
        let length = (self.0.len() - at - 2).next_multiple_of(4);
        self.0.resize(at + 2 + length, 0);
        self.0[at..at + 2].copy_from_slice(&(length as u16).to_le_bytes());
        self
    }

    pub(crate) fn bytes(&mut self, id: u16, value: &[u8]) -> &mut Self {
        self.with(id, |to| to.extend_from_slice(value))
    }

    pub(crate) fn number(&mut self, id: u16, value: u32) -> &mut Self {
        self.bytes(id, &value.to_le_bytes())
    }

    pub(crate) fn guid(&mut self, id: u16, value: Guid) -> &mut Self {
        self.bytes(id, &value.bytes())
    }

    pub(crate) fn sample_identity(&mut self, id: u16, value: SampleIdentity) -> &mut Self {
        self.with(id, |to| {
            to.extend_from_slice(&value.writer.bytes());
            to.put_sequence(value.sequence);
        })
    }

    pub(crate) fn string(&mut self, id: u16, value: &str) -> &mut Self {
        self.with(id, |to| to.put_string(value))
    }

    /// Bytes with their count.
    pub(crate) fn counted(&mut self, id: u16, value: &[u8]) -> &mut Self {
        self.with(id, |to| {
            to.put_u32(value.len() as u32);
            to.extend_from_slice(value);
        })
    }

    /// Numbers, and behind them a duration.
    pub(crate) fn numbers_and_duration(&mut self, id: u16, numbers: &[u32], value: Duration) -> &mut Self {
        self.with(id, |to| {
            for &number in numbers {
                to.put_u32(number);
            }
            if value == Duration::MAX {
                to.put_u32(0x7FFF_FFFF);
                to.put_u32(u32::MAX);
            } else {
                to.put_u32(value.as_secs().min(0x7FFF_FFFE) as u32);
                to.put_u32(((u64::from(value.subsec_nanos()) << 32) / 1_000_000_000) as u32);
            }
        })
    }

    pub(crate) fn locator(&mut self, id: u16, value: SocketAddrV4) -> &mut Self {
        self.with(id, |to| {
            to.put_u32(1);
            to.put_u32(u32::from(value.port()));
            to.extend_from_slice(&[0; 12]);
            to.extend_from_slice(&value.ip().octets());
        })
    }

    pub(crate) fn end(&mut self) {
        self.0.put_u16(SENTINEL);
        self.0.put_u16(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_comes_back_from_its_bytes() {
        let mut bytes = ENCAPSULATION.to_vec();
        let address = SocketAddrV4::new(Ipv4Addr::new(192, 168, 1, 2), 7411);
        List(&mut bytes)
            .string(id::TOPIC_NAME, "rt/scan")
            .locator(id::UNICAST_LOCATOR, address)
            .numbers_and_duration(id::LEASE_DURATION, &[], Duration::from_millis(1500))
            .numbers_and_duration(id::DEADLINE, &[], Duration::MAX)
            .end();
        bytes.push(9);
        let mut list = of_payload(&bytes).expect("a list");
        let mut value = |id| {
            let (found, value) = list.next().expect("whole").expect("one more");
            assert_eq!(found, id);
            value
        };
        assert_eq!(value(id::TOPIC_NAME).string().as_deref(), Some("rt/scan"));
        assert_eq!(locator(&mut value(id::UNICAST_LOCATOR)), Some(address));
        let lease = duration(&mut value(id::LEASE_DURATION)).expect("a duration");
        assert!(lease.abs_diff(Duration::from_millis(1500)) < Duration::from_nanos(2), "{lease:?}");
        assert_eq!(duration(&mut value(id::DEADLINE)), Some(Duration::MAX));
        assert!(list.next().expect("whole").is_none());
        assert_eq!(list.rest(), [9]);
    }

    #[test]
    fn a_list_that_is_cut_is_an_error() {
        let mut bytes = ENCAPSULATION.to_vec();
        List(&mut bytes).string(id::TOPIC_NAME, "rt/scan").end();
        for length in 4..bytes.len() {
            let mut list = of_payload(&bytes[..length]).expect("a list");
            while let Ok(parameter) = list.next() {
                assert!(parameter.is_some(), "{length} bytes ended well");
            }
        }
    }
}
