//! The optics of a sensor: the directions of all its rays, whatever defines them.

#[cfg(feature = "alloc")]
use super::RayTableBuf;
use super::rays::RayGrid;
use super::{MAX_GRID_SIZE, PinholeGrid, RayTable, SphericalGrid};
use crate::ParameterError;

/// The directions of a sensor's rays, row by row. The sensor looks along +x; y is left, z is up.
///
/// ```
/// use belvedere_sensors::optics::{Optics, PinholeGrid};
/// let optics = Optics::from(PinholeGrid::from_fov(640, 480, 1.2)?);
/// assert_eq!(optics.size(), [640, 480]);
/// # Ok::<(), belvedere_sensors::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[allow(
    clippy::large_enum_variant,
    reason = "a table lent by value, so that its owner can be lent as one; there may be no heap"
)]
pub enum Optics<'a> {
    /// The pixels of a camera without distortion.
    Pinhole(PinholeGrid),
    /// Columns by azimuth around z from +x, rows by elevation, both equally spaced.
    Spherical(SphericalGrid),
    /// Arbitrary directions from a table.
    Table(RayTable<'a>),
}

impl From<PinholeGrid> for Optics<'_> {
    fn from(grid: PinholeGrid) -> Self {
        Self::Pinhole(grid)
    }
}

impl From<SphericalGrid> for Optics<'_> {
    fn from(grid: SphericalGrid) -> Self {
        Self::Spherical(grid)
    }
}

impl<'a> From<RayTable<'a>> for Optics<'a> {
    fn from(table: RayTable<'a>) -> Self {
        Self::Table(table)
    }
}

#[cfg(feature = "alloc")]
impl<'a> From<&'a RayTableBuf> for Optics<'a> {
    fn from(table: &'a RayTableBuf) -> Self {
        Self::Table(table.table())
    }
}

impl Optics<'_> {
    /// Number of columns and rows of rays.
    pub fn size(&self) -> [usize; 2] {
        let ray_grid = self.ray_grid();
        [ray_grid.width as usize, ray_grid.height as usize]
    }

    /// Number of columns and rows of rays as configured, even if there are more than [`MAX_GRID_SIZE`], which are never
    /// traced.
    pub(crate) fn asked_size(&self) -> [u32; 2] {
        match self {
            Self::Pinhole(grid) => grid.size(),
            Self::Spherical(grid) => [grid.columns, grid.rows],
            Self::Table(table) => table.size(),
        }
    }

    /// Checks that sizes are 1 to [`MAX_GRID_SIZE`], and that angles are finite.
    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        const OF: &str = "grid of rays";
        let size = |parameter, value: u32| {
            ParameterError::require_in(OF, parameter, value.into(), [1.0, MAX_GRID_SIZE.into()])
        };
        let number = |parameter, value: f64| {
            ParameterError::require(OF, parameter, value, value.is_finite(), "a finite number")
        };
        match self {
            Self::Pinhole(lens) => {
                let [width, height] = lens.size();
                size("width", width)?;
                size("height", height)
            }
            Self::Spherical(grid) => {
                size("columns", grid.columns)?;
                size("rows", grid.rows)?;
                number("first_azimuth_rad", grid.first_azimuth_rad)?;
                number("azimuth_step_rad", grid.azimuth_step_rad)?;
                number("first_elevation_rad", grid.first_elevation_rad)?;
                number("elevation_step_rad", grid.elevation_step_rad)
            }
            // Checked when the table was built.
            Self::Table(_) => Ok(()),
        }
    }

    /// An upper bound on the length of the rays' direction vectors, in units of t.
    pub(crate) fn longest_direction(&self) -> f64 {
        match self {
            Self::Pinhole(grid) => {
                let ([width, height], lens) = (grid.size().map(f64::from), grid.intrinsics());
                let x = lens.cx.abs().max((width - 1.0 - lens.cx).abs()) / lens.fx;
                let y = lens.cy.abs().max((height - 1.0 - lens.cy).abs()) / lens.fy;
                crate::simd::sqrt(1.0 + x * x + y * y)
            }
            Self::Spherical(_) | Self::Table(_) => 1.0,
        }
    }

    pub(crate) fn ray_grid(&self) -> RayGrid {
        match self {
            // Larger grids are never traced.
            Self::Pinhole(grid) => {
                let [width, height] = grid.size();
                RayGrid::square(width.min(MAX_GRID_SIZE), height.min(MAX_GRID_SIZE))
            }
            Self::Spherical(grid) => {
                RayGrid::new(grid.columns.min(MAX_GRID_SIZE), grid.rows.min(MAX_GRID_SIZE))
            }
            Self::Table(table) => table.ray_grid(),
        }
    }
}
