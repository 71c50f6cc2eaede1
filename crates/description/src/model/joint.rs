//! Joints: how they move, and what resists them.

use super::{JointIndex, LinkIndex};
use crate::diagnostics::Source;
use belvedere_sensors::Pose;
use glam::DVec3;

/// What holds two links together.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Unique in its model.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// The link it hangs on.
    pub parent: LinkIndex,
    /// The link that moves.
    pub child: LinkIndex,
    /// Pose of the child at joint position zero.
    pub parent_from_child: Pose,
    /// Unit axis in the child's frame.
    pub axis: DVec3,
    /// A point of the child that the axis goes through, in the child's frame: 0 in URDF, an SDF joint's `<pose>`.
    pub pivot: DVec3,
    /// What resists it, and what it follows.
    pub dynamics: JointDynamics,
    /// Where it stands.
    pub source: Source,
}

/// What resists a joint that turns or slides, and what it follows. Units are rad and N·m, or m and N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointDynamics {
    /// Force for each unit of speed, against it.
    pub damping: f64,
    /// Force of dry friction, against any motion.
    pub friction: f64,
    /// Force for each unit of distance from [`JointDynamics::spring_reference`].
    pub spring_stiffness: f64,
    /// Where the spring is at ease.
    pub spring_reference: f64,
    /// Where the joint begins.
    pub initial_position: f64,
    /// The most that a motor can give; infinite if nothing limits it.
    pub max_effort: f64,
    /// The fastest that a motor goes; infinite if nothing limits it.
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

/// A joint goes to `multiplier` × the position of its leader + `offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mimic {
    /// The joint that it follows.
    pub leader: JointIndex,
    /// Its own motion for that of the leader.
    pub multiplier: f64,
    /// Where it is while the leader is at 0.
    pub offset: f64,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointKind {
    /// Not at all.
    Fixed,
    /// Turns without end.
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
    /// All six degrees of freedom.
    Floating,
}

impl JointKind {
    /// The lower and the upper limit of its position, if it has some.
    pub fn limits(self) -> Option<[f64; 2]> {
        match self {
            Self::Revolute { lower, upper } | Self::Prismatic { lower, upper } => Some([lower, upper]),
            _ => None,
        }
    }
}
