//! Fog, rain and snow between a scanner and the surfaces that it measures.

use super::beam::Beam;
use crate::ParameterError;
use crate::noise::{Stream, fill_standard_normal};
use crate::simd::{Level, sin_cos, sqrt};
use core::f64::consts::{FRAC_PI_4, LN_10, PI};

/// ln 20: at the visibility, a twentieth of the light remains.
const LN_20: f64 = 2.995_732_273_553_991;

/// The weather: fog, rain and snow.
///
/// Their extinctions α add up and attenuate each return by e^(−2αr).
///
/// Fog also sends back a part of each pulse itself, as in M. Hahner et al., "Fog simulation on real lidar point clouds
/// …", 2021, arXiv:2108.05249: a pulse of 20 ns, β = 0.046/visibility, β₀ = 10⁻⁶/π, and an optical crossover from 0.9
/// to 1 m.
///
/// Drops and flakes send pulses back one by one, as in V. Kilic et al. (LISA, 2021, arXiv:2107.07004). Their number
/// follows from the volume of the beam, and their power from the share of the beam that each covers. Those that are
/// weaker than the threshold of the [receiver](super::Receiver) are left out.
///
/// All of these are returns like those of surfaces. A scanner whose firings would detect more than 12 drops or flakes
/// on average is refused.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weather {
    /// The meteorological optical range in fog, in metres: 1 or more, ∞ without fog. α = ln 20/visibility.
    pub visibility_m: f64,
    /// Rain in millimetres per hour, 0 to 500. Its extinction is 1.45·R^0.64 dB/km.
    pub rain_mm_per_h: f64,
    /// Snow in millimetres of water per hour, 0 to 50. Its extinction is twice the cross section of the melted flakes.
    pub snow_mm_per_h: f64,
}

impl Weather {
    /// Clear air.
    pub const CLEAR: Self = Self { visibility_m: f64::INFINITY, rain_mm_per_h: 0.0, snow_mm_per_h: 0.0 };

    /// Returns the extinction α: the share of light that is lost per metre, for short distances.
    ///
    /// ```
    /// use belvedere_sensors::scanner::Weather;
    /// let fog = Weather { visibility_m: 49.93, ..Weather::CLEAR };
    /// assert!((fog.extinction_per_m() - 0.06).abs() < 1e-5);
    /// ```
    pub fn extinction_per_m(&self) -> f64 {
        let rain_db_per_km =
            if self.rain_mm_per_h > 0.0 { 1.45 * libm::pow(self.rain_mm_per_h, 0.64) } else { 0.0 };
        let snow = DropSizes::snow(self.snow_mm_per_h);
        // Twice the cross section of the flakes, from mm² to m² per m³.
        let snow =
            snow.map_or(0.0, |snow| PI * snow.intercept / (snow.slope * snow.slope * snow.slope) * 1e-6);
        LN_20 / self.visibility_m + rain_db_per_km * (LN_10 / 10_000.0) + snow
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let wrong = |parameter, value, rule| Err(ParameterError::new("scanner", parameter, value, rule));
        if self.visibility_m.is_nan() || self.visibility_m < 1.0 {
            return wrong("visibility_m of the weather", self.visibility_m, "1 m or more");
        }
        if !(0.0..=500.0).contains(&self.rain_mm_per_h) {
            return wrong("rain_mm_per_h of the weather", self.rain_mm_per_h, "0 to 500");
        }
        if !(0.0..=50.0).contains(&self.snow_mm_per_h) {
            return wrong("snow_mm_per_h of the weather", self.snow_mm_per_h, "0 to 50");
        }
        Ok(())
    }

    /// Checks that hardly any firing detects more drops than there is room for. `least` is the smallest power that is
    /// detected.
    pub(super) fn check_drops(&self, beam: &Beam, least: f64) -> Result<(), ParameterError> {
        const RAIN: &str = "number of raindrops that a firing notices on average";
        const SNOW: &str = "number of snowflakes that a firing notices on average";
        for (parameter, drops) in [RAIN, SNOW].into_iter().zip(Air::new(self, beam, least).drops) {
            let Some(Noticed { expected: value, .. }) = drops else { continue };
            if value.is_nan() || value > MOST_EXPECTED {
                let rule = "12 at most: reduce the rain or snow, the width of the beam, or the reach of the receiver";
                return Err(ParameterError::new("scanner", parameter, value, rule));
            }
        }
        Ok(())
    }
}

/// The size distribution of drops: `intercept`·e^(−`slope`·D) drops per cubic metre and millimetre of their diameter D.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DropSizes {
    /// The intercept N₀, per m³ and mm.
    pub intercept: f64,
    /// The slope Λ, per mm.
    pub slope: f64,
    /// The share of light that a drop sends back if it is hit in its middle: ((n − 1)/(n + 1))².
    pub reflectivity: f64,
}

impl DropSizes {
    /// Returns the distribution of rain in millimetres per hour, or `None` without rain (J. S. Marshall, W. Palmer,
    /// 1948).
    ///
    /// ```
    /// use belvedere_sensors::scanner::DropSizes;
    /// let drops = DropSizes::rain(30.0).unwrap().per_m3(0.05);
    /// assert!((drops - 3605.0).abs() < 1.0);
    /// ```
    pub fn rain(mm_per_h: f64) -> Option<Self> {
        let slope = || 4.1 * libm::pow(mm_per_h, -0.21);
        (mm_per_h > 0.0).then(|| Self { intercept: 8000.0, slope: slope(), reflectivity: of_index(1.328) })
    }

    /// Returns the distribution of snow in millimetres of water per hour, by the diameters of the melted flakes, or
    /// `None` without snow (K. L. S. Gunn, J. S. Marshall, 1958).
    pub fn snow(mm_per_h: f64) -> Option<Self> {
        let (intercept, slope) =
            (|| 3800.0 * libm::pow(mm_per_h, -0.87), || 2.55 * libm::pow(mm_per_h, -0.48));
        (mm_per_h > 0.0).then(|| Self {
            intercept: intercept(),
            slope: slope(),
            reflectivity: of_index(1.3031),
        })
    }

    /// Returns the number of drops per cubic metre that are larger than `least_mm` millimetres.
    pub fn per_m3(&self, least_mm: f64) -> f64 {
        self.intercept / self.slope * libm::exp(-self.slope * least_mm)
    }
}

fn of_index(n: f64) -> f64 {
    let share = (n - 1.0) / (n + 1.0);
    share * share
}

/// The largest number of drops of a kind that one firing detects.
const MOST_DROPS: usize = 32;
/// The largest mean number of drops of a kind that a firing may detect. At this mean, less than one firing in a million
/// has more than [`MOST_DROPS`].
const MOST_EXPECTED: f64 = 12.0;
/// The number of uniform and of normal random numbers for the drops of a kind. There is one uniform number for their
/// count and one for the size of each, and there are three normal numbers for the place of each.
const UNIFORMS: u32 = 64;
const NORMALS: u32 = 128;
const _: () = assert!(MOST_DROPS < UNIFORMS as usize && 3 * MOST_DROPS <= NORMALS as usize);
/// The largest number of echoes of the air to one firing: fog, and drops of two kinds.
pub(super) const MOST_IN_AIR: usize = 1 + 2 * MOST_DROPS;
/// The divergence of LISA's beam, which is assumed for drops if a beam has no width of its own.
const DIVERGENCE_RAD: f64 = 3e-3;

/// The air in front of a scanner, with everything that is computed once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Air {
    extinction: f64,
    /// The range at which fog sends most light back, and the power.
    fog: Option<[f64; 2]>,
    drops: [Option<Noticed>; 2],
}

impl Air {
    /// Computes the air for a beam and the smallest power that is detected.
    pub(super) fn new(weather: &Weather, beam: &Beam, least: f64) -> Self {
        let [across, up] = beam.divergence_rad;
        let angle = if across > 0.0 && up > 0.0 { sqrt(across * up) } else { DIVERGENCE_RAD };
        let drops = [DropSizes::rain(weather.rain_mm_per_h), DropSizes::snow(weather.snow_mm_per_h)];
        Self {
            extinction: weather.extinction_per_m(),
            fog: (weather.visibility_m < f64::INFINITY).then(|| fog(weather.visibility_m)),
            drops: drops.map(|sizes| sizes.map(|sizes| Noticed::new(sizes, angle, least))),
        }
    }

    /// Returns the share of light that remains on the way there and back.
    #[inline(always)]
    pub(super) fn clearness(&self, range: f64) -> f64 {
        if self.extinction == 0.0 { 1.0 } else { libm::exp(-2.0 * self.extinction * range) }
    }

    /// Returns range and power of the return of fog. `passing` gives the share of the beam that reaches the range where
    /// fog sends most light back.
    pub(super) fn fog(&self, passing: impl FnOnce(f64) -> f64) -> Option<[f64; 2]> {
        self.fog.map(|[range, power]| [range, power * passing(range)])
    }

    /// Calls `met` with range and power of each drop that one firing detects between two ranges.
    pub(super) fn for_each_drop(
        &self,
        level: Level,
        noise: &Stream,
        firing: u32,
        [nearest, farthest]: [f64; 2],
        mut met: impl FnMut([f64; 2]),
    ) {
        for (kind, drops) in self.drops.iter().enumerate() {
            let Some(drops) = drops else { continue };
            let number = 2 * firing + kind as u32;
            let chance = Stream { channel: Stream::DROPS, ..*noise };
            let uniform = |index| f64::from(chance.uniform(UNIFORMS * number + index));
            // A Poisson number by inversion; mostly 0.
            let (mut left, mut term, mut count) = (uniform(0), drops.none, 0);
            while left >= term && count < MOST_DROPS {
                left -= term;
                count += 1;
                term *= drops.expected / count as f64;
            }
            if count == 0 {
                continue;
            }
            let mut normals = [0.0; 3 * MOST_DROPS];
            let places = Stream { channel: Stream::DROPS + 1, ..*noise };
            let normals = &mut normals[..3 * count];
            fill_standard_normal(level, &places, NORMALS * number, normals);
            for (drop, normals) in normals.as_chunks::<3>().0.iter().enumerate() {
                let [x, y, z] = normals.map(f64::from);
                let range = drops.scale_m * sqrt(x * x + y * y + z * z);
                if range >= nearest && range < farthest {
                    let more_mm = -libm::log(uniform(1 + drop as u32)) / drops.sizes.slope;
                    met([range, drops.power(range, more_mm) * self.clearness(range)]);
                }
            }
        }
    }
}

/// The drops of one kind that are detected.
///
/// A drop of diameter D at range r covers (D/φr)² of a cone of angle φ, so it is detected if D ≥ c·r². There are
/// N₀/Λ·e^(−Λc·r²) such drops per m³. With the cross section of the cone, this is a Maxwell distribution of ranges with
/// a = Λc, and the excess of D over c·r² has an exponential distribution. The attenuation on such a short way is
/// neglected here.
#[derive(Debug, Clone, Copy)]
struct Noticed {
    sizes: DropSizes,
    angle_rad: f64,
    /// c, in millimetres per m².
    least_mm: f64,
    /// The mean number of drops that a firing detects, and the probability that it detects none.
    expected: f64,
    none: f64,
    /// 1/√(2a), in metres.
    scale_m: f64,
}

impl Noticed {
    fn new(sizes: DropSizes, angle_rad: f64, least: f64) -> Self {
        let least_mm = 1e3 * angle_rad * sqrt(least / sizes.reflectivity);
        let a = sizes.slope * least_mm;
        let volume = FRAC_PI_4 * angle_rad * angle_rad * sqrt(PI) / (4.0 * a * sqrt(a));
        let expected = volume * sizes.per_m3(0.0);
        Self {
            sizes,
            angle_rad,
            least_mm,
            expected,
            none: libm::exp(-expected),
            scale_m: 1.0 / sqrt(2.0 * a),
        }
    }

    /// Returns the power of a drop at a range in clear air, if it is `more_mm` larger than the smallest that is
    /// detected there.
    fn power(&self, range: f64, more_mm: f64) -> f64 {
        let covered = 1e-3 * (self.least_mm * range * range + more_mm) / (self.angle_rad * range);
        self.sizes.reflectivity * (covered * covered).min(1.0) / (range * range)
    }
}

/// Returns the range at which fog of this visibility sends most light back, and its power in units of a white surface
/// at 1 m.
fn fog(visibility_m: f64) -> [f64; 2] {
    /// The reflectivity β₀.
    const SURFACE: f64 = 1e-6 / PI;
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let (alpha, beta) = (LN_20 / visibility_m, 0.046 / visibility_m);
    // There is a single peak, which is found by golden-section search.
    let (mut low, mut high) = (CROSSOVER_M[0], CROSSOVER_M[1] + PULSE_M);
    for _ in 0..40 {
        let span = (high - low) * GOLDEN;
        let (left, right) = (high - span, low + span);
        if soft(alpha, left) < soft(alpha, right) { low = left } else { high = right }
    }
    let range = 0.5 * (low + high);
    [range, beta / SURFACE * soft(alpha, range)]
}

/// The ranges between which the field of view of the receiver comes to cover the beam.
const CROSSOVER_M: [f64; 2] = [0.9, 1.0];
/// The half-power width of the pulse, and the distance that the whole pulse reaches back.
const PULSE_S: f64 = 20e-9;
const LIGHT_M_PER_S: f64 = 299_792_458.0;
const PULSE_M: f64 = PULSE_S * LIGHT_M_PER_S;

/// Returns the power that fog of this extinction sends back in the moment of a range: ∫ sin²(πt/2τ)·e^(−2αx)/x²·ξ(x) dt
/// with x = R − ct/2.
fn soft(alpha: f64, range: f64) -> f64 {
    let at = |x: f64| {
        let (sin, _) = sin_cos(PI / PULSE_M * (range - x));
        let [from, to] = CROSSOVER_M;
        let seen = ((x - from) / (to - from)).clamp(0.0, 1.0);
        sin * sin * libm::exp(-2.0 * alpha * x) / (x * x) * seen
    };
    // Simpson's rule on both sides of the bend at 1 m. It integrates over x, that is, over ct/2 in metres.
    let between = |from: f64, to: f64, steps: u32| {
        if to <= from {
            return 0.0;
        }
        let step = (to - from) / f64::from(steps);
        let weight =
            |index: u32| if index == 0 || index == steps { 1.0 } else { f64::from(2 + 2 * (index % 2)) };
        (0..=steps).map(|index| weight(index) * at(from + step * f64::from(index))).sum::<f64>() * step / 3.0
    };
    let [from, to] = CROSSOVER_M;
    let begin = range - PULSE_M;
    let metres = between(from.max(begin), to.min(range), 8) + between(to.max(begin), range, 64);
    metres * (2.0 / LIGHT_M_PER_S)
}

#[cfg(test)]
mod tests {
    use super::{Air, Beam, MOST_DROPS, MOST_EXPECTED, Stream, Weather};
    use crate::simd::best_level;

    /// The smallest power that a receiver with a reach in metres detects.
    fn least(reach_m: f64) -> f64 {
        0.9 / (reach_m * reach_m)
    }

    #[test]
    fn hardly_any_firing_has_more_drops_than_there_is_memory_for() {
        let (mut term, mut beyond) = (libm::exp(-MOST_EXPECTED), 0.0);
        for k in 1..200 {
            term *= MOST_EXPECTED / f64::from(k);
            beyond += if k as usize > MOST_DROPS { term } else { 0.0 };
        }
        assert!(beyond < 1e-6, "{beyond} of firings");
    }

    #[test]
    fn the_number_of_drops_has_its_expected_mean_and_variance() {
        const FIRINGS: u32 = 40_000;
        // The last case has 11.9 drops per firing, and the widest beam.
        for (rain_mm_per_h, reach_m, width) in
            [(50.0, 1000.0, 3e-3), (500.0, 1000.0, 3e-3), (500.0, 362.0, 0.2)]
        {
            let weather = Weather { rain_mm_per_h, ..Weather::CLEAR };
            let beam = Beam { divergence_rad: [width; 2], ..Beam::RAY };
            weather.check_drops(&beam, least(reach_m)).unwrap();
            let air = Air::new(&weather, &beam, least(reach_m));
            let expected = air.drops[0].unwrap().expected;
            let noise = Stream { seed: 1, sensor: 0, frame: 0, channel: 0 };
            let (mut sum, mut squares) = (0.0, 0.0);
            for firing in 0..FIRINGS {
                let mut count = 0.0;
                air.for_each_drop(best_level(), &noise, firing, [0.0, f64::INFINITY], |_| count += 1.0);
                sum += count;
                squares += count * count;
            }
            let n = f64::from(FIRINGS);
            let mean = sum / n;
            let variance = squares / n - mean * mean;
            assert!((mean - expected).abs() < 4.0 * libm::sqrt(expected / n), "{mean}, not {expected}");
            let spread = libm::sqrt((expected + 2.0 * expected * expected) / n);
            assert!((variance - expected).abs() < 4.0 * spread, "{variance}, not {expected}");
        }
    }

    #[test]
    fn weather_with_too_many_drops_is_refused() {
        let refused = |weather: Weather, reach_m| {
            let beam = Beam { divergence_rad: [0.2; 2], ..Beam::RAY };
            weather.check_drops(&beam, least(reach_m)).unwrap_err().to_string()
        };
        let rain = Weather { rain_mm_per_h: 500.0, ..Weather::CLEAR };
        assert!(
            refused(rain, 1000.0)
                .starts_with("number of raindrops that a firing notices on average of the scanner is 5")
        );
        assert!(refused(rain, 1e300).contains(" is inf; it must be 12 at most"));
        let snow = Weather { snow_mm_per_h: 50.0, ..Weather::CLEAR };
        assert!(refused(snow, 1e6).starts_with("number of snowflakes"));
    }
}
