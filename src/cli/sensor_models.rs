//! The option `--sensor-models`.

use crate::description::SensorModels;

/// The device that a sensor is modelled on if its file does not choose a preset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Devices {
    /// No device: sensors measure exactly as their elements specify.
    #[default]
    AsWritten,
    /// The real device that a sensor's plugin stands for.
    Real,
}

impl From<Devices> for SensorModels {
    fn from(devices: Devices) -> Self {
        match devices {
            Devices::AsWritten => Self::AsWritten,
            Devices::Real => Self::Real,
        }
    }
}
