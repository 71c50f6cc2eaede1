//! Automatic exposure: exposure time and gain follow the mean brightness of the frames.

use super::{DeviceConfig, Exposure, PixelFormat, Tone};
use crate::ParameterError;
use crate::srgb;

/// The weighting of pixels when a frame is metered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Metering {
    /// All pixels have equal weight.
    #[default]
    Mean,
    /// Pixels in the middle half of the rows and columns have four times the weight.
    Centre,
}

/// The brightness of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameStatistics {
    /// Mean of the linear signal above the black level, as a fraction of the signal at which pixels saturate.
    pub mean: f64,
    /// Fraction of the pixels that are saturated.
    pub saturated: f64,
}

/// The parameters of automatic exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct AutoExposureConfig {
    /// The target for the mean ([`FrameStatistics::mean`]); 0.18 is a middle grey. The default is 0.18.
    pub target: f64,
    /// Tolerance as a fraction of the target: while the mean is within it, the exposure does not change. The default is
    /// 0.05.
    pub tolerance: f64,
    /// Shortest and longest exposure time in seconds. The default is 20 µs to 33 ms.
    pub time_range_s: [f64; 2],
    /// Largest gain. The gain rises above 1 only if the longest time is not enough. The default is 16.
    pub most_gain: f64,
}

impl Default for AutoExposureConfig {
    /// A target of middle grey within 5 %, times from 20 µs to 33 ms, and a gain of up to 16.
    fn default() -> Self {
        Self { target: 0.18, tolerance: 0.05, time_range_s: [20e-6, 0.033], most_gain: 16.0 }
    }
}

impl AutoExposureConfig {
    setters! {
        /// Sets the target for the mean.
        target: f64,
        /// Sets the tolerance as a fraction of the target.
        tolerance: f64,
        /// Sets the shortest and longest exposure time in seconds.
        time_range_s: [f64; 2],
        /// Sets the largest gain.
        most_gain: f64,
    }
}

/// Chooses the exposure of the next frame from the brightness of the last one.
///
/// The signal is proportional to exposure time and gain, so one step is enough if nothing is saturated. Saturated
/// pixels do not show how bright they are; if most pixels are saturated, the exposure is divided by sixteen. No step is
/// larger than that, in either direction. The exposure is the only state, and it is computed with +, −, × and ÷ in f64,
/// so the same frames give the same exposures.
///
/// ```
/// use belvedere_sensors::device::{AutoExposure, AutoExposureConfig, Exposure, FrameStatistics};
/// let start = Exposure { time_s: 0.004, gain: 1.0 };
/// let mut automatic = AutoExposure::new(AutoExposureConfig::default(), start)?;
/// let next = automatic.next(&FrameStatistics { mean: 0.09, saturated: 0.0 });
/// assert_eq!(next, Exposure { time_s: 0.008, gain: 1.0 });
/// # Ok::<(), belvedere_sensors::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AutoExposure {
    config: AutoExposureConfig,
    exposure: Exposure,
}

/// The largest factor between two successive exposures.
const LARGEST_STEP: f64 = 16.0;

impl AutoExposure {
    /// Creates an automatic exposure after checking its parameters; the first frame is taken with `start`.
    ///
    /// # Errors
    /// Names the parameter that is out of range.
    pub fn new(config: AutoExposureConfig, start: Exposure) -> Result<Self, ParameterError> {
        let [shortest, longest] = config.time_range_s;
        for (parameter, value, range) in [
            ("target", config.target, [1e-4, 0.9]),
            ("tolerance", config.tolerance, [0.0, 1.0]),
            ("time_range_s", shortest, [1e-9, 3600.0]),
            ("time_range_s", longest, [shortest, 3600.0]),
            ("most_gain", config.most_gain, [1.0, 1e6]),
            ("start.time_s", start.time_s, [1e-9, 3600.0]),
            ("start.gain", start.gain, [1e-3, 1e6]),
        ] {
            ParameterError::require_in("automatic exposure", parameter, value, range)?;
        }
        Ok(Self { config, exposure: start })
    }

    /// The exposure for the next frame.
    #[must_use]
    pub fn exposure(&self) -> Exposure {
        self.exposure
    }

    /// Returns the exposure for the next frame, given the statistics of a frame that was taken with the current
    /// exposure.
    pub fn next(&mut self, seen: &FrameStatistics) -> Exposure {
        let AutoExposureConfig { target, tolerance, time_range_s: [shortest, longest], most_gain } =
            self.config;
        if (seen.mean - target).abs() > tolerance * target {
            let wanted =
                if seen.saturated > 0.5 { 0.0 } else { target / seen.mean.max(target / LARGEST_STEP) };
            let step = wanted.clamp(1.0 / LARGEST_STEP, LARGEST_STEP);
            let product =
                (self.exposure.time_s * self.exposure.gain * step).clamp(shortest, longest * most_gain);
            let time_s = product.min(longest);
            self.exposure = Exposure { time_s, gain: product / time_s };
        }
        self.exposure
    }
}

/// Of every eight rows, the first two are metered, so that all colours of a mosaic are included.
const ROWS: usize = 8;
const LOOKED_AT: usize = 2;

/// Meters an image of the given width and height in pixels.
pub(crate) fn meter(
    pixels: &[u8],
    [width, height]: [usize; 2],
    format: PixelFormat,
    device: Option<&DeviceConfig>,
    metering: Metering,
) -> FrameStatistics {
    let scale = Scale::new(format, device);
    let (mut sum, mut saturated, mut count) = (0.0, 0_u64, 0_u64);
    let middle = |place: usize, size: usize| (size / 4..size - size / 4).contains(&place);
    let stride = width * format.bytes();
    for (y, row) in pixels.chunks_exact(stride).enumerate().filter(|(y, _)| y % ROWS < LOOKED_AT) {
        let edge = width / 4;
        // The parts to the left of the middle, the middle, and to the right.
        let parts = [
            (0, edge, 1),
            (edge, width - edge, if middle(y, height) { 4 } else { 1 }),
            (width - edge, width, 1),
        ];
        for (from, to, weight) in parts {
            let weight = if metering == Metering::Mean { 1 } else { weight };
            let part = &row[from * format.bytes()..to * format.bytes()];
            let tally = scale.tally(part, format);
            sum += tally.sum * weight as f64;
            saturated += tally.saturated * weight;
            count += tally.count * weight;
        }
    }
    let count = count.max(1) as f64;
    FrameStatistics { mean: sum / count, saturated: saturated as f64 / count }
}

/// The interpretation of an image's values.
struct Scale {
    full: f64,
    black: f64,
    /// The signal at which pixels saturate, as a fraction of full scale above black.
    most: f64,
    curved: bool,
}

struct Tally {
    sum: f64,
    saturated: u64,
    count: u64,
}

impl Scale {
    fn new(format: PixelFormat, device: Option<&DeviceConfig>) -> Self {
        let words = matches!(format, PixelFormat::Mono16 | PixelFormat::Bayer16(_));
        let Some(device) = device else {
            return Self { full: if words { 65_535.0 } else { 255.0 }, black: 0.0, most: 1.0, curved: false };
        };
        let top = f64::from(device.top_dn());
        let full = if words { top } else { 255.0 };
        let signal = device.dn_per_electron * device.exposure.gain * device.full_well_e;
        let most = (signal / (top - device.black_level_dn)).min(1.0);
        Self { full, black: device.black_level_dn / top * full, most, curved: device.tone != Tone::Raw }
    }

    /// The signal of a value, as a fraction of the signal at which pixels saturate.
    fn signal(&self, value: u16) -> f64 {
        let value = f64::from(value);
        let share = if self.curved {
            f64::from(srgb::decode((value / self.full) as f32))
        } else {
            (value - self.black) / (self.full - self.black)
        };
        share / self.most
    }

    fn tally(&self, part: &[u8], format: PixelFormat) -> Tally {
        /// From this signal on, a pixel counts as saturated.
        const SATURATED: f64 = 0.97;
        let (mut sum, mut saturated, mut count) = (0.0, 0, 0);
        let mut take = |value: u16, times: u32| {
            let signal = self.signal(value);
            sum += signal * f64::from(times);
            saturated += if signal >= SATURATED { u64::from(times) } else { 0 };
            count += u64::from(times);
        };
        if format.bytes() == 2 {
            for bytes in part.as_chunks::<2>().0 {
                take(u16::from_le_bytes(*bytes), 1);
            }
        } else {
            // Each value is converted once and weighted by its count.
            let mut times = [0_u32; 256];
            for pixel in part.chunks_exact(format.bytes()) {
                for byte in pixel.iter().take(3) {
                    times[usize::from(*byte)] += 1;
                }
            }
            for (value, times) in times.into_iter().enumerate().filter(|(_, times)| *times > 0) {
                take(value as u16, times);
            }
        }
        Tally { sum, saturated, count }
    }
}
