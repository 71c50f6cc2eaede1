//! Decides when a body rests, so that it may sleep and cost nothing.
//!
//! For rapier, a body is at rest if its speed is below a limit for half a second. But slow bodies are not at rest: a pendulum
//! turns round, and a crate begins to fall off its edge. Here a body is at rest if it has stayed within a millimetre for a
//! second, whatever its speed was. This notices an acceleration of 2 mm/s² from rest, and ignores the last digits of a pose. Only then rapier is allowed to put it to sleep, which it does once everything that the body touches may sleep, too.

use belvedere_sensors::Pose;
use rapier3d_f64::dynamics::RigidBody;

/// Time in ns that a body has to stay where it is before it may sleep.
const STILL_NS: u64 = 1_000_000_000;
/// Farthest distance in m that a point of it may move in this time.
const STILL_M: f64 = 0.001;
/// Time in s that rapier waits after that. A body that is woken up stays awake for this time.
const SLEEPY_S: f64 = 0.1;
/// A speed in m/s that no body reaches.
const ANY_SPEED: f64 = 1e6;

/// The pose near which a body has stayed, and the time since when.
#[derive(Debug)]
pub(super) struct Rest {
    pose: Pose,
    since_ns: u64,
    /// Distance from its origin to the farthest point of its shapes, in m.
    reach_m: f64,
    /// True if rapier may put it to sleep.
    may_sleep: bool,
    was_asleep: bool,
}

impl Rest {
    pub(super) fn new(pose: Pose, now_ns: u64) -> Self {
        Self { pose, since_ns: now_ns, reach_m: 0.0, may_sleep: false, was_asleep: false }
    }

    /// Takes a shape into account whose farthest point has this distance from the body's origin.
    pub(super) fn reach(&mut self, reach_m: f64) {
        self.reach_m = self.reach_m.max(reach_m);
    }

    /// Compares the body's pose after a step. Returns true if [`Rest::tell`] has to be called.
    pub(super) fn notice(&mut self, rigid: &RigidBody, pose: &Pose, now_ns: u64) -> bool {
        let is_asleep = rigid.is_sleeping();
        let has_woken = std::mem::replace(&mut self.was_asleep, is_asleep) && !is_asleep;
        if is_asleep {
            return false;
        }
        let turn = (self.pose.rotation().inverse() * pose.rotation()).xyz().length() * 2.0;
        let way_m = self.pose.translation().distance(pose.translation()) + turn * self.reach_m;
        if has_woken || way_m > STILL_M {
            (self.pose, self.since_ns) = (*pose, now_ns);
        }
        let may_sleep = now_ns - self.since_ns >= STILL_NS;
        std::mem::replace(&mut self.may_sleep, may_sleep) != may_sleep
    }

    /// Sets in rapier whether the body may sleep.
    pub(super) fn tell(&self, rigid: &mut RigidBody) {
        let activation = rigid.activation_mut();
        let bound = if self.may_sleep { ANY_SPEED } else { -1.0 };
        (activation.normalized_linear_threshold, activation.angular_threshold) = (bound, bound);
        activation.time_until_sleep = SLEEPY_S;
    }
}
