//! Up to 64 rays, each with its own origin and its own time between two moments.
//!
//! They traverse the tree over the instances together, as a packet, and are tested against a solid all at once, in
//! double precision. Rays that hit the box of a mesh traverse its tree as a wave. Moving instances are hit at the pose
//! that they have at the time of the ray.

use crate::pose::Pose;
use crate::scene::{Kind, Triangles};
use crate::simd::{LANES, Lanes, WIDTH};
use crate::trace::grid::Sight;
use crate::trace::hit::resolve::Resolver;
use crate::trace::packet::scratch::MovingScratch;
use crate::trace::packet::walk::{stack_len, walk_to_nearest};
use crate::trace::packet::{Faces, MISS, Packet, PacketBounds};
use crate::trace::placed::view::{self, Placed, View};
use crate::trace::rays::bundle::RAYS;
use crate::trace::rays::ray::{Nearest, Ray};
use crate::trace::rays::wave::Wave;
use crate::trace::rays::{doubt_of, mesh_tree, nearest_in_tree};
use crate::trace::shapes::{self, LocalRays, commit, match_solid, solid_normal};
use fearless_simd::Simd;
use glam::{DMat3, DVec3};

/// The relative enlargement of boxes around triangles: more than all rounding errors of a test together.
const MARGIN: f64 = 1e-6;

/// The rays of a view, and their hits.
pub(crate) struct MovingPacket {
    packet: Packet,
    /// The times, as fractions of the interval from the view's moment to the next one.
    share: Lanes<f64>,
}

/// The scratch memory that a packet is cast with. Nothing in it is kept from one cast to the next.
pub(crate) struct Ways<'m> {
    /// The rays in the frame of the current instance.
    local: &'m mut LocalRays,
    /// The rays that traverse a mesh or a height field.
    wave: Wave<'m>,
}

impl<'m> Ways<'m> {
    #[inline(always)]
    pub(crate) fn new(room: &'m mut MovingScratch) -> Self {
        Self { local: &mut room.local, wave: Wave::new(&mut room.wave) }
    }
}

/// The hit of a ray.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MovingHit {
    /// The index of the instance in the scene.
    pub(crate) instance: u32,
    /// The distance in metres.
    pub(crate) range: f64,
    /// The outward unit normal, along the axes of the world.
    pub(crate) normal: DVec3,
    /// The cosine of the angle between the normal and the reversed ray.
    pub(crate) cos_incidence: f64,
}

impl MovingPacket {
    pub(crate) const fn new() -> Self {
        let mut packet = Packet::new();
        packet.shared_origin = false;
        Self { packet, share: [0.0; LANES] }
    }

    /// Removes all rays.
    pub(crate) fn clear(&mut self) {
        self.packet.t = [f64::NEG_INFINITY; LANES];
        self.packet.hit = [MISS; LANES];
    }

    /// Sets a ray: its origin relative to the view's and its unit direction, both along the axes of the world, and its
    /// time.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, origin: DVec3, direction: DVec3, share: f64, farthest: f64) {
        for axis in 0..3 {
            self.packet.origin[axis][lane] = origin[axis];
            self.packet.direction[axis][lane] = direction[axis];
        }
        self.share[lane] = share;
        self.packet.t[lane] = farthest;
    }

    /// The origin and direction of a ray, as they were set.
    pub(crate) fn ray(&self, lane: usize) -> [DVec3; 2] {
        [of_lane(&self.packet.origin, lane), of_lane(&self.packet.direction, lane)]
    }

    /// The time of a ray, as it was set.
    pub(crate) fn share(&self, lane: usize) -> f64 {
        self.share[lane]
    }

    /// The distance to the hit, or `None` if the ray hits nothing.
    #[inline(always)]
    pub(crate) fn range(&self, lane: usize) -> Option<f64> {
        self.slot(lane).map(|_| self.packet.t[lane])
    }

    /// The slot of the hit, or `None` if the ray hits nothing.
    #[inline(always)]
    pub(crate) fn slot(&self, lane: usize) -> Option<u32> {
        Some(self.packet.hit[lane]).filter(|slot| *slot != MISS)
    }

    /// Finds the first hit of each ray.
    #[inline(always)]
    pub(crate) fn cast<S: Simd>(&mut self, simd: S, view: &View<'_>, sight: &Sight, ways: &mut Ways<'_>) {
        let Self { packet, share } = self;
        let Ways { local, wave } = ways;
        packet.t_min = sight.range[0];
        let bounds = PacketBounds::new(&packet.origin, &packet.direction, packet);
        walk_to_nearest::<S, _, { stack_len(view::MAX_DEPTH) }>(
            simd,
            #[inline(always)]
            |node| &view.nodes[node as usize],
            &bounds,
            packet,
            #[inline(always)]
            |index, packet| {
                let placed = &view.placed[index as usize];
                take_in(view, placed, packet, share, local);
                match placed.kind() {
                    Kind::Solid(solid) => match_solid!(
                        solid,
                        view.instance(index).size,
                        inside => commit(local, packet, sight.faces, placed.first_slot, inside)
                    ),
                    Kind::Triangles(kind) => {
                        let only_front = sight.faces == Faces::Front;
                        let near = near(view, placed, local, packet);
                        if near != 0 {
                            let rays = (&**local, packet, near);
                            match kind {
                                Triangles::Mesh => {
                                    through_mesh(simd, (view, placed), only_front, rays, wave);
                                }
                                Triangles::HeightField => {
                                    through_height_field(simd, (view, placed), only_front, rays, wave);
                                }
                            }
                        }
                    }
                }
            },
        );
    }

    /// The hit of a ray, or `None` if it hits nothing.
    pub(crate) fn struck(
        &self,
        view: &View<'_>,
        resolver: &mut Resolver<'_>,
        lane: usize,
    ) -> Option<MovingHit> {
        let slot = self.slot(lane)?;
        let hit = resolver.hit(slot);
        let (placed, index) = (hit.instance, hit.instance.instance);
        let instance = &view.scene.instances[index as usize];
        let normal = match placed.kind() {
            Kind::Triangles(_) => {
                let [a, b, c] = view.corners(placed, hit.local);
                (b - a).cross(c - a)
            }
            Kind::Solid(solid) => {
                let [origin, direction] = self.in_instance(view, placed, lane);
                let point = origin + direction * self.packet.t[lane];
                DVec3::from_array(solid_normal(solid, instance.size, point.to_array()))
            }
        };
        // Normals are transformed by the inverse transpose.
        let normal = match PlacedMotion::of(view, placed) {
            Some(motion) => {
                let turn = motion.from.interpolate(&motion.to, self.share[lane]).rotation_matrix();
                turn * (normal * motion.inverse_scale)
            }
            None => DMat3::from_cols_array_2d(&placed.inverse) * normal,
        };
        let normal = normal.normalize_or_zero();
        let cos_incidence = -normal.dot(of_lane(&self.packet.direction, lane));
        Some(MovingHit { instance: index, range: self.packet.t[lane], normal, cos_incidence })
    }

    /// Transforms a ray to the frame of an instance.
    fn in_instance(&self, view: &View<'_>, placed: &Placed, lane: usize) -> [DVec3; 2] {
        let [origin, direction] = self.ray(lane);
        match PlacedMotion::of(view, placed) {
            Some(motion) => motion.in_instance(origin, direction, self.share[lane]),
            None => [
                placed.vector_in_instance(origin - DVec3::from_array(placed.translation)),
                placed.vector_in_instance(direction),
            ],
        }
    }
}

/// The motion of an instance from a view's moment to the next.
struct PlacedMotion {
    from: Pose,
    to: Pose,
    /// The first position relative to the view's origin, and the displacement.
    translation: DVec3,
    shift: DVec3,
    /// The first rotation and the difference to the last one, as quaternions. Their interpolation is not of length 1.
    rotation: [f64; 4],
    turn: [f64; 4],
    inverse_scale: DVec3,
}

impl PlacedMotion {
    /// Returns `None` if the instance does not move.
    fn of(view: &View<'_>, placed: &Placed) -> Option<Self> {
        let index = placed.instance as usize;
        let (from, to) = (view.world_from_instance[index], view.next?.world_from_instance[index]);
        if from == to {
            return None;
        }
        let (first, last) = (from.rotation(), to.rotation());
        let last = if first.dot(last) < 0.0 { -last } else { last };
        Some(Self {
            from,
            to,
            translation: from.translation() - view.origin_in_world,
            shift: to.translation() - from.translation(),
            rotation: first.to_array(),
            turn: (last - first).to_array(),
            inverse_scale: 1.0 / DVec3::from_array(view.scene.instances[index].scale),
        })
    }

    /// Transforms an origin and a direction to the frame of the instance at a time.
    #[inline(always)]
    fn in_instance(&self, origin: DVec3, direction: DVec3, share: f64) -> [DVec3; 2] {
        let [x, y, z, w] = [0, 1, 2, 3].map(|part| self.rotation[part] + self.turn[part] * share);
        let per_square = 2.0 / ((x * x + y * y) + (z * z + w * w));
        let axis = DVec3::new(x, y, z);
        // The inverse rotation, by the conjugate divided by the square of the length, which is not 1.
        let back = |v: DVec3| {
            let across = axis.cross(v);
            (v + (axis.cross(across) - across * w) * per_square) * self.inverse_scale
        };
        [back(origin - (self.translation + self.shift * share)), back(direction)]
    }
}

#[inline(always)]
fn of_lane([x, y, z]: &[Lanes<f64>; 3], lane: usize) -> DVec3 {
    DVec3::new(x[lane], y[lane], z[lane])
}

/// Transforms the rays of a packet to the frame of an instance.
#[inline(always)]
fn take_in(view: &View<'_>, placed: &Placed, packet: &Packet, share: &Lanes<f64>, local: &mut LocalRays) {
    let mut put = |lane: usize, [origin, direction]: [DVec3; 2]| {
        for axis in 0..3 {
            local.origin[axis][lane] = origin[axis];
            local.direction[axis][lane] = direction[axis];
        }
    };
    if let Some(motion) = PlacedMotion::of(view, placed) {
        for lane in 0..LANES {
            put(
                lane,
                motion.in_instance(
                    of_lane(&packet.origin, lane),
                    of_lane(&packet.direction, lane),
                    share[lane],
                ),
            );
        }
    } else {
        let [a, b, c] = placed.inverse.map(DVec3::from_array);
        let translation = DVec3::from_array(placed.translation);
        for lane in 0..LANES {
            let origin = of_lane(&packet.origin, lane) - translation;
            let direction = of_lane(&packet.direction, lane);
            let turned = |v: DVec3| DVec3::new(a.dot(v), b.dot(v), c.dot(v));
            put(lane, [turned(origin), turned(direction)]);
        }
    }
}

/// The lanes whose rays may hit an instance's box before their hits so far, as one bit each.
#[inline(always)]
fn near(view: &View<'_>, placed: &Placed, local: &LocalRays, packet: &Packet) -> u64 {
    let instance = &view.scene.instances[placed.instance as usize];
    let [low, high] = view.scene.local_bounds(instance);
    let middle = (low + high) * 0.5;
    let half = ((high - low) * 0.5 + (low.abs().max(high.abs())) * MARGIN + DVec3::splat(1e-9)).to_array();
    let mut inside = [false; LANES];
    for lane in 0..LANES {
        let origin = [0, 1, 2].map(|axis| local.origin[axis][lane] - middle[axis]);
        let direction = [0, 1, 2].map(|axis| local.direction[axis][lane]);
        let within = shapes::cuboid::inside(origin, direction, half);
        inside[lane] =
            within.enter <= within.exit && within.exit >= packet.t_min && within.enter <= packet.t[lane];
    }
    let mut lanes = 0;
    for (lane, inside) in inside.into_iter().enumerate() {
        lanes |= u64::from(inside) << lane;
    }
    lanes
}

/// The range in which a ray may still hit something: slightly more than the distance of its hit so far, because boxes
/// and hits are rounded.
#[inline(always)]
fn range_of(packet: &Packet, lane: usize) -> [f32; 2] {
    [packet.t_min as f32, (packet.t[lane] * (1.0 + MARGIN)) as f32]
}

/// Stores a hit on a triangle if it is nearer than the hit so far.
#[inline(always)]
fn offer(packet: &mut Packet, lane: usize, t: f64, slot: u32) {
    if t < packet.t[lane] && t >= packet.t_min {
        (packet.t[lane], packet.hit[lane]) = (t, slot);
    }
}

/// Traverses the tree of a mesh with some rays, sixteen at a time.
#[inline(always)]
fn through_mesh<S: Simd>(
    simd: S,
    (view, placed): (&View<'_>, &Placed),
    only_front: bool,
    (local, packet, lanes): (&LocalRays, &mut Packet, u64),
    wave: &mut Wave<'_>,
) {
    let tree = mesh_tree(view, placed);
    let (mut order, mut count, mut rest) = ([0_u8; LANES], 0, lanes);
    while rest != 0 {
        order[count] = rest.trailing_zeros() as u8;
        rest &= rest - 1;
        count += 1;
    }
    let doubt = doubt_of(tree.nodes.first());
    for order in order[..count].chunks(RAYS) {
        let count = order.len();
        for id in 0..count.next_multiple_of(WIDTH) {
            // Unused lanes repeat the last ray.
            let lane = usize::from(order[id.min(count - 1)]);
            let (origin, direction) = (of_lane(&local.origin, lane), of_lane(&local.direction, lane));
            wave.set(id, origin, direction, range_of(packet, lane));
        }
        wave.cast(simd, tree, (count, doubt), only_front);
        for (id, &lane) in order.iter().enumerate() {
            if let Some((t, slot)) = wave.hit(id) {
                offer(packet, usize::from(lane), t, placed.first_slot + slot);
            }
        }
    }
}

/// Traverses the tree of a height field, which is generated on the fly, with some rays, one after the other.
#[inline(always)]
fn through_height_field<S: Simd>(
    simd: S,
    (view, placed): (&View<'_>, &Placed),
    only_front: bool,
    (local, packet, mut lanes): (&LocalRays, &mut Packet, u64),
    wave: &mut Wave<'_>,
) {
    let grid = view.height_grid(placed);
    let doubt = doubt_of(Some(&grid.node(0)));
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize % LANES;
        lanes &= lanes - 1;
        let (origin, direction) = (of_lane(&local.origin, lane), of_lane(&local.direction, lane));
        let ray = Ray::new(origin.to_array(), direction.to_array(), range_of(packet, lane), doubt);
        let mut nearest = Nearest::none(&ray);
        nearest_in_tree(simd, &grid, &ray, only_front, wave.stack(), &mut nearest);
        offer(packet, lane, nearest.t * f64::from(ray.unit), placed.first_slot.wrapping_add(nearest.slot));
    }
}
