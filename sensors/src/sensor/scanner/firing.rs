//! Firings of a scanner.

use crate::simd::{LANES, Lanes};
use glam::DVec3;

/// A laser pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Firing {
    /// The time in seconds after the beginning of the frame.
    pub time_s: f64,
    /// The origin in metres, in the frame of the sensor (x ahead, y left, z up) at the time of the firing.
    pub origin: DVec3,
    /// The direction in that frame; a unit vector.
    pub direction: DVec3,
    /// The number of the laser, counted from 0.
    pub laser: u32,
}

/// Up to 64 firings, one per lane.
pub(super) struct FiringLanes {
    pub(super) time_s: Lanes<f64>,
    pub(super) origin: [Lanes<f64>; 3],
    pub(super) direction: [Lanes<f64>; 3],
    pub(super) laser: Lanes<u32>,
}

impl FiringLanes {
    pub(super) const fn new() -> Self {
        Self {
            time_s: [0.0; LANES],
            origin: [[0.0; LANES]; 3],
            direction: [[0.0; LANES]; 3],
            laser: [0; LANES],
        }
    }

    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, firing: &Firing) {
        self.time_s[lane] = firing.time_s;
        self.laser[lane] = firing.laser;
        for axis in 0..3 {
            self.origin[axis][lane] = firing.origin[axis];
            self.direction[axis][lane] = firing.direction[axis];
        }
    }

    #[inline(always)]
    pub(super) fn lane(&self, lane: usize) -> Firing {
        let of = |lanes: &[Lanes<f64>; 3]| DVec3::new(lanes[0][lane], lanes[1][lane], lanes[2][lane]);
        Firing {
            time_s: self.time_s[lane],
            origin: of(&self.origin),
            direction: of(&self.direction),
            laser: self.laser[lane],
        }
    }
}
