//! Time of flight: the phases of modulated light, mixed over the area that a pixel sees, and the range on which they
//! agree.

use super::check;
use super::turns::{sin_cos_of_turns, turns_of};
use crate::ParameterError;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};

/// The speed of light in m/s.
const LIGHT: f64 = 299_792_458.0;

/// The greatest number of frequencies.
pub(crate) const FREQUENCIES: usize = 3;

/// The greatest number of turns of the highest frequency in the ambiguity range.
const MOST_TURNS: f64 = 64.0;

/// Time of flight: a pixel measures the phases of the modulated light that returns to it, at one to three frequencies.
/// Light from several ranges adds up like waves: at a frequency f
///
/// range = c/(4πf) · arg Σ aₖ · exp(i·4πf·rₖ/c), up to multiples of c/(2f)
///
/// over the pixel and its eight neighbours, which represent its footprint with the weights of a normal distribution.
/// The amplitude aₖ is that weight · cos θₖ/rₖ². At edges, this produces flying pixels between foreground and
/// background.
///
/// With several frequencies, the range is the one on which all phases agree best. For each number of turns of the
/// highest frequency, the others take the best-fitting number of turns, and the range is the mean weighted by the
/// squares of the frequencies. The candidate with the least sum of squared phase errors is used. Pixels whose phases do
/// not agree, such as at edges, have no depth (NaN). Ranges beyond the common ambiguity range wrap around to near ones.
/// [Axial noise](super::AxialNoise) is then applied to the phases, so strong noise makes pixels miscount turns.
///
/// ```
/// use belvedere_sensors::device::depth_model::TimeOfFlight;
/// let kinect = TimeOfFlight { modulation_hz: [120e6, 80e6, 16e6], footprint_px: 0.5, most_off_rad: 0.45 };
/// // 8 MHz is the greatest common divisor.
/// assert!((kinect.ambiguity_m() - 18.737).abs() < 1e-3);
/// assert!((TimeOfFlight::of_one(80e6, 0.5).ambiguity_m() - 1.8737).abs() < 1e-4);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeOfFlight {
    /// Modulation frequencies in whole hertz, each 1000 to 10¹¹; all but the first may be 0 for none. The greatest is
    /// at most 64 times their greatest common divisor.
    pub modulation_hz: [f64; FREQUENCIES],
    /// Standard deviation of the footprint in pixels, 0 to 1.
    pub footprint_px: f64,
    /// Greatest root mean square of the phase errors with respect to the common range, 10⁻⁶ to 10 rad. With one
    /// frequency the error is always 0.
    pub most_off_rad: f64,
}

impl TimeOfFlight {
    /// Creates the model for light of a single frequency.
    #[must_use]
    pub const fn of_one(modulation_hz: f64, footprint_px: f64) -> Self {
        Self { modulation_hz: [modulation_hz, 0.0, 0.0], footprint_px, most_off_rad: 10.0 }
    }

    /// Returns the ambiguity range, after which ranges repeat.
    #[must_use]
    pub fn ambiguity_m(&self) -> f64 {
        LIGHT / (2.0 * self.common_hz())
    }

    /// The greatest common divisor of the frequencies.
    fn common_hz(&self) -> f64 {
        let divide = |mut a: u64, mut b: u64| {
            while b > 0 {
                (a, b) = (b, a % b);
            }
            a
        };
        self.modulation_hz.iter().fold(0, |common, hz| divide(common, libm::round(*hz) as u64)) as f64
    }

    fn highest_hz(&self) -> f64 {
        self.modulation_hz.into_iter().fold(0.0, f64::max)
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        for (index, hz) in self.modulation_hz.into_iter().enumerate() {
            if index == 0 || hz != 0.0 {
                check("time_of_flight.modulation_hz", hz, [1e3, 1e11])?;
            }
        }
        let range = [self.highest_hz() / MOST_TURNS, self.highest_hz()];
        check("frequency in common of time_of_flight.modulation_hz", self.common_hz(), range)?;
        check("time_of_flight.footprint_px", self.footprint_px, [0.0, 1.0])?;
        check("time_of_flight.most_off_rad", self.most_off_rad, [1e-6, 10.0])
    }
}

/// Ranges and cosines of incidence of sixteen pixels and their neighbours, row by row, column by column.
pub(crate) type Around<S> = [[[f32x16<S>; 2]; 3]; 3];

/// The modulated light of a checked device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ModulatedLight {
    /// The range of one turn of each frequency, the highest frequency first.
    turn_m: [f32; FREQUENCIES],
    /// Weight of each phase, by the square of its frequency; the weights sum to 1.
    shares: [f32; FREQUENCIES],
    count: usize,
    ambiguity: f32,
    /// Number of turns of the first frequency in the ambiguity range.
    turns: usize,
    /// Standard deviation of each phase, in turns, that causes a standard deviation of the range of 1 m.
    turns_per_metre: f32,
    /// Greatest sum of squares of the phase errors, in turns.
    most_off: f32,
    /// Weights of the pixel, of its four neighbours, and of the four at its corners.
    weights: [f32; 3],
}

impl ModulatedLight {
    pub(super) fn new(time_of_flight: &TimeOfFlight) -> Self {
        let variance = time_of_flight.footprint_px * time_of_flight.footprint_px;
        let weight =
            |squared: f64| if variance > 0.0 { libm::exp(-0.5 * squared / variance) as f32 } else { 0.0 };
        let mut hz = time_of_flight.modulation_hz;
        hz.sort_unstable_by(|a, b| b.total_cmp(a));
        let count = hz.iter().filter(|hz| **hz > 0.0).count();
        let squares: f64 = hz.iter().map(|hz| hz * hz).sum();
        let off = time_of_flight.most_off_rad / core::f64::consts::TAU;
        Self {
            turn_m: hz.map(|hz| if hz > 0.0 { (LIGHT / (2.0 * hz)) as f32 } else { 1.0 }),
            shares: hz.map(|hz| (hz * hz / squares) as f32),
            count,
            ambiguity: time_of_flight.ambiguity_m() as f32,
            turns: libm::round(hz[0] / time_of_flight.common_hz()) as usize,
            turns_per_metre: (2.0 * libm::sqrt(squares) / LIGHT) as f32,
            most_off: (off * off * count as f64) as f32,
            weights: [1.0, weight(1.0), weight(2.0)],
        }
    }

    /// Returns true if there are several frequencies, so that turns are counted and noise is in the phases.
    pub(crate) fn has_several(self) -> bool {
        self.count > 1
    }

    /// The ranges that sixteen pixels measure, with a standard deviation in metres and a normal number for each
    /// frequency. Ranges that are not finite are left unchanged.
    #[inline(always)]
    pub(crate) fn ranges<S: Simd>(
        self,
        simd: S,
        around: &Around<S>,
        (stddevs, normals): (f32x16<S>, [f32x16<S>; FREQUENCIES]),
    ) -> f32x16<S> {
        let [own, _] = around[1][1];
        let range = if self.has_several() {
            let mut phases = [f32x16::splat(simd, 0.0); FREQUENCIES];
            let scale = stddevs * self.turns_per_metre;
            for index in 0..self.count {
                let turns = own * (1.0 / self.turn_m[index]);
                let off = self.turns_off(simd, around, self.turn_m[index]) + scale * normals[index];
                let phase = (turns - turns.floor()) + off;
                phases[index] = phase - phase.floor();
            }
            self.agreed(simd, phases)
        } else {
            own + self.turns_off(simd, around, self.turn_m[0]) * self.turn_m[0]
        };
        let range = range - (range * (1.0 / self.ambiguity)).floor() * self.ambiguity;
        own.abs().simd_lt(f32x16::splat(simd, f32::INFINITY)).select(range, own)
    }

    /// The differences, in turns, between the phases of mixed light and those of the pixels' own ranges.
    #[inline(always)]
    fn turns_off<S: Simd>(self, simd: S, around: &Around<S>, turn_m: f32) -> f32x16<S> {
        let [own, _] = around[1][1];
        let number = |value: f32| f32x16::splat(simd, value);
        let (mut sine, mut cosine) = (number(0.0), number(0.0));
        for (y, row) in around.iter().enumerate() {
            for (x, &[range, incidence]) in row.iter().enumerate() {
                let weight = self.weights[usize::from(x != 1) + usize::from(y != 1)];
                // Relative to the pixel's own phase, so that the common part of a surface does not lose digits.
                let turns = (range - own) * (1.0 / turn_m);
                let [sin, cos] = sin_cos_of_turns(simd, turns - turns.round_ties_even());
                let amplitude = incidence * weight / (range * range);
                let counts = range.abs().simd_lt(number(f32::INFINITY)) & incidence.simd_gt(number(0.0));
                sine += counts.select(amplitude * sin, number(0.0));
                cosine += counts.select(amplitude * cos, number(0.0));
            }
        }
        turns_of(simd, sine, cosine)
    }

    /// The ranges on which phases, in turns, agree; NaN if they do not agree.
    #[inline(always)]
    fn agreed<S: Simd>(self, simd: S, phases: [f32x16<S>; FREQUENCIES]) -> f32x16<S> {
        let number = |value: f32| f32x16::splat(simd, value);
        let (mut best, mut least) = (number(f32::NAN), number(self.most_off));
        for turn in 0..self.turns {
            let first = (phases[0] + turn as f32) * self.turn_m[0];
            let (mut turned, mut mean) = ([phases[0] + turn as f32; FREQUENCIES], first * self.shares[0]);
            for index in 1..self.count {
                let (phase, turn_m) = (phases[index], self.turn_m[index]);
                turned[index] = phase + (first * (1.0 / turn_m) - phase).round_ties_even();
                mean += turned[index] * (turn_m * self.shares[index]);
            }
            let mut sum = number(0.0);
            for index in 0..self.count {
                let off = mean * (1.0 / self.turn_m[index]) - turned[index];
                sum += off * off;
            }
            let is_better = sum.simd_lt(least);
            best = is_better.select(mean, best);
            least = is_better.select(sum, least);
        }
        best
    }
}
