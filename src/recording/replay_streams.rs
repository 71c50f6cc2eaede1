//! [`ReplayStreams`]: the streams of a replay.

use super::player_options::PlayerOptions;
use super::reader::RecordedFrame;
use super::{RecordedStream, RecordingError};
use crate::server::room::Room;
use belvedere_bridge::{Consumer, FrameHeader, Lossless, Node, Publisher, StreamSpec};
use std::collections::{BTreeMap, HashMap};
use std::time::{Duration, Instant};

/// The streams that a recording describes, as they are opened in a domain.
pub(super) struct ReplayStreams {
    node: Node,
    publishers: HashMap<String, Publisher>,
    specs: BTreeMap<String, RecordedStream>,
    /// The limit of pools; `made` has the specification of each open stream.
    room: Room,
    made: HashMap<String, StreamSpec>,
    /// True if a described stream is not open yet.
    has_new: bool,
    /// The consumers that lose no frame; `None` if there are none.
    lossless: Option<Lossless>,
    /// Longest wait of a frame for a consumer.
    patience: Duration,
}

impl ReplayStreams {
    /// Creates it without a stream.
    pub(super) fn new(node: Node, options: &PlayerOptions) -> Self {
        let patience = options.patience.unwrap_or(Lossless::PATIENCE);
        let lossless = (!options.wait_for.is_empty()).then(|| Lossless {
            consumers: options.wait_for.iter().map(|awaited| awaited.name.clone()).collect(),
            patience,
            gives_up: options.gives_up,
        });
        Self {
            node,
            publishers: HashMap::new(),
            specs: BTreeMap::new(),
            room: Room::default(),
            made: HashMap::new(),
            has_new: false,
            lossless,
            patience,
        }
    }

    /// Sends latched frames to new subscribers.
    pub(super) fn update(&self) -> Result<(), RecordingError> {
        Ok(self.publishers.values().try_for_each(Publisher::update)?)
    }

    /// Returns the consumers of all open streams, once for each stream.
    pub(super) fn consumers(&self) -> impl Iterator<Item = Consumer> {
        self.publishers.values().flat_map(Publisher::consumers)
    }

    /// Removes the files of processes that were killed.
    pub(super) fn clean_up_dead(&self) {
        self.node.clean_up_dead();
    }

    /// Sends a frame on its stream.
    pub(super) fn send(&mut self, frame: &RecordedFrame) -> Result<(), RecordingError> {
        let len = frame.payload.len();
        if self.publishers.get(&frame.topic).is_some_and(|publisher| len > publisher.max_payload_len()) {
            self.enlarge(&frame.topic, len)?;
        }
        let Some(publisher) = self.publishers.get(&frame.topic) else {
            return Err(RecordingError::Broken(format!(
                "a frame belongs to /{}, which the recording does not describe",
                frame.topic
            )));
        };
        let mut loaned = publisher.loan(len)?;
        loaned.payload_mut().copy_from_slice(&frame.payload);
        let flags = frame.header.flags | FrameHeader::REPLAYED;
        *loaned.header_mut() = FrameHeader { flags, payload_len: len as u64, ..*frame.header };
        loaned.send()?;
        Ok(())
    }

    /// Adds a stream, which is opened before the next frame, so that streams that are described together share the
    /// memory.
    pub(super) fn add(&mut self, stream: RecordedStream) {
        if !self.specs.contains_key(&stream.topic) {
            self.specs.insert(stream.topic.clone(), stream);
            self.has_new = true;
        }
    }

    /// Opens the streams that are not open yet, with pools as large as all of them fit. If the memory is too small with
    /// those already open, all are opened again with smaller pools: consumers then see new publishers.
    pub(super) fn open_new(&mut self) -> Result<(), RecordingError> {
        if !std::mem::take(&mut self.has_new) {
            return Ok(());
        }
        let room = std::mem::take(&mut self.room);
        let opened = room.fit(RecordingError::lacks_memory, || self.open_within(&room));
        self.room = room;
        opened
    }

    /// Opens all streams within the limit of `room`. Streams that already have the right size stay open.
    fn open_within(&mut self, room: &Room) -> Result<(), RecordingError> {
        let wanted: Vec<_> = self.specs.values().map(|stream| room.cut(&stream.spec())).collect();
        // Closed first, to make room for others.
        for spec in &wanted {
            if self.made.get(&spec.topic).is_some_and(|made| made != spec) {
                self.made.remove(&spec.topic);
                self.publishers.remove(&spec.topic);
            }
        }
        for spec in wanted {
            if !self.publishers.contains_key(&spec.topic) {
                self.publishers.insert(spec.topic.clone(), self.publisher(&spec)?);
                self.made.insert(spec.topic.clone(), spec);
            }
        }
        Ok(())
    }

    fn publisher(&self, spec: &StreamSpec) -> Result<Publisher, RecordingError> {
        Ok(self.node.publisher(&StreamSpec { lossless: self.lossless.clone(), ..spec.clone() })?)
    }

    /// Opens a stream again for a frame that is larger than its description. This happens if the simulator was
    /// restarted with another robot or world during the recording. Consumers see a new publisher, as they did then.
    fn enlarge(&mut self, topic: &str, len: usize) -> Result<(), RecordingError> {
        let Some(stream) = self.specs.get_mut(topic) else { return Ok(()) };
        stream.max_payload_len = len;
        self.made.remove(topic);
        // A stream has one publisher: the old one is closed first, and consumers disconnect from it.
        let awaited = |name: &String| self.lossless.iter().any(|lossless| lossless.consumers.contains(name));
        let old = self.publishers.remove(topic);
        let names = old.iter().flat_map(Publisher::consumers).map(|consumer| consumer.name);
        let names: Vec<String> = names.filter(awaited).collect();
        drop(old);
        let is_left = |node: &Node| {
            let streams = node.streams()?;
            let followed = streams.iter().any(|info| info.topic == topic && info.subscribers > 0);
            Ok::<_, RecordingError>(names.is_empty() || !followed)
        };
        self.until(|| is_left(&self.node))?;
        self.has_new = true;
        self.open_new()?;
        self.until(|| {
            let Some(publisher) = self.publishers.get(topic) else { return Ok(true) };
            publisher.update()?;
            let there = publisher.consumers();
            Ok(names.iter().all(|name| there.iter().any(|consumer| consumer.name == *name)))
        })
    }

    /// Waits until a condition holds, or the time for waiting is over.
    fn until(&self, holds: impl Fn() -> Result<bool, RecordingError>) -> Result<(), RecordingError> {
        let deadline = Instant::now() + self.patience;
        while !holds()? && Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok(())
    }
}
