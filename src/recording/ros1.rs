//! Converts streams to the ROS 1 messages that the ROS node publishes for them.

mod bytes;
mod encode;
mod types;

use belvedere_bridge::{FrameHeader, FrameView, Kind};
use bytes::Bytes;
pub use types::MessageType;

/// The ROS topic of a stream.
#[derive(Debug, Clone)]
pub struct RosStream {
    /// With a leading slash. Transforms, the clock and states of models always have ROS's own topic, regardless of the
    /// stream's namespace.
    pub topic: String,
    /// The type of its messages.
    pub message_type: &'static MessageType,
    encode: encode::Encode,
}

impl RosStream {
    /// Returns the ROS topic for a stream of this kind and topic (without a leading slash), or `None` if ROS has no
    /// message for it.
    pub fn new(kind: Kind, topic: &str, layers: Option<u32>) -> Option<Self> {
        let last = topic.rsplit('/').next().unwrap_or(topic);
        let (message_type, encode): (&'static MessageType, encode::Encode) = match kind {
            Kind::Image | Kind::DepthImage => (&types::IMAGE, encode::image),
            Kind::CameraInfo => (&types::CAMERA_INFO, encode::camera_info),
            Kind::LaserScan if layers.unwrap_or(1) > 1 => (&types::POINT_CLOUD, encode::scan_cloud),
            Kind::LaserScan => (&types::LASER_SCAN, encode::laser_scan),
            Kind::PointCloud => (&types::POINT_CLOUD, encode::point_cloud),
            Kind::Odometry => (&types::ODOMETRY, encode::odometry),
            Kind::Transforms | Kind::StaticTransforms => (&types::TRANSFORMS, encode::transforms),
            Kind::JointStates => (&types::JOINT_STATE, encode::joint_states),
            Kind::Clock => (&types::CLOCK, encode::clock),
            Kind::VelocityCommand => (&types::TWIST, encode::velocity_command),
            Kind::Imu => (&types::IMU, encode::imu),
            Kind::RobotEvent => match last {
                "bumper" => (&types::BUMPER, encode::bumper),
                "cliff" => (&types::CLIFF, encode::cliff),
                "wheel_drop" => (&types::WHEEL_DROP, encode::wheel_drop),
                _ => return None,
            },
            Kind::ModelStates => match last {
                "model_states" => (&types::MODEL_STATES, encode::model_states),
                "link_states" => (&types::LINK_STATES, encode::model_states),
                _ => return None,
            },
            Kind::CoreSensors => (&types::CORE_SENSORS, encode::core_sensors),
            Kind::ResetOdometry => (&types::EMPTY, encode::empty),
            Kind::MotorPower => (&types::MOTOR_POWER, encode::motor_power),
            Kind::Range => (&types::RANGE, encode::range),
            Kind::NavSatFix => (&types::NAV_SAT_FIX, encode::nav_sat_fix),
            Kind::MagneticField => (&types::MAGNETIC_FIELD, encode::magnetic_field),
            Kind::FluidPressure => (&types::FLUID_PRESSURE, encode::fluid_pressure),
            Kind::Altimeter => (&types::POINT_STAMPED, encode::height),
            Kind::Vector3 => (&types::VECTOR3_STAMPED, encode::vector),
            _ => return None,
        };
        let topic = match kind {
            Kind::Transforms => "/tf".to_owned(),
            Kind::StaticTransforms => "/tf_static".to_owned(),
            Kind::Clock => "/clock".to_owned(),
            Kind::ModelStates => format!("/gazebo/{last}"),
            _ => format!("/{topic}"),
        };
        Some(Self { topic, message_type, encode })
    }

    /// Writes a frame's message to `out`, replacing its contents, and returns the place of the payload in it if the
    /// message contains all of it unchanged. Returns `None` if the message cannot represent the frame.
    pub fn write(&self, frame: &FrameView<'_>, out: &mut Vec<u8>) -> Option<Payload> {
        out.clear();
        (self.encode)(frame, &mut Bytes(out))
    }
}

/// Whether a message contains a frame's payload.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Payload {
    /// The message contains all of it, starting at this byte.
    Within(usize),
    /// The message does not contain it byte by byte.
    Elsewhere,
}

/// Returns the type of the message that [`write_frame`] writes.
pub fn frame_type() -> &'static MessageType {
    &types::FRAME
}

/// Writes a complete frame to `out`, replacing its contents, without the payload if the previous message contains it.
pub fn write_frame(header: &FrameHeader, payload: &[u8], within: Payload, out: &mut Vec<u8>) {
    out.clear();
    let mut bytes = Bytes(out);
    bytes.bytes(bytemuck::bytes_of(header));
    match within {
        Payload::Within(offset) => {
            bytes.u64(offset as u64);
            bytes.bytes(&[]);
        }
        Payload::Elsewhere => {
            bytes.u64(0);
            bytes.bytes(payload);
        }
    }
}

/// Returns header, offset and payload of a message written by [`write_frame`], or `None` if it is not one.
pub fn read_frame(message: &[u8]) -> Option<(FrameHeader, u64, &[u8])> {
    const HEADER: usize = size_of::<FrameHeader>();
    let (count, rest) = message.split_first_chunk::<4>()?;
    if u32::from_le_bytes(*count) as usize != HEADER || rest.len() < HEADER {
        return None;
    }
    let (header, rest) = rest.split_at(HEADER);
    let (offset, rest) = rest.split_first_chunk::<8>()?;
    let (count, payload) = rest.split_first_chunk::<4>()?;
    (u32::from_le_bytes(*count) as usize == payload.len())
        .then(|| (bytemuck::pod_read_unaligned(header), u64::from_le_bytes(*offset), payload))
}
