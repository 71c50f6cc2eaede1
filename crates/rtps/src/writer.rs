//! The writing end of a topic: its history, its readers, and the datagrams that are still to be sent (8.4.9).

use std::collections::{BTreeMap, VecDeque};
use std::net::SocketAddrV4;
use std::sync::Arc;
use std::time::{Duration, Instant};

mod job;

pub(crate) use job::Sample;
use job::{FRAGMENT, Job};

use crate::answer::Answer;
use crate::guid::{EntityId, Guid, Prefix};
use crate::message::{Encoder, Place};
use crate::numbers::NumberSet;
use crate::pacing::Pace;
use crate::peer::{Link, Peer};

/// Readers are told which samples there are, and asked for what they lack: after a sample, but not more often than
/// this, and again until they have answered, less and less often.
const HEARTBEAT_FIRST: Duration = Duration::from_millis(10);
const HEARTBEAT_LAST: Duration = Duration::from_millis(640);

/// A reader that asks twice within this time is answered once.
const REPAIRED: Duration = Duration::from_millis(8);

/// How many samples are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Keep {
    /// The last ones of a topic.
    Last(usize),
    /// The last one for each key, as in discovery.
    LastOfKey,
}

/// What is known of a reader.
#[derive(Debug)]
struct Proxy {
    peer: Peer,
    /// The first sample that it is to get.
    start: i64,
    /// It has all samples up to this one.
    acked: i64,
    answered: Option<u32>,
    repaired: VecDeque<(i64, Instant)>,
}

/// The writing end of a topic.
#[derive(Debug)]
pub(crate) struct Writer {
    guid: Guid,
    keep: Keep,
    transient: bool,
    history: BTreeMap<i64, Sample>,
    /// The number of the next sample.
    next: i64,
    /// All samples up to this one were sent.
    sent: i64,
    readers: BTreeMap<Guid, Proxy>,
    fresh: VecDeque<Job>,
    repairs: VecDeque<Job>,
    pace: Pace,
    heartbeats: u32,
    heartbeat_due: Option<Instant>,
    heartbeat_wait: Duration,
    heartbeat_sent: Option<Instant>,
    head: Vec<u8>,
    tail: Vec<u8>,
}

impl Writer {
    pub(crate) fn new(guid: Guid, keep: Keep, transient: bool, now: Instant) -> Writer {
        Writer {
            guid,
            keep,
            transient,
            history: BTreeMap::new(),
            next: 1,
            sent: 0,
            readers: BTreeMap::new(),
            fresh: VecDeque::new(),
            repairs: VecDeque::new(),
            pace: Pace::new(now),
            heartbeats: 0,
            heartbeat_due: None,
            heartbeat_wait: HEARTBEAT_FIRST,
            heartbeat_sent: None,
            head: Vec::new(),
            tail: Vec::new(),
        }
    }

    pub(crate) fn readers(&self) -> usize {
        self.readers.len()
    }

    /// Has the client's reader shown that it knows this writer? One that is best effort never says anything.
    pub(crate) fn is_heard_by(&self, client: Answer) -> bool {
        let is_it = |guid: Guid| client.reader.map_or(guid.prefix == client.client, |reader| reader == guid);
        let mut readers = self.readers.values().filter(|proxy| is_it(proxy.peer.guid));
        readers.any(|proxy| proxy.answered.is_some() || !proxy.peer.reliable)
    }

    /// Adds a sample. Gives back the buffers of samples that are no longer needed.
    pub(crate) fn write(&mut self, sample: Sample, now: Instant) -> Vec<Arc<Vec<u8>>> {
        let sequence = self.next;
        self.next += 1;
        self.pace.written(now);
        let mut dropped = Vec::new();
        match self.keep {
            Keep::Last(depth) => {
                while self.history.len() >= depth.max(1) {
                    dropped.extend(self.history.pop_first());
                }
            }
            Keep::LastOfKey => {
                let key = sample.key.map(|(key, _)| key);
                let of_key = |old: &Sample| old.key.map(|(key, _)| key) == key;
                let old = self.history.iter().find(|(_, old)| of_key(old)).map(|(&sequence, _)| sequence);
                dropped.extend(old.and_then(|old| self.history.remove_entry(&old)));
            }
        }
        let gone = |job: &Job| dropped.iter().any(|(sequence, _)| *sequence == job.sequence);
        // A sample of which a part was sent is finished.
        self.fresh.retain(|job| job.next > 0 || !gone(job));
        self.repairs.retain(|job| job.next > 0 || !gone(job));
        if self.readers.is_empty() {
            self.sent = sequence;
        } else {
            self.fresh.push_back(Job { sequence, sample: sample.clone(), reader: None, only: None, next: 0 });
        }
        self.history.insert(sequence, sample);
        dropped.into_iter().map(|(_, sample)| sample.payload).collect()
    }

    /// Matches a reader, or changes where one that is matched listens. Gives whether it is new.
    pub(crate) fn match_reader(&mut self, peer: Peer, now: Instant) -> bool {
        if let Some(known) = self.readers.get_mut(&peer.guid) {
            known.peer = peer;
            self.set_pace();
            return false;
        }
        let history = self.transient && peer.transient;
        let start = if history { 1 } else { self.next };
        let proxy = Proxy { peer, start, acked: start - 1, answered: None, repaired: VecDeque::new() };
        self.readers.insert(peer.guid, proxy);
        self.set_pace();
        if history && peer.reliable {
            for (&sequence, sample) in self.history.range(..=self.sent) {
                let reader = Some(peer.guid);
                self.repairs.push_back(Job { sequence, sample: sample.clone(), reader, only: None, next: 0 });
            }
        }
        if peer.reliable {
            self.hurry(now);
        }
        true
    }

    /// Forgets a reader. Gives whether there was one.
    pub(crate) fn unmatch(&mut self, guid: Guid) -> bool {
        self.repairs.retain(|job| job.reader != Some(guid));
        let found = self.readers.remove(&guid).is_some();
        self.set_pace();
        if self.readers.is_empty() {
            self.fresh.clear();
            self.sent = self.next - 1;
            self.heartbeat_due = None;
        }
        found
    }

    fn set_pace(&mut self) {
        self.pace.readers(self.readers.values().all(|proxy| proxy.peer.reliable));
    }

    /// Forgets the readers of a participant.
    pub(crate) fn unmatch_all(&mut self, prefix: Prefix) {
        let gone: Vec<Guid> = self.readers.keys().copied().filter(|guid| guid.prefix == prefix).collect();
        for guid in gone {
            self.unmatch(guid);
        }
    }

    /// A reader says which samples it has, and which it wants.
    pub(crate) fn acknack(
        &mut self,
        from: Guid,
        missing: &NumberSet,
        count: u32,
        now: Instant,
        link: &mut impl Link,
    ) {
        let Some(proxy) = self.readers.get_mut(&from).filter(|proxy| proxy.peer.reliable) else { return };
        // A reader that took this writer for gone while the network was cut begins anew, and has forgotten what it had.
        if proxy.answered.is_some_and(|last| count < last) && missing.base() <= 1 {
            let history = self.transient && proxy.peer.transient;
            proxy.start = if history { 1 } else { self.next };
            proxy.acked = proxy.start - 1;
            proxy.answered = None;
        }
        if proxy.answered.is_some_and(|last| last.wrapping_sub(count) < 1000) {
            return;
        }
        let is_first = proxy.answered.replace(count).is_none();
        let acked = (missing.base() - 1).min(self.next - 1);
        if acked > proxy.acked {
            proxy.acked = acked;
            self.heartbeat_wait = HEARTBEAT_FIRST;
        }
        proxy.repaired.retain(|(_, at)| now.saturating_duration_since(*at) < REPAIRED);
        let (start, acked, peer) = (proxy.start, proxy.acked, proxy.peer);
        // Samples that it will not get, up to the first that is kept.
        let kept = self.history.range(start..).next().map_or(self.next, |(&sequence, _)| sequence);
        let mut gaps = Vec::new();
        let sent = self.sent;
        for sequence in missing.iter().filter(|&sequence| sequence <= sent) {
            if sequence < kept {
                if gaps.is_empty() {
                    gaps.push((sequence, kept));
                }
            } else if let Some(sample) = self.history.get(&sequence).filter(|sample| sample.is_for(from)) {
                let job = Job { sequence, sample: sample.clone(), reader: Some(from), only: None, next: 0 };
                self.repair(job, now);
            } else {
                gaps.push((sequence, sequence + 1));
            }
        }
        if !gaps.is_empty() {
            let place = Place { reader: peer.guid.entity, writer: self.guid.entity };
            let mut encoder = Encoder::new(&mut self.head, self.guid.prefix, peer.guid.prefix);
            for (start, end) in gaps {
                encoder.gap(place, start, end);
            }
            link.send(peer.address, [&self.head, &[], &[]]);
        }
        if self.keep == Keep::LastOfKey {
            // Whoever comes later need not be told of what is gone.
            let all = self.readers.values().map(|proxy| proxy.acked).min().unwrap_or(0);
            self.history.retain(|&sequence, sample| sequence > all || !sample.is_disposed());
        }
        if acked < self.sent && (is_first || self.heartbeat_due.is_none()) {
            self.hurry(now);
        }
    }

    /// A reader says which fragments of a sample it lacks.
    pub(crate) fn nack_fragments(&mut self, from: Guid, sequence: i64, missing: NumberSet, now: Instant) {
        let Some(sample) = self.history.get(&sequence).filter(|_| sequence <= self.sent) else { return };
        if self.readers.get(&from).is_some_and(|proxy| proxy.peer.reliable) {
            let only = Some(missing);
            let job = Job { sequence, sample: sample.clone(), reader: Some(from), only, next: 0 };
            self.repair(job, now);
        }
    }

    fn repair(&mut self, mut job: Job, now: Instant) {
        let Some(reader) = job.reader else { return };
        let Some(proxy) = self.readers.get_mut(&reader) else { return };
        let queued = self.repairs.iter().any(|old| old.sequence == job.sequence && old.reader == job.reader);
        let recent = proxy
            .repaired
            .iter()
            .any(|(sequence, at)| *sequence == job.sequence && now.saturating_duration_since(*at) < REPAIRED);
        if !queued && !recent && job.seek() {
            self.repairs.push_back(job);
        }
    }

    /// When there is something to do.
    pub(crate) fn due(&self) -> Option<Instant> {
        let works = !self.fresh.is_empty() || !self.repairs.is_empty();
        let work = works.then_some(self.pace.due());
        work.into_iter().chain(self.heartbeat_due).min()
    }

    /// Sends what is due: one fragment of a sample to each participant that is to get it, and heartbeats.
    pub(crate) fn step(&mut self, now: Instant, link: &mut impl Link) {
        let repairs = !self.repairs.is_empty();
        let queue = if repairs { &mut self.repairs } else { &mut self.fresh };
        if self.pace.due() <= now
            && let Some(mut job) = queue.pop_front()
        {
            let (bytes, total) = self.send_fragment(&job, now, link);
            let is_first = job.next == 0 && bytes < total;
            job.next += 1;
            if job.seek() {
                let queue = if repairs { &mut self.repairs } else { &mut self.fresh };
                queue.push_front(job);
            } else if let Some(reader) = job.reader {
                if let Some(proxy) = self.readers.get_mut(&reader) {
                    proxy.repaired.push_back((job.sequence, now));
                }
                self.hurry(now);
            }
            self.pace.sent(now, bytes, total, self.fresh.len().saturating_sub(1), is_first);
        }
        if self.heartbeat_due.is_some_and(|due| due <= now) {
            self.send_heartbeats(now, link);
        }
    }

    fn hurry(&mut self, now: Instant) {
        self.heartbeat_due = Some(now);
        self.heartbeat_wait = HEARTBEAT_FIRST;
    }

    /// Sends one fragment, or a sample that fits into a datagram, and what was a heartbeat's turn behind the last one.
    fn send_fragment(&mut self, job: &Job, now: Instant, link: &mut impl Link) -> (usize, usize) {
        let sample = &job.sample;
        let total = sample.payload.len();
        let start = (job.next as usize * FRAGMENT).min(total);
        let body = &sample.payload[start..total.min(start + FRAGMENT)];
        let is_last = job.reader.is_none() && job.next + 1 == job.count();
        if is_last {
            self.sent = self.sent.max(job.sequence);
        }
        let beats = is_last
            && self.heartbeat_sent.is_none_or(|at| now.saturating_duration_since(at) >= HEARTBEAT_FIRST);
        if beats {
            self.heartbeats += 1;
        }
        for (address, prefix, reader) in self.targets(job) {
            let place = Place { reader, writer: self.guid.entity };
            let mut encoder = Encoder::new(&mut self.head, self.guid.prefix, prefix);
            encoder.time(sample.time);
            let mut body = body;
            if let Some((key, disposed)) = sample.key {
                encoder.keyed(place, job.sequence, key, disposed, body);
                body = &[];
            } else if job.count() == 1 {
                encoder.data(place, job.sequence, sample.related(), body.len());
            } else {
                let which = (job.next + 1, 1, FRAGMENT as u16);
                encoder.fragments(place, job.sequence, sample.related(), which, total as u32, body.len());
            }
            let mut tail = Encoder::behind(&mut self.tail);
            let here =
                self.readers.values().filter(|proxy| proxy.peer.address == address && proxy.peer.reliable);
            for proxy in here.filter(|_| beats) {
                let place = Place { reader: proxy.peer.guid.entity, writer: self.guid.entity };
                let (first, last) = span(&self.history, self.sent, self.next, proxy.start);
                tail.heartbeat(place, first, last, self.heartbeats);
            }
            link.send(address, [&self.head, body, &self.tail]);
        }
        if is_last && self.readers.values().any(|proxy| proxy.peer.reliable) {
            if beats {
                self.heartbeat_sent = Some(now);
            }
            self.heartbeat_wait = HEARTBEAT_FIRST;
            self.heartbeat_due = Some(now + self.heartbeat_wait);
        }
        (body.len(), total)
    }

    /// Each participant that is to get a sample, once, with its reader if it has only one.
    fn targets(&self, job: &Job) -> Vec<(SocketAddrV4, Prefix, EntityId)> {
        let mut targets: Vec<(SocketAddrV4, Prefix, EntityId)> = Vec::new();
        let readers = self.readers.values().map(|proxy| proxy.peer);
        for peer in readers.filter(|peer| job.is_for(peer.guid)) {
            match targets.iter_mut().find(|(address, ..)| *address == peer.address) {
                Some((_, _, reader)) => *reader = EntityId::UNKNOWN,
                None => targets.push((peer.address, peer.guid.prefix, peer.guid.entity)),
            }
        }
        targets
    }

    /// Tells readers that have not got everything which samples there are.
    fn send_heartbeats(&mut self, now: Instant, link: &mut impl Link) {
        self.heartbeats += 1;
        let mut waits = false;
        for proxy in self.readers.values() {
            let silent = proxy.answered.is_none();
            if !proxy.peer.reliable || (proxy.acked >= self.sent && !silent) {
                continue;
            }
            waits = true;
            let place = Place { reader: proxy.peer.guid.entity, writer: self.guid.entity };
            let (first, last) = span(&self.history, self.sent, self.next, proxy.start);
            let mut encoder = Encoder::new(&mut self.head, self.guid.prefix, proxy.peer.guid.prefix);
            encoder.heartbeat(place, first, last, self.heartbeats);
            link.send(proxy.peer.address, [&self.head, &[], &[]]);
        }
        self.heartbeat_sent = Some(now);
        self.heartbeat_wait = (self.heartbeat_wait * 2).min(HEARTBEAT_LAST);
        self.heartbeat_due = waits.then(|| now + self.heartbeat_wait);
    }
}

/// The first and the last sample that a reader can get, which begins with `start`.
fn span(history: &BTreeMap<i64, Sample>, sent: i64, next: i64, start: i64) -> (i64, i64) {
    let last = sent.max(start - 1);
    let first = history.range(start..).next().map_or(next, |(&sequence, _)| sequence);
    (first.min(last + 1), last)
}
