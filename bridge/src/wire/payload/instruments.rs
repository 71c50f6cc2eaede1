//! Measurements of instruments: satellite receivers, magnetometers, barometers, altimeters.

use super::Message;
use crate::wire::{Kind, layout::wire_structs};

wire_structs! {
    /// A position on the earth, as in `sensor_msgs/NavSatFix`, with the velocity.
    with #[derive(PartialEq)]
    pub struct NavSatFix, 120 bytes, of [Kind::NavSatFix] {
        /// Geodetic latitude in degrees, WGS 84.
        pub latitude: f64 = 0,
        /// Longitude in degrees, positive to the east.
        pub longitude: f64 = 8,
        /// Height above the ellipsoid in metres.
        pub altitude: f64 = 16,
        /// Velocity to the east, to the north and up, in metres per second.
        pub velocity: [f64; 3] = 24,
        /// Covariance of the position to the east, to the north and up, in m², row by row.
        pub position_covariance: [f64; 9] = 48 as [3, 3],
    }

    /// A magnetic field, as in `sensor_msgs/MagneticField`.
    with #[derive(PartialEq)]
    pub struct MagneticField, 96 bytes, of [Kind::MagneticField] {
        /// The field in teslas.
        pub magnetic_field: [f64; 3] = 0,
        /// Its covariance, row by row.
        pub covariance: [f64; 9] = 24 as [3, 3],
    }

    /// A pressure, as in `sensor_msgs/FluidPressure`.
    with #[derive(PartialEq)]
    pub struct FluidPressure, 16 bytes, of [Kind::FluidPressure] {
        /// Absolute pressure in pascals.
        pub fluid_pressure: f64 = 0,
        /// Its variance in Pa².
        pub variance: f64 = 8,
    }

    /// A height and a vertical velocity, as in gz-sim's altimeter.
    with #[derive(PartialEq)]
    pub struct Altimeter, 32 bytes, of [Kind::Altimeter] {
        /// Height above the reference in metres.
        pub vertical_position: f64 = 0,
        /// Vertical velocity in metres per second.
        pub vertical_velocity: f64 = 8,
        /// Height of the reference in the world in metres.
        pub vertical_reference: f64 = 16,
        /// Variance of the height in m².
        pub variance: f64 = 24,
    }

    /// A vector, as in `geometry_msgs/Vector3Stamped`. The topic defines its meaning.
    with #[derive(PartialEq)]
    pub struct Vector3, 24 bytes, of [Kind::Vector3] {
        /// Components x y z.
        pub vector: [f64; 3] = 0,
    }
}
