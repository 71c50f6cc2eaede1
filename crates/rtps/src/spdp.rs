//! What participants announce of themselves (8.5.3).

use std::net::SocketAddrV4;
use std::time::Duration;

use crate::guid::{EntityId, Guid, Prefix};
use crate::parameters::{self, ENCAPSULATION, List, id};

/// The readers and writers of discovery that there are: those of participants, publications and subscriptions (9.3.2).
const BUILTIN_ENDPOINTS: u32 = 0x3F;

/// After this time without an announcement, others take a participant for gone.
pub(crate) const LEASE: Duration = Duration::from_secs(20);

/// A participant, as it announces itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Announcement {
    pub(crate) prefix: Prefix,
    /// Where its readers and writers of discovery listen.
    pub(crate) discovery: Vec<SocketAddrV4>,
    /// Where its other readers and writers listen.
    pub(crate) user: Vec<SocketAddrV4>,
    pub(crate) lease: Duration,
    /// Who made its program.
    pub(crate) vendor: [u8; 2],
}

/// Those who make programs of DDS have numbers; this crate has none.
pub(crate) const UNKNOWN_VENDOR: [u8; 2] = [0, 0];
pub(crate) const FAST_DDS: [u8; 2] = [1, 15];
pub(crate) const CYCLONE: [u8; 2] = [1, 16];

/// At most so many addresses of a participant or endpoint are kept.
pub(crate) const MOST_LOCATORS: usize = 16;

impl Announcement {
    /// Reads what a participant announces; `None` if it is malformed or lacks its name.
    pub(crate) fn decode(payload: &[u8]) -> Option<Announcement> {
        let mut list = parameters::of_payload(payload)?;
        let (mut prefix, mut vendor) = (None, UNKNOWN_VENDOR);
        let (mut discovery, mut user, mut lease) = (Vec::new(), Vec::new(), Duration::from_secs(100));
        while let Some((id, mut value)) = list.next().ok()? {
            let locators = match id {
                id::PARTICIPANT_GUID => {
                    prefix = Some(value.guid()?.prefix);
                    continue;
                }
                id::VENDOR_ID => {
                    vendor = value.array()?;
                    continue;
                }
                id::LEASE_DURATION => {
                    lease = parameters::duration(&mut value)?;
                    continue;
                }
                id::METATRAFFIC_UNICAST_LOCATOR => &mut discovery,
                id::DEFAULT_UNICAST_LOCATOR => &mut user,
                _ => continue,
            };
            if locators.len() < MOST_LOCATORS {
                locators.extend(parameters::locator(&mut value));
            }
        }
        Some(Announcement { prefix: prefix?, discovery, user, lease, vendor })
    }

    /// What is announced. At `multicast`, all participants listen.
    pub(crate) fn encode(&self, domain: u32, multicast: Option<SocketAddrV4>, name: &str) -> Vec<u8> {
        let mut payload = ENCAPSULATION.to_vec();
        let mut list = List(&mut payload);
        list.bytes(id::PROTOCOL_VERSION, &[2, 3])
            .bytes(id::VENDOR_ID, &self.vendor)
            .guid(id::PARTICIPANT_GUID, Guid::new(self.prefix, EntityId::PARTICIPANT))
            .number(id::DOMAIN_ID, domain)
            .number(id::BUILTIN_ENDPOINT_SET, BUILTIN_ENDPOINTS)
            .numbers_and_duration(id::LEASE_DURATION, &[], self.lease)
            .string(id::ENTITY_NAME, name)
            // The security enclave of ROS 2: none.
            .counted(id::USER_DATA, b"enclave=/;");
        if let Some(locator) = multicast {
            list.locator(id::METATRAFFIC_MULTICAST_LOCATOR, locator);
        }
        for &locator in &self.discovery {
            list.locator(id::METATRAFFIC_UNICAST_LOCATOR, locator);
        }
        for &locator in &self.user {
            list.locator(id::DEFAULT_UNICAST_LOCATOR, locator);
        }
        list.end();
        payload
    }
}

/// The message by which a participant says that it is gone.
pub(crate) fn encode_key(guid: Guid) -> Vec<u8> {
    let mut payload = ENCAPSULATION.to_vec();
    List(&mut payload).guid(id::PARTICIPANT_GUID, guid).end();
    payload
}

/// The participant or endpoint that a payload names which is a key alone.
pub(crate) fn key(payload: &[u8], id: u16) -> Option<Guid> {
    let mut list = parameters::of_payload(payload)?;
    while let Some((found, mut value)) = list.next().ok()? {
        if found == id {
            return value.guid();
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_announcement_comes_back_from_its_bytes() {
        let address = |port| SocketAddrV4::new([127, 0, 0, 1].into(), port);
        let announced = Announcement {
            prefix: Prefix([7; 12]),
            discovery: vec![address(7410)],
            user: vec![address(7411), address(7413)],
            lease: LEASE,
            vendor: [1, 15],
        };
        let payload = announced.encode(0, Some(address(7400)), "belvedere");
        assert_eq!(Announcement::decode(&payload), Some(announced));
        for length in 0..payload.len() {
            assert_eq!(Announcement::decode(&payload[..length]), None);
        }
    }
}
