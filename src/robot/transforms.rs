//! The tree of frames that a robot publishes (`/tf`, `/tf_static`).

use crate::description::model::{JointKind, LinkIndex, Model};
use crate::world::physics::JointIndex;
use belvedere_sensors::Pose;
use glam::{DQuat, DVec3};
use std::sync::Arc;

/// A frame in its parent.
#[derive(Debug, Clone, PartialEq)]
pub struct Transform {
    /// The parent frame.
    pub parent: Arc<str>,
    /// The child frame.
    pub child: Arc<str>,
    /// Pose of the child frame in the parent frame.
    pub parent_from_child: Pose,
}

/// The transform of a joint that moves.
#[derive(Debug, Clone)]
pub struct JointTransform {
    /// Index in [`Model::joints`].
    pub joint: JointIndex,
    /// The joint's name.
    pub name: Arc<str>,
    rest: Transform,
    axis: DVec3,
    pivot: DVec3,
    slides: bool,
}

impl JointTransform {
    /// Returns the transform with the joint at a position in radians or metres.
    pub fn at(&self, position: f64) -> Transform {
        let motion = if self.slides {
            Pose::from_translation(self.axis * position)
        } else {
            let (sin, cos) = libm::sincos(position * 0.5);
            let axis = self.axis * sin;
            let turn = DQuat::from_xyzw(axis.x, axis.y, axis.z, cos);
            Pose::new(self.pivot - turn * self.pivot, turn)
        };
        let parent_from_child = self.rest.parent_from_child * motion;
        Transform { parent: self.rest.parent.clone(), child: self.rest.child.clone(), parent_from_child }
    }
}

/// The frames of a model.
#[derive(Debug, Clone)]
pub struct Transforms {
    fixed: Vec<Transform>,
    moving: Vec<JointTransform>,
    /// Names of odometry's frame and of the base's frame, if odometry is published as a transform.
    odometry: Option<[Arc<str>; 2]>,
}

impl Transforms {
    /// Sorts the joints of a model into fixed and moving transforms. Ball and floating joints are omitted, because no
    /// joint state describes them. Names are in the namespace, if there is one.
    pub fn of(model: &Model, namespace: &str) -> Self {
        let name = |name: &str| -> Arc<str> {
            if namespace.is_empty() { name.into() } else { format!("{namespace}/{name}").into() }
        };
        let names: Vec<Arc<str>> = model.links.iter().map(|link| name(&link.name)).collect();
        let (mut fixed, mut moving) = (Vec::new(), Vec::new());
        for (index, joint) in model.joints.iter().enumerate() {
            let rest = Transform {
                parent: names[joint.parent].clone(),
                child: names[joint.child].clone(),
                parent_from_child: joint.parent_from_child,
            };
            let slides = match joint.kind {
                JointKind::Fixed => {
                    fixed.push(rest);
                    continue;
                }
                JointKind::Ball | JointKind::Floating => continue,
                JointKind::Prismatic { .. } => true,
                JointKind::Continuous | JointKind::Revolute { .. } => false,
            };
            moving.push(JointTransform {
                joint: index,
                name: joint.name.as_str().into(),
                rest,
                axis: joint.axis,
                pivot: joint.pivot,
                slides,
            });
        }
        let odometry = model.base().map(|base| &base.odometry).filter(|odometry| odometry.is_transform);
        let odometry = odometry.map(|odometry| [name(&odometry.frame), name(&odometry.child_frame)]);
        Self { fixed, moving, odometry }
    }

    /// Returns the transforms that never change.
    pub fn fixed(&self) -> &[Transform] {
        &self.fixed
    }

    /// Returns the transforms of moving joints, in the order of the file.
    pub fn moving(&self) -> &[JointTransform] {
        &self.moving
    }

    /// Returns the transform from odometry's frame to the base, if it is published.
    pub fn odom(&self, odom_from_base: Pose) -> Option<Transform> {
        let [parent, child] = self.odometry.clone()?;
        Some(Transform { parent, child, parent_from_child: odom_from_base })
    }
}

/// Returns the link that odometry describes: `base_footprint`, or the root of a model without it.
pub fn base_link(model: &Model) -> LinkIndex {
    model.link_named("base_footprint").or_else(|| model.first_root()).unwrap_or(0)
}
