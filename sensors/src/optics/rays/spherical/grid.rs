//! What a spinning lidar's rays are given by.

/// The rays of a spinning lidar. Angles in radians; azimuth is counter-clockwise seen from +z, elevation up. Any finite
/// angles will do: azimuth a and elevation e are the direction (cos a cos e, sin a cos e, sin e), so beyond a pole rays
/// look the other way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphericalGrid {
    /// Columns, 1 … [`MAX_GRID_SIZE`](crate::optics::MAX_GRID_SIZE).
    pub columns: u32,
    /// Rows, 1 … [`MAX_GRID_SIZE`](crate::optics::MAX_GRID_SIZE).
    pub rows: u32,
    /// Of the first column.
    pub first_azimuth_rad: f64,
    /// From a column to the next.
    pub azimuth_step_rad: f64,
    /// Of the first row.
    pub first_elevation_rad: f64,
    /// From a row to the next.
    pub elevation_step_rad: f64,
}
