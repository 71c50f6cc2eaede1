//! Inertial measurement units: three gyros and three accelerometers; each triad is an [`Instrument`].

use crate::ParameterError;
use crate::Pose;
use crate::noise::{Instrument, InstrumentConfig, InstrumentState, Stream};
use glam::DVec3;

/// Errors of an inertial measurement unit: gyros in rad/s, accelerometers in m/s². By default there are none.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct ImuConfig {
    /// Errors of the angular velocity, in rad/s. The default is [`InstrumentConfig::default`], without errors.
    pub gyro: InstrumentConfig<3>,
    /// Errors of the specific force, in m/s². The default is [`InstrumentConfig::default`], without errors.
    pub accelerometer: InstrumentConfig<3>,
}

impl ImuConfig {
    setters! {
        /// Sets the errors of the angular velocity.
        gyro: InstrumentConfig<3>,
        /// Sets the errors of the specific force.
        accelerometer: InstrumentConfig<3>,
    }
}

/// Angular velocity and specific force in the axes of the unit: true ones, or the values that the unit measures.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct InertialReading {
    /// Angular velocity in rad/s.
    pub angular_velocity: DVec3,
    /// Specific force in m/s²: acceleration minus gravity. It is (0, 0, 9.81) in a unit that lies level at rest, and 0
    /// in free fall. [`InertialReading::of_motion`] works it out.
    pub specific_force: DVec3,
}

impl InertialReading {
    /// Returns the true reading of a unit that moves: the angular velocity ω and the specific force f = R⁻¹·(a − g),
    /// where R turns the axes of the unit to those of the world. Vectors are given in the axes of the world, in rad/s
    /// and m/s².
    ///
    /// ```
    /// use belvedere_sensors::glam::DVec3;
    /// use belvedere_sensors::{Pose, imu::InertialReading};
    /// // A level robot speeds up along its x axis.
    /// let (acceleration, gravity) = (DVec3::X * 2.0, DVec3::Z * -9.81);
    /// let level = InertialReading::of_motion(&Pose::IDENTITY, DVec3::ZERO, acceleration, gravity);
    /// assert_eq!(level.specific_force, DVec3::new(2.0, 0.0, 9.81));
    /// // At rest with its nose up by 90°: pitch is −90°, and x points up.
    /// let nose_up = Pose::from_xyz_rpy(DVec3::ZERO, DVec3::Y * -90_f64.to_radians());
    /// let still = InertialReading::of_motion(&nose_up, DVec3::ZERO, DVec3::ZERO, gravity);
    /// assert!((still.specific_force - DVec3::X * 9.81).length() < 1e-12);
    /// ```
    pub fn of_motion(
        world_from_unit: &Pose,
        angular_velocity: DVec3,
        acceleration: DVec3,
        gravity: DVec3,
    ) -> Self {
        let unit_from_world = world_from_unit.rotation().inverse();
        Self {
            angular_velocity: unit_from_world * angular_velocity,
            specific_force: unit_from_world * (acceleration - gravity),
        }
    }
}

/// The biases of a running unit, returned by [`Imu::start`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImuState {
    /// State of the gyros.
    pub gyro: InstrumentState<3>,
    /// State of the accelerometers.
    pub accelerometer: InstrumentState<3>,
}

/// An inertial measurement unit.
///
/// ```
/// use belvedere_sensors::imu::{Imu, InertialReading, presets};
/// use belvedere_sensors::glam::DVec3;
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
    /// Creates a unit with these errors. `seed` and `sensor` (the number of the sensor) select its random numbers.
    ///
    /// # Errors
    /// Returns a [`ParameterError`] that names the first parameter out of range.
    pub fn new(config: ImuConfig, seed: u64, sensor: u32) -> Result<Self, ParameterError> {
        Ok(Self {
            gyro: Instrument::named("gyro", config.gyro)?,
            accelerometer: Instrument::named("accelerometer", config.accelerometer)?,
            seed,
            sensor,
        })
    }

    /// Returns the errors that the unit was created with.
    pub const fn config(&self) -> ImuConfig {
        ImuConfig { gyro: *self.gyro.config(), accelerometer: *self.accelerometer.config() }
    }

    /// Begins a run: draws the biases that hold for it.
    pub fn start(&self) -> ImuState {
        let [gyro, accelerometer] = self.streams(0);
        ImuState { gyro: self.gyro.start(&gyro), accelerometer: self.accelerometer.start(&accelerometer) }
    }

    /// Measures a motion in a frame that comes `period_s` seconds after the previous one. Frames must be measured in
    /// order.
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

    /// Returns the random number streams of gyros and accelerometers.
    fn streams(&self, frame: u64) -> [Stream; 2] {
        let Self { seed, sensor, .. } = *self;
        [0, 1].map(|which| Stream { seed, sensor, frame, channel: Stream::INSTRUMENT + which })
    }
}

/// Errors of particular products, from their data sheets.
pub mod presets {
    use super::{ImuConfig, InstrumentConfig};
    use core::f64::consts::PI;

    const DEGREE: f64 = PI / 180.0;
    const GRAVITY: f64 = 9.80665;

    /// Returns the errors of the Analog Devices ADIS16448, as flown on small helicopters. Noise densities, bias random
    /// walks and correlation times are those of the unit of that name in the `RotorS` simulator. Turn-on biases,
    /// resolutions and ranges are from the data sheet.
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

    /// An inertial measurement unit with a name.
    #[derive(Debug, Clone, Copy)]
    #[non_exhaustive]
    pub struct ImuPreset {
        /// The name by which configuration files refer to the preset.
        pub name: &'static str,
        config: fn() -> ImuConfig,
    }

    impl ImuPreset {
        /// Returns the errors of the unit.
        #[must_use]
        pub fn config(&self) -> ImuConfig {
            (self.config)()
        }
    }

    /// All presets.
    pub const ALL: &[ImuPreset] = &[ImuPreset { name: "adis16448", config: adis16448 }];

    preset_names!(ALL: ImuPreset);
}
