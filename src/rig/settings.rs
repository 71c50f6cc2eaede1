//! [`Settings`]: the settings of a sensor that can be changed while it runs, their limits, and the text that changes
//! them.

use crate::description::model::{Noise, RaySensor};
use belvedere_bridge::Text;
use belvedere_bridge::payload::{SensorSettings, Setting};
use belvedere_sensors::ParameterError;
use belvedere_sensors::noise::GaussianNoise;

/// Lowest and highest number of frames per second. A period of 100 s is longer than any sensor's, one of 1 ms shorter
/// than a camera's.
const RATES_HZ: [f64; 2] = [0.01, 1000.0];
/// Lowest and highest factor of the light: six and a half stops in each direction.
const EXPOSURES: [f64; 2] = [0.01, 100.0];
/// Highest noise of a range in metres, if ranges are unlimited.
const MOST_RANGE_NOISE_M: f64 = 1000.0;

/// The settings, in the order of their names in [`NAMES`].
#[derive(Debug, Clone, Copy)]
pub struct Settings([Setting; 4]);

/// Names of the settings.
pub const NAMES: [&str; 4] = ["update_rate", "noise_mean", "noise_stddev", "exposure"];
const UPDATE_RATE: usize = 0;
const NOISE_MEAN: usize = 1;
const NOISE_STDDEV: usize = 2;
const EXPOSURE: usize = 3;

impl Settings {
    /// Creates the settings of a sensor of which only the rate can be changed.
    pub(super) fn new(rate_hz: f64) -> Self {
        let mut settings = [Setting::NONE; 4];
        settings[UPDATE_RATE] = setting(rate_hz, RATES_HZ);
        Self(settings)
    }

    /// Adds noise with this upper limit.
    #[must_use]
    pub(super) fn noise_of(mut self, noise: &Noise, most: f64) -> Self {
        self.0[NOISE_MEAN] = setting(noise.mean, [-most, most]);
        self.0[NOISE_STDDEV] = setting(noise.stddev, [0.0, most]);
        self
    }

    /// Adds the noise of ranges.
    #[must_use]
    pub(super) fn noise_of_ranges(self, ray: &RaySensor) -> Self {
        self.noise_of(&ray.noise, ray.range_max_m.min(MOST_RANGE_NOISE_M))
    }

    /// Adds an exposure.
    #[must_use]
    pub(super) fn with_exposure(mut self) -> Self {
        self.0[EXPOSURE] = setting(1.0, EXPOSURES);
        self
    }

    /// Returns the number of frames per second.
    pub fn update_rate_hz(&self) -> f64 {
        self.0[UPDATE_RATE].value
    }

    /// Returns the sensor's noise with these settings.
    ///
    /// # Errors
    /// If one of the settings is out of range.
    pub fn noise(&self, sensor: &GaussianNoise) -> Result<GaussianNoise, ParameterError> {
        let [mean, stddev] = [NOISE_MEAN, NOISE_STDDEV].map(|name| self.0[name].value as f32);
        GaussianNoise::new(sensor.config().mean(mean).stddev(stddev))
    }

    /// Returns the factor of the light.
    pub fn exposure(&self) -> f32 {
        self.0[EXPOSURE].value as f32
    }

    /// Returns true if every value is the same.
    pub fn is_same(&self, other: &Self) -> bool {
        // Compared by bits, so that NaN, for settings that a sensor does not have, equals itself.
        self.0.iter().zip(&other.0).all(|(one, other)| one.value.to_bits() == other.value.to_bits())
    }

    /// Returns the settings with the changes in a text: words `name=value`, separated by white space.
    ///
    /// # Errors
    /// A message about the first invalid word, with the allowed values.
    pub fn changed(&self, text: &str) -> Result<Self, String> {
        let mut changed = *self;
        let mut seen = [false; NAMES.len()];
        for word in text.split_whitespace() {
            let (name, value) = word.split_once('=').ok_or_else(|| {
                format!("'{word}' is not a setting; write NAME=VALUE for one of {}", self.in_words())
            })?;
            let index = self.find(name)?;
            if std::mem::replace(&mut seen[index], true) {
                return Err(format!("{name} is given twice; give it once"));
            }
            let Setting { min, max, .. } = self.0[index];
            changed.0[index].value = value
                .parse()
                .ok()
                .filter(|value| (min..=max).contains(value))
                .ok_or_else(|| format!("{name} is '{value}'; it must be a number from {min} to {max}"))?;
        }
        if !seen.contains(&true) {
            return Err(format!("no setting is given; write NAME=VALUE for one of {}", self.in_words()));
        }
        Ok(changed)
    }

    fn find(&self, name: &str) -> Result<usize, String> {
        let index = NAMES
            .iter()
            .position(|known| *known == name)
            .ok_or_else(|| format!("{name} is not a setting; this sensor has {}", self.in_words()))?;
        if self.0[index].value.is_nan() {
            return Err(format!("this sensor has no {name}; it has {}", self.in_words()));
        }
        Ok(index)
    }

    fn in_words(&self) -> String {
        let word = |(name, setting): (&&str, &Setting)| {
            (!setting.value.is_nan()).then(|| format!("{name} ({} to {})", setting.min, setting.max))
        };
        NAMES.iter().zip(&self.0).filter_map(word).collect::<Vec<_>>().join(", ")
    }

    /// Returns the settings as a message.
    pub fn message(&self, sensor: &str, topics: &[String]) -> SensorSettings {
        let mut message = SensorSettings {
            name: Text::cut(sensor),
            topics: [Text::EMPTY; 6],
            update_rate: self.0[UPDATE_RATE],
            noise_mean: self.0[NOISE_MEAN],
            noise_stddev: self.0[NOISE_STDDEV],
            exposure: self.0[EXPOSURE],
        };
        for (place, topic) in message.topics.iter_mut().zip(topics) {
            // A stream's name fits, because it could not have been opened otherwise.
            *place = Text::cut(topic.trim_start_matches('/'));
        }
        message
    }
}

/// Creates a setting whose limits include the described value.
fn setting(value: f64, [min, max]: [f64; 2]) -> Setting {
    Setting { value, min: min.min(value), max: max.max(value) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIDAR: Settings = Settings([
        Setting { value: 5.5, min: 0.01, max: 1000.0 },
        Setting { value: 0.0, min: -6.0, max: 6.0 },
        Setting { value: 0.01, min: 0.0, max: 6.0 },
        Setting::NONE,
    ]);

    #[test]
    fn words_change_the_settings_that_they_name() {
        let changed = LIDAR.changed(" update_rate=10\tnoise_mean=-0.5\n").unwrap();
        assert_eq!([changed.update_rate_hz(), changed.0[1].value, changed.0[2].value], [10.0, -0.5, 0.01]);
        assert!(LIDAR.is_same(&LIDAR) && !changed.is_same(&LIDAR));
        assert!(changed.changed("noise_mean=0 update_rate=5.5").unwrap().is_same(&LIDAR));
    }

    #[test]
    fn each_invalid_word_is_refused_with_a_reason() {
        for (text, says) in [
            (
                "",
                "no setting is given; write NAME=VALUE for one of update_rate (0.01 to 1000), noise_mean (-6 to 6)",
            ),
            ("update_rate", "'update_rate' is not a setting; write NAME=VALUE"),
            ("updaterate=3", "updaterate is not a setting; this sensor has update_rate"),
            ("iso=3", "iso is not a setting; this sensor has update_rate (0.01 to 1000), "),
            ("exposure=2", "this sensor has no exposure; it has update_rate"),
            ("update_rate=0", "update_rate is '0'; it must be a number from 0.01 to 1000"),
            ("update_rate=fast", "update_rate is 'fast'; it must be a number from 0.01 to 1000"),
            ("noise_stddev=nan", "noise_stddev is 'nan'; it must be a number from 0 to 6"),
            ("noise_stddev=-0.1", "noise_stddev is '-0.1'"),
            ("update_rate=1 update_rate=2", "update_rate is given twice"),
        ] {
            let refused = LIDAR.changed(text).unwrap_err();
            assert!(refused.starts_with(says), "{text}: {refused}");
        }
    }
}
