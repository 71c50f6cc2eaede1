//! Optical flow: where the point that a ray hits is seen at another moment.

use crate::moment::{Moment, Shutter};
use crate::optics::Intrinsics;
use crate::optics::rays::{PinholeRays, Rays};
use crate::simd::WIDTH;
use crate::trace::grid::Band;
use crate::trace::hit::cache::HitCache;
use crate::trace::hit::point::block_index;
use crate::trace::hit::resolve::{Resolver, SurfaceHit};
use crate::trace::image::NO_HIT;
use crate::trace::placed::view::View;
use fearless_simd::{Select, Simd, SimdBase, f32x16};
use glam::{DMat3, DVec3};

/// The largest number of iterations that search for the row of a rolling shutter. The row changes by less in each step,
/// as long as the image moves more slowly than the shutter.
const MOST_STEPS: usize = 16;

/// The transformation of one instance's points from the axes of the sensor to those of the sensor at another moment.
#[derive(Debug, Clone, Copy)]
struct InstanceMotion {
    turn: DMat3,
    shift: DVec3,
}

impl InstanceMotion {
    /// Computes the transformation from differences of positions, so that no digits are lost far from the world's
    /// origin.
    fn new(view: &View<'_>, instance: u32, other: &Moment<'_>) -> Self {
        let (sensor, other_sensor) = (&view.world_from_sensor, &other.world_from_sensor);
        let now = &view.world_from_instance[instance as usize];
        let then = &other.world_from_instance[instance as usize];
        let to_other_sensor = other_sensor.rotation_matrix().transpose();
        let turned = then.rotation_matrix() * now.rotation_matrix().transpose();
        let from_instance = turned * (sensor.translation() - now.translation());
        Self {
            turn: to_other_sensor * (turned * sensor.rotation_matrix()),
            shift: to_other_sensor * ((then.translation() - other_sensor.translation()) + from_instance),
        }
    }
}

/// An [`InstanceMotion`] in pixels of a pinhole: the pixel of a point and its 1/t are mapped to its pixel at the other
/// moment by one linear map, in homogeneous coordinates.
#[derive(Debug, Clone, Copy)]
struct PixelMotion {
    /// The rows for the depth, for the column times it, and for the row times it; each has coefficients of column, row
    /// and 1.
    rows: [[f32; 3]; 3],
    /// The coefficients of 1/t.
    shift: [f32; 3],
}

impl PixelMotion {
    fn new(motion: &InstanceMotion, lens: &Intrinsics) -> Self {
        let Intrinsics { fx, fy, cx, cy, .. } = *lens;
        let direction = DMat3::from_cols(
            DVec3::new(0.0, -1.0 / fx, 0.0),
            DVec3::new(0.0, 0.0, -1.0 / fy),
            DVec3::new(1.0, cx / fx, cy / fy),
        );
        let pixel = DMat3::from_cols(DVec3::new(1.0, cx, cy), DVec3::Y * -fx, DVec3::Z * -fy);
        let rows = (pixel * (motion.turn * direction)).transpose();
        Self { rows: rows.as_mat3().to_cols_array_2d(), shift: (pixel * motion.shift).as_vec3().to_array() }
    }

    /// The flow of the rays of a block; NaN if the point is behind the sensor at the other moment.
    #[inline(always)]
    fn flow<S: Simd>(
        &self,
        simd: S,
        band: &Band<'_>,
        rays: &PinholeRays,
        block: [usize; 2],
    ) -> [f32x16<S>; 2] {
        let inverse = f32x16::load_array_ref(simd, &band.target.inverse[block_index(band, block)]);
        let [columns, rows] = rays.pixels(simd, block[0], block[1]);
        let mut moved = [inverse; 3];
        for axis in 0..3 {
            let [column, row, one] = self.rows[axis];
            moved[axis] = ((columns * column + rows * row) + one) + inverse * self.shift[axis];
        }
        let [ahead, across, down] = moved;
        let (per_ahead, none) = (f32x16::splat(simd, 1.0) / ahead, f32x16::splat(simd, f32::NAN));
        let seen = ahead.simd_gt(f32x16::splat(simd, 0.0));
        let flow = [across * per_ahead - columns, down * per_ahead - rows];
        [seen.select(flow[0], none), seen.select(flow[1], none)]
    }
}

/// Computes the flow of the blocks of a band.
pub(crate) struct Flow<'a> {
    other: &'a Shutter<'a>,
    /// Motions in pixels of a pinhole, and motions for other rays, if the other moment is the same for all lines.
    pixels: HitCache<PixelMotion>,
    motions: HitCache<InstanceMotion>,
    /// The pixel to which the last ray's point moved, an initial guess for the next.
    guess: [f64; 2],
}

impl<'a> Flow<'a> {
    pub(crate) fn new(other: &'a Shutter<'a>) -> Self {
        Self { other, pixels: HitCache::new(), motions: HitCache::new(), guess: [0.0; 2] }
    }

    /// The displacement in pixels, to the right and down, from each ray of a block to the pixel of its point at the
    /// other moment; NaN if nothing is hit, or if no pixel sees the point then.
    #[inline(always)]
    pub(crate) fn block<S: Simd>(
        &mut self,
        simd: S,
        band: &Band<'_>,
        resolver: &mut Resolver<'_>,
        block: [usize; 2],
        met: &SurfaceHit<'_>,
    ) -> [f32x16<S>; 2] {
        if let (Rays::Pinhole(rays), Shutter::Global(moment)) = (&band.rays, self.other) {
            return self.pinhole(simd, band, (rays, moment), resolver, block, met);
        }
        let [right, down] = self.ray_by_ray(band, resolver, block);
        [f32x16::load_array(simd, right), f32x16::load_array(simd, down)]
    }

    /// Flow between two moments of a pinhole, for all rays of an instance at once.
    #[inline(always)]
    fn pinhole<S: Simd>(
        &mut self,
        simd: S,
        band: &Band<'_>,
        (rays, moment): (&PinholeRays, &Moment<'_>),
        resolver: &mut Resolver<'_>,
        block: [usize; 2],
        met: &SurfaceHit<'_>,
    ) -> [f32x16<S>; 2] {
        let mut flow = [f32x16::splat(simd, f32::NAN); 2];
        let mut rest = match met {
            SurfaceHit::Nothing => return flow,
            SurfaceHit::One(hit) => {
                let motion = self.pixel_motion(band, rays, moment, hit.instance.instance);
                return motion.flow(simd, band, rays, block);
            }
            SurfaceHit::Several(lanes) => *lanes,
        };
        let slots = &band.target.slot[block_index(band, block)];
        while rest != 0 {
            let (hit, own) = resolver.first_of(simd, slots, rest);
            rest &= !own;
            let motion = self.pixel_motion(band, rays, moment, hit.instance.instance);
            let found = motion.flow(simd, band, rays, block);
            let own = simd.from_bitmask_mask32x16(u64::from(own));
            flow = [own.select(found[0], flow[0]), own.select(found[1], flow[1])];
        }
        flow
    }

    #[inline(always)]
    fn pixel_motion(
        &mut self,
        band: &Band<'_>,
        rays: &PinholeRays,
        moment: &Moment<'_>,
        instance: u32,
    ) -> &PixelMotion {
        self.pixels.get(instance, || {
            PixelMotion::new(&InstanceMotion::new(band.view, instance, moment), rays.intrinsics())
        })
    }

    /// Flow for any lens and shutter.
    fn ray_by_ray(
        &mut self,
        band: &Band<'_>,
        resolver: &mut Resolver<'_>,
        block: [usize; 2],
    ) -> [[f32; WIDTH]; 2] {
        let slots = &band.target.slot[block_index(band, block)];
        let mut flow = [[f32::NAN; WIDTH]; 2];
        let directions = band.rays.exact_block(block[0], block[1]);
        let ray_grid = band.rays.ray_grid();
        for lane in 0..WIDTH {
            if slots[lane] == NO_HIT {
                continue;
            }
            let instance = resolver.hit(slots[lane]).instance.instance;
            let direction = DVec3::from_array(directions.map(|axis| axis[lane]));
            let t = 1.0 / f64::from(band.target.inverse[block_index(band, block)][lane]);
            let (x, y) = ray_grid.lane_position(lane);
            let from =
                [(block[0] << ray_grid.shift_x) + x, (block[1] << ray_grid.shift_y) + y].map(|at| at as f64);
            if let Some(to) = self.find(band, instance, direction * t, from) {
                self.guess = to;
                for axis in 0..2 {
                    flow[axis][lane] = (to[axis] - from[axis]) as f32;
                }
            }
        }
        flow
    }

    /// The pixel at which a point, in the axes of the sensor, is seen at the other moment.
    fn find(&mut self, band: &Band<'_>, instance: u32, point: DVec3, from: [f64; 2]) -> Option<[f64; 2]> {
        let other = self.other;
        if let Shutter::Global(moment) = other {
            let &InstanceMotion { turn, shift } =
                self.motions.get(instance, || InstanceMotion::new(band.view, instance, moment));
            return project(&band.rays, turn * point + shift, [self.guess, from]);
        }
        let seen = at_its_line(other, band.rays.ray_grid().height as u32, from[1], |moment| {
            let InstanceMotion { turn, shift } = InstanceMotion::new(band.view, instance, moment);
            project(&band.rays, turn * point + shift, [self.guess, from])
        });
        seen.map(|(to, _)| to)
    }
}

/// The pixel of a point at the moment at which its line is captured, and the slice of that line. The moment depends on
/// the row, and the row on the moment, so this iterates from an initial `row`; `pixel` gives the point's pixel at a
/// moment.
pub(in crate::trace) fn at_its_line(
    shutter: &Shutter<'_>,
    height: u32,
    mut row: f64,
    mut pixel: impl FnMut(&Moment<'_>) -> Option<[f64; 2]>,
) -> Option<([f64; 2], usize)> {
    let slices = match shutter {
        Shutter::Global(moment) => return pixel(moment).map(|to| (to, 0)),
        Shutter::Slices(slices) => *slices,
        // Moving shutters were refused before.
        Shutter::Moving(_) => return None,
    };
    let mut seen = None;
    for _ in 0..MOST_STEPS {
        let line = (libm::floor(row + 0.5).clamp(0.0, f64::from(height - 1))) as u32;
        let slice = shutter.covering(line..line + 1).start;
        let to = pixel(&slices[slice].at)?;
        let is_settled = slices[slice].lines.contains(&((libm::floor(to[1] + 0.5)).max(0.0) as u32));
        (row, seen) = (to[1], Some((to, slice)));
        if is_settled {
            break;
        }
    }
    seen
}

/// The pixel that sees a point; each of the guesses is tried.
fn project(rays: &Rays<'_>, point: DVec3, guesses: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    guesses.into_iter().find_map(|guess| rays.project(point, guess))
}
