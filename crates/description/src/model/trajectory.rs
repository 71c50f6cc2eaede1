//! [`Trajectory`]: the pose of an actor over time.

use belvedere_sensors::Pose;
use glam::DVec3;

/// The script of an actor: legs one after the other, each with its waypoints.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// Seconds before it begins.
    pub delay_s: f64,
    /// True if it begins again at its end; otherwise the actor stays there.
    pub repeats: bool,
    legs: Vec<Leg>,
}

/// A path through waypoints.
#[derive(Debug, Clone, PartialEq)]
pub struct Leg {
    /// Tension from 0, a Catmull–Rom spline, to 1: straight lines, with a stop at each waypoint.
    pub tension: f64,
    /// The waypoints, at least one, ordered by time.
    waypoints: Vec<Waypoint>,
}

/// The pose of an actor at a time of its leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint {
    /// Seconds since the leg began; not negative.
    pub time_s: f64,
    /// Pose of the actor in the world.
    pub world_from_actor: Pose,
}

impl Leg {
    /// Creates a leg through waypoints, which are sorted by time; of two with the same time the later one is used.
    /// None without waypoints.
    pub fn new(tension: f64, mut waypoints: Vec<Waypoint>) -> Option<Self> {
        waypoints.sort_by(|one, other| one.time_s.total_cmp(&other.time_s));
        waypoints.reverse();
        waypoints.dedup_by_key(|waypoint| waypoint.time_s.to_bits());
        waypoints.reverse();
        (!waypoints.is_empty()).then_some(Self { tension, waypoints })
    }

    /// Returns its duration in seconds.
    pub fn length_s(&self) -> f64 {
        self.waypoints.last().map_or(0.0, |last| last.time_s)
    }

    /// Returns the pose at a time. Before the first waypoint it is that of the first, after the last that of the last.
    fn pose_at(&self, time_s: f64) -> Pose {
        let points = &self.waypoints;
        let next = points.partition_point(|point| point.time_s <= time_s);
        let (Some(from), Some(to)) = (next.checked_sub(1), points.get(next)) else {
            let end = if next == 0 { points.first() } else { points.last() };
            return end.map_or(Pose::IDENTITY, |point| point.world_from_actor);
        };
        let fraction = (time_s - points[from].time_s) / (to.time_s - points[from].time_s);
        let turned = points[from].world_from_actor.interpolate(&to.world_from_actor, fraction);
        Pose::new(self.place(from, fraction), turned.rotation())
    }

    /// Interpolates between a waypoint and the next one with Hermite's cubic.
    fn place(&self, from: usize, fraction: f64) -> DVec3 {
        let (square, cube) = (fraction * fraction, fraction * fraction * fraction);
        self.point(from) * (2.0 * cube - 3.0 * square + 1.0)
            + self.tangent(from) * (cube - 2.0 * square + fraction)
            + self.point(from + 1) * (3.0 * square - 2.0 * cube)
            + self.tangent(from + 1) * (cube - square)
    }

    fn point(&self, index: usize) -> DVec3 {
        self.waypoints[index].world_from_actor.translation()
    }

    /// Returns the tangent at a waypoint: half the way between its neighbours, reduced by the tension. If a leg ends where it
    /// began, the neighbours wrap around; otherwise an end has one neighbour.
    fn tangent(&self, index: usize) -> DVec3 {
        let last = self.waypoints.len() - 1;
        let is_round = last > 1 && self.point(0).distance(self.point(last)) < 1e-6;
        let before = match index {
            0 if is_round => last - 1,
            _ => index.saturating_sub(1),
        };
        let after = if index == last && is_round { 1 } else { (index + 1).min(last) };
        (self.point(after) - self.point(before)) * (0.5 * (1.0 - self.tension))
    }
}

impl Trajectory {
    /// Creates a trajectory of legs in their order; none without legs.
    pub fn new(delay_s: f64, repeats: bool, legs: Vec<Leg>) -> Option<Self> {
        (!legs.is_empty()).then_some(Self { delay_s, repeats, legs })
    }

    /// Returns the duration of one round in seconds.
    pub fn length_s(&self) -> f64 {
        self.legs.iter().map(Leg::length_s).sum()
    }

    /// Returns the pose of the actor at a simulated time; none before the trajectory begins.
    pub fn pose_at(&self, time_ns: u64) -> Option<Pose> {
        let nanoseconds = |seconds: f64| (seconds * 1e9).round() as u64;
        let mut time_ns = time_ns.checked_sub(nanoseconds(self.delay_s))?;
        // In whole nanoseconds, so that rounds do not drift.
        let length_ns: u64 = self.legs.iter().map(|leg| nanoseconds(leg.length_s())).sum();
        if self.repeats && length_ns > 0 {
            time_ns %= length_ns;
        }
        let (last, legs) = self.legs.split_last()?;
        for leg in legs {
            let leg_ns = nanoseconds(leg.length_s());
            if time_ns < leg_ns {
                return Some(leg.pose_at(time_ns as f64 * 1e-9));
            }
            time_ns -= leg_ns;
        }
        Some(last.pose_at(time_ns as f64 * 1e-9))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn waypoint(time_s: f64, x: f64, y: f64, yaw: f64) -> Waypoint {
        let world_from_actor = Pose::new(DVec3::new(x, y, 0.0), DQuat::from_rotation_z(yaw));
        Waypoint { time_s, world_from_actor }
    }

    fn place(trajectory: &Trajectory, time_s: f64) -> [f64; 2] {
        let pose = trajectory.pose_at((time_s * 1e9) as u64).unwrap().translation();
        [pose.x, pose.y].map(|value| (value * 1e9).round() / 1e9)
    }

    #[test]
    fn an_actor_is_at_its_waypoints_at_their_times_in_any_order() {
        let points =
            vec![waypoint(4.0, 2.0, 2.0, 1.0), waypoint(0.0, 0.0, 0.0, 0.0), waypoint(2.0, 2.0, 0.0, 1.0)];
        let legs =
            vec![Leg::new(1.0, points).unwrap(), Leg::new(0.0, vec![waypoint(1.0, 7.0, 7.0, 0.0)]).unwrap()];
        let trajectory = Trajectory::new(1.5, true, legs).unwrap();
        assert_eq!(trajectory.length_s(), 5.0);
        assert_eq!(trajectory.pose_at(1_499_999_999), None);
        for round in [0.0, 5.0, 50.0] {
            assert_eq!(place(&trajectory, 1.5 + round), [0.0, 0.0]);
            // In the middle of a straight line with stops at its ends, and after a quarter: 3/16 − 2/64.
            assert_eq!(place(&trajectory, 2.5 + round), [1.0, 0.0]);
            assert_eq!(place(&trajectory, 2.0 + round), [2.0 * 0.15625, 0.0]);
            assert_eq!(place(&trajectory, 3.5 + round), [2.0, 0.0]);
            // The second leg stays at its one waypoint.
            assert_eq!(place(&trajectory, 5.6 + round), [7.0, 7.0]);
        }
        let angle = trajectory.pose_at(2_500_000_000).unwrap().rotation().to_axis_angle().1;
        assert!((angle - 0.5).abs() < 1e-12, "{angle}");
        let once = Trajectory { repeats: false, ..trajectory };
        assert_eq!(place(&once, 1000.0), [7.0, 7.0]);
    }

    #[test]
    fn without_tension_it_is_a_catmull_rom_spline() {
        // On a straight line at constant speed such a spline is the line itself.
        let points = (0..5).map(|second| waypoint(f64::from(second), f64::from(second) * 0.7, 0.0, 0.0));
        let straight = Trajectory::new(0.0, false, vec![Leg::new(0.0, points.collect()).unwrap()]).unwrap();
        assert_eq!(place(&straight, 1.25), [0.875, 0.0]);
        // Around a square: half-way along a side the spline is outside by an eighth of the sides' tangents.
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)];
        let points = (0..5).map(|corner| {
            waypoint(f64::from(corner), square[corner as usize].0, square[corner as usize].1, 0.0)
        });
        let round = Trajectory::new(0.0, true, vec![Leg::new(0.0, points.collect()).unwrap()]).unwrap();
        for (time, expected) in [(0.5, [0.5, -0.125]), (1.5, [1.125, 0.5]), (3.5, [-0.125, 0.5])] {
            assert_eq!(place(&round, time), expected);
        }
    }
}
