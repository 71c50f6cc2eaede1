//! Fog in front of surfaces, and the sky behind them. Compiled once for each level and never inlined, so that scenes
//! without them do not pay.

use super::power::exp;
use super::tile::Tile;
use super::{Colours, ROWS, lanes_in, light_of, store_where};
use crate::scene::{Fog, FogLaw};
use crate::simd::load_row;
use crate::trace::placed::view::View;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};

/// Blends the surfaces of a tile with fog, by their depths along the optical axis if `along_axis`, and otherwise along
/// the rays.
#[inline(never)]
pub(super) fn blend<S: Simd>(
    simd: S,
    view: &View<'_>,
    fog: &Fog,
    (tile, along_axis): (&Tile, bool),
    colours: &mut Colours,
) {
    let axis = view.world_from_sensor.rotation_matrix().x_axis.as_vec3().to_array();
    let colour = light_of(fog.colour, view.scene.colour_space);
    simd.vectorize(
        #[inline(always)]
        || {
            let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
            for row in 0..ROWS {
                let [x, y, z] = &tile.point;
                let (x, y, z) = (load_row(simd, x, row), load_row(simd, y, row), load_row(simd, z, row));
                let depth = if along_axis {
                    (x * axis[0] + y * axis[1]) + z * axis[2]
                } else {
                    ((x * x + y * y) + z * z).sqrt()
                };
                let share = match fog.law {
                    FogLaw::Linear { start_m, end_m } => {
                        let share = (f32x16::splat(simd, end_m) - depth) / (end_m - start_m);
                        let share = share.simd_gt(0.0).select(share, zero);
                        share.simd_lt(1.0).select(share, one)
                    }
                    FogLaw::Exponential { density_per_m } => exp(simd, depth * -density_per_m),
                    FogLaw::ExponentialSquared { density_per_m } => {
                        let thickness = depth * density_per_m;
                        exp(simd, thickness * thickness * -1.0)
                    }
                };
                let mine = lanes_in(simd, tile.hits, row);
                for channel in 0..3 {
                    let own = load_row(simd, &colours[channel], row);
                    let seen = (own - colour[channel]) * share + colour[channel];
                    store_where(simd, mine, seen, &mut colours[channel], row);
                }
            }
        },
    );
}

/// Sets the lanes of a tile that hit nothing to a clear sky with these colours at the zenith and at the horizon.
#[inline(never)]
pub(super) fn paint_sky<S: Simd>(
    simd: S,
    view: &View<'_>,
    [zenith, horizon]: [[f32; 3]; 2],
    tile: &Tile,
    colours: &mut Colours,
) {
    let space = view.scene.colour_space;
    let (zenith, horizon) = (light_of(zenith, space), light_of(horizon, space));
    simd.vectorize(
        #[inline(always)]
        || {
            let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
            for row in 0..ROWS {
                let [x, y, z] = &tile.direction;
                let (x, y, z) = (load_row(simd, x, row), load_row(simd, y, row), load_row(simd, z, row));
                let sin = z / ((x * x + y * y) + z * z).sqrt();
                let left = one - sin.simd_gt(0.0).select(sin, zero);
                let share = one - left * left;
                let mine = lanes_in(simd, !tile.hits, row);
                for channel in 0..3 {
                    let colour = share * (zenith[channel] - horizon[channel]) + horizon[channel];
                    store_where(simd, mine, colour, &mut colours[channel], row);
                }
            }
        },
    );
}
