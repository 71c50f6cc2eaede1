//! Shadows: whether anything is between a lamp and the points that it lights, for the 64 rays of a tile.
//!
//! Only few instances are between a lamp and a tile. The [`occluders`](super::occluders) of each lamp cache them for
//! the neighbourhood of the last tile, so the tree over the instances is seldom traversed. Boxes, of which rooms are
//! built, are tested in single precision, everything else in double precision.
//!
//! The outside of a convex instance never shadows itself; its inside does, unless the lamp is inside as well. Meshes
//! and height fields may shadow themselves, so points on them are first [lifted](lift) from their triangles, to the
//! side that is seen.

use super::occluders::Occluders;
use super::ray_offset::lift;
use super::tile::Tile;
use crate::scene::{Kind, Solid};
use crate::simd::{LANES, WIDTH, load_row};
use crate::trace::packet::hits::{Search, activate, hit_lanes, intersect_instance};
use crate::trace::packet::walk::{stack_len, walk};
use crate::trace::packet::{Faces, Packet, PacketBounds};
use crate::trace::placed::view::{MAX_DEPTH, View};
use crate::trace::shapes::LocalRays;
use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16};
use glam::DVec3;

/// Shadow rays end before the surface by this fraction of their length, unless the point is lifted.
const SHADOW_BIAS: f32 = 1e-5;
/// Parallel shadow rays start this many metres above the surface, plus as much again per metre of distance from the
/// sensor.
const PARALLEL_BIAS: f64 = 1e-6;

/// Number of lamps whose occluders are cached; for others, they are searched for each tile.
const REMEMBERED: usize = 4;

/// The state of the search for shadows, reused from tile to tile of a frame.
pub(crate) struct Shadows {
    occluders: [Occluders; REMEMBERED],
    /// Rays in double precision, in the view and in the frame of an instance.
    packet: Packet,
    local: LocalRays,
}

impl Shadows {
    pub(crate) const fn new() -> Self {
        Self {
            occluders: [const { Occluders::new() }; REMEMBERED],
            packet: Packet::new(),
            local: LocalRays::new(),
        }
    }

    /// Returns scratch memory for rays. Nothing in it is kept from one call to the next.
    pub(super) fn rays(&mut self) -> (&mut Packet, &mut LocalRays) {
        (&mut self.packet, &mut self.local)
    }

    /// The lanes in `lit` that the light of a lamp does not reach; the lanes in `back` see the back of a surface. Only
    /// outsides of surfaces cast shadows, so the bulb around a lamp does not keep its light in.
    #[inline(always)]
    pub(crate) fn of_lamp<S: Simd>(
        &mut self,
        simd: S,
        view: &View<'_>,
        tile: &Tile,
        (lamp, position): (usize, DVec3),
        (lit, back): (u64, u64),
    ) -> u64 {
        simd.vectorize(
            #[inline(always)]
            || {
                let Self { occluders, packet, local } = self;
                let bounds = PacketBounds::from_point(position, &tile.bounds);
                let mut rays = ShadowRays {
                    view,
                    tile,
                    packet,
                    local,
                    position,
                    lit,
                    back,
                    dark: 0,
                    is_aimed: false,
                    lifted: 0,
                };
                if let Some(occluders) = occluders.get_mut(lamp)
                    && occluders.cover(simd, view, position, &tile.bounds)
                {
                    let node = occluders.node();
                    let mut lanes = bounds.enter(simd, node, 1.0);
                    while lanes != 0 {
                        let lane = lanes.trailing_zeros() as usize & (WIDTH - 1);
                        lanes &= lanes - 1;
                        if !rays.meet(simd, node.child[lane]) {
                            break;
                        }
                    }
                } else {
                    walk::<S, _, { stack_len(MAX_DEPTH) }>(
                        simd,
                        #[inline(always)]
                        |node| &view.nodes[node as usize],
                        &bounds,
                        1.0,
                        #[inline(always)]
                        |index| !view.placed[index as usize].casts_shadows() || rays.meet(simd, index),
                    );
                }
                rays.dark
            },
        )
    }

    /// The lanes in `lit` that parallel light does not reach. Both sides of surfaces cast shadows.
    pub(crate) fn of_parallel<S: Simd>(
        &mut self,
        simd: S,
        view: &View<'_>,
        tile: &Tile,
        towards: DVec3,
        (lit, back): (u64, u64),
    ) -> u64 {
        let Self { packet, local, .. } = self;
        simd.vectorize(
            #[inline(always)]
            || {
                let mut farthest = 0.0_f64;
                for axis in 0..3 {
                    let [low, high] = tile.bounds[axis];
                    farthest = farthest.max(f64::from(low.abs())).max(f64::from(high.abs()));
                    for lane in 0..LANES {
                        packet.origin[axis][lane] = f64::from(tile.point[axis][lane]);
                    }
                    packet.direction[axis] = [towards[axis]; LANES];
                }
                packet.shared_origin = false;
                packet.t_min = PARALLEL_BIAS * (1.0 + farthest);
                let lifted = lift(simd, view, tile, (lit, back), &mut packet.origin);
                if lifted != 0 {
                    // The rays of lifted points start at the points themselves.
                    for axis in 0..3 {
                        let back = towards[axis] * packet.t_min;
                        for lane in 0..LANES {
                            let moved = if lifted >> lane & 1 != 0 { back } else { 0.0 };
                            packet.origin[axis][lane] -= moved;
                        }
                    }
                }
                activate(packet, lit, f64::INFINITY);
                let bounds = PacketBounds::new(&packet.origin, &packet.direction, packet);
                let mut dark = 0;
                walk::<S, _, { stack_len(MAX_DEPTH) }>(
                    simd,
                    #[inline(always)]
                    |node| &view.nodes[node as usize],
                    &bounds,
                    f32::INFINITY,
                    #[inline(always)]
                    |index| {
                        if !view.placed[index as usize].casts_shadows() {
                            return true;
                        }
                        let active = lit & !dark & !own_lanes(simd, view, tile, (index, back));
                        if active != 0 {
                            activate(packet, active, f64::INFINITY);
                            let search = (Faces::Both, Search::Any(f32::INFINITY));
                            intersect_instance(simd, view, index, (packet, local), search);
                            dark |= hit_lanes(packet);
                        }
                        dark != lit
                    },
                );
                dark
            },
        )
    }
}

/// The lanes on an instance that it cannot shadow itself: those on the outside of something convex, and those on either
/// side of something without an inside.
#[inline(always)]
fn own_lanes<S: Simd>(simd: S, view: &View<'_>, tile: &Tile, (index, back): (u32, u64)) -> u64 {
    match view.instance(index).kind() {
        Kind::Solid(Solid::Rectangle | Solid::Plane) => tile.lanes_of(simd, index),
        Kind::Solid(_) => tile.lanes_of(simd, index) & !back,
        Kind::Triangles(_) => 0,
    }
}

/// Rays from a lamp to the points of a tile.
struct ShadowRays<'a> {
    view: &'a View<'a>,
    tile: &'a Tile,
    packet: &'a mut Packet,
    local: &'a mut LocalRays,
    position: DVec3,
    lit: u64,
    /// The lanes that see the back of a surface.
    back: u64,
    /// The lanes in shadow.
    dark: u64,
    /// True if the packet contains these rays.
    is_aimed: bool,
    /// The lanes whose end points are lifted, valid once the rays are in the packet.
    lifted: u64,
}

impl ShadowRays<'_> {
    /// Marks the rays that an instance blocks, and returns true if any lit lane is left.
    #[inline(always)]
    fn meet<S: Simd>(&mut self, simd: S, index: u32) -> bool {
        let own = own_lanes(simd, self.view, self.tile, (index, self.back));
        let active = self.lit & !self.dark & !own;
        if active != 0 {
            let instance = self.view.instance(index);
            self.dark |= match instance.kind() {
                Kind::Solid(Solid::Box) => self.meet_box(simd, index, active),
                Kind::Solid(solid)
                    if !self.comes_near(simd, index, solid.half_extents(instance.size), active) =>
                {
                    0
                }
                Kind::Solid(_) | Kind::Triangles(_) => self.meet_other(simd, index, active),
            };
        }
        self.dark != self.lit
    }

    /// The slab test of [`crate::trace::shapes::cuboid`] in single precision.
    #[inline(always)]
    fn meet_box<S: Simd>(&self, simd: S, index: u32, active: u64) -> u64 {
        let half = self.view.instance(index).size;
        let mut dark = 0;
        self.for_each_row(
            simd,
            (index, half),
            active,
            #[inline(always)]
            |row, enter, exit| {
                let hit = enter.simd_le(exit) & enter.simd_ge(0.0) & enter.simd_lt(1.0 - SHADOW_BIAS);
                dark |= hit.to_bitmask() << (row * WIDTH);
            },
        );
        dark & active
    }

    /// Returns true if any ray comes near the box around a solid. This happens seldom enough that the test pays off.
    #[inline(always)]
    fn comes_near<S: Simd>(&self, simd: S, index: u32, half: [f64; 3], active: u64) -> bool {
        // More than all rounding errors of the slabs together.
        const MARGIN: f64 = 4e-6;
        let mut reach = self.position.abs().max_element();
        for [low, high] in self.tile.bounds {
            reach = reach.max(f64::from(low.abs())).max(f64::from(high.abs()));
        }
        let mut grown = half;
        for axis in 0..3 {
            let [x, y, z] = self.view.placed[index as usize].inverse[axis];
            grown[axis] += MARGIN * (half[axis] + reach * (x.abs() + y.abs() + z.abs()));
        }
        let mut near = false;
        self.for_each_row(
            simd,
            (index, grown),
            active,
            #[inline(always)]
            |_, enter, exit| {
                let (enter, exit) = (enter - enter.abs() * 1e-5, exit + exit.abs() * 1e-5);
                near |= (enter.simd_le(exit) & exit.simd_ge(0.0) & enter.simd_le(1.0)).any_true();
            },
        );
        near
    }

    /// Calls `visit` for each row with active lanes, with the positions where its rays enter and leave a box of an
    /// instance.
    #[inline(always)]
    fn for_each_row<S: Simd>(
        &self,
        simd: S,
        (index, half): (u32, [f64; 3]),
        active: u64,
        mut visit: impl FnMut(usize, f32x16<S>, f32x16<S>),
    ) {
        let placed = &self.view.placed[index as usize];
        // Distances from the lamp are rounded after the subtraction.
        let inverse = placed.inverse.map(DVec3::from_array);
        let lamp = self.position - DVec3::from_array(placed.translation);
        let (mut to_low, mut to_high, mut rows) = ([0.0; 3], [0.0; 3], [[0.0; 3]; 3]);
        for axis in 0..3 {
            let at = inverse[axis].dot(lamp);
            (to_low[axis], to_high[axis]) = ((-half[axis] - at) as f32, (half[axis] - at) as f32);
            rows[axis] = inverse[axis].as_vec3().to_array();
        }
        let one = f32x16::splat(simd, 1.0);
        for row in 0..LANES / WIDTH {
            if (active >> (row * WIDTH)) as u16 == 0 {
                continue;
            }
            let mut direction = [one; 3];
            for axis in 0..3 {
                direction[axis] = load_row(simd, &self.tile.point[axis], row) - self.position[axis] as f32;
            }
            let mut enter = f32x16::splat(simd, f32::NEG_INFINITY);
            let mut exit = f32x16::splat(simd, f32::INFINITY);
            for axis in 0..3 {
                let [x, y, z] = rows[axis];
                let per_step = one / ((direction[0] * x + direction[1] * y) + direction[2] * z);
                let (a, b) = (per_step * to_low[axis], per_step * to_high[axis]);
                let ascending = a.simd_lt(b);
                let (near, far) = (ascending.select(a, b), ascending.select(b, a));
                enter = near.simd_gt(enter).select(near, enter);
                exit = far.simd_lt(exit).select(far, exit);
            }
            visit(row, enter, exit);
        }
    }

    fn meet_other<S: Simd>(&mut self, simd: S, index: u32, active: u64) -> u64 {
        let Self { view, tile, position, lit, back, .. } = *self;
        let aim = !core::mem::replace(&mut self.is_aimed, true);
        let (packet, local, lifted) = (&mut *self.packet, &mut *self.local, &mut self.lifted);
        simd.vectorize(
            #[inline(always)]
            || {
                if aim {
                    for axis in 0..3 {
                        for lane in 0..LANES {
                            packet.direction[axis][lane] = f64::from(tile.point[axis][lane]);
                        }
                    }
                    *lifted = lift(simd, view, tile, (lit, back), &mut packet.direction);
                    for axis in 0..3 {
                        packet.origin[axis] = [position[axis]; LANES];
                        for lane in 0..LANES {
                            packet.direction[axis][lane] -= position[axis];
                        }
                    }
                    packet.shared_origin = true;
                    packet.t_min = 0.0;
                }
                activate(packet, active, 1.0 - f64::from(SHADOW_BIAS));
                if active & *lifted != 0 {
                    for lane in 0..LANES {
                        let whole = active & *lifted & 1 << lane != 0;
                        packet.t[lane] = if whole { 1.0 } else { packet.t[lane] };
                    }
                }
                let search = (Faces::Front, Search::Any(1.0));
                intersect_instance(simd, view, index, (packet, local), search);
                hit_lanes(packet)
            },
        )
    }
}
