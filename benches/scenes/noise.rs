//! Value noise on a lattice, and sums of its octaves.

use super::random::{mix, unit};
use glam::DVec3;

/// Returns a value in [−1, 1) for a point of the lattice.
fn lattice([x, y, z]: [i64; 3], seed: u64) -> f64 {
    let hash = (x as u64).wrapping_mul(0x8DA6_B343)
        ^ (y as u64).wrapping_mul(0xD816_3841)
        ^ (z as u64).wrapping_mul(0xCB1A_B31F)
        ^ seed;
    unit(mix(hash)) * 2.0 - 1.0
}

/// Returns smooth noise in [−1, 1].
fn noise(point: DVec3, seed: u64) -> f64 {
    let floor = point.floor();
    let corner = [floor.x as i64, floor.y as i64, floor.z as i64];
    let part = point - floor;
    let weight = part * part * (3.0 - 2.0 * part);
    let mut sum = 0.0;
    for step in 0..8 {
        let at = [step >> 2, step >> 1 & 1, step & 1];
        let mut term = lattice([corner[0] + at[0], corner[1] + at[1], corner[2] + at[2]], seed);
        for axis in 0..3 {
            term *= if at[axis] == 1 { weight[axis] } else { 1.0 - weight[axis] };
        }
        sum += term;
    }
    sum
}

/// Returns the sum of octaves of [`noise`]. Each has twice the frequency and `gain` times the amplitude of the previous
/// one.
pub fn octaves(point: DVec3, count: u32, seed: u64, gain: f64) -> f64 {
    let (mut height, mut frequency, mut sum) = (1.0, 1.0, 0.0);
    for octave in 0..count {
        let shift = 17.3 * f64::from(octave);
        sum += height * noise(point * frequency + shift, seed + u64::from(octave));
        height *= gain;
        frequency *= 2.0;
    }
    sum
}
