//! What instruments measure: receivers, magnetometers, barometers, altimeters.

use super::Message;
use crate::wire::{Kind, layout::wire_structs};

wire_structs! {
    /// A place on the earth, as `sensor_msgs/NavSatFix` has it, and the velocity there.
    with #[derive(PartialEq)]
    pub struct NavSatFix, 120 bytes, of [Kind::NavSatFix] {
        /// Geodetic latitude in degrees, WGS 84.
        pub latitude: f64 = 0,
        /// Longitude in degrees, to the east.
        pub longitude: f64 = 8,
        /// Height above the ellipsoid in metres.
        pub altitude: f64 = 16,
        /// To the east, the north and up, in metres per second.
        pub velocity: [f64; 3] = 24,
        /// Of the position to the east, the north and up, in m², row by row.
        pub position_covariance: [f64; 9] = 48 as [3, 3],
    }

    /// A magnetic field, as `sensor_msgs/MagneticField` has it.
    with #[derive(PartialEq)]
    pub struct MagneticField, 96 bytes, of [Kind::MagneticField] {
        /// Teslas.
        pub magnetic_field: [f64; 3] = 0,
        /// Row by row.
        pub covariance: [f64; 9] = 24 as [3, 3],
    }

    /// A pressure, as `sensor_msgs/FluidPressure` has it.
    with #[derive(PartialEq)]
    pub struct FluidPressure, 16 bytes, of [Kind::FluidPressure] {
        /// Absolute, in pascals.
        pub fluid_pressure: f64 = 0,
        /// Pa².
        pub variance: f64 = 8,
    }

    /// A height and how fast it changes, as gz-sim's altimeter tells them.
    with #[derive(PartialEq)]
    pub struct Altimeter, 32 bytes, of [Kind::Altimeter] {
        /// Metres above the reference.
        pub vertical_position: f64 = 0,
        /// Metres per second.
        pub vertical_velocity: f64 = 8,
        /// Height of the reference in the world in metres.
        pub vertical_reference: f64 = 16,
        /// Of the position, in m².
        pub variance: f64 = 24,
    }

    /// A vector whose meaning its topic says, as `geometry_msgs/Vector3Stamped` has it.
    with #[derive(PartialEq)]
    pub struct Vector3, 24 bytes, of [Kind::Vector3] {
        /// x y z.
        pub vector: [f64; 3] = 0,
    }
}
