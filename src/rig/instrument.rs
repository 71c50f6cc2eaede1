//! [`Running`]: a running instrument, which turns true values into readings.

use super::{Opening, RigError};
use crate::description::model::{InstrumentPlugin, Sensor};
use belvedere_sensors::noise::{Instrument, InstrumentConfig, InstrumentState, Stream};

/// One of a sensor's instruments.
pub(super) struct Running<const N: usize> {
    instrument: Instrument<N>,
    state: InstrumentState<N>,
    stream: Stream,
    last_ns: Option<u64>,
}

impl<const N: usize> Running<N> {
    /// Creates the sensor's instrument with this number.
    pub(super) fn new(
        sensor: &Sensor,
        config: &InstrumentConfig<N>,
        number: u16,
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let instrument = Instrument::new(*config).map_err(|error| RigError::sensor(sensor, &error))?;
        let channel = Stream::INSTRUMENT + number;
        let stream = Stream { seed: opening.seed, sensor: opening.sensor, frame: 0, channel };
        Ok(Self { state: instrument.start(&stream), instrument, stream, last_ns: None })
    }

    /// Returns the reading for a true value.
    pub(super) fn read(&mut self, truth: [f64; N], frame: u64, stamp_ns: u64) -> [f64; N] {
        let period_s = self.period_s(stamp_ns);
        self.last_ns = Some(stamp_ns);
        self.instrument.measure(truth, period_s, &Stream { frame, ..self.stream }, &mut self.state)
    }

    /// Returns the variance of a reading: of white noise, of the constant bias, and of a drifting bias with a
    /// correlation time.
    pub(super) fn variance(&self, stamp_ns: u64) -> [f64; N] {
        let InstrumentConfig { bias_stddev, drift, drift_time_s, .. } = self.instrument.config();
        let white = self.instrument.config().white_stddev(self.period_s(stamp_ns));
        std::array::from_fn(|axis| {
            let drifts = drift[axis] > 0.0 && drift_time_s[axis].is_finite();
            let drifting = if drifts { 0.5 * drift[axis] * drift[axis] * drift_time_s[axis] } else { 0.0 };
            white[axis] * white[axis] + bias_stddev[axis] * bias_stddev[axis] + drifting
        })
    }

    fn period_s(&self, stamp_ns: u64) -> f64 {
        self.last_ns.map_or(0.0, |last_ns| stamp_ns.saturating_sub(last_ns) as f64 * 1e-9)
    }

    /// Restarts the instrument.
    pub(super) fn restart(&mut self) {
        (self.state, self.last_ns) = (self.instrument.start(&self.stream), None);
    }
}

/// Returns the covariance matrix, row by row, of these variances along the axes.
pub(super) fn covariance([x, y, z]: [f64; 3]) -> [f64; 9] {
    [x, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, z]
}

impl Opening<'_> {
    /// Returns topic and frame of an instrument's messages.
    pub(super) fn names(&self, sensor: &Sensor, plugin: &InstrumentPlugin) -> (String, String) {
        let is_free = plugin.topic.starts_with('/') || !self.entity.namespace.is_empty();
        let topic =
            if is_free { plugin.topic.clone() } else { format!("/{}/{}", self.entity.name, plugin.topic) };
        (topic, self.frame_id(sensor, &plugin.frame_name))
    }
}
