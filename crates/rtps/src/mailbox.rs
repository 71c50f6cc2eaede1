//! What the user's threads hand to the participant's thread, and the other way around.

use std::collections::VecDeque;
use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::guid::{EntityId, Guid};
use crate::lock::lock;
use crate::reader::Received;
use crate::requests::{Request, Requests};
use crate::sedp::Endpoint;
use crate::sockets::Waker;
use crate::writer::Sample;

/// What the participant's thread is to do.
#[derive(Debug)]
pub(crate) enum Order {
    AddWriter(Endpoint, Arc<WriterState>),
    AddReader(Endpoint, Inbox),
    Remove(EntityId),
    Write(EntityId, Arc<Vec<u8>>, Duration),
    Reply(EntityId, Sample),
    Stop,
}

/// Where samples go that a reader gives on.
#[derive(Debug)]
pub(crate) enum Inbox {
    Samples(Arc<ReaderState>),
    /// Requests of a service, with its number, and the most bytes of a request.
    Requests(Requests, u32, usize),
}

impl Inbox {
    /// The most bytes of a sample.
    pub(crate) fn limit(&self) -> usize {
        match self {
            Inbox::Samples(state) => state.limit,
            Inbox::Requests(.., limit) => *limit,
        }
    }

    pub(crate) fn push(&self, writer: Guid, vendor: [u8; 2], sample: Received) {
        match self {
            Inbox::Samples(_) if sample.is_too_large => {}
            Inbox::Samples(state) => state.push(sample.payload),
            Inbox::Requests(requests, service, _) => {
                if let Some(request) = Request::of(*service, writer, vendor, sample) {
                    requests.push(request);
                }
            }
        }
    }

    pub(crate) fn set_matched(&self, count: usize) {
        if let Inbox::Samples(state) = self {
            state.matched.store(count, Ordering::Relaxed);
        }
    }
}

/// Orders that wait for the participant's thread.
#[derive(Debug)]
pub(crate) struct Mailbox {
    /// Nothing, once the thread has left: writers may outlive their participant.
    orders: Mutex<Option<Vec<Order>>>,
    pub(crate) waker: Waker,
    /// The last announcement of the participant has reached no network.
    pub(crate) is_cut: AtomicBool,
}

impl Mailbox {
    pub(crate) fn new(waker: Waker) -> Mailbox {
        Mailbox { orders: Mutex::new(Some(Vec::new())), waker, is_cut: AtomicBool::new(false) }
    }

    pub(crate) fn post(&self, order: Order) {
        if let Some(orders) = &mut *lock(&self.orders) {
            orders.push(order);
        }
        self.waker.wake();
    }

    /// Posts a sample. If the thread lags behind, only the last `depth` of a writer wait for it.
    pub(crate) fn post_sample(&self, writer: EntityId, sample: Vec<u8>, time: Duration, depth: usize) {
        let mut guard = lock(&self.orders);
        let Some(orders) = &mut *guard else { return };
        let of_writer = |order: &Order| matches!(order, Order::Write(other, ..) if *other == writer);
        if orders.iter().filter(|order| of_writer(order)).count() >= depth
            && let Some(oldest) = orders.iter().position(of_writer)
        {
            orders.remove(oldest);
        }
        orders.push(Order::Write(writer, Arc::new(sample), time));
        drop(guard);
        self.waker.wake();
    }

    pub(crate) fn take(&self) -> Vec<Order> {
        lock(&self.orders).as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// Takes no orders from now on.
    pub(crate) fn close(&self) {
        *lock(&self.orders) = None;
    }
}

/// What a writer's user and the participant's thread share.
#[derive(Default)]
pub(crate) struct WriterState {
    pub(crate) matched: AtomicUsize,
    /// Buffers of samples that nobody needs any longer.
    buffers: Mutex<Vec<Vec<u8>>>,
    /// Called with the number of readers when it changes.
    on_matched: Mutex<Option<OnMatched>>,
}

pub(crate) type OnMatched = Box<dyn FnMut(usize) + Send>;

impl WriterState {
    pub(crate) fn new(on_matched: Option<OnMatched>) -> WriterState {
        WriterState { on_matched: Mutex::new(on_matched), ..WriterState::default() }
    }

    pub(crate) fn set_matched(&self, count: usize) {
        if self.matched.swap(count, Ordering::Relaxed) != count
            && let Some(call) = &mut *lock(&self.on_matched)
        {
            call(count);
        }
    }

    pub(crate) fn give_back(&self, buffer: Vec<u8>) {
        let mut buffers = lock(&self.buffers);
        if buffers.len() < 2 {
            buffers.push(buffer);
        }
    }

    pub(crate) fn buffer(&self) -> Vec<u8> {
        lock(&self.buffers).pop().unwrap_or_default()
    }
}

impl fmt::Debug for WriterState {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.debug_struct("WriterState").field("matched", &self.matched).finish_non_exhaustive()
    }
}

/// What a reader's user and the participant's thread share.
pub(crate) struct ReaderState {
    pub(crate) matched: AtomicUsize,
    samples: Mutex<VecDeque<Vec<u8>>>,
    arrived: Condvar,
    depth: usize,
    /// The most bytes of a sample.
    pub(crate) limit: usize,
    /// Called with each sample, which is not kept then.
    on_sample: Option<Mutex<OnSample>>,
}

pub(crate) type OnSample = Box<dyn FnMut(&[u8]) + Send>;

impl ReaderState {
    pub(crate) fn new(depth: usize, limit: usize, on_sample: Option<OnSample>) -> ReaderState {
        let (matched, samples, arrived) = (AtomicUsize::new(0), Mutex::default(), Condvar::new());
        ReaderState {
            matched,
            samples,
            arrived,
            depth: depth.max(1),
            limit,
            on_sample: on_sample.map(Mutex::new),
        }
    }

    pub(crate) fn push(&self, sample: Vec<u8>) {
        if let Some(call) = &self.on_sample {
            return lock(call)(&sample);
        }
        let mut samples = lock(&self.samples);
        if samples.len() >= self.depth {
            samples.pop_front();
        }
        samples.push_back(sample);
        self.arrived.notify_one();
    }

    pub(crate) fn take(&self, timeout: Duration) -> Option<Vec<u8>> {
        let until = Instant::now().checked_add(timeout);
        let mut samples = lock(&self.samples);
        loop {
            if let Some(sample) = samples.pop_front() {
                return Some(sample);
            }
            let left =
                until.map_or(Duration::from_secs(3600), |at| at.saturating_duration_since(Instant::now()));
            if left.is_zero() {
                return None;
            }
            let waited = self.arrived.wait_timeout(samples, left);
            samples = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

impl fmt::Debug for ReaderState {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.debug_struct("ReaderState").field("matched", &self.matched).finish_non_exhaustive()
    }
}
