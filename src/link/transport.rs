//! Zenoh, and nothing but it: bytes on keys between two machines.

use super::LinkError;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use zenoh::bytes::ZBytes;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::{CongestionControl, Priority};
use zenoh::{Config, Session, Wait as _};

/// Largest message that is taken from the network, bytes: eight frames of four million RGB pixels.
pub(super) const MAX_MESSAGE: usize = 128 << 20;
/// Longest key that a message is sent with, bytes.
const MAX_KEY: usize = 1024;

/// Settings of Zenoh that are not its defaults, as its configuration file names them.
const SETTINGS: &[(&str, &str)] = &[
    // Who is met is who was named: nobody is looked for, and nothing is told of others.
    ("scouting/multicast/enabled", "false"),
    ("scouting/gossip/enabled", "false"),
    // A peer that is not there at first, or goes, is called again and again. A call is given up after two and a half
    // seconds: TCP asks a cut line after 1, 2, 4, 8 … s, and one call would go on asking less and less often for ten.
    ("connect/timeout_ms", "-1"),
    ("connect/exit_on_failure", "false"),
    ("connect/retry", "{ period_init_ms: 250, period_max_ms: 500, period_increase_factor: 2 }"),
    ("transport/unicast/open_timeout", "2500"),
    // Each session may hold one unfinished message of `MAX_MESSAGE`. A robot and the machines that watch it are a handful;
    // further ones are refused.
    ("transport/unicast/max_sessions", "16"),
    // A peer that says nothing for two seconds is gone; it says something every half second.
    ("transport/link/tx/lease", "2000"),
    // Whoever sends waits for room, half a second for each piece of a message and two for all: it is the link that waits,
    // never the simulator, whose frames give way in shared memory. With Zenoh's own 1 and 50 ms large frames hardly ever
    // pass a narrow line. Longer waits make a cut cable last: see `Gate`. Without a limit (`CongestionControl::Block`) the
    // connection is closed under whoever waits, and the one that follows was seen to be cut off, too, while both sides
    // took it to be there (Zenoh 1.10.2).
    ("transport/link/tx/queue/congestion_control/drop/wait_before_drop", "500000"),
    ("transport/link/tx/queue/congestion_control/drop/max_wait_before_drop_fragments", "2000000"),
    // Buffers of a megabyte: a picture comes in a few reads.
    ("transport/link/rx/buffer_size", "1048576"),
];

/// How long a message waits for the first piece of room, as set above.
const PATIENCE: Duration = Duration::from_millis(500);
/// How long nothing is sent when a message has waited in vain.
const PAUSE: Duration = Duration::from_millis(100);

/// Where the other machine is, each as `tcp/HOST:PORT`.
#[derive(Debug, Clone, Default)]
pub struct Endpoints {
    /// Addresses of this machine, at which others are waited for.
    pub listen: Vec<String>,
    /// Addresses of others, which are called, again and again.
    pub connect: Vec<String>,
}

/// What Zenoh says, without the places in its sources where it says so.
fn words(error: &zenoh::Error) -> String {
    let said = error.to_string();
    said.split_once(" at /").map_or(said.as_str(), |(words, _)| words).to_owned()
}

/// How soon a message goes when others wait, too.
#[derive(Debug, Clone, Copy)]
pub(super) enum Urgency {
    /// Before all others.
    Command,
    /// Before pictures.
    Message,
    /// After what is small.
    Bulk,
}

/// A session with other machines.
pub(super) struct Transport {
    session: Session,
    gates: [Arc<Gate>; 3],
}

/// Where messages of one urgency go to Zenoh one after the other, and none while nothing moves.
///
/// Whoever waits for room in Zenoh holds a lock that Zenoh needs to give up a connection, too (1.10.2). When a cable was cut
/// and the threads of a dozen streams waited one after the other, that took ten seconds and more; the other machine had
/// long called again then, its new connection was taken for one more of the old, and closed with it. So after one that
/// has waited in vain nobody waits for a while, in which the lock is free.
#[derive(Default)]
struct Gate(Mutex<Option<Instant>>);

impl Gate {
    /// Sends, if others did not just find that nothing moves; whether it was tried.
    fn pass<E>(&self, send: impl FnOnce() -> Result<(), E>) -> Result<bool, E> {
        let mut closed_until = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let began = Instant::now();
        if closed_until.is_some_and(|until| began < until) {
            return Ok(false);
        }
        let sent = send();
        let now = Instant::now();
        *closed_until = (now - began >= PATIENCE).then(|| now + PAUSE);
        sent.map(|()| true)
    }
}

impl Transport {
    pub(super) fn open(endpoints: &Endpoints) -> Result<Self, LinkError> {
        let what = || {
            let calls = endpoints.connect.iter().map(|address| format!("--connect {address}"));
            let ears = endpoints.listen.iter().map(|address| format!("--listen {address}"));
            ears.chain(calls).collect::<Vec<_>>().join(" ")
        };
        let failed = |error: zenoh::Error| LinkError::Transport { what: what(), detail: words(&error) };
        let mut config = Config::default();
        for (key, value) in SETTINGS {
            config.insert_json5(key, value).map_err(failed)?;
        }
        config
            .insert_json5("transport/link/rx/max_message_size", &MAX_MESSAGE.to_string())
            .map_err(failed)?;
        // Set in any case: by default Zenoh listens on all addresses.
        for (key, addresses) in
            [("listen/endpoints", &endpoints.listen), ("connect/endpoints", &endpoints.connect)]
        {
            let addresses = serde_json::Value::from(addresses.clone()).to_string();
            config.insert_json5(key, &addresses).map_err(failed)?;
        }
        Ok(Self { session: zenoh::open(config).wait().map_err(failed)?, gates: Default::default() })
    }

    /// Machines, or routers, that there is a connection with.
    pub(super) fn peers(&self) -> usize {
        let info = self.session.info();
        info.peers_zid().wait().count() + info.routers_zid().wait().count()
    }

    /// The sending end of a key.
    pub(super) fn outlet(&self, key: String, urgency: Urgency) -> Result<Outlet, LinkError> {
        let failed = |error: zenoh::Error| LinkError::Transport {
            what: "opening a key for sending".into(),
            detail: words(&error),
        };
        let priority = match urgency {
            Urgency::Command => Priority::RealTime,
            Urgency::Message => Priority::InteractiveHigh,
            Urgency::Bulk => Priority::Data,
        };
        let publisher = self
            .session
            .declare_publisher(key)
            .congestion_control(CongestionControl::Drop)
            .priority(priority)
            .express(true)
            .wait()
            .map_err(failed)?;
        let gate = self.gates[urgency as usize].clone();
        let is_wanted = Arc::new(AtomicBool::new(false));
        let told = is_wanted.clone();
        // It is told what is, and then of changes.
        publisher
            .matching_listener()
            .callback(move |status| told.store(status.matching(), Ordering::Relaxed))
            .background()
            .wait()
            .map_err(failed)?;
        Ok(Outlet { publisher, gate, is_wanted })
    }

    /// The receiving end of a key, or of all that a pattern stands for. `taken` gets each message with the key that its
    /// sender put it on, in a thread of Zenoh's, which it must not hold up.
    pub(super) fn inlet(
        &self,
        key: String,
        taken: impl Fn(&str, &ZBytes) + Send + Sync + 'static,
    ) -> Result<Inlet, LinkError> {
        self.session
            .declare_subscriber(key)
            .callback(move |sample| {
                // A message in several pieces is copied to be read as one, so a key that is none is not read at all.
                let attachment = sample.attachment().filter(|bytes| bytes.len() <= MAX_KEY);
                let key = attachment.map(ZBytes::to_bytes).unwrap_or_default();
                taken(std::str::from_utf8(&key).unwrap_or_default(), sample.payload());
            })
            .wait()
            .map(Inlet)
            .map_err(|error| LinkError::Transport {
                what: "opening a key for receiving".into(),
                detail: words(&error),
            })
    }

    /// Ends it; who waits for room goes on.
    pub(super) fn close(&self) {
        if let Err(error) = self.session.close().wait() {
            tracing::debug!(%error, "the session did not end in order");
        }
    }
}

/// See [`Transport::outlet`].
pub(super) struct Outlet {
    publisher: Publisher<'static>,
    gate: Arc<Gate>,
    is_wanted: Arc<AtomicBool>,
}

impl Outlet {
    /// Whether somebody has the other end; costs a read of memory.
    pub(super) fn is_wanted(&self) -> bool {
        self.is_wanted.load(Ordering::Relaxed)
    }

    /// Sends a message, and waits while there is no room for it, as when the line is narrower than what is sent. False if
    /// it was not tried, since nothing moves; one that waits in vain is lost, too, and Zenoh does not say so.
    pub(super) fn put(&self, message: Vec<u8>) -> Result<bool, LinkError> {
        // Zenoh gives keys numbers, and after a connection was lost and made again a few messages were seen to arrive at
        // other keys than theirs (Zenoh 1.10.2). So each has its own with it.
        let key = self.publisher.key_expr().as_str().as_bytes();
        let sent = self.gate.pass(|| self.publisher.put(message).attachment(key).wait());
        sent.map_err(|error| LinkError::Transport {
            what: format!("sending {}", self.publisher.key_expr()),
            detail: words(&error),
        })
    }
}

/// See [`Transport::inlet`]; what comes is taken until it is dropped.
pub(super) struct Inlet(#[allow(dead_code, reason = "kept for its end")] Subscriber<()>);
