/* Belvedere's frames in shared memory, for C and C++. SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * Generated from bridge/src/wire and, by cbindgen, from bridge/c/src; do not edit. The layout of every byte is in
 * bridge/WIRE.md.
 *
 *   bv_node *node;
 *   bv_subscriber *subscriber;
 *   if (bv_node_open(NULL, "me", &node) != BV_STATUS_OK) { puts(bv_last_error()); exit(1); }
 *   bv_subscribe(node, "camera/rgb/image_raw", &subscriber);
 *   while (bv_subscriber_wait(subscriber, 1000) >= 0) {
 *       bv_frame *frame;
 *       while (bv_subscriber_take(subscriber, &frame) == BV_STATUS_OK) {
 *           const bv_frame_header *header = bv_frame_get_header(frame);
 *           const uint8_t *pixels = bv_frame_get_payload(frame);  // the simulator's own memory, not a copy
 *           ...
 *           bv_frame_release(frame);
 *       }
 *   }
 *
 * Functions return a bv_status: 0 for success, 1 if nothing is available, negative for an error, which
 * bv_last_error() describes.
 * A handle may move between threads, but only one may use it at a time. No function unwinds or aborts.
 */

#ifndef BELVEDERE_H
#define BELVEDERE_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

// First field of every frame header: "BLVD" in memory order.
#define BV_MAGIC 1146506306

// Version of the layout in this file.
#define BV_SCHEMA 2

// Flag: a plane of intensities of the same shape follows the ranges, at row_stride * height.
#define BV_HAS_INTENSITIES 1

// Flag: the frame comes from a recording.
#define BV_REPLAYED 2

// The meaning of a stream's payload (bv_frame_header.kind). Numbers are never reused.
enum bv_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint16_t
#endif
 {
    // A colour or grey image; the header carries its intrinsics.
    BV_KIND_IMAGE = 1,
    // Depth along the optical axis; the header carries its intrinsics.
    BV_KIND_DEPTH_IMAGE = 2,
    // One bv_camera_info.
    BV_KIND_CAMERA_INFO = 3,
    // Ranges of a planar or multi-layer lidar; the header carries its angles.
    BV_KIND_LASER_SCAN = 4,
    // Points in the sensor's frame; organised (an image of points) if the height is more than 1.
    BV_KIND_POINT_CLOUD = 5,
    // One bv_odometry.
    BV_KIND_ODOMETRY = 6,
    // An array of bv_transform that are valid at the stamp.
    BV_KIND_TRANSFORMS = 7,
    // An array of bv_transform that never change.
    BV_KIND_STATIC_TRANSFORMS = 8,
    // An array of bv_joint_state.
    BV_KIND_JOINT_STATES = 9,
    // One bv_clock, the simulated time.
    BV_KIND_CLOCK = 10,
    // One bv_velocity_command, to the robot.
    BV_KIND_VELOCITY_COMMAND = 11,
    // One bv_imu.
    BV_KIND_IMU = 12,
    // One bv_robot_event, sent when the state changes.
    BV_KIND_ROBOT_EVENT = 13,
    // One bv_simulation_command, to the simulator; a text may follow it in the
    // payload.
    BV_KIND_SIMULATION_COMMAND = 14,
    // One bv_simulation_result, the result of a command.
    BV_KIND_SIMULATION_RESULT = 15,
    // An array of bv_model_state.
    BV_KIND_MODEL_STATES = 16,
    // One bv_core_sensors.
    BV_KIND_CORE_SENSORS = 17,
    // One bv_reset_odometry, to the robot.
    BV_KIND_RESET_ODOMETRY = 18,
    // One bv_motor_power, to the robot.
    BV_KIND_MOTOR_POWER = 19,
    // One bv_range.
    BV_KIND_RANGE = 20,
    // An array of bv_sensor_settings: the settings of every sensor that has any,
    // valid from the stamp on.
    BV_KIND_SENSOR_SETTINGS = 21,
    // An array of bv_bounding_box, one for each object in an image.
    BV_KIND_BOUNDING_BOXES = 22,
    // An array of bv_tag_detection, one for each tag in an image.
    BV_KIND_TAG_DETECTIONS = 23,
    // One bv_nav_sat_fix.
    BV_KIND_NAV_SAT_FIX = 24,
    // One bv_magnetic_field.
    BV_KIND_MAGNETIC_FIELD = 25,
    // One bv_fluid_pressure.
    BV_KIND_FLUID_PRESSURE = 26,
    // One bv_altimeter.
    BV_KIND_ALTIMETER = 27,
    // One bv_vector3.
    BV_KIND_VECTOR3 = 28,
    // One bv_wrench.
    BV_KIND_WRENCH = 29,
    // An array of bv_contact: all contacts of a sensor since its last frame.
    BV_KIND_CONTACTS = 30,
    // An array of bv_seen_model, one for each model that a logical camera sees.
    BV_KIND_SEEN_MODELS = 31,
    // One bv_pose.
    BV_KIND_POSE = 32,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum bv_kind bv_kind;
#else
typedef uint16_t bv_kind;
#endif
#endif

// The encoding of one element of the payload (bv_frame_header.encoding).
enum bv_encoding
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint16_t
#endif
 {
    // Red, green, blue; 8 bits each.
    BV_ENCODING_RGB8 = 1,
    // Blue, green, red; 8 bits each.
    BV_ENCODING_BGR8 = 2,
    // Grey, 8 bits.
    BV_ENCODING_MONO8 = 3,
    // Depth in metres, 32-bit floats: NaN invalid, −inf too near, +inf no return (REP-118).
    BV_ENCODING_F32C1 = 4,
    // Depth in millimetres, 16 bits: 0 invalid (REP-118).
    BV_ENCODING_U16C1 = 5,
    // A point with a colour. NaN coordinates mean no point.
    // Its 32 bytes:
    // - x at 0, f32: Metres.
    // - y at 4, f32: Metres.
    // - z at 8, f32: Metres.
    // - rgb at 16, u8[4]: Blue, green, red, 0.
    BV_ENCODING_XYZ_RGB_F32 = 6,
    // Ranges in metres, 32-bit floats (REP-117): height layers of width rays. With
    // BV_HAS_INTENSITIES a second plane of the same shape follows
    // at height · row_stride.
    BV_ENCODING_RANGES_F32 = 7,
    // height fixed structs, elem_stride bytes apart; see payload.
    BV_ENCODING_STRUCT = 8,
    // Red, green, blue, and 255; 8 bits each.
    BV_ENCODING_RGBA8 = 9,
    // Grey, 16 bits.
    BV_ENCODING_MONO16 = 10,
    // Bayer mosaic, 8 bits: red and green in the first row, green and blue in the second.
    BV_ENCODING_BAYER_RGGB8 = 11,
    // Bayer mosaic, 8 bits: blue and green in the first row, green and red in the second.
    BV_ENCODING_BAYER_BGGR8 = 12,
    // Bayer mosaic, 8 bits: green and blue in the first row, red and green in the second.
    BV_ENCODING_BAYER_GBRG8 = 13,
    // Bayer mosaic, 8 bits: green and red in the first row, blue and green in the second.
    BV_ENCODING_BAYER_GRBG8 = 14,
    // Bayer mosaic, 16 bits: red and green in the first row, green and blue in the second.
    BV_ENCODING_BAYER_RGGB16 = 15,
    // Bayer mosaic, 16 bits: blue and green in the first row, green and red in the second.
    BV_ENCODING_BAYER_BGGR16 = 16,
    // Bayer mosaic, 16 bits: green and blue in the first row, red and green in the second.
    BV_ENCODING_BAYER_GBRG16 = 17,
    // Bayer mosaic, 16 bits: green and red in the first row, blue and green in the second.
    BV_ENCODING_BAYER_GRBG16 = 18,
    // Two 32-bit floats: optical flow in pixels, to the right and down; NaN where it is undefined.
    BV_ENCODING_F32C2 = 19,
    // Three 32-bit floats: unit normals in the world's axes; 0 where no surface is seen.
    BV_ENCODING_F32C3 = 20,
    // An instance or class number, 32-bit signed; in instance images, −1 where nothing is seen.
    BV_ENCODING_I32C1 = 21,
    // A point in the layout of Velodyne's driver. NaN coordinates mean no point, which occurs only in clouds of
    // several rows.
    // Its 22 bytes:
    // - x at 0, f32: Metres.
    // - y at 4, f32: Metres.
    // - z at 8, f32: Metres.
    // - intensity at 12, f32: Intensity.
    // - ring at 16, u16: Number of the laser, counted from the lowest.
    // - time at 18, f32: Seconds after the stamp.
    BV_ENCODING_XYZ_IRT_F32 = 22,
    // A point in the layout of Ouster's driver. NaN coordinates mean no point. A row is a laser, a column a
    // direction.
    // Its 48 bytes:
    // - x at 0, f32: Metres.
    // - y at 4, f32: Metres.
    // - z at 8, f32: Metres.
    // - intensity at 16, f32: Intensity.
    // - t at 20, u32: Nanoseconds after the stamp.
    // - reflectivity at 24, u16: The intensity, limited to 255.
    // - ring at 26, u16: Number of the laser, counted from the highest.
    // - ambient at 28, u16: 0.
    // - range at 32, u32: Millimetres from the axis; 0 for none.
    BV_ENCODING_OUSTER_POINT = 23,
    // A point in the layout of Livox's driver.
    // Its 26 bytes:
    // - x at 0, f32: Metres.
    // - y at 4, f32: Metres.
    // - z at 8, f32: Metres.
    // - intensity at 12, f32: Intensity, 0 to 255.
    // - tag at 16, u8: The number of the return in bits 4 and 5.
    // - line at 17, u8: Number of the laser.
    // - timestamp at 18, f64: Nanoseconds since time 0.
    BV_ENCODING_LIVOX_POINT = 24,
    // A point in the layout of gz-sim's lidars. NaN coordinates mean no point. A row is a layer.
    // Its 18 bytes:
    // - x at 0, f32: Metres.
    // - y at 4, f32: Metres.
    // - z at 8, f32: Metres.
    // - intensity at 12, f32: Intensity.
    // - ring at 16, u16: Number of the layer, counted from the first vertical angle.
    BV_ENCODING_XYZ_IR_F32 = 25,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum bv_encoding bv_encoding;
#else
typedef uint16_t bv_encoding;
#endif
#endif

// The mapping from directions to pixels by a lens, and the order of its parameters. Names are those of
// sensor_msgs/CameraInfo where ROS has one. With K = (fx, fy, cx, cy), the direction (x, y, z) is seen at the
// pixel (fx·u + cx, fy·v + cy).
enum bv_distortion_model
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint16_t
#endif
 {
    // Brown–Conrady: k1 k2 p1 p2 k3; all 0 for a pinhole. u, v are the distorted x/z, y/z.
    BV_DISTORTION_MODEL_PLUMB_BOB = 1,
    // OpenCV's extensions of Brown–Conrady: k1 k2 p1 p2 k3 k4 k5 k6, then the thin prism s1 s2 s3 s4, then the
    // tilts τx τy; 8, 12 or 14 parameters.
    BV_DISTORTION_MODEL_RATIONAL_POLYNOMIAL = 2,
    // Kannala–Brandt, OpenCV's fisheye model: k1 k2 k3 k4 in θ + k1 θ³ + k2 θ⁵ + k3 θ⁷ + k4 θ⁹.
    BV_DISTORTION_MODEL_EQUIDISTANT = 3,
    // Extended unified camera model: alpha beta. ROS has no name for this model or for the following ones.
    BV_DISTORTION_MODEL_EUCM = 4,
    // Double sphere: xi alpha.
    BV_DISTORTION_MODEL_DOUBLE_SPHERE = 5,
    // Mei's unified model: xi k1 k2 p1 p2.
    BV_DISTORTION_MODEL_MEI = 6,
    // Columns are angles about the camera's y, rows are elevations: u = atan2(x, z), v = atan2(y, √(x² + z²)).
    BV_DISTORTION_MODEL_EQUIRECTANGULAR = 7,
    // SDF's wide-angle lens: c1 c2 c3 f fun cutoff. The radius is c1·f·fun(θ/c2 + c3), f in pixels; fun is 0 for
    // sin, 1 for tan, 2 for the identity. Directions beyond the cutoff angle are not seen. K holds the scale at
    // the centre.
    BV_DISTORTION_MODEL_WIDE_ANGLE = 8,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum bv_distortion_model bv_distortion_model;
#else
typedef uint16_t bv_distortion_model;
#endif
#endif

// An operation on a simulation (bv_simulation_command.operation). Numbers are never reused; a simulator refuses one
// that it does not know.
enum bv_operation
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint16_t
#endif
 {
    // Pause simulated time.
    BV_OPERATION_PAUSE = 1,
    // Resume simulated time.
    BV_OPERATION_RESUME = 2,
    // Run steps physics steps and publish everything that is due, then pause.
    BV_OPERATION_STEP = 3,
    // Return every model to its initial pose, at rest; time continues.
    BV_OPERATION_RESET_WORLD = 4,
    // Restart at time 0; the output is the same as after a fresh start.
    BV_OPERATION_RESET_SIMULATION = 5,
    // Set the pose and velocity of the model name, in the frame reference.
    BV_OPERATION_SET_MODEL_STATE = 6,
    // Add the model in the text (URDF or SDF) to the world as name, at a pose in the frame reference.
    BV_OPERATION_SPAWN = 7,
    // Remove the model name from the world.
    BV_OPERATION_DELETE = 8,
    // Change settings of the sensor name, or of the sensor that publishes the topic name: key=value words in
    // the text.
    BV_OPERATION_CONFIGURE = 9,
    // Change nothing. The result's reason holds words that describe the simulation and, if there is a name, that
    // model.
    BV_OPERATION_QUERY = 10,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum bv_operation bv_operation;
#else
typedef uint16_t bv_operation;
#endif
#endif

// The mapping from pixels to directions; the block of images, depth images and organised clouds.
typedef struct bv_intrinsics {
    // Horizontal focal length, pixels.
    double fx;
    // Vertical focal length, pixels.
    double fy;
    // Column of the principal point. Pixel centres are integers, so that of a centred image is (width − 1) / 2.
    double cx;
    // Row of the principal point.
    double cy;
    // Skew, K[1]: pixels along a row per unit of y.
    double skew;
    // Parameters of the model, in the order of bv_distortion_model; the first distortion_len are valid.
    double distortion[14];
    // Smallest measured depth, metres.
    float near;
    // Largest measured depth, metres.
    float far;
    // P[3] = −fx · baseline of a stereo partner, else 0.
    float tx;
    // A bv_distortion_model by its number; 0 for none.
    uint16_t distortion_model;
    // Number of valid values in distortion.
    uint16_t distortion_len;
    // Reserved; 0.
    uint64_t reserved[5];
} bv_intrinsics;

// Angles and limits of a lidar; the block of scans. Angles are in radians: horizontal ones counter-clockwise about
// +z from +x, vertical ones up.
typedef struct bv_scan_geometry {
    // Angle of the first ray of a layer.
    double angle_min;
    // Angle from one ray to the next.
    double angle_increment;
    // Seconds from one ray to the next.
    double time_increment;
    // Seconds from one scan to the next.
    double scan_time;
    // Smallest measured range, metres.
    float range_min;
    // Largest measured range, metres.
    float range_max;
    // Elevation of the first layer.
    double vertical_angle_min;
    // Elevation from one layer to the next.
    double vertical_angle_increment;
    // Reserved; 0.
    uint64_t reserved[19];
} bv_scan_geometry;

// The block that is specific to the kind.
typedef union bv_block {
    // images, depth images, clouds
    struct bv_intrinsics intrinsics;
    // scans
    struct bv_scan_geometry scan;
    uint64_t raw[26];
} bv_block;

// The header of a frame: its content, the time and pose of its capture, and its layout in memory.
//
// It is aligned to 64 bytes, so that the payload behind it starts on a cache line and a SIMD register boundary.
typedef struct bv_frame_header {
    // BV_MAGIC.
    uint32_t magic;
    // Size of the header: 384.
    uint16_t header_len;
    // BV_SCHEMA.
    uint16_t schema;
    // A bv_kind by its number.
    uint16_t kind;
    // An bv_encoding by its number.
    uint16_t encoding;
    // BV_HAS_INTENSITIES, BV_REPLAYED; other bits are 0.
    uint32_t flags;
    // Sequence number of the frame within one life of its publisher, from 0. Set by send.
    uint64_t seq;
    // Random number of the publisher's life: a new value means that seq restarted. Set by loan.
    uint64_t session;
    // Time of capture in simulated time, nanoseconds since the simulation started.
    uint64_t stamp_ns;
    // Time of sending by CLOCK_MONOTONIC, nanoseconds. Set by send.
    uint64_t publish_mono_ns;
    // Elements per row: pixels, rays, points; 1 for structs.
    uint32_t width;
    // Rows: image rows, lidar layers; the number of structs.
    uint32_t height;
    // Bytes from one row to the next.
    uint32_t row_stride;
    // Bytes from one element to the next.
    uint32_t elem_stride;
    // Valid bytes of the payload. Set by loan.
    uint64_t payload_len;
    // The coordinate frame of the data.
    char frame_id[64];
    // world_from_sensor: the sensor's origin in the world at stamp_ns, metres.
    double position[3];
    // world_from_sensor: its orientation, x y z w.
    float orientation[4];
    // The block that is specific to the kind: bv_intrinsics or bv_scan_geometry.
    union bv_block block;
} bv_frame_header;

// The calibration of a camera, as in sensor_msgs/CameraInfo.
typedef struct bv_camera_info {
    // Pixels per row.
    uint32_t width;
    // Rows.
    uint32_t height;
    // The name of a bv_distortion_model; empty without distortion.
    char distortion_model[32];
    // Distortion parameters in the order of the model; the first d_len are valid.
    double d[14];
    // Number of valid values in d.
    uint32_t d_len;
    // Reserved; 0.
    uint32_t reserved;
    // Intrinsic matrix of the raw image, row by row.
    double k[9];
    // Rectification rotation, row by row.
    double r[9];
    // Projection matrix of the rectified image, 3 × 4, row by row.
    double p[12];
} bv_camera_info;

// Pose and velocity of a body, as in nav_msgs/Odometry: the pose is in the header's frame_id, the velocity in
// child_frame_id.
typedef struct bv_odometry {
    // The body's frame.
    char child_frame_id[64];
    // Position, metres.
    double position[3];
    // Orientation, x y z w.
    double orientation[4];
    // Linear velocity, metres per second.
    double linear[3];
    // Angular velocity, radians per second.
    double angular[3];
    // Covariance of the pose, 6 × 6 row by row: x y z, then rotations about x y z.
    double pose_covariance[36];
    // Covariance of the velocity, 6 × 6 row by row: linear x y z, then angular x y z.
    double twist_covariance[36];
} bv_odometry;

// A transform between two frames: point_in_parent = parent_from_child · point_in_child.
typedef struct bv_transform {
    // The reference frame.
    char parent[64];
    // The frame whose pose is given.
    char child[64];
    // The child's origin in the parent, metres.
    double translation[3];
    // The child's orientation in the parent, x y z w.
    double rotation[4];
} bv_transform;

// The state of one joint.
typedef struct bv_joint_state {
    // The joint's name in the robot description.
    char name[64];
    // Position, radians or metres.
    double position;
    // Velocity, radians or metres per second.
    double velocity;
    // Effort, newton metres or newtons.
    double effort;
} bv_joint_state;

// The simulated time.
typedef struct bv_clock {
    // Nanoseconds since the simulation started.
    uint64_t now_ns;
} bv_clock;

// A commanded velocity of the robot in its own frame, as in geometry_msgs/Twist.
typedef struct bv_velocity_command {
    // Linear velocity: x forward, y left, z up; metres per second.
    double linear[3];
    // Angular velocity about x, y, z; radians per second.
    double angular[3];
} bv_velocity_command;

// The measurement of an inertial measurement unit, as in sensor_msgs/Imu, in the header's frame_id.
// Covariances are 3 × 3 row by row. All zeros mean an unknown covariance; −1 as the first element means that there
// is no measurement (REP-145).
typedef struct bv_imu {
    // Orientation, x y z w.
    double orientation[4];
    // Angular velocity, radians per second.
    double angular_velocity[3];
    // Linear acceleration, metres per second²; +g upwards at rest.
    double linear_acceleration[3];
    // Covariance of the orientation about x, y, z.
    double orientation_covariance[9];
    // Covariance of the angular velocity about x, y, z.
    double angular_velocity_covariance[9];
    // Covariance of the linear acceleration along x, y, z.
    double linear_acceleration_covariance[9];
} bv_imu;

// A change of state of a base's bumper, cliff sensor or wheel (kobuki_msgs/BumperEvent, CliffEvent,
// WheelDropEvent).
typedef struct bv_robot_event {
    // bv_robot_event.BUMPER, bv_robot_event.CLIFF or bv_robot_event.WHEEL_DROP.
    uint32_t source;
    // bv_robot_event.LEFT, bv_robot_event.CENTRE or bv_robot_event.RIGHT. (kobuki_msgs numbers the right wheel 1.)
    uint32_t index;
    // The new state: 0 released, floor, raised; 1 pressed, cliff, dropped.
    uint32_t state;
    // The reading of a cliff sensor, as in bv_core_sensors.bottom; 0 for other sources.
    uint32_t value;
} bv_robot_event;

// The state of a base's own sensors, 50 times a second (kobuki_msgs/SensorState). In the bits of bumper and
// cliff, 1 is right, 2 is centre, 4 is left; in those of the wheels, 1 is right, 2 is left.
typedef struct bv_core_sensors {
    // Time in milliseconds; wraps around.
    uint16_t time_stamp;
    // Bits of the pressed bumpers.
    uint8_t bumper;
    // Bits of the dropped wheels.
    uint8_t wheel_drop;
    // Bits of the cliff sensors that see no floor.
    uint8_t cliff;
    // Bits of the pressed buttons: 1, 2, 4.
    uint8_t buttons;
    // Ticks of the left wheel; wraps around.
    uint16_t left_encoder;
    // Ticks of the right wheel; wraps around.
    uint16_t right_encoder;
    // Duty cycle of the left motor; always 0, since it is not simulated.
    int8_t left_pwm;
    // Duty cycle of the right motor; always 0, since it is not simulated.
    int8_t right_pwm;
    // State of charge control: 0 discharging, 2 charged, 6 charging; plus 16 if an adapter is connected.
    uint8_t charger;
    // Battery voltage in tenths of a volt.
    uint8_t battery;
    // Readings of the cliff sensors' 12-bit converters: right, centre, left; smaller is farther.
    uint16_t bottom[3];
} bv_core_sensors;

// A command to restart odometry at zero from the current pose.
typedef struct bv_reset_odometry {
    // Reserved; 0.
    uint64_t reserved;
} bv_reset_odometry;

// A command to enable or disable the motors (kobuki_msgs/MotorPower).
typedef struct bv_motor_power {
    // 0 off, else on.
    uint32_t state;
} bv_motor_power;

// A point at which two collision shapes touch each other. The contacts of a pair follow each other.
typedef struct bv_contact {
    // The collision that the sensor watches, as in Gazebo: MODEL::LINK::COLLISION.
    char collision1[128];
    // The other collision.
    char collision2[128];
    // The point, metres.
    double position[3];
    // Unit normal of the contact, which points into the first collision.
    double normal[3];
    // Depth to which the shapes overlap, metres.
    double depth;
    // Force on the first collision, newtons.
    double force[3];
    // Torque of that force about the centre of mass of the first collision's body, newton metres.
    double torque[3];
} bv_contact;

// A command to a simulator. A text of text_len bytes follows it in the payload.
typedef struct bv_simulation_command {
    // A random number chosen by the sender; the result repeats it.
    uint64_t id;
    // The number of an bv_operation.
    uint16_t operation;
    // Reserved; 0.
    uint16_t reserved;
    // Length of the UTF-8 text that follows this struct, without a NUL: the model to be spawned, or the settings
    // to be changed. 0 for other operations.
    uint32_t text_len;
    // Number of physics steps to run.
    uint64_t steps;
    // Name of the model; for settings, name of the sensor or of a topic that it publishes.
    char name[64];
    // The reference frame of pose and velocity: a model, model::link, or empty for the world.
    char reference[64];
    // Position of the model's frame, metres.
    double position[3];
    // Orientation of the model's frame, x y z w; four zeros mean no rotation.
    double orientation[4];
    // Velocity of the model's origin along the axes of the reference, metres per second.
    double linear[3];
    // Angular velocity about the axes of the reference, radians per second.
    double angular[3];
    // Prefix of the topics and frames of a spawned robot; empty for none.
    char robot_namespace[64];
} bv_simulation_command;

// The result of a bv_simulation_command.
typedef struct bv_simulation_result {
    // The id of the command.
    uint64_t id;
    // Simulated time after the command.
    uint64_t time_ns;
    // 1 if the command was executed, 0 if it was refused.
    uint16_t done;
    // The operation of the command.
    uint16_t operation;
    // Reserved; 0.
    uint32_t reserved;
    // The reason for a refusal, or the answer to a query; empty otherwise.
    char reason[488];
} bv_simulation_result;

// The pose and velocity of a model or a link.
typedef struct bv_model_state {
    // The model's name, or model::link for a link. It is twice as long as other names, since it is made of two.
    char name[128];
    // Position in the world, metres.
    double position[3];
    // Orientation in the world, x y z w.
    double orientation[4];
    // Velocity of its origin along the world's axes, metres per second.
    double linear[3];
    // Angular velocity about the world's axes, radians per second.
    double angular[3];
} bv_model_state;

// A position on the earth, as in sensor_msgs/NavSatFix, with the velocity.
typedef struct bv_nav_sat_fix {
    // Geodetic latitude in degrees, WGS 84.
    double latitude;
    // Longitude in degrees, positive to the east.
    double longitude;
    // Height above the ellipsoid in metres.
    double altitude;
    // Velocity to the east, to the north and up, in metres per second.
    double velocity[3];
    // Covariance of the position to the east, to the north and up, in m², row by row.
    double position_covariance[9];
} bv_nav_sat_fix;

// A magnetic field, as in sensor_msgs/MagneticField.
typedef struct bv_magnetic_field {
    // The field in teslas.
    double magnetic_field[3];
    // Its covariance, row by row.
    double covariance[9];
} bv_magnetic_field;

// A pressure, as in sensor_msgs/FluidPressure.
typedef struct bv_fluid_pressure {
    // Absolute pressure in pascals.
    double fluid_pressure;
    // Its variance in Pa².
    double variance;
} bv_fluid_pressure;

// A height and a vertical velocity, as in gz-sim's altimeter.
typedef struct bv_altimeter {
    // Height above the reference in metres.
    double vertical_position;
    // Vertical velocity in metres per second.
    double vertical_velocity;
    // Height of the reference in the world in metres.
    double vertical_reference;
    // Variance of the height in m².
    double variance;
} bv_altimeter;

// A vector, as in geometry_msgs/Vector3Stamped. The topic defines its meaning.
typedef struct bv_vector3 {
    // Components x y z.
    double vector[3];
} bv_vector3;

// A force and a torque, as in geometry_msgs/WrenchStamped, along the axes of the header's frame_id and about its
// origin.
typedef struct bv_wrench {
    // Force in newtons.
    double force[3];
    // Torque in newton metres.
    double torque[3];
} bv_wrench;

// A distance to the nearest surface within the field of view, as in sensor_msgs/Range.
typedef struct bv_range {
    // 0 ultrasound, 1 infrared.
    uint32_t radiation_type;
    // Full angle of the measured cone, radians.
    float field_of_view;
    // Smallest measured distance, metres.
    float min_range;
    // Largest measured distance, metres.
    float max_range;
    // The distance, metres. Out of range: −inf too near, +inf nothing in range (REP-117), unless the sensor's
    // description specifies other values.
    float range;
} bv_range;

// The value and limits of a setting; all three are NaN if the sensor does not have the setting.
typedef struct bv_setting {
    // The current value.
    double value;
    // The smallest allowed value.
    double min;
    // The largest allowed value.
    double max;
} bv_setting;

// The settings of one sensor, under the names by which the operation Configure
// changes them.
typedef struct bv_sensor_settings {
    // The sensor's name in the robot's description.
    char name[64];
    // The topics that it publishes, without leading slashes; unused entries are empty.
    char topics[6][256];
    // Frames per second.
    struct bv_setting update_rate;
    // Mean of the noise: of colours in [0, 1] for a camera, of ranges in metres for a lidar.
    struct bv_setting noise_mean;
    // Standard deviation of the noise, in the same unit.
    struct bv_setting noise_stddev;
    // Exposure of a camera, relative to its description: 1 is as described.
    struct bv_setting exposure;
} bv_sensor_settings;

// The visible and the complete extent of an object. The pose is in the optical frame of the sensor (x right, y
// down, z forward) at the header's stamp.
typedef struct bv_bounding_box {
    // Instance number, as in the instance image.
    uint32_t instance;
    // Class number, as in the class image.
    uint32_t label;
    // Number of visible pixels.
    uint32_t pixels;
    // First column and row of the visible pixels.
    uint32_t min[2];
    // Last column and row of the visible pixels, inclusive.
    uint32_t max[2];
    // Reserved; 0.
    uint32_t reserved;
    // Centre of the oriented box around the complete object, metres.
    double position[3];
    // Orientation of that box, x y z w.
    double orientation[4];
    // Edge lengths of that box, metres.
    double size[3];
} bv_bounding_box;

// A fiducial tag with at least one corner in the image that is not occluded. The pose is in the optical frame of
// the sensor (x right, y down, z forward) at the header's stamp. The tag's own x is to the right and y up as one
// reads it, and z points towards the reader, as in OpenCV's ArUco.
typedef struct bv_tag_detection {
    // The tag family, as in the world file: tag36h11, qr.
    char family[32];
    // Its number in the family.
    uint32_t id;
    // For each corner, 1 if it is in the image and not occluded, else 0.
    uint8_t visible[4];
    // Edge length of its square without the white margin, metres.
    double size;
    // Column and row of each corner at the time its row is exposed, with pixel centres at integers: top left, top
    // right, bottom right, bottom left as one reads it (OpenCV's ArUco). NaN if no pixel of the lens sees in
    // that direction.
    double corners[4][2];
    // Centre of the tag, metres.
    double position[3];
    // Orientation of the tag, x y z w.
    double orientation[4];
} bv_tag_detection;

// A model in the frustum of a logical camera, with its pose in the frame of the camera (x forward, y left, z up).
typedef struct bv_seen_model {
    // The model's name in the world.
    char name[128];
    // The origin of the model's frame, metres.
    double position[3];
    // Orientation of the model's frame, x y z w.
    double orientation[4];
} bv_seen_model;

// A pose in the header's frame_id, as in geometry_msgs/PoseStamped.
typedef struct bv_pose {
    // Position, metres.
    double position[3];
    // Orientation, x y z w.
    double orientation[4];
} bv_pose;

// Applies X to every struct and its size in bytes.
#define BV_STRUCTS(X) \
    X(bv_frame_header, 384) \
    X(bv_intrinsics, 208) \
    X(bv_scan_geometry, 208) \
    X(bv_camera_info, 400) \
    X(bv_odometry, 744) \
    X(bv_transform, 184) \
    X(bv_joint_state, 88) \
    X(bv_clock, 8) \
    X(bv_velocity_command, 48) \
    X(bv_imu, 296) \
    X(bv_robot_event, 16) \
    X(bv_core_sensors, 20) \
    X(bv_reset_odometry, 8) \
    X(bv_motor_power, 4) \
    X(bv_contact, 360) \
    X(bv_simulation_command, 320) \
    X(bv_simulation_result, 512) \
    X(bv_model_state, 232) \
    X(bv_nav_sat_fix, 120) \
    X(bv_magnetic_field, 96) \
    X(bv_fluid_pressure, 16) \
    X(bv_altimeter, 32) \
    X(bv_vector3, 24) \
    X(bv_wrench, 48) \
    X(bv_range, 20) \
    X(bv_setting, 24) \
    X(bv_sensor_settings, 1696) \
    X(bv_bounding_box, 112) \
    X(bv_tag_detection, 168) \
    X(bv_seen_model, 184) \
    X(bv_pose, 56)

// Applies X to every struct that streams carry, and the kind of these streams.
#define BV_PAYLOADS(X) \
    X(bv_camera_info, BV_KIND_CAMERA_INFO) \
    X(bv_odometry, BV_KIND_ODOMETRY) \
    X(bv_transform, BV_KIND_TRANSFORMS) \
    X(bv_transform, BV_KIND_STATIC_TRANSFORMS) \
    X(bv_joint_state, BV_KIND_JOINT_STATES) \
    X(bv_clock, BV_KIND_CLOCK) \
    X(bv_velocity_command, BV_KIND_VELOCITY_COMMAND) \
    X(bv_imu, BV_KIND_IMU) \
    X(bv_robot_event, BV_KIND_ROBOT_EVENT) \
    X(bv_core_sensors, BV_KIND_CORE_SENSORS) \
    X(bv_reset_odometry, BV_KIND_RESET_ODOMETRY) \
    X(bv_motor_power, BV_KIND_MOTOR_POWER) \
    X(bv_contact, BV_KIND_CONTACTS) \
    X(bv_simulation_command, BV_KIND_SIMULATION_COMMAND) \
    X(bv_simulation_result, BV_KIND_SIMULATION_RESULT) \
    X(bv_model_state, BV_KIND_MODEL_STATES) \
    X(bv_nav_sat_fix, BV_KIND_NAV_SAT_FIX) \
    X(bv_magnetic_field, BV_KIND_MAGNETIC_FIELD) \
    X(bv_fluid_pressure, BV_KIND_FLUID_PRESSURE) \
    X(bv_altimeter, BV_KIND_ALTIMETER) \
    X(bv_vector3, BV_KIND_VECTOR3) \
    X(bv_wrench, BV_KIND_WRENCH) \
    X(bv_range, BV_KIND_RANGE) \
    X(bv_sensor_settings, BV_KIND_SENSOR_SETTINGS) \
    X(bv_bounding_box, BV_KIND_BOUNDING_BOXES) \
    X(bv_tag_detection, BV_KIND_TAG_DETECTIONS) \
    X(bv_seen_model, BV_KIND_SEEN_MODELS) \
    X(bv_pose, BV_KIND_POSE)

// Applies X to every encoding of points: the constant, the size of a point in bytes, and whether a cloud of one
// row has no NaN coordinates.
#define BV_POINTS(X) \
    X(BV_ENCODING_XYZ_RGB_F32, 32, false) \
    X(BV_ENCODING_XYZ_IRT_F32, 22, true) \
    X(BV_ENCODING_OUSTER_POINT, 48, false) \
    X(BV_ENCODING_LIVOX_POINT, 26, true) \
    X(BV_ENCODING_XYZ_IR_F32, 18, false)

// Applies X to every field of points: the constant of the encoding, name, offset in bytes, and type by its name in
// sensor_msgs/PointField.
#define BV_POINT_FIELDS(X) \
    X(BV_ENCODING_XYZ_RGB_F32, "x", 0, FLOAT32) \
    X(BV_ENCODING_XYZ_RGB_F32, "y", 4, FLOAT32) \
    X(BV_ENCODING_XYZ_RGB_F32, "z", 8, FLOAT32) \
    X(BV_ENCODING_XYZ_RGB_F32, "rgb", 16, FLOAT32) \
    X(BV_ENCODING_XYZ_IRT_F32, "x", 0, FLOAT32) \
    X(BV_ENCODING_XYZ_IRT_F32, "y", 4, FLOAT32) \
    X(BV_ENCODING_XYZ_IRT_F32, "z", 8, FLOAT32) \
    X(BV_ENCODING_XYZ_IRT_F32, "intensity", 12, FLOAT32) \
    X(BV_ENCODING_XYZ_IRT_F32, "ring", 16, UINT16) \
    X(BV_ENCODING_XYZ_IRT_F32, "time", 18, FLOAT32) \
    X(BV_ENCODING_OUSTER_POINT, "x", 0, FLOAT32) \
    X(BV_ENCODING_OUSTER_POINT, "y", 4, FLOAT32) \
    X(BV_ENCODING_OUSTER_POINT, "z", 8, FLOAT32) \
    X(BV_ENCODING_OUSTER_POINT, "intensity", 16, FLOAT32) \
    X(BV_ENCODING_OUSTER_POINT, "t", 20, UINT32) \
    X(BV_ENCODING_OUSTER_POINT, "reflectivity", 24, UINT16) \
    X(BV_ENCODING_OUSTER_POINT, "ring", 26, UINT16) \
    X(BV_ENCODING_OUSTER_POINT, "ambient", 28, UINT16) \
    X(BV_ENCODING_OUSTER_POINT, "range", 32, UINT32) \
    X(BV_ENCODING_LIVOX_POINT, "x", 0, FLOAT32) \
    X(BV_ENCODING_LIVOX_POINT, "y", 4, FLOAT32) \
    X(BV_ENCODING_LIVOX_POINT, "z", 8, FLOAT32) \
    X(BV_ENCODING_LIVOX_POINT, "intensity", 12, FLOAT32) \
    X(BV_ENCODING_LIVOX_POINT, "tag", 16, UINT8) \
    X(BV_ENCODING_LIVOX_POINT, "line", 17, UINT8) \
    X(BV_ENCODING_LIVOX_POINT, "timestamp", 18, FLOAT64) \
    X(BV_ENCODING_XYZ_IR_F32, "x", 0, FLOAT32) \
    X(BV_ENCODING_XYZ_IR_F32, "y", 4, FLOAT32) \
    X(BV_ENCODING_XYZ_IR_F32, "z", 8, FLOAT32) \
    X(BV_ENCODING_XYZ_IR_F32, "intensity", 12, FLOAT32) \
    X(BV_ENCODING_XYZ_IR_F32, "ring", 16, UINT16)

// The largest number of streams of a set.
#define BV_SYNCHRONIZER_MAX 8

// The result of a call. Negative values are errors, which bv_last_error() describes.
enum bv_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Success.
    BV_STATUS_OK = 0,
    // Nothing is available: the timeout passed without a frame, or no frame is queued.
    BV_STATUS_NOTHING = 1,
    // A pointer is null, a text is not UTF-8, or a number is out of range.
    BV_STATUS_INVALID_ARGUMENT = -1,
    // The name of a domain or topic is unusable.
    BV_STATUS_INVALID_NAME = -2,
    // Another process publishes this stream already.
    BV_STATUS_DOMAIN_IN_USE = -3,
    // The stream is of another version, is not a Belvedere stream, or is kept open with the settings of an earlier
    // publisher.
    BV_STATUS_INCOMPATIBLE = -4,
    // The shared memory belongs to another user.
    BV_STATUS_PERMISSION = -5,
    // /dev/shm is too small.
    BV_STATUS_SHARED_MEMORY_TOO_SMALL = -6,
    // A limit is reached: publishers or subscribers of the stream, frames held at a time, or open files of the
    // process.
    BV_STATUS_LIMIT = -7,
    // The header of a frame is invalid; the frame was dropped.
    BV_STATUS_BAD_FRAME = -8,
    // The transport (iceoryx2 or the system) failed.
    BV_STATUS_TRANSPORT = -9,
    // A defect in Belvedere; please report it.
    BV_STATUS_INTERNAL = -10,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum bv_status bv_status;
#else
typedef int32_t bv_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The sending end of a stream of commands to the robot.
typedef struct bv_command_publisher bv_command_publisher;

// The client side of simulation control.
typedef struct bv_control bv_control;

// A received frame in shared memory, which does not change until it is released. Its header has been checked: rows and
// structs lie within the payload.
typedef struct bv_frame bv_frame;

// Membership of a domain.
typedef struct bv_node bv_node;

// The conversion of a stream's frames to messages of ROS 1.
typedef struct bv_ros1_message bv_ros1_message;

// The reading end of a stream. It may exist before its publisher and after it.
typedef struct bv_subscriber bv_subscriber;

// A synchroniser, which returns frames of several streams that were captured at the same time: an image with its depth
// image and its camera_info.
//
// The stamps are in simulated time. Each frame is in at most one set, sets come in order, and a frame that cannot find
// a partner any more is skipped. It holds at most one frame of each stream. A subscriber may hold two, so one set may
// be kept while the next is awaited.
typedef struct bv_synchronizer bv_synchronizer;

// The sending end of a velocity command stream.
typedef struct bv_velocity_publisher bv_velocity_publisher;

// An existing stream.
typedef struct bv_stream_info {
    // without a leading slash
    char topic[256];
    // coordinate frame of the data
    char frame_id[64];
    // intended rate; 0 if the stream has no fixed rate
    double rate_hz;
    // largest payload in bytes
    uint64_t max_payload_len;
    // publishers now
    uint32_t publishers;
    // subscribers now
    uint32_t subscribers;
    // a bv_kind; 0 unknown
    uint16_t kind;
    // a bv_encoding; 0 unknown
    uint16_t encoding;
    // layers of a lidar; 0 unknown
    uint32_t layers;
} bv_stream_info;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Returns a description of the last error in this thread; empty if there was none. Valid until the next failing call
// in this thread.
const char *bv_last_error(void);

// Returns Belvedere's version, such as "0.1.0".
const char *bv_version(void);

// Returns CLOCK_MONOTONIC in nanoseconds, to compare with publish_mono_ns of a header.
uint64_t bv_mono_ns(void);

// Joins a domain under a name, which listings show. If the domain is NULL, it is that of the environment variable
// BELVEDERE_DOMAIN, or "default". Close the node with bv_node_close; objects made from it remain usable after that.
// Requires: The texts are NUL-terminated or NULL; `out` can be written.
bv_status bv_node_open(const char *domain,
                       const char *name,
                       struct bv_node **out);

// Leaves the domain; NULL is ignored.
// Requires: `node` came from bv_node_open and is not used afterwards.
void bv_node_close(struct bv_node *node);

// Lists the streams of the domain, by topic. Free the array with bv_streams_free.
// Requires: `node` is open; `out` and `count` can be written.
bv_status bv_streams(struct bv_node *node, struct bv_stream_info **out, size_t *count);

// Frees an array from bv_streams; NULL is ignored.
// Requires: `streams` and `count` came from one call of bv_streams and are not used afterwards.
void bv_streams_free(struct bv_stream_info *streams, size_t count);

// Subscribes to a stream, which may be created later. A leading slash of the topic is ignored. If the publisher ends
// or is killed, and starts again, the subscriber continues with the new one.
// Requires: `node` is open; `topic` is NUL-terminated; `out` can be written.
bv_status bv_subscribe(struct bv_node *node,
                       const char *topic,
                       struct bv_subscriber **out);

// Closes the subscription; NULL is ignored. Frames that are held remain valid.
// Requires: `subscriber` came from bv_subscribe and is not used afterwards.
void bv_subscriber_close(struct bv_subscriber *subscriber);

// Sleeps until a frame is available. Returns BV_STATUS_OK, or BV_STATUS_NOTHING if the timeout passes, or a signal
// arrives, without one.
// Requires: `subscriber` is open.
bv_status bv_subscriber_wait(struct bv_subscriber *subscriber,
                             uint32_t timeout_ms);

// Enables busy polling: when a frame is due, the subscriber polls for it without sleeping, for at most `limit_us` per
// frame. 0, the default, disables it.
//
// The system takes 30 to 100 us to wake a process, which is most of the latency of a frame. With busy polling, a
// process that sleeps in bv_subscriber_wait, or calls bv_subscriber_take in a loop that polls bv_subscriber_fd, begins
// to poll shortly before the next frame of a periodic stream is due, as predicted from the previous send times. It has
// the frame a few microseconds after it was sent. Frames that arrive much earlier or later, or without a period, wake
// the process as usual.
//
// The cost is processor time for each frame: three mean deviations of the send times, at least 0.15 ms and at most
// half of `limit_us`. On a single core it does nothing.
// Requires: `subscriber` is open.
bv_status bv_subscriber_set_busy_poll(struct bv_subscriber *subscriber,
                                      uint32_t limit_us);

// Writes a descriptor for the poll, select or epoll of another event loop. It is the same over the subscriber's whole
// life, and only bv_subscriber_close closes it. It is readable if frames may be queued or the publisher must be
// checked: then call bv_subscriber_take until it returns BV_STATUS_NOTHING. Do not read from it.
// Requires: `subscriber` is open; `fd` can be written.
bv_status bv_subscriber_fd(struct bv_subscriber *subscriber,
                           int *fd);

// Takes the oldest queued frame; BV_STATUS_NOTHING if there is none (`*out` is NULL then). Never sleeps. Two frames
// may be held at a time, or as many as the publisher allows.
// Requires: `subscriber` is open; `out` can be written.
bv_status bv_subscriber_take(struct bv_subscriber *subscriber,
                             struct bv_frame **out);

// Takes the newest queued frame and drops older ones; otherwise like bv_subscriber_take.
// Requires: `subscriber` is open; `out` can be written.
bv_status bv_subscriber_take_newest(struct bv_subscriber *subscriber, struct bv_frame **out);

// Returns the number of frames that were sent and never taken, over this subscriber's life.
// Requires: `subscriber` is open or NULL.
uint64_t bv_subscriber_missed_total(struct bv_subscriber *subscriber);

// Returns the number of publishers now: 0 before the first, and after the last has ended or was found dead.
// Requires: `subscriber` is open or NULL.
size_t bv_subscriber_publishers(struct bv_subscriber *subscriber);

// Returns the nanoseconds since the last frame: a long silence is the only reliable sign that a stream has stopped.
// Requires: `subscriber` is open or NULL.
uint64_t bv_subscriber_silence_ns(struct bv_subscriber *subscriber);

// Returns the header of a frame.
// Requires: `frame` is held, or NULL, for which NULL is returned.
const struct bv_frame_header *bv_frame_get_header(const struct bv_frame *frame);

// Returns the payload of a frame: payload_len bytes, aligned to 64.
// Requires: `frame` is held, or NULL, for which NULL is returned.
const uint8_t *bv_frame_get_payload(const struct bv_frame *frame);

// Returns the number of frames that were sent between the previously taken frame and this one.
// Requires: `frame` is held or NULL.
uint64_t bv_frame_missed(const struct bv_frame *frame);

// Returns true if the frame comes from another life of the publisher than the previous one: the simulator was
// restarted.
// Requires: `frame` is held or NULL.
bool bv_frame_restarted(const struct bv_frame *frame);

// Returns true if the frame was sent before this subscriber connected, and was kept for it: its age then does not show
// the latency.
// Requires: `frame` is held or NULL.
bool bv_frame_is_from_history(const struct bv_frame *frame);

// Returns the nanoseconds since the frame was sent.
// Requires: `frame` is held or NULL.
uint64_t bv_frame_age_ns(const struct bv_frame *frame);

// Releases the frame; NULL is ignored.
// Requires: `frame` came from a take; it, its header and its payload are not used afterwards.
void bv_frame_release(struct bv_frame *frame);

// Opens a synchroniser of `count` streams, 2 to BV_SYNCHRONIZER_MAX, which may be created later. The stamps of a set
// differ by at most `tolerance_ns`: 0 for frames captured at the same time, more for sensors of different rates.
// Requires: `node` is open; `topics` has `count` NUL-terminated texts; `out` can be written.
bv_status bv_synchronizer_open(struct bv_node *node,
                               const char *const *topics,
                               size_t count,
                               uint64_t tolerance_ns,
                               struct bv_synchronizer **out);

// Closes the synchroniser; NULL is ignored. Frames that are held remain valid.
// Requires: `synchronizer` came from bv_synchronizer_open and is not used afterwards.
void bv_synchronizer_close(struct bv_synchronizer *synchronizer);

// Sleeps until a set is available. Returns BV_STATUS_OK, or BV_STATUS_NOTHING if the timeout passes, or a signal
// arrives, without one.
// Requires: `synchronizer` is open.
bv_status bv_synchronizer_wait(struct bv_synchronizer *synchronizer,
                               uint32_t timeout_ms);

// Takes the next set: one frame of each stream, in the order of the topics, each of which the caller must release.
// BV_STATUS_NOTHING if no set is complete (all of `out` are NULL then). Never sleeps.
// Requires: `synchronizer` is open; `out` has room for one frame of each stream.
bv_status bv_synchronizer_take(struct bv_synchronizer *synchronizer,
                               struct bv_frame **out);

// Returns the number of frames that were taken and found no partner.
// Requires: `synchronizer` is open or NULL.
uint64_t bv_synchronizer_skipped(const struct bv_synchronizer *synchronizer);

// Returns the number of frames that were sent and never taken, over all streams.
// Requires: `synchronizer` is open or NULL.
uint64_t bv_synchronizer_missed_total(const struct bv_synchronizer *synchronizer);

// Opens a stream of commands of one bv_kind for sending; several processes may. The topics of a TurtleBot are
// "cmd_vel" for BV_KIND_VELOCITY_COMMAND, "mobile_base/commands/reset_odometry" for BV_KIND_RESET_ODOMETRY and
// "mobile_base/commands/motor_power" for BV_KIND_MOTOR_POWER.
// Requires: `node` is open; `topic` is NUL-terminated; `out` can be written.
bv_status bv_command_open(struct bv_node *node,
                          const char *topic,
                          uint16_t kind,
                          struct bv_command_publisher **out);

// Sends a command: the struct of the publisher's kind, and its size. The robot uses the newest command that has
// arrived since its last step.
// Requires: `publisher` is open; `size` bytes of `command` can be read.
bv_status bv_command_send(struct bv_command_publisher *publisher,
                          const void *command,
                          size_t size);

// Closes the publisher; NULL is ignored. If the receiver has not polled since the publisher was opened, it misses its
// commands: give the robot one or two steps of simulation before closing.
// Requires: `publisher` came from bv_command_open and is not used afterwards.
void bv_command_close(struct bv_command_publisher *publisher);

// Opens a velocity command stream ("cmd_vel") for sending; several processes may. Equivalent to bv_command_open with
// BV_KIND_VELOCITY_COMMAND.
// Requires: `node` is open; `topic` is NUL-terminated; `out` can be written.
bv_status bv_velocity_open(struct bv_node *node,
                           const char *topic,
                           struct bv_velocity_publisher **out);

// Sends a velocity command. The robot stops if no command arrives within its timeout.
// Requires: `publisher` is open; `command` can be read.
bv_status bv_velocity_send(struct bv_velocity_publisher *publisher,
                           const struct bv_velocity_command *command);

// Closes the publisher; NULL is ignored. See bv_command_close.
// Requires: `publisher` came from bv_velocity_open and is not used afterwards.
void bv_velocity_close(struct bv_velocity_publisher *publisher);

// Opens the control streams of a domain. The simulator may start later.
// Requires: `node` is open; `out` can be written.
bv_status bv_control_open(struct bv_node *node, struct bv_control **out);

// Sends a command, with a text (NULL for none), and waits for its result. Returns BV_STATUS_NOTHING if no result
// arrives in time or the simulator ends. An id of 0 is replaced by a unique one; text_len is set from the text. A
// refused command is a success of this function: check result->done.
// Requires: `control` is open; `command` can be read; `text` is NUL-terminated or NULL; `result` can be written.
bv_status bv_control_call(struct bv_control *control,
                          const struct bv_simulation_command *command,
                          const char *text,
                          uint32_t timeout_ms,
                          struct bv_simulation_result *result);

// Writes true if a simulator is listening now; never sleeps.
// Requires: `control` is open; `connected` can be written.
bv_status bv_control_is_connected(struct bv_control *control, bool *connected);

// Returns when the last result was sent, on the clock of bv_mono_ns; 0 before the first. Frames with a later
// publish_mono_ns show the effect of the command.
// Requires: `control` is open or NULL.
uint64_t bv_control_answered_ns(const struct bv_control *control);

// Closes the control; NULL is ignored.
// Requires: `control` came from bv_control_open and is not used afterwards.
void bv_control_close(struct bv_control *control);

// Opens the conversion of a stream of structs. A kind may have several types of ROS, which the last word of its topic
// distinguishes. Returns BV_STATUS_NOTHING if ROS has no type for the stream, and for images, scans and clouds.
// Requires: `topic` is NUL-terminated; `out` can be written.
bv_status bv_ros1_open(uint16_t kind,
                       const char *topic,
                       struct bv_ros1_message **out);

// Returns the type of the messages, such as "sensor_msgs/Imu".
// Requires: `message` is open, or NULL, for which NULL is returned.
const char *bv_ros1_name(const struct bv_ros1_message *message);

// Returns the MD5 sum of the type, as text.
// Requires: `message` is open, or NULL, for which NULL is returned.
const char *bv_ros1_md5(const struct bv_ros1_message *message);

// Returns the definition of the type, followed by those of its parts.
// Requires: `message` is open, or NULL, for which NULL is returned.
const char *bv_ros1_definition(const struct bv_ros1_message *message);

// Converts a frame: `bytes` is its serialized message of `len` bytes, valid until the next call with this conversion.
// Returns BV_STATUS_BAD_FRAME for an invalid header, BV_STATUS_INVALID_ARGUMENT if the message cannot hold the frame.
// Requires: `message` is open; `header` points to a header, `payload` to `payload_len` bytes; `bytes` and `len` can be written.
bv_status bv_ros1_write(struct bv_ros1_message *message,
                        const struct bv_frame_header *header,
                        const uint8_t *payload,
                        size_t payload_len,
                        const uint8_t **bytes,
                        size_t *len);

// Closes the conversion; NULL is ignored.
// Requires: `message` came from bv_ros1_open and is not used afterwards.
void bv_ros1_close(struct bv_ros1_message *message);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* BELVEDERE_H */
