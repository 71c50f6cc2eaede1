//! Where on the earth a world is, and what air and magnetic field are there.

use glam::DVec3;

/// `<spherical_coordinates>`, on the ellipsoid WGS 84: where the world's origin is, and which way its axes point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Earth {
    /// Geodetic latitude in degrees.
    pub latitude_deg: f64,
    /// Longitude in degrees, to the east.
    pub longitude_deg: f64,
    /// Height above the ellipsoid in metres.
    pub elevation_m: f64,
    /// Angle from east to the world's x, to the left, in radians.
    pub heading_rad: f64,
    /// Whether a file says so; otherwise it is where the equator meets the prime meridian, x east, y north.
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
