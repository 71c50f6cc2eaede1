//! Who else is there, and whose readers and writers fit those of this participant.

use std::net::{Ipv4Addr, SocketAddrV4};
use std::time::Instant;

use super::{Engine, MOST_ENDPOINTS, MOST_PARTICIPANTS, Remote};
use crate::guid::{EntityId, Guid, Prefix};
use crate::message::About;
use crate::parameters::id;
use crate::peer::{Link, Peer};
use crate::reader::Received;
use crate::sedp::Endpoint;
use crate::spdp::{self, Announcement};

impl Engine {
    /// A participant announces itself, or that it leaves.
    pub(super) fn announcement(
        &mut self,
        writer: Guid,
        about: About,
        payload: &[u8],
        from: Ipv4Addr,
        now: Instant,
    ) {
        if about.disposed {
            let key = about.key.or_else(|| spdp::key(payload, id::PARTICIPANT_GUID));
            return self.forget(key.unwrap_or(writer).prefix);
        }
        let Some(announced) = Announcement::decode(payload) else { return };
        let prefix = announced.prefix;
        if prefix == self.prefix {
            return;
        }
        if let Some(known) = self.participants.get_mut(&prefix) {
            known.seen = now;
            if known.announced == announced {
                let (discovery, knows_this) = (known.discovery, known.knows_this);
                if !knows_this {
                    self.announce_to(discovery);
                }
                return;
            }
        } else if self.participants.len() >= MOST_PARTICIPANTS {
            return;
        }
        let Some(discovery) = self.sockets.choose(&announced.discovery, from) else { return };
        let vendor = announced.vendor;
        let remote = Remote { announced, seen: now, knows_this: false, from, discovery };
        self.participants.insert(prefix, remote);
        self.announce_to(discovery);
        let mut link = &self.sockets;
        let peer = |entity| Peer {
            guid: Guid::new(prefix, entity),
            address: discovery,
            reliable: true,
            transient: true,
            vendor,
        };
        self.publications.match_reader(peer(EntityId::PUBLICATIONS_READER), now);
        self.subscriptions.match_reader(peer(EntityId::SUBSCRIPTIONS_READER), now);
        self.publications_reader.match_writer(peer(EntityId::PUBLICATIONS_WRITER), &mut link);
        self.subscriptions_reader.match_writer(peer(EntityId::SUBSCRIPTIONS_WRITER), &mut link);
    }

    /// A participant that was heard of need not wait until this one is announced again. One that begins announces
    /// itself a little before it listens, so this is repeated for each of its announcements, until it answers.
    pub(super) fn announce_to(&self, address: SocketAddrV4) {
        let datagram = self.announcement_to(Prefix::UNKNOWN, false);
        (&self.sockets).send(address, [&datagram, &[], &[]]);
    }

    /// A participant announces one of its endpoints, or that it is gone.
    pub(super) fn discovered(&mut self, prefix: Prefix, sample: &Received, writes: bool, now: Instant) {
        if sample.about.disposed {
            let key = sample.about.key.or_else(|| spdp::key(&sample.payload, id::ENDPOINT_GUID));
            if let Some(guid) = key.filter(|guid| guid.prefix == prefix) {
                self.endpoints.remove(&guid);
                self.lost(guid);
            }
            return;
        }
        let Some(endpoint) = Endpoint::decode(&sample.payload, writes) else { return };
        if endpoint.guid.prefix != prefix || self.endpoints.len() >= MOST_ENDPOINTS {
            return;
        }
        if writes {
            self.found_writer(&endpoint);
        } else {
            self.found_reader(&endpoint, now);
        }
        self.endpoints.insert(endpoint.guid, (endpoint, writes));
    }

    /// Where an endpoint listens.
    pub(super) fn peer(&self, endpoint: &Endpoint) -> Option<Peer> {
        let remote = self.participants.get(&endpoint.guid.prefix)?;
        let locators = if endpoint.locators.is_empty() { &remote.announced.user } else { &endpoint.locators };
        Some(Peer {
            guid: endpoint.guid,
            address: self.sockets.choose(locators, remote.from)?,
            reliable: endpoint.reliable,
            transient: endpoint.transient,
            vendor: remote.announced.vendor,
        })
    }

    pub(super) fn found_reader(&mut self, reader: &Endpoint, now: Instant) {
        let Some(peer) = self.peer(reader) else { return };
        for own in self.writers.values_mut() {
            if own.endpoint.serves(reader) {
                own.writer.match_reader(peer, now);
            } else {
                own.writer.unmatch(reader.guid);
            }
            own.state.set_matched(own.writer.readers());
        }
    }

    /// If a topic has a reliable reader and one that is best effort, a reliable writer is read by the reliable one
    /// alone. So such a pair gets each sample once, from writers of both kinds.
    pub(super) fn found_writer(&mut self, writer: &Endpoint) {
        let Some(peer) = self.peer(writer) else { return };
        let mut served = self.readers.values().filter(|own| writer.serves(&own.endpoint));
        let by_reliable = served.any(|own| own.endpoint.reliable);
        for own in self.readers.values_mut() {
            if writer.serves(&own.endpoint) && own.endpoint.reliable == by_reliable {
                own.reader.match_writer(peer, &mut &self.sockets);
            } else {
                own.reader.unmatch(writer.guid);
            }
            own.inbox.set_matched(own.reader.writers());
        }
    }

    /// A reader or writer is gone.
    pub(super) fn lost(&mut self, guid: Guid) {
        for own in self.writers.values_mut() {
            own.writer.unmatch(guid);
            own.state.set_matched(own.writer.readers());
        }
        for own in self.readers.values_mut() {
            own.reader.unmatch(guid);
            own.inbox.set_matched(own.reader.writers());
        }
    }

    /// A participant is gone.
    pub(super) fn forget(&mut self, prefix: Prefix) {
        if self.participants.remove(&prefix).is_none() {
            return;
        }
        self.endpoints.retain(|guid, _| guid.prefix != prefix);
        self.all_writers().for_each(|writer| writer.unmatch_all(prefix));
        self.publications_reader.unmatch_all(prefix);
        self.subscriptions_reader.unmatch_all(prefix);
        for own in self.writers.values() {
            own.state.set_matched(own.writer.readers());
        }
        for own in self.readers.values_mut() {
            own.reader.unmatch_all(prefix);
            own.inbox.set_matched(own.reader.writers());
        }
    }
}
