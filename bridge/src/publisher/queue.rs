//! [`Queue`]: how a publisher of a [lossless](Lossless) stream waits for its consumers.

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

/// How often, while a consumer is waited for, it is asked whether it still lives.
const CHECK_INTERVAL: Duration = Duration::from_millis(200);

/// What one publisher knows while it waits.
pub(crate) struct Queue {
    lossless: Lossless,
    node: Node,
    state: Mutex<State>,
}

struct State {
    /// Ports that are waited for, and whose they are.
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

    /// Learns who the subscribers are, if they are others than at the frame before. One that comes later cannot be
    /// in the way of this frame: it has an empty buffer.
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

    /// Whether a frame goes on waiting for a subscriber without room.
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
        if now - state.since >= self.lossless.patience {
            let consumer = consumer.clone();
            state.held_up.get_or_insert(consumer);
            return BackpressureAction::DiscardData;
        }
        if now - state.checked >= CHECK_INTERVAL {
            // One that was killed is let go by this, and waited for no longer.
            state.checked = now;
            drop(state);
            self.node.clean_up_dead();
        }
        BackpressureAction::Retry
    }

    /// Who did not take the frame in time, if somebody did not.
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
