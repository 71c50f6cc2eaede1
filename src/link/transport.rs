//! [`Transport`]: sends bytes on keys between machines with Zenoh.

use super::LinkError;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use zenoh::bytes::ZBytes;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::{CongestionControl, Priority};
use zenoh::{Config, Session, Wait as _};

/// Largest message that is accepted from the network, bytes: about ten frames of four million RGB pixels.
pub(super) const MAX_MESSAGE: usize = 128 << 20;
/// Longest key that is attached to a message, bytes.
const MAX_KEY: usize = 1024;

/// Settings of Zenoh that differ from its defaults, by their names in its configuration file.
const SETTINGS: &[(&str, &str)] = &[
    // Only the given addresses are connected: no discovery of peers, and no gossip about others.
    ("scouting/multicast/enabled", "false"),
    ("scouting/gossip/enabled", "false"),
    // Connecting is repeated if a peer is not running yet or goes away. An attempt is given up after two and a half
    // seconds: TCP repeats its request after 1, 2, 4, 8 … s, so on a cut line one attempt would go on for ten seconds
    // with longer and longer gaps.
    ("connect/timeout_ms", "-1"),
    ("connect/exit_on_failure", "false"),
    ("connect/retry", "{ period_init_ms: 250, period_max_ms: 500, period_increase_factor: 2 }"),
    ("transport/unicast/open_timeout", "2500"),
    // Each session may hold one unfinished message of `MAX_MESSAGE`. A robot and the machines that watch it are a
    // handful; further sessions are refused.
    ("transport/unicast/max_sessions", "16"),
    // A peer that is silent for two seconds counts as gone; it sends a sign of life every half second.
    ("transport/link/tx/lease", "2000"),
    // A sender waits for room, half a second for each piece of a message and two seconds in total. Only the link's
    // threads wait, never the simulator, whose frames are overwritten in shared memory. With Zenoh's defaults of 1 and
    // 50 ms large frames hardly ever pass a narrow line. Longer waits delay the recovery from a cut cable: see `Gate`.
    // Without a limit (`CongestionControl::Block`) the connection was closed while senders waited, and the next
    // connection was sometimes cut off as well, while both sides still considered it open (Zenoh 1.10.2).
    ("transport/link/tx/queue/congestion_control/drop/wait_before_drop", "500000"),
    ("transport/link/tx/queue/congestion_control/drop/max_wait_before_drop_fragments", "2000000"),
    // With buffers of a megabyte an image is received in a few reads.
    ("transport/link/rx/buffer_size", "1048576"),
];

/// Longest wait of a message for the first piece of room, as set above.
const PATIENCE: Duration = Duration::from_millis(500);
/// Time for which nothing is sent after a message has waited in vain.
const PAUSE: Duration = Duration::from_millis(100);

/// Addresses of the connection, each as `tcp/HOST:PORT`.
#[derive(Debug, Clone, Default)]
pub struct Endpoints {
    /// Addresses of this machine, at which to wait for others.
    pub listen: Vec<String>,
    /// Addresses of other machines; connecting is repeated until it succeeds.
    pub connect: Vec<String>,
}

/// Returns Zenoh's message without the places in its source code.
fn words(error: &zenoh::Error) -> String {
    let said = error.to_string();
    said.split_once(" at /").map_or(said.as_str(), |(words, _)| words).to_owned()
}

/// The priority of a message when several wait.
#[derive(Debug, Clone, Copy)]
pub(super) enum Urgency {
    /// Before all others.
    Command,
    /// Before images.
    Message,
    /// After small messages.
    Bulk,
}

/// A session with other machines.
pub(super) struct Transport {
    session: Session,
    gates: [Arc<Gate>; 3],
}

/// Passes messages of one priority to Zenoh one after the other, and none while the connection is stuck.
///
/// A thread that waits for room in Zenoh holds a lock that Zenoh also needs to close a connection (1.10.2). When a
/// cable was cut and the threads of a dozen streams waited one after the other, closing took ten seconds and more. By
/// then the other machine had long connected again; its new connection was treated as part of the old one and closed
/// with it. So after a message has waited in vain, no thread waits for a while, and the lock is free.
#[derive(Default)]
struct Gate(Mutex<Option<Instant>>);

impl Gate {
    /// Sends, unless a message has just waited in vain. Returns whether it tried.
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
        // Always set, because by default Zenoh listens on all addresses.
        for (key, addresses) in
            [("listen/endpoints", &endpoints.listen), ("connect/endpoints", &endpoints.connect)]
        {
            let addresses = serde_json::Value::from(addresses.clone()).to_string();
            config.insert_json5(key, &addresses).map_err(failed)?;
        }
        Ok(Self { session: zenoh::open(config).wait().map_err(failed)?, gates: Default::default() })
    }

    /// Returns the number of connected machines and routers.
    pub(super) fn peers(&self) -> usize {
        let info = self.session.info();
        info.peers_zid().wait().count() + info.routers_zid().wait().count()
    }

    /// Opens the sending end of a key.
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
        let matching = is_wanted.clone();
        // The callback gets the current state, and then each change.
        publisher
            .matching_listener()
            .callback(move |status| matching.store(status.matching(), Ordering::Relaxed))
            .background()
            .wait()
            .map_err(failed)?;
        Ok(Outlet { publisher, gate, is_wanted })
    }

    /// Opens the receiving end of a key, or of all keys that match a pattern. `taken` gets each message with the key
    /// that its sender attached. It is called in a thread of Zenoh, which it must not hold up.
    pub(super) fn inlet(
        &self,
        key: String,
        taken: impl Fn(&str, &ZBytes) + Send + Sync + 'static,
    ) -> Result<Inlet, LinkError> {
        self.session
            .declare_subscriber(key)
            .callback(move |sample| {
                // A key in several pieces is copied into one, so one that is too long is not read at all.
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

    /// Closes the session. Threads that wait for room continue.
    pub(super) fn close(&self) {
        if let Err(error) = self.session.close().wait() {
            tracing::debug!(%error, "the session did not end in order");
        }
    }
}

/// The sending end of a key, from [`Transport::outlet`].
pub(super) struct Outlet {
    publisher: Publisher<'static>,
    gate: Arc<Gate>,
    is_wanted: Arc<AtomicBool>,
}

impl Outlet {
    /// Returns true if the key has a subscriber. This only reads an atomic.
    pub(super) fn is_wanted(&self) -> bool {
        self.is_wanted.load(Ordering::Relaxed)
    }

    /// Sends a message, and waits while there is no room for it, for example if the network is slow. Returns false if
    /// it did not try, because the connection is stuck. A message that waits in vain is lost as well, which Zenoh does
    /// not report.
    pub(super) fn put(&self, message: Vec<u8>) -> Result<bool, LinkError> {
        // Zenoh numbers keys, and after a connection was lost and made again a few messages were seen to arrive at
        // other keys than theirs (Zenoh 1.10.2). So each message carries its own key.
        let key = self.publisher.key_expr().as_str().as_bytes();
        let sent = self.gate.pass(|| self.publisher.put(message).attachment(key).wait());
        sent.map_err(|error| LinkError::Transport {
            what: format!("sending {}", self.publisher.key_expr()),
            detail: words(&error),
        })
    }
}

/// The receiving end of a key, from [`Transport::inlet`]. Messages are received until it is dropped.
pub(super) struct Inlet(#[allow(dead_code, reason = "kept for its end")] Subscriber<()>);
