//! The wire format's structs for C: field by field those of `belvedere_bridge`, which is checked below.

use std::{
    ffi::c_char,
    mem::{offset_of, size_of},
};

use belvedere_bridge as wire;
use belvedere_bridge::payload;

/// First field of every frame header: "BLVD" in memory order.
pub const BV_MAGIC: u32 = 0x4456_4C42;
/// Version of the layout in this file.
pub const BV_SCHEMA: u16 = 2;
/// Flag: a plane of intensities of the same shape follows the ranges, at row_stride * height.
pub const BV_HAS_INTENSITIES: u32 = 1;

/// What the payload is (bv_frame_header.kind).
#[allow(dead_code)]
#[derive(Clone, Copy)]
#[repr(u16)]
pub enum Kind {
    /// A colour or grey picture; block: intrinsics.
    Image = 1,
    /// Depth along the optical axis; block: intrinsics.
    DepthImage = 2,
    /// One bv_camera_info.
    CameraInfo = 3,
    /// Ranges of a lidar; block: scan.
    LaserScan = 4,
    /// Points; organised as an image when height > 1; block: intrinsics.
    PointCloud = 5,
    /// One bv_odometry.
    Odometry = 6,
    /// An array of bv_transform that hold at the stamp.
    Transforms = 7,
    /// An array of bv_transform that hold always.
    StaticTransforms = 8,
    /// An array of bv_joint_state.
    JointStates = 9,
    /// One bv_clock.
    Clock = 10,
    /// One bv_velocity_command.
    VelocityCommand = 11,
    /// One bv_imu.
    Imu = 12,
    /// One bv_robot_event.
    RobotEvent = 13,
    /// One bv_simulation_command, towards the simulator; a text may follow it.
    SimulationCommand = 14,
    /// One bv_simulation_result.
    SimulationResult = 15,
    /// An array of bv_model_state.
    ModelStates = 16,
    /// One bv_core_sensors.
    CoreSensors = 17,
    /// One bv_reset_odometry.
    ResetOdometry = 18,
    /// One bv_motor_power.
    MotorPower = 19,
    /// One bv_range.
    Range = 20,
    /// An array of bv_sensor_settings.
    SensorSettings = 21,
    /// An array of bv_bounding_box.
    BoundingBoxes = 22,
    /// An array of bv_tag_detection.
    TagDetections = 23,
}

/// What a simulator is told to do (bv_simulation_command.operation), and the fields that it looks at.
#[allow(dead_code)]
#[derive(Clone, Copy)]
#[repr(u16)]
pub enum Operation {
    /// Let simulated time stand.
    Pause = 1,
    /// Let it go on.
    Resume = 2,
    /// Run steps of physics with all that is published on the way, then pause: steps.
    Step = 3,
    /// Every model where it was at the start, at rest; time goes on.
    ResetWorld = 4,
    /// Begin again at time 0.
    ResetSimulation = 5,
    /// Move a model: name, reference, position, orientation, linear, angular.
    SetModelState = 6,
    /// Put the model of the text into the world: name, reference, position, orientation, robot_namespace.
    Spawn = 7,
    /// Take a model out: name.
    Delete = 8,
    /// Change settings of the sensor, or of the one that sends the topic, name: `key=value` words in the text.
    Configure = 9,
}

/// How an element is coded (bv_frame_header.encoding).
#[allow(dead_code)]
#[derive(Clone, Copy)]
#[repr(u16)]
pub enum Encoding {
    /// Red, green, blue; 8 bit each.
    Rgb8 = 1,
    /// Blue, green, red; 8 bit each.
    Bgr8 = 2,
    /// Grey, 8 bit.
    Mono8 = 3,
    /// float, metres: NaN invalid, -inf too near, +inf nothing there.
    F32C1 = 4,
    /// uint16_t, millimetres: 0 invalid.
    U16C1 = 5,
    /// 32 bytes: float x, y, z at 0, 4, 8; colour 0x00RRGGBB at 16.
    XyzRgbF32 = 6,
    /// float, metres: height layers of width rays.
    RangesF32 = 7,
    /// height structs of the kind, row_stride bytes apart.
    Struct = 8,
    /// Red, green, blue, and 255; 8 bit each.
    Rgba8 = 9,
    /// Grey, uint16_t.
    Mono16 = 10,
    /// A colour a pixel, 8 bit: the first row red and green, the second green and blue.
    BayerRggb8 = 11,
    /// A colour a pixel, 8 bit: the first row blue and green, the second green and red.
    BayerBggr8 = 12,
    /// A colour a pixel, 8 bit: the first row green and blue, the second red and green.
    BayerGbrg8 = 13,
    /// A colour a pixel, 8 bit: the first row green and red, the second blue and green.
    BayerGrbg8 = 14,
    /// A colour a pixel, uint16_t: the first row red and green, the second green and blue.
    BayerRggb16 = 15,
    /// A colour a pixel, uint16_t: the first row blue and green, the second green and red.
    BayerBggr16 = 16,
    /// A colour a pixel, uint16_t: the first row green and blue, the second red and green.
    BayerGbrg16 = 17,
    /// A colour a pixel, uint16_t: the first row green and red, the second blue and green.
    BayerGrbg16 = 18,
    /// Two floats: flow in pixels, to the right and down; NaN where there is none.
    F32C2 = 19,
    /// Three floats: unit normals in the axes of the world; 0 where nothing is seen.
    F32C3 = 20,
    /// int32_t, a number of a thing or of a class; of things, -1 where nothing is seen.
    I32C1 = 21,
}

/// How a lens maps directions to pixels, and its parameters (bv_intrinsics.distortion_model).
#[allow(dead_code)]
#[derive(Clone, Copy)]
#[repr(u16)]
pub enum DistortionModel {
    /// k1 k2 p1 p2 k3; all 0 for a pinhole.
    PlumbBob = 1,
    /// k1 k2 p1 p2 k3 k4 k5 k6, then s1 s2 s3 s4, then tau_x tau_y: 8, 12 or 14.
    RationalPolynomial = 2,
    /// k1 k2 k3 k4 of Kannala and Brandt, OpenCV's fisheye.
    Equidistant = 3,
    /// alpha beta
    Eucm = 4,
    /// xi alpha
    DoubleSphere = 5,
    /// xi k1 k2 p1 p2
    Mei = 6,
    /// none
    Equirectangular = 7,
    /// c1 c2 c3 f fun cutoff of SDF's lens; f in pixels, fun 0 sin, 1 tan, 2 the angle itself.
    WideAngle = 8,
}

/// How pixels map to directions.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Intrinsics {
    pub fx: f64,
    pub fy: f64,
    pub cx: f64,
    pub cy: f64,
    /// K[1]
    pub skew: f64,
    /// parameters of the model, in its order
    pub distortion: [f64; 14],
    /// metres
    pub near: f32,
    /// metres
    pub far: f32,
    /// P[3]
    pub tx: f32,
    /// a bv_distortion_model; 0 none
    pub distortion_model: u16,
    /// how many of distortion hold
    pub distortion_len: u16,
    pub reserved: [u64; 5],
}

/// Angles (radians) and limits (metres) of a lidar.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct ScanGeometry {
    pub angle_min: f64,
    pub angle_increment: f64,
    /// seconds from ray to ray
    pub time_increment: f64,
    /// seconds from scan to scan
    pub scan_time: f64,
    pub range_min: f32,
    pub range_max: f32,
    pub vertical_angle_min: f64,
    pub vertical_angle_increment: f64,
    pub reserved: [u64; 19],
}

/// What only this kind has.
#[derive(Clone, Copy)]
#[repr(C)]
pub union Block {
    /// images, depth images, clouds
    pub intrinsics: Intrinsics,
    /// scans
    pub scan: ScanGeometry,
    pub raw: [u64; 26],
}

/// The 384 bytes before every payload.
#[repr(C)]
pub struct FrameHeader {
    /// BV_MAGIC
    pub magic: u32,
    /// 384
    pub header_len: u16,
    /// BV_SCHEMA
    pub schema: u16,
    /// a bv_kind
    pub kind: u16,
    /// a bv_encoding
    pub encoding: u16,
    /// BV_HAS_INTENSITIES
    pub flags: u32,
    /// counts the frames of one session from 0
    pub seq: u64,
    /// random per publisher life
    pub session: u64,
    /// simulation time of capture
    pub stamp_ns: u64,
    /// CLOCK_MONOTONIC of sending
    pub publish_mono_ns: u64,
    /// elements per row
    pub width: u32,
    /// rows
    pub height: u32,
    /// bytes from row to row
    pub row_stride: u32,
    /// bytes from element to element
    pub elem_stride: u32,
    pub payload_len: u64,
    /// NUL-terminated
    pub frame_id: [c_char; 64],
    /// of the sensor in the world, metres
    pub position: [f64; 3],
    /// of the sensor in the world, x y z w
    pub orientation: [f32; 4],
    pub block: Block,
}

/// As sensor_msgs/CameraInfo.
#[repr(C)]
pub struct CameraInfo {
    pub width: u32,
    pub height: u32,
    /// the model's name: plumb_bob, rational_polynomial, equidistant, eucm, double_sphere, mei, equirectangular, wide_angle
    pub distortion_model: [c_char; 32],
    /// parameters of the model, in its order
    pub d: [f64; 14],
    /// how many of d hold
    pub d_len: u32,
    pub reserved: u32,
    pub k: [f64; 9],
    pub r: [f64; 9],
    pub p: [f64; 12],
}

/// As nav_msgs/Odometry.
#[repr(C)]
pub struct Odometry {
    pub child_frame_id: [c_char; 64],
    pub position: [f64; 3],
    /// x y z w
    pub orientation: [f64; 4],
    pub linear: [f64; 3],
    pub angular: [f64; 3],
    pub pose_covariance: [f64; 36],
    pub twist_covariance: [f64; 36],
}

/// point_in_parent = parent_from_child * point_in_child
#[repr(C)]
pub struct Transform {
    pub parent: [c_char; 64],
    pub child: [c_char; 64],
    pub translation: [f64; 3],
    /// x y z w
    pub rotation: [f64; 4],
}

/// State of one joint.
#[repr(C)]
pub struct JointState {
    pub name: [c_char; 64],
    pub position: f64,
    pub velocity: f64,
    pub effort: f64,
}

/// The simulation's time.
#[repr(C)]
pub struct Clock {
    pub now_ns: u64,
}

/// As geometry_msgs/Twist: x forward, y left, z up; m/s and rad/s.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct VelocityCommand {
    pub linear: [f64; 3],
    pub angular: [f64; 3],
}

/// As sensor_msgs/Imu. A covariance of zeros is not known; one that begins with -1: not measured.
#[repr(C)]
pub struct Imu {
    /// x y z w
    pub orientation: [f64; 4],
    /// rad/s
    pub angular_velocity: [f64; 3],
    /// m/s^2; +g upwards at rest
    pub linear_acceleration: [f64; 3],
    pub orientation_covariance: [f64; 9],
    pub angular_velocity_covariance: [f64; 9],
    pub linear_acceleration_covariance: [f64; 9],
}

/// A sensor of a base that has changed its state.
#[repr(C)]
pub struct RobotEvent {
    /// 0 bumper, 1 cliff sensor, 2 wheel
    pub source: u32,
    /// 0 left, 1 centre, 2 right
    pub index: u32,
    /// 0 released, floor, raised; 1 pressed, cliff, dropped
    pub state: u32,
    /// a cliff sensor's reading, else 0
    pub value: u32,
}

/// As kobuki_msgs/SensorState. Bits of bumper and cliff: 1 right, 2 centre, 4 left; of wheel_drop: 1 right, 2 left.
#[repr(C)]
pub struct CoreSensors {
    /// milliseconds; wraps
    pub time_stamp: u16,
    pub bumper: u8,
    pub wheel_drop: u8,
    pub cliff: u8,
    pub buttons: u8,
    /// ticks; wraps
    pub left_encoder: u16,
    /// ticks; wraps
    pub right_encoder: u16,
    pub left_pwm: i8,
    pub right_pwm: i8,
    /// 0 discharging, 2 charged, 6 charging
    pub charger: u8,
    /// tenths of a volt
    pub battery: u8,
    /// cliff readings right, centre, left
    pub bottom: [u16; 3],
}

/// Odometry is to begin at zero here and now.
#[repr(C)]
pub struct ResetOdometry {
    pub reserved: u64,
}

/// Whether the motors follow commands.
#[repr(C)]
pub struct MotorPower {
    /// 0 off, else on
    pub state: u32,
}

/// As sensor_msgs/Range: distance to the nearest thing within a cone.
#[allow(clippy::struct_field_names, reason = "those of sensor_msgs")]
#[repr(C)]
pub struct Range {
    /// 0 ultrasound, 1 infrared
    pub radiation_type: u32,
    /// full angle of the cone, radians
    pub field_of_view: f32,
    /// metres
    pub min_range: f32,
    /// metres
    pub max_range: f32,
    /// metres; -inf too near, +inf nothing in range
    pub range: f32,
}

/// A number that can be set; all three are NaN where a sensor has no such setting.
#[repr(C)]
pub struct Setting {
    pub value: f64,
    pub min: f64,
    pub max: f64,
}

/// What of a sensor can be changed, under the names by which the operation configure changes it.
#[repr(C)]
pub struct SensorSettings {
    /// the sensor's name in the robot's description
    pub name: [c_char; 64],
    /// the streams that it sends, without leading slashes; the rest is empty
    pub topics: [[c_char; 256]; 6],
    /// frames per second
    pub update_rate: Setting,
    /// of colours in [0, 1] for a camera, of ranges in metres for a lidar
    pub noise_mean: Setting,
    pub noise_stddev: Setting,
    /// share of the light that a camera's description gives it, 1 as described
    pub exposure: Setting,
}

/// What a simulator is to do. A text of text_len bytes follows it in the payload.
#[repr(C)]
pub struct SimulationCommand {
    /// chosen at random by the sender; the result names it
    pub id: u64,
    /// a bv_operation
    pub operation: u16,
    pub reserved: u16,
    /// bytes of UTF-8 that follow, without a NUL
    pub text_len: u32,
    /// steps of physics
    pub steps: u64,
    /// the model that is meant; for configure a sensor, or a topic that it sends
    pub name: [c_char; 64],
    /// the frame of what follows: a model, model::link, or nothing for the world
    pub reference: [c_char; 64],
    pub position: [f64; 3],
    /// x y z w
    pub orientation: [f64; 4],
    pub linear: [f64; 3],
    pub angular: [f64; 3],
    /// of what is spawned: stands before its topics and frames; empty for none
    pub robot_namespace: [c_char; 64],
}

/// What became of a command.
#[repr(C)]
pub struct SimulationResult {
    /// the command's
    pub id: u64,
    /// simulated time after it
    pub time_ns: u64,
    /// 1 done, 0 refused
    pub done: u16,
    /// the command's
    pub operation: u16,
    pub reserved: u32,
    /// why it was refused
    pub reason: [c_char; 488],
}

/// Where a model or a link is in the world, and how it moves.
#[repr(C)]
pub struct ModelState {
    /// model, or model::link
    pub name: [c_char; 128],
    pub position: [f64; 3],
    /// x y z w
    pub orientation: [f64; 4],
    pub linear: [f64; 3],
    pub angular: [f64; 3],
}

/// What is seen of a thing, and where all of it is in the optical frame of the sensor: x right, y down, z forward.
#[repr(C)]
pub struct BoundingBox {
    /// its number, as in the picture of instances
    pub instance: u32,
    /// its class, as in the picture of classes
    pub label: u32,
    /// how many pixels show it
    pub pixels: u32,
    /// first column and row
    pub min: [u32; 2],
    /// last column and row
    pub max: [u32; 2],
    pub reserved: u32,
    /// middle of the box that holds the whole of it, metres
    pub position: [f64; 3],
    /// x y z w
    pub orientation: [f64; 4],
    /// edges of that box, metres
    pub size: [f64; 3],
}

/// Where a tag is seen, and its pose in the optical frame of the sensor: its own x right, y up, z towards the reader.
#[repr(C)]
pub struct TagDetection {
    /// as the file says: tag36h11, qr
    pub family: [c_char; 32],
    /// its number in the family
    pub id: u32,
    /// for each corner 1 if it is in the picture and nothing hides it, else 0
    pub visible: [u8; 4],
    /// edge of its square without the white margin, metres
    pub size: f64,
    /// column and row of top left, top right, bottom right, bottom left as one reads it; NaN where the lens has no pixel
    pub corners: [[f64; 2]; 4],
    /// its middle, metres
    pub position: [f64; 3],
    /// x y z w
    pub orientation: [f64; 4],
}

macro_rules! same_layout {
    ($here:ty, $there:ty, $($field:ident)*) => {
        const _: () = {
            assert!(size_of::<$here>() == size_of::<$there>());
            $(assert!(offset_of!($here, $field) == offset_of!($there, $field));)*
        };
    };
}

same_layout!(FrameHeader, wire::FrameHeader, magic header_len schema kind encoding flags seq session stamp_ns
    publish_mono_ns width height row_stride elem_stride payload_len frame_id position orientation block);
same_layout!(Intrinsics, wire::Intrinsics, fx fy cx cy skew distortion near far tx distortion_model
    distortion_len reserved);
same_layout!(ScanGeometry, wire::ScanGeometry, angle_min angle_increment time_increment scan_time range_min
    range_max vertical_angle_min vertical_angle_increment reserved);
same_layout!(CameraInfo, payload::CameraInfo, width height distortion_model d d_len reserved k r p);
same_layout!(Odometry, payload::Odometry, child_frame_id position orientation linear angular pose_covariance
    twist_covariance);
same_layout!(Transform, payload::Transform, parent child translation rotation);
same_layout!(JointState, payload::JointState, name position velocity effort);
same_layout!(Clock, payload::Clock, now_ns);
same_layout!(VelocityCommand, payload::VelocityCommand, linear angular);
same_layout!(Imu, payload::Imu, orientation angular_velocity linear_acceleration orientation_covariance
    angular_velocity_covariance linear_acceleration_covariance);
same_layout!(RobotEvent, payload::RobotEvent, source index state value);
same_layout!(CoreSensors, payload::CoreSensors, time_stamp bumper wheel_drop cliff buttons left_encoder right_encoder
    left_pwm right_pwm charger battery bottom);
same_layout!(ResetOdometry, payload::ResetOdometry, reserved);
same_layout!(MotorPower, payload::MotorPower, state);
same_layout!(Range, payload::Range, radiation_type field_of_view min_range max_range range);
same_layout!(Setting, payload::Setting, value min max);
same_layout!(SensorSettings, payload::SensorSettings, name topics update_rate noise_mean noise_stddev exposure);
same_layout!(SimulationCommand, payload::SimulationCommand, id operation reserved text_len steps name reference
    position orientation linear angular robot_namespace);
same_layout!(SimulationResult, payload::SimulationResult, id time_ns done operation reserved reason);
same_layout!(ModelState, payload::ModelState, name position orientation linear angular);
same_layout!(BoundingBox, payload::BoundingBox, instance label pixels min max reserved position orientation size);
same_layout!(TagDetection, payload::TagDetection, family id visible size corners position orientation);

const _: () = {
    assert!(BV_MAGIC == wire::FrameHeader::MAGIC);
    assert!(BV_SCHEMA == wire::FrameHeader::SCHEMA);
    assert!(BV_HAS_INTENSITIES == wire::FrameHeader::HAS_INTENSITIES);
    assert!(size_of::<Block>() == 208);
    // A kind, encoding or operation that is added there is missing here until this compiles again.
    assert!(wire::Kind::ALL.len() == 23 && Kind::TagDetections as u16 == 23);
    assert!(wire::Encoding::ALL.len() == 21 && Encoding::I32C1 as u16 == 21);
    assert!(wire::DistortionModel::ALL.len() == 8 && DistortionModel::WideAngle as u16 == 8);
    assert!(wire::Operation::ALL.len() == 9 && Operation::Configure as u16 == 9);
};
