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
use fearless_simd::{Simd, SimdBase, f32x16};

/// What is seen of pixels, row after row: the true depth in metres, +∞ where nothing is met and −∞ where something too near
/// is in the way, and the cosine of the angle of incidence, 1 where nothing is met or nobody asks. Side by side, since
/// who looks beside its own ray looks at both.
pub(super) struct Seen<'a>(pub(super) &'a mut [[f32; 2]]);

impl<'a> Seen<'a> {
    /// Cache lines of so many pixels.
    pub(super) const fn workspace_len(pixels: usize) -> usize {
        lines(pixels * size_of::<[f32; 2]>())
    }

    pub(super) fn new(pixels: usize, memory: &mut Cutter<'a>) -> Self {
        Self(memory.take(pixels))
    }

    /// To be lent once more.
    pub(super) fn reborrow(&mut self) -> Seen<'_> {
        Seen(&mut *self.0)
    }

    /// The first pixels, and the rest.
    pub(super) fn split_at(self, pixels: usize) -> (Self, Self) {
        let (seen, rest) = self.0.split_at_mut(pixels.min(self.0.len()));
        (Self(seen), Self(rest))
    }

    /// Writes what the rays of a band see. Compiled once a level.
    #[inline(never)]
    pub(super) fn write<S: Simd>(
        &mut self,
        simd: S,
        band: &Band<'_>,
        device: &DepthDevice,
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
                        let mut cosines = f32x16::splat(simd, 1.0);
                        if device.wants_incidence() {
                            cosines = finder.cosines(simd, band, &axes, &mut resolver, block);
                        }
                        place.write_pairs(simd, [depths, cosines], self.0);
                    },
                );
            },
        );
    }
}
