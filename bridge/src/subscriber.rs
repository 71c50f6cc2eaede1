//! [`Subscriber`]: the reading end of a stream, through all that happens to its publisher.

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

/// How often a stream that is not there is looked for.
const SEARCH_INTERVAL: Duration = Duration::from_millis(20);
/// How long a wait sleeps at most before it looks whether the publisher is still there.
const WATCH_INTERVAL: Duration = Duration::from_millis(100);
/// After this silence the publisher may have been killed: see who is dead.
const SUSPICIOUS_SILENCE: Duration = Duration::from_secs(1);
/// How much less often it is looked at while the silence lasts: after 1, 2, 4 … 16 s. Some streams are always silent.
const LEAST_SUSPICION: Duration = Duration::from_secs(16);

/// The reading end of a stream.
///
/// It can be made before the stream exists, and it outlives the publisher: when that ends, or is killed, and
/// starts again, [`wait`](Self::wait) and [`take`](Self::take) go on with the new one. A [`Frame`] that is held
/// stays valid through all of it.
///
/// Frames of a publisher that came and went between two looks of this reader are lost: look often where a sender may
/// be short-lived, as with commands.
///
/// A reader that is slower than the publisher loses the oldest of its own waiting frames and slows nobody;
/// [`Frame::missed`] tells how many.
pub struct Subscriber {
    connection: Option<Own<Connection>>,
    node: Node,
    topic: String,
    /// What the stream is made with when this end makes it.
    owned: Option<StreamSpec>,
    next_search: Instant,
    last_frame: Option<FrameId>,
    missed_total: u64,
    last_sign_of_life: Instant,
    /// Only of subscribers that somebody polls.
    readiness: Option<Readiness>,
    /// Only where it was asked for.
    busy_poll: Option<BusyPoll>,
}

#[derive(Clone, Copy)]
struct FrameId {
    session: u64,
    seq: u64,
}

impl Node {
    /// Follows a stream, whether it exists already or not: see [`Subscriber`].
    ///
    /// # Errors
    /// [`Error::InvalidTopic`].
    pub fn subscriber(&self, topic: &str) -> Result<Subscriber, Error> {
        Ok(Subscriber::watching(self, canonical_topic(topic)?))
    }

    /// The receiving side of a command stream: makes the stream, so that commands have a place to go before
    /// anyone sends one, and keeps it while senders come and go.
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

    /// The topic without a leading slash.
    #[must_use]
    pub fn topic(&self) -> &str {
        &self.topic
    }

    /// Publishers now: 0 before the first, and after the last has ended or was found dead.
    #[must_use]
    pub fn publishers(&self) -> usize {
        self.connection.as_ref().map_or(0, |connection| connection.publishers())
    }

    /// Frames that were sent and never taken, over this subscriber's life.
    #[must_use]
    pub fn missed_total(&self) -> u64 {
        self.missed_total
    }

    /// Time since the last frame, or since the subscriber was made: compare with a multiple of the period to see
    /// that a stream has stopped. This is the real sign of life; a killed publisher cannot say goodbye.
    #[must_use]
    pub fn silence(&self) -> Duration {
        self.last_sign_of_life.elapsed()
    }

    /// Looks for frames without sleeping when they are due, for at most `limit` a frame; zero, as at first: never.
    ///
    /// It takes the system 30 to 100 µs to wake a process, which is most of a frame's age where it arrives. With this,
    /// [`wait`](Self::wait), and [`take`](Self::take) in a loop that waits for [`readiness`](Self::readiness), begin to
    /// look shortly before the next frame of a periodic stream is due, by the times of those before, and have it a few
    /// microseconds after it was sent. What comes much earlier or later, or without a period, wakes them as ever.
    ///
    /// The price is processor time: three mean deviations of the times of sending, 0.15 ms at least and half of
    /// `limit` at most, of a core for each frame. Not for machines that have no core to spare; on a single core it
    /// does nothing, as the publisher would have to wait for it.
    pub fn set_busy_poll(&mut self, limit: Duration) {
        self.busy_poll = BusyPoll::new(limit);
    }

    /// Sleeps until there is a frame to take; `false` when `timeout` has passed, or a signal came, without one.
    ///
    /// # Errors
    /// [`Error::TooManySubscribers`], [`Error::Incompatible`], [`Error::Permission`] when the stream is there and
    /// cannot be opened.
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
                        // Interrupted by a signal: the caller may want to end.
                        return self.has_frames();
                    }
                }
                None => std::thread::sleep(left.min(SEARCH_INTERVAL)),
            }
        }
    }

    /// A descriptor to wait on in an event loop of somebody else's (poll, epoll, libuv, asyncio, Qt): readable when
    /// a frame waits, or when it is time to look after the stream. Then [`take`](Self::take) until there is none,
    /// which makes it unreadable; a frame that is left waiting keeps it readable.
    ///
    /// It is the same one for the subscriber's whole life, whatever publishers come and go. Do not read from it.
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
    /// [`Error::Transport`] when the process has no descriptors left.
    pub fn readiness(&mut self) -> Result<BorrowedFd<'_>, Error> {
        self.poll_ready()?;
        self.readiness_fd().ok_or_else(|| self.broken("no descriptor"))
    }

    /// Makes the descriptor, if there is none yet.
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

    /// The descriptor, if it was made.
    pub(crate) fn readiness_fd(&self) -> Option<BorrowedFd<'_>> {
        self.readiness.as_ref().map(|readiness| readiness.as_fd())
    }

    /// The oldest frame that waits, if any; never sleeps.
    ///
    /// # Errors
    /// As [`wait`](Self::wait); [`Error::TooManyHeld`] while too many frames are held; [`Error::Frame`] for one
    /// that must not be read, which is dropped.
    pub fn take(&mut self) -> Result<Option<Frame>, Error> {
        self.search()?;
        match self.receive_or_settle()? {
            Some(sample) => self.accept(sample),
            None => Ok(None),
        }
    }

    /// The newest frame that waits, if any, dropping those before it (they count as missed); never sleeps.
    ///
    /// # Errors
    /// As [`take`](Self::take).
    pub fn take_newest(&mut self) -> Result<Option<Frame>, Error> {
        self.search()?;
        let Some(mut newest) = self.receive_or_settle()? else { return Ok(None) };
        let Some(connection) = &self.connection else { return Ok(None) };
        let config = connection.frames.static_config();
        // A publisher that sends faster than this one drains would hold it here.
        let at_most = config.max_publishers() * config.subscriber_max_buffer_size();
        for _ in 0..at_most {
            if !self.has_frames()? {
                break;
            }
            let next = match self.receive() {
                Err(Error::TooManyHeld { .. }) => {
                    // The last place is the one that `newest` takes.
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

    /// A frame, or the certainty that the next one will be announced.
    fn receive_or_settle(&mut self) -> Result<Option<Sample>, Error> {
        // More than once is a race, more than a few times would be a defect below, to be looked at again by the timer.
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
                    // What has come until now is no news any more. A signal in between only leaves it for later.
                    let _ = connection.listener.try_wait(|_| {});
                    self.watch_interval()
                }
                None => SEARCH_INTERVAL,
            };
            readiness.look_again_in(delay).map_err(|error| self.broken(error))?;
            // It may have come between the look and the clearing.
            if !self.has_frames()? {
                break;
            }
        }
        Ok(None)
    }

    /// Looks for a frame without sleeping while one is due, but no longer than `most`; whether it came.
    fn looked_when_due(&self, most: Duration) -> Result<bool, Error> {
        match (&self.busy_poll, &self.connection) {
            (Some(busy_poll), Some(_)) => busy_poll.look(most, || self.has_frames()),
            _ => Ok(false),
        }
    }

    /// How long may be slept until there is something to look after.
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

    /// Checks a frame and compares it with the one before.
    fn accept(&mut self, sample: Sample) -> Result<Option<Frame>, Error> {
        let Some(connection) = &self.connection else { return Ok(None) };
        self.last_sign_of_life = Instant::now();
        // One that is refused counts as missed by the next: its number is not to be believed.
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

    /// Looks for the stream when it is not open.
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

    /// Lets go of a stream whose publisher has gone, so that the next one finds nothing of the old.
    fn watch_publisher(&mut self) {
        let Some(connection) = &self.connection else { return };
        if self.owned.is_some() {
            return;
        }
        let silence = self.last_sign_of_life.elapsed();
        if silence > SUSPICIOUS_SILENCE {
            self.node.keeper().clean_up_dead_every((silence / 2).clamp(SUSPICIOUS_SILENCE, LEAST_SUSPICION));
        }
        // In this order: a publisher's last frame is there before it is gone.
        if connection.publishers() == 0 && !connection.port.has_samples().unwrap_or(false) {
            self.connection = None;
        }
    }
}

/// One publisher's frames are received in order, those of several in turn.
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
