//! Moves, resets, adds and removes models while the world runs.

use super::convert::{from_rapier, to_rapier};
use super::joint::Motion;
use super::{FARTHEST_M, Follows, ModelIndex, Physics, PlacedModel, Placement};
use crate::description::diagnostics::{Problem, Severity};
use crate::description::model::Model;
use belvedere_sensors::Pose;
use glam::DVec3;

impl Physics {
    /// Returns the pose of a model's frame at a time between the last two steps.
    pub fn world_from_model_at(&self, model: ModelIndex, stamp_ns: u64) -> Pose {
        self.models[model].leading.map_or(self.models[model].world_from_model, |body| {
            self.body_at(body, stamp_ns) * self.bodies[body].model_at_start.inverse()
        })
    }

    /// Returns the current pose of a model's frame, which moves with the root of its tree of links.
    pub fn world_from_model(&self, model: ModelIndex) -> Pose {
        self.world_from_model_at(model, self.time_ns)
    }

    /// Returns the velocity of a model's origin in m/s and its angular velocity in rad/s, both in the world frame.
    pub fn model_velocity(&self, model: ModelIndex) -> (DVec3, DVec3) {
        let Some(body) = self.models[model].leading else { return (DVec3::ZERO, DVec3::ZERO) };
        let origin = self.world_from_model(model).translation();
        let rigid = &self.rapier.bodies[self.bodies[body].handle];
        (rigid.velocity_at_point(origin), rigid.angvel())
    }

    /// Moves a model with its current joint positions, so that its frame is at `world_from_model`, and sets the velocity of
    /// its origin in m/s and its angular velocity in rad/s, both in the world frame. Static parts are moved, too, but get no
    /// velocity. The wheels of a Kobuki do not turn, so its odometry does not change.
    pub fn move_model(&mut self, model: ModelIndex, world_from_model: &Pose, linear: DVec3, angular: DVec3) {
        let moved_from_world = *world_from_model * self.world_from_model(model).inverse();
        for index in self.models[model].first_body..self.models[model].end_body {
            if self.bodies[index].can_be_put() {
                let pose = moved_from_world * self.bodies[index].current;
                self.set_body(index, &pose, world_from_model.translation(), linear, angular);
            }
        }
        self.settle(model, world_from_model);
    }

    /// Returns true if a model follows a script, so that it cannot be moved.
    pub fn follows_script(&self, model: ModelIndex) -> bool {
        self.models[model].leading.is_some_and(|body| matches!(self.bodies[body].follows, Follows::Path(_)))
    }

    /// Places a model as it was at the start: at rest, with its joints at their initial positions. The wheels of a Kobuki keep
    /// the turns that its encoders have counted.
    pub fn place_model(&mut self, model: ModelIndex, world_from_model: &Pose) {
        let placed = &mut self.models[model];
        for joint in placed.joints.iter_mut().flatten() {
            if matches!(joint.motion, Motion::Forces(_)) {
                joint.begin(&mut self.rapier.impulse_joints);
            }
        }
        for index in self.models[model].first_body..self.models[model].end_body {
            if self.bodies[index].can_be_put() {
                let pose = *world_from_model * self.bodies[index].model_at_start;
                self.set_body(index, &pose, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
            }
        }
        self.settle(model, world_from_model);
    }

    /// Sets the pose of a body, and the velocity that it has in a rigid motion about `origin`.
    fn set_body(&mut self, index: usize, pose: &Pose, origin: DVec3, linear: DVec3, angular: DVec3) {
        let body = &mut self.bodies[index];
        let rigid = &mut self.rapier.bodies[body.handle];
        let centre = pose.transform_point(rigid.mass_properties().local_mprops.local_com);
        rigid.set_position(to_rapier(pose), true);
        rigid.set_linvel(linear + angular.cross(centre - origin), true);
        rigid.set_angvel(angular, true);
        rigid.reset_forces(true);
        rigid.reset_torques(true);
        body.current = from_rapier(rigid.position());
    }

    /// Moves the static parts, and makes the new pose the model's previous pose as well.
    fn settle(&mut self, model: ModelIndex, world_from_model: &Pose) {
        self.carry();
        let placed = &mut self.models[model];
        for body in &mut self.bodies[placed.first_body..placed.end_body] {
            body.previous = body.current;
        }
        placed.world_from_model = *world_from_model;
        for link in placed.links.iter_mut().filter(|link| link.body.is_none()) {
            link.body_from_link = *world_from_model * link.model_from_link;
            for (handle, link_from_shape) in link.colliders.iter().zip(&link.shapes) {
                if let Some(collider) = self.rapier.colliders.get_mut(*handle) {
                    collider.set_position(to_rapier(&(link.body_from_link * *link_from_shape)));
                }
            }
        }
        self.history.add(self.time_ns, &self.bodies);
        // Bodies that rested on it or against it may have to move now.
        self.rapier.wake_up_all(true);
    }

    /// Adds a model to the running world, with its frame at `world_from_model`. Values that were chosen for the user are
    /// reported by [`Physics::take_notes`].
    ///
    /// # Errors
    /// If a pose is not finite.
    pub fn insert_model(&mut self, placement: &Placement<'_>) -> Result<ModelIndex, Problem> {
        check_poses(placement.model, &placement.world_from_model)?;
        let index = self.free.pop().unwrap_or(self.models.len());
        self.add(index, placement);
        self.rapier.wake_up_all(true);
        Ok(index)
    }

    /// Removes a model from the running world. The next model that is added gets its index; those of the others do not
    /// change.
    pub fn remove_model(&mut self, model: ModelIndex) {
        self.free.push(model);
        let removed = std::mem::take(&mut self.models[model]);
        for link in removed.links.iter().filter(|link| link.body.is_none()) {
            for collider in &link.colliders {
                self.rapier.remove_collider(*collider);
            }
        }
        let (first, end) = (removed.first_body, removed.end_body);
        for body in self.bodies.drain(first..end).filter(|body| !body.is_carried()) {
            self.rapier.remove_body_with_colliders(body.handle, true);
        }
        self.history.remove(first..end);
        self.moving.retain(|link| link.model != model);
        // Bodies behind it have moved up.
        let count = end - first;
        let up = |body: &mut usize| {
            if *body >= end {
                *body -= count;
            }
        };
        for body in &mut self.bodies {
            if let Follows::Carried(carrier, ..) = &mut body.follows {
                up(carrier);
            }
        }
        self.moving.iter_mut().for_each(|link| up(&mut link.body));
        for placed in &mut self.models {
            up(&mut placed.first_body);
            up(&mut placed.end_body);
            placed.leading.iter_mut().for_each(up);
            placed.links.iter_mut().filter_map(|link| link.body.as_mut()).for_each(up);
            placed.joints.iter_mut().flatten().flat_map(|joint| &mut joint.bodies).for_each(up);
        }
        self.rapier.wake_up_all(true);
    }

    /// Leaves an index empty, as [`Physics::remove_model`] does.
    pub(super) fn skip(&mut self) {
        self.free.push(self.models.len());
        self.models.push(PlacedModel::default());
    }
}

/// Returns a warning about a model that is so far away that the steps of its coordinates show.
pub(super) fn too_far(model: &Model, world_from_model: &Pose) -> Option<Problem> {
    let at = world_from_model.translation();
    (at.abs().max_element() > FARTHEST_M).then(|| Problem {
        severity: Severity::Warning,
        source: model.source.clone(),
        what: format!(
            "model '{}' is at {} {} {}, where bodies may move in visible steps",
            model.name, at.x, at.y, at.z
        ),
        remedy: format!("write coordinates of at most {FARTHEST_M:e} m, and move the world's origin nearer"),
    })
}

/// Refuses a model with a pose that is not finite.
pub(super) fn check_poses(model: &Model, world_from_model: &Pose) -> Result<(), Problem> {
    if world_from_model.is_finite() && model.links.iter().all(|link| link.model_from_link.is_finite()) {
        return Ok(());
    }
    Err(Problem {
        severity: Severity::Error,
        source: model.source.clone(),
        what: format!("the pose of model '{}' or of one of its links is not finite", model.name),
        remedy: "write finite numbers".into(),
    })
}
