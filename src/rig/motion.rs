//! [`Motion`]: the poses during a frame in which each ray has its own time.
//!
//! A frame's timestamp is the time at which it ends. Physics' history has the poses after each step and interpolates
//! between them, so its steps are the keyframes.

use super::RigContext;
use super::mount::Mount;
use belvedere_sensors::{Keyframe, Moment, Pose};

/// The keyframes of a frame.
#[derive(Debug, Default)]
pub(super) struct Motion {
    times_s: Vec<f64>,
    world_from_sensor: Vec<Pose>,
    /// For each time, the poses of all instances of the scene.
    world_from_instance: Vec<Pose>,
}

impl Motion {
    /// Fills in the keyframes of a frame of this duration that ends now. Before time 0 the poses are those at time 0.
    pub(super) fn fill(&mut self, context: &RigContext<'_>, mount: &Mount, frame_time_ns: u64) {
        self.times_s.clear();
        self.world_from_sensor.clear();
        self.world_from_instance.clear();
        let end_ns = context.stamp_ns;
        let step_ns = context.physics.step_ns();
        let mut add = |time_ns: u64, before_ns: u64| {
            self.times_s.push((frame_time_ns - before_ns) as f64 * 1e-9);
            self.world_from_sensor.push(mount.pose_at(context.physics, time_ns));
            context.scene.poses_at(context.physics, time_ns, &mut self.world_from_instance);
        };
        add(end_ns.saturating_sub(frame_time_ns), frame_time_ns);
        let last = end_ns.saturating_sub(1) / step_ns;
        for step in last.saturating_sub(frame_time_ns / step_ns)..=last {
            let time_ns = step * step_ns;
            if (1..frame_time_ns).contains(&(end_ns - time_ns)) {
                add(time_ns, end_ns - time_ns);
            }
        }
        add(end_ns, 0);
    }

    /// Returns the keyframes for a [moving shutter](belvedere_sensors::Shutter::Moving).
    pub(super) fn keyframes(&self) -> Vec<Keyframe<'_>> {
        let instances = self.world_from_instance.len() / self.times_s.len().max(1);
        let keyframe = |(index, &time_s): (usize, &f64)| Keyframe {
            time_s,
            at: Moment {
                world_from_sensor: self.world_from_sensor[index],
                world_from_instance: &self.world_from_instance[index * instances..][..instances],
            },
        };
        self.times_s.iter().enumerate().map(keyframe).collect()
    }
}
