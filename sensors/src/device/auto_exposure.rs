//! Automatic exposure: time and gain follow the mean of the frames.

use super::{DeviceConfig, Exposure, PixelFormat, Tone};
use crate::ParameterError;
use crate::srgb;

/// What a frame is metered by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Metering {
    /// All pixels alike.
    #[default]
    Mean,
    /// The middle half of the rows and columns counts four times.
    Centre,
}

/// How bright a frame is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameStatistics {
    /// Mean of the linear signal above the black level, as a share of the signal at which pixels saturate.
    pub mean: f64,
    /// Share of the pixels that are saturated.
    pub saturated: f64,
}

/// How exposure is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct AutoExposureConfig {
    /// The mean that is aimed at, as [`FrameStatistics::mean`]; 0.18 is a middle grey.
    pub target: f64,
    /// As a share of the target: as long as the mean is so near, nothing changes.
    pub tolerance: f64,
    /// Shortest and longest time of exposure in seconds.
    pub time_range_s: [f64; 2],
    /// Largest gain. It rises above 1 only where the longest time is not enough.
    pub most_gain: f64,
}

impl Default for AutoExposureConfig {
    /// To a middle grey within 5 %, from 20 µs to 33 ms, and a gain of 16.
    fn default() -> Self {
        Self { target: 0.18, tolerance: 0.05, time_range_s: [20e-6, 0.033], most_gain: 16.0 }
    }
}

impl AutoExposureConfig {
    setters! {
        /// Sets the mean that is aimed at.
        target: f64,
        /// Sets how near is near enough.
        tolerance: f64,
        /// Sets the shortest and longest time in seconds.
        time_range_s: [f64; 2],
        /// Sets the largest gain.
        most_gain: f64,
    }
}

/// Chooses the exposure of the next frame from how bright the last one was.
///
/// The signal is proportional to time and gain, so that one step is enough where nothing is saturated. Saturated pixels
/// hide how bright they are; where most are, the exposure is a sixteenth of what it was. No step is larger, either way.
/// The state is the exposure alone, and its arithmetic + − × ÷ in f64: the same frames give the same exposures.
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

/// The largest step of an exposure.
const LARGEST_STEP: f64 = 16.0;

impl AutoExposure {
    /// Checks the configuration; the first frame is taken with `start`.
    ///
    /// # Errors
    /// Names the parameter that is out of its range.
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

    /// The exposure of the frame that is to be taken.
    #[must_use]
    pub fn exposure(&self) -> Exposure {
        self.exposure
    }

    /// The exposure of the next frame, after one that was taken with the last.
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

/// Of eight rows the first two are looked at, so that of a mosaic all colours are.
const ROWS: usize = 8;
const LOOKED_AT: usize = 2;

/// Meters a picture of so many pixels across and down.
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
        // The parts left and right of the middle, and the middle.
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

/// What the values of a picture mean.
struct Scale {
    full: f64,
    black: f64,
    /// The signal at which pixels saturate, as a share of full scale above black.
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

    /// The signal of a value as a share of what saturates.
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
        /// What is so near to it counts as saturated.
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
            // Each value once, as often as it occurs.
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
