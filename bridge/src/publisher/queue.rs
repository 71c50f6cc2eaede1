//! [`Queue`]: the wait of a [lossless](Lossless) publisher for its consumers.

use std::{
    fmt,
    sync::{Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use iceoryx2::port::{BackpressureAction, BackpressureInfo};

use crate::{
    Consumer, Lossless, Node,
    stream::{Frames, ports},
};

/// Interval at which a publisher that waits for a consumer checks that it is still alive.
const CHECK_INTERVAL: Duration = Duration::from_millis(200);

/// The state of one publisher's wait.
pub(crate) struct Queue {
    lossless: Lossless,
    node: Node,
    state: Mutex<State>,
}

struct State {
    /// The ports that the publisher waits for, with their consumers.
    waited_for: Vec<(u128, Consumer)>,
    subscribers_seen: Vec<u128>,
    since: Instant,
    checked: Instant,
    held_up: Option<Consumer>,
}

impl Queue {
    pub(crate) fn new(lossless: Lossless, node: Node) -> Self {
        let now = Instant::now();
        let state = State {
            waited_for: Vec::new(),
            subscribers_seen: Vec::new(),
            since: now,
            checked: now,
            held_up: None,
        };
        Self { lossless, node, state: Mutex::new(state) }
    }

    /// Updates the list of consumers if the subscribers have changed since the previous frame. A subscriber that comes
    /// later cannot block this frame: its buffer is empty.
    pub(crate) fn look_at(&self, frames: &Frames) {
        let ports = ports::of_subscribers(frames);
        let mut state = self.state();
        if state.subscribers_seen == ports {
            return;
        }
        let all = self.lossless.consumers.is_empty();
        let mut consumers = ports::consumers(&self.node, frames);
        consumers.retain(|(_, consumer)| all || self.lossless.consumers.contains(&consumer.name));
        state.waited_for = consumers;
        state.subscribers_seen = ports;
    }

    /// Decides whether a frame waits on for a subscriber without room.
    pub(crate) fn wait(&self, full: &BackpressureInfo) -> BackpressureAction {
        let mut state = self.state();
        let now = Instant::now();
        if full.retries == 0 {
            (state.since, state.checked) = (now, now);
        }
        let Some((_, consumer)) = state.waited_for.iter().find(|(port, _)| *port == full.receiver_port_id)
        else {
            return BackpressureAction::DiscardData;
        };
        if (self.lossless.gives_up)(consumer) {
            return BackpressureAction::DiscardData;
        }
        if now - state.since >= self.lossless.patience {
            let consumer = consumer.clone();
            state.held_up.get_or_insert(consumer);
            return BackpressureAction::DiscardData;
        }
        if now - state.checked >= CHECK_INTERVAL {
            // This removes a killed consumer, which is then no longer waited for.
            state.checked = now;
            drop(state);
            self.node.clean_up_dead();
        }
        BackpressureAction::Retry
    }

    /// Returns the consumer that did not make room in time, if any.
    pub(crate) fn take_held_up(&self) -> Option<(Consumer, Duration)> {
        self.state().held_up.take().map(|consumer| (consumer, self.lossless.patience))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl fmt::Debug for Queue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Queue").field("lossless", &self.lossless).finish_non_exhaustive()
    }
}
