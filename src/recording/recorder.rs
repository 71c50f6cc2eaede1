//! [`Recorder`]: records all streams of a domain to a file.

use super::backlog::Backlog;
use super::send_order::SendOrder;
use super::stream::RecordedStream;
use super::writer::{Compression, Profile, RecordingWriter, StreamId, StreamTally};
use super::{Attachment, NewFile, RecordingError};
use belvedere_bridge::{Domain, FrameHeader, Kind, Node, Subscriber, clock};
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, SyncSender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Interval between flushes: at most this much is lost when the process is killed.
const FLUSH_INTERVAL: Duration = Duration::from_secs(1);
/// Time for which a frame is held back, so that earlier frames from other threads can arrive.
const ORDER_NS: u64 = 250_000_000;
/// Longest sleep of a stream's thread between two checks of the stop flag.
const NAP: Duration = Duration::from_millis(50);
/// The topic that is always recorded, because it shows resets.
const CLOCK: &str = "clock";

/// Options for recording.
#[derive(Debug, Clone, Default)]
pub struct RecorderOptions {
    /// Topics, with or without a leading slash; all if the list is empty. The clock is always recorded.
    pub topics: Vec<String>,
    /// The version of ROS whose messages the file has.
    pub profile: Profile,
    /// Compression of the file.
    pub compression: Compression,
    /// True if an existing file is replaced.
    pub replace: bool,
    /// Describes how the recording was made.
    pub about: BTreeMap<String, String>,
    /// Files that are stored in it.
    pub attachments: Vec<Attachment>,
}

/// The progress of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Progress {
    /// Number of recorded streams.
    pub streams: usize,
    /// Number of these that have a publisher now.
    pub publishers: usize,
    /// Frames received.
    pub frames: u64,
    /// Frames that were sent but not received in time.
    pub missed: u64,
    /// Bytes of messages written, before compression.
    pub bytes: u64,
}

/// Records the streams of a domain, with a thread for each, until it is [finished](Self::finish).
///
/// A simulation that waits for the name of its node loses no frame to it.
pub struct Recorder {
    node: Node,
    file: NewFile,
    wanted: BTreeSet<String>,
    /// Topics that are recorded.
    known: BTreeSet<String>,
    shared: Arc<Shared>,
    sender: SyncSender<Note>,
    followers: Vec<JoinHandle<()>>,
    writer: JoinHandle<Result<Vec<StreamTally>, RecordingError>>,
}

/// A message to the thread that writes.
enum Note {
    Stream(RecordedStream, usize),
    Frame(usize, Box<FrameHeader>, Vec<u8>),
}

#[derive(Default)]
struct Shared {
    stop: AtomicBool,
    publishers: AtomicUsize,
    frames: AtomicU64,
    missed: AtomicU64,
    written: AtomicU64,
    backlog: Backlog,
    missed_by_topic: Mutex<BTreeMap<String, u64>>,
}

impl Recorder {
    /// Starts to record the streams of the domain, including those that appear later with [`look`](Self::look).
    ///
    /// # Errors
    /// If the file cannot be created, or the domain cannot be joined.
    pub fn start(node: Node, path: &Path, options: &RecorderOptions) -> Result<Self, RecordingError> {
        let file = NewFile::create(path, options.replace)?;
        let (shared, sender, writer) = match start_to_write(&file, options) {
            Ok(started) => started,
            Err(error) => {
                file.discard();
                return Err(error);
            }
        };
        let wanted = options.topics.iter().map(|topic| topic.trim_start_matches('/').to_owned()).collect();
        let mut recorder = Self {
            node,
            file,
            wanted,
            known: BTreeSet::new(),
            shared,
            sender,
            followers: Vec::new(),
            writer,
        };
        match recorder.look() {
            Ok(()) => Ok(recorder),
            Err(error) => {
                recorder.discard();
                Err(error)
            }
        }
    }

    /// Subscribes to streams that have appeared since the last call.
    ///
    /// # Errors
    /// If streams cannot be listed or subscribed to.
    pub fn look(&mut self) -> Result<(), RecordingError> {
        let mut new = Vec::new();
        let mut failed = None;
        for info in self.node.streams()? {
            let is_wanted =
                self.wanted.is_empty() || self.wanted.contains(&info.topic) || info.topic == CLOCK;
            // The size of a stream without a publisher is not known yet.
            let is_open = info.publishers > 0 || info.kind.is_some_and(Kind::is_robot_command);
            if !is_wanted || !is_open || self.known.contains(&info.topic) {
                continue;
            }
            let Some(stream) = RecordedStream::new(&info) else { continue };
            match self.subscribe(&info.topic) {
                Ok(subscriber) => new.push((stream, subscriber)),
                // The next call tries again; the other streams do not wait for this one.
                Err(error) => failed = Some(error),
            }
        }
        let first = self.followers.len();
        // All streams are described before the first frame of any, so that a replay opens them together.
        for (number, (stream, _)) in (first..).zip(&new) {
            // This fails only if the writer has ended with an error, which `finish` reports.
            let _ = self.sender.send(Note::Stream(stream.clone(), number));
        }
        for (number, (stream, subscriber)) in (first..).zip(new) {
            let (sender, shared) = (self.sender.clone(), self.shared.clone());
            let thread = std::thread::Builder::new()
                .name(format!("record {number}"))
                .spawn(move || follow(subscriber, number, &sender, &shared))?;
            self.followers.push(thread);
            self.known.insert(stream.topic);
        }
        failed.map_or(Ok(()), Err)
    }

    fn subscribe(&self, topic: &str) -> Result<Subscriber, RecordingError> {
        let mut subscriber = self.node.subscriber(topic)?;
        // This connects, so that a simulation that waits for this consumer sees it.
        subscriber.wait(Duration::ZERO)?;
        Ok(subscriber)
    }

    /// Returns the progress.
    pub fn progress(&self) -> Progress {
        let shared = &self.shared;
        Progress {
            streams: self.followers.len(),
            publishers: shared.publishers.load(Ordering::Relaxed),
            frames: shared.frames.load(Ordering::Relaxed),
            missed: shared.missed.load(Ordering::Relaxed),
            bytes: shared.written.load(Ordering::Relaxed),
        }
    }

    /// Returns true if the file cannot be written any more; [`finish`](Self::finish) returns the reason.
    pub fn has_failed(&self) -> bool {
        self.shared.backlog.has_failed()
    }

    /// Returns the number of lost frames per topic.
    pub fn missed(&self) -> BTreeMap<String, u64> {
        self.shared.missed_by_topic.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Returns the path of the file until it is complete.
    pub fn active(&self) -> &Path {
        self.file.active()
    }

    /// Records the frames that still wait, completes the file and gives it its name.
    ///
    /// # Errors
    /// If the file could not be written; the written part remains under [`active`](Self::active).
    pub fn finish(self) -> Result<Vec<StreamTally>, RecordingError> {
        let (file, tallies) = self.end();
        let tallies = tallies?;
        file.complete()?;
        Ok(tallies)
    }

    /// Stops the recorder and removes the file.
    fn discard(self) {
        self.end().0.discard();
    }

    fn end(self) -> (NewFile, Result<Vec<StreamTally>, RecordingError>) {
        let Self { file, shared, sender, followers, writer, .. } = self;
        shared.stop.store(true, Ordering::Relaxed);
        let all_ended = followers.into_iter().map(JoinHandle::join).all(|ended| ended.is_ok());
        drop(sender);
        let panicked = |what: &str| Err(RecordingError::Broken(format!("{what} panicked")));
        let written = writer.join().unwrap_or_else(|_| panicked("the thread that writes it"));
        let written = if all_ended { written } else { panicked("a thread that follows a stream") };
        (file, written)
    }
}

/// The writer's shared state, the sender of its messages, and its thread.
type Writing = (Arc<Shared>, SyncSender<Note>, JoinHandle<Result<Vec<StreamTally>, RecordingError>>);

fn start_to_write(file: &NewFile, options: &RecorderOptions) -> Result<Writing, RecordingError> {
    let shared = Arc::new(Shared::default());
    let (sender, notes) = mpsc::sync_channel(1024);
    let mut writer =
        RecordingWriter::new(file.writer()?, options.profile, options.compression, &options.about)?;
    options.attachments.iter().try_for_each(|attachment| writer.attach(attachment))?;
    let writing = shared.clone();
    let writer = std::thread::Builder::new()
        .name("recording".into())
        .spawn(move || write(writer, &notes, &writing))?;
    Ok((shared, sender, writer))
}

/// Passes a stream's frames on to the writer until the recorder stops.
fn follow(mut subscriber: Subscriber, number: usize, sender: &SyncSender<Note>, shared: &Shared) {
    let mut is_there = false;
    loop {
        let stopping = shared.stop.load(Ordering::Relaxed);
        let nap = if stopping { Duration::ZERO } else { NAP };
        match subscriber.wait(nap) {
            Ok(true) => {}
            Ok(false) if stopping => break,
            Ok(false) => {
                is_there = count(subscriber.publishers() > 0, is_there, &shared.publishers);
                continue;
            }
            Err(error) => {
                tracing::warn!(topic = subscriber.topic(), %error, "the stream cannot be read");
                std::thread::sleep(NAP);
                if stopping {
                    break;
                }
                continue;
            }
        }
        is_there = count(true, is_there, &shared.publishers);
        match subscriber.take() {
            Ok(Some(frame)) => {
                if frame.missed() > 0 {
                    shared.missed.fetch_add(frame.missed(), Ordering::Relaxed);
                    let mut missed = shared.missed_by_topic.lock().unwrap_or_else(PoisonError::into_inner);
                    *missed.entry(subscriber.topic().to_owned()).or_default() += frame.missed();
                }
                // Copied, so that the stream's memory is free again at once.
                let (header, payload) = (Box::new(*frame.header()), shared.backlog.copied(frame.payload()));
                drop(frame);
                shared.backlog.wait_for_room(payload.len() as u64);
                shared.frames.fetch_add(1, Ordering::Relaxed);
                if sender.send(Note::Frame(number, header, payload)).is_err() {
                    break;
                }
            }
            Ok(None) => {}
            Err(error) => tracing::warn!(topic = subscriber.topic(), %error, "a frame is not recorded"),
        }
    }
    count(false, is_there, &shared.publishers);
}

/// Updates `total` if the state has changed, and returns the new state.
fn count(now: bool, before: bool, total: &AtomicUsize) -> bool {
    match (before, now) {
        (false, true) => {
            total.fetch_add(1, Ordering::Relaxed);
        }
        (true, false) => {
            total.fetch_sub(1, Ordering::Relaxed);
        }
        _ => {}
    }
    now
}

/// Writes until all senders have ended.
fn write<W: io::Write>(
    mut writer: RecordingWriter<W>,
    notes: &mpsc::Receiver<Note>,
    shared: &Shared,
) -> Result<Vec<StreamTally>, RecordingError> {
    let written = write_all(&mut writer, notes, shared).and_then(|()| writer.finish());
    if written.is_err() {
        shared.backlog.fail();
    }
    written
}

fn write_all<W: io::Write>(
    writer: &mut RecordingWriter<W>,
    notes: &mpsc::Receiver<Note>,
    shared: &Shared,
) -> Result<(), RecordingError> {
    let mut ids: BTreeMap<usize, StreamId> = BTreeMap::new();
    let mut order = SendOrder::default();
    let mut next_flush = Instant::now() + FLUSH_INTERVAL;
    let mut is_open = true;
    while is_open {
        match notes.recv_timeout(NAP) {
            Ok(Note::Stream(stream, number)) => {
                ids.insert(number, writer.add(&stream)?);
            }
            Ok(Note::Frame(number, header, payload)) => order.add(number, header, payload),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => is_open = false,
        }
        let before = if is_open { clock::mono_ns().saturating_sub(ORDER_NS) } else { u64::MAX };
        while let Some((number, header, payload)) = order.next_sent_before(before) {
            if let Some(&id) = ids.get(&number) {
                writer.write(id, &header, &payload)?;
            }
            shared.backlog.give_room(payload.len() as u64);
            shared.backlog.keep(payload);
        }
        if Instant::now() >= next_flush {
            next_flush = Instant::now() + FLUSH_INTERVAL;
            writer.flush()?;
        }
        shared.written.store(writer.bytes(), Ordering::Relaxed);
    }
    Ok(())
}

/// Returns the description that every recording has: version, command line, domain.
pub fn about(domain: &Domain) -> BTreeMap<String, String> {
    let command_line: Vec<String> =
        std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    BTreeMap::from([
        ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        ("command_line".to_owned(), command_line.join(" ")),
        ("domain".to_owned(), domain.to_string()),
    ])
}
