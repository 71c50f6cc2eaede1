//! What a model's own plugins make of it: a base that drives, and reporters of what it does.

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
    /// Returns the plugin as part of an outer model, which has `links` links and `joints` joints before its own, and
    /// calls a joint by what `rename` makes of its name.
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

/// A base: how a model drives, what it is told and what it tells.
#[derive(Debug, Clone, PartialEq)]
pub struct BasePlugin {
    /// What drives it.
    pub drive: Drive,
    /// Absolute topic of velocity commands.
    pub command_topic: String,
    /// For how long a command holds, in s; none until the next one.
    pub command_timeout_s: Option<f64>,
    /// What it tells of its motion.
    pub odometry: OdometryPlugin,
    /// The plugin.
    pub source: Source,
}

/// Ways to drive.
#[derive(Debug, Clone, PartialEq)]
pub enum Drive {
    /// `libgazebo_ros_kobuki.so`: two wheels, encoders, gyro, bumpers, cliff sensors.
    Kobuki(Wheels),
    /// Wheels on the left turn alike, and those on the right.
    Differential(DifferentialDrive),
    /// `libgazebo_ros_planar_move.so`, `libgazebo_ros_force_based_move.so`: any velocity in the plane, as if by hand.
    Planar,
    /// Front wheels that steer.
    Ackermann(AckermannDrive),
}

impl Drive {
    /// What it is called in messages.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Kobuki(_) => "kobuki",
            Self::Differential(drive) if drive.skids => "skid steer",
            Self::Differential(_) => "differential drive",
            Self::Planar => "planar move",
            Self::Ackermann(_) => "ackermann",
        }
    }

    /// All joints that it turns: of wheels, and of what steers them.
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

/// The wheels of an axle, or of several that turn alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Wheels {
    /// Joints of the wheels on the left: of one or more.
    pub left: Vec<JointIndex>,
    /// Joints of the wheels on the right.
    pub right: Vec<JointIndex>,
    /// Radius in m by which speeds become turns of the wheels; the wheels' own if it is not given.
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
    /// Its wheels.
    pub wheels: Wheels,
    /// Distance in m between left and right wheels by which a rate of turn becomes speeds of the wheels.
    pub separation_m: f64,
    /// How fast the speed of a wheel's rim changes, in m/s²; none for at once.
    pub acceleration_m_s2: Option<f64>,
    /// Its wheels slip when it turns.
    pub skids: bool,
}

/// `libgazebo_ros_ackermann_drive.so`, gz-sim's `AckermannSteering`.
#[derive(Debug, Clone, PartialEq)]
pub struct AckermannDrive {
    /// Wheels that are driven and do not steer.
    pub rear: Wheels,
    /// Wheels that roll on the steered axle, if there are any.
    pub front: Option<Wheels>,
    /// Joints that steer: left, right.
    pub steering: [JointIndex; 2],
    /// Distance in m between the axles; by where the joints are if it is not given.
    pub wheel_base_m: Option<f64>,
    /// Greatest mean steering angle in rad.
    pub steering_limit_rad: f64,
    /// How fast the steering angle comes to the one that is wanted: rad/s for each rad between the two.
    pub steering_gain: f64,
    /// Greatest speed in m/s.
    pub max_speed_m_s: f64,
    /// The command's second number is the steering angle in rad, not the rate of turn in rad/s.
    pub is_told_angle: bool,
}

/// What a base tells of its motion.
#[derive(Debug, Clone, PartialEq)]
pub struct OdometryPlugin {
    /// Absolute topic.
    pub topic: String,
    /// The frame of the pose.
    pub frame: String,
    /// The frame that it is the pose of, as messages name it.
    pub child_frame: String,
    /// The link of that name, or the model's root.
    pub link: LinkIndex,
    /// Rate; none for each step.
    pub rate_hz: Option<f64>,
    /// Where it comes from.
    pub origin: OdometryOrigin,
    /// It is a transform, too.
    pub is_transform: bool,
    /// Variances of x, y, z in m², roll, pitch, yaw in rad².
    pub pose_variance: [f64; 6],
}

/// Where odometry comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OdometryOrigin {
    /// What the wheels have turned.
    Encoders,
    /// The true pose in the world.
    World,
}

/// True pose and velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct PosePlugin {
    /// Absolute topic.
    pub topic: String,
    /// The link whose pose it is.
    pub link: LinkIndex,
    /// The frame that messages name.
    pub frame: String,
    /// What is put before the pose: `xyzOffset` and `rpyOffset`.
    pub offset: Pose,
    /// Rate; none for each step.
    pub rate_hz: Option<f64>,
    /// Standard deviation of the velocities.
    pub stddev: f64,
    /// The plugin.
    pub source: Source,
}

/// Joint states under a name of one's own.
#[derive(Debug, Clone, PartialEq)]
pub struct JointStatesPlugin {
    /// Absolute topic.
    pub topic: String,
    /// Names of joints; all if there are none.
    pub joints: Vec<String>,
    /// Rate; none for each step.
    pub rate_hz: Option<f64>,
    /// The plugin.
    pub source: Source,
}
