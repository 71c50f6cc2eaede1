//! What the robot says of itself: odometry, transforms, joint states; and the clock.

use super::outlet::Outlet;
use super::{RigContext, RigError, Setting};
use crate::description::optical::{OpticalFrame, new_frames, optical_frames};
use crate::entities::EntityId;
use crate::robot::odometry::Odometry as OdometryReport;
use crate::robot::transforms::Transform as RobotTransform;
use crate::robot::{Robot, RobotState};
use belvedere_bridge::payload::{Clock, JointState, Odometry, Transform};
use belvedere_bridge::{Kind, StreamSpec, Text};
use glam::DVec3;

/// The robot's own streams.
pub(super) struct StateChannel {
    id: EntityId,
    odometry: Option<Outlet>,
    transforms: Outlet,
    static_transforms: Outlet,
    joint_states: Outlet,
    state: RobotState,
    transform_messages: Vec<Transform>,
    joint_messages: Vec<JointState>,
}

impl StateChannel {
    pub(super) fn open(robot: &Robot, setting: &Setting<'_>) -> Result<Self, RigError> {
        let rate = setting.rate.hz();
        let state = robot.state_at(setting.physics, setting.physics.time_ns());
        let fixed: Vec<RobotTransform> =
            robot.static_transforms().iter().cloned().chain(optical_transforms(setting)).collect();
        let array = |topic, kind, count| StreamSpec::structs(topic, kind, count).rate_hz(rate);
        let odometry = state
            .odometry
            .map(|_| {
                setting
                    .open(&array("/odom", Kind::Odometry, 1).frame_id(crate::robot::transforms::ODOM_FRAME))
            })
            .transpose()?;
        let mut channel = Self {
            id: setting.id,
            odometry,
            transforms: setting.open(&array("/tf", Kind::Transforms, state.transforms.len()))?,
            static_transforms: setting.open(&StreamSpec::structs(
                "/tf_static",
                Kind::StaticTransforms,
                fixed.len(),
            ))?,
            joint_states: setting.open(&array("/joint_states", Kind::JointStates, state.joints.len()))?,
            transform_messages: Vec::with_capacity(state.transforms.len()),
            joint_messages: Vec::with_capacity(state.joints.len()),
            state,
        };
        let fixed = fixed.iter().map(message).collect::<Result<Vec<_>, _>>()?;
        channel.static_transforms.send_structs(setting.physics.time_ns(), &fixed);
        // The names are checked here once; after this they are known to fit.
        for transform in &channel.state.transforms {
            message(transform)?;
        }
        for name in &channel.state.joint_names {
            Text::<64>::new(name).map_err(|error| RigError::name(name, &error))?;
        }
        Ok(channel)
    }

    pub(super) fn publish(&mut self, context: &mut RigContext<'_>) {
        let Some(robot) = context.entities.robot(self.id) else { return };
        robot.state_into(context.physics, context.stamp_ns, &mut self.state);
        if let (Some(outlet), Some(report)) = (&mut self.odometry, &self.state.odometry) {
            let child = self.state.transforms.first().map_or("", |odom| &*odom.child);
            outlet.send_structs(report.stamp_ns, &[odometry(report, child)]);
        }
        self.transform_messages.clear();
        self.transform_messages
            .extend(self.state.transforms.iter().filter_map(|transform| message(transform).ok()));
        self.transforms.send_structs(context.stamp_ns, &self.transform_messages);
        self.joint_messages.clear();
        let joints = self.state.joint_names.iter().zip(&self.state.joints);
        self.joint_messages.extend(joints.map(|(name, joint)| JointState {
            name: Text::new(name).unwrap_or_default(),
            position: joint.position,
            velocity: joint.velocity,
            effort: joint.effort,
        }));
        self.joint_states.send_structs(context.stamp_ns, &self.joint_messages);
        // Whoever has come since the start gets the static transforms now.
        self.static_transforms.update();
    }

    pub(super) fn outlets(&self) -> impl Iterator<Item = &Outlet> {
        self.odometry.iter().chain([&self.transforms, &self.static_transforms, &self.joint_states])
    }
}

/// Those of the frames that cameras' pictures are in, where the robot's file has none.
fn optical_transforms(setting: &Setting<'_>) -> Vec<RobotTransform> {
    if setting.gazebo_compat {
        return Vec::new();
    }
    let entity = setting.entity;
    let transform = |frame: &OpticalFrame| RobotTransform {
        parent: entity.frame(&entity.model.links[frame.parent].name).into(),
        child: entity.frame(&frame.name).into(),
        parent_from_child: frame.parent_from_frame,
    };
    new_frames(&optical_frames(&entity.model)).map(transform).collect()
}

fn message(transform: &RobotTransform) -> Result<Transform, RigError> {
    let name = |name: &str| Text::new(name).map_err(|error| RigError::name(name, &error));
    Ok(Transform {
        parent: name(&transform.parent)?,
        child: name(&transform.child)?,
        translation: transform.parent_from_child.translation().to_array(),
        rotation: transform.parent_from_child.rotation().to_array(),
    })
}

fn odometry(report: &OdometryReport, child: &str) -> Odometry {
    Odometry {
        child_frame_id: Text::new(child).unwrap_or_default(),
        position: report.odom_from_base.translation().to_array(),
        orientation: report.odom_from_base.rotation().to_array(),
        linear: (DVec3::X * report.linear_m_s).to_array(),
        angular: (DVec3::Z * report.angular_rad_s).to_array(),
        pose_covariance: OdometryReport::POSE_COVARIANCE,
        twist_covariance: OdometryReport::TWIST_COVARIANCE,
    }
}

/// The clock of the simulation.
pub(super) struct ClockChannel {
    clock: Outlet,
}

impl ClockChannel {
    pub(super) fn spec(rate_hz: f64) -> StreamSpec {
        StreamSpec::structs("/clock", Kind::Clock, 1).rate_hz(rate_hz)
    }

    pub(super) fn new(clock: Outlet) -> Self {
        Self { clock }
    }

    pub(super) fn publish(&mut self, context: &mut RigContext<'_>) {
        self.clock.send_structs(context.stamp_ns, &[Clock { now_ns: context.stamp_ns }]);
    }

    pub(super) fn outlets(&self) -> [&Outlet; 1] {
        [&self.clock]
    }
}
