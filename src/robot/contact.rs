//! What a Kobuki feels: three bumpers, three cliff sensors, two wheels that may hang.
//!
//! - **Bumpers** are pressed by what touches the base's body at a height of 0.01 to 0.13 m, in sectors of 60° by the
//!   direction of the contact: left +90…+30°, centre ±30°, right −30…−90° (Kobuki's Gazebo plugin). A touch between
//!   two reports counts for the later one.
//! - **Cliff sensors** look down at three places and see a cliff where the floor is [`CLIFF_M`] away or more: on the
//!   floor it is 0.0316. One ray along the axis each (the plugin takes the first beam of a fan of ±2.5°).
//! - **A wheel** has dropped when it touches nothing, and there is nothing under its axle within its radius and
//!   [`WHEEL_TRAVEL_M`]. The plugin never says so. The wheels of our base do not move down; no data sheet gives their
//!   travel, so it is a value of ours: more than the 12 mm that a Kobuki climbs, and farther down than a cliff begins, so
//!   that over an edge the cliff sensors are the first.

use super::transforms::base_link;
use crate::description::model::{LinkIndex, Model};
use crate::world::physics::{ModelIndex, Physics};
use belvedere_sensors::Pose;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6};
use std::ops::RangeInclusive;

/// Heights over the floor that the bumpers feel, in m.
const BUMPER_HEIGHTS_M: RangeInclusive<f64> = 0.01..=0.13;
/// What is nearer than this touches, in m: physics holds a body that pushes a hair before a wall.
const BUMPER_GAP_M: f64 = 5e-4;
/// Distance of the floor at which there is a cliff, in m.
pub const CLIFF_M: f64 = 0.04;
/// Distance of the floor that the base stands on, in m.
const ON_FLOOR_M: f64 = 0.0316;
/// What the cliff sensors can measure, in m.
const CLIFF_RANGE_M: [f64; 2] = [0.01, 0.15];
/// How far down a wheel hangs when nothing holds it, in m.
pub const WHEEL_TRAVEL_M: f64 = 0.02;
/// Places of the cliff sensors left, centre, right on `base_link`, in m, for a model that has no links for them.
const CLIFF_PLACES_M: [DVec3; 3] = [
    DVec3::new(0.087_34, 0.136_01, 0.0214),
    DVec3::new(0.156, 0.0, 0.0214),
    DVec3::new(0.085, -0.136_01, 0.0214),
];
const CLIFF_LINKS: [&str; 3] =
    ["cliff_sensor_left_link", "cliff_sensor_front_link", "cliff_sensor_right_link"];

/// What the base feels; left, centre, right each, and left and right wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Contact {
    /// Whether the bumpers are pressed.
    pub bumper: [bool; 3],
    /// Whether there is no floor.
    pub cliff: [bool; 3],
    /// The cliff sensors' readings; see [`cliff_reading`].
    pub bottom: [u16; 3],
    /// Whether the wheels hang.
    pub wheel_drop: [bool; 2],
}

/// What the converter of a cliff sensor (12 bits) says of a distance in m: 76123 · atan2(0.995, distance in mm), the
/// formula of Kobuki's Gazebo plugin, which puts in metres and overflows.
pub fn cliff_reading(distance_m: f64) -> u16 {
    (76_123.0 * libm::atan2(0.995, distance_m * 1e3)).clamp(0.0, 4095.0) as u16
}

/// The sensors on their base.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactSensors {
    model: ModelIndex,
    base: LinkIndex,
    body: LinkIndex,
    /// A link, and in it the sensor, which looks along its x.
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

    /// What it feels before the first step, when physics has not looked around yet: the floor.
    pub(super) fn at_start() -> Contact {
        let bottom = [cliff_reading(ON_FLOOR_M); 3];
        Contact { bottom, ..Contact::default() }
    }

    /// Notices what touches the bumpers after a step.
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

    /// What the base feels now, and felt of bumps since the last report.
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

/// The bumper in a direction in rad to the left of ahead: 0 left, 1 centre, 2 right; none behind.
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
