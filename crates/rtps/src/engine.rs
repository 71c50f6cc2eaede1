//! The thread of a participant: it reads every socket, sends all that is due, and knows who else is there.

use std::collections::{BTreeMap, VecDeque};
use std::net::{Ipv4Addr, SocketAddrV4};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

mod discovery;
mod replies;

use crate::guid::{EntityId, Guid, Prefix};
use crate::mailbox::{Inbox, Mailbox, Order, WriterState};
use crate::message::{Content, Encoder, Message, Place};
use crate::peer::Link;
use crate::reader::Reader;
use crate::sedp::Endpoint;
use crate::sockets::{Announced, Sockets};
use crate::spdp::{self, Announcement};
use crate::writer::{Keep, Sample, Writer};

/// How often this participant announces itself: often in the beginning and after a network was down, then every second. A network
/// that was cut without an error, longer than a lease, is noticed by nobody; one second later others know it again.
const ANNOUNCE_FIRST: Duration = Duration::from_millis(100);
const ANNOUNCE: Duration = Duration::from_secs(1);
const ANNOUNCED_OFTEN: u32 = 10;

/// More participants or endpoints than this are not noted, so that a flood of them cannot fill the memory.
const MOST_PARTICIPANTS: usize = 1000;
const MOST_ENDPOINTS: usize = 20_000;

/// The most bytes of what a participant announces of an endpoint.
const MOST_ANNOUNCED: usize = 65_536;

/// At most so many datagrams of a socket are read before what is due is sent.
const READ: usize = 64;

/// Another participant.
#[derive(Debug)]
struct Remote {
    announced: Announcement,
    seen: Instant,
    /// It has answered one of this participant's writers of discovery, so it knows this one.
    knows_this: bool,
    from: Ipv4Addr,
    discovery: SocketAddrV4,
}

#[derive(Debug)]
struct OwnWriter {
    endpoint: Endpoint,
    writer: Writer,
    state: Arc<WriterState>,
}

#[derive(Debug)]
struct OwnReader {
    endpoint: Endpoint,
    reader: Reader,
    inbox: Inbox,
}

/// A reply of a service that waits.
#[derive(Debug)]
struct Held {
    writer: EntityId,
    sample: Sample,
    /// When it is sent to whoever is there.
    until: Instant,
}

/// What the thread of a participant knows.
#[derive(Debug)]
pub(crate) struct Engine {
    prefix: Prefix,
    sockets: Sockets,
    mailbox: Arc<Mailbox>,
    /// What this participant announces of itself.
    announcement: Vec<u8>,
    /// How often it has been announced.
    announced: u32,
    /// A network could not be sent to.
    is_down: bool,
    announce_due: Instant,
    participants: BTreeMap<Prefix, Remote>,
    endpoints: BTreeMap<Guid, (Endpoint, bool)>,
    publications: Writer,
    subscriptions: Writer,
    publications_reader: Reader,
    subscriptions_reader: Reader,
    writers: BTreeMap<EntityId, OwnWriter>,
    readers: BTreeMap<EntityId, OwnReader>,
    /// Replies of services that wait for their clients.
    held: VecDeque<Held>,
}

impl Engine {
    pub(crate) fn new(
        prefix: Prefix,
        sockets: Sockets,
        mailbox: Arc<Mailbox>,
        announcement: Vec<u8>,
    ) -> Engine {
        let now = Instant::now();
        let writer = |entity| Writer::new(Guid::new(prefix, entity), Keep::LastOfKey, true, now);
        let reader = |entity| Reader::new(Guid::new(prefix, entity), true, true, MOST_ANNOUNCED);
        Engine {
            prefix,
            sockets,
            mailbox,
            announcement,
            announced: 0,
            is_down: false,
            announce_due: now,
            participants: BTreeMap::new(),
            endpoints: BTreeMap::new(),
            publications: writer(EntityId::PUBLICATIONS_WRITER),
            subscriptions: writer(EntityId::SUBSCRIPTIONS_WRITER),
            publications_reader: reader(EntityId::PUBLICATIONS_READER),
            subscriptions_reader: reader(EntityId::SUBSCRIPTIONS_READER),
            writers: BTreeMap::new(),
            readers: BTreeMap::new(),
            held: VecDeque::new(),
        }
    }

    /// Works until it is told to stop.
    pub(crate) fn run(mut self) {
        let mut buffer = vec![0; 65_536];
        loop {
            let now = Instant::now();
            let timeout = self.due().saturating_duration_since(now);
            let mut datagrams = Vec::new();
            self.sockets.wait(&self.mailbox.waker, timeout, READ, &mut buffer, |datagram, from| {
                datagrams.push((datagram.to_vec(), from));
            });
            let now = Instant::now();
            for (datagram, from) in datagrams {
                self.datagram(&datagram, *from.ip(), now);
            }
            for order in self.mailbox.take() {
                if matches!(order, Order::Stop) {
                    return self.leave();
                }
                self.order(order, now);
            }
            self.work(now);
        }
    }

    fn all_writers(&mut self) -> impl Iterator<Item = &mut Writer> {
        let own = self.writers.values_mut().map(|own| &mut own.writer);
        [&mut self.publications, &mut self.subscriptions].into_iter().chain(own)
    }

    fn due(&mut self) -> Instant {
        let announce = self.announce_due;
        let held = self.held.front().map(|held| held.until);
        let others = [announce].into_iter().chain(held);
        self.all_writers().filter_map(|writer| writer.due()).chain(others).min().unwrap_or(announce)
    }

    /// Sends what is due.
    fn work(&mut self, now: Instant) {
        self.send_held(now);
        let mut link = &self.sockets;
        let own = self.writers.values_mut().map(|own| &mut own.writer);
        for writer in [&mut self.publications, &mut self.subscriptions].into_iter().chain(own) {
            writer.step(now, &mut link);
        }
        if self.announce_due <= now {
            let datagram = self.announcement_to(Prefix::UNKNOWN, false);
            let reached = self.sockets.announce(&datagram);
            self.mailbox.is_cut.store(reached == Announced::Nowhere, Ordering::Relaxed);
            let is_down = reached != Announced::Everywhere;
            let is_mended = std::mem::replace(&mut self.is_down, is_down) && !is_down;
            self.announced = if is_mended { 0 } else { self.announced.saturating_add(1) };
            let often = self.announced < ANNOUNCED_OFTEN;
            self.announce_due = now + if often { ANNOUNCE_FIRST } else { ANNOUNCE };
            // A peer may come at any time, and its network need not carry multicast.
            for peer in self.sockets.neighbours().filter(|_| often).chain(self.sockets.peers()) {
                (&self.sockets).send(peer, [&datagram, &[], &[]]);
            }
            let mut link = &self.sockets;
            self.publications_reader.ask_again(&mut link);
            self.subscriptions_reader.ask_again(&mut link);
            for own in self.readers.values_mut() {
                own.reader.ask_again(&mut link);
            }
            let silent =
                |remote: &Remote| now.saturating_duration_since(remote.seen) > remote.announced.lease;
            let gone = self.participants.iter().filter(|(_, remote)| silent(remote));
            for prefix in gone.map(|(prefix, _)| *prefix).collect::<Vec<_>>() {
                self.forget(prefix);
            }
        }
    }

    /// Says that this participant is gone.
    fn leave(self) {
        self.mailbox.close();
        let datagram = self.announcement_to(Prefix::UNKNOWN, true);
        self.sockets.announce(&datagram);
        for remote in self.participants.values() {
            (&self.sockets).send(remote.discovery, [&datagram, &[], &[]]);
        }
    }

    /// The datagram that announces this participant, to one participant or to all.
    fn announcement_to(&self, to: Prefix, disposed: bool) -> Vec<u8> {
        let mut datagram = Vec::new();
        let place = Place { reader: EntityId::UNKNOWN, writer: EntityId::SPDP_WRITER };
        let key = Guid::new(self.prefix, EntityId::PARTICIPANT);
        let only_key = spdp::encode_key(key);
        let payload = if disposed { &only_key } else { &self.announcement };
        // The announcement does not change, so it keeps its number; that this participant leaves is the second one.
        Encoder::new(&mut datagram, self.prefix, to).keyed(
            place,
            1 + i64::from(disposed),
            key,
            disposed,
            payload,
        );
        datagram
    }

    fn order(&mut self, order: Order, now: Instant) {
        match order {
            Order::AddWriter(endpoint, state) => {
                let keep = Keep::Last(endpoint.depth as usize);
                let writer = Writer::new(endpoint.guid, keep, endpoint.transient, now);
                self.publications.write(announced(&endpoint), now);
                let entity = endpoint.guid.entity;
                self.writers.insert(entity, OwnWriter { endpoint, writer, state });
                let readers: Vec<Endpoint> = self.remote(false);
                for reader in &readers {
                    self.found_reader(reader, now);
                }
            }
            Order::AddReader(endpoint, inbox) => {
                let reader = Reader::new(endpoint.guid, endpoint.reliable, endpoint.transient, inbox.limit());
                self.subscriptions.write(announced(&endpoint), now);
                let entity = endpoint.guid.entity;
                self.readers.insert(entity, OwnReader { endpoint, reader, inbox });
                let writers: Vec<Endpoint> = self.remote(true);
                for writer in &writers {
                    self.found_writer(writer);
                }
            }
            Order::Remove(entity) => {
                let guid = Guid::new(self.prefix, entity);
                let sample = Sample::keyed(Endpoint::encode_key(guid), guid, true);
                if self.writers.remove(&entity).is_some() {
                    self.publications.write(sample, now);
                } else if self.readers.remove(&entity).is_some() {
                    self.subscriptions.write(sample, now);
                }
            }
            Order::Write(entity, payload, time) => {
                let Some(own) = self.writers.get_mut(&entity) else { return };
                for buffer in own.writer.write(Sample::plain(payload, time), now) {
                    if let Some(buffer) = Arc::into_inner(buffer) {
                        own.state.give_back(buffer);
                    }
                }
            }
            Order::Reply(entity, sample) => self.hold(entity, sample, now),
            Order::Stop => {}
        }
    }

    fn remote(&self, writes: bool) -> Vec<Endpoint> {
        let endpoints = self.endpoints.values().filter(|(_, is_writer)| *is_writer == writes);
        endpoints.map(|(endpoint, _)| endpoint.clone()).collect()
    }

    fn datagram(&mut self, datagram: &[u8], from: Ipv4Addr, now: Instant) {
        let Some(mut message) = Message::new(datagram) else { return };
        while let Some(said) = message.next() {
            let (source, vendor, destination) = (message.source, message.vendor, message.destination);
            if source == self.prefix || ![Prefix::UNKNOWN, self.prefix].contains(&destination) {
                continue;
            }
            let writer = Guid::new(source, said.writer);
            if said.writer == EntityId::SPDP_WRITER {
                if !self.sockets.is_off()
                    && let Content::Data { about, payload, .. } = said.content
                {
                    self.announcement(writer, about, payload, from, now);
                }
                continue;
            }
            let Some(remote) = self.participants.get_mut(&source) else { continue };
            remote.seen = now;
            match said.content {
                Content::AckNack { .. } | Content::NackFragments { .. } => {
                    self.answered(said.writer, Guid::new(source, said.reader), &said.content, now);
                }
                content => self.written(writer, vendor, said.reader, &content, now),
            }
        }
    }

    /// A reader of another participant says what it has.
    fn answered(&mut self, writer: EntityId, reader: Guid, content: &Content<'_>, now: Instant) {
        if let Some(remote) = self.participants.get_mut(&reader.prefix)
            && [EntityId::PUBLICATIONS_WRITER, EntityId::SUBSCRIPTIONS_WRITER].contains(&writer)
        {
            remote.knows_this = true;
        }
        let writer = match writer {
            EntityId::PUBLICATIONS_WRITER => &mut self.publications,
            EntityId::SUBSCRIPTIONS_WRITER => &mut self.subscriptions,
            entity => match self.writers.get_mut(&entity) {
                Some(own) => &mut own.writer,
                None => return,
            },
        };
        match content {
            Content::AckNack { missing, count, .. } => {
                writer.acknack(reader, missing, *count, now, &mut &self.sockets);
            }
            Content::NackFragments { sequence, missing, .. } => {
                writer.nack_fragments(reader, *sequence, *missing, now);
            }
            _ => {}
        }
    }

    /// A writer of another participant says something.
    fn written(
        &mut self,
        writer: Guid,
        vendor: [u8; 2],
        reader: EntityId,
        content: &Content<'_>,
        now: Instant,
    ) {
        let mut link = &self.sockets;
        match writer.entity {
            EntityId::PUBLICATIONS_WRITER => {
                for sample in self.publications_reader.take(writer, content, &mut link) {
                    self.discovered(writer.prefix, &sample, true, now);
                }
            }
            EntityId::SUBSCRIPTIONS_WRITER => {
                for sample in self.subscriptions_reader.take(writer, content, &mut link) {
                    self.discovered(writer.prefix, &sample, false, now);
                }
            }
            _ => {
                for own in self.readers.values_mut() {
                    if ![EntityId::UNKNOWN, own.reader.entity()].contains(&reader) {
                        continue;
                    }
                    for sample in own.reader.take(writer, content, &mut link) {
                        // What is disposed has no value.
                        if !sample.about.disposed && !sample.about.is_key {
                            own.inbox.push(writer, vendor, sample);
                        }
                    }
                }
            }
        }
    }
}

/// The sample of discovery that announces an endpoint.
fn announced(endpoint: &Endpoint) -> Sample {
    Sample::keyed(endpoint.encode(), endpoint.guid, false)
}
