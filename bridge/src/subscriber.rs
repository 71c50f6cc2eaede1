//! [`Subscriber`]: the reading end of a stream, which outlives its publishers.

mod busy_poll;
mod connection;
mod frame;
mod readiness;

pub use frame::Frame;

use std::{
    fmt,
    os::fd::{AsFd as _, BorrowedFd},
    time::{Duration, Instant},
};

use iceoryx2::{port::ReceiveError, service::port_factory::PortFactory as _};

use crate::{Error, FrameHeader, Node, StreamSpec, clock, own::Own, topic::canonical_topic};
use busy_poll::BusyPoll;
use connection::Connection;
use frame::{Sample, checked_header};
use readiness::Readiness;

/// Interval between searches for a stream that does not exist.
const SEARCH_INTERVAL: Duration = Duration::from_millis(20);
/// The longest sleep within a wait, after which it checks that the publisher still exists.
const WATCH_INTERVAL: Duration = Duration::from_millis(100);
/// Silence after which the publisher may have been killed, so dead processes are looked for.
const SUSPICIOUS_SILENCE: Duration = Duration::from_secs(1);
/// The largest interval between these checks. While the silence lasts they follow after 1, 2, 4 … 16 s, since some
/// streams are always silent.
const LEAST_SUSPICION: Duration = Duration::from_secs(16);

/// The reading end of a stream.
///
/// A subscriber can be created before its stream exists, and it outlives the publisher: if that ends or is killed, and
/// starts again, [`wait`](Self::wait) and [`take`](Self::take) continue with the new one. A [`Frame`] that is held
/// remains valid meanwhile.
///
/// Frames of a publisher that came and went between two calls of this subscriber are lost. Call often if senders may be
/// short-lived, as with commands.
///
/// A subscriber that is slower than the publisher loses the oldest of its own queued frames and does not slow the
/// publisher. [`Frame::missed`] tells how many it lost.
pub struct Subscriber {
    connection: Option<Own<Connection>>,
    node: Node,
    topic: String,
    /// The specification, if this subscriber creates the stream.
    owned: Option<StreamSpec>,
    next_search: Instant,
    last_frame: Option<FrameId>,
    missed_total: u64,
    last_sign_of_life: Instant,
    /// Present once a descriptor was requested.
    readiness: Option<Readiness>,
    /// Present if busy polling is enabled.
    busy_poll: Option<BusyPoll>,
}

#[derive(Clone, Copy)]
struct FrameId {
    session: u64,
    seq: u64,
}

impl Node {
    /// Subscribes to a stream, which may be created later: see [`Subscriber`].
    ///
    /// # Errors
    /// [`Error::InvalidTopic`].
    pub fn subscriber(&self, topic: &str) -> Result<Subscriber, Error> {
        Ok(Subscriber::watching(self, canonical_topic(topic)?))
    }

    /// Opens the receiving end of a command stream. Creates the stream, so that it exists before the first command is
    /// sent, and keeps it while senders come and go.
    ///
    /// # Errors
    /// [`Error::Incompatible`] and [`Error::Permission`].
    pub fn command_subscriber(&self, spec: &StreamSpec) -> Result<Subscriber, Error> {
        Subscriber::owning(self, spec)
    }
}

impl Subscriber {
    fn watching(node: &Node, topic: &str) -> Self {
        let now = Instant::now();
        Self {
            connection: None,
            node: node.clone(),
            topic: topic.to_owned(),
            owned: None,
            next_search: now,
            last_frame: None,
            missed_total: 0,
            last_sign_of_life: now,
            readiness: None,
            busy_poll: None,
        }
    }

    fn owning(node: &Node, spec: &StreamSpec) -> Result<Self, Error> {
        let topic = canonical_topic(&spec.topic)?;
        let mut subscriber = Self { owned: Some(spec.clone()), ..Self::watching(node, topic) };
        subscriber.connect()?;
        Ok(subscriber)
    }

    /// Returns the topic without a leading slash.
    #[must_use]
    pub fn topic(&self) -> &str {
        &self.topic
    }

    /// Returns the number of publishers now: 0 before the first, and after the last has ended or was found dead.
    #[must_use]
    pub fn publishers(&self) -> usize {
        self.connection.as_ref().map_or(0, |connection| connection.publishers())
    }

    /// Returns the number of frames that were sent and never taken since this subscriber was created.
    #[must_use]
    pub fn missed_total(&self) -> u64 {
        self.missed_total
    }

    /// Returns the time since the last frame, or since the subscriber was created. If it exceeds several periods, the
    /// stream has stopped. This is the only reliable sign: a killed publisher cannot report its end.
    #[must_use]
    pub fn silence(&self) -> Duration {
        self.last_sign_of_life.elapsed()
    }

    /// Enables busy polling: when a frame is due, the subscriber polls for it without sleeping, for at most `limit` per
    /// frame. Zero, the default, disables it.
    ///
    /// The system takes 30 to 100 µs to wake a process, which is most of the latency of a frame. With busy polling, a
    /// process that sleeps in [`wait`](Self::wait), or calls [`take`](Self::take) in a loop that polls
    /// [`readiness`](Self::readiness), begins to poll shortly before the next frame of a periodic stream is due, as
    /// predicted from the previous send times. It has the frame a few microseconds after it was sent. Frames that
    /// arrive much earlier or later, or without a period, wake the process as usual.
    ///
    /// The cost is processor time for each frame: three mean deviations of the send times, at least 0.15 ms and at most
    /// half of `limit`. Do not use it on machines without a spare core. On a single core it does nothing, as the
    /// publisher would have to wait.
    pub fn set_busy_poll(&mut self, limit: Duration) {
        self.busy_poll = BusyPoll::new(limit);
    }

    /// Sleeps until a frame is available. Returns false if `timeout` passes, or a signal arrives, without one.
    ///
    /// # Errors
    /// [`Error::TooManySubscribers`], [`Error::Incompatible`], [`Error::Permission`] if the stream exists and cannot be
    /// opened.
    pub fn wait(&mut self, timeout: Duration) -> Result<bool, Error> {
        let deadline = clock::deadline(timeout);
        loop {
            self.search()?;
            if self.has_frames()? {
                return Ok(true);
            }
            self.watch_publisher();
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(false);
            }
            if self.looked_when_due(left)? {
                return Ok(true);
            }
            match &self.connection {
                Some(connection) => {
                    if readiness::wait_for(&connection.listener, left.min(self.watch_interval())).is_err() {
                        // Interrupted by a signal: return, since the caller may want to exit.
                        return self.has_frames();
                    }
                }
                None => std::thread::sleep(left.min(SEARCH_INTERVAL)),
            }
        }
    }

    /// Returns a descriptor to wait on in another event loop (poll, epoll, libuv, asyncio, Qt). It is readable if a
    /// frame is available, or if the subscriber has to check the stream. Then call [`take`](Self::take) until it
    /// returns `None`, which makes the descriptor unreadable; a frame that is not taken keeps it readable.
    ///
    /// The descriptor is the same for the subscriber's whole life, even as publishers come and go. Do not read from it.
    ///
    /// ```
    /// use belvedere_bridge::{Domain, Encoding, Kind, Node, StreamSpec};
    /// use rustix::event::{PollFd, PollFlags, Timespec, poll};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let domain = Domain::new(&format!("doc-f-{}", std::process::id()))?;
    /// let node = Node::open(&domain, "my-loop")?;
    /// # let publisher = node.publisher(&StreamSpec::new("scan", Kind::LaserScan, Encoding::RangesF32, 1440))?;
    /// let mut scans = node.subscriber("scan")?;
    /// # scans.take()?;
    /// # publisher.loan(1440)?.send()?;
    /// let mut fds = [PollFd::from_borrowed_fd(scans.readiness()?, PollFlags::IN)];
    /// assert_eq!(poll(&mut fds, Some(&Timespec { tv_sec: 10, tv_nsec: 0 }))?, 1);
    /// assert!(scans.take()?.is_some());
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`Error::Transport`] if the process has no descriptors left.
    pub fn readiness(&mut self) -> Result<BorrowedFd<'_>, Error> {
        self.poll_ready()?;
        self.readiness_fd().ok_or_else(|| self.broken("no descriptor"))
    }

    /// Creates the descriptor, if there is none yet.
    pub(crate) fn poll_ready(&mut self) -> Result<(), Error> {
        if self.readiness.is_none() {
            let readiness = Readiness::new().map_err(|error| self.broken(error))?;
            if let Some(connection) = &self.connection {
                readiness.follow(&connection.listener).map_err(|error| self.broken(error))?;
            }
            self.readiness = Some(readiness);
        }
        Ok(())
    }

    /// Returns the descriptor, if it was created.
    pub(crate) fn readiness_fd(&self) -> Option<BorrowedFd<'_>> {
        self.readiness.as_ref().map(|readiness| readiness.as_fd())
    }

    /// Returns the oldest queued frame, if any; never sleeps.
    ///
    /// # Errors
    /// The errors of [`wait`](Self::wait); [`Error::TooManyHeld`] while too many frames are held; [`Error::Frame`] for
    /// a frame with an invalid header, which is dropped.
    pub fn take(&mut self) -> Result<Option<Frame>, Error> {
        self.search()?;
        match self.receive_or_settle()? {
            Some(sample) => self.accept(sample),
            None => Ok(None),
        }
    }

    /// Returns the newest queued frame, if any, and drops older ones, which count as missed; never sleeps.
    ///
    /// # Errors
    /// The errors of [`take`](Self::take).
    pub fn take_newest(&mut self) -> Result<Option<Frame>, Error> {
        self.search()?;
        let Some(mut newest) = self.receive_or_settle()? else { return Ok(None) };
        let Some(connection) = &self.connection else { return Ok(None) };
        let config = connection.frames.static_config();
        // Bounded, since a publisher that sends faster than this loop drains would keep it here for ever.
        let at_most = config.max_publishers() * config.subscriber_max_buffer_size();
        for _ in 0..at_most {
            if !self.has_frames()? {
                break;
            }
            let next = match self.receive() {
                Err(Error::TooManyHeld { .. }) => {
                    // `newest` occupies the last slot for held frames.
                    drop(newest);
                    match self.receive()? {
                        Some(sample) => {
                            newest = sample;
                            continue;
                        }
                        None => return Ok(None),
                    }
                }
                received => received?,
            };
            match next {
                Some(next) if is_newer(next.user_header(), newest.user_header()) => newest = next,
                Some(_) => {}
                None => break,
            }
        }
        self.accept(newest)
    }

    /// Receives a frame, or makes sure that the arrival of the next one makes the descriptor readable.
    fn receive_or_settle(&mut self) -> Result<Option<Sample>, Error> {
        // A second iteration means a race. More than a few would be a defect in a layer below; the timer then triggers
        // another check.
        for _ in 0..4 {
            if let Some(sample) = self.receive()? {
                return Ok(Some(sample));
            }
            self.watch_publisher();
            let Some(readiness) = &self.readiness else { return Ok(None) };
            if self.looked_when_due(Duration::MAX)? {
                continue;
            }
            let delay = match &self.connection {
                Some(connection) => {
                    // Clear the notifications so far. If a signal interrupts this, the next call clears them.
                    let _ = connection.listener.try_wait(|_| {});
                    self.watch_interval()
                }
                None => SEARCH_INTERVAL,
            };
            readiness.look_again_in(delay).map_err(|error| self.broken(error))?;
            // A frame may have arrived between the check and the clearing.
            if !self.has_frames()? {
                break;
            }
        }
        Ok(None)
    }

    /// Polls for a frame without sleeping while one is due, for at most `most`. Returns true if one arrived.
    fn looked_when_due(&self, most: Duration) -> Result<bool, Error> {
        match (&self.busy_poll, &self.connection) {
            (Some(busy_poll), Some(_)) => busy_poll.look(most, || self.has_frames()),
            _ => Ok(false),
        }
    }

    /// Returns the longest time to sleep before the stream must be checked.
    fn watch_interval(&self) -> Duration {
        self.busy_poll.as_ref().map_or(WATCH_INTERVAL, |busy_poll| busy_poll.sleep().min(WATCH_INTERVAL))
    }

    fn has_frames(&self) -> Result<bool, Error> {
        let Some(connection) = &self.connection else { return Ok(false) };
        connection.port.has_samples().map_err(|error| self.broken(error))
    }

    fn receive(&self) -> Result<Option<Sample>, Error> {
        let Some(connection) = &self.connection else { return Ok(None) };
        connection.port.receive().map_err(|error| match error {
            ReceiveError::ExceedsMaxBorrows => Error::TooManyHeld {
                topic: self.topic.clone(),
                max: connection.frames.static_config().subscriber_max_borrowed_samples(),
            },
            ReceiveError::ConnectionFailure(error) => self.broken(error),
        })
    }

    fn broken(&self, error: impl fmt::Debug) -> Error {
        Error::transport(format!("receiving {}", self.topic), error)
    }

    /// Checks a frame and compares it with the previous one.
    fn accept(&mut self, sample: Sample) -> Result<Option<Frame>, Error> {
        let Some(connection) = &self.connection else { return Ok(None) };
        self.last_sign_of_life = Instant::now();
        // `last_frame` stays as it is: the sequence number of a refused frame is not trusted, so the next good frame
        // reports it as missed.
        let header =
            checked_header(&sample).map_err(|error| Error::Frame { topic: self.topic.clone(), error })?;
        if let Some(busy_poll) = &mut self.busy_poll {
            busy_poll.taken(&header);
        }
        let now = FrameId { session: header.session, seq: header.seq };
        let (missed, restarted) = match self.last_frame.replace(now) {
            Some(last) if last.session == now.session => {
                (now.seq.saturating_sub(last.seq).saturating_sub(1), false)
            }
            Some(_) => (0, true),
            None => (0, false),
        };
        self.missed_total = self.missed_total.saturating_add(missed);
        let port = connection.port.clone();
        let since_mono_ns = connection.since_mono_ns;
        Ok(Some(Frame::new(sample, &header, port, missed, restarted, since_mono_ns, self.node.clone())))
    }

    /// Searches for the stream if it is not open.
    fn search(&mut self) -> Result<(), Error> {
        if self.connection.is_none() {
            let now = Instant::now();
            if now >= self.next_search {
                self.next_search = now + SEARCH_INTERVAL;
                self.connect()?;
            }
        }
        Ok(())
    }

    fn connect(&mut self) -> Result<(), Error> {
        let Some(connection) = Connection::open(&self.node, &self.topic, self.owned.as_ref())? else {
            return Ok(());
        };
        if let Some(readiness) = &self.readiness {
            readiness.follow(&connection.listener).map_err(|error| self.broken(error))?;
        }
        self.connection = Some(Own::new(connection));
        Ok(())
    }

    /// Closes a stream whose publisher has gone, so that the next publisher creates it anew.
    fn watch_publisher(&mut self) {
        let Some(connection) = &self.connection else { return };
        if self.owned.is_some() {
            return;
        }
        let silence = self.last_sign_of_life.elapsed();
        if silence > SUSPICIOUS_SILENCE {
            self.node.keeper().clean_up_dead_every((silence / 2).clamp(SUSPICIOUS_SILENCE, LEAST_SUSPICION));
        }
        // In this order, since a publisher sends its last frame before it is gone.
        if connection.publishers() == 0 && !connection.port.has_samples().unwrap_or(false) {
            self.connection = None;
        }
    }
}

/// Returns true if `next` is newer: frames of one publisher arrive in order, those of several in turn.
fn is_newer(next: &FrameHeader, newest: &FrameHeader) -> bool {
    next.session == newest.session || next.publish_mono_ns >= newest.publish_mono_ns
}

impl fmt::Debug for Subscriber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Subscriber")
            .field("topic", &self.topic)
            .field("domain", self.node.domain())
            .field("connected", &self.connection.is_some())
            .field("missed_total", &self.missed_total)
            .finish_non_exhaustive()
    }
}
