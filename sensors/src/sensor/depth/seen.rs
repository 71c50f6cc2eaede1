//! What a device reads: true depths of a frame, and how the rays meet the surfaces, in the workspace.

use super::too_near::Obstacles;
use crate::device::depth::DepthDevice;
use crate::memory::{Cutter, lines};
use crate::trace::grid::Band;
use crate::trace::measure::Measure;
use crate::trace::normals::NormalFinder;
use crate::trace::packet::Faces;
use crate::trace::place::for_each_block;
use crate::trace::resolve::Resolver;
use fearless_simd::Simd;

/// What is seen of pixels, row after row.
pub(super) struct Seen<'a> {
    /// True depths in metres: +∞ where nothing is met, −∞ where something too near is in the way.
    pub(super) depth: &'a mut [f32],
    /// Cosines of the angles of incidence, 1 where nothing is met; empty if the device does not ask for them.
    pub(super) cosine: &'a mut [f32],
}

impl<'a> Seen<'a> {
    /// Cache lines of so many pixels.
    pub(super) fn workspace_len(device: &DepthDevice, pixels: usize) -> usize {
        let arrays = 1 + usize::from(device.wants_incidence());
        arrays * lines(pixels * size_of::<f32>())
    }

    pub(super) fn new(device: &DepthDevice, pixels: usize, memory: &mut Cutter<'a>) -> Self {
        Self {
            depth: memory.take(pixels),
            cosine: memory.take(if device.wants_incidence() { pixels } else { 0 }),
        }
    }

    /// To be lent once more.
    pub(super) fn reborrow(&mut self) -> Seen<'_> {
        Seen { depth: &mut *self.depth, cosine: &mut *self.cosine }
    }

    /// The first pixels, and the rest.
    pub(super) fn split_at(self, pixels: usize) -> (Self, Self) {
        let (depth, depth_rest) = self.depth.split_at_mut(pixels.min(self.depth.len()));
        let (cosine, cosine_rest) = self.cosine.split_at_mut(pixels.min(self.cosine.len()));
        (Self { depth, cosine }, Self { depth: depth_rest, cosine: cosine_rest })
    }

    /// Writes what the rays of a band see. Compiled once a level.
    #[inline(never)]
    pub(super) fn write<S: Simd>(
        &mut self,
        simd: S,
        band: &Band<'_>,
        faces: Faces,
        obstacles: Obstacles<'_>,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let measure = Measure::new(&band.view.world_from_sensor);
                let axes = band.view.world_from_sensor.rotation_matrix().as_mat3().to_cols_array_2d();
                let mut resolver = Resolver::new(band.view);
                let mut finder = NormalFinder::new(faces);
                let across = band.rays.fan().blocks_across();
                for_each_block(
                    band,
                    #[inline(always)]
                    |place, block| {
                        let depths = measure.block::<S, true>(simd, band, &mut resolver, block);
                        let depths = obstacles.hide(simd, block[1] * across + block[0], depths);
                        place.write_f32(simd, depths, self.depth);
                        if !self.cosine.is_empty() {
                            let cosines = finder.cosines(simd, band, &axes, &mut resolver, block);
                            place.write_f32(simd, cosines, self.cosine);
                        }
                    },
                );
            },
        );
    }
}
