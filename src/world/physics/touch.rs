//! Queries about touch and nearness: where a link touches, what is near a model, and what a ray meets.

use super::convert::{from_rapier, to_rapier};
use super::{ModelIndex, Owner, Physics};
use crate::description::model::LinkIndex;
use glam::DVec3;
use rapier3d_f64::geometry::{Ball, Collider, Ray, Shape as RapierShape};
use rapier3d_f64::math::Pose as RapierPose;
use rapier3d_f64::parry::bounding_volume::BoundingVolume as _;
use rapier3d_f64::parry::query::contact;
use rapier3d_f64::pipeline::QueryFilter;

/// A point where a link touches something, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Touch {
    /// The point on the link.
    pub(crate) point: DVec3,
    /// Direction out of the link into what it touches.
    pub(crate) outward: DVec3,
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

    /// Returns the points where a link touched other models in the last step: all that are less than `gap_m` apart.
    pub(crate) fn touches(
        &self,
        model: ModelIndex,
        link: LinkIndex,
        gap_m: f64,
    ) -> impl Iterator<Item = Touch> + '_ {
        let colliders = self.models[model].links[link].colliders.iter().copied();
        colliders.flat_map(move |own| {
            let world_from_own =
                self.rapier.colliders.get(own).map(|collider| from_rapier(collider.position()));
            let is_other = move |collider| {
                self.rapier.colliders.get(collider).is_some_and(|collider| Owner::of(collider).model != model)
            };
            let pairs = self.rapier.narrow_phase.contact_pairs_with(own);
            let pairs = pairs.filter(move |pair| {
                is_other(if pair.collider1 == own { pair.collider2 } else { pair.collider1 })
            });
            pairs.filter_map(move |pair| Some((pair, pair.rigid()?, world_from_own?))).flat_map(
                move |(pair, contacts, world_from_own)| {
                    let is_first = pair.collider1 == own;
                    contacts.manifolds.iter().flat_map(move |manifold| {
                        let normal = manifold.data.normal;
                        let near = manifold.points.iter().filter(move |point| point.dist < gap_m);
                        near.map(move |point| {
                            let local = if is_first { point.local_p1 } else { point.local_p2 };
                            Touch {
                                point: world_from_own.transform_point(local),
                                outward: if is_first { normal } else { -normal },
                            }
                        })
                    })
                },
            )
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
