//! Streams as the messages of ROS 1 that the bridge's node publishes of them.

mod bytes;
mod encode;
mod types;

use belvedere_bridge::{FrameHeader, FrameView, Kind};
use bytes::Bytes;
pub use types::MessageType;

/// What a stream is for ROS.
#[derive(Debug, Clone)]
pub struct RosStream {
    /// With a leading slash. That of transforms, of the clock and of states of models is always ROS's own, whatever
    /// namespace the stream has.
    pub topic: String,
    /// What its messages are.
    pub message_type: &'static MessageType,
    encode: encode::Encode,
}

impl RosStream {
    /// What ROS calls a stream of this kind and topic (without a leading slash); none if it has no message for it.
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

    /// Writes a frame's message over what `out` holds, and gives the place of the payload in it if the message has all
    /// of it as it is. None if ROS's message cannot hold the frame.
    pub fn write(&self, frame: &FrameView<'_>, out: &mut Vec<u8>) -> Option<Payload> {
        out.clear();
        (self.encode)(frame, &mut Bytes(out))
    }
}

/// What of a frame's payload its message has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Payload {
    /// All of it, from this byte on.
    Within(usize),
    /// Not byte by byte.
    Elsewhere,
}

/// The type of [`write_frame`]'s message.
pub fn frame_type() -> &'static MessageType {
    &types::FRAME
}

/// Writes a frame whole over what `out` holds, without the payload if the message before has it.
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

/// The parts of a message of [`write_frame`]: header, offset, payload. None if it is not one.
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
