//! MEMS scanners: one small mirror that oscillates about two axes.

use super::clock::{Clock, Ticks, turns};
use super::firing::{Firing, FiringLanes};
use crate::ParameterError;
use crate::simd::sin_cos;
use core::f64::consts::{FRAC_PI_2, TAU};
use glam::DVec3;

/// The waveform of a mirror's oscillation about an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wave {
    /// A sine, as of a mirror in resonance.
    Sine,
    /// A triangle: back and forth at constant speed.
    Triangle,
}

/// The oscillation of a mirror about one of its axes. The beam turns by twice the angle of the mirror.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MirrorAxis {
    /// The largest angle of the mirror to either side, in radians.
    pub amplitude_rad: f64,
    /// The frequency in cycles per minute.
    pub cycles_per_min: u32,
    /// The phase at time 0, in radians. At phase 0 the mirror passes its middle position, turning to the left or
    /// upwards.
    pub phase_rad: f64,
    /// The waveform.
    pub wave: Wave,
}

/// One laser and a mirror that oscillates about two axes.
///
/// Two sines draw a Lissajous figure; a sine and a triangle draw rows that are bent at their ends. The directions of
/// the beams follow from the reflection at the mirror, so the field of view has the distortion of a real device.
///
/// At rest the beam goes along +x. The laser is above the mirror, in the xz plane. The mirror turns to the left and
/// right in a frame that turns up and down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mems<'a> {
    /// The time from one firing to the next, in nanoseconds.
    pub firing_time_ns: u64,
    /// The angle between the laser's beam and the normal of the mirror at rest, in radians.
    pub incidence_rad: f64,
    /// The oscillations: to the left and right within the frame, and up and down together with the frame.
    pub axes: &'a [MirrorAxis; 2],
}

impl MirrorAxis {
    /// An axis about which the mirror does not move.
    pub const STILL: Self = Self { amplitude_rad: 0.0, cycles_per_min: 0, phase_rad: 0.0, wave: Wave::Sine };

    fn check(&self) -> Result<(), (&'static str, f64, &'static str)> {
        if !(0.0..FRAC_PI_2).contains(&self.amplitude_rad) {
            return Err(("amplitude_rad", self.amplitude_rad, "0 to less than π/2"));
        }
        if !(-TAU..=TAU).contains(&self.phase_rad) {
            return Err(("phase_rad", self.phase_rad, "-2π to 2π"));
        }
        Ok(())
    }

    /// Returns the angle of the mirror at a time, in radians.
    #[inline(always)]
    fn turned(&self, at_ns: i128) -> f64 {
        let cycles = turns(at_ns, self.cycles_per_min.into());
        match self.wave {
            Wave::Sine => self.amplitude_rad * sin_cos(cycles * TAU + self.phase_rad).0,
            Wave::Triangle => {
                // Quarters of a cycle, beginning at the middle position: up, down, down, up.
                let cycle = cycles + self.phase_rad / TAU;
                let quarters = (cycle - crate::simd::floor(cycle)) * 4.0;
                let share = if quarters < 1.0 {
                    quarters
                } else if quarters < 3.0 {
                    2.0 - quarters
                } else {
                    quarters - 4.0
                };
                self.amplitude_rad * share
            }
        }
    }
}

impl Mems<'_> {
    pub(super) fn check(&self, frame_time_ns: u64) -> Result<(), ParameterError> {
        let wrong = |parameter, value, rule| Err(ParameterError::new("scanner", parameter, value, rule));
        self.clock().check("firing_time_ns", frame_time_ns)?;
        for axis in self.axes {
            if let Err((parameter, value, rule)) = axis.check() {
                return wrong(parameter, value, rule);
            }
        }
        // The largest angle between the normal and the direction of the laser.
        let most = self.incidence_rad + self.axes[0].amplitude_rad + self.axes[1].amplitude_rad;
        if !(self.incidence_rad >= 0.0 && most < FRAC_PI_2) {
            let rule =
                "0 or more, and with both amplitudes less than π/2, so that light meets the mirror's face";
            return wrong("incidence_rad", self.incidence_rad, rule);
        }
        Ok(())
    }

    pub(super) fn clock(&self) -> Clock {
        Clock { tick_ns: self.firing_time_ns }
    }

    #[inline(always)]
    pub(super) fn fill(&self, ticks: &Ticks, (first, count): (usize, usize), lanes: &mut FiringLanes) {
        for lane in 0..count {
            let tick = (first + lane) as u64;
            let at_ns = ticks.in_minute_ns(tick);
            let [across, up] = self.axes;
            let direction = self.reflected(across.turned(at_ns), up.turned(at_ns));
            lanes.set(lane, &Firing { time_s: ticks.time_s(tick), origin: DVec3::ZERO, direction, laser: 0 });
        }
    }

    /// Returns the direction of the beam for these angles of the mirror.
    #[inline(always)]
    fn reflected(&self, across_rad: f64, up_rad: f64) -> DVec3 {
        let (sin, cos) = sin_cos(2.0 * self.incidence_rad);
        let beam = DVec3::new(-cos, 0.0, -sin);
        // At rest the normal is halfway between +x and the laser. The frame turns the mirror about y.
        let (left, ahead) = sin_cos(across_rad);
        let (sin, cos) = sin_cos(self.incidence_rad + up_rad);
        let normal = DVec3::new(ahead * cos, left, ahead * sin);
        beam - normal * (2.0 * beam.dot(normal))
    }
}
