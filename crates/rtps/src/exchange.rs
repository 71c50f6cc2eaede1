//! A writer and a reader over a link that loses datagrams, in a time of its own.

use std::collections::VecDeque;
use std::net::{Ipv4Addr, SocketAddrV4};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::answer::Answer;
use crate::guid::{EntityId, Guid, Prefix, SampleIdentity};
use crate::message::{Content, Encoder, Message, Place};
use crate::numbers::NumberSet;
use crate::peer::{Link, Peer};
use crate::reader::Reader;
use crate::spdp::UNKNOWN_VENDOR;
use crate::writer::{Keep, Sample, Writer};

const WRITER: Guid = Guid { prefix: Prefix([1; 12]), entity: EntityId([0, 0, 1, 3]) };
const READER: Guid = Guid { prefix: Prefix([2; 12]), entity: EntityId([0, 0, 1, 4]) };
const ADDRESS: SocketAddrV4 = SocketAddrV4::new(Ipv4Addr::LOCALHOST, 7411);

/// Keeps what is sent, but for what it loses: the share `lost` of 100.
struct Lossy {
    sent: VecDeque<Vec<u8>>,
    /// Only what is sent to this address is kept; `None` for all.
    to: Option<SocketAddrV4>,
    lost: u64,
    random: u64,
}

impl Link for Lossy {
    fn send(&mut self, to: SocketAddrV4, parts: [&[u8]; 3]) {
        self.random =
            self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        if (self.random >> 33) % 100 >= self.lost && self.to.is_none_or(|only| only == to) {
            self.sent.push_back(parts.concat());
        }
    }
}

/// Both ends of a topic, and the way between them.
struct Exchange {
    now: Instant,
    writer: Writer,
    reader: Reader,
    link: Lossy,
    /// The first byte behind the header of each sample that came, and its length.
    came: Vec<(u8, usize)>,
}

impl Exchange {
    fn new(reliable: bool, depth: usize, lost: u64) -> Exchange {
        let now = Instant::now();
        Exchange {
            now,
            writer: Writer::new(WRITER, Keep::Last(depth), true, now),
            reader: Reader::new(READER, reliable, true, 1 << 20),
            link: Lossy { sent: VecDeque::new(), to: None, lost, random: 7 },
            came: Vec::new(),
        }
    }

    fn join(&mut self, reliable: bool) {
        let peer = |guid| Peer { guid, address: ADDRESS, reliable, transient: true, vendor: UNKNOWN_VENDOR };
        self.writer.match_reader(peer(READER), self.now);
        self.reader.match_writer(peer(WRITER), &mut self.link);
    }

    fn write(&mut self, number: u8, length: usize) {
        let mut payload = vec![number; length];
        payload[..4].copy_from_slice(&[0, 1, 0, 0]);
        self.writer.write(Sample::plain(Arc::new(payload), Duration::ZERO), self.now);
    }

    /// Lets time pass, in steps of a tenth of a millisecond.
    fn pass(&mut self, time: Duration) {
        let end = self.now + time;
        while self.now < end {
            self.now += Duration::from_micros(100);
            if self.writer.due().is_some_and(|due| due <= self.now) {
                self.writer.step(self.now, &mut self.link);
            }
            while let Some(datagram) = self.link.sent.pop_front() {
                self.deliver(&datagram);
            }
        }
    }

    fn deliver(&mut self, datagram: &[u8]) {
        let mut message = Message::new(datagram).expect("a datagram of this crate");
        let mut said = 0;
        while let Some(submessage) = message.next() {
            said += 1;
            match &submessage.content {
                Content::AckNack { missing, count, .. } => {
                    self.writer.acknack(READER, missing, *count, self.now, &mut self.link);
                }
                Content::NackFragments { sequence, missing, .. } => {
                    self.writer.nack_fragments(READER, *sequence, *missing, self.now);
                }
                content => {
                    let taken = self.reader.take(WRITER, content, &mut self.link);
                    for sample in taken.into_iter().filter(|sample| !sample.is_too_large) {
                        let number = sample.payload[4];
                        assert!(sample.payload[4..].iter().all(|&byte| byte == number));
                        self.came.push((number, sample.payload.len()));
                    }
                }
            }
        }
        assert!(said > 0, "an empty datagram");
    }
}

#[test]
fn a_reliable_reader_gets_everything_in_order_over_a_bad_link() {
    for lost in [0, 1, 10, 30] {
        let mut exchange = Exchange::new(true, 100, lost);
        exchange.join(true);
        let mut wanted = Vec::new();
        for number in 0..60 {
            let length = if number % 3 == 0 { 300_000 } else { 100 };
            exchange.write(number, length);
            wanted.push((number, length));
            exchange.pass(Duration::from_millis(10));
        }
        exchange.pass(Duration::from_secs(20));
        assert_eq!(exchange.came, wanted, "{lost} of 100 lost");
        assert_eq!(exchange.writer.due(), None, "the writer has nothing more to do");
    }
}

#[test]
fn a_reader_that_is_slow_goes_on_with_what_is_kept() {
    let mut exchange = Exchange::new(true, 3, 100);
    exchange.join(true);
    for number in 0..20 {
        exchange.write(number, 300_000);
        exchange.pass(Duration::from_millis(30));
    }
    assert_eq!(exchange.came, []);
    exchange.link.lost = 0;
    exchange.pass(Duration::from_secs(5));
    assert_eq!(exchange.came, [(17, 300_000), (18, 300_000), (19, 300_000)]);
}

#[test]
fn a_late_reader_gets_the_history() {
    let mut exchange = Exchange::new(true, 2, 20);
    for number in 0..5 {
        exchange.write(number, 150_000);
        exchange.pass(Duration::from_millis(30));
    }
    exchange.join(true);
    exchange.pass(Duration::from_secs(5));
    assert_eq!(exchange.came, [(3, 150_000), (4, 150_000)]);
    exchange.write(5, 8);
    exchange.pass(Duration::from_secs(5));
    assert_eq!(exchange.came.last(), Some(&(5, 8)));
}

#[test]
fn a_reader_that_has_forgotten_its_writer_gets_the_history_again() {
    let mut exchange = Exchange::new(true, 2, 0);
    exchange.join(true);
    for number in 0..5 {
        exchange.write(number, 100);
        exchange.pass(Duration::from_millis(30));
    }
    exchange.came.clear();
    exchange.reader = Reader::new(READER, true, true, 1 << 20);
    let writer =
        Peer { guid: WRITER, address: ADDRESS, reliable: true, transient: true, vendor: UNKNOWN_VENDOR };
    exchange.reader.match_writer(writer, &mut exchange.link);
    exchange.pass(Duration::from_secs(1));
    assert_eq!(exchange.came, [(3, 100), (4, 100)]);
}

#[test]
fn best_effort_loses_what_is_lost_and_no_more() {
    let mut exchange = Exchange::new(false, 5, 0);
    exchange.join(false);
    for number in 0..10 {
        exchange.write(number, 300_000);
        exchange.pass(Duration::from_millis(30));
        exchange.link.lost = if number == 4 { 100 } else { 0 };
    }
    let came: Vec<u8> = exchange.came.iter().map(|(number, _)| *number).collect();
    assert_eq!(came, [0, 1, 2, 3, 4, 6, 7, 8, 9]);
    assert_eq!(exchange.writer.due(), None);
}

#[test]
fn a_sample_that_is_too_large_is_not_assembled_and_those_behind_it_come() {
    for reliable in [false, true] {
        let mut exchange = Exchange::new(reliable, 5, 0);
        exchange.join(reliable);
        exchange.write(1, (1 << 20) + 4);
        exchange.pass(Duration::from_millis(100));
        exchange.write(2, 1 << 20);
        exchange.pass(Duration::from_millis(100));
        assert_eq!(exchange.came, [(2, 1 << 20)], "{reliable}");
        assert_eq!(exchange.writer.due(), None, "the writer has nothing more to do");
    }
}

#[test]
fn what_is_kept_for_later_is_bounded_and_comes_nevertheless() {
    let mut exchange = Exchange::new(true, 300, 0);
    exchange.join(true);
    exchange.pass(Duration::from_millis(1));
    let head = |number: i64| {
        let mut datagram = Vec::new();
        let place = Place { reader: READER.entity, writer: WRITER.entity };
        Encoder::new(&mut datagram, WRITER.prefix, READER.prefix).data(place, number, None, 40_000);
        datagram.resize(datagram.len() + 40_000, number as u8);
        datagram
    };
    for number in (2..=300).rev() {
        exchange.deliver(&head(number));
    }
    let (kept, most) = (exchange.reader.kept(), exchange.reader.most_kept());
    assert!(kept <= most && kept > most - 40_000, "{kept} of {most}");
    assert_eq!(exchange.came, []);
    for number in 1..=300 {
        exchange.deliver(&head(number));
    }
    assert_eq!(exchange.came, (1..=300).map(|number| (number as u8, 40_000)).collect::<Vec<_>>());
    assert_eq!(exchange.reader.kept(), 0);
}

/// A reply names its request in every datagram, and goes to its client alone: another one is told that there is a gap.
#[test]
fn a_reply_goes_to_its_client_alone() {
    let other = Guid { prefix: Prefix([3; 12]), ..READER };
    let related = SampleIdentity { writer: READER, sequence: 12 };
    for length in [8, 150_000] {
        let mut exchange = Exchange::new(true, 10, 0);
        exchange.join(true);
        let address = SocketAddrV4::new(Ipv4Addr::LOCALHOST, 7413);
        let peer = Peer { guid: other, address, reliable: true, transient: false, vendor: UNKNOWN_VENDOR };
        exchange.writer.match_reader(peer, exchange.now);
        exchange.link.sent.clear();
        let answer =
            Answer { client: READER.prefix, reader: Some(READER), related: Some(related), header: None };
        let sample = Sample::plain(Arc::new(vec![0; length]), Duration::ZERO);
        exchange.writer.write(Sample { answer: Some(answer), ..sample }, exchange.now);
        let mut parts = 0;
        for _ in 0..100 {
            exchange.now += Duration::from_millis(1);
            exchange.writer.step(exchange.now, &mut exchange.link);
            for datagram in exchange.link.sent.drain(..) {
                let mut message = Message::new(&datagram).expect("a datagram of this crate");
                while let Some(said) = message.next() {
                    if let Content::Data { about, .. } | Content::Fragments { about, .. } = said.content {
                        assert_eq!((message.destination, about.related), (READER.prefix, Some(related)));
                        parts += 1;
                    }
                }
            }
        }
        assert_eq!(parts, usize::div_ceil(length, 64_000));
        exchange.writer.acknack(other, &NumberSet::of(1, [1]), 1, exchange.now, &mut exchange.link);
        exchange.writer.step(exchange.now, &mut exchange.link);
        let gap = exchange.link.sent.pop_front().expect("an answer");
        let mut message = Message::new(&gap).expect("a datagram of this crate");
        let said = message.next().map(|said| said.content);
        assert_eq!(said, Some(Content::Gap { start: 1, list: NumberSet::empty(2) }));
        assert_eq!(message.destination, other.prefix);
    }
}

/// A reader that is best effort slows the samples down for all, from when it is there until it is gone.
#[test]
fn samples_are_sent_faster_if_all_readers_are_reliable() {
    /// Milliseconds that the last of some pictures took, 30 of which are written per second.
    fn time(exchange: &mut Exchange) -> f64 {
        let mut taken = Duration::ZERO;
        for number in 0..30 {
            let (begin, before) = (exchange.now, exchange.came.len());
            exchange.write(number, 921_600);
            while exchange.came.len() == before && exchange.now < begin + Duration::from_millis(30) {
                exchange.pass(Duration::from_micros(100));
            }
            taken = exchange.now - begin;
            exchange.pass(Duration::from_millis(33).saturating_sub(taken));
        }
        taken.as_secs_f64() * 1e3
    }
    let mut exchange = Exchange::new(true, 2, 0);
    exchange.join(true);
    let alone = time(&mut exchange);
    let guid = Guid { prefix: Prefix([3; 12]), ..READER };
    let address = SocketAddrV4::new(Ipv4Addr::LOCALHOST, 7413);
    let peer = Peer { guid, address, reliable: false, transient: false, vendor: UNKNOWN_VENDOR };
    exchange.writer.match_reader(peer, exchange.now);
    // What is sent to the second one would arrive at the first one, too.
    exchange.link.to = Some(ADDRESS);
    let beside = time(&mut exchange);
    exchange.writer.unmatch(guid);
    let again = time(&mut exchange);
    assert!(alone < 7.0 && (7.5..9.5).contains(&beside) && again < 7.0, "{alone} {beside} {again}");
}
