//! [`LinkReceiver`]: the side of a machine without a simulator.

use super::LinkError;
use super::mirror::Mirror;
use super::room::{Room, Taken};
use super::tally::{LinkProgress, Tallies, Tally};
use super::transport::{Endpoints, Inlet, Transport};
use super::wire::{self, Announcement, Described};
use belvedere_bridge::{Domain, Error, Node, StreamSpec};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How often those who have come late are given the last frame of streams that keep it.
const UPDATE: Duration = Duration::from_millis(100);
/// The other side says something every second; after so long it is told that it does not.
const SILENCE: Duration = Duration::from_secs(5);
/// Names of other domains that are kept to be told.
const MAX_OTHERS: usize = 8;

/// What is taken.
#[derive(Debug, Clone)]
pub struct ReceiverOptions {
    /// Where the simulator's machine is.
    pub endpoints: Endpoints,
    /// The simulator's domain there.
    pub from: Domain,
    /// Topics, with or without a leading slash; all if there are none.
    pub topics: Vec<String>,
    /// Bytes of shared memory that all streams together may take here; half of what is free at the start if it is `None`.
    pub memory: Option<u64>,
}

/// Stands in a domain of this machine for a simulator on another one: the same streams with the same frames, and
/// commands go back to it.
///
/// Of a header only the time of sending is this machine's own; number and session are the simulator's, so that a consumer
/// is told of what the network has lost as it is of what it was too slow for.
pub struct LinkReceiver {
    node: Node,
    from: Domain,
    wanted: BTreeSet<String>,
    transport: Transport,
    heard: Arc<Mutex<Heard>>,
    _announcements: Inlet,
    mirrors: BTreeMap<String, Mirror>,
    room: Room,
    /// Threads of streams that are gone.
    ending: Vec<JoinHandle<()>>,
    tallies: Tallies,
    /// Of announcements.
    refused: Tally,
    silence: Silence,
    next_update: Instant,
}

/// What was announced and not yet looked at.
#[derive(Default)]
struct Heard {
    streams: Option<Vec<Described>>,
    others: BTreeSet<String>,
    refused: Option<String>,
}

/// Since when nothing is heard, and whether that was said.
struct Silence {
    since: Instant,
    is_told: bool,
    /// Frames that had come by then: they are a sign of life, too.
    frames: u64,
}

impl LinkReceiver {
    /// Opens the way to the simulator's machine, which need not be there yet.
    ///
    /// # Errors
    /// When an address cannot be listened at; [`Error::Transport`] when the system does not say how much memory is free.
    pub fn open(node: Node, options: ReceiverOptions) -> Result<Self, LinkError> {
        let memory = match options.memory {
            Some(memory) => memory,
            None => node.free_shared_memory()? / 2,
        };
        let transport = Transport::open(&options.endpoints)?;
        let heard: Arc<Mutex<Heard>> = Arc::default();
        let (hearing, from) = (heard.clone(), options.from.to_string());
        let announcements = transport.inlet(wire::announcement_key("*"), move |key, message| {
            let Some(domain) = wire::announced_domain(key) else { return };
            let mut heard = hearing.lock().unwrap_or_else(PoisonError::into_inner);
            if domain != from {
                if heard.others.len() < MAX_OTHERS {
                    heard.others.insert(domain.to_owned());
                }
                return;
            }
            let read =
                Announcement::check_len(message.len()).and_then(|()| Announcement::read(&message.to_bytes()));
            match read {
                Ok(announcement) => heard.streams = Some(announcement.streams),
                Err(refusal) => heard.refused = Some(refusal.to_string()),
            }
        })?;
        let wanted = options.topics.iter().map(|topic| topic.trim_start_matches('/').to_owned()).collect();
        let now = Instant::now();
        Ok(Self {
            node,
            from: options.from,
            wanted,
            transport,
            heard,
            _announcements: announcements,
            mirrors: BTreeMap::new(),
            room: Room::new(memory),
            ending: Vec::new(),
            tallies: Tallies::default(),
            refused: Tally::default(),
            silence: Silence { since: now, is_told: false, frames: 0 },
            next_update: now,
        })
    }

    /// Looks after streams and consumers that come and go; to be called some fifty times a second.
    ///
    /// # Errors
    /// [`Error::DomainInUse`] when a simulator, or another link, is in this domain. Other failures concern one stream,
    /// are warned of, and tried again.
    pub fn tend(&mut self) -> Result<(), LinkError> {
        let now = Instant::now();
        let (streams, refused) = {
            let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
            (heard.streams.take(), heard.refused.take())
        };
        if let Some(refused) = refused {
            self.refused.refuse("list of streams", &refused);
        }
        if let Some(streams) = streams {
            if self.silence.is_told {
                tracing::info!("domain {} of the other machine is heard", self.from);
            }
            self.silence = Silence { since: now, is_told: false, ..self.silence };
            self.apply(&streams)?;
        } else if !self.silence.is_told && now - self.silence.since > SILENCE {
            self.tell_of_silence(now);
        }
        let is_time = now >= self.next_update;
        if is_time {
            self.next_update = now + UPDATE;
        }
        for (topic, mirror) in &mut self.mirrors {
            if let Err(error) = mirror.tend(&self.transport, is_time) {
                tracing::warn!(topic, %error, "a stream of the other machine is not looked after");
            }
        }
        Ok(())
    }

    /// Warns that nothing is heard, unless frames are.
    fn tell_of_silence(&mut self, now: Instant) {
        let frames = self.tallies.sum().frames;
        let is_told = frames == self.silence.frames;
        if is_told {
            let heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
            let why = match (self.transport.peers(), heard.others.first()) {
                (0, _) => "there is no connection; it is tried again".to_owned(),
                (_, None) => "there is a connection, and no `belvedere link send` at its end".to_owned(),
                (_, Some(other)) => format!("there is domain {other}; name it with --from"),
            };
            tracing::warn!("nothing is heard of domain {}: {why}", self.from);
        }
        self.silence = Silence { since: now, is_told, frames };
    }

    /// Opens and closes streams until they are those that were announced.
    fn apply(&mut self, streams: &[Described]) -> Result<(), LinkError> {
        let is_wanted = |topic: &str| self.wanted.is_empty() || self.wanted.contains(topic);
        let announced: BTreeMap<&str, (&Described, StreamSpec)> = streams
            .iter()
            .filter(|described| is_wanted(&described.topic))
            .filter_map(|described| Some((described.topic.as_str(), (described, described.spec()?))))
            .collect();
        let is_same = |topic: &str, mirror: &Mirror| {
            announced.get(topic).is_some_and(|(described, _)| mirror.is_of(described))
        };
        let gone = self.mirrors.iter().filter(|(topic, mirror)| !is_same(topic, mirror));
        for topic in gone.map(|(topic, _)| topic.clone()).collect::<Vec<_>>() {
            self.ending.extend(self.mirrors.remove(&topic).and_then(Mirror::end));
        }
        self.ending.retain(|thread| !thread.is_finished());
        let mut taken = Taken::default();
        for mirror in self.mirrors.values() {
            taken.add(mirror.pool_bytes());
        }
        let mut left_out: Vec<(&str, Box<dyn std::error::Error>)> = Vec::new();
        for (topic, (described, spec)) in announced {
            if self.mirrors.contains_key(topic) {
                continue;
            }
            if let Err(full) = self.room.take(&mut taken, wire::pool_bytes(&spec)) {
                left_out.push((topic, full.into()));
                continue;
            }
            let tally = self.tallies.of(topic, wire::is_command(spec.kind));
            match Mirror::open(&self.node, &self.transport, &self.from, described, spec, tally) {
                Ok(mirror) => {
                    self.mirrors.insert(topic.to_owned(), mirror);
                }
                Err(error @ LinkError::Bridge(Error::DomainInUse { .. })) => return Err(error),
                // It is tried again with the next announcement.
                Err(error) => left_out.push((topic, error.into())),
            }
        }
        if let Some((topic, why)) = left_out.first() {
            self.room.warn(topic, why, left_out.len() - 1);
        }
        Ok(())
    }

    /// How far it is.
    pub fn progress(&self) -> LinkProgress {
        LinkProgress { peers: self.transport.peers(), streams: self.mirrors.len(), ..self.tallies.sum() }
    }

    /// Frames carried and lost of each topic.
    pub fn by_topic(&self) -> BTreeMap<String, (u64, u64)> {
        self.tallies.by_topic()
    }

    /// Ends it; the streams end as those of a simulator that ends.
    pub fn close(mut self) {
        let mirrors = std::mem::take(&mut self.mirrors);
        self.ending.extend(mirrors.into_values().filter_map(Mirror::end));
        self.transport.close();
        for thread in self.ending {
            // One that panicked has said so.
            let _ = thread.join();
        }
    }
}
