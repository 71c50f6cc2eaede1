//! [`LinkReceiver`]: the receiving side, on a machine without the simulator.

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

/// Interval at which new subscribers get the last frame of latched streams.
const UPDATE: Duration = Duration::from_millis(100);
/// The other side sends a list every second. After this time without one, a warning is logged.
const SILENCE: Duration = Duration::from_secs(5);
/// Most names of other domains that are kept for warnings.
const MAX_OTHERS: usize = 8;

/// Options of a receiver.
#[derive(Debug, Clone)]
pub struct ReceiverOptions {
    /// Addresses of the connection to the simulator's machine.
    pub endpoints: Endpoints,
    /// The simulator's domain on its machine.
    pub from: Domain,
    /// Topics, with or without a leading slash; all if the list is empty.
    pub topics: Vec<String>,
    /// Most bytes of shared memory for all streams together; `None` for half of what is free at the start.
    pub memory: Option<u64>,
}

/// Replaces, in a domain of this machine, a simulator on another machine: publishes the same streams with the same
/// frames, and sends commands to it.
///
/// In a header only the send time is this machine's own. Number and session are the simulator's, so a consumer sees
/// frames lost by the network like those that it was too slow for.
pub struct LinkReceiver {
    node: Node,
    from: Domain,
    wanted: BTreeSet<String>,
    transport: Transport,
    heard: Arc<Mutex<Heard>>,
    _announcements: Inlet,
    mirrors: BTreeMap<String, Mirror>,
    room: Room,
    /// Threads of streams that have ended.
    ending: Vec<JoinHandle<()>>,
    tallies: Tallies,
    /// Counts refused announcements.
    refused: Tally,
    silence: Silence,
    next_update: Instant,
}

/// Announcements that have not been processed yet.
#[derive(Default)]
struct Heard {
    streams: Option<Vec<Described>>,
    others: BTreeSet<String>,
    refused: Option<String>,
}

/// The time since the last announcement, and whether a warning was logged.
struct Silence {
    since: Instant,
    is_reported: bool,
    /// Number of frames received by then, which are a sign of life as well.
    frames: u64,
}

impl LinkReceiver {
    /// Opens the connection to the simulator's machine, which need not be running yet.
    ///
    /// # Errors
    /// If it is not possible to listen at an address; [`Error::Transport`] if the system does not report the free
    /// memory.
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
            silence: Silence { since: now, is_reported: false, frames: 0 },
            next_update: now,
        })
    }

    /// Handles streams and consumers that come and go. To be called about fifty times a second.
    ///
    /// # Errors
    /// [`Error::DomainInUse`] if a simulator, or another link, is in this domain. Other failures concern one stream;
    /// they are logged, and the stream is tried again.
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
            if self.silence.is_reported {
                tracing::info!("domain {} of the other machine is received", self.from);
            }
            self.silence = Silence { since: now, is_reported: false, ..self.silence };
            self.apply(&streams)?;
        } else if !self.silence.is_reported && now - self.silence.since > SILENCE {
            self.warn_of_silence(now);
        }
        let is_time = now >= self.next_update;
        if is_time {
            self.next_update = now + UPDATE;
        }
        for (topic, mirror) in &mut self.mirrors {
            if let Err(error) = mirror.tend(&self.transport, is_time) {
                tracing::warn!(topic, %error, "a stream of the other machine failed");
            }
        }
        Ok(())
    }

    /// Logs a warning that nothing is received, unless frames have arrived.
    fn warn_of_silence(&mut self, now: Instant) {
        let frames = self.tallies.sum().frames;
        let is_reported = frames == self.silence.frames;
        if is_reported {
            let heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
            let why = match (self.transport.peers(), heard.others.first()) {
                (0, _) => "there is no connection; trying again".to_owned(),
                (_, None) => {
                    "there is a connection, but no `belvedere link send` at its other end".to_owned()
                }
                (_, Some(other)) => format!("the other machine has domain {other}; choose it with --from"),
            };
            tracing::warn!("nothing is received from domain {}: {why}", self.from);
        }
        self.silence = Silence { since: now, is_reported, frames };
    }

    /// Opens and closes streams to match the announcement.
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
        let new: Vec<_> =
            announced.into_iter().filter(|(topic, _)| !self.mirrors.contains_key(*topic)).collect();
        let specs: Vec<&StreamSpec> = new.iter().map(|(_, (_, spec))| spec).collect();
        let most_bytes = self.room.largest_pool(taken, &specs);
        let mut left_out: Vec<(&str, Box<dyn std::error::Error>)> = Vec::new();
        for (topic, (described, spec)) in new {
            let spec = most_bytes.map_or_else(|| spec.clone(), |bytes| spec.within(bytes));
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
                // The next announcement tries again.
                Err(error) => left_out.push((topic, error.into())),
            }
        }
        if let Some((topic, why)) = left_out.first() {
            self.room.warn(topic, why, left_out.len() - 1);
        } else if most_bytes.is_some() {
            tracing::warn!(
                "the other machine's streams have room for fewer consumers than usual, so that they fit into {}; allow more with --memory, or name the topics that you need",
                self.room.memory_text()
            );
        }
        Ok(())
    }

    /// Returns the progress.
    pub fn progress(&self) -> LinkProgress {
        LinkProgress { peers: self.transport.peers(), streams: self.mirrors.len(), ..self.tallies.sum() }
    }

    /// Returns the numbers of carried and lost frames per topic.
    pub fn by_topic(&self) -> BTreeMap<String, (u64, u64)> {
        self.tallies.by_topic()
    }

    /// Ends the link. Its streams end like those of a simulator that ends.
    pub fn close(mut self) {
        let mirrors = std::mem::take(&mut self.mirrors);
        self.ending.extend(mirrors.into_values().filter_map(Mirror::end));
        self.transport.close();
        for thread in self.ending {
            // A panic of the thread has already been reported.
            let _ = thread.join();
        }
    }
}
