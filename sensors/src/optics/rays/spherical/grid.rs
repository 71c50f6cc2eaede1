//! The parameters of a spinning lidar's rays.

/// The rays of a spinning lidar. Angles are in radians; azimuth is counter-clockwise seen from +z, elevation is up. All
/// finite angles are allowed: azimuth a and elevation e mean the direction (cos a cos e, sin a cos e, sin e), so beyond
/// a pole rays look in the opposite direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphericalGrid {
    /// Number of columns, 1 to [`MAX_GRID_SIZE`](crate::optics::MAX_GRID_SIZE).
    pub columns: u32,
    /// Number of rows, 1 to [`MAX_GRID_SIZE`](crate::optics::MAX_GRID_SIZE).
    pub rows: u32,
    /// Azimuth of the first column, in radians.
    pub first_azimuth_rad: f64,
    /// Azimuth difference from one column to the next, in radians.
    pub azimuth_step_rad: f64,
    /// Elevation of the first row, in radians.
    pub first_elevation_rad: f64,
    /// Elevation difference from one row to the next, in radians.
    pub elevation_step_rad: f64,
}
