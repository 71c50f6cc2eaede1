//! The reading end of a topic: its writers, and what has come from each (8.4.12).

use std::collections::BTreeMap;

use crate::assembly::Assembly;
use crate::guid::{EntityId, Guid, Prefix};
use crate::message::{About, Content, Encoder, Place};
use crate::numbers::NumberSet;
use crate::peer::{Link, Peer};
use crate::spdp::FAST_DDS;

/// At most so many samples of a writer wait for one before them, and so many are in parts.
const MOST_WAITING: usize = 256;
const MOST_PARTIAL: usize = 4;

/// So many bytes of samples that are not complete or have to wait are kept for all writers, beside four of the largest
/// samples.
const MOST_KEPT: usize = 4 << 20;

/// A sample that has come.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Received {
    pub(crate) sequence: i64,
    pub(crate) about: About,
    /// Only the beginning, if the sample is larger than the reader takes.
    pub(crate) payload: Vec<u8>,
    pub(crate) is_too_large: bool,
}

/// The bytes that are kept of a sample that is too large: the header of CDR, and what Cyclone writes before the values of
/// a request, by which the reply names it.
const BEGINNING: usize = 20;

impl Received {
    fn whole(sequence: i64, about: About, payload: Vec<u8>) -> Received {
        Received { sequence, about, payload, is_too_large: false }
    }

    fn too_large(sequence: i64, about: About, payload: &[u8]) -> Received {
        let payload = payload[..payload.len().min(BEGINNING)].to_vec();
        Received { sequence, about, payload, is_too_large: true }
    }
}

/// What has come from a writer.
#[derive(Debug)]
struct Source {
    peer: Peer,
    /// The next sample to be given on, once it is known.
    next: Option<i64>,
    /// Samples that came before their turn; `None` will not come.
    waiting: BTreeMap<i64, Option<Received>>,
    partial: BTreeMap<i64, Assembly>,
    /// Bytes of the samples that wait or are in parts.
    kept: usize,
    heartbeat: Option<u32>,
    answers: u32,
}

/// The reading end of a topic.
#[derive(Debug)]
pub(crate) struct Reader {
    guid: Guid,
    reliable: bool,
    /// Wants the history.
    transient: bool,
    /// The most bytes of a sample.
    limit: usize,
    sources: BTreeMap<Guid, Source>,
    buffer: Vec<u8>,
}

impl Reader {
    pub(crate) fn new(guid: Guid, reliable: bool, transient: bool, limit: usize) -> Reader {
        Reader { guid, reliable, transient, limit, sources: BTreeMap::new(), buffer: Vec::new() }
    }

    pub(crate) fn writers(&self) -> usize {
        self.sources.len()
    }

    /// Matches a writer, or changes where one that is matched listens. Gives whether it is new.
    pub(crate) fn match_writer(&mut self, peer: Peer, link: &mut impl Link) -> bool {
        if let Some(known) = self.sources.get_mut(&peer.guid) {
            known.peer = peer;
            return false;
        }
        let next = self.transient.then_some(1);
        let source = Source {
            peer,
            next,
            waiting: BTreeMap::new(),
            partial: BTreeMap::new(),
            kept: 0,
            heartbeat: None,
            answers: 0,
        };
        self.sources.insert(peer.guid, source);
        if self.reliable {
            self.ask(peer, link);
        }
        true
    }

    /// Forgets a writer. Gives whether there was one.
    pub(crate) fn unmatch(&mut self, guid: Guid) -> bool {
        self.sources.remove(&guid).is_some()
    }

    /// Forgets the writers of a participant.
    pub(crate) fn unmatch_all(&mut self, prefix: Prefix) {
        self.sources.retain(|guid, _| guid.prefix != prefix);
    }

    /// The bytes that are kept of samples which cannot be given on yet.
    pub(crate) fn kept(&self) -> usize {
        self.sources.values().map(|source| source.kept).sum()
    }

    /// The most bytes that are kept.
    pub(crate) fn most_kept(&self) -> usize {
        MOST_KEPT + 4 * self.limit
    }

    /// Takes what a writer says, and gives the samples that are complete and whose turn it is.
    pub(crate) fn take(&mut self, from: Guid, content: &Content<'_>, link: &mut impl Link) -> Vec<Received> {
        let room = self.most_kept().saturating_sub(self.kept());
        let out = self.heard(from, content, room, link);
        if let Some(source) = self.sources.get_mut(&from) {
            source.count();
        }
        out
    }

    /// Does the same; no more than `room` bytes are to be kept beside those that are kept already.
    fn heard(
        &mut self,
        from: Guid,
        content: &Content<'_>,
        room: usize,
        link: &mut impl Link,
    ) -> Vec<Received> {
        let (reliable, limit) = (self.reliable, self.limit);
        let Some(source) = self.sources.get_mut(&from) else { return Vec::new() };
        let mut out = Vec::new();
        match *content {
            Content::Data { sequence, about, payload } if source.wants(sequence) => {
                let sample = if payload.len() > limit {
                    Received::too_large(sequence, about, payload)
                } else {
                    Received::whole(sequence, about, payload.to_vec())
                };
                source.add(sample, reliable, room, &mut out);
            }
            Content::Fragments { sequence, about, first, size, total, payload } if source.wants(sequence) => {
                if total as usize > limit {
                    // The others are not needed. If this one is lost, a reliable writer sends all again.
                    if first == 1 {
                        let sample = Received::too_large(sequence, about, payload);
                        source.add(sample, reliable, room, &mut out);
                    }
                    return out;
                }
                if !source.partial.contains_key(&sequence) && total as usize > room {
                    return out;
                }
                if !source.partial.contains_key(&sequence) && source.partial.len() >= MOST_PARTIAL {
                    source.partial.pop_first();
                }
                let assembly = source.partial.entry(sequence).or_insert_with(|| Assembly::new(size, total));
                assembly.add(first, size, total, payload);
                if assembly.is_whole()
                    && let Some(assembly) = source.partial.remove(&sequence)
                {
                    let sample = Received::whole(sequence, about, assembly.into_data());
                    source.add(sample, reliable, room, &mut out);
                }
            }
            Content::Gap { start, list } if reliable => {
                source.skip(start, list.base(), &mut out);
                for sequence in list.iter() {
                    source.skip(sequence, sequence + 1, &mut out);
                }
            }
            Content::Heartbeat { first, last, count, is_final } if reliable => {
                if source.heartbeat.is_some_and(|known| known.wrapping_sub(count) < 1000) {
                    return out;
                }
                source.heartbeat = Some(count);
                let next = *source.next.get_or_insert(first);
                source.skip(next, first, &mut out);
                self.answer_heartbeat(from, last, is_final, link);
            }
            _ => {}
        }
        out
    }

    /// Says which samples up to `last` are there, and asks for the others.
    fn answer_heartbeat(&mut self, from: Guid, last: i64, is_final: bool, link: &mut impl Link) {
        let Some(source) = self.sources.get_mut(&from) else { return };
        let next = source.next.unwrap_or(1);
        let range = next..=last.min(next.saturating_add(255));
        let wanted =
            |sequence: &i64| !source.waiting.contains_key(sequence) && !source.partial.contains_key(sequence);
        let missing = NumberSet::of(next, range.filter(wanted));
        let partial: Vec<(i64, NumberSet)> = source
            .partial
            .range(..=last)
            .map(|(&sequence, assembly)| (sequence, assembly.missing()))
            .collect();
        if is_final && missing.is_empty() && partial.is_empty() {
            return;
        }
        if !partial.is_empty() {
            let peer = source.peer;
            let place = Place { reader: self.guid.entity, writer: from.entity };
            let mut encoder = Encoder::new(&mut self.buffer, self.guid.prefix, from.prefix);
            for (sequence, missing) in partial {
                source.answers = source.answers.wrapping_add(1);
                encoder.nack_fragments(place, sequence, &missing, source.answers);
            }
            link.send(peer.address, [&self.buffer, &[], &[]]);
        }
        self.answer(from, &missing, true, link);
    }

    fn answer(&mut self, to: Guid, missing: &NumberSet, is_final: bool, link: &mut impl Link) {
        let Some(source) = self.sources.get_mut(&to) else { return };
        source.answers = source.answers.wrapping_add(1);
        let place = Place { reader: self.guid.entity, writer: to.entity };
        Encoder::new(&mut self.buffer, self.guid.prefix, to.prefix).acknack(
            place,
            missing,
            source.answers,
            is_final,
        );
        link.send(source.peer.address, [&self.buffer, &[], &[]]);
    }

    /// Asks writers that have not said anything yet which samples they have.
    pub(crate) fn ask_again(&mut self, link: &mut impl Link) {
        let silent = |source: &&Source| source.heartbeat.is_none();
        let reliable = self.sources.values().filter(|_| self.reliable);
        let silent: Vec<Peer> = reliable.filter(silent).map(|source| source.peer).collect();
        for peer in silent {
            self.ask(peer, link);
        }
    }

    /// Has nothing of a writer and asks for nothing, but for a heartbeat. Fast DDS sends one at once if the empty set
    /// begins with 0, and otherwise only after its period of three seconds. Others take that set for malformed.
    fn ask(&mut self, peer: Peer, link: &mut impl Link) {
        let base = i64::from(peer.vendor != FAST_DDS);
        self.answer(peer.guid, &NumberSet::empty(base), false, link);
    }

    /// The entity to which datagrams for this reader are addressed.
    pub(crate) fn entity(&self) -> EntityId {
        self.guid.entity
    }
}

impl Source {
    fn wants(&self, sequence: i64) -> bool {
        self.next.is_none_or(|next| sequence >= next) && !self.waiting.contains_key(&sequence)
    }

    /// Counts the bytes that are kept.
    fn count(&mut self) {
        let waiting = self.waiting.values().flatten().map(|sample| sample.payload.len());
        self.kept = waiting.chain(self.partial.values().map(Assembly::len)).sum();
    }

    fn add(&mut self, sample: Received, reliable: bool, room: usize, out: &mut Vec<Received>) {
        let sequence = sample.sequence;
        if !reliable {
            self.next = Some(sequence + 1);
            self.partial = self.partial.split_off(&(sequence + 1));
            out.push(sample);
            return;
        }
        // One whose turn it is does not wait. Others may come again, so none is lost.
        let is_next = *self.next.get_or_insert(sequence) == sequence;
        if is_next || (self.waiting.len() < MOST_WAITING && sample.payload.len() <= room) {
            self.waiting.insert(sequence, Some(sample));
        }
        self.give(out);
    }

    /// Samples from `start` to before `end` will not come.
    fn skip(&mut self, start: i64, end: i64, out: &mut Vec<Received>) {
        let next = *self.next.get_or_insert(start);
        if start <= next {
            // Those that came early are still given on.
            let later = self.waiting.split_off(&end);
            let early = std::mem::replace(&mut self.waiting, later);
            out.extend(early.into_values().flatten());
            self.next = Some(next.max(end));
        } else {
            for sequence in (start..end).take(MOST_WAITING) {
                if self.waiting.len() < MOST_WAITING {
                    self.waiting.entry(sequence).or_insert(None);
                }
            }
        }
        self.give(out);
        let next = self.next.unwrap_or(1);
        self.partial = self.partial.split_off(&next);
    }

    /// Gives on what has its turn.
    fn give(&mut self, out: &mut Vec<Received>) {
        let Some(next) = &mut self.next else { return };
        while let Some(sample) = self.waiting.remove(next) {
            out.extend(sample);
            *next += 1;
        }
    }
}
