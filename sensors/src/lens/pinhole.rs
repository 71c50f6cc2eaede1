//! The pinhole camera.
//!
//! | frame | x | y | z |
//! |---|---|---|---|
//! | sensor (SDF, URDF) | forward | left | up |
//! | optical (REP-103) | right | down | forward |
//!
//! Pixel centres are integers: pixel (0, 0) looks along ((0 − cx)/fx, (0 − cy)/fy, 1) in the optical frame.

use crate::trace::tile::{TILE_HEIGHT, TILE_WIDTH};
use glam::DVec3;

/// Intrinsic parameters in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinhole {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Focal length along a row.
    pub fx: f64,
    /// Focal length down a column.
    pub fy: f64,
    /// Column of the principal point.
    pub cx: f64,
    /// Row of the principal point.
    pub cy: f64,
}

impl Pinhole {
    /// A centred camera with square pixels: f = w / (2·tan(hfov / 2)), principal point ((w−1)/2, (h−1)/2).
    ///
    /// ```
    /// // The articles' ceiling camera.
    /// let lens = belvedere_sensors::lens::Pinhole::from_fov(640, 480, 1.3962634);
    /// assert!((lens.fx - 381.36115).abs() < 1e-4);
    /// assert_eq!((lens.cx, lens.cy), (319.5, 239.5));
    /// ```
    pub fn from_fov(width: u32, height: u32, horizontal_fov_rad: f64) -> Self {
        let focal = f64::from(width) / (2.0 * libm::tan(horizontal_fov_rad * 0.5));
        Self {
            width,
            height,
            fx: focal,
            fy: focal,
            cx: (f64::from(width) - 1.0) * 0.5,
            cy: (f64::from(height) - 1.0) * 0.5,
        }
    }

    /// Pixel (column, row) of a point in the optical frame (x right, y down, z forward), wherever it may lie;
    /// none for a point that is not in front of the camera.
    pub fn project(&self, point_in_optical: DVec3) -> Option<[f64; 2]> {
        (point_in_optical.z > 0.0).then(|| {
            [
                self.fx * point_in_optical.x / point_in_optical.z + self.cx,
                self.fy * point_in_optical.y / point_in_optical.z + self.cy,
            ]
        })
    }

    /// Direction of a pixel's ray in the optical frame, with z = 1: the inverse of [`Pinhole::project`].
    pub fn unproject(&self, [column, row]: [f64; 2]) -> DVec3 {
        DVec3::new((column - self.cx) / self.fx, (row - self.cy) / self.fy, 1.0)
    }

    /// Tiles across and down.
    pub(crate) fn tiles(&self) -> [usize; 2] {
        [(self.width as usize).div_ceil(TILE_WIDTH), (self.height as usize).div_ceil(TILE_HEIGHT)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unproject_undoes_project() {
        let lens = Pinhole::from_fov(640, 480, 1.2);
        for point in [DVec3::new(0.3, -0.2, 1.5), DVec3::new(-4.0, 2.0, 7.0)] {
            let pixel = lens.project(point).unwrap();
            assert!((lens.unproject(pixel) * point.z - point).length() < 1e-12);
        }
        assert_eq!(lens.project(DVec3::NEG_Z), None);
    }
}
