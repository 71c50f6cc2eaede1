//! Rules for reading a file where readers differ.

use super::mesh::UpAxis;

/// Rules that loading follows in addition to the files.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Rules {
    /// Continue as Gazebo classic does where something is missing, with a warning in place of the error.
    pub gazebo_compat: bool,
    /// Leave out missing files that a world or a robot names, with a warning in place of the error.
    pub skip_missing: bool,
    /// How Collada's `<up_axis>` is handled.
    pub up_axis: UpAxis,
    /// How sensors are matched with real devices.
    pub sensor_models: SensorModels,
}

/// How sensors for which the file names no device are matched with real ones.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum SensorModels {
    /// Not at all: they measure as their elements specify.
    #[default]
    AsWritten,
    /// With the devices that they are known to stand for: a Kinect's plugin means a Kinect.
    Real,
}
