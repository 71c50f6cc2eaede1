//! Tables that own their memory.

use super::RayTable;
use super::error::{TableError, check_size};
use super::plan::TablePlan;
use crate::memory::CacheLine;
use crate::optics::Lens;

/// A table of rays that owns its memory.
///
/// ```
/// use belvedere_sensors::camera::{Camera, CameraConfig};
/// use belvedere_sensors::optics::{Intrinsics, KannalaBrandt, RayTableBuf};
/// let intrinsics = Intrinsics { fx: 100.0, fy: 100.0, cx: 159.5, cy: 119.5, skew: 0.0 };
/// let fisheye = RayTableBuf::from_lens(320, 240, &KannalaBrandt::new(intrinsics, [0.0; 4])?)?;
/// // The pixel a quarter of a turn to the right of the axis: 100 px/rad · π/2.
/// let [forward, left, _] = fisheye.table().direction(317, 120);
/// assert!(forward.abs() < 0.01 && left < -0.99);
/// let camera = Camera::new(CameraConfig::new(&fisheye))?;
/// assert_eq!(camera.size(), [320, 240]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct RayTableBuf {
    plan: TablePlan,
    buffer: alloc::vec::Vec<CacheLine>,
}

impl RayTableBuf {
    /// Builds a table with [`RayTable::build`] in allocated memory.
    ///
    /// # Errors
    /// The errors of [`RayTable::build`].
    pub fn build(width: u32, height: u32, directions: &[[f32; 3]]) -> Result<Self, TableError> {
        Self::with(width, height, |buffer| RayTable::build(width, height, directions, buffer))
    }

    /// Builds a table with [`RayTable::from_lens`] in allocated memory.
    ///
    /// # Errors
    /// [`TableError::Size`]; [`TableError::Empty`] if the lens maps no pixel.
    pub fn from_lens(width: u32, height: u32, lens: &(impl Lens + ?Sized)) -> Result<Self, TableError> {
        Self::with(width, height, |buffer| RayTable::from_lens(width, height, lens, buffer))
    }

    fn with(
        width: u32,
        height: u32,
        build: impl FnOnce(&mut [CacheLine]) -> Result<RayTable<'_>, TableError>,
    ) -> Result<Self, TableError> {
        check_size(width, height)?;
        let mut buffer = alloc::vec![CacheLine::ZERO; RayTable::required_len(width, height)];
        let plan = build(&mut buffer)?.plan();
        Ok(Self { plan, buffer })
    }

    /// Copies a table into allocated memory.
    pub(crate) fn copy_of(table: &RayTable<'_>) -> Self {
        Self { plan: table.plan(), buffer: table.buffer.to_vec() }
    }

    /// Returns the table, for use by a sensor.
    pub fn table(&self) -> RayTable<'_> {
        RayTable::cut(&self.plan, &self.buffer)
    }
}
