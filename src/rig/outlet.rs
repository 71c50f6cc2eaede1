//! [`Outlet`]: one stream, with its port, its cost, and a hash of everything sent.

use super::owner::Owner;
use super::sink::{Frame, Port, Sink};
use belvedere_bridge::payload::Message;
use belvedere_bridge::{Consumer, Encoding, Error, Kind, StreamSpec};
use std::cell::{Cell, OnceCell};
use std::ops::Add;
use std::time::Duration;
use xxhash_rust::xxh3::Xxh3;

/// A stream of the rig.
pub struct Outlet {
    port: Box<dyn Port>,
    /// The topic, with a leading slash.
    topic: String,
    kind: Kind,
    encoding: Encoding,
    frame_id: String,
    owner: Owner,
    rate_hz: Cell<Option<f64>>,
    hash: Option<Xxh3>,
    tally: Tally,
    /// The first error about a consumer that was waited for in vain.
    held_up: OnceCell<Error>,
    /// Whether the current frame has no subscribers.
    unwanted: Cell<bool>,
}

/// The counts of a stream.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    /// Frames sent.
    pub frames: u64,
    /// Frames that could not be sent.
    pub dropped: u64,
    /// Time spent making them.
    pub busy: Duration,
}

impl Add for Tally {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            frames: self.frames + other.frames,
            dropped: self.dropped + other.dropped,
            busy: self.busy + other.busy,
        }
    }
}

impl Outlet {
    /// Opens the stream of an owner; with `hashed`, every byte sent is hashed.
    ///
    /// # Errors
    /// If the sink cannot open the stream.
    pub fn open(sink: &dyn Sink, spec: &StreamSpec, owner: Owner, hashed: bool) -> Result<Self, Error> {
        Ok(Self {
            port: sink.open(spec)?,
            topic: format!("/{}", spec.name()?),
            kind: spec.kind,
            encoding: spec.encoding,
            frame_id: spec.frame_id.clone(),
            owner,
            rate_hz: Cell::new(spec.rate_hz),
            hash: hashed.then(Xxh3::new),
            tally: Tally::default(),
            held_up: OnceCell::new(),
            unwanted: Cell::new(false),
        })
    }

    /// Returns the topic with its leading slash.
    pub fn topic(&self) -> &str {
        &self.topic
    }

    /// Returns the kind of its frames.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Returns the encoding of its frames.
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// Returns the coordinate frame of its data; empty for none.
    pub fn frame_id(&self) -> &str {
        &self.frame_id
    }

    /// Returns the owner that publishes it.
    pub fn owner(&self) -> &Owner {
        &self.owner
    }

    /// Returns the intended rate.
    pub fn rate_hz(&self) -> Option<f64> {
        self.rate_hz.get()
    }

    /// Sets the intended rate.
    pub fn set_rate_hz(&self, rate_hz: f64) {
        self.rate_hz.set(Some(rate_hz));
    }

    /// Returns the current number of subscribers.
    pub fn subscribers(&self) -> usize {
        self.port.subscribers()
    }

    /// Returns the current consumers, which is slower than their number.
    pub fn consumers(&self) -> Vec<Consumer> {
        self.port.consumers()
    }

    /// Returns the first error about a consumer that was waited for in vain, if there was one.
    pub fn held_up(&self) -> Option<&Error> {
        self.held_up.get()
    }

    /// Returns its counts so far.
    pub fn tally(&self) -> Tally {
        Tally { dropped: self.tally.dropped + self.port.failed(), ..self.tally }
    }

    /// Returns the hash of everything sent so far, if it is hashed.
    pub fn hash(&self) -> Option<u128> {
        self.hash.as_ref().map(Xxh3::digest128)
    }

    /// Returns true if the next frame has to be made, because the stream has subscribers or is hashed.
    pub fn is_wanted(&self) -> bool {
        self.hash.is_some() || self.port.is_wanted()
    }

    /// Returns memory for the next frame, or `None` if it is not needed or no memory is free.
    pub fn loan(&self, len: usize) -> Option<Frame> {
        self.unwanted.set(!self.is_wanted());
        if self.unwanted.get() {
            return None;
        }
        self.port.loan(len).map_err(|error| self.report(&error)).ok()
    }

    /// Sends a frame that was loaned here. The outcome must be passed to [`Outlet::record`].
    pub fn send(&self, frame: Option<Frame>) -> Outcome {
        let Some(frame) = frame else {
            return if self.unwanted.get() { Outcome::Unwanted } else { Outcome::Dropped };
        };
        let hash = self.hash.is_some().then(|| frame_hash(frame.header().stamp_ns, frame.payload()));
        match self.port.send(frame) {
            Ok(()) => Outcome::Sent(hash),
            Err(error) => self.failed(error),
        }
    }

    /// Counts a frame that took `busy` to make.
    pub fn record(&mut self, outcome: Outcome, busy: Duration) {
        match outcome {
            Outcome::Sent(hash) => {
                self.tally.frames += 1;
                self.tally.busy += busy;
                if let (Some(all), Some(hash)) = (&mut self.hash, hash) {
                    all.update(&hash.to_le_bytes());
                }
            }
            Outcome::Dropped => self.tally.dropped += 1,
            Outcome::Unwanted => {}
        }
    }

    /// Sends structs with the timestamp `stamp_ns`, and counts the frame.
    pub fn send_structs<T: Message>(&mut self, stamp_ns: u64, structs: &[T]) {
        if !self.is_wanted() && !self.port.keeps_messages() {
            return;
        }
        let outcome = match self.port.loan(size_of_val(structs)) {
            Ok(mut frame) => {
                frame.fill(stamp_ns, structs);
                self.send(Some(frame))
            }
            Err(error) => self.failed(error),
        };
        self.record(outcome, Duration::ZERO);
    }

    /// Sends the last frame to new subscribers.
    pub fn update(&self) {
        if let Err(error) = self.port.update() {
            self.report(&error);
        }
    }

    fn failed(&self, error: Error) -> Outcome {
        self.report(&error);
        if matches!(error, Error::HeldUp { .. }) {
            let _ = self.held_up.set(error);
        }
        Outcome::Dropped
    }

    fn report(&self, error: &Error) {
        tracing::warn!(topic = self.topic, %error, "frame dropped");
    }
}

/// The result of publishing a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// It was sent; with its hash if the stream is hashed.
    Sent(Option<u128>),
    /// There was no memory for it, or it could not be sent.
    Dropped,
    /// It was not made, because the stream has no subscribers.
    Unwanted,
}

fn frame_hash(stamp_ns: u64, payload: &[u8]) -> u128 {
    let mut hash = Xxh3::with_seed(stamp_ns);
    hash.update(payload);
    hash.digest128()
}
