//! Measurements of instruments: satellite receivers, magnetometers, barometers, altimeters, force-torque sensors.

use super::Message;
use crate::wire::{
    Kind,
    fields::{Describe, Fields, RosType},
    layout::wire_structs,
};

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

    /// A force and a torque, as in `geometry_msgs/WrenchStamped`, along the axes of the header's `frame_id` and about its
    /// origin.
    with #[derive(PartialEq)]
    pub struct Wrench, 48 bytes, of [Kind::Wrench] {
        /// Force in newtons.
        pub force: [f64; 3] = 0,
        /// Torque in newton metres.
        pub torque: [f64; 3] = 24,
    }
}

impl Describe for NavSatFix {
    const ROS: &'static [RosType] =
        &[RosType::new("sensor_msgs/NavSatFix", "2d3a8cd499b9b4a0249fb98fd05cfa48")];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.header(None);
        if fields.ros().is_some() {
            fields.part("status", "sensor_msgs/NavSatStatus", &mut |fields| {
                for (name, value) in
                    [("STATUS_NO_FIX", -1), ("STATUS_FIX", 0), ("STATUS_SBAS_FIX", 1), ("STATUS_GBAS_FIX", 2)]
                {
                    fields.constant("int8", name, value);
                }
                // A fix, from GPS.
                fields.put("status", 0_i8);
                for (name, value) in [
                    ("SERVICE_GPS", 1),
                    ("SERVICE_GLONASS", 2),
                    ("SERVICE_COMPASS", 4),
                    ("SERVICE_GALILEO", 8),
                ] {
                    fields.constant("uint16", name, value);
                }
                fields.put("service", 1_u16);
            });
        }
        fields.put("latitude", self.latitude);
        fields.put("longitude", self.longitude);
        fields.put("altitude", self.altitude);
        fields.put("position_covariance", &self.position_covariance);
        if fields.ros().is_some() {
            for (name, value) in [
                ("COVARIANCE_TYPE_UNKNOWN", 0),
                ("COVARIANCE_TYPE_APPROXIMATED", 1),
                ("COVARIANCE_TYPE_DIAGONAL_KNOWN", 2),
                ("COVARIANCE_TYPE_KNOWN", 3),
            ] {
                fields.constant("uint8", name, value);
            }
            // Known along the axes, unless it is 0 altogether.
            let is_known = self.position_covariance.iter().any(|part| *part != 0.0);
            fields.put("position_covariance_type", if is_known { 2_u8 } else { 0 });
        } else {
            // The message of ROS has no place for it.
            fields.vector("velocity", self.velocity);
        }
        Some(())
    }
}

impl Describe for MagneticField {
    const ROS: &'static [RosType] =
        &[RosType::new("sensor_msgs/MagneticField", "2f3b0b43eed0c9501de0fa3ff89a45aa")];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.header(None);
        fields.vector("magnetic_field", self.magnetic_field);
        fields.put("magnetic_field_covariance", &self.covariance);
        Some(())
    }
}

impl Describe for FluidPressure {
    const ROS: &'static [RosType] =
        &[RosType::new("sensor_msgs/FluidPressure", "804dc5cea1c5306d6a2eb80b9833befe")];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.header(None);
        fields.put("fluid_pressure", self.fluid_pressure);
        fields.put("variance", self.variance);
        Some(())
    }
}

impl Describe for Altimeter {
    const ROS: &'static [RosType] =
        &[RosType::new("geometry_msgs/PointStamped", "c63aecb41bfdfd6b7e1fac37c7cbe7bf")];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.header(None);
        if fields.ros().is_some() {
            // ROS has no message for altimeters: the height is a point above the origin of its frame.
            fields.point("point", [0.0, 0.0, self.vertical_position]);
        } else {
            fields.put("vertical_position", self.vertical_position);
            fields.put("vertical_velocity", self.vertical_velocity);
            fields.put("vertical_reference", self.vertical_reference);
            fields.put("variance", self.variance);
        }
        Some(())
    }
}

impl Describe for Vector3 {
    const ROS: &'static [RosType] =
        &[RosType::new("geometry_msgs/Vector3Stamped", "7b324c7325e683bf02a9b14b01090ec7")];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.header(None);
        fields.vector("vector", self.vector);
        Some(())
    }
}

impl Describe for Wrench {
    const ROS: &'static [RosType] =
        &[RosType::new("geometry_msgs/WrenchStamped", "d78d3cb249ce23087ade7e7d0c40cfa7")];

    fn describe(&self, fields: &mut dyn Fields) -> Option<()> {
        fields.header(None);
        fields.part("wrench", "geometry_msgs/Wrench", &mut |fields| {
            fields.vector("force", self.force);
            fields.vector("torque", self.torque);
        });
        Some(())
    }
}
