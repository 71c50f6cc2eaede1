//! The place of a world on the earth, and its magnetic field.

use glam::DVec3;

/// `<spherical_coordinates>`, on the ellipsoid WGS 84: the place of the world's origin and the direction of its axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Earth {
    /// Geodetic latitude in degrees.
    pub latitude_deg: f64,
    /// Longitude in degrees, positive to the east.
    pub longitude_deg: f64,
    /// Height above the ellipsoid in metres.
    pub elevation_m: f64,
    /// Angle from east to the world's x in radians, positive counter-clockwise.
    pub heading_rad: f64,
    /// True if the file specifies it; otherwise the origin is at latitude and longitude 0, x east, y north.
    pub is_given: bool,
    /// `<magnetic_field>` in the world's axes, in teslas.
    pub magnetic_field_t: DVec3,
}

impl Default for Earth {
    fn default() -> Self {
        Self {
            latitude_deg: 0.0,
            longitude_deg: 0.0,
            elevation_m: 0.0,
            heading_rad: 0.0,
            is_given: false,
            // sdf/1.6
            magnetic_field_t: DVec3::new(5.5645e-6, 22.8758e-6, -42.3884e-6),
        }
    }
}
