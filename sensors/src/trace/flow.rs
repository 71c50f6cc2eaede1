//! Optical flow: where the point that a ray meets is seen at another moment.

use super::grid::Band;
use super::hit_point::block_index;
use super::image::NO_HIT;
use super::resolve::Resolver;
use super::view::View;
use crate::moment::{Moment, Shutter};
use crate::optics::rays::Rays;
use crate::simd::WIDTH;
use fearless_simd::{Simd, SimdBase, f32x16};
use glam::{DMat3, DVec3};

/// What stands for no flow.
const NONE: [f32; 2] = [f32::NAN; 2];
/// How often the row of a rolling shutter is looked for anew: it moves by less each time, as long as things move by less
/// than the shutter.
const MOST_STEPS: usize = 16;

/// The way of the points of one instance from the axes of the sensor to those of the sensor at another moment.
#[derive(Debug, Clone, Copy)]
struct Motion {
    turn: DMat3,
    shift: DVec3,
}

impl Motion {
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

/// Works out the flow of the blocks of a band.
pub(crate) struct Flow<'a> {
    other: &'a Shutter<'a>,
    /// That of the instance met last, if the other moment is one for all lines.
    last: Option<(u32, Motion)>,
    /// Where the last ray's point went: a good guess for the next.
    guess: [f64; 2],
}

impl<'a> Flow<'a> {
    pub(crate) fn new(other: &'a Shutter<'a>) -> Self {
        Self { other, last: None, guess: [0.0; 2] }
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
    ) -> [[f32; 2]; WIDTH] {
        let slots = &band.target.slot[block_index(band, block)];
        if let (Rays::Pinhole(lens), Shutter::Global(moment)) = (&band.rays, self.other)
            && slots[0] != NO_HIT
        {
            let instance = resolver.hit(slots[0]).instance.instance;
            if resolver.are_of_last(simd, slots) {
                let lens = lens.intrinsics();
                let scale = [lens.fx as f32, lens.fy as f32];
                let centre = [lens.cx as f32, lens.cy as f32];
                return pinhole(
                    simd,
                    band,
                    &self.motion(band.view, instance, moment),
                    (scale, centre),
                    block,
                );
            }
        }
        let mut flow = [NONE; WIDTH];
        let directions = band.rays.exact_block(block[0], block[1]);
        let fan = band.rays.fan();
        for lane in 0..WIDTH {
            if slots[lane] == NO_HIT {
                continue;
            }
            let instance = resolver.hit(slots[lane]).instance.instance;
            let direction = DVec3::from_array(directions.map(|axis| axis[lane]));
            let t = 1.0 / f64::from(band.target.inverse[block_index(band, block)][lane]);
            let (x, y) = fan.lane_position(lane);
            let from = [(block[0] << fan.shift_x) + x, (block[1] << fan.shift_y) + y].map(|at| at as f64);
            if let Some(to) = self.find(band, instance, direction * t, from) {
                self.guess = to;
                flow[lane] = [(to[0] - from[0]) as f32, (to[1] - from[1]) as f32];
            }
        }
        flow
    }

    /// Where a point, in the axes of the sensor, is seen at the other moment.
    fn find(&mut self, band: &Band<'_>, instance: u32, point: DVec3, from: [f64; 2]) -> Option<[f64; 2]> {
        let slices = match self.other {
            Shutter::Global(moment) => {
                let Motion { turn, shift } = self.motion(band.view, instance, moment);
                return project(&band.rays, turn * point + shift, [self.guess, from]);
            }
            Shutter::Slices(slices) => *slices,
        };
        // The moment depends on the row, and the row on the moment.
        let last_row = band.rays.fan().height - 1;
        let mut row = from[1];
        let mut seen = None;
        for _ in 0..MOST_STEPS {
            let line = (libm::floor(row + 0.5).clamp(0.0, f64::from(last_row))) as u32;
            let slice = self.other.covering(line..line + 1).start;
            let Motion { turn, shift } = Motion::new(band.view, instance, &slices[slice].at);
            let to = project(&band.rays, turn * point + shift, [self.guess, from])?;
            let is_settled = slices[slice].lines.contains(&((libm::floor(to[1] + 0.5)).max(0.0) as u32));
            (row, seen) = (to[1], Some(to));
            if is_settled {
                break;
            }
        }
        seen
    }

    #[inline(always)]
    fn motion(&mut self, view: &View<'_>, instance: u32, other: &Moment<'_>) -> Motion {
        match self.last {
            Some((last, motion)) if last == instance => motion,
            _ => {
                let motion = Motion::new(view, instance, other);
                self.last = Some((instance, motion));
                motion
            }
        }
    }
}

/// The pixel that sees a point; each of the guesses is tried.
fn project(rays: &Rays<'_>, point: DVec3, guesses: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    guesses.into_iter().find_map(|guess| rays.project(point, guess))
}

/// The flow of a pinhole's block whose rays all meet one instance.
#[inline(always)]
fn pinhole<S: Simd>(
    simd: S,
    band: &Band<'_>,
    motion: &Motion,
    (scale, centre): ([f32; 2], [f32; 2]),
    [column, row]: [usize; 2],
) -> [[f32; 2]; WIDTH] {
    let index = block_index(band, [column, row]);
    let inverse = f32x16::load_array_ref(simd, &band.target.inverse[index]);
    let distance = band.rays.distances(simd, inverse, column, row);
    let [x, y, z] = band.rays.unit_directions(simd, column, row);
    let [x, y, z] = [x * distance, y * distance, z * distance];
    let turn = motion.turn.transpose().as_mat3().to_cols_array_2d();
    let shift = motion.shift.as_vec3().to_array();
    let moved = |axis: usize| {
        let [a, b, c] = turn[axis];
        ((x * a + y * b) + z * c) + shift[axis]
    };
    let (ahead, left, up) = (moved(0), moved(1), moved(2));
    let per_depth = f32x16::splat(simd, 1.0) / ahead;
    let (mut ahead_of, mut columns, mut rows) = ([0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
    ahead.store_array(&mut ahead_of);
    (f32x16::splat(simd, centre[0]) - (left * per_depth) * scale[0]).store_array(&mut columns);
    (f32x16::splat(simd, centre[1]) - (up * per_depth) * scale[1]).store_array(&mut rows);
    let fan = band.rays.fan();
    let mut flow = [NONE; WIDTH];
    for lane in 0..WIDTH {
        let (x, y) = fan.lane_position(lane);
        let from = [(column << fan.shift_x) + x, (row << fan.shift_y) + y].map(|at| at as f32);
        let to = [columns[lane] - from[0], rows[lane] - from[1]];
        flow[lane] = if ahead_of[lane] > 0.0 { to } else { NONE };
    }
    flow
}
