//! What a scanner fires.

use crate::simd::{LANES, Lanes};
use glam::DVec3;

/// A pulse of a laser.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Firing {
    /// Seconds after the beginning of the frame.
    pub time_s: f64,
    /// Where it starts, in the frame of the sensor (x ahead, y left, z up) as that is at the time.
    pub origin: DVec3,
    /// Which way it goes there; a unit vector.
    pub direction: DVec3,
    /// Which laser it is of, from 0.
    pub laser: u32,
}

/// Up to 64 firings, lane by lane.
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
