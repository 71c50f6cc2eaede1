//! Crosstalk: pulses of other lidars that a receiver takes for its own.

use crate::ParameterError;
use crate::noise::Stream;

/// Crosstalk: pulses received from other lidars, which are not synchronised with the scanner.
///
/// A share of the firings receives one, at a range that is independent of the scene and uniformly distributed from 0 to
/// the largest range. It is as strong as the return of a white surface that faces the scanner at that range in clear
/// air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crosstalk {
    /// The share of the firings that receive a pulse of another lidar, 0 to 1.
    pub chance: f64,
}

impl Crosstalk {
    /// No other lidars.
    pub const NONE: Self = Self { chance: 0.0 };

    pub(super) fn check(self, range_max_m: f64) -> Result<(), ParameterError> {
        let wrong = |parameter, value, rule| Err(ParameterError::new("scanner", parameter, value, rule));
        if !(0.0..=1.0).contains(&self.chance) {
            return wrong("chance of crosstalk", self.chance, "0 to 1");
        }
        if self.chance > 0.0 && range_max_m == f64::INFINITY {
            return wrong("range_max_m", range_max_m, "finite where there is crosstalk");
        }
        Ok(())
    }

    /// Returns the range at which a firing receives a pulse of another lidar, if it does.
    pub(super) fn heard(self, noise: &Stream, firing: u32, range_max_m: f64) -> Option<f64> {
        if self.chance == 0.0 {
            return None;
        }
        let stream = Stream { channel: Stream::CROSSTALK, ..*noise };
        let uniform = |index| f64::from(stream.uniform(2 * firing + index));
        (uniform(0) < self.chance).then(|| uniform(1) * range_max_m)
    }
}
