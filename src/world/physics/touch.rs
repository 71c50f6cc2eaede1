//! Queries about touch and nearness: where a shape touches, what is near a model, and what a ray meets.

use super::convert::to_rapier;
use super::wrench::impulse;
use super::{ModelIndex, Owner, Physics};
use crate::description::model::LinkIndex;
use glam::DVec3;
use rapier3d_f64::dynamics::RigidBody;
use rapier3d_f64::geometry::{
    Ball, Collider, ColliderHandle, ContactManifold, ContactPair, Ray, Shape as RapierShape, SolverContact,
};
use rapier3d_f64::math::Pose as RapierPose;
use rapier3d_f64::parry::bounding_volume::BoundingVolume as _;
use rapier3d_f64::parry::query::contact;
use rapier3d_f64::pipeline::QueryFilter;

/// A collision shape in the world. A handle is never used again after its shape was removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct ShapeHandle(ColliderHandle);

/// A point where a shape touches, or nearly touches, another one, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Touch {
    /// The other shape.
    pub(crate) other: ShapeHandle,
    /// The point on the shape.
    pub(crate) point: DVec3,
    /// Direction out of the shape into the other one.
    pub(crate) outward: DVec3,
    /// Distance of the two shapes in m; negative if they overlap.
    pub(crate) gap_m: f64,
    /// The impulse on the shape in the last step, in N·s.
    pub(crate) impulse: DVec3,
}

impl Physics {
    /// Returns a link of this model and another model if the middle of the largest shape of the link is inside that other
    /// model. Only the middle counts, because physics pushes out a model that is slightly inside the floor.
    pub(crate) fn inside(&self, model: ModelIndex) -> Option<(LinkIndex, ModelIndex)> {
        let colliders = &self.rapier.colliders;
        let world_from = |collider: &Collider| self.world_from_collider(collider);
        let own = self.models[model].links.iter().enumerate().flat_map(|(link, placed)| {
            let shapes = placed.colliders.iter().filter_map(|handle| colliders.get(*handle));
            shapes.map(move |shape| (link, shape.shape().compute_aabb(&world_from(shape))))
        });
        let (link, largest) = own.max_by(|(_, one), (_, other)| one.volume().total_cmp(&other.volume()))?;
        let mut others = colliders.iter().filter(|(_, other)| Owner::of(other).model != model);
        let (_, other) =
            others.find(|(_, other)| other.shape().contains_point(&world_from(other), largest.center()))?;
        Some((link, Owner::of(other).model))
    }

    /// Returns true if no shape of another model is nearer than `clearance_m` to those of this one, or to its origin if it has
    /// none. The floor below it may be nearer.
    pub(crate) fn is_clear(&self, model: ModelIndex, clearance_m: f64) -> bool {
        /// The least z of a floor's normal: a floor is inclined by at most 45°.
        const FLOOR: f64 = 0.707;
        /// Depth in m to which a model may be inside a floor.
        const SUNK_M: f64 = 0.02;
        let colliders = &self.rapier.colliders;
        let origin = Ball::new(1e-3);
        let links = self.models[model].links.iter();
        let own = links.flat_map(|link| &link.colliders).filter_map(|handle| colliders.get(*handle));
        let mut own: Vec<(RapierPose, &dyn RapierShape)> =
            own.map(|collider| (self.world_from_collider(collider), collider.shape())).collect();
        if own.is_empty() {
            own.push((to_rapier(&self.world_from_model(model)), &origin));
        }
        let others = colliders.iter().map(|(_, other)| other).filter(|other| Owner::of(other).model != model);
        others.map(|other| (self.world_from_collider(other), other.shape())).all(
            |(world_from_other, other)| {
                let around = other.compute_aabb(&world_from_other).loosened(clearance_m.max(0.0));
                own.iter().all(|(world_from_own, shape)| {
                    if !around.intersects(&shape.compute_aabb(world_from_own)) {
                        return true;
                    }
                    if let Some(plane) = other.as_halfspace() {
                        let up = world_from_other.rotation * plane.normal;
                        let height =
                            lowest(*shape, world_from_own, up) - world_from_other.translation.dot(up);
                        return height >= clearance_m || up.z > FLOOR && height > -SUNK_M;
                    }
                    // parry cannot compare some pairs of shapes. They touch if one contains the middle of the other.
                    match contact(world_from_own, *shape, &world_from_other, other, clearance_m) {
                        Ok(None) => true,
                        Ok(Some(near)) => near.normal1.z < -FLOOR && near.dist > -SUNK_M,
                        Err(_) => !other.contains_point(&world_from_other, world_from_own.translation),
                    }
                })
            },
        )
    }

    /// Returns the pose of a collider. rapier updates it only in the next step after its body was added or moved.
    fn world_from_collider(&self, collider: &Collider) -> RapierPose {
        let body = collider.parent().and_then(|body| self.rapier.bodies.get(body));
        match (body, collider.position_wrt_parent()) {
            (Some(body), Some(shape)) => *body.position() * *shape,
            _ => *collider.position(),
        }
    }

    /// Returns the least and the greatest corner of the box around all shapes of a model in the world, without infinite
    /// planes; `None` if it has no other shape.
    pub(crate) fn bounds(&self, model: ModelIndex) -> Option<[DVec3; 2]> {
        let links = self.models[model].links.iter();
        let colliders = links.flat_map(|link| &link.colliders);
        let colliders = colliders.filter_map(|handle| self.rapier.colliders.get(*handle));
        let finite = colliders.filter(|collider| collider.shape().as_halfspace().is_none());
        let boxes = finite.map(|collider| collider.shape().compute_aabb(&self.world_from_collider(collider)));
        boxes
            .map(|aabb| [aabb.mins, aabb.maxs])
            .reduce(|[least, greatest], [mins, maxs]| [least.min(mins), greatest.max(maxs)])
    }

    /// Returns the shape of a link's collision; `None` if the collision has no shape that can touch anything.
    pub(crate) fn shape_of(
        &self,
        model: ModelIndex,
        link: LinkIndex,
        collision: usize,
    ) -> Option<ShapeHandle> {
        let placed = &self.models[model].links[link];
        let number = placed.numbers.iter().position(|number| *number == collision)?;
        Some(ShapeHandle(placed.colliders[number]))
    }

    /// Returns the model, the link and the collision to which a shape belongs; `None` if it was removed.
    pub(crate) fn collision_of(&self, shape: ShapeHandle) -> Option<(ModelIndex, LinkIndex, usize)> {
        let model = Owner::of(self.rapier.colliders.get(shape.0)?).model;
        self.models[model].links.iter().enumerate().find_map(|(link, placed)| {
            let number = placed.colliders.iter().position(|collider| *collider == shape.0)?;
            Some((model, link, placed.numbers[number]))
        })
    }

    /// Returns true unless the shape was removed.
    pub(crate) fn has_shape(&self, shape: ShapeHandle) -> bool {
        self.rapier.colliders.get(shape.0).is_some()
    }

    /// Returns the centre of mass of the body that a link belongs to, or the origin of a link that no force moves.
    pub(crate) fn balance_point(&self, model: ModelIndex, link: LinkIndex) -> DVec3 {
        let body = self.models[model].links[link].body;
        let rigid = body.and_then(|body| self.rapier.bodies.get(self.bodies[body].handle));
        match rigid.filter(|rigid| rigid.is_dynamic()) {
            Some(rigid) => RigidBody::center_of_mass(rigid),
            None => self.world_from_link(model, link).translation(),
        }
    }

    /// Returns the points where a link touched other models in the last step: all that are less than `gap_m` apart.
    pub(crate) fn touches(
        &self,
        model: ModelIndex,
        link: LinkIndex,
        gap_m: f64,
    ) -> impl Iterator<Item = Touch> + '_ {
        let is_other = move |touch: &Touch| {
            let other = self.rapier.colliders.get(touch.other.0);
            other.is_some_and(|collider| Owner::of(collider).model != model)
        };
        let colliders = self.models[model].links[link].colliders.iter();
        colliders
            .flat_map(|own| self.touches_of(ShapeHandle(*own)))
            .filter(move |touch| touch.gap_m < gap_m)
            .filter(is_other)
    }

    /// Returns the points where a shape touched others in the last step, and those where it was near them.
    pub(crate) fn touches_of(&self, shape: ShapeHandle) -> impl Iterator<Item = Touch> + '_ {
        let pairs = self.rapier.narrow_phase.contact_pairs_with(shape.0);
        pairs
            .flat_map(|pair| pair.solver_manifolds().iter().map(move |manifold| (pair, manifold)))
            .flat_map(move |(pair, manifold)| self.points(pair, manifold, pair.collider1 == shape.0))
    }

    /// Returns the points of a manifold as seen by one of its two shapes.
    fn points<'p>(
        &'p self,
        pair: &'p ContactPair,
        manifold: &'p ContactManifold,
        is_first: bool,
    ) -> impl Iterator<Item = Touch> + 'p {
        let colliders = [pair.collider1, pair.collider2].map(|handle| self.rapier.colliders.get(handle));
        let subshapes = [manifold.subshape_pos1(), manifold.subshape_pos2()];
        let normal = manifold.data.normal;
        manifold.points.iter().enumerate().filter_map(move |(number, point)| {
            let mut ends = [point.local_p1, point.local_p2];
            for (end, (subshape, collider)) in ends.iter_mut().zip(subshapes.iter().zip(colliders)) {
                let in_collider = subshape.map_or(*end, |subshape| *subshape * *end);
                *end = *collider?.position() * in_collider;
            }
            let solved = manifold.data.solver_contacts.iter().flat_map(SolverContact::contact_indices);
            let on_first = if solved.into_iter().any(|index| index as usize == number) {
                impulse(manifold, &point.data)
            } else {
                DVec3::ZERO
            };
            let sign = if is_first { 1.0 } else { -1.0 };
            Some(Touch {
                other: ShapeHandle(if is_first { pair.collider2 } else { pair.collider1 }),
                point: ends[usize::from(!is_first)],
                outward: normal * sign,
                gap_m: (ends[1] - ends[0]).dot(normal),
                impulse: on_first * sign,
            })
        })
    }

    /// Returns the distance in m along a ray to the first shape within `max_m` that does not belong to `ignored`. The ray is
    /// in the world, and its direction has unit length. If it begins inside a shape, the distance is 0.
    pub(crate) fn cast_ray(
        &self,
        origin: DVec3,
        direction: DVec3,
        max_m: f64,
        ignored: ModelIndex,
    ) -> Option<f64> {
        let is_other = |_, collider: &Collider| Owner::of(collider).model != ignored;
        let filter = QueryFilter { predicate: Some(&is_other), ..QueryFilter::default() };
        let ray = Ray::new(origin, direction);
        self.rapier.cast_ray(&ray, max_m, true, filter).map(|(_, way)| way)
    }
}

/// Returns the height of the lowest point of a shape.
fn lowest(shape: &dyn RapierShape, world_from_shape: &RapierPose, up: DVec3) -> f64 {
    if let Some(shape) = shape.as_support_map() {
        return shape.support_point(world_from_shape, -up).dot(up);
    }
    let around = shape.compute_aabb(world_from_shape);
    around.center().dot(up) - around.half_extents().dot(up.abs())
}
