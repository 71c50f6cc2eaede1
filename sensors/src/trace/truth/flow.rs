//! Optical flow: where the point that a ray meets is seen at another moment.

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

/// How often the row of a rolling shutter is looked for anew: it moves by less each time, as long as things move by
/// less than the shutter.
const MOST_STEPS: usize = 16;

/// The way of the points of one instance from the axes of the sensor to those of the sensor at another moment.
#[derive(Debug, Clone, Copy)]
struct InstanceMotion {
    turn: DMat3,
    shift: DVec3,
}

impl InstanceMotion {
    /// In one piece, so that what is far from the world's origin keeps its digits.
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

/// An [`InstanceMotion`] between the pixels of a pinhole: those of a point's ray, together with 1/t, are taken to those
/// of its ray at the other moment by one linear map, in homogeneous coordinates.
#[derive(Debug, Clone, Copy)]
struct PixelMotion {
    /// How far ahead, column and row times that; of column, row and 1 each.
    rows: [[f32; 3]; 3],
    /// What 1/t adds.
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

    /// The flow of the rays of a block; NaN where the point is behind the sensor then.
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

/// Works out the flow of the blocks of a band.
pub(crate) struct Flow<'a> {
    other: &'a Shutter<'a>,
    /// If the other moment is one for all lines: of a pinhole, and of other rays.
    pixels: HitCache<PixelMotion>,
    motions: HitCache<InstanceMotion>,
    /// Where the last ray's point went: a good guess for the next.
    guess: [f64; 2],
}

impl<'a> Flow<'a> {
    pub(crate) fn new(other: &'a Shutter<'a>) -> Self {
        Self { other, pixels: HitCache::new(), motions: HitCache::new(), guess: [0.0; 2] }
    }

    /// Pixels to the right and down from each ray of a block to where its point is seen at the other moment; NaN where
    /// nothing is hit, or the point is seen by no pixel then.
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

    /// Between two moments of a pinhole: all rays of an instance at once.
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

    /// Through any lens and shutter.
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

    /// Where a point, in the axes of the sensor, is seen at the other moment.
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

/// The pixel of a point when its line is taken, and the slice of that line: the moment depends on the row, and the row
/// on the moment. The row is one to begin with; `pixel` is where the point is seen at a moment.
pub(in crate::trace) fn at_its_line(
    shutter: &Shutter<'_>,
    height: u32,
    mut row: f64,
    mut pixel: impl FnMut(&Moment<'_>) -> Option<[f64; 2]>,
) -> Option<([f64; 2], usize)> {
    let slices = match shutter {
        Shutter::Global(moment) => return pixel(moment).map(|to| (to, 0)),
        Shutter::Slices(slices) => *slices,
        // These have been refused.
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
