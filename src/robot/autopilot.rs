//! Autopilots for robots that receive no commands.

use super::Command;
use belvedere_sensors::Pose;
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_PI_2;

/// The autopilot that drives a robot while no command arrives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Autopilot {
    /// Drive round a rounded rectangle of 4.0 m × 2.4 m about the world's origin.
    #[default]
    Loop,
    /// Turn on the spot.
    Spin,
    /// Stand still.
    Still,
}

/// Rate of [`Autopilot::Spin`] in rad/s.
pub const SPIN_RAD_S: f64 = 0.6;

impl Autopilot {
    /// Returns the start pose of a robot: on the path of [`Autopilot::Loop`], else at the origin, facing along x.
    pub fn start_pose(self) -> Pose {
        match self {
            Self::Loop => LoopPath::DEFAULT.start_pose(),
            Self::Spin | Self::Still => Pose::IDENTITY,
        }
    }

    /// Returns the command for a robot at this true pose.
    pub fn command(self, world_from_base: &Pose) -> Command {
        match self {
            Self::Loop => LoopPath::DEFAULT.pursue(world_from_base),
            Self::Spin => Command::new(0.0, SPIN_RAD_S),
            Self::Still => Command::STOP,
        }
    }
}

/// A closed path: a rectangle with round corners, followed counter-clockwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopPath {
    /// Centre in the world's xy plane.
    pub centre: DVec2,
    /// Full extents along x and y in m.
    pub size: DVec2,
    /// Radius of the corners in m, at most half of either extent.
    pub corner_radius_m: f64,
    /// Speed along it in m/s.
    pub speed_m_s: f64,
    /// Distance along the path to the point that the robot aims at, in m.
    pub look_ahead_m: f64,
}

impl LoopPath {
    /// The path of [`Autopilot::Loop`].
    pub const DEFAULT: Self = Self {
        centre: DVec2::ZERO,
        size: DVec2::new(4.0, 2.4),
        corner_radius_m: 0.6,
        speed_m_s: 0.35,
        look_ahead_m: 0.35,
    };

    /// Returns the pose in the middle of the side at negative y, facing along x.
    pub fn start_pose(&self) -> Pose {
        Pose::from_translation(DVec3::new(self.centre.x, self.centre.y - 0.5 * self.size.y, 0.0))
    }

    /// Returns the lengths of the straights along x and y.
    fn straights(&self) -> [f64; 2] {
        [self.size.x, self.size.y].map(|extent| (extent - 2.0 * self.corner_radius_m).max(0.0))
    }

    /// Returns the length of one round in m.
    pub fn length_m(&self) -> f64 {
        let [along_x, along_y] = self.straights();
        2.0 * (along_x + along_y) + 4.0 * FRAC_PI_2 * self.corner_radius_m
    }

    /// Returns the point at a distance along the path, counted from the start of the straight at negative y.
    pub fn point_at(&self, way_m: f64) -> DVec2 {
        let length = self.length_m();
        let mut rest = way_m - length * libm::floor(way_m / length);
        let (straights, arc) = (self.straights(), FRAC_PI_2 * self.corner_radius_m);
        // Each side is a straight and the arc after it. The side's own axes point along it and inward.
        for side in 0..4 {
            let straight = straights[side % 2];
            if rest <= straight + arc {
                let local = if rest <= straight {
                    DVec2::new(rest, 0.0)
                } else {
                    let (sin, cos) = libm::sincos((rest - straight) / self.corner_radius_m);
                    DVec2::new(straight + self.corner_radius_m * sin, self.corner_radius_m * (1.0 - cos))
                };
                return self.side_origin(side) + rotate(local, side);
            }
            rest -= straight + arc;
        }
        self.side_origin(0)
    }

    /// Returns the start of a side's straight: side 0 is at negative y, the others follow counter-clockwise.
    fn side_origin(&self, side: usize) -> DVec2 {
        let [along_x, along_y] = self.straights();
        let half = self.size * 0.5;
        self.centre
            + match side {
                0 => DVec2::new(-0.5 * along_x, -half.y),
                1 => DVec2::new(half.x, -0.5 * along_y),
                2 => DVec2::new(0.5 * along_x, half.y),
                _ => DVec2::new(-half.x, 0.5 * along_y),
            }
    }

    /// Returns the distance along the path to its point nearest to `point`, and the distance between the two points.
    pub fn nearest(&self, point: DVec2) -> (f64, f64) {
        let (straights, radius) = (self.straights(), self.corner_radius_m);
        let arc = FRAC_PI_2 * radius;
        let mut best = (0.0, f64::INFINITY);
        let mut way = 0.0;
        for side in 0..4 {
            let straight = straights[side % 2];
            let local = rotate(point - self.side_origin(side), 4 - side);
            let on_straight = local.x.clamp(0.0, straight);
            let from_centre = local - DVec2::new(straight, radius);
            // Angle on the arc, counted from the end of the straight.
            let angle = libm::atan2(from_centre.x, -from_centre.y).clamp(0.0, FRAC_PI_2);
            for candidate in [way + on_straight, way + straight + angle * radius] {
                let distance = self.point_at(candidate).distance(point);
                if distance < best.1 {
                    best = (candidate, distance);
                }
            }
            way += straight + arc;
        }
        best
    }

    /// Returns the command of pure pursuit: a circle through the robot, along its x, and through the point
    /// `look_ahead_m` further on the path. Its curvature is 2·y/d² for that point at (x, y), d away, in the robot's
    /// frame (Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, CMU-RI-TR-92-01, 1992).
    pub fn pursue(&self, world_from_base: &Pose) -> Command {
        let position = world_from_base.translation();
        let (way, _) = self.nearest(DVec2::new(position.x, position.y));
        let target = self.point_at(way + self.look_ahead_m);
        let ahead = world_from_base.transform_vector(DVec3::X);
        let offset = target - DVec2::new(position.x, position.y);
        let heading = DVec2::new(ahead.x, ahead.y).normalize_or(DVec2::X);
        let (along, across) = (heading.dot(offset), heading.perp_dot(offset));
        if along < 0.0 {
            // The path runs in the other direction: turn on the spot.
            return Command::new(0.0, SPIN_RAD_S.copysign(across));
        }
        let curvature = 2.0 * across / offset.length_squared().max(1e-6);
        let angular_rad_s = self.speed_m_s * curvature;
        Command::new(self.speed_m_s, angular_rad_s)
    }
}

/// Rotates by a number of quarter turns to the left, exactly.
fn rotate(vector: DVec2, quarter_turns: usize) -> DVec2 {
    match quarter_turns % 4 {
        0 => vector,
        1 => DVec2::new(-vector.y, vector.x),
        2 => -vector,
        _ => DVec2::new(vector.y, -vector.x),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_is_closed_and_its_points_are_nearest_to_themselves() {
        let path = LoopPath::DEFAULT;
        let mut before = path.point_at(0.0);
        let steps = 1000;
        for step in 1..=steps {
            let way = path.length_m() * f64::from(step) / f64::from(steps);
            let point = path.point_at(way);
            assert!(point.distance(before) < path.length_m() / f64::from(steps) + 1e-9, "jump at {way}");
            let (found, distance) = path.nearest(point);
            let apart = (found - way).abs() % path.length_m();
            assert!(distance < 1e-9 && apart.min(path.length_m() - apart) < 1e-9, "{way} found as {found}");
            before = point;
        }
        assert!(before.distance(path.point_at(0.0)) < 1e-9);
    }

    #[test]
    fn it_starts_on_the_path_along_it() {
        let path = LoopPath::DEFAULT;
        let command = path.pursue(&path.start_pose());
        assert_eq!(command, Command::new(path.speed_m_s, 0.0));
    }
}
