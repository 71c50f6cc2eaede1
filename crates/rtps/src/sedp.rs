//! What participants announce of their readers and writers (8.5.4), and which of them fit together.

use std::net::SocketAddrV4;
use std::time::Duration;

use crate::guid::{EntityId, Guid};
use crate::parameters::{self, ENCAPSULATION, List, id};
use crate::spdp::MOST_LOCATORS;

/// A reader or writer, as its participant announces it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Endpoint {
    pub(crate) guid: Guid,
    pub(crate) topic: String,
    pub(crate) type_name: String,
    pub(crate) reliable: bool,
    /// A reader that joins late gets the history.
    pub(crate) transient: bool,
    pub(crate) depth: u32,
    /// A reader asks for a sample at least so often.
    pub(crate) deadline: Duration,
    /// A reader asks that writers show that they are alive so often.
    pub(crate) liveliness: Duration,
    /// Where it listens, if that is not where its participant does.
    pub(crate) locators: Vec<SocketAddrV4>,
    /// ROS 2 puts the hash of the type here.
    pub(crate) user_data: Vec<u8>,
}

impl Endpoint {
    /// One with the values that hold for what is not announced. `writes` because the standard's value of
    /// reliability is another one for writers.
    fn unnamed(writes: bool) -> Endpoint {
        Endpoint {
            guid: Guid::of([0; 16]),
            topic: String::new(),
            type_name: String::new(),
            reliable: writes,
            transient: false,
            depth: 1,
            deadline: Duration::MAX,
            liveliness: Duration::MAX,
            locators: Vec::new(),
            user_data: Vec::new(),
        }
    }

    /// Reads what is announced of a writer, if `writes`, or of a reader; `None` if it is malformed or lacks a name.
    pub(crate) fn decode(payload: &[u8], writes: bool) -> Option<Endpoint> {
        let mut list = parameters::of_payload(payload)?;
        let mut endpoint = Endpoint::unnamed(writes);
        let mut named = [false; 3];
        while let Some((id, mut value)) = list.next().ok()? {
            match id {
                id::ENDPOINT_GUID => (endpoint.guid, named[0]) = (value.guid()?, true),
                id::TOPIC_NAME => (endpoint.topic, named[1]) = (value.string()?, true),
                id::TYPE_NAME => (endpoint.type_name, named[2]) = (value.string()?, true),
                id::RELIABILITY => endpoint.reliable = value.u32()? == 2,
                id::DURABILITY => endpoint.transient = value.u32()? >= 1,
                id::DEADLINE => endpoint.deadline = parameters::duration(&mut value)?,
                id::LIVELINESS => {
                    value.u32()?;
                    endpoint.liveliness = parameters::duration(&mut value)?;
                }
                id::UNICAST_LOCATOR if endpoint.locators.len() < MOST_LOCATORS => {
                    endpoint.locators.extend(parameters::locator(&mut value));
                }
                id::HISTORY => endpoint.depth = value.take(4).and(value.u32())?,
                id::USER_DATA => {
                    let length = value.u32()? as usize;
                    endpoint.user_data = value.take(length)?.to_vec();
                }
                _ => {}
            }
        }
        (named == [true; 3]).then_some(endpoint)
    }

    /// What is announced.
    pub(crate) fn encode(&self) -> Vec<u8> {
        let mut payload = ENCAPSULATION.to_vec();
        let mut list = List(&mut payload);
        list.guid(id::ENDPOINT_GUID, self.guid)
            .guid(id::PARTICIPANT_GUID, Guid::new(self.guid.prefix, EntityId::PARTICIPANT))
            .string(id::TOPIC_NAME, &self.topic)
            .string(id::TYPE_NAME, &self.type_name)
            // How long a write may block: never at all, but 100 ms is what everyone says.
            .numbers_and_duration(
                id::RELIABILITY,
                &[1 + u32::from(self.reliable)],
                Duration::from_millis(100),
            )
            .number(id::DURABILITY, u32::from(self.transient))
            .numbers_and_duration(id::DEADLINE, &[], self.deadline)
            .numbers_and_duration(id::LIVELINESS, &[0], self.liveliness)
            .bytes(id::HISTORY, &[[0; 4], self.depth.to_le_bytes()].concat());
        for &locator in &self.locators {
            list.locator(id::UNICAST_LOCATOR, locator);
        }
        if !self.user_data.is_empty() {
            list.counted(id::USER_DATA, &self.user_data);
        }
        list.end();
        payload
    }

    /// The message by which a reader or writer is said to be gone.
    pub(crate) fn encode_key(guid: Guid) -> Vec<u8> {
        let mut payload = ENCAPSULATION.to_vec();
        List(&mut payload).guid(id::ENDPOINT_GUID, guid).end();
        payload
    }

    /// Does this writer give the reader what it asks for?
    pub(crate) fn serves(&self, reader: &Endpoint) -> bool {
        self.topic == reader.topic
            && self.type_name == reader.type_name
            && self.reliable >= reader.reliable
            && self.transient >= reader.transient
            && self.deadline <= reader.deadline
            && self.liveliness <= reader.liveliness
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn writer() -> Endpoint {
        Endpoint {
            guid: Guid::of([5; 16]),
            topic: "rt/scan".to_owned(),
            type_name: "sensor_msgs::msg::dds_::LaserScan_".to_owned(),
            reliable: true,
            depth: 5,
            locators: vec![SocketAddrV4::new([10, 0, 0, 7].into(), 7411)],
            user_data: b"typehash=RIHS01_00;".to_vec(),
            ..Endpoint::unnamed(true)
        }
    }

    #[test]
    fn an_endpoint_comes_back_from_its_bytes() {
        let payload = writer().encode();
        assert_eq!(Endpoint::decode(&payload, true), Some(writer()));
        for length in 0..payload.len() {
            assert_eq!(Endpoint::decode(&payload[..length], true), None);
        }
    }

    #[test]
    fn a_writer_serves_those_who_ask_for_no_more() {
        let same = writer();
        assert!(writer().serves(&same));
        assert!(writer().serves(&Endpoint { reliable: false, ..same.clone() }));
        assert!(!Endpoint { reliable: false, ..writer() }.serves(&same));
        assert!(!writer().serves(&Endpoint { transient: true, ..same.clone() }));
        assert!(!writer().serves(&Endpoint { deadline: Duration::from_secs(1), ..same.clone() }));
        assert!(!writer().serves(&Endpoint { topic: "rt/scan2".to_owned(), ..same }));
    }
}
