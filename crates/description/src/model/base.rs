//! Plugins of a model: a base that drives it, and publishers of its state.

use super::{JointIndex, LinkIndex};
use crate::diagnostics::Source;
use belvedere_sensors::Pose;

/// A `<plugin>` of a model, with its parameters resolved to the plugin's own defaults.
#[derive(Debug, Clone, PartialEq)]
pub enum ModelPlugin {
    /// Drives the model.
    Base(Box<BasePlugin>),
    /// `libgazebo_ros_p3d.so`: the true pose and velocity of a link.
    Pose(PosePlugin),
    /// `libgazebo_ros_joint_state_publisher.so`.
    JointStates(JointStatesPlugin),
}

impl ModelPlugin {
    /// Returns the plugin as part of an outer model. That model has `links` links and `joints` joints before this model's own,
    /// and `rename` converts a joint's name to its name there.
    #[must_use]
    pub fn nested(self, links: usize, joints: usize, rename: impl Fn(&str) -> String) -> Self {
        match self {
            Self::Base(mut base) => {
                for wheel in base.drive.joints_mut() {
                    *wheel += joints;
                }
                base.odometry.link += links;
                Self::Base(base)
            }
            Self::Pose(pose) => Self::Pose(PosePlugin { link: pose.link + links, ..pose }),
            Self::JointStates(states) => {
                let joints = states.joints.iter().map(|name| rename(name)).collect();
                Self::JointStates(JointStatesPlugin { joints, ..states })
            }
        }
    }
}

/// A base: how a model drives, its commands and its odometry.
#[derive(Debug, Clone, PartialEq)]
pub struct BasePlugin {
    /// The kind of drive.
    pub drive: Drive,
    /// Absolute topic of velocity commands.
    pub command_topic: String,
    /// Seconds for which a command holds; none until the next command.
    pub command_timeout_s: Option<f64>,
    /// The odometry that it publishes.
    pub odometry: OdometryPlugin,
    /// File and line of the plugin.
    pub source: Source,
}

/// Kinds of drive.
#[derive(Debug, Clone, PartialEq)]
pub enum Drive {
    /// `libgazebo_ros_kobuki.so`: two wheels, encoders, gyro, bumpers, cliff sensors.
    Kobuki(Wheels),
    /// Differential drive: the wheels on each side turn alike.
    Differential(DifferentialDrive),
    /// `libgazebo_ros_planar_move.so`, `libgazebo_ros_force_based_move.so`: any velocity in the plane, without wheels.
    Planar,
    /// Ackermann steering: the front wheels steer.
    Ackermann(AckermannDrive),
}

impl Drive {
    /// Returns its name for messages.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Kobuki(_) => "kobuki",
            Self::Differential(drive) if drive.skids => "skid steer",
            Self::Differential(_) => "differential drive",
            Self::Planar => "planar move",
            Self::Ackermann(_) => "ackermann",
        }
    }

    /// Returns all joints that it moves: those of wheels and of steering.
    pub fn joints(&self) -> Vec<JointIndex> {
        self.clone().joints_mut().into_iter().map(|joint| *joint).collect()
    }

    fn joints_mut(&mut self) -> Vec<&mut JointIndex> {
        match self {
            Self::Kobuki(wheels) => wheels.joints_mut().collect(),
            Self::Differential(drive) => drive.wheels.joints_mut().collect(),
            Self::Planar => Vec::new(),
            Self::Ackermann(drive) => {
                let front = drive.front.iter_mut().flat_map(Wheels::joints_mut);
                drive.rear.joints_mut().chain(front).chain(&mut drive.steering).collect()
            }
        }
    }
}

/// The wheels of one axle, or of several axles that turn alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Wheels {
    /// Joints of the wheels on the left, one or more.
    pub left: Vec<JointIndex>,
    /// Joints of the wheels on the right.
    pub right: Vec<JointIndex>,
    /// Radius in m that converts speeds to wheel rates; none for the wheels' own.
    pub radius_m: Option<f64>,
    /// Torque of each wheel's motor in N·m.
    pub torque_n_m: f64,
}

impl Wheels {
    fn joints_mut(&mut self) -> impl Iterator<Item = &mut JointIndex> {
        self.left.iter_mut().chain(&mut self.right)
    }
}

/// `libgazebo_ros_diff_drive.so`, `libgazebo_ros_skid_steer_drive.so`, `libgazebo_ros_create.so`, gz-sim's `DiffDrive`.
#[derive(Debug, Clone, PartialEq)]
pub struct DifferentialDrive {
    /// The wheels.
    pub wheels: Wheels,
    /// Distance in m between left and right wheels that converts yaw rates to wheel speeds.
    pub separation_m: f64,
    /// Acceleration limit of a wheel's rim in m/s²; none for no limit.
    pub acceleration_m_s2: Option<f64>,
    /// True if its wheels slip when it turns.
    pub skids: bool,
}

/// `libgazebo_ros_ackermann_drive.so`, gz-sim's `AckermannSteering`.
#[derive(Debug, Clone, PartialEq)]
pub struct AckermannDrive {
    /// The driven wheels, which do not steer.
    pub rear: Wheels,
    /// The wheels that roll on the steered axle, if there are any.
    pub front: Option<Wheels>,
    /// The steering joints: left, right.
    pub steering: [JointIndex; 2],
    /// Distance in m between the axles; none to derive it from the joints.
    pub wheel_base_m: Option<f64>,
    /// Greatest mean steering angle in rad.
    pub steering_limit_rad: f64,
    /// Gain of the steering: rad/s for each rad between the angle and its setpoint.
    pub steering_gain: f64,
    /// Greatest speed in m/s.
    pub max_speed_m_s: f64,
    /// True if the command's second number is the steering angle in rad, false for the yaw rate in rad/s.
    pub is_told_angle: bool,
}

/// The odometry that a base publishes.
#[derive(Debug, Clone, PartialEq)]
pub struct OdometryPlugin {
    /// Absolute topic.
    pub topic: String,
    /// The frame that the pose is in.
    pub frame: String,
    /// The frame whose pose it is, as named in messages.
    pub child_frame: String,
    /// The link of that name, or else the model's root.
    pub link: LinkIndex,
    /// Rate in Hz; none for every step.
    pub rate_hz: Option<f64>,
    /// The source of the pose.
    pub origin: OdometryOrigin,
    /// True if it is also published as a transform.
    pub is_transform: bool,
    /// Variances of x, y, z in m², roll, pitch, yaw in rad².
    pub pose_variance: [f64; 6],
}

/// The source of odometry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OdometryOrigin {
    /// The rotation of the wheels.
    Encoders,
    /// The true pose in the world.
    World,
}

/// A plugin that publishes true pose and velocity of a link.
#[derive(Debug, Clone, PartialEq)]
pub struct PosePlugin {
    /// Absolute topic.
    pub topic: String,
    /// The link whose pose it is.
    pub link: LinkIndex,
    /// The frame that messages name.
    pub frame: String,
    /// A pose that is applied before the link's: `xyzOffset` and `rpyOffset`.
    pub offset: Pose,
    /// Rate in Hz; none for every step.
    pub rate_hz: Option<f64>,
    /// Standard deviation of the velocities.
    pub stddev: f64,
    /// File and line of the plugin.
    pub source: Source,
}

/// A plugin that publishes joint states on its own topic.
#[derive(Debug, Clone, PartialEq)]
pub struct JointStatesPlugin {
    /// Absolute topic.
    pub topic: String,
    /// Names of joints; empty for all joints.
    pub joints: Vec<String>,
    /// Rate in Hz; none for every step.
    pub rate_hz: Option<f64>,
    /// File and line of the plugin.
    pub source: Source,
}
