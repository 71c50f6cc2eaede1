//! The state of a robot: odometry, transforms, joint states; and the simulation's clock.

use super::channel::Channel;
use super::outlet::Outlet;
use super::owner::Owner;
use super::{Opening, RigContext, RigError};
use crate::description::model::{ModelPlugin, OdometryPlugin};
use crate::description::optical::{OpticalFrame, new_frames, optical_frames};
use crate::entities::{EntityId, Origin};
use crate::robot::odometry::Odometry as OdometryReport;
use crate::robot::transforms::Transform as RobotTransform;
use crate::robot::{Robot, RobotState};
use belvedere_bridge::payload::{Clock, JointState, Odometry, Transform};
use belvedere_bridge::{Kind, StreamSpec, Text};

/// Topic of joint states.
const JOINT_STATES_TOPIC: &str = "/joint_states";

/// The transforms of a robot. Models of the world publish none.
struct FrameOutlets {
    moving: Outlet,
    fixed: Outlet,
}

/// The odometry of a base.
struct OdometryOutlet {
    outlet: Outlet,
    child: Text<64>,
    covariance: [f64; 36],
}

/// The robot's own streams.
pub(super) struct StateChannel {
    id: EntityId,
    odometry: Option<OdometryOutlet>,
    frames: Option<FrameOutlets>,
    joint_states: Option<Outlet>,
    state: RobotState,
    transform_messages: Vec<Transform>,
    joint_messages: Vec<JointState>,
}

impl StateChannel {
    pub(super) fn open(robot: &Robot, opening: &Opening<'_>) -> Result<Self, RigError> {
        let rate = opening.rate.hz();
        let state = robot.state_at(opening.physics, opening.physics.time_ns());
        let fixed: Vec<RobotTransform> =
            robot.static_transforms().iter().cloned().chain(optical_transforms(opening)).collect();
        let array = |topic, kind, count| StreamSpec::structs(topic, kind, count).rate_hz(rate);
        let model = &opening.entity.model;
        let base = model.base().filter(|_| robot.base().is_some());
        let odometry = base.map(|base| {
            let owner = Owner::base(opening.id, opening.entity, base);
            OdometryOutlet::open(&base.odometry, &opening.of(owner))
        });
        let is_robot = opening.entity.origin != Origin::World;
        let frames = is_robot.then(|| -> Result<_, RigError> {
            Ok(FrameOutlets {
                moving: opening.open(&array("/tf", Kind::Transforms, state.transforms.len()))?,
                fixed: opening.open(&StreamSpec::structs(
                    "/tf_static",
                    Kind::StaticTransforms,
                    fixed.len(),
                ))?,
            })
        });
        // A plugin may publish joint states on the same topic.
        let is_published = model
            .plugins
            .iter()
            .any(|plugin| matches!(plugin, ModelPlugin::JointStates(own) if own.topic == JOINT_STATES_TOPIC));
        let joint_states = (is_robot && !is_published)
            .then(|| opening.open(&array(JOINT_STATES_TOPIC, Kind::JointStates, state.joints.len())));
        let mut channel = Self {
            id: opening.id,
            odometry: odometry.transpose()?,
            frames: frames.transpose()?,
            joint_states: joint_states.transpose()?,
            transform_messages: Vec::with_capacity(state.transforms.len()),
            joint_messages: Vec::with_capacity(state.joints.len()),
            state,
        };
        let fixed = fixed.iter().map(message).collect::<Result<Vec<_>, _>>()?;
        if let Some(frames) = &mut channel.frames {
            frames.fixed.send_structs(opening.physics.time_ns(), &fixed);
        }
        // The names are checked here once, so that they are known to fit later.
        for transform in &channel.state.transforms {
            message(transform)?;
        }
        for name in &channel.state.joint_names {
            Text::<64>::new(name).map_err(|error| RigError::name(name, &error))?;
        }
        Ok(channel)
    }
}

impl Channel for StateChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        let frames = self.frames.iter().flat_map(|frames| [&frames.moving, &frames.fixed]);
        self.odometry
            .iter()
            .map(|odometry| &odometry.outlet)
            .chain(frames)
            .chain(&self.joint_states)
            .collect()
    }

    fn publish(&mut self, context: &mut RigContext<'_>, _frame: u64) {
        let Some(robot) = context.entities.robot(self.id) else { return };
        robot.state_into(context.physics, context.stamp_ns, &mut self.state);
        if let (Some(to), Some(report)) = (&mut self.odometry, &self.state.odometry) {
            let message = odometry(report, to);
            to.outlet.send_structs(report.stamp_ns, &[message]);
        }
        if let Some(frames) = &mut self.frames {
            self.transform_messages.clear();
            self.transform_messages
                .extend(self.state.transforms.iter().filter_map(|transform| message(transform).ok()));
            frames.moving.send_structs(context.stamp_ns, &self.transform_messages);
            // Subscribers that connected since the start get the static transforms now.
            frames.fixed.update();
        }
        if let Some(outlet) = &mut self.joint_states {
            self.joint_messages.clear();
            let joints = self.state.joint_names.iter().zip(&self.state.joints);
            self.joint_messages.extend(joints.map(|(name, joint)| JointState {
                name: Text::new(name).unwrap_or_default(),
                position: joint.position,
                velocity: joint.velocity,
                effort: joint.effort,
            }));
            outlet.send_structs(context.stamp_ns, &self.joint_messages);
        }
    }
}

impl OdometryOutlet {
    fn open(plugin: &OdometryPlugin, opening: &Opening<'_>) -> Result<Self, RigError> {
        let spec = StreamSpec::structs(&plugin.topic, Kind::Odometry, 1);
        let child = opening.entity.frame(&plugin.child_frame);
        let mut covariance = [0.0; 36];
        for (axis, variance) in plugin.pose_variance.into_iter().enumerate() {
            covariance[axis * 7] = variance;
        }
        Ok(Self {
            outlet: opening.open(&spec.frame_id(&plugin.frame).rate_hz(opening.rate.hz()))?,
            child: Text::new(&child).map_err(|error| RigError::name(&child, &error))?,
            covariance,
        })
    }
}

/// Returns the transforms of cameras' optical frames that the robot's file lacks.
fn optical_transforms(opening: &Opening<'_>) -> Vec<RobotTransform> {
    if opening.gazebo_compat {
        return Vec::new();
    }
    let entity = opening.entity;
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

fn odometry(report: &OdometryReport, to: &OdometryOutlet) -> Odometry {
    Odometry {
        child_frame_id: to.child,
        position: report.odom_from_base.translation().to_array(),
        orientation: report.odom_from_base.rotation().to_array(),
        linear: [report.linear_m_s, report.lateral_m_s, 0.0],
        angular: [0.0, 0.0, report.angular_rad_s],
        pose_covariance: to.covariance,
        // Gazebo's plugins leave this unset.
        twist_covariance: [0.0; 36],
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
}

impl Channel for ClockChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        vec![&self.clock]
    }

    fn publish(&mut self, context: &mut RigContext<'_>, _frame: u64) {
        self.clock.send_structs(context.stamp_ns, &[Clock { now_ns: context.stamp_ns }]);
    }
}
