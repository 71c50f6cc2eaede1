//! [`Synchronizer`]: matches frames of several streams by their stamps.

use std::{
    fmt,
    time::{Duration, Instant},
};

use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    io::Errno,
};

use crate::{Error, Frame, Node, Subscriber, clock};

/// A synchroniser of `N` streams, which returns frames that were captured at the same time: an image with its depth
/// image and its `camera_info`.
///
/// The stamps are in simulated time. All frames that a simulator captures at one time have the same stamp, so use
/// [`exact`](Self::exact) as a rule, and [`within`](Self::within) for sensors of different rates.
///
/// A set is complete if the stamps of all streams' oldest frames lie within the tolerance. A frame that is older than
/// the newest of them by more than the tolerance is skipped: stamps only grow, so it cannot find a partner any more. So
/// each frame is in at most one set, sets come in order, and no frame waits longer than its partners take. If a
/// simulator is restarted, or its time is reset, the remaining frames from before are skipped.
///
/// It holds at most one frame of each stream. A subscriber may hold two, so one set may be kept while the next is
/// awaited.
///
/// ```
/// use std::time::Duration;
/// use belvedere_bridge::{Domain, Encoding, Kind, Node, StreamSpec, Synchronizer};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let domain = Domain::new(&format!("doc-s-{}", std::process::id()))?;
/// let node = Node::open(&domain, "rgbd")?;
/// # let rgb = node.publisher(&StreamSpec::new("rgb/image_raw", Kind::Image, Encoding::Mono8, 12))?;
/// # let depth = node.publisher(&StreamSpec::new("depth/image_raw", Kind::DepthImage, Encoding::U16C1, 24))?;
/// let mut pairs = Synchronizer::exact(&node, ["rgb/image_raw", "depth/image_raw"])?;
/// # pairs.take()?;
/// # for (publisher, len, stamp_ns) in [(&rgb, 12, 7), (&rgb, 12, 8), (&depth, 24, 8)] {
/// #     let mut frame = publisher.loan(len)?;
/// #     frame.header_mut().set_packed(4, 3);
/// #     frame.header_mut().stamp_ns = stamp_ns;
/// #     frame.send()?;
/// # }
/// if pairs.wait(Duration::from_secs(10))? {
///     let [rgb, depth] = pairs.take()?.ok_or("another thread took it")?;
///     assert_eq!(rgb.header().stamp_ns, depth.header().stamp_ns);
/// }
/// # assert_eq!(pairs.skipped(), 1);
/// # Ok(())
/// # }
/// ```
pub struct Synchronizer<const N: usize> {
    lanes: [Lane; N],
    tolerance_ns: u64,
    skipped: u64,
}

/// A stream, and its oldest frame that has no partners yet.
struct Lane {
    subscriber: Subscriber,
    head: Option<Frame>,
    newest_stamp_ns: u64,
    /// True if the head is the first frame after a restart or a reset of time.
    anew: bool,
}

impl<const N: usize> Synchronizer<N> {
    /// Creates a synchroniser for frames with equal stamps.
    ///
    /// # Errors
    /// [`Error::InvalidTopic`]; [`Error::Transport`] if the process has no descriptors left.
    pub fn exact<T: AsRef<str>>(node: &Node, topics: [T; N]) -> Result<Self, Error> {
        Self::within(node, topics, Duration::ZERO)
    }

    /// Creates a synchroniser for frames whose stamps differ by at most `tolerance`.
    ///
    /// # Errors
    /// The errors of [`exact`](Self::exact).
    #[allow(clippy::missing_panics_doc, reason = "every lane was made when there was no failure")]
    pub fn within<T: AsRef<str>>(node: &Node, topics: [T; N], tolerance: Duration) -> Result<Self, Error> {
        const { assert!(N >= 1, "a set of no streams") };
        let mut failure = None;
        let lanes = topics.map(|topic| {
            let made = node.subscriber(topic.as_ref()).and_then(|mut subscriber| {
                subscriber.poll_ready()?;
                Ok(Lane { subscriber, head: None, newest_stamp_ns: 0, anew: false })
            });
            made.map_err(|error| failure = Some(error)).ok()
        });
        if let Some(error) = failure {
            return Err(error);
        }
        let tolerance_ns = u64::try_from(tolerance.as_nanos()).unwrap_or(u64::MAX);
        Ok(Self { lanes: lanes.map(|lane| lane.expect("made")), tolerance_ns, skipped: 0 })
    }

    /// Sleeps until a set is available. Returns false if `timeout` passes, or a signal arrives, without one.
    ///
    /// # Errors
    /// The errors of [`Subscriber::take`].
    pub fn wait(&mut self, timeout: Duration) -> Result<bool, Error> {
        let deadline = clock::deadline(timeout);
        loop {
            if self.complete()? {
                return Ok(true);
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(false);
            }
            match self.sleep(left) {
                Ok(()) => {}
                Err(Errno::INTR) => return self.complete(),
                Err(error) => return Err(Error::transport("waiting for several streams", error)),
            }
        }
    }

    /// Returns the next set, in the order of the topics, if it is complete; never sleeps.
    ///
    /// # Errors
    /// The errors of [`Subscriber::take`].
    #[allow(clippy::missing_panics_doc, reason = "a complete set has every head")]
    pub fn take(&mut self) -> Result<Option<[Frame; N]>, Error> {
        if !self.complete()? {
            return Ok(None);
        }
        let heads = self.lanes.each_mut().map(|lane| lane.head.take());
        Ok(Some(heads.map(|head| head.expect("a complete set"))))
    }

    /// Returns the number of frames that were taken and found no partner.
    #[must_use]
    pub fn skipped(&self) -> u64 {
        self.skipped
    }

    /// Returns the number of frames that were sent and never taken, over all streams.
    #[must_use]
    pub fn missed_total(&self) -> u64 {
        self.lanes.iter().map(|lane| lane.subscriber.missed_total()).sum()
    }

    /// Sleeps until one of the streams without a head is ready.
    fn sleep(&self, timeout: Duration) -> Result<(), Errno> {
        let mut fds = Vec::with_capacity(N);
        for lane in &self.lanes {
            if lane.head.is_none()
                && let Some(fd) = lane.subscriber.readiness_fd()
            {
                fds.push(PollFd::from_borrowed_fd(fd, PollFlags::IN));
            }
        }
        let timeout =
            Timespec { tv_sec: timeout.as_secs().cast_signed(), tv_nsec: timeout.subsec_nanos().into() };
        poll(&mut fds, Some(&timeout)).map(drop)
    }

    /// Takes and skips frames. Returns true once the heads of all streams match, false if a stream has no frame.
    fn complete(&mut self) -> Result<bool, Error> {
        loop {
            for lane in 0..N {
                if self.lanes[lane].head.is_none() {
                    self.refill(lane)?;
                }
            }
            let Some(newest) = self.newest_if_all() else { return Ok(false) };
            let mut all_close = true;
            for lane in &mut self.lanes {
                let stamp_ns = lane.head.as_ref().map_or(newest, |head| head.header().stamp_ns);
                if newest - stamp_ns > self.tolerance_ns {
                    lane.head = None;
                    self.skipped += 1;
                    all_close = false;
                }
            }
            if all_close {
                return Ok(true);
            }
        }
    }

    /// Returns the newest stamp of the heads, if every stream has one.
    fn newest_if_all(&self) -> Option<u64> {
        let mut newest = 0;
        for lane in &self.lanes {
            newest = newest.max(lane.head.as_ref()?.header().stamp_ns);
        }
        Some(newest)
    }

    /// Takes the next frame of a stream. If it is the first after a restart or reset, drops the other streams' frames
    /// from before.
    fn refill(&mut self, index: usize) -> Result<(), Error> {
        let lane = &mut self.lanes[index];
        let Some(frame) = lane.subscriber.take()? else { return Ok(()) };
        let stamp_ns = frame.header().stamp_ns;
        lane.anew = frame.restarted() || stamp_ns < lane.newest_stamp_ns;
        lane.newest_stamp_ns = stamp_ns;
        lane.head = Some(frame);
        if lane.anew {
            for (other, lane) in self.lanes.iter_mut().enumerate() {
                if other != index && !lane.anew && lane.head.take().is_some() {
                    self.skipped += 1;
                }
            }
        }
        Ok(())
    }
}

impl<const N: usize> fmt::Debug for Synchronizer<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Synchronizer")
            .field("topics", &self.lanes.each_ref().map(|lane| lane.subscriber.topic()))
            .field("tolerance_ns", &self.tolerance_ns)
            .field("skipped", &self.skipped)
            .finish_non_exhaustive()
    }
}
