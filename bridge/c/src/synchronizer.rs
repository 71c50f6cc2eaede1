//! Sets of frames with matching stamps.

use std::{ffi::c_char, time::Duration};

use belvedere_bridge::{Error, Synchronizer as Sets};

use crate::{
    frame::Frame,
    node::Node,
    status::{Failure, Status, close, give, guard, guard_value, handle_arg, null, str_arg},
};

/// A synchroniser, which returns frames of several streams that were captured at the same time: an image with its depth
/// image and its camera_info.
///
/// The stamps are in simulated time. Each frame is in at most one set, sets come in order, and a frame that cannot find
/// a partner any more is skipped. It holds at most one frame of each stream. A subscriber may hold two, so one set may
/// be kept while the next is awaited.
pub struct Synchronizer(Box<dyn Synchronized>);

/// The largest number of streams of a set.
pub const BV_SYNCHRONIZER_MAX: usize = 8;

/// A synchroniser of any number of streams.
trait Synchronized: Send {
    fn wait(&mut self, timeout: Duration) -> Result<bool, Error>;
    fn take(&mut self) -> Result<Option<Vec<belvedere_bridge::Frame>>, Error>;
    fn skipped(&self) -> u64;
    fn missed_total(&self) -> u64;
    fn count(&self) -> usize;
}

impl<const N: usize> Synchronized for Sets<N> {
    fn wait(&mut self, timeout: Duration) -> Result<bool, Error> {
        self.wait(timeout)
    }

    fn take(&mut self) -> Result<Option<Vec<belvedere_bridge::Frame>>, Error> {
        Ok(self.take()?.map(Vec::from))
    }

    fn skipped(&self) -> u64 {
        self.skipped()
    }

    fn missed_total(&self) -> u64 {
        self.missed_total()
    }

    fn count(&self) -> usize {
        N
    }
}

/// Opens a synchroniser of `count` streams, 2 to BV_SYNCHRONIZER_MAX, which may be created later. The stamps of a set
/// differ by at most `tolerance_ns`: 0 for frames captured at the same time, more for sensors of different rates.
///
/// # Safety
/// `node` is open; `topics` has `count` NUL-terminated texts; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_synchronizer_open(
    node: *mut Node,
    topics: *const *const c_char,
    count: usize,
    tolerance_ns: u64,
    out: *mut *mut Synchronizer,
) -> Status {
    guard(|| {
        // SAFETY: an open node by this function's contract.
        let node = unsafe { handle_arg(node, "node") }?;
        if topics.is_null() {
            return Err(null("topics"));
        }
        if !(2..=BV_SYNCHRONIZER_MAX).contains(&count) {
            return Err(wrong_count(count));
        }
        // SAFETY: not null; `count` texts by this function's contract.
        let topics = unsafe { std::slice::from_raw_parts(topics, count) };
        let topics = topics
            .iter()
            // SAFETY: NUL-terminated by this function's contract.
            .map(|topic| unsafe { str_arg(*topic, "a topic") })
            .collect::<Result<Vec<_>, _>>()?;
        let sets = open(&node.0, &topics, Duration::from_nanos(tolerance_ns))?;
        // SAFETY: `out` can be written by this function's contract.
        unsafe { give(out, Synchronizer(sets)) }
    })
}

/// Opens the synchroniser of this number of streams, which is part of the type in Rust.
fn open(
    node: &belvedere_bridge::Node,
    topics: &[&str],
    tolerance: Duration,
) -> Result<Box<dyn Synchronized>, Failure> {
    fn of<const N: usize>(
        node: &belvedere_bridge::Node,
        topics: &[&str],
        tolerance: Duration,
    ) -> Result<Box<dyn Synchronized>, Failure> {
        let topics: [&str; N] = topics.try_into().map_err(|_| wrong_count(topics.len()))?;
        Ok(Box::new(Sets::within(node, topics, tolerance)?))
    }
    match topics.len() {
        2 => of::<2>(node, topics, tolerance),
        3 => of::<3>(node, topics, tolerance),
        4 => of::<4>(node, topics, tolerance),
        5 => of::<5>(node, topics, tolerance),
        6 => of::<6>(node, topics, tolerance),
        7 => of::<7>(node, topics, tolerance),
        8 => of::<8>(node, topics, tolerance),
        other => Err(wrong_count(other)),
    }
}

fn wrong_count(count: usize) -> Failure {
    Failure::invalid_argument(format!("{count} streams: a set is of 2 to {BV_SYNCHRONIZER_MAX}"))
}

/// Closes the synchroniser; NULL is ignored. Frames that are held remain valid.
///
/// # Safety
/// `synchronizer` came from bv_synchronizer_open and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_synchronizer_close(synchronizer: *mut Synchronizer) {
    // SAFETY: this function's contract.
    unsafe { close(synchronizer) };
}

/// Sleeps until a set is available. Returns BV_STATUS_OK, or BV_STATUS_NOTHING if the timeout passes, or a signal
/// arrives, without one.
///
/// # Safety
/// `synchronizer` is open.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_synchronizer_wait(synchronizer: *mut Synchronizer, timeout_ms: u32) -> Status {
    guard(|| {
        // SAFETY: an open synchroniser by this function's contract.
        let synchronizer = unsafe { handle_arg(synchronizer, "synchronizer") }?;
        let ready = synchronizer.0.wait(Duration::from_millis(timeout_ms.into()))?;
        Ok(if ready { Status::Ok } else { Status::Nothing })
    })
}

/// Takes the next set: one frame of each stream, in the order of the topics, each of which the caller must release.
/// BV_STATUS_NOTHING if no set is complete (all of `out` are NULL then). Never sleeps.
///
/// # Safety
/// `synchronizer` is open; `out` has room for one frame of each stream.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_synchronizer_take(
    synchronizer: *mut Synchronizer,
    out: *mut *mut Frame,
) -> Status {
    guard(|| {
        if out.is_null() {
            return Err(null("out"));
        }
        // SAFETY: an open synchroniser by this function's contract.
        let synchronizer = unsafe { handle_arg(synchronizer, "synchronizer") }?;
        for index in 0..synchronizer.0.count() {
            // SAFETY: room for so many by this function's contract.
            unsafe { out.add(index).write(std::ptr::null_mut()) };
        }
        let Some(frames) = synchronizer.0.take()? else { return Ok(Status::Nothing) };
        for (index, frame) in frames.into_iter().enumerate() {
            // SAFETY: as above, and a set has as many frames as there are streams.
            unsafe { give(out.add(index), Frame(frame)) }?;
        }
        Ok(Status::Ok)
    })
}

/// Returns the number of frames that were taken and found no partner.
///
/// # Safety
/// `synchronizer` is open or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_synchronizer_skipped(synchronizer: *const Synchronizer) -> u64 {
    // SAFETY: this function's contract.
    unsafe { synchronizer.as_ref() }.map_or(0, |it| guard_value(0, || it.0.skipped()))
}

/// Returns the number of frames that were sent and never taken, over all streams.
///
/// # Safety
/// `synchronizer` is open or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bv_synchronizer_missed_total(synchronizer: *const Synchronizer) -> u64 {
    // SAFETY: this function's contract.
    unsafe { synchronizer.as_ref() }.map_or(0, |it| guard_value(0, || it.0.missed_total()))
}
