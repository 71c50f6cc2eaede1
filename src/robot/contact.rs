//! A Kobuki's contact sensors: three bumpers, three cliff sensors, two wheel-drop sensors.
//!
//! - **Bumpers** are pressed by contacts with the base's body at a height of 0.01 to 0.13 m, in sectors of 60° by the
//!   direction of the contact: left +90…+30°, centre ±30°, right −30…−90° (Kobuki's Gazebo plugin). A contact between
//!   two reports counts for the later one.
//! - **Cliff sensors** look down at three places and report a cliff where the floor is [`CLIFF_M`] away or more; on the
//!   floor the distance is 0.0316. Each casts one ray along its axis (the plugin uses the first beam of a fan of
//!   ±2.5°).
//! - **A wheel** has dropped if it touches nothing, and there is nothing under its axle within its radius and
//!   [`WHEEL_TRAVEL_M`]. The plugin never reports that. Wheels do not move down in the simulation, and no data sheet
//!   gives their travel. The value is our choice: more than the 12 mm that a Kobuki climbs, and more than the distance
//!   at which a cliff begins, so that at an edge the cliff sensors react first.

use super::transforms::base_link;
use crate::description::model::{LinkIndex, Model};
use crate::world::physics::{ModelIndex, Physics};
use belvedere_sensors::Pose;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6};
use std::ops::RangeInclusive;

/// Heights above the floor at which bumpers detect contacts, in m.
const BUMPER_HEIGHTS_M: RangeInclusive<f64> = 0.01..=0.13;
/// Objects nearer than this count as touching, in m, because physics keeps a small gap between a body and a wall.
const BUMPER_GAP_M: f64 = 5e-4;
/// Distance of the floor from which a cliff is reported, in m.
pub const CLIFF_M: f64 = 0.04;
/// Distance of the floor that the base stands on, in m.
const ON_FLOOR_M: f64 = 0.0316;
/// Measuring range of the cliff sensors, in m.
const CLIFF_RANGE_M: [f64; 2] = [0.01, 0.15];
/// Distance by which an unsupported wheel hangs down, in m.
pub const WHEEL_TRAVEL_M: f64 = 0.02;
/// Positions of the cliff sensors left, centre, right on `base_link`, in m, for a model that has no links for them.
const CLIFF_PLACES_M: [DVec3; 3] = [
    DVec3::new(0.087_34, 0.136_01, 0.0214),
    DVec3::new(0.156, 0.0, 0.0214),
    DVec3::new(0.085, -0.136_01, 0.0214),
];
const CLIFF_LINKS: [&str; 3] =
    ["cliff_sensor_left_link", "cliff_sensor_front_link", "cliff_sensor_right_link"];

/// The state of the contact sensors: left, centre and right, and left and right wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Contact {
    /// Whether the bumpers are pressed.
    pub bumper: [bool; 3],
    /// Whether the cliff sensors report a cliff.
    pub cliff: [bool; 3],
    /// The cliff sensors' readings; see [`cliff_reading`].
    pub bottom: [u16; 3],
    /// Whether the wheels have dropped.
    pub wheel_drop: [bool; 2],
}

/// Returns a cliff sensor's reading (12 bits) at a distance in m: 76123 · atan2(0.995, distance in mm). This is the
/// formula of Kobuki's Gazebo plugin, which inserts metres and overflows.
pub fn cliff_reading(distance_m: f64) -> u16 {
    (76_123.0 * libm::atan2(0.995, distance_m * 1e3)).clamp(0.0, 4095.0) as u16
}

/// The contact sensors of a base.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactSensors {
    model: ModelIndex,
    base: LinkIndex,
    body: LinkIndex,
    /// The link, and the pose of the sensor in it, which looks along its x.
    cliff: [(LinkIndex, Pose); 3],
    wheels: [LinkIndex; 2],
    wheel_radius_m: f64,
    /// Bumpers that were touched since the last report.
    touched: [bool; 3],
}

impl ContactSensors {
    pub(super) fn new(model: &Model, index: ModelIndex, wheels: [LinkIndex; 2], wheel_radius_m: f64) -> Self {
        let base = base_link(model);
        let body = model.link_named("base_link").unwrap_or(base);
        let cliff = [0, 1, 2].map(|side| match model.link_named(CLIFF_LINKS[side]) {
            Some(link) => (link, Pose::IDENTITY),
            None => (body, Pose::from_xyz_rpy(CLIFF_PLACES_M[side], DVec3::Y * FRAC_PI_2)),
        });
        Self { model: index, base, body, cliff, wheels, wheel_radius_m, touched: [false; 3] }
    }

    /// Returns the state before the first step, when physics has detected no contacts yet: on the floor.
    pub(super) fn at_start() -> Contact {
        let bottom = [cliff_reading(ON_FLOOR_M); 3];
        Contact { bottom, ..Contact::default() }
    }

    /// Records contacts with the bumpers after a step.
    pub(super) fn notice(&mut self, physics: &Physics) {
        let base_from_world = physics.world_from_link(self.model, self.base).inverse();
        for touch in physics.touches(self.model, self.body, BUMPER_GAP_M) {
            let height_m = base_from_world.transform_point(touch.point).z;
            let outward = base_from_world.transform_vector(touch.outward);
            let is_beside = outward.z.abs() < 0.9;
            if is_beside
                && BUMPER_HEIGHTS_M.contains(&height_m)
                && let Some(side) = bumper_at(libm::atan2(outward.y, outward.x))
            {
                self.touched[side] = true;
            }
        }
    }

    /// Returns the current state, with all bumps since the last report.
    pub(super) fn report(&mut self, physics: &Physics) -> Contact {
        let distances_m = self.cliff.map(|(link, link_from_sensor)| {
            let world_from_sensor = physics.world_from_link(self.model, link) * link_from_sensor;
            let (origin, along) =
                (world_from_sensor.translation(), world_from_sensor.transform_vector(DVec3::X));
            let way_m = physics.cast_ray(origin, along, CLIFF_RANGE_M[1], self.model);
            way_m.map_or(CLIFF_RANGE_M[1], |way_m| way_m.max(CLIFF_RANGE_M[0]))
        });
        let world_from_base = physics.world_from_link(self.model, self.base);
        let up = world_from_base.transform_vector(DVec3::Z);
        let wheel_drop = self.wheels.map(|wheel| {
            let axle = physics.world_from_link(self.model, wheel).translation();
            let reach_m = self.wheel_radius_m + WHEEL_TRAVEL_M;
            physics.ground_normal(self.model, wheel, up).is_none()
                && physics.cast_ray(axle, -up, reach_m, self.model).is_none()
        });
        Contact {
            bumper: std::mem::take(&mut self.touched),
            cliff: distances_m.map(|distance_m| distance_m >= CLIFF_M),
            bottom: distances_m.map(cliff_reading),
            wheel_drop,
        }
    }
}

/// Returns the bumper in a direction, in rad to the left of ahead: 0 left, 1 centre, 2 right, `None` behind.
fn bumper_at(direction_rad: f64) -> Option<usize> {
    match direction_rad {
        angle if angle.abs() <= FRAC_PI_6 => Some(1),
        angle if angle.abs() > FRAC_PI_2 => None,
        angle => Some(if angle > 0.0 { 0 } else { 2 }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bumpers_have_their_sectors() {
        for (degrees, bumper) in [
            (0.0, Some(1)),
            (29.0, Some(1)),
            (31.0, Some(0)),
            (89.0, Some(0)),
            (91.0, None),
            (180.0, None),
            (-29.0, Some(1)),
            (-31.0, Some(2)),
            (-89.0, Some(2)),
            (-91.0, None),
        ] {
            assert_eq!(bumper_at(f64::to_radians(degrees)), bumper, "{degrees}");
        }
    }

    #[test]
    fn readings_fit_into_the_converter_and_fall_with_distance() {
        assert_eq!(cliff_reading(0.0316), 2396);
        assert_eq!(cliff_reading(0.01), 4095);
        assert_eq!(cliff_reading(0.15), 504);
        assert!(cliff_reading(CLIFF_M) < cliff_reading(0.0316));
    }
}
