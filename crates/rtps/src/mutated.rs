//! A million datagrams that are nearly right: whatever comes, nothing panics, and nothing grows without a bound.

use std::net::{Ipv4Addr, SocketAddrV4};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::answer::Answer;
use crate::guid::{EntityId, Guid, Prefix, SampleIdentity};
use crate::message::{Content, Encoder, Message, Place};
use crate::numbers::NumberSet;
use crate::peer::{Link, Peer};
use crate::reader::Reader;
use crate::requests::{Request, Requests};
use crate::sedp::Endpoint;
use crate::spdp::{Announcement, CYCLONE, FAST_DDS, LEASE};
use crate::writer::{Keep, Sample, Writer};

const PREFIX: Prefix = Prefix([1; 12]);
const WRITER: Guid = Guid { prefix: PREFIX, entity: EntityId([0, 0, 1, 3]) };
const READER: Guid = Guid { prefix: Prefix([2; 12]), entity: EntityId([0, 0, 1, 4]) };
const ADDRESS: SocketAddrV4 = SocketAddrV4::new(Ipv4Addr::LOCALHOST, 7411);

/// Counts what would be sent.
struct Counter(usize);

impl Link for Counter {
    fn send(&mut self, _to: SocketAddrV4, parts: [&[u8]; 3]) {
        let length: usize = parts.iter().map(|part| part.len()).sum();
        assert!(length <= 65_507, "a datagram of {length} bytes");
        self.0 += 1;
    }
}

struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end.max(1) as u64) as usize
    }
}

/// A datagram of each kind.
fn datagrams() -> Vec<Vec<u8>> {
    let place = Place { reader: READER.entity, writer: WRITER.entity };
    let (discovery, user) = (vec![ADDRESS], vec![ADDRESS; 3]);
    let announcement = Announcement { prefix: PREFIX, discovery, user, lease: LEASE, vendor: FAST_DDS };
    let announcement = announcement.encode(0, Some(ADDRESS), "belvedere");
    let endpoint = Endpoint::decode(&endpoint(), true).expect("an endpoint").encode();
    let one = |write: &dyn Fn(&mut Encoder<'_>)| {
        let mut datagram = Vec::new();
        write(&mut Encoder::new(&mut datagram, PREFIX, READER.prefix));
        datagram
    };
    let client = Some(SampleIdentity { writer: WRITER, sequence: 0 });
    let mut fragment = one(&|to| to.fragments(place, 3, None, (2, 1, 400), 1000, 400));
    fragment.extend_from_slice(&[7; 400]);
    let mut request_fragment = one(&|to| to.fragments(place, 3, client, (1, 1, 400), 400, 400));
    request_fragment.extend_from_slice(&[7; 400]);
    let data = |related| {
        let mut sample = one(&|to| {
            to.time(Duration::new(1, 5));
            to.data(place, 2, related, 40);
        });
        sample.extend_from_slice(&[7; 40]);
        sample
    };
    let mut request_of_cyclone = data(None);
    request_of_cyclone[6..8].copy_from_slice(&CYCLONE);
    vec![
        one(&|to| to.keyed(place, 1, WRITER, false, &announcement)),
        one(&|to| to.keyed(place, 1, WRITER, true, &Endpoint::encode_key(WRITER))),
        one(&|to| to.keyed(place, 1, WRITER, false, &endpoint)),
        fragment,
        request_fragment,
        data(None),
        data(client),
        request_of_cyclone,
        one(&|to| to.heartbeat(place, 1, 9, 4)),
        one(&|to| to.gap(place, 1, 7)),
        one(&|to| to.acknack(place, &NumberSet::of(3, [3, 5, 200]), 3, false)),
        one(&|to| to.nack_fragments(place, 3, &NumberSet::of(1, [2, 3]), 4)),
    ]
}

fn endpoint() -> Vec<u8> {
    let mut payload = vec![0, 3, 0, 0];
    crate::parameters::List(&mut payload)
        .guid(crate::parameters::id::ENDPOINT_GUID, WRITER)
        .string(crate::parameters::id::TOPIC_NAME, "rt/scan")
        .string(crate::parameters::id::TYPE_NAME, "sensor_msgs::msg::dds_::LaserScan_")
        .end();
    payload
}

/// The sides that a datagram can reach.
struct Sides {
    readers: [Reader; 2],
    writer: Writer,
    requests: Requests,
    link: Counter,
    now: Instant,
}

impl Sides {
    fn new() -> Sides {
        let now = Instant::now();
        let mut sides = Sides {
            readers: [true, false].map(|reliable| Reader::new(READER, reliable, false, 4096)),
            writer: Writer::new(WRITER, Keep::Last(4), true, now),
            requests: Requests::new(),
            link: Counter(0),
            now,
        };
        let peer = |guid| Peer { guid, address: ADDRESS, reliable: true, transient: true, vendor: FAST_DDS };
        for reader in &mut sides.readers {
            reader.match_writer(peer(WRITER), &mut sides.link);
        }
        sides.writer.match_reader(peer(READER), now);
        for length in [8, 200_000, 8, 8] {
            let sample = Sample::plain(Arc::new(vec![0; length]), Duration::ZERO);
            // Those of eight bytes are replies.
            let related = Some(SampleIdentity { writer: READER, sequence: 1 });
            let answer = Answer { client: READER.prefix, reader: Some(READER), related, header: None };
            sides.writer.write(Sample { answer: (length == 8).then_some(answer), ..sample }, now);
        }
        sides
    }

    /// Gives how many samples were taken.
    fn take(&mut self, datagram: &[u8]) -> usize {
        let mut taken = 0;
        let Some(mut message) = Message::new(datagram) else { return 0 };
        while let Some(said) = message.next() {
            match &said.content {
                Content::AckNack { missing, count, .. } => {
                    self.writer.acknack(READER, missing, *count, self.now, &mut self.link);
                }
                Content::NackFragments { sequence, missing, .. } => {
                    self.writer.nack_fragments(READER, *sequence, *missing, self.now);
                }
                content => {
                    if let Content::Data { payload, .. } = content {
                        Announcement::decode(payload);
                        Endpoint::decode(payload, true);
                    }
                    for reader in &mut self.readers {
                        for sample in reader.take(WRITER, content, &mut self.link) {
                            taken += 1;
                            if let Some(request) = Request::of(1, WRITER, message.vendor, sample) {
                                self.requests.push(request);
                            }
                        }
                    }
                }
            }
        }
        assert!(self.readers.iter().all(|reader| reader.kept() <= reader.most_kept()));
        self.now += Duration::from_millis(1);
        self.writer.step(self.now, &mut self.link);
        taken
    }
}

#[test]
fn a_million_mutated_datagrams_are_read() {
    let datagrams = datagrams();
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let mut sides = Sides::new();
    let (mut taken, mut asked) = (0, [0; 3]);
    for number in 0..1_000_000 {
        let mut datagram = datagrams[number % datagrams.len()].clone();
        for _ in 0..random.below(4) {
            let at = random.below(datagram.len());
            match random.below(7) {
                0 => datagram.truncate(at),
                1 if at < datagram.len() => datagram[at] = random.below(256) as u8,
                2 if at < datagram.len() => datagram[at] = [0, 1, 0x7F, 0x80, 0xFF][random.below(5)],
                3 if at < datagram.len() => datagram[at] ^= 1 << random.below(8),
                4 => datagram.extend_from_within(at..),
                5 => {
                    // The largest numbers of all sizes, in both byte orders.
                    let end = (at + 8).min(datagram.len());
                    datagram[at..end].fill(0xFF);
                    if end > at {
                        let top = if random.below(2) == 0 { at } else { at + (end - at - 1).min(3) };
                        datagram[top] = 0x7F;
                    }
                }
                _ => {
                    let other = &datagrams[random.below(datagrams.len())];
                    datagram.extend_from_slice(&other[20.min(other.len())..]);
                }
            }
            datagram.truncate(2000);
        }
        taken += sides.take(&datagram);
        while let Some(request) = sides.requests.take(Duration::ZERO) {
            let kind = if request.answer.header.is_some() {
                2
            } else {
                usize::from(request.answer.reader.is_some())
            };
            asked[kind] += 1;
        }
        if number % 1000 == 0 {
            sides = Sides::new();
        }
    }
    assert!(taken > 1000, "{taken} samples came through");
    assert!(
        asked.iter().all(|count| *count > 100),
        "requests without a name, with one, and of Cyclone: {asked:?}"
    );
    assert!(sides.link.0 > 0, "something was answered");
}
