//! By which rules a file is read where readers differ.

use super::mesh::UpAxis;

/// What loading goes by, besides the files.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Rules {
    /// Go on as Gazebo classic does where something is missing, with a warning in place of the error.
    pub gazebo_compat: bool,
    /// Leave out what a world names and nobody has, with a warning in place of the error.
    pub skip_missing: bool,
    /// Collada's `<up_axis>`.
    pub up_axis: UpAxis,
    /// Which devices sensors are.
    pub sensor_models: SensorModels,
}

/// Which devices sensors are where files ask for none.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum SensorModels {
    /// None: they measure as their elements say.
    #[default]
    AsWritten,
    /// Those that they are known to stand for: what a Kinect's plugin publishes is a Kinect.
    Real,
}
