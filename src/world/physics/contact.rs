//! Decides which shapes touch each other, and which of those bounce.

use super::{ModelIndex, friction};
use crate::description::model::Contact;
use rapier3d_f64::dynamics::CoefficientCombineRule;
use rapier3d_f64::geometry::{
    Collider, ColliderBuilder, Group, InteractionGroups, InteractionTestMode, SolverFlags,
};
use rapier3d_f64::pipeline::{ActiveHooks, ContactModificationContext, PairFilterContext, PhysicsHooks};

/// Natural frequency of contacts of two bodies that move, in Hz. A body sinks in by its weight and all that rests on it, each
/// as g/(2πf)²: with rapier's own 30 Hz the uppermost of three boxes rests 2.5 mm too low, with 120 Hz 0.4 mm. Higher
/// frequencies push bodies out so fast that stacks shift when they land, all the more in long steps.
pub(super) const STIFFEST_HZ: f64 = 120.0;

/// The properties of a link that its colliders carry, packed into their user data.
#[derive(Debug, Clone, Copy)]
pub(super) struct Owner {
    pub(super) model: ModelIndex,
    /// True if its link collides with others of its model.
    pub(super) self_collide: bool,
    /// The lowest speed of an impact, in m/s, after which it bounces.
    pub(super) bounce_threshold_m_s: f64,
}

impl Owner {
    pub(super) fn into_data(self) -> u128 {
        u128::from(self.bounce_threshold_m_s.to_bits()) << 64
            | (self.model as u128) << 1
            | u128::from(self.self_collide)
    }

    pub(super) fn of(collider: &Collider) -> Self {
        let data = collider.user_data;
        Self {
            model: (data as u64 >> 1) as ModelIndex,
            self_collide: data & 1 == 1,
            bounce_threshold_m_s: f64::from_bits((data >> 64) as u64),
        }
    }
}

/// Applies the properties of a surface to a collider.
pub(super) fn with_surface(collider: ColliderBuilder, contact: &Contact) -> ColliderBuilder {
    let bits = Group::from_bits_retain(contact.collide_bitmask);
    let collider = collider
        .restitution(contact.restitution)
        .restitution_combine_rule(CoefficientCombineRule::Min)
        .collision_groups(InteractionGroups::new(bits, bits, InteractionTestMode::And));
    if contact.is_solid { collider } else { collider.solver_groups(InteractionGroups::none()) }
}

/// Returns the hooks that a collider needs. At least one of two touching colliders can move, so static ones need none.
pub(super) fn hooks(moves: bool) -> ActiveHooks {
    if moves {
        ActiveHooks::FILTER_CONTACT_PAIRS | ActiveHooks::MODIFY_SOLVER_CONTACTS
    } else {
        ActiveHooks::empty()
    }
}

/// Ignores contacts between links of the same model without `<self_collide>`, stops slow bodies from bouncing, and makes
/// friction act against the slip.
pub(super) struct Contacts;

impl PhysicsHooks for Contacts {
    fn filter_contact_pair(&self, context: &PairFilterContext) -> Option<SolverFlags> {
        let owner = |collider| context.colliders.get(collider).map(Owner::of);
        let touch = match (owner(context.collider1), owner(context.collider2)) {
            (Some(one), Some(other)) => one.model != other.model || one.self_collide || other.self_collide,
            _ => true,
        };
        touch.then_some(SolverFlags::COMPUTE_RIGID_IMPULSES)
    }

    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        let bodies = [context.rigid_body1, context.rigid_body2]
            .map(|body| body.and_then(|body| context.bodies.get(body)));
        let (colliders, pair) = (context.colliders, [context.collider1, context.collider2]);
        let Some(manifold) = context.rigid_mut() else { return };
        let normal = *manifold.normal;
        if *manifold.friction > 0.0 {
            friction::turn_against_slip(bodies, normal, manifold.solver_contacts);
        }
        if *manifold.restitution == 0.0 {
            return;
        }
        let [one, other] = pair.map(|collider| {
            colliders.get(collider).map_or(0.0, |collider| Owner::of(collider).bounce_threshold_m_s)
        });
        let threshold_m_s = one.min(other);
        let approach = manifold.solver_contacts.iter().map(|contact| {
            let speed = |side: usize, point| {
                bodies[side].map_or(0.0, |body| body.velocity_at_point(point).dot(normal))
            };
            speed(0, contact.anchor1) - speed(1, contact.anchor2)
        });
        if approach.fold(0.0, f64::max) < threshold_m_s {
            *manifold.restitution = 0.0;
        }
    }
}
