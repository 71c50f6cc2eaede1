//! Converts positions in the world to latitude and longitude on WGS 84; the standard atmosphere.

use crate::description::model::Earth;
use glam::{DMat3, DQuat, DVec3};

/// Semi-axes of WGS 84 in metres: equatorial and polar.
const EQUATOR_M: f64 = 6_378_137.0;
const POLE_M: f64 = EQUATOR_M * (1.0 - 1.0 / 298.257_223_563);

/// A position on the earth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geodetic {
    /// Geodetic latitude in degrees.
    pub latitude_deg: f64,
    /// Longitude in degrees, positive to the east.
    pub longitude_deg: f64,
    /// Height above the ellipsoid in metres.
    pub altitude_m: f64,
}

/// Returns the rotation from the world's axes to east, north and up.
///
/// Gazebo classic has the opposite convention, rotated by half a turn, so its worlds are correct with a heading of
/// 180°. `gazebo_compat` does the same.
pub fn enu_from_world(earth: &Earth, gazebo_compat: bool) -> DQuat {
    let half_turn = if gazebo_compat { std::f64::consts::PI } else { 0.0 };
    DQuat::from_rotation_z(half_turn + if gazebo_compat { -earth.heading_rad } else { earth.heading_rad })
}

/// Returns the position that is `enu` metres east, north and up from the world's origin.
pub fn geodetic(earth: &Earth, enu: DVec3) -> Geodetic {
    let (latitude, longitude) = (earth.latitude_deg.to_radians(), earth.longitude_deg.to_radians());
    let (sin_lat, cos_lat) = (libm::sin(latitude), libm::cos(latitude));
    let (sin_lon, cos_lon) = (libm::sin(longitude), libm::cos(longitude));
    let across = cross_radius(sin_lat, cos_lat);
    let east = DVec3::new(-sin_lon, cos_lon, 0.0);
    let up = DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat);
    let centre_from_enu = DMat3::from_cols(east, up.cross(east), up);
    let of_ellipsoid = DVec3::new(across, across, across * (POLE_M / EQUATOR_M).powi(2));
    from_centre(up * (of_ellipsoid + earth.elevation_m) + centre_from_enu * enu)
}

/// Returns the radius of curvature across the meridian.
fn cross_radius(sin_lat: f64, cos_lat: f64) -> f64 {
    EQUATOR_M * EQUATOR_M / libm::hypot(EQUATOR_M * cos_lat, POLE_M * sin_lat)
}

/// Converts earth-centred coordinates (z to the north pole, x to the prime meridian).
fn from_centre(point: DVec3) -> Geodetic {
    let across = libm::hypot(point.x, point.y);
    // Bowring's first guess from the reduced latitude, then his formula twice: exact in double precision within 10,000
    // km.
    let (e2, second_e2) = (1.0 - (POLE_M / EQUATOR_M).powi(2), (EQUATOR_M / POLE_M).powi(2) - 1.0);
    let mut reduced = libm::atan2(point.z * EQUATOR_M, across * POLE_M);
    let mut latitude = 0.0;
    for _ in 0..3 {
        let (sin, cos) = (libm::sin(reduced), libm::cos(reduced));
        latitude = libm::atan2(
            point.z + second_e2 * POLE_M * sin * sin * sin,
            across - e2 * EQUATOR_M * cos * cos * cos,
        );
        reduced = libm::atan2(POLE_M * libm::sin(latitude), EQUATOR_M * libm::cos(latitude));
    }
    let (sin_lat, cos_lat) = (libm::sin(latitude), libm::cos(latitude));
    // The distance from the foot point on the ellipsoid, along the vertical, which also works at the poles.
    let foot = cross_radius(sin_lat, cos_lat);
    let below = DVec3::new(foot * cos_lat, 0.0, foot * (1.0 - e2) * sin_lat);
    let altitude_m = (across - below.x) * cos_lat + (point.z - below.z) * sin_lat;
    Geodetic {
        latitude_deg: latitude.to_degrees(),
        longitude_deg: libm::atan2(point.y, point.x).to_degrees(),
        altitude_m,
    }
}

/// Layers of the U.S. Standard Atmosphere 1976: the geopotential height in m at which each begins, and its temperature
/// gradient in K/m. Above 86 km, where the air separates and the standard uses other rules, the last layer continues.
const LAYERS: [(f64, f64); 8] = [
    (0.0, -0.0065),
    (11_000.0, 0.0),
    (20_000.0, 0.001),
    (32_000.0, 0.0028),
    (47_000.0, 0.0),
    (51_000.0, -0.0028),
    (71_000.0, -0.002),
    (84_852.0, 0.0),
];

/// Returns the pressure in Pa at a height in m above sea level, from the U.S. Standard Atmosphere 1976.
pub fn air_pressure_pa(height_m: f64) -> f64 {
    const EARTH_RADIUS_M: f64 = 6_356_766.0;
    // g·M/R of dry air in K/m.
    const HYDROSTATIC_K_M: f64 = 9.80665 * 28.9644 / 8314.32;
    let geopotential_m = EARTH_RADIUS_M * height_m / (EARTH_RADIUS_M + height_m);
    let (mut temperature_k, mut pressure_pa) = (288.15, 101_325.0);
    for (layer, (base_m, lapse_k_m)) in LAYERS.into_iter().enumerate() {
        let top_m = LAYERS.get(layer + 1).map_or(f64::INFINITY, |above| above.0);
        let rise_m = geopotential_m.min(top_m) - base_m;
        if lapse_k_m == 0.0 {
            pressure_pa *= libm::exp(-HYDROSTATIC_K_M * rise_m / temperature_k);
        } else {
            let next_k = temperature_k + lapse_k_m * rise_m;
            pressure_pa *= libm::pow(temperature_k / next_k, HYDROSTATIC_K_M / lapse_k_m);
            temperature_k = next_k;
        }
        if geopotential_m <= top_m {
            break;
        }
    }
    pressure_pa
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with results of gz-math's `SphericalCoordinates`.
    #[test]
    fn positions_equal_those_of_gz_math() {
        let earth = Earth {
            latitude_deg: 31.230_416,
            longitude_deg: 121.473_701,
            elevation_m: 10.0,
            ..Earth::default()
        };
        for (enu, latitude_deg, longitude_deg, altitude_m) in [
            ([100.0, 0.0, 0.0], 31.230_415_995_716_708, 121.474_750_604_266_63, 10.000_783_220_9),
            ([0.0, 100.0, 0.0], 31.231_317_927_837_033, 121.473_700_999_999_99, 10.000_787_080_3),
            ([-60.0, 40.0, 5.0], 31.230_776_769_324_08, 121.473_071_235_540_59, 15.000_407_890_4),
            ([30.0, -51.75, 0.0], 31.229_949_251_909_09, 121.474_015_879_732_32, 10.000_281_274_3),
            ([91.75, 20.0, 0.0], 31.230_596_381_971_818, 121.474_664_013_744_02, 10.000_690_802_9),
        ] {
            let place = geodetic(&earth, DVec3::from(enu));
            // 1e-12° is 0.1 µm.
            assert!((place.latitude_deg - latitude_deg).abs() < 3e-13, "{place:?}");
            assert!((place.longitude_deg - longitude_deg).abs() < 3e-13, "{place:?}");
            assert!((place.altitude_m - altitude_m).abs() < 2e-9, "{place:?}");
        }
    }

    #[test]
    fn a_heading_turns_the_world_to_the_left() {
        // x points north: 10 m along it change the latitude by this angle on the equator.
        let earth = Earth { heading_rad: std::f64::consts::FRAC_PI_2, ..Earth::default() };
        let place = geodetic(&earth, enu_from_world(&earth, false) * DVec3::X * 10.0);
        assert!((place.latitude_deg - 0.000_090_436_947_704_967).abs() < 1e-13, "{place:?}");
        assert!(place.longitude_deg.abs() < 1e-13);
        // Gazebo classic's worlds are correct with 180°.
        let classic = Earth { heading_rad: std::f64::consts::PI, ..Earth::default() };
        assert!((enu_from_world(&classic, true) * DVec3::X - DVec3::X).length() < 1e-12);
        assert!((enu_from_world(&Earth::default(), true) * DVec3::X + DVec3::X).length() < 1e-12);
    }

    #[test]
    fn positions_are_exact_near_the_poles_and_at_great_heights() {
        for (latitude_deg, longitude_deg, elevation_m) in
            [(89.9999, 10.0, 100.0), (-90.0, 0.0, 2800.0), (0.0, 180.0, -400.0), (45.0, -77.0, 400e3)]
        {
            let earth = Earth { latitude_deg, longitude_deg, elevation_m, ..Earth::default() };
            let place = geodetic(&earth, DVec3::Z * 50.0);
            assert!((place.latitude_deg - latitude_deg).abs() < 1e-11, "{place:?}");
            assert!((place.altitude_m - elevation_m - 50.0).abs() < 1e-8, "{place:?}");
        }
    }

    /// From the standard's tables: geometric heights above sea level, and pressures.
    #[test]
    fn pressures_are_those_of_the_standard_atmosphere() {
        for (height_m, pressure_pa) in [
            (0.0, 101_325.0),
            (500.0, 95_461.0),
            (1000.0, 89_876.0),
            (2000.0, 79_501.0),
            (5000.0, 54_048.0),
            (10_000.0, 26_500.0),
            (15_000.0, 12_111.0),
            (20_000.0, 5_529.3),
            (30_000.0, 1_197.0),
            (40_000.0, 287.14),
            (50_000.0, 79.779),
            (60_000.0, 21.958),
            (70_000.0, 5.2209),
            (80_000.0, 1.0524),
        ] {
            // One unit in the last of the tables' five digits.
            assert!((air_pressure_pa(height_m) / pressure_pa - 1.0).abs() < 1e-4, "{height_m} m");
        }
        // No step at 86 km, and a finite value at any height.
        assert!((air_pressure_pa(86_001.0) / air_pressure_pa(85_999.0) - 1.0).abs() < 1e-3);
        for height_m in [-1e6, -5000.0, 2e5, 1e9] {
            assert!(air_pressure_pa(height_m).is_finite(), "{height_m} m");
        }
    }
}
