//! Odometry of a Kobuki: distance from the wheels' encoders, heading from the gyro.
//!
//! The base reports 50 times a second ([`ODOMETRY_PERIOD_NS`], with exact timestamps). At each report the encoders are
//! read as 16-bit counters that wrap, and the heading is the integral of the gyro's rate, which comes in whole steps of
//! the L3G4200D chip. (Gazebo's plugin publishes at every physics step instead, uses the wheels' velocity without the
//! encoders' steps, and integrates the IMU's rate. The rate of the real base is used here, because consumers written
//! for the robot expect it.)

use belvedere_sensors::Pose;
use glam::{DQuat, DVec3};
use std::f64::consts::PI;

/// Time between two reports of the base, in ns: 50 Hz.
pub const ODOMETRY_PERIOD_NS: u64 = 20_000_000;

/// Turn of a wheel per encoder tick: 2π / (52 ticks · 6545/132 gear ratio), in rad.
pub const RAD_PER_TICK: f64 = 0.002_436_916_871_363_93;

/// Rate of turn per step of the gyro (L3G4200D at ±250 °/s), in rad/s.
pub const GYRO_STEP_RAD_S: f64 = 0.008_75 * PI / 180.0;

/// The base's report (`nav_msgs/Odometry`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Odometry {
    /// Time of the report in ns.
    pub stamp_ns: u64,
    /// Pose of the base in `odom`, its frame at the start.
    pub odom_from_base: Pose,
    /// Speed along the base's x in m/s, from the ticks since the last report.
    pub linear_m_s: f64,
    /// Speed along its y in m/s.
    pub lateral_m_s: f64,
    /// Rate of turn about the base's z in rad/s, from the gyro.
    pub angular_rad_s: f64,
}

/// Returns the 16-bit count, which wraps, of an encoder on a wheel that has turned by an angle.
pub fn encoder_count(wheel_rad: f64) -> u16 {
    libm::floor(wheel_rad / RAD_PER_TICK) as i64 as u16
}

/// Rounds a rate of turn to the gyro's steps.
pub fn gyro_reading(rate_rad_s: f64) -> f64 {
    libm::round(rate_rad_s / GYRO_STEP_RAD_S) * GYRO_STEP_RAD_S
}

/// Integrates the reports.
#[derive(Debug, Clone)]
pub struct Odometer {
    wheel_radius_m: f64,
    counts: [u16; 2],
    heading_rad: f64,
    x_m: f64,
    y_m: f64,
    latest: Odometry,
}

impl Odometer {
    /// Starts at the origin of `odom` with both wheels at the angle zero.
    pub fn new(wheel_radius_m: f64) -> Self {
        let latest = Odometry {
            stamp_ns: 0,
            odom_from_base: Pose::IDENTITY,
            linear_m_s: 0.0,
            lateral_m_s: 0.0,
            angular_rad_s: 0.0,
        };
        Self { wheel_radius_m, counts: [0; 2], heading_rad: 0.0, x_m: 0.0, y_m: 0.0, latest }
    }

    /// Restarts at the origin, at a time and with the counts at that time.
    pub fn reset(&mut self, stamp_ns: u64, counts: [u16; 2]) {
        (self.x_m, self.y_m, self.heading_rad) = (0.0, 0.0, 0.0);
        (self.counts, self.latest.stamp_ns) = (counts, stamp_ns);
    }

    /// Processes one report: the counts of the left and right encoder, and the gyro's heading in rad.
    ///
    /// The path since the last report is approximated as straight along the mean of both headings. For a distance d and
    /// a turn Δ the error is less than d·Δ²/24.
    pub fn update(&mut self, stamp_ns: u64, counts: [u16; 2], heading_rad: f64) -> Odometry {
        let turned = [0, 1].map(|wheel| {
            let ticks = counts[wheel].wrapping_sub(self.counts[wheel]) as i16;
            f64::from(ticks) * RAD_PER_TICK
        });
        let distance_m = self.wheel_radius_m * 0.5 * (turned[0] + turned[1]);
        let (sin, cos) = libm::sincos(0.5 * (self.heading_rad + heading_rad));
        self.x_m += distance_m * cos;
        self.y_m += distance_m * sin;
        let period_s = stamp_ns.saturating_sub(self.latest.stamp_ns) as f64 * 1e-9;
        let per_second = |way: f64| if period_s > 0.0 { way / period_s } else { 0.0 };
        let (half_sin, half_cos) = libm::sincos(0.5 * heading_rad);
        self.latest = Odometry {
            stamp_ns,
            odom_from_base: Pose::new(
                DVec3::new(self.x_m, self.y_m, 0.0),
                DQuat::from_xyzw(0.0, 0.0, half_sin, half_cos),
            ),
            linear_m_s: per_second(distance_m),
            lateral_m_s: 0.0,
            angular_rad_s: per_second(heading_rad - self.heading_rad),
        };
        self.counts = counts;
        self.heading_rad = heading_rad;
        self.latest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 60 m straight are 700 000 ticks: the counter wraps ten times.
    #[test]
    fn counters_wrap() {
        let mut odometer = Odometer::new(0.035);
        let mut wheel_rad = 0.0;
        for report in 1..=3000_u64 {
            wheel_rad += 0.02 / 0.035;
            odometer.update(report * ODOMETRY_PERIOD_NS, [encoder_count(wheel_rad); 2], 0.0);
        }
        let way = odometer.latest.odom_from_base.translation();
        assert!((way.x - 60.0).abs() < 0.035 * RAD_PER_TICK && way.y == 0.0, "{way}");
        assert!((odometer.latest.linear_m_s - 1.0).abs() < 0.035 * RAD_PER_TICK / 0.02);
    }

    #[test]
    fn backwards_counts_down() {
        let mut odometer = Odometer::new(0.035);
        let report = odometer.update(ODOMETRY_PERIOD_NS, [encoder_count(-1.0); 2], 0.0);
        assert!((report.odom_from_base.translation().x + 0.035).abs() < 0.035 * RAD_PER_TICK);
    }

    /// The ticks per metre that Kobuki's documents give.
    #[test]
    fn ticks_per_metre() {
        assert!((1.0 / (0.035 * RAD_PER_TICK) - 11724.41658).abs() < 1e-3);
    }

    #[test]
    fn a_circle_closes() {
        let mut odometer = Odometer::new(0.035);
        let reports = 1000_u64;
        for report in 1..=reports {
            let part = report as f64 / reports as f64;
            let counts = [encoder_count(part * 4.0 / 0.035); 2];
            odometer.update(report * ODOMETRY_PERIOD_NS, counts, part * 2.0 * PI);
        }
        assert!(odometer.latest.odom_from_base.translation().length() < 1e-3);
    }
}
