//! Poses of the robot that are not listed: along a path, or random in a region.

use crate::description::diagnostics::Source;
use belvedere_sensors::Pose;
use belvedere_sensors::noise::philox4x32;
use glam::DVec3;

/// Poses along a line through points, at equal distances, each facing along the line.
#[derive(Debug, Clone)]
pub(in crate::dataset) struct Route {
    points_m: Vec<DVec3>,
    pub(in crate::dataset) count: u64,
}

impl Route {
    /// Returns `None` for fewer than two points or poses, or two equal points in a row.
    pub(in crate::dataset) fn new(points_m: Vec<DVec3>, count: u64) -> Option<Self> {
        let is_way = points_m.len() > 1 && points_m.windows(2).all(|ends| ends[0] != ends[1]);
        (is_way && count > 1).then_some(Self { points_m, count })
    }

    /// Returns the pose with this number.
    pub(in crate::dataset) fn pose(&self, number: u64) -> Pose {
        let legs = || self.points_m.windows(2).map(|ends| (ends[0], ends[1] - ends[0]));
        let way: f64 = legs().map(|(_, leg)| leg.length()).sum();
        let mut left = way * number as f64 / (self.count - 1) as f64;
        let mut at = Pose::IDENTITY;
        for (start, leg) in legs() {
            let length = leg.length();
            let (yaw, pitch) = (libm::atan2(leg.y, leg.x), -libm::atan2(leg.z, leg.truncate().length()));
            at = Pose::from_xyz_rpy(start + leg * (left / length).min(1.0), DVec3::new(0.0, pitch, yaw));
            if left <= length {
                break;
            }
            left -= length;
        }
        at
    }
}

/// Random poses in a box, with ranges of angles.
#[derive(Debug, Clone)]
pub(in crate::dataset) struct Random {
    pub(in crate::dataset) count: u64,
    /// Lower and upper limit, in metres.
    pub(in crate::dataset) xyz: [DVec3; 2],
    /// Lower and upper limit, in radians.
    pub(in crate::dataset) rpy: [DVec3; 2],
    pub(in crate::dataset) clearance_m: f64,
    /// Its place in the plan's file.
    pub(in crate::dataset) source: Source,
}

impl Random {
    /// Returns one attempt at a pose, which depends only on these numbers.
    pub(in crate::dataset) fn draw(&self, seed: u64, world: usize, pose: u64, attempt: u32) -> Pose {
        let key = [seed as u32, (seed >> 32) as u32];
        let words = [0, 1].map(|half| {
            // The highest bit of the third word distinguishes the two halves; there are never that many worlds.
            philox4x32::<10>([pose as u32, attempt, world as u32 | half << 31, (pose >> 32) as u32], key)
        });
        let share = |place: usize| f64::from(words[place / 4][place % 4]) / 4_294_967_296.0;
        let between = |[low, high]: [DVec3; 2], first: usize| {
            low + (high - low) * DVec3::new(share(first), share(first + 1), share(first + 2))
        };
        Pose::from_xyz_rpy(between(self.xyz, 0), between(self.rpy, 3))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_route_goes_through_its_points_at_equal_distances() {
        let points = vec![DVec3::ZERO, DVec3::X * 2.0, DVec3::new(2.0, 1.0, 0.0)];
        let route = Route::new(points, 7).unwrap();
        let poses: Vec<Pose> = (0..7).map(|number| route.pose(number)).collect();
        for (number, pose) in poses.iter().enumerate() {
            let way = 0.5 * number as f64;
            let expected = DVec3::new(way.min(2.0), (way - 2.0).max(0.0), 0.0);
            assert!(pose.translation().distance(expected) < 1e-12, "{number}: {pose:?}");
        }
        assert_eq!(poses[1].rpy(), DVec3::ZERO);
        assert!((poses[6].rpy().z - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!(Route::new(vec![DVec3::ZERO; 2], 3).is_none());
    }
}
