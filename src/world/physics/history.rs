//! The poses of bodies after the last steps, for sensors whose frames begin in the past.

use super::Body;
use belvedere_sensors::Pose;
use std::collections::VecDeque;

/// Poses of all bodies after each of the last steps.
#[derive(Debug, Default)]
pub(super) struct History {
    /// How far back poses are known. Nothing is kept if it is 0.
    window_ns: u64,
    steps: VecDeque<Step>,
}

#[derive(Debug)]
struct Step {
    time_ns: u64,
    poses: Vec<Pose>,
}

impl History {
    /// Keeps poses for this time, from now on.
    pub(super) fn keep(&mut self, window_ns: u64, time_ns: u64, bodies: &[Body]) {
        *self = Self { window_ns, steps: VecDeque::new() };
        self.add(time_ns, bodies);
    }

    /// Notes where bodies are now: after a step, or after they were moved by hand since. Of two notes of one time, the
    /// later one holds from then on and the earlier one before.
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

    /// Forgets bodies that are taken out.
    pub(super) fn remove(&mut self, bodies: std::ops::Range<usize>) {
        for step in &mut self.steps {
            let known = step.poses.len();
            step.poses.drain(bodies.start.min(known)..bodies.end.min(known));
        }
    }

    /// The pose of a body at a time before the last step; that of the first step which is known if that is later. None for
    /// a body that was not there.
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
