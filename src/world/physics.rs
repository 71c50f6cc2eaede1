//! Rigid-body dynamics of a world and its robots, by rapier.
//!
//! - A static model is a set of fixed shapes. In any other model, links that are connected by fixed joints are one body, as
//!   in Gazebo, and the other joints constrain or drive the bodies. The order of the bodies follows from the names of the
//!   links and not from the file, whose order therefore changes no bit.
//! - Links of one model do not collide with each other, which is SDF's default. If a link has `<self_collide>`, it collides
//!   with all others of its model except those to which a joint connects it.
//! - Surfaces bounce with the smaller of their two coefficients, above the smaller of their two thresholds, as in ODE.
//! - The coefficient of friction is the smaller one of the two surfaces, as in ODE. A surface without one has 1.
//! - The wheels of a base that drives are part of its body, and are only shown turning: see `robot::grip`.
//! - An actor moves as one piece along its script. It pushes other bodies, and none pushes it.
//! - Time is counted in whole nanoseconds, so it does not drift. Poses are known at all times between the last two steps.
//! - The same calls give the same bits, by rapier's `enhanced-determinism` on one thread.
//! - Everything is in double precision, so a body moves the same at UTM coordinates as at the origin.

mod contact;
mod convert;
mod friction;
mod history;
mod insert;
mod joint;
mod lump;
mod place;
mod query;
mod resist;
mod rest;
mod shape;
mod start;
mod touch;
mod wrench;

pub use joint::JointState;
pub(crate) use touch::{ShapeHandle, Touch};
pub use wrench::Wrench;

use crate::description::diagnostics::{Problem, Severity};
pub use crate::description::model::JointIndex;
use crate::description::model::{LinkIndex, Model, Trajectory, World};
use belvedere_sensors::Pose;
use contact::{Contacts, Owner};
use convert::{from_rapier, to_rapier};
use glam::DVec3;
use history::History;
use joint::{Motion, MovingJoint};
use rapier3d_f64::dynamics::{FrictionModel, RigidBodyHandle};
use rapier3d_f64::geometry::ColliderHandle;
use rapier3d_f64::pipeline::PhysicsWorld;
use rest::Rest;
use std::sync::Arc;
use wrench::Gauge;

/// Index of a model: those of the world file first, in its order, then the robots.
pub type ModelIndex = usize;

/// Farthest coordinate in m at which a command may place a model. All UTM coordinates and all points of the earth are
/// nearer. Numbers in double precision are 2 nm apart there.
pub const FARTHEST_M: f64 = 1e7;

/// Shortest physics step, in ns.
const MIN_STEP_NS: u64 = 1_000;
/// Longest physics step, in ns.
const MAX_STEP_NS: u64 = 100_000_000;
/// Number of substeps into which rapier divides a step. It reports the impulse of a motor in the last one only.
const SUBSTEPS: usize = 4;

/// The moving state of a world.
pub struct Physics {
    rapier: PhysicsWorld,
    /// Number of bodies that flew apart and were reported.
    frozen: usize,
    step_ns: u64,
    time_ns: u64,
    bodies: Vec<Body>,
    models: Vec<PlacedModel>,
    moving: Vec<MovingLink>,
    history: History,
    /// Indices of removed models.
    free: Vec<ModelIndex>,
    notes: Vec<Problem>,
}

/// A rigid body that can move.
struct Body {
    handle: RigidBodyHandle,
    follows: Follows,
    /// Its pose in its model while every joint is at zero.
    model_at_rest: Pose,
    /// Its pose in its model while every joint is at its initial position.
    model_at_start: Pose,
    /// Pose in the world after the last step but one.
    previous: Pose,
    /// Pose in the world after the last step.
    current: Pose,
    /// Decides whether it may sleep; `None` for a body that never sleeps.
    rest: Option<Rest>,
}

/// What determines the pose of a body.
enum Follows {
    /// Forces, contacts and joints determine it.
    Dynamics,
    /// It never moves. So do static links in a model whose other links move.
    Nothing,
    /// It is a wheel, and follows another body by a joint of this model. Its handle is that of the body that carries it.
    Carried(usize, ModelIndex, JointIndex),
    /// The script of an actor determines it, whatever is in its way.
    Path(Arc<Trajectory>),
}

/// A model that is to be added, with its pose and its treatment.
#[derive(Debug, Clone)]
pub struct Placement<'a> {
    /// The model.
    pub model: &'a Model,
    /// The pose of its frame.
    pub world_from_model: Pose,
    /// Joints of wheels that belong to the body that carries them. The base turns them, not physics.
    pub carried: Vec<JointIndex>,
    /// True if its bodies never sleep. A sleeping body would ignore the force that a base applies in each step.
    pub stays_awake: bool,
}

impl Body {
    fn is_carried(&self) -> bool {
        matches!(self.follows, Follows::Carried(..))
    }

    /// Whether it stays where it is put. The other bodies follow a carrier or a script.
    fn can_be_put(&self) -> bool {
        matches!(self.follows, Follows::Dynamics | Follows::Nothing)
    }
}

impl<'a> Placement<'a> {
    /// Places a model that no base drives.
    pub fn of_thing(model: &'a Model, world_from_model: Pose) -> Self {
        Self { model, world_from_model, carried: Vec::new(), stays_awake: false }
    }
}

/// The links and joints of a model; both are empty if it was removed.
#[derive(Default)]
struct PlacedModel {
    /// Pose of a model that never moves, and of the parts that never move of another one.
    world_from_model: Pose,
    links: Vec<PlacedLink>,
    /// The movable joints; `None` for one that does not move.
    joints: Vec<Option<MovingJoint>>,
    /// The gauges of its force-torque sensors, in their order; `None` for a joint that cannot be measured.
    gauges: Vec<Option<Gauge>>,
    /// Its bodies are `bodies[first_body..end_body]`.
    first_body: usize,
    end_body: usize,
    /// The body that the model's frame moves with; `None` if no part of the model moves.
    leading: Option<usize>,
}

/// A link with its pose in its body, or in the world if it has no body.
struct PlacedLink {
    body: Option<usize>,
    body_from_link: Pose,
    model_from_link: Pose,
    colliders: Vec<ColliderHandle>,
    /// The indices of the link's collisions that the colliders are, in the order of `colliders`.
    numbers: Vec<usize>,
    /// Poses of the colliders' shapes in the link, in the order of `colliders`.
    shapes: Vec<Pose>,
}

/// A link that can move, with its body and its pose in the body.
struct MovingLink {
    model: ModelIndex,
    link: LinkIndex,
    body: usize,
    body_from_link: Pose,
}

impl Physics {
    /// Builds the bodies of a world, each model at its own index. Time is 0.
    ///
    /// # Errors
    /// If the world's step is not a time from 1 µs to 0.1 s, or a pose or gravity is not finite.
    pub fn new(world: &World) -> Result<Self, Problem> {
        let models = world.models.iter().map(|model| Placement::of_thing(model, model.world_from_model));
        Self::with_models(world, models.map(Some))
    }

    /// Builds the bodies of these models instead of those of the world. `None` leaves an index empty.
    ///
    /// # Errors
    /// As [`Physics::new`].
    pub fn with_models<'a>(
        world: &World,
        models: impl Iterator<Item = Option<Placement<'a>>>,
    ) -> Result<Self, Problem> {
        let step_ns = (world.max_step_size_s * 1e9).round();
        if !(MIN_STEP_NS as f64..=MAX_STEP_NS as f64).contains(&step_ns) {
            return Err(Problem {
                severity: Severity::Error,
                source: world.source.clone(),
                what: format!("<max_step_size> is {} s", world.max_step_size_s),
                remedy: "write a step from 0.000001 s to 0.1 s; Gazebo's own is 0.001".into(),
            });
        }
        if !world.gravity.is_finite() {
            return Err(Problem {
                severity: Severity::Error,
                source: world.source.clone(),
                what: format!("<gravity> is {}", world.gravity),
                remedy: "write three finite numbers".into(),
            });
        }
        let step_ns = step_ns as u64;
        let mut rapier = PhysicsWorld { gravity: world.gravity, ..PhysicsWorld::default() };
        let parameters = &mut rapier.integration_parameters;
        parameters.dt = step_ns as f64 * 1e-9;
        parameters.num_solver_iterations = SUBSTEPS;
        parameters.friction_model = FrictionModel::Coulomb;
        // One pass per substep, rapier's default, lets a motor with a load off its axis run slow.
        parameters.num_internal_pgs_iterations = 4;
        // In long steps, stiff contacts make bodies hop.
        let stiffest_hz = contact::STIFFEST_HZ.min(0.25 * SUBSTEPS as f64 / parameters.dt);
        let softness = &mut parameters.contact_softness;
        softness.natural_frequency = softness.natural_frequency.max(stiffest_hz);
        let mut physics = Self {
            rapier,
            frozen: 0,
            step_ns,
            time_ns: 0,
            bodies: Vec::new(),
            models: Vec::new(),
            moving: Vec::new(),
            history: History::default(),
            free: Vec::new(),
            notes: Vec::new(),
        };
        for model in models {
            match model {
                Some(placement) => {
                    place::check_poses(placement.model, &placement.world_from_model)?;
                    physics.add(physics.models.len(), &placement);
                }
                None => physics.skip(),
            }
        }
        Ok(physics)
    }

    /// Returns the notes since the last call: about values that were chosen for the user, and about ignored input.
    pub fn take_notes(&mut self) -> Vec<Problem> {
        std::mem::take(&mut self.notes)
    }

    /// Returns the length of a step in ns.
    pub fn step_ns(&self) -> u64 {
        self.step_ns
    }

    /// Returns the length of a step in seconds.
    pub fn step_s(&self) -> f64 {
        self.step_ns as f64 * 1e-9
    }

    /// Returns the simulated time of the current poses, in ns.
    pub fn time_ns(&self) -> u64 {
        self.time_ns
    }

    /// Advances by one step.
    pub fn step(&mut self) {
        self.time_ns += self.step_ns;
        for body in &mut self.bodies {
            body.previous = body.current;
            if let Follows::Path(trajectory) = &body.follows
                && let Some(pose) = trajectory.pose_at(self.time_ns)
            {
                body.current = pose;
                self.rapier.bodies[body.handle].set_next_kinematic_position(to_rapier(&pose));
            }
        }
        self.lead_followers();
        self.begin_gauges();
        self.rapier.step_with_events(&Contacts, &());
        for body in &mut self.bodies {
            if let Follows::Dynamics = body.follows {
                let rigid = &self.rapier.bodies[body.handle];
                body.current = from_rapier(rigid.position());
                if let Some(rest) = &mut body.rest
                    && rest.notice(rigid, &body.current, self.time_ns)
                {
                    rest.tell(&mut self.rapier.bodies[body.handle]);
                }
            }
        }
        // It is reported again only when there are more.
        let frozen = self.rapier.quarantine().bodies().len();
        if frozen > self.frozen {
            tracing::warn!(
                "{frozen} bodies flew apart at {} ns and are frozen; check masses and joints",
                self.time_ns
            );
        }
        self.frozen = frozen;
        let step_s = self.step_s();
        for joint in self.models.iter_mut().flat_map(|model| model.joints.iter_mut().flatten()) {
            let world_from_body = joint.bodies.map(|body| self.bodies[body].current);
            let handles = joint.bodies.map(|body| self.bodies[body].handle);
            let rapier = &mut self.rapier;
            joint.update(world_from_body, handles, &rapier.bodies, &mut rapier.impulse_joints, step_s);
        }
        self.carry();
        self.end_gauges();
        self.history.add(self.time_ns, &self.bodies);
    }

    /// Keeps the poses of all bodies for this time, besides those of the last two steps. At first, and for 0, it keeps none.
    pub fn remember(&mut self, window_ns: u64) {
        self.history.keep(window_ns, self.time_ns, &self.bodies);
    }

    /// Moves the wheels with the bodies that carry them.
    fn carry(&mut self) {
        for index in 0..self.bodies.len() {
            if let Follows::Carried(carrier, model, joint) = self.bodies[index].follows
                && let Some(joint) = &self.models[model].joints[joint]
            {
                self.bodies[index].current = joint.carried(self.bodies[carrier].current);
            }
        }
    }

    /// Drives the joints that follow others. Their leaders do not feel it.
    fn lead_followers(&mut self) {
        /// Number of steps in which a follower corrects its error.
        const STEPS: f64 = 4.0;
        let time_s = STEPS * self.step_s();
        for model in &self.models {
            for joint in model.joints.iter().flatten() {
                let Some(mimic) = &joint.dynamics.mimic else { continue };
                let leader = model.joints[mimic.leader].as_ref().map(|leader| leader.current);
                let leader = leader.unwrap_or_default();
                joint.follow(&mut self.rapier.impulse_joints, mimic, leader, time_s);
            }
        }
    }

    /// Makes a joint's motor hold a velocity in rad/s or m/s from the next step on, with at most `max_effort` in
    /// N·m or N. Does nothing for a joint that does not move, or follows another.
    pub fn drive_joint(&mut self, model: ModelIndex, joint: JointIndex, velocity: f64, max_effort: f64) {
        if let Some(joint) = &self.models[model].joints[joint]
            && joint.dynamics.mimic.is_none()
        {
            joint.drive(&mut self.rapier.impulse_joints, velocity, max_effort);
        }
    }

    /// Turns a wheel that its body carries, at a rate in rad/s from the next step on, and stores the effort of
    /// its motor in N·m. Does nothing for any other joint.
    pub(crate) fn roll_joint(&mut self, model: ModelIndex, joint: JointIndex, rate: f64, effort: f64) {
        if let Some(MovingJoint { motion: motion @ Motion::Rolled { .. }, .. }) =
            &mut self.models[model].joints[joint]
        {
            *motion = Motion::Rolled { rate, effort };
        }
    }

    /// Applies a force in N at the centre of mass, and a torque in N·m, both in the world frame, to the body that a link
    /// belongs to, from the next step on. They replace earlier ones.
    ///
    /// rapier spreads forces over its substeps as it does gravity, so a force can hold a weight without a residue. An impulse
    /// before the step could not.
    pub(crate) fn push(&mut self, model: ModelIndex, link: LinkIndex, force: DVec3, torque: DVec3) {
        if let Some(body) = self.models[model].links[link].body {
            let rigid = &mut self.rapier.bodies[self.bodies[body].handle];
            rigid.reset_forces(true);
            rigid.reset_torques(true);
            rigid.add_force(force, true);
            rigid.add_torque(torque, true);
        }
    }

    /// Sets the coefficient of friction of all shapes of a link.
    pub fn set_link_friction(&mut self, model: ModelIndex, link: LinkIndex, friction: f64) {
        for handle in &self.models[model].links[link].colliders {
            if let Some(collider) = self.rapier.colliders.get_mut(*handle) {
                collider.set_friction(friction);
            }
        }
    }
}
