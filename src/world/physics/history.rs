//! The poses of bodies after the last steps, for sensors whose frames begin in the past.

use super::Body;
use belvedere_sensors::Pose;
use std::collections::VecDeque;

/// Poses of all bodies after each of the last steps.
#[derive(Debug, Default)]
pub(super) struct History {
    /// The time for which poses are kept; 0 to keep none.
    window_ns: u64,
    steps: VecDeque<Step>,
}

#[derive(Debug)]
struct Step {
    time_ns: u64,
    poses: Vec<Pose>,
}

impl History {
    /// Sets the time for which poses are kept.
    pub(super) fn keep(&mut self, window_ns: u64, time_ns: u64, bodies: &[Body]) {
        *self = Self { window_ns, steps: VecDeque::new() };
        self.add(time_ns, bodies);
    }

    /// Stores the current poses, after a step or after bodies were moved by a command. If poses are stored twice for the same
    /// time, the first ones end the interval before it, and the second ones begin the interval after it.
    pub(super) fn add(&mut self, time_ns: u64, bodies: &[Body]) {
        if self.window_ns == 0 {
            return;
        }
        // The first step that is kept is at the beginning of the window, or before it.
        let begin_ns = time_ns.saturating_sub(self.window_ns);
        let mut poses = Vec::new();
        while self.steps.get(1).is_some_and(|second| second.time_ns <= begin_ns) {
            poses = self.steps.pop_front().map(|step| step.poses).unwrap_or_default();
        }
        poses.clear();
        poses.extend(bodies.iter().map(|body| body.current));
        self.steps.push_back(Step { time_ns, poses });
    }

    /// Drops the poses of removed bodies.
    pub(super) fn remove(&mut self, bodies: std::ops::Range<usize>) {
        for step in &mut self.steps {
            let known = step.poses.len();
            step.poses.drain(bodies.start.min(known)..bodies.end.min(known));
        }
    }

    /// Returns the pose of a body at a time before the last step, or its first stored pose if the time is before that.
    /// Returns `None` for a body that did not exist.
    pub(super) fn pose(&self, body: usize, time_ns: u64) -> Option<Pose> {
        let next = self.steps.partition_point(|step| step.time_ns <= time_ns);
        let of = |step: &Step| step.poses.get(body).copied();
        let (Some(before), after) =
            (next.checked_sub(1).map(|index| &self.steps[index]), self.steps.get(next))
        else {
            return self.steps.front().and_then(of);
        };
        let Some(after) = after else { return of(before) };
        let Some(from) = of(before) else { return of(after) };
        let fraction = (time_ns - before.time_ns) as f64 / (after.time_ns - before.time_ns) as f64;
        Some(from.interpolate(&of(after)?, fraction))
    }
}
