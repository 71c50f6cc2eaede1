//! Queries about the state of physics: poses, velocities, masses, and the ground on which links stand.

use super::convert::from_rapier;
use super::{JointIndex, JointState, ModelIndex, Physics};
use crate::description::model::LinkIndex;
use belvedere_sensors::Pose;
use glam::DVec3;

impl Physics {
    /// Returns the current pose of a link.
    ///
    /// # Panics
    /// If there is no such model or link; so do the other methods that take an index.
    pub fn world_from_link(&self, model: ModelIndex, link: LinkIndex) -> Pose {
        let placed = &self.models[model].links[link];
        placed.body.map_or(placed.body_from_link, |body| self.bodies[body].current * placed.body_from_link)
    }

    /// Returns the pose of a link at a time between the last two steps, or at the nearer of the two. Earlier poses are
    /// those that [`Physics::remember`] keeps.
    pub fn world_from_link_at(&self, model: ModelIndex, link: LinkIndex, stamp_ns: u64) -> Pose {
        let placed = &self.models[model].links[link];
        placed.body.map_or(placed.body_from_link, |body| self.body_at(body, stamp_ns) * placed.body_from_link)
    }

    /// Returns every link that can move, with its current pose.
    pub fn moving_links(&self) -> impl Iterator<Item = (ModelIndex, LinkIndex, Pose)> + '_ {
        self.moving_links_at(self.time_ns)
    }

    /// Returns every link that can move, with its pose at a time between the last two steps.
    pub fn moving_links_at(&self, stamp_ns: u64) -> impl Iterator<Item = (ModelIndex, LinkIndex, Pose)> + '_ {
        self.moving.iter().map(move |moving| {
            (moving.model, moving.link, self.body_at(moving.body, stamp_ns) * moving.body_from_link)
        })
    }

    /// Returns the velocity of a link's origin in m/s and its angular velocity in rad/s, both in the world frame; zero for a
    /// link that never moves.
    pub fn link_velocity(&self, model: ModelIndex, link: LinkIndex) -> (DVec3, DVec3) {
        let placed = &self.models[model].links[link];
        let Some(body) = placed.body else { return (DVec3::ZERO, DVec3::ZERO) };
        let body = &self.bodies[body];
        let origin = body.current.transform_point(placed.body_from_link.translation());
        let body = &self.rapier.bodies[body.handle];
        (body.velocity_at_point(origin), body.angvel())
    }

    /// Returns the current state of a joint; `None` for a joint that does not move.
    pub fn joint_state(&self, model: ModelIndex, joint: JointIndex) -> Option<JointState> {
        self.models[model].joints[joint].as_ref().map(|joint| joint.current)
    }

    /// Returns the state of a joint at a time between the last two steps; `None` for a joint that does not move.
    pub fn joint_state_at(&self, model: ModelIndex, joint: JointIndex, stamp_ns: u64) -> Option<JointState> {
        let (joint, fraction) = (self.models[model].joints[joint].as_ref()?, self.fraction(stamp_ns));
        let between = |from: f64, to: f64| from + (to - from) * fraction;
        let (from, to) = (&joint.previous, &joint.current);
        Some(JointState {
            position: between(from.position, to.position),
            velocity: between(from.velocity, to.velocity),
            effort: between(from.effort, to.effort),
        })
    }

    /// Returns true if all bodies of a model that could move sleep.
    pub fn sleeps(&self, model: ModelIndex) -> bool {
        let placed = &self.models[model];
        let bodies = &self.bodies[placed.first_body..placed.end_body];
        bodies.iter().all(|body| {
            !self.rapier.bodies[body.handle].is_dynamic() || self.rapier.bodies[body.handle].is_sleeping()
        })
    }

    /// Returns the mass in kg, the centre of mass in the world, and the moment of inertia in kg·m² about an axis through it,
    /// of the body that a link belongs to; `None` for a link that never moves.
    pub(crate) fn body_mass(
        &self,
        model: ModelIndex,
        link: LinkIndex,
        axis_in_world: DVec3,
    ) -> Option<(f64, DVec3, f64)> {
        let body = &self.bodies[self.models[model].links[link].body?];
        let rigid = &self.rapier.bodies[body.handle];
        let inertia = rigid.mass_properties().local_mprops.reconstruct_inertia_matrix();
        let axis = from_rapier(rigid.position()).inverse().transform_vector(axis_in_world);
        Some((rigid.mass(), rigid.center_of_mass(), axis.dot(inertia * axis)))
    }

    /// Returns the mass in kg of all parts of a model that can move.
    pub(crate) fn model_mass(&self, model: ModelIndex) -> f64 {
        let placed = &self.models[model];
        let own = self.bodies[placed.first_body..placed.end_body].iter().filter(|body| !body.is_carried());
        own.map(|body| self.rapier.bodies[body.handle].mass()).sum()
    }

    /// Returns the normal of the ground that a link stood on in the last step: the mean of its contacts whose normals are
    /// within 60° of `up_in_world`. Returns `None` if it stood on nothing.
    pub(crate) fn ground_normal(
        &self,
        model: ModelIndex,
        link: LinkIndex,
        up_in_world: DVec3,
    ) -> Option<DVec3> {
        let mut sum = DVec3::ZERO;
        for collider in &self.models[model].links[link].colliders {
            for pair in self.rapier.narrow_phase.contact_pairs_with(*collider) {
                let Some(contacts) = pair.rigid().filter(|_| pair.has_any_active_contact()) else { continue };
                // A manifold's normal points from the first collider to the second.
                let sign = if pair.collider1 == *collider { -1.0 } else { 1.0 };
                let normals = contacts.manifolds.iter().map(|manifold| manifold.data.normal * sign);
                sum += normals.filter(|normal| normal.dot(up_in_world) > 0.5).sum::<DVec3>();
            }
        }
        sum.try_normalize()
    }

    /// Returns gravity in m/s², in the world frame.
    pub fn gravity(&self) -> DVec3 {
        self.rapier.gravity
    }

    /// Returns the position of `stamp_ns` between the last two steps, in [0, 1].
    pub(super) fn fraction(&self, stamp_ns: u64) -> f64 {
        let before_ns = self.time_ns.saturating_sub(stamp_ns).min(self.step_ns);
        1.0 - before_ns as f64 / self.step_ns as f64
    }

    pub(super) fn body_at(&self, index: usize, stamp_ns: u64) -> Pose {
        let body = &self.bodies[index];
        if stamp_ns >= self.time_ns {
            return body.current;
        }
        if self.time_ns - stamp_ns > self.step_ns
            && let Some(pose) = self.history.pose(index, stamp_ns)
        {
            return pose;
        }
        body.previous.interpolate(&body.current, self.fraction(stamp_ns))
    }
}
