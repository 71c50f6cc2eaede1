//! Inertial measurement units: three gyros and three accelerometers, each triad an [`Instrument`].

use crate::ParameterError;
use crate::noise::{Instrument, InstrumentConfig, InstrumentState, Stream};
use glam::DVec3;

/// Errors of a unit's gyros, in rad/s, and accelerometers, in m/s². None at first.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct ImuConfig {
    /// Of rates of turn.
    pub gyro: InstrumentConfig<3>,
    /// Of specific forces.
    pub accelerometer: InstrumentConfig<3>,
}

impl ImuConfig {
    setters! {
        /// Of rates of turn.
        gyro: InstrumentConfig<3>,
        /// Of specific forces.
        accelerometer: InstrumentConfig<3>,
    }
}

/// A motion as it is felt, or what a unit reads of it, in the unit's axes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct InertialReading {
    /// In rad/s.
    pub angular_velocity: DVec3,
    /// In m/s²: acceleration less gravity, which is +g upwards at rest and 0 in free fall.
    pub specific_force: DVec3,
}

/// A running unit's biases, from [`Imu::start`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImuState {
    /// Of the gyros.
    pub gyro: InstrumentState<3>,
    /// Of the accelerometers.
    pub accelerometer: InstrumentState<3>,
}

/// An inertial measurement unit.
///
/// ```
/// use belvedere_sensors::imu::{Imu, InertialReading, presets};
/// use glam::DVec3;
/// let unit = Imu::new(presets::adis16448(), 7, 0)?;
/// let mut state = unit.start();
/// let bias = state.gyro.bias[2]; // of this run: sigma is 0.5 °/s
/// let rest = InertialReading { angular_velocity: DVec3::ZERO, specific_force: DVec3::Z * 9.81 };
/// let mut heading = 0.0;
/// for frame in 0..1000 {
///     heading += 0.01 * unit.measure(&rest, frame, 0.01, &mut state).angular_velocity.z;
/// }
/// assert!((heading - 10.0 * bias).abs() < 0.005 && bias.abs() < 3.0 * 0.5_f64.to_radians());
/// # Ok::<(), belvedere_sensors::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Imu {
    gyro: Instrument<3>,
    accelerometer: Instrument<3>,
    seed: u64,
    sensor: u32,
}

impl Imu {
    /// Of these errors, with the random numbers of a seed and a sensor's number.
    ///
    /// # Errors
    /// Names the first parameter that is out of range.
    pub fn new(config: ImuConfig, seed: u64, sensor: u32) -> Result<Self, ParameterError> {
        Ok(Self {
            gyro: Instrument::named("gyro", config.gyro)?,
            accelerometer: Instrument::named("accelerometer", config.accelerometer)?,
            seed,
            sensor,
        })
    }

    /// Its errors.
    pub const fn config(&self) -> ImuConfig {
        ImuConfig { gyro: *self.gyro.config(), accelerometer: *self.accelerometer.config() }
    }

    /// Begins a run.
    pub fn start(&self) -> ImuState {
        let [gyro, accelerometer] = self.streams(0);
        ImuState { gyro: self.gyro.start(&gyro), accelerometer: self.accelerometer.start(&accelerometer) }
    }

    /// What it reads of a motion in a frame that comes `period_s` after the one before: frames one after the other.
    pub fn measure(
        &self,
        truth: &InertialReading,
        frame: u64,
        period_s: f64,
        state: &mut ImuState,
    ) -> InertialReading {
        let [gyro, accelerometer] = self.streams(frame);
        let (turn, force) = (truth.angular_velocity.to_array(), truth.specific_force.to_array());
        let turn = self.gyro.measure(turn, period_s, &gyro, &mut state.gyro);
        let force = self.accelerometer.measure(force, period_s, &accelerometer, &mut state.accelerometer);
        InertialReading { angular_velocity: DVec3::from(turn), specific_force: DVec3::from(force) }
    }

    /// Of gyro and accelerometer.
    fn streams(&self, frame: u64) -> [Stream; 2] {
        let Self { seed, sensor, .. } = *self;
        [0, 1].map(|which| Stream { seed, sensor, frame, channel: Stream::INSTRUMENT + which })
    }
}

/// Units of data sheets.
pub mod presets {
    use super::{ImuConfig, InstrumentConfig};
    use core::f64::consts::PI;

    const DEGREE: f64 = PI / 180.0;
    const GRAVITY: f64 = 9.80665;

    /// Analog Devices ADIS16448, as flown on small helicopters: densities, bias walks and correlation times of the
    /// `RotorS` simulator's unit of that name, biases of a run, steps and ranges of the data sheet.
    #[must_use]
    pub fn adis16448() -> ImuConfig {
        let gyro = InstrumentConfig::default()
            .density([3.394e-4; 3])
            .drift([3.879e-5; 3])
            .drift_time_s([1000.0; 3])
            .bias_stddev([0.5 * DEGREE; 3])
            .precision([0.04 * DEGREE; 3])
            .limit(1000.0 * DEGREE);
        let accelerometer = InstrumentConfig::default()
            .density([4e-3; 3])
            .drift([6e-3; 3])
            .drift_time_s([300.0; 3])
            .bias_stddev([0.02 * GRAVITY; 3])
            .precision([0.833e-3 * GRAVITY; 3])
            .limit(18.0 * GRAVITY);
        ImuConfig { gyro, accelerometer }
    }

    /// Names of the presets, as files ask for them.
    pub const NAMES: [&str; 1] = ["adis16448"];

    /// The preset of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<ImuConfig> {
        match name {
            "adis16448" => Some(adis16448()),
            _ => None,
        }
    }
}
