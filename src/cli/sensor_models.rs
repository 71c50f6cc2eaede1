//! `--sensor-models`.

use crate::description::SensorModels;

/// Which devices sensors are whose files ask for none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Devices {
    /// None: they measure as their elements say.
    #[default]
    AsWritten,
    /// Those that they stand for.
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
