//! [`Tracker`]: odometry of bases other than a Kobuki, from the turns of the wheels or the true pose, as their plugins
//! specify.

use super::grip::Axle;
use super::odometry::Odometry;
use crate::description::model::{LinkIndex, OdometryOrigin, OdometryPlugin};
use crate::world::physics::{ModelIndex, Physics};
use belvedere_sensors::Pose;
use glam::{DQuat, DVec3};

/// Computes the odometry of a base.
#[derive(Debug)]
pub(super) struct Tracker {
    model: ModelIndex,
    link: LinkIndex,
    /// State of odometry from encoders; `None` for the true pose.
    wheels: Option<WheelTrack>,
    /// Origin of odometry from the true pose: the world's frame until odometry is reset.
    odom_from_world: Pose,
}

/// Odometry integrated from the turns of the wheels.
#[derive(Debug)]
struct WheelTrack {
    axle: Axle,
    radius_m: f64,
    separation_m: f64,
    /// Turns of the left and the right wheels after the last step.
    turned_rad: [f64; 2],
    /// x, y and heading after the last step but one, and after the last.
    before: [f64; 3],
    now: [f64; 3],
}

impl Tracker {
    /// Creates odometry from the true pose.
    pub(super) fn of_truth(model: ModelIndex, plugin: &OdometryPlugin) -> Self {
        Self { model, link: plugin.link, wheels: None, odom_from_world: Pose::IDENTITY }
    }

    /// Creates odometry as the plugin specifies, with wheels of this radius and separation in m.
    pub(super) fn of_axle(
        model: ModelIndex,
        plugin: &OdometryPlugin,
        axle: &Axle,
        radius_m: f64,
        separation_m: f64,
    ) -> Self {
        let wheels = (plugin.origin == OdometryOrigin::Encoders).then(|| WheelTrack {
            axle: axle.clone(),
            radius_m,
            separation_m,
            turned_rad: [0.0; 2],
            before: [0.0; 3],
            now: [0.0; 3],
        });
        Self { wheels, ..Self::of_truth(model, plugin) }
    }

    /// Processes a step.
    pub(super) fn observe(&mut self, physics: &Physics) {
        let Some(track) = &mut self.wheels else { return };
        let turned_rad = track.axle.turned_rad(physics, self.model, physics.time_ns());
        let [left_m, right_m] =
            [0, 1].map(|side| track.radius_m * (turned_rad[side] - track.turned_rad[side]));
        let [x, y, heading] = track.now;
        let (way_m, turn) = (0.5 * (left_m + right_m), (right_m - left_m) / track.separation_m);
        let (sin, cos) = libm::sincos(heading + 0.5 * turn);
        track.turned_rad = turned_rad;
        track.before = track.now;
        track.now = [x + way_m * cos, y + way_m * sin, heading + turn];
    }

    /// Resets odometry to zero at the current pose.
    pub(super) fn reset(&mut self, physics: &Physics) {
        self.odom_from_world = physics.world_from_link(self.model, self.link).inverse();
        if let Some(track) = &mut self.wheels {
            (track.before, track.now) = ([0.0; 3], [0.0; 3]);
        }
    }

    /// Returns odometry at a time between the last two steps. Speeds are those of the last step.
    pub(super) fn odometry_at(&self, physics: &Physics, stamp_ns: u64) -> Odometry {
        let Some(track) = &self.wheels else {
            let world_from_base = physics.world_from_link_at(self.model, self.link, stamp_ns);
            let (linear, turn) = physics.link_velocity(self.model, self.link);
            let base_from_world = world_from_base.inverse();
            let linear = base_from_world.transform_vector(linear);
            return Odometry {
                stamp_ns,
                odom_from_base: self.odom_from_world * world_from_base,
                linear_m_s: linear.x,
                lateral_m_s: linear.y,
                angular_rad_s: base_from_world.transform_vector(turn).z,
            };
        };
        let left_ns = physics.time_ns().saturating_sub(stamp_ns) as f64;
        let part = 1.0 - (left_ns / physics.step_ns() as f64).min(1.0);
        let at = |axis: usize| track.before[axis] + (track.now[axis] - track.before[axis]) * part;
        let (sin, cos) = libm::sincos(0.5 * at(2));
        let way = DVec3::new(track.now[0] - track.before[0], track.now[1] - track.before[1], 0.0);
        let (sin_now, cos_now) = libm::sincos(0.5 * (track.before[2] + track.now[2]));
        Odometry {
            stamp_ns,
            odom_from_base: Pose::new(DVec3::new(at(0), at(1), 0.0), DQuat::from_xyzw(0.0, 0.0, sin, cos)),
            linear_m_s: way.dot(DVec3::new(cos_now, sin_now, 0.0)) / physics.step_s(),
            lateral_m_s: 0.0,
            angular_rad_s: (track.now[2] - track.before[2]) / physics.step_s(),
        }
    }
}
