//! Formatting of numbers and poses.

use belvedere_sensors::Pose;
use glam::{DVec3, EulerRot};
use std::f64::consts::PI;

/// Returns `xyz … rpy …`, as URDF writes it; parts that are zero are omitted.
pub fn pose(pose: &Pose) -> String {
    let xyz = pose.translation();
    let (yaw, pitch, roll) = pose.rotation().to_euler(EulerRot::ZYX);
    // Every rotation has two such representations. Beyond a quarter turn, files use the one that only pitches.
    let flipped = DVec3::new(roll - PI.copysign(roll), PI.copysign(pitch) - pitch, yaw - PI.copysign(yaw));
    let is_tilted = roll.abs() + yaw.abs() > PI;
    let rpy = if is_tilted { flipped } else { DVec3::new(roll, pitch, yaw) };
    let mut parts = vec![format!("xyz {}", vector(xyz))];
    if rpy.abs().max_element() > 5e-7 {
        parts.push(format!("rpy {}", vector(rpy)));
    }
    parts.join(" ")
}

/// Returns a number with what it counts: `1 frame`, `2 frames`.
pub fn count(number: u64, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

/// Returns its numbers, separated by spaces.
pub fn vector(vector: DVec3) -> String {
    vector.to_array().map(number).join(" ")
}

/// Returns an angle in radians and degrees.
pub fn angle(radians: f64) -> String {
    format!("{} rad ({:.2}°)", number(radians), radians.to_degrees())
}

/// Returns a number with at most seven decimals and without trailing zeros.
pub fn number(value: f64) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    if value != 0.0 && value.abs() < 1e-6 {
        return format!("{value:e}");
    }
    let text = format!("{value:.7}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (30.0, "30"),
            (0.35, "0.35"),
            (-1.308_996_9, "-1.3089969"),
            (1e-7, "1e-7"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    #[allow(clippy::approx_constant, reason = "the articles' number, which is not π/2")]
    fn poses_are_written_as_urdf_writes_them() {
        let turned = Pose::from_xyz_rpy(DVec3::new(0.15, 0.0, 0.35), DVec3::new(0.1, -0.2, 0.3));
        assert_eq!(pose(&turned), "xyz 0.15 0 0.35 rpy 0.1 -0.2 0.3");
        assert_eq!(pose(&Pose::IDENTITY), "xyz 0 0 0");
        let upwards = Pose::from_xyz_rpy(DVec3::ZERO, DVec3::new(0.0, -1.5708, 0.0));
        assert_eq!(pose(&upwards), "xyz 0 0 0 rpy 0 -1.5708 0");
        let around = Pose::from_xyz_rpy(DVec3::ZERO, DVec3::new(0.0, 0.0, 3.0));
        assert_eq!(pose(&around), "xyz 0 0 0 rpy 0 0 3");
    }
}
