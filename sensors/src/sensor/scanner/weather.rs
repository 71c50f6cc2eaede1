//! What stands in the air between a scanner and what it looks at.

use super::beam::Beam;
use crate::ParameterError;
use crate::noise::{Stream, fill_standard_normal};
use crate::simd::{Level, sin_cos, sqrt};
use core::f64::consts::{FRAC_PI_4, LN_10, PI};

/// ln 20: what is left of light at the visibility is a twentieth.
const LN_20: f64 = 2.995_732_273_553_991;

/// Fog, rain and snow.
///
/// Their extinctions α add up and take e^(−2αr) of what comes back. Fog besides sends a part of each pulse back itself, as
/// M. Hahner et al., "Fog simulation on real lidar point clouds …", 2021,
/// arXiv:2108.05249, have it: a pulse of 20 ns, β = 0.046/visibility, β₀ = 10⁻⁶/π, an optical crossover from 0.9 to
/// 1 m. Drops and flakes send pulses back one by one, as V. Kilic et al. (LISA, 2021, arXiv:2107.07004) have it: as many
/// as there are in the beam, each by the share of the beam that it covers; what is weaker than what the
/// [receiver](super::Receiver) notices is left out. All of that are returns among those of surfaces. A scanner whose firings
/// would notice more than 12 drops of a kind on average is refused.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weather {
    /// Meteorological optical range in fog, metres: 1 or more, ∞ without any. α = ln 20/visibility.
    pub visibility_m: f64,
    /// Rain, millimetres an hour, 0 to 500: 1.45·R^0.64 dB/km.
    pub rain_mm_per_h: f64,
    /// Snow, millimetres of water an hour, 0 to 50: twice the area of its melted flakes.
    pub snow_mm_per_h: f64,
}

impl Weather {
    /// Clear air.
    pub const CLEAR: Self = Self { visibility_m: f64::INFINITY, rain_mm_per_h: 0.0, snow_mm_per_h: 0.0 };

    /// The share of light that is lost on a metre of its way, for short ways: α.
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
        // In mm² of drops in a m³.
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

    /// Whether hardly any firing meets more drops than there is room for, of a beam and of the least that a receiver notices.
    pub(super) fn check_drops(&self, beam: &Beam, least: f64) -> Result<(), ParameterError> {
        const RAIN: &str = "number of raindrops that a firing notices on average";
        const SNOW: &str = "number of snowflakes that a firing notices on average";
        for (parameter, drops) in [RAIN, SNOW].into_iter().zip(Air::new(self, beam, least).drops) {
            let Some(Noticed { expected: value, .. }) = drops else { continue };
            if value.is_nan() || value > MOST_EXPECTED {
                let rule = "12 at most: by less of it, a narrower beam or a shorter reach of the receiver";
                return Err(ParameterError::new("scanner", parameter, value, rule));
            }
        }
        Ok(())
    }
}

/// How many drops there are of each size: `intercept`·e^(−`slope`·D) a cubic metre and a millimetre of their diameters D.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DropSizes {
    /// A m³ and mm.
    pub intercept: f64,
    /// A mm.
    pub slope: f64,
    /// What a drop sends back of light that meets its middle: ((n − 1)/(n + 1))².
    pub reflectivity: f64,
}

impl DropSizes {
    /// Rain of so many millimetres an hour; none without (J. S. Marshall, W. Palmer, 1948).
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

    /// Snow that is so many millimetres of water an hour, by the diameters of its melted flakes; none without
    /// (K. L. S. Gunn, J. S. Marshall, 1958).
    pub fn snow(mm_per_h: f64) -> Option<Self> {
        let (intercept, slope) =
            (|| 3800.0 * libm::pow(mm_per_h, -0.87), || 2.55 * libm::pow(mm_per_h, -0.48));
        (mm_per_h > 0.0).then(|| Self {
            intercept: intercept(),
            slope: slope(),
            reflectivity: of_index(1.3031),
        })
    }

    /// Drops in a cubic metre that are larger than so many millimetres.
    pub fn per_m3(&self, least_mm: f64) -> f64 {
        self.intercept / self.slope * libm::exp(-self.slope * least_mm)
    }
}

fn of_index(n: f64) -> f64 {
    let share = (n - 1.0) / (n + 1.0);
    share * share
}

/// Most drops of a kind that one firing notices.
const MOST_DROPS: usize = 32;
/// Most drops of a kind that a firing may notice on average. Of so many, less than one firing in a million has more than
/// [`MOST_DROPS`].
const MOST_EXPECTED: f64 = 12.0;
/// Uniform numbers and normals that there are for the drops of a kind: one for their count and one for the size of each, and
/// three for the place of each.
const UNIFORMS: u32 = 64;
const NORMALS: u32 = 128;
const _: () = assert!(MOST_DROPS < UNIFORMS as usize && 3 * MOST_DROPS <= NORMALS as usize);
/// Most echoes of the air to one firing: fog, and drops of two kinds.
pub(super) const MOST_IN_AIR: usize = 1 + 2 * MOST_DROPS;
/// Divergence of LISA's beam, which those without a width of their own have to drops.
const DIVERGENCE_RAD: f64 = 3e-3;

/// The air before a scanner, worked out once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Air {
    extinction: f64,
    /// Where fog sends most back, and how much.
    fog: Option<[f64; 2]>,
    drops: [Option<Noticed>; 2],
}

impl Air {
    /// With the least that the receiver notices.
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

    /// What is left of light on its way there and back.
    #[inline(always)]
    pub(super) fn clearness(&self, range: f64) -> f64 {
        if self.extinction == 0.0 { 1.0 } else { libm::exp(-2.0 * self.extinction * range) }
    }

    /// What the fog sends back of a beam, a share of which goes past where that is most: its range and power.
    pub(super) fn fog(&self, passing: impl FnOnce(f64) -> f64) -> Option<[f64; 2]> {
        self.fog.map(|[range, power]| [range, power * passing(range)])
    }

    /// The drops that one firing meets, as range and power, on its way up to a range.
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
            // Poisson's, by inversion: most often none.
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

/// The drops of one kind that are noticed.
///
/// A drop of diameter D at r covers (D/φr)² of a cone of angle φ, so it is noticed from D = c·r² on; of those there are
/// N₀/Λ·e^(−Λc·r²) a m³. On the cone's cross section that is a Maxwell distribution of ranges with a = Λc, and what D has
/// more than c·r² is an exponential distribution. What is lost on so short a way is left out here.
#[derive(Debug, Clone, Copy)]
struct Noticed {
    sizes: DropSizes,
    angle_rad: f64,
    /// c, millimetres a m².
    least_mm: f64,
    /// How many a firing meets, and how likely it is to meet none.
    expected: f64,
    none: f64,
    /// 1/√(2a).
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

    /// What comes back of a drop so much larger than what is noticed at a range, in clear air.
    fn power(&self, range: f64, more_mm: f64) -> f64 {
        let covered = 1e-3 * (self.least_mm * range * range + more_mm) / (self.angle_rad * range);
        self.sizes.reflectivity * (covered * covered).min(1.0) / (range * range)
    }
}

/// Where fog of a visibility sends most back, and how much in units of a white surface at 1 m.
fn fog(visibility_m: f64) -> [f64; 2] {
    /// β₀.
    const SURFACE: f64 = 1e-6 / PI;
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let (alpha, beta) = (LN_20 / visibility_m, 0.046 / visibility_m);
    // One peak: by the golden section.
    let (mut low, mut high) = (CROSSOVER_M[0], CROSSOVER_M[1] + PULSE_M);
    for _ in 0..40 {
        let span = (high - low) * GOLDEN;
        let (left, right) = (high - span, low + span);
        if soft(alpha, left) < soft(alpha, right) { low = left } else { high = right }
    }
    let range = 0.5 * (low + high);
    [range, beta / SURFACE * soft(alpha, range)]
}

/// Between these ranges a receiver comes to see the beam.
const CROSSOVER_M: [f64; 2] = [0.9, 1.0];
/// Half-power width of the pulse, and how far it reaches back, in all its length.
const PULSE_S: f64 = 20e-9;
const LIGHT_M_PER_S: f64 = 299_792_458.0;
const PULSE_M: f64 = PULSE_S * LIGHT_M_PER_S;

/// What fog of an extinction sends back to the moment of a range: ∫ sin²(πt/2τ)·e^(−2αx)/x²·ξ(x) dt of x = R − ct/2.
fn soft(alpha: f64, range: f64) -> f64 {
    let at = |x: f64| {
        let (sin, _) = sin_cos(PI / PULSE_M * (range - x));
        let [from, to] = CROSSOVER_M;
        let seen = ((x - from) / (to - from)).clamp(0.0, 1.0);
        sin * sin * libm::exp(-2.0 * alpha * x) / (x * x) * seen
    };
    // Simpson's rule on both sides of the bend at 1 m, in metres of x, of which ct/2 is one.
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

    /// The least that a receiver of a reach in metres notices.
    fn least(reach_m: f64) -> f64 {
        0.9 / (reach_m * reach_m)
    }

    #[test]
    fn hardly_any_firing_has_more_drops_than_are_taken() {
        let (mut term, mut beyond) = (libm::exp(-MOST_EXPECTED), 0.0);
        for k in 1..200 {
            term *= MOST_EXPECTED / f64::from(k);
            beyond += if k as usize > MOST_DROPS { term } else { 0.0 };
        }
        assert!(beyond < 1e-6, "{beyond} of firings");
    }

    #[test]
    fn as_many_drops_as_are_expected() {
        const FIRINGS: u32 = 40_000;
        // The last one has 11.9 drops a firing, and its beam is the widest.
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
    fn more_drops_than_there_is_room_for_are_refused() {
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
