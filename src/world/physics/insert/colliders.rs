//! Adds the collision shapes of links as colliders of rapier.

use super::super::convert::to_rapier;
use super::super::{Follows, ModelIndex, Owner, Physics, PlacedLink, contact, shape};
use crate::description::diagnostics::{Problem, Severity};
use crate::description::model::{LinkIndex, Model};
use belvedere_sensors::Pose;
use rapier3d_f64::dynamics::CoefficientCombineRule;
use rapier3d_f64::geometry::ColliderBuilder;

/// Coefficient of friction of ODE and SDF for a surface that has none.
const DEFAULT_FRICTION: f64 = 1.0;

impl Physics {
    /// Returns the body that carries another one in the end, or that one itself if none carries it.
    fn outermost_carrier(&self, mut body: usize) -> usize {
        while let Follows::Carried(carrier, ..) = self.bodies[body].follows {
            body = carrier;
        }
        body
    }

    /// Adds the shapes of a link.
    pub(super) fn add_colliders(
        &mut self,
        model: &Model,
        index: ModelIndex,
        link: LinkIndex,
        placed: &mut PlacedLink,
    ) {
        for (number, collision) in model.links[link].collisions.iter().enumerate() {
            let moves =
                placed.body.is_some_and(|body| !matches!(self.bodies[body].follows, Follows::Nothing));
            let (shape, collision_from_shape) = match shape::shape(&collision.geometry, moves) {
                Ok(shape) => shape,
                Err(why) => {
                    self.notes.push(Problem {
                        severity: Severity::Warning,
                        source: collision.source.clone(),
                        what: format!(
                            "the collision '{}' of link '{}' touches nothing: {why}",
                            collision.name, model.links[link].name
                        ),
                        remedy: "correct its <geometry>".into(),
                    });
                    continue;
                }
            };
            // A wheel's shapes are fixed to the body that carries it.
            let rapier_from_body = placed.body.map_or(Pose::IDENTITY, |body| {
                let at_rest = self.bodies[body].model_at_rest;
                match self.bodies[body].follows {
                    Follows::Carried(..) => {
                        self.bodies[self.outermost_carrier(body)].model_at_rest.inverse() * at_rest
                    }
                    _ => Pose::IDENTITY,
                }
            });
            let link_from_shape = collision.link_from_collision * collision_from_shape;
            let pose = rapier_from_body * placed.body_from_link * link_from_shape;
            if let Some(rest) = placed.body.and_then(|body| self.bodies[body].rest.as_mut()) {
                let radius = shape.compute_local_bounding_sphere().radius();
                rest.reach(pose.translation().length() + radius);
            }
            let owner = Owner {
                model: index,
                self_collide: model.links[link].self_collide,
                bounce_threshold_m_s: collision.contact.bounce_threshold_m_s,
            };
            let collider = ColliderBuilder::new(shape)
                .position(to_rapier(&pose))
                // Mass and inertia come from <inertial> alone.
                .density(0.0)
                .friction(collision.friction.unwrap_or(DEFAULT_FRICTION))
                .friction_combine_rule(CoefficientCombineRule::Min)
                .user_data(owner.into_data())
                .active_hooks(contact::hooks(placed.body.is_some()));
            let collider = contact::with_surface(collider, &collision.contact);
            let parent = placed.body.map(|body| self.bodies[body].handle);
            placed.colliders.push(self.rapier.insert_collider(collider, parent));
            placed.numbers.push(number);
            placed.shapes.push(link_from_shape);
        }
    }
}
