//! Joints: how they move, and which forces act in them.

use super::{JointIndex, LinkIndex};
use crate::diagnostics::Source;
use belvedere_sensors::Pose;
use glam::DVec3;

/// A connection of two links.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Unique in its model.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// The link that it is attached to.
    pub parent: LinkIndex,
    /// The link that moves.
    pub child: LinkIndex,
    /// Pose of the child at joint position zero.
    pub parent_from_child: Pose,
    /// Unit axis in the child's frame.
    pub axis: DVec3,
    /// A point of the child that the axis goes through, in the child's frame: 0 in URDF, the joint's `<pose>` in SDF.
    pub pivot: DVec3,
    /// Resistance, limits and mimic.
    pub dynamics: JointDynamics,
    /// File and line that define it.
    pub source: Source,
}

/// Resistance, motor limits and mimic of a joint that turns or slides. Units are rad and N·m, or m and N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointDynamics {
    /// Damping force per unit of speed.
    pub damping: f64,
    /// Force of dry friction.
    pub friction: f64,
    /// Spring force per unit of distance from [`JointDynamics::spring_reference`].
    pub spring_stiffness: f64,
    /// Position at which the spring exerts no force.
    pub spring_reference: f64,
    /// Initial position of the joint.
    pub initial_position: f64,
    /// Greatest force or torque of its motor; infinite for no limit.
    pub max_effort: f64,
    /// Greatest speed of its motor; infinite for no limit.
    pub max_velocity: f64,
    /// The joint that it follows.
    pub mimic: Option<Mimic>,
}

impl Default for JointDynamics {
    fn default() -> Self {
        Self {
            damping: 0.0,
            friction: 0.0,
            spring_stiffness: 0.0,
            spring_reference: 0.0,
            initial_position: 0.0,
            max_effort: f64::INFINITY,
            max_velocity: f64::INFINITY,
            mimic: None,
        }
    }
}

/// A joint that follows another: its position is `multiplier` × the leader's + `offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mimic {
    /// The joint that it follows.
    pub leader: JointIndex,
    /// Its motion per unit of the leader's.
    pub multiplier: f64,
    /// Its position while the leader is at 0.
    pub offset: f64,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointKind {
    /// Does not move.
    Fixed,
    /// Turns without limits.
    Continuous,
    /// Turns between two angles in radians; an infinite one is no limit.
    Revolute {
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
    },
    /// Slides between two lengths in metres; an infinite one is no limit.
    Prismatic {
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
    },
    /// Turns about all axes through its pivot.
    Ball,
    /// Moves in all six degrees of freedom.
    Floating,
}

impl JointKind {
    /// Returns the lower and the upper limit of its position, if it has limits.
    pub fn limits(self) -> Option<[f64; 2]> {
        match self {
            Self::Revolute { lower, upper } | Self::Prismatic { lower, upper } => Some([lower, upper]),
            _ => None,
        }
    }
}
