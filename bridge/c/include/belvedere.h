/* Belvedere's frames in shared memory, for C and C++. SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * Made from bridge/src/wire and, by cbindgen, from bridge/c/src; do not edit. The layout of every byte is in bridge/WIRE.md.
 *
 *   bv_node *node;
 *   bv_subscriber *subscriber;
 *   if (bv_node_open(NULL, "me", &node) != BV_STATUS_OK) { puts(bv_last_error()); exit(1); }
 *   bv_subscribe(node, "camera/rgb/image_raw", &subscriber);
 *   while (bv_subscriber_wait(subscriber, 1000) >= 0) {
 *       bv_frame *frame;
 *       while (bv_subscriber_take(subscriber, &frame) == BV_STATUS_OK) {
 *           const bv_frame_header *header = bv_frame_get_header(frame);
 *           const uint8_t *pixels = bv_frame_get_payload(frame);  // where the simulator wrote them
 *           ...
 *           bv_frame_release(frame);
 *       }
 *   }
 *
 * Functions give a bv_status: 0 success, 1 nothing there (yet), negative an error that bv_last_error() words.
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

// What the payload of a stream means (bv_frame_header.kind). Numbers are never reused.
enum bv_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint16_t
#endif
 {
    // A colour or grey picture; the header carries its intrinsics.
    BV_KIND_IMAGE = 1,
    // Depth along the optical axis; the header carries its intrinsics.
    BV_KIND_DEPTH_IMAGE = 2,
    // One bv_camera_info.
    BV_KIND_CAMERA_INFO = 3,
    // Ranges of a planar or multi-layer lidar; the header carries its angles.
    BV_KIND_LASER_SCAN = 4,
    // Points in the sensor's frame; organised (an image of points) when the height is more than 1.
    BV_KIND_POINT_CLOUD = 5,
    // One bv_odometry.
    BV_KIND_ODOMETRY = 6,
    // An array of bv_transform that hold at the stamp.
    BV_KIND_TRANSFORMS = 7,
    // An array of bv_transform that hold always.
    BV_KIND_STATIC_TRANSFORMS = 8,
    // An array of bv_joint_state.
    BV_KIND_JOINT_STATES = 9,
    // One bv_clock: the simulation's time.
    BV_KIND_CLOCK = 10,
    // One bv_velocity_command, towards the robot.
    BV_KIND_VELOCITY_COMMAND = 11,
    // One bv_imu.
    BV_KIND_IMU = 12,
    // One bv_robot_event, sent when it happens.
    BV_KIND_ROBOT_EVENT = 13,
    // One bv_simulation_command, towards the simulator; a text may follow it in the payload.
    BV_KIND_SIMULATION_COMMAND = 14,
    // One bv_simulation_result: the answer to a command.
    BV_KIND_SIMULATION_RESULT = 15,
    // An array of bv_model_state.
    BV_KIND_MODEL_STATES = 16,
    // One bv_core_sensors.
    BV_KIND_CORE_SENSORS = 17,
    // One bv_reset_odometry, towards the robot.
    BV_KIND_RESET_ODOMETRY = 18,
    // One bv_motor_power, towards the robot.
    BV_KIND_MOTOR_POWER = 19,
    // One bv_range.
    BV_KIND_RANGE = 20,
    // An array of bv_sensor_settings: of every sensor that can be changed, as they are from the stamp on.
    BV_KIND_SENSOR_SETTINGS = 21,
    // An array of bv_bounding_box: of everything that a picture shows.
    BV_KIND_BOUNDING_BOXES = 22,
    // An array of bv_tag_detection: of the tags that a picture shows.
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
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum bv_kind bv_kind;
#else
typedef uint16_t bv_kind;
#endif
#endif

// How one element of the payload is coded (bv_frame_header.encoding).
enum bv_encoding
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint16_t
#endif
 {
    // Red, green, blue; 8 bit each.
    BV_ENCODING_RGB8 = 1,
    // Blue, green, red; 8 bit each.
    BV_ENCODING_BGR8 = 2,
    // Grey, 8 bit.
    BV_ENCODING_MONO8 = 3,
    // Depth in metres, as 32-bit floats: NaN invalid, −inf too near, +inf nothing there (REP-118).
    BV_ENCODING_F32C1 = 4,
    // Depth in millimetres, 16 bit: 0 invalid (REP-118).
    BV_ENCODING_U16C1 = 5,
    // A point of 32 bytes: x, y, z as f32 at 0, 4, 8 in metres; colour at 16 as an f32 whose bits are
    // 0x00RRGGBB (PCL's rgb); the rest is padding. NaN coordinates: no point.
    BV_ENCODING_XYZ_RGB_F32 = 6,
    // Ranges in metres, 32-bit floats (REP-117): height layers of width rays. With
    // BV_HAS_INTENSITIES a second plane of the same shape follows
    // at height · row_stride.
    BV_ENCODING_RANGES_F32 = 7,
    // height fixed structs, elem_stride bytes apart; see payload.
    BV_ENCODING_STRUCT = 8,
    // Red, green, blue, and 255; 8 bit each.
    BV_ENCODING_RGBA8 = 9,
    // Grey, 16 bit.
    BV_ENCODING_MONO16 = 10,
    // A colour a pixel, 8 bit: the first row red and green, the second green and blue.
    BV_ENCODING_BAYER_RGGB8 = 11,
    // A colour a pixel, 8 bit: the first row blue and green, the second green and red.
    BV_ENCODING_BAYER_BGGR8 = 12,
    // A colour a pixel, 8 bit: the first row green and blue, the second red and green.
    BV_ENCODING_BAYER_GBRG8 = 13,
    // A colour a pixel, 8 bit: the first row green and red, the second blue and green.
    BV_ENCODING_BAYER_GRBG8 = 14,
    // A colour a pixel, 16 bit: the first row red and green, the second green and blue.
    BV_ENCODING_BAYER_RGGB16 = 15,
    // A colour a pixel, 16 bit: the first row blue and green, the second green and red.
    BV_ENCODING_BAYER_BGGR16 = 16,
    // A colour a pixel, 16 bit: the first row green and blue, the second red and green.
    BV_ENCODING_BAYER_GBRG16 = 17,
    // A colour a pixel, 16 bit: the first row green and red, the second blue and green.
    BV_ENCODING_BAYER_GRBG16 = 18,
    // Two 32-bit floats: flow in pixels, to the right and down; NaN where there is none.
    BV_ENCODING_F32C2 = 19,
    // Three 32-bit floats: unit normals in the axes of the world; 0 where nothing is seen.
    BV_ENCODING_F32C3 = 20,
    // A number of a thing or of a class, 32 bit and signed; of things, -1 where nothing is seen.
    BV_ENCODING_I32C1 = 21,
    // A point of 22 bytes, as Velodyne's driver sends it: x, y, z as f32 at 0, 4, 8 in metres, intensity as f32 at
    // 12, ring as u16 at 16, from the lowest up, time as f32 at 18 in seconds after the stamp. NaN coordinates: no
    // point, which only clouds of several rows have.
    BV_ENCODING_XYZ_IRT_F32 = 22,
    // A point of 48 bytes, as Ouster's driver sends it: x, y, z as f32 at 0, 4, 8 in metres, intensity as f32 at 16,
    // t as u32 at 20 in nanoseconds after the stamp, reflectivity as u16 at 24, ring as u16 at 26, from the highest
    // down, ambient as u16 at 28, range as u32 at 32 in millimetres, 0 for none. NaN coordinates: no point. A row is
    // a laser, a column a direction.
    BV_ENCODING_OUSTER_POINT = 23,
    // A point of 26 bytes, as Livox's driver sends it: x, y, z as f32 at 0, 4, 8 in metres, intensity as f32 at 12,
    // tag as u8 at 16, line as u8 at 17, timestamp as f64 at 18 in nanoseconds since time 0.
    BV_ENCODING_LIVOX_POINT = 24,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum bv_encoding bv_encoding;
#else
typedef uint16_t bv_encoding;
#endif
#endif

// How a lens maps directions to pixels, and the order of its parameters. Names are those of
// sensor_msgs/CameraInfo where ROS has one. With K = (fx, fy, cx, cy) a direction (x, y, z) becomes the pixel (fx·u + cx, fy·v + cy).
enum bv_distortion_model
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint16_t
#endif
 {
    // Brown–Conrady: k1 k2 p1 p2 k3; all 0 for a pinhole. u, v are x/z, y/z, distorted.
    BV_DISTORTION_MODEL_PLUMB_BOB = 1,
    // OpenCV's longer forms of it: k1 k2 p1 p2 k3 k4 k5 k6, then s1 s2 s3 s4 of a thin prism, then the tilts τx τy;
    // 8, 12 or 14 of them.
    BV_DISTORTION_MODEL_RATIONAL_POLYNOMIAL = 2,
    // Kannala–Brandt, OpenCV's fisheye: k1 k2 k3 k4 of θ + k1 θ³ + k2 θ⁵ + k3 θ⁷ + k4 θ⁹.
    BV_DISTORTION_MODEL_EQUIDISTANT = 3,
    // Extended unified camera model: alpha beta. ROS has no name for it, nor for those that follow.
    BV_DISTORTION_MODEL_EUCM = 4,
    // Double sphere: xi alpha.
    BV_DISTORTION_MODEL_DOUBLE_SPHERE = 5,
    // Mei's unified model: xi k1 k2 p1 p2.
    BV_DISTORTION_MODEL_MEI = 6,
    // Columns are angles about the camera's y, rows are elevations: u = atan2(x, z), v = atan2(y, √(x² + z²)).
    BV_DISTORTION_MODEL_EQUIRECTANGULAR = 7,
    // SDF's: c1 c2 c3 f fun cutoff. The radius is c1·f·fun(θ/c2 + c3), f in pixels, fun 0 sin, 1 tan, 2 the angle
    // itself; beyond the angle cutoff nothing is seen. K is its scale in the middle.
    BV_DISTORTION_MODEL_WIDE_ANGLE = 8,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum bv_distortion_model bv_distortion_model;
#else
typedef uint16_t bv_distortion_model;
#endif
#endif

// What a simulator is told to do (bv_simulation_command.operation). Numbers are never reused; one that a simulator
// does not know it refuses by number.
enum bv_operation
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint16_t
#endif
 {
    // Let simulated time stand.
    BV_OPERATION_PAUSE = 1,
    // Let it go on.
    BV_OPERATION_RESUME = 2,
    // Run steps steps of physics with all that is published on the way, then pause.
    BV_OPERATION_STEP = 3,
    // Put every model back to where it was at the start, at rest; time goes on.
    BV_OPERATION_RESET_WORLD = 4,
    // Begin again at time 0: what follows are the bytes of a fresh start.
    BV_OPERATION_RESET_SIMULATION = 5,
    // Give the model name a pose and a velocity, in the frame reference.
    BV_OPERATION_SET_MODEL_STATE = 6,
    // Put the model in the text (URDF or SDF) into the world as name, at a pose in the frame reference.
    BV_OPERATION_SPAWN = 7,
    // Take the model name out of the world.
    BV_OPERATION_DELETE = 8,
    // Change settings of the sensor name, or of the one that sends the topic name: key=value words in the text.
    BV_OPERATION_CONFIGURE = 9,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum bv_operation bv_operation;
#else
typedef uint16_t bv_operation;
#endif
#endif

// How an image's pixels map to directions; the block of images, depth images and organised clouds.
typedef struct bv_intrinsics {
    // Focal length along a row, pixels.
    double fx;
    // Focal length along a column, pixels.
    double fy;
    // Principal point; pixel centres are integers, so that of a centred image is (width − 1) / 2.
    double cx;
    // Principal point, rows.
    double cy;
    // K[1]: pixels along a row for each unit of y.
    double skew;
    // Parameters of the model, in the order that bv_distortion_model says; the first distortion_len hold.
    double distortion[14];
    // Nearest depth that is measured, metres.
    float near;
    // Farthest depth that is measured, metres.
    float far;
    // P[3] = −fx · baseline of a stereo partner, else 0.
    float tx;
    // A bv_distortion_model by its number; 0 for none.
    uint16_t distortion_model;
    // How many of distortion hold.
    uint16_t distortion_len;
    // 0.
    uint64_t reserved[5];
} bv_intrinsics;

// Angles and limits of a lidar; the block of scans. Angles in radians: horizontal ones counter-clockwise about
// +z from +x, vertical ones up.
typedef struct bv_scan_geometry {
    // Angle of the first ray of a layer.
    double angle_min;
    // From one ray to the next.
    double angle_increment;
    // Seconds from one ray to the next.
    double time_increment;
    // Seconds from one scan to the next.
    double scan_time;
    // Shortest range that is measured, metres.
    float range_min;
    // Longest range that is measured, metres.
    float range_max;
    // Elevation of the first layer.
    double vertical_angle_min;
    // From one layer to the next.
    double vertical_angle_increment;
    // 0.
    uint64_t reserved[19];
} bv_scan_geometry;

// What only this kind has.
typedef union bv_block {
    // images, depth images, clouds
    struct bv_intrinsics intrinsics;
    // scans
    struct bv_scan_geometry scan;
    uint64_t raw[26];
} bv_block;

// The 384 bytes that describe a payload: what it is, when and from where it was taken, how it lies in memory.
//
// Aligned to 64 bytes, so that the payload behind it starts on a cache line and a SIMD register boundary.
typedef struct bv_frame_header {
    // BV_MAGIC.
    uint32_t magic;
    // 384.
    uint16_t header_len;
    // BV_SCHEMA.
    uint16_t schema;
    // A bv_kind by its number.
    uint16_t kind;
    // An bv_encoding by its number.
    uint16_t encoding;
    // BV_HAS_INTENSITIES, BV_REPLAYED; other bits are 0.
    uint32_t flags;
    // Counts the frames of one publisher's life from 0. Set by send.
    uint64_t seq;
    // Random per publisher life: a new one means that seq began again. Set by loan.
    uint64_t session;
    // Moment of capture in simulation time, nanoseconds since the simulation started.
    uint64_t stamp_ns;
    // CLOCK_MONOTONIC at the moment of sending, nanoseconds. Set by send.
    uint64_t publish_mono_ns;
    // Elements per row: pixels, rays, points; 1 for structs.
    uint32_t width;
    // Rows: image rows, lidar layers; the number of structs.
    uint32_t height;
    // Bytes from one row to the next.
    uint32_t row_stride;
    // Bytes from one element to the next.
    uint32_t elem_stride;
    // Bytes of payload that hold. Set by loan.
    uint64_t payload_len;
    // The frame that the data are given in.
    char frame_id[64];
    // world_from_sensor: the sensor's origin in the world at stamp_ns, metres.
    double position[3];
    // world_from_sensor: its orientation, x y z w.
    float orientation[4];
    // What only this kind has: bv_intrinsics or bv_scan_geometry.
    union bv_block block;
} bv_frame_header;

// How a camera maps directions to pixels, as sensor_msgs/CameraInfo has it.
typedef struct bv_camera_info {
    // Pixels per row.
    uint32_t width;
    // Rows.
    uint32_t height;
    // A bv_distortion_model by its name, or nothing without distortion.
    char distortion_model[32];
    // Distortion parameters in the order of the model; the first d_len hold.
    double d[14];
    // How many of d hold.
    uint32_t d_len;
    // 0.
    uint32_t reserved;
    // Intrinsic matrix of the raw image, row by row.
    double k[9];
    // Rectification rotation, row by row.
    double r[9];
    // Projection matrix of the rectified image, 3 × 4, row by row.
    double p[12];
} bv_camera_info;

// Pose and velocity of a body, as nav_msgs/Odometry has it: the pose is in the header's frame_id, the
// velocity in child_frame_id.
typedef struct bv_odometry {
    // The body's frame.
    char child_frame_id[64];
    // Metres.
    double position[3];
    // x y z w.
    double orientation[4];
    // Metres per second.
    double linear[3];
    // Radians per second.
    double angular[3];
    // 6 × 6 row by row: x y z and rotations about x y z.
    double pose_covariance[36];
    // 6 × 6 row by row: linear x y z, angular x y z.
    double twist_covariance[36];
} bv_odometry;

// point_in_parent = parent_from_child · point_in_child.
typedef struct bv_transform {
    // The frame that is the reference.
    char parent[64];
    // The frame whose pose is given.
    char child[64];
    // The child's origin in the parent, metres.
    double translation[3];
    // x y z w.
    double rotation[4];
} bv_transform;

// State of one joint.
typedef struct bv_joint_state {
    // The joint's name in the robot description.
    char name[64];
    // Radians or metres.
    double position;
    // Radians or metres per second.
    double velocity;
    // Newton metres or newtons.
    double effort;
} bv_joint_state;

// The simulation's time.
typedef struct bv_clock {
    // Nanoseconds since the simulation started.
    uint64_t now_ns;
} bv_clock;

// A wanted velocity of the robot in its own frame, as geometry_msgs/Twist has it.
typedef struct bv_velocity_command {
    // x forward, y left, z up; metres per second.
    double linear[3];
    // About x, y, z; radians per second.
    double angular[3];
} bv_velocity_command;

// What an inertial measurement unit measures, as sensor_msgs/Imu has it, in the header's frame_id. Covariances
// are 3 × 3 row by row; one of zeros is not known, one that begins with −1 says that there is no measurement
// (REP-145).
typedef struct bv_imu {
    // x y z w.
    double orientation[4];
    // Radians per second.
    double angular_velocity[3];
    // Metres per second²; +g upwards at rest.
    double linear_acceleration[3];
    // About x, y, z.
    double orientation_covariance[9];
    // About x, y, z.
    double angular_velocity_covariance[9];
    // Along x, y, z.
    double linear_acceleration_covariance[9];
} bv_imu;

// A sensor of a base that has changed its state (kobuki_msgs/BumperEvent, CliffEvent, WheelDropEvent).
typedef struct bv_robot_event {
    // bv_robot_event.BUMPER, bv_robot_event.CLIFF or bv_robot_event.WHEEL_DROP.
    uint32_t source;
    // bv_robot_event.LEFT, bv_robot_event.CENTRE or bv_robot_event.RIGHT. (kobuki_msgs numbers the right wheel 1.)
    uint32_t index;
    // 0 released, floor, raised; 1 pressed, cliff, dropped.
    uint32_t state;
    // A cliff sensor's reading, as bv_core_sensors.bottom; else 0.
    uint32_t value;
} bv_robot_event;

// What a base says of itself 50 times a second (kobuki_msgs/SensorState). In the bits of bumper and cliff 1 is
// right, 2 is centre, 4 is left; in those of the wheels 1 is right, 2 is left.
typedef struct bv_core_sensors {
    // Milliseconds; wraps.
    uint16_t time_stamp;
    // Bits of what is pressed.
    uint8_t bumper;
    // Bits of the wheels that hang.
    uint8_t wheel_drop;
    // Bits of where there is no floor.
    uint8_t cliff;
    // Bits of what is pressed: 1, 2, 4.
    uint8_t buttons;
    // Ticks of the left wheel; wraps.
    uint16_t left_encoder;
    // Ticks of the right wheel; wraps.
    uint16_t right_encoder;
    // Duty of the left motor; 0, not simulated.
    int8_t left_pwm;
    // Duty of the right motor; 0, not simulated.
    int8_t right_pwm;
    // 0 discharging, 2 charged, 6 charging; 16 is added at an adapter.
    uint8_t charger;
    // Tenths of a volt.
    uint8_t battery;
    // Converted readings of the cliff sensors right, centre, left, of 12 bits; smaller is farther.
    uint16_t bottom[3];
} bv_core_sensors;

// Odometry is to begin at zero here and now.
typedef struct bv_reset_odometry {
    // 0.
    uint64_t reserved;
} bv_reset_odometry;

// Whether the motors follow commands (kobuki_msgs/MotorPower).
typedef struct bv_motor_power {
    // 0 off, else on.
    uint32_t state;
} bv_motor_power;

// What a simulator is to do. A text of text_len bytes follows it in the payload.
typedef struct bv_simulation_command {
    // Chosen at random by the sender; the result names it.
    uint64_t id;
    // An bv_operation's number.
    uint16_t operation;
    // 0.
    uint16_t reserved;
    // Bytes of UTF-8 that follow this struct, without a NUL: the model to be spawned, the settings to
    // be changed. 0 for other operations.
    uint32_t text_len;
    // Steps of physics to run.
    uint64_t steps;
    // The model that is meant; of a sensor's settings, the sensor, or a topic that it sends.
    char name[64];
    // The frame that pose and velocity are given in: a model, model::link, or nothing for the world.
    char reference[64];
    // Of the model's frame, metres.
    double position[3];
    // Of the model's frame, x y z w; four zeros are no rotation.
    double orientation[4];
    // Of the model's origin, along the axes of the reference, metres per second.
    double linear[3];
    // About the axes of the reference, radians per second.
    double angular[3];
    // Of what is spawned: it stands before its topics and frames; nothing for none.
    char robot_namespace[64];
} bv_simulation_command;

// What became of a bv_simulation_command.
typedef struct bv_simulation_result {
    // The command's.
    uint64_t id;
    // Simulated time after it.
    uint64_t time_ns;
    // 1 when it was done, 0 when it was refused.
    uint16_t done;
    // The command's.
    uint16_t operation;
    // 0.
    uint32_t reserved;
    // Why it was refused; nothing when it was done.
    char reason[488];
} bv_simulation_result;

// Where a model or a link is, and how it moves.
typedef struct bv_model_state {
    // The model's name; model::link for a link. Twice as long as other names since it is made of two.
    char name[128];
    // In the world, metres.
    double position[3];
    // In the world, x y z w.
    double orientation[4];
    // Of its origin, along the world's axes, metres per second.
    double linear[3];
    // About the world's axes, radians per second.
    double angular[3];
} bv_model_state;

// A place on the earth, as sensor_msgs/NavSatFix has it, and the velocity there.
typedef struct bv_nav_sat_fix {
    // Geodetic latitude in degrees, WGS 84.
    double latitude;
    // Longitude in degrees, to the east.
    double longitude;
    // Height above the ellipsoid in metres.
    double altitude;
    // To the east, the north and up, in metres per second.
    double velocity[3];
    // Of the position to the east, the north and up, in m², row by row.
    double position_covariance[9];
} bv_nav_sat_fix;

// A magnetic field, as sensor_msgs/MagneticField has it.
typedef struct bv_magnetic_field {
    // Teslas.
    double magnetic_field[3];
    // Row by row.
    double covariance[9];
} bv_magnetic_field;

// A pressure, as sensor_msgs/FluidPressure has it.
typedef struct bv_fluid_pressure {
    // Absolute, in pascals.
    double fluid_pressure;
    // Pa².
    double variance;
} bv_fluid_pressure;

// A height and how fast it changes, as gz-sim's altimeter tells them.
typedef struct bv_altimeter {
    // Metres above the reference.
    double vertical_position;
    // Metres per second.
    double vertical_velocity;
    // Height of the reference in the world in metres.
    double vertical_reference;
    // Of the position, in m².
    double variance;
} bv_altimeter;

// A vector whose meaning its topic says, as geometry_msgs/Vector3Stamped has it.
typedef struct bv_vector3 {
    // x y z.
    double vector[3];
} bv_vector3;

// One distance, as sensor_msgs/Range has it: to the nearest thing within the field of view.
typedef struct bv_range {
    // 0 ultrasound, 1 infrared.
    uint32_t radiation_type;
    // Full angle of the cone that is measured in, radians.
    float field_of_view;
    // Metres: nothing nearer is measured.
    float min_range;
    // Metres: nothing farther is measured.
    float max_range;
    // Metres; −inf too near, +inf nothing in range (REP-117), or as the simulator's description of it says.
    float range;
} bv_range;

// A number that can be set; all three are NaN where a sensor has no such setting.
typedef struct bv_setting {
    // What it is.
    double value;
    // The least that it may be.
    double min;
    // The most that it may be.
    double max;
} bv_setting;

// The settings of one sensor, under the names by which the operation Configure
// changes them.
typedef struct bv_sensor_settings {
    // The sensor's name in the robot's description.
    char name[64];
    // The streams that it sends, without leading slashes; the rest is empty.
    char topics[6][256];
    // Frames per second.
    struct bv_setting update_rate;
    // Mean of the noise: of colours in [0, 1] for a camera, of ranges in metres for a lidar.
    struct bv_setting noise_mean;
    // Its standard deviation, in the same unit.
    struct bv_setting noise_stddev;
    // Exposure of a camera: the share of the light that its description gives it, 1 as described.
    struct bv_setting exposure;
} bv_sensor_settings;

// What is seen of a thing, and where all of it is. Its pose is in the optical frame of the sensor (x right, y down, z
// forward) at the header's stamp.
typedef struct bv_bounding_box {
    // Its number, as in the picture of instances.
    uint32_t instance;
    // Its class, as in the picture of classes.
    uint32_t label;
    // How many pixels show it.
    uint32_t pixels;
    // First column and row of these.
    uint32_t min[2];
    // Last column and row, themselves seen.
    uint32_t max[2];
    // 0.
    uint32_t reserved;
    // Middle of the box that holds the whole of it, along its own axes; metres.
    double position[3];
    // x y z w.
    double orientation[4];
    // Edges of that box; metres.
    double size[3];
} bv_bounding_box;

// Where a tag is seen: one of which a corner is in the picture with nothing in front of it. Its pose is in the optical
// frame of the sensor (x right, y down, z forward) at the header's stamp; the tag's own x is to the right and y up as one
// reads it, z towards the reader, as in OpenCV's ArUco.
typedef struct bv_tag_detection {
    // As the file says: tag36h11, qr.
    char family[32];
    // Its number in the family.
    uint32_t id;
    // For each corner 1 if it is in the picture and nothing hides it, else 0.
    uint8_t visible[4];
    // Edge of its square without the white margin; metres.
    double size;
    // Column and row of each corner, centres of pixels at integers: top left, top right, bottom right, bottom left as one
    // reads it (OpenCV's ArUco), when the row is taken. NaN where no pixel of the lens sees in that direction.
    double corners[4][2];
    // Its middle; metres.
    double position[3];
    // x y z w.
    double orientation[4];
} bv_tag_detection;

// Most streams of a set.
#define BV_SYNCHRONIZER_MAX 8

// How a call went. Negative values are errors; bv_last_error() has the words.
enum bv_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Done.
    BV_STATUS_OK = 0,
    // Nothing is there: the time passed without a frame, or none waits.
    BV_STATUS_NOTHING = 1,
    // A pointer is null, a text is not UTF-8, or a number is out of range.
    BV_STATUS_INVALID_ARGUMENT = -1,
    // The name of a domain or topic cannot be one.
    BV_STATUS_INVALID_NAME = -2,
    // Another process publishes this stream already.
    BV_STATUS_DOMAIN_IN_USE = -3,
    // The stream is of another version, or not a Belvedere stream, or kept open as an earlier publisher made it.
    BV_STATUS_INCOMPATIBLE = -4,
    // The shared memory belongs to another user.
    BV_STATUS_PERMISSION = -5,
    // /dev/shm is too small.
    BV_STATUS_SHARED_MEMORY_TOO_SMALL = -6,
    // All places are taken: publishers or subscribers of the stream, frames held at a time, or files that the process
    // may have open.
    BV_STATUS_LIMIT = -7,
    // A frame's header is wrong; the frame was dropped.
    BV_STATUS_BAD_FRAME = -8,
    // A failure of the transport below.
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

// The commanding end of a simulation.
typedef struct bv_control bv_control;

// A frame where it lies in shared memory; unchanged until it is released. Its header was checked: rows and structs
// lie within the payload.
typedef struct bv_frame bv_frame;

// Membership of a domain.
typedef struct bv_node bv_node;

// The reading end of a stream: there before its publisher, and after.
typedef struct bv_subscriber bv_subscriber;

// Gives the frames of several streams that were taken at the same time: a picture with its depth and its camera_info.
//
// Time is that of the stamps. Each frame is in one set at most, sets come in order, and a frame that can find no
// partner any more is skipped. It holds one frame of each stream at most: with the two that may be held, one set may
// be kept while the next is waited for.
typedef struct bv_synchronizer bv_synchronizer;

// The sending end of a velocity command stream.
typedef struct bv_velocity_publisher bv_velocity_publisher;

// A stream that exists.
typedef struct bv_stream_info {
    // without a leading slash
    char topic[256];
    // the frame that the data are given in
    char frame_id[64];
    // intended rate; 0 when frames come as they come
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

// What went wrong last in this thread, in words; empty when nothing has. Valid until the next call that fails in
// this thread.
const char *bv_last_error(void);

// Belvedere's version, such as "0.1.0".
const char *bv_version(void);

// CLOCK_MONOTONIC in nanoseconds: compare with publish_mono_ns of a header.
uint64_t bv_mono_ns(void);

// Joins a domain (NULL: that of the environment variable BELVEDERE_DOMAIN, else "default") under a name for
// listings. Close it with bv_node_close; what was made from it stays usable after that.
// Requires: The texts are NUL-terminated or NULL; `out` can be written.
bv_status bv_node_open(const char *domain, const char *name, struct bv_node **out);

// Leaves the domain; NULL is ignored.
// Requires: `node` came from bv_node_open and is not used afterwards.
void bv_node_close(struct bv_node *node);

// Lists the streams of the domain, by topic. Free the array with bv_streams_free.
// Requires: `node` is open; `out` and `count` can be written.
bv_status bv_streams(struct bv_node *node, struct bv_stream_info **out, size_t *count);

// Frees what bv_streams has given; NULL is ignored.
// Requires: `streams` and `count` came from one call of bv_streams and are not used afterwards.
void bv_streams_free(struct bv_stream_info *streams, size_t count);

// Follows a stream, whether it exists already or not. A leading slash of the topic is ignored. When the publisher
// ends, or is killed, and starts again, the subscriber goes on with the new one.
// Requires: `node` is open; `topic` is NUL-terminated; `out` can be written.
bv_status bv_subscribe(struct bv_node *node,
                       const char *topic,
                       struct bv_subscriber **out);

// Ends the subscription; NULL is ignored. Frames that are held stay valid.
// Requires: `subscriber` came from bv_subscribe and is not used afterwards.
void bv_subscriber_close(struct bv_subscriber *subscriber);

// Sleeps until there is a frame to take: BV_STATUS_OK; BV_STATUS_NOTHING when the time has passed, or a signal
// came, without one.
// Requires: `subscriber` is open.
bv_status bv_subscriber_wait(struct bv_subscriber *subscriber,
                             uint32_t timeout_ms);

// Looks for frames without sleeping when they are due, for at most `limit_us` a frame; 0, as at first: never.
//
// It takes the system 30 to 100 us to wake a process, which is most of a frame's age where it arrives. With this,
// bv_subscriber_wait, and bv_subscriber_take in a loop that waits for bv_subscriber_fd, begin to look shortly before
// the next frame of a periodic stream is due, by the times of those before, and have it a few microseconds after it
// was sent. What comes much earlier or later, or without a period, wakes them as ever.
//
// The price is processor time: three mean deviations of the times of sending, 0.15 ms at least and half of
// `limit_us` at most, of a core for each frame. On a single core it does nothing.
// Requires: `subscriber` is open.
bv_status bv_subscriber_set_busy_poll(struct bv_subscriber *subscriber,
                                      uint32_t limit_us);

// A descriptor for the poll, select or epoll of another event loop: the same over the subscriber's whole life, and
// closed by bv_subscriber_close only. It is readable when frames may wait or it is time to look for the publisher:
// call bv_subscriber_take then until it gives BV_STATUS_NOTHING. Do not read from it.
// Requires: `subscriber` is open; `fd` can be written.
bv_status bv_subscriber_fd(struct bv_subscriber *subscriber,
                           int *fd);

// Takes the oldest frame that waits; BV_STATUS_NOTHING when none does (`*out` is NULL then). Never sleeps.
// Two frames may be held at a time, or as many as the publisher allows.
// Requires: `subscriber` is open; `out` can be written.
bv_status bv_subscriber_take(struct bv_subscriber *subscriber, struct bv_frame **out);

// Takes the newest frame that waits and drops those before it; otherwise as bv_subscriber_take.
// Requires: `subscriber` is open; `out` can be written.
bv_status bv_subscriber_take_newest(struct bv_subscriber *subscriber, struct bv_frame **out);

// Frames that were sent and never taken, over this subscriber's life.
// Requires: `subscriber` is open or NULL.
uint64_t bv_subscriber_missed_total(struct bv_subscriber *subscriber);

// Publishers now; 0 before the first, and after the last has ended or was found dead.
// Requires: `subscriber` is open or NULL.
size_t bv_subscriber_publishers(struct bv_subscriber *subscriber);

// Nanoseconds since the last frame: the sign that a stream has stopped.
// Requires: `subscriber` is open or NULL.
uint64_t bv_subscriber_silence_ns(struct bv_subscriber *subscriber);

// Its header.
// Requires: `frame` is held or NULL (then NULL is given).
const struct bv_frame_header *bv_frame_get_header(const struct bv_frame *frame);

// Its payload of payload_len bytes, aligned to 64.
// Requires: `frame` is held or NULL (then NULL is given).
const uint8_t *bv_frame_get_payload(const struct bv_frame *frame);

// Frames that were sent between the last one taken and this one.
// Requires: `frame` is held or NULL.
uint64_t bv_frame_missed(const struct bv_frame *frame);

// Whether it comes from another publisher life than the one before: the simulator was started again.
// Requires: `frame` is held or NULL.
bool bv_frame_restarted(const struct bv_frame *frame);

// Whether it was sent before this subscriber was connected, and kept for it: its age says nothing then.
// Requires: `frame` is held or NULL.
bool bv_frame_is_from_history(const struct bv_frame *frame);

// Nanoseconds since it was sent.
// Requires: `frame` is held or NULL.
uint64_t bv_frame_age_ns(const struct bv_frame *frame);

// Releases it; NULL is ignored.
// Requires: `frame` came from a take, and neither it nor its header and payload are used afterwards.
void bv_frame_release(struct bv_frame *frame);

// Synchronises `count` streams, 2 to BV_SYNCHRONIZER_MAX, whether they exist already or not. Stamps of a set differ
// by at most `tolerance_ns`: 0 for what is captured at one moment, more for sensors of different rates.
// Requires: `node` is open; `topics` has `count` NUL-terminated texts; `out` can be written.
bv_status bv_synchronizer_open(struct bv_node *node,
                               const char *const *topics,
                               size_t count,
                               uint64_t tolerance_ns,
                               struct bv_synchronizer **out);

// Ends it; NULL is ignored. Frames that are held stay valid.
// Requires: `synchronizer` came from bv_synchronizer_open and is not used afterwards.
void bv_synchronizer_close(struct bv_synchronizer *synchronizer);

// Sleeps until there is a set to take: BV_STATUS_OK; BV_STATUS_NOTHING when the time has passed, or a signal came,
// without one.
// Requires: `synchronizer` is open.
bv_status bv_synchronizer_wait(struct bv_synchronizer *synchronizer,
                               uint32_t timeout_ms);

// Takes the next set: one frame of each stream, in the order of the topics, each to be released;
// BV_STATUS_NOTHING when none is complete (all of `out` are NULL then). Never sleeps.
// Requires: `synchronizer` is open; `out` has room for as many frames as it has streams.
bv_status bv_synchronizer_take(struct bv_synchronizer *synchronizer, struct bv_frame **out);

// Frames that were taken and found no partner.
// Requires: `synchronizer` is open or NULL.
uint64_t bv_synchronizer_skipped(const struct bv_synchronizer *synchronizer);

// Frames that were sent and never taken, over all streams.
// Requires: `synchronizer` is open or NULL.
uint64_t bv_synchronizer_missed_total(const struct bv_synchronizer *synchronizer);

// Opens a stream of commands of a kind for sending; several processes may. A bv_kind, and the topic of a TurtleBot:
// BV_KIND_VELOCITY_COMMAND, "cmd_vel"; BV_KIND_RESET_ODOMETRY, "mobile_base/commands/reset_odometry";
// BV_KIND_MOTOR_POWER, "mobile_base/commands/motor_power".
// Requires: `node` is open; `topic` is NUL-terminated; `out` can be written.
bv_status bv_command_open(struct bv_node *node,
                          const char *topic,
                          uint16_t kind,
                          struct bv_command_publisher **out);

// Sends a command: the struct of the publisher's kind, and its size. The robot takes the newest of those that have
// come since its last step.
// Requires: `publisher` is open; `size` bytes of `command` can be read.
bv_status bv_command_send(struct bv_command_publisher *publisher,
                          const void *command,
                          size_t size);

// Closes it; NULL is ignored. A receiver that has not looked since this was opened misses what was sent: leave the
// robot a step or two of its simulation.
// Requires: `publisher` came from bv_command_open and is not used afterwards.
void bv_command_close(struct bv_command_publisher *publisher);

// Opens a velocity command stream ("cmd_vel") for sending; several processes may. As bv_command_open with
// BV_KIND_VELOCITY_COMMAND.
// Requires: `node` is open; `topic` is NUL-terminated; `out` can be written.
bv_status bv_velocity_open(struct bv_node *node, const char *topic, struct bv_velocity_publisher **out);

// Sends a command; the robot stops when none comes for its time-out.
// Requires: `publisher` is open; `command` can be read.
bv_status bv_velocity_send(struct bv_velocity_publisher *publisher,
                           const struct bv_velocity_command *command);

// Closes it; NULL is ignored. As bv_command_close.
// Requires: `publisher` came from bv_velocity_open and is not used afterwards.
void bv_velocity_close(struct bv_velocity_publisher *publisher);

// Gets ready to control the simulation of a domain, whether it runs already or not.
// Requires: `node` is open; `out` can be written.
bv_status bv_control_open(struct bv_node *node, struct bv_control **out);

// Sends a command, with a text (NULL: none), and waits for its result; 1 when none came in time, or the simulator
// ended. An id of 0 is replaced by one that no other has; text_len is that of the text. A command that was refused is
// a success of this function: look at result->done.
// Requires: `control` is open; `command` can be read; `text` is NUL-terminated or NULL; `result` can be written.
bv_status bv_control_call(struct bv_control *control,
                          const struct bv_simulation_command *command,
                          const char *text,
                          uint32_t timeout_ms,
                          struct bv_simulation_result *result);

// Whether there is a simulator that listens now; never sleeps.
// Requires: `control` is open; `connected` can be written.
bv_status bv_control_is_connected(struct bv_control *control, bool *connected);

// When the last result was sent, on the clock of bv_mono_ns; 0 before the first. Frames with a later publish_mono_ns
// show what the command has changed.
// Requires: `control` is open or NULL.
uint64_t bv_control_answered_ns(const struct bv_control *control);

// Closes it; NULL is ignored.
// Requires: `control` came from bv_control_open and is not used afterwards.
void bv_control_close(struct bv_control *control);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* BELVEDERE_H */
