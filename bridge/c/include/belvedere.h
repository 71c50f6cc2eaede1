/* Belvedere's frames in shared memory, for C and C++. SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * Made by cbindgen from bridge/c/src; do not edit. The layout of every byte is in bridge/WIRE.md.
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
    // The stream is of another version, or not a Belvedere stream.
    BV_STATUS_INCOMPATIBLE = -4,
    // The shared memory belongs to another user.
    BV_STATUS_PERMISSION = -5,
    // /dev/shm is too small.
    BV_STATUS_SHARED_MEMORY_TOO_SMALL = -6,
    // All places are taken: subscribers of the stream, or frames held at a time.
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

// What the payload is (bv_frame_header.kind).
enum bv_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint16_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // A colour or grey picture; block: intrinsics.
    BV_KIND_IMAGE = 1,
    // Depth along the optical axis; block: intrinsics.
    BV_KIND_DEPTH_IMAGE = 2,
    // One bv_camera_info.
    BV_KIND_CAMERA_INFO = 3,
    // Ranges of a lidar; block: scan.
    BV_KIND_LASER_SCAN = 4,
    // Points; organised as an image when height > 1; block: intrinsics.
    BV_KIND_POINT_CLOUD = 5,
    // One bv_odometry.
    BV_KIND_ODOMETRY = 6,
    // An array of bv_transform that hold at the stamp.
    BV_KIND_TRANSFORMS = 7,
    // An array of bv_transform that hold always.
    BV_KIND_STATIC_TRANSFORMS = 8,
    // An array of bv_joint_state.
    BV_KIND_JOINT_STATES = 9,
    // One bv_clock.
    BV_KIND_CLOCK = 10,
    // One bv_velocity_command.
    BV_KIND_VELOCITY_COMMAND = 11,
    // One bv_imu.
    BV_KIND_IMU = 12,
    // One bv_robot_event.
    BV_KIND_ROBOT_EVENT = 13,
    // One bv_simulation_command, towards the simulator; a text may follow it.
    BV_KIND_SIMULATION_COMMAND = 14,
    // One bv_simulation_result.
    BV_KIND_SIMULATION_RESULT = 15,
    // An array of bv_model_state.
    BV_KIND_MODEL_STATES = 16,
    // One bv_core_sensors.
    BV_KIND_CORE_SENSORS = 17,
    // One bv_reset_odometry.
    BV_KIND_RESET_ODOMETRY = 18,
    // One bv_motor_power.
    BV_KIND_MOTOR_POWER = 19,
    // One bv_range.
    BV_KIND_RANGE = 20,
    // An array of bv_sensor_settings.
    BV_KIND_SENSOR_SETTINGS = 21,
    // An array of bv_bounding_box.
    BV_KIND_BOUNDING_BOXES = 22,
    // An array of bv_tag_detection.
    BV_KIND_TAG_DETECTIONS = 23,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum bv_kind bv_kind;
#else
typedef uint16_t bv_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How an element is coded (bv_frame_header.encoding).
enum bv_encoding
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint16_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Red, green, blue; 8 bit each.
    BV_ENCODING_RGB8 = 1,
    // Blue, green, red; 8 bit each.
    BV_ENCODING_BGR8 = 2,
    // Grey, 8 bit.
    BV_ENCODING_MONO8 = 3,
    // float, metres: NaN invalid, -inf too near, +inf nothing there.
    BV_ENCODING_F32C1 = 4,
    // uint16_t, millimetres: 0 invalid.
    BV_ENCODING_U16C1 = 5,
    // 32 bytes: float x, y, z at 0, 4, 8; colour 0x00RRGGBB at 16.
    BV_ENCODING_XYZ_RGB_F32 = 6,
    // float, metres: height layers of width rays.
    BV_ENCODING_RANGES_F32 = 7,
    // height structs of the kind, row_stride bytes apart.
    BV_ENCODING_STRUCT = 8,
    // Red, green, blue, and 255; 8 bit each.
    BV_ENCODING_RGBA8 = 9,
    // Grey, uint16_t.
    BV_ENCODING_MONO16 = 10,
    // A colour a pixel, 8 bit: the first row red and green, the second green and blue.
    BV_ENCODING_BAYER_RGGB8 = 11,
    // A colour a pixel, 8 bit: the first row blue and green, the second green and red.
    BV_ENCODING_BAYER_BGGR8 = 12,
    // A colour a pixel, 8 bit: the first row green and blue, the second red and green.
    BV_ENCODING_BAYER_GBRG8 = 13,
    // A colour a pixel, 8 bit: the first row green and red, the second blue and green.
    BV_ENCODING_BAYER_GRBG8 = 14,
    // A colour a pixel, uint16_t: the first row red and green, the second green and blue.
    BV_ENCODING_BAYER_RGGB16 = 15,
    // A colour a pixel, uint16_t: the first row blue and green, the second green and red.
    BV_ENCODING_BAYER_BGGR16 = 16,
    // A colour a pixel, uint16_t: the first row green and blue, the second red and green.
    BV_ENCODING_BAYER_GBRG16 = 17,
    // A colour a pixel, uint16_t: the first row green and red, the second blue and green.
    BV_ENCODING_BAYER_GRBG16 = 18,
    // Two floats: flow in pixels, to the right and down; NaN where there is none.
    BV_ENCODING_F32C2 = 19,
    // Three floats: unit normals in the axes of the world; 0 where nothing is seen.
    BV_ENCODING_F32C3 = 20,
    // int32_t, a number of a thing or of a class; of things, -1 where nothing is seen.
    BV_ENCODING_I32C1 = 21,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum bv_encoding bv_encoding;
#else
typedef uint16_t bv_encoding;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What a simulator is told to do (bv_simulation_command.operation), and the fields that it looks at.
enum bv_operation
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint16_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Let simulated time stand.
    BV_OPERATION_PAUSE = 1,
    // Let it go on.
    BV_OPERATION_RESUME = 2,
    // Run steps of physics with all that is published on the way, then pause: steps.
    BV_OPERATION_STEP = 3,
    // Every model where it was at the start, at rest; time goes on.
    BV_OPERATION_RESET_WORLD = 4,
    // Begin again at time 0.
    BV_OPERATION_RESET_SIMULATION = 5,
    // Move a model: name, reference, position, orientation, linear, angular.
    BV_OPERATION_SET_MODEL_STATE = 6,
    // Put the model of the text into the world: name, reference, position, orientation, robot_namespace.
    BV_OPERATION_SPAWN = 7,
    // Take a model out: name.
    BV_OPERATION_DELETE = 8,
    // Change settings of the sensor, or of the one that sends the topic, name: `key=value` words in the text.
    BV_OPERATION_CONFIGURE = 9,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum bv_operation bv_operation;
#else
typedef uint16_t bv_operation;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How a lens maps directions to pixels, and its parameters (bv_intrinsics.distortion_model).
enum bv_distortion_model
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint16_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // k1 k2 p1 p2 k3; all 0 for a pinhole.
    BV_DISTORTION_MODEL_PLUMB_BOB = 1,
    // k1 k2 p1 p2 k3 k4 k5 k6, then s1 s2 s3 s4, then tau_x tau_y: 8, 12 or 14.
    BV_DISTORTION_MODEL_RATIONAL_POLYNOMIAL = 2,
    // k1 k2 k3 k4 of Kannala and Brandt, OpenCV's fisheye.
    BV_DISTORTION_MODEL_EQUIDISTANT = 3,
    // alpha beta
    BV_DISTORTION_MODEL_EUCM = 4,
    // xi alpha
    BV_DISTORTION_MODEL_DOUBLE_SPHERE = 5,
    // xi k1 k2 p1 p2
    BV_DISTORTION_MODEL_MEI = 6,
    // none
    BV_DISTORTION_MODEL_EQUIRECTANGULAR = 7,
    // c1 c2 c3 f fun cutoff of SDF's lens; f in pixels, fun 0 sin, 1 tan, 2 the angle itself.
    BV_DISTORTION_MODEL_WIDE_ANGLE = 8,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum bv_distortion_model bv_distortion_model;
#else
typedef uint16_t bv_distortion_model;
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

// How pixels map to directions.
typedef struct bv_intrinsics {
    double fx;
    double fy;
    double cx;
    double cy;
    // K[1]
    double skew;
    // parameters of the model, in its order
    double distortion[14];
    // metres
    float near;
    // metres
    float far;
    // P[3]
    float tx;
    // a bv_distortion_model; 0 none
    uint16_t distortion_model;
    // how many of distortion hold
    uint16_t distortion_len;
    uint64_t reserved[5];
} bv_intrinsics;

// Angles (radians) and limits (metres) of a lidar.
typedef struct bv_scan_geometry {
    double angle_min;
    double angle_increment;
    // seconds from ray to ray
    double time_increment;
    // seconds from scan to scan
    double scan_time;
    float range_min;
    float range_max;
    double vertical_angle_min;
    double vertical_angle_increment;
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

// The 384 bytes before every payload.
typedef struct bv_frame_header {
    // BV_MAGIC
    uint32_t magic;
    // 384
    uint16_t header_len;
    // BV_SCHEMA
    uint16_t schema;
    // a bv_kind
    uint16_t kind;
    // a bv_encoding
    uint16_t encoding;
    // BV_HAS_INTENSITIES
    uint32_t flags;
    // counts the frames of one session from 0
    uint64_t seq;
    // random per publisher life
    uint64_t session;
    // simulation time of capture
    uint64_t stamp_ns;
    // CLOCK_MONOTONIC of sending
    uint64_t publish_mono_ns;
    // elements per row
    uint32_t width;
    // rows
    uint32_t height;
    // bytes from row to row
    uint32_t row_stride;
    // bytes from element to element
    uint32_t elem_stride;
    uint64_t payload_len;
    // NUL-terminated
    char frame_id[64];
    // of the sensor in the world, metres
    double position[3];
    // of the sensor in the world, x y z w
    float orientation[4];
    union bv_block block;
} bv_frame_header;

// As geometry_msgs/Twist: x forward, y left, z up; m/s and rad/s.
typedef struct bv_velocity_command {
    double linear[3];
    double angular[3];
} bv_velocity_command;

// What a simulator is to do. A text of text_len bytes follows it in the payload.
typedef struct bv_simulation_command {
    // chosen at random by the sender; the result names it
    uint64_t id;
    // a bv_operation
    uint16_t operation;
    uint16_t reserved;
    // bytes of UTF-8 that follow, without a NUL
    uint32_t text_len;
    // steps of physics
    uint64_t steps;
    // the model that is meant; for configure a sensor, or a topic that it sends
    char name[64];
    // the frame of what follows: a model, model::link, or nothing for the world
    char reference[64];
    double position[3];
    // x y z w
    double orientation[4];
    double linear[3];
    double angular[3];
    // of what is spawned: stands before its topics and frames; empty for none
    char robot_namespace[64];
} bv_simulation_command;

// What became of a command.
typedef struct bv_simulation_result {
    // the command's
    uint64_t id;
    // simulated time after it
    uint64_t time_ns;
    // 1 done, 0 refused
    uint16_t done;
    // the command's
    uint16_t operation;
    uint32_t reserved;
    // why it was refused
    char reason[488];
} bv_simulation_result;

// As sensor_msgs/CameraInfo.
typedef struct bv_camera_info {
    uint32_t width;
    uint32_t height;
    // the model's name: plumb_bob, rational_polynomial, equidistant, eucm, double_sphere, mei, equirectangular, wide_angle
    char distortion_model[32];
    // parameters of the model, in its order
    double d[14];
    // how many of d hold
    uint32_t d_len;
    uint32_t reserved;
    double k[9];
    double r[9];
    double p[12];
} bv_camera_info;

// As nav_msgs/Odometry.
typedef struct bv_odometry {
    char child_frame_id[64];
    double position[3];
    // x y z w
    double orientation[4];
    double linear[3];
    double angular[3];
    double pose_covariance[36];
    double twist_covariance[36];
} bv_odometry;

// point_in_parent = parent_from_child * point_in_child
typedef struct bv_transform {
    char parent[64];
    char child[64];
    double translation[3];
    // x y z w
    double rotation[4];
} bv_transform;

// State of one joint.
typedef struct bv_joint_state {
    char name[64];
    double position;
    double velocity;
    double effort;
} bv_joint_state;

// The simulation's time.
typedef struct bv_clock {
    uint64_t now_ns;
} bv_clock;

// As sensor_msgs/Imu. A covariance of zeros is not known; one that begins with -1: not measured.
typedef struct bv_imu {
    // x y z w
    double orientation[4];
    // rad/s
    double angular_velocity[3];
    // m/s^2; +g upwards at rest
    double linear_acceleration[3];
    double orientation_covariance[9];
    double angular_velocity_covariance[9];
    double linear_acceleration_covariance[9];
} bv_imu;

// A sensor of a base that has changed its state.
typedef struct bv_robot_event {
    // 0 bumper, 1 cliff sensor, 2 wheel
    uint32_t source;
    // 0 left, 1 centre, 2 right
    uint32_t index;
    // 0 released, floor, raised; 1 pressed, cliff, dropped
    uint32_t state;
    // a cliff sensor's reading, else 0
    uint32_t value;
} bv_robot_event;

// As kobuki_msgs/SensorState. Bits of bumper and cliff: 1 right, 2 centre, 4 left; of wheel_drop: 1 right, 2 left.
typedef struct bv_core_sensors {
    // milliseconds; wraps
    uint16_t time_stamp;
    uint8_t bumper;
    uint8_t wheel_drop;
    uint8_t cliff;
    uint8_t buttons;
    // ticks; wraps
    uint16_t left_encoder;
    // ticks; wraps
    uint16_t right_encoder;
    int8_t left_pwm;
    int8_t right_pwm;
    // 0 discharging, 2 charged, 6 charging
    uint8_t charger;
    // tenths of a volt
    uint8_t battery;
    // cliff readings right, centre, left
    uint16_t bottom[3];
} bv_core_sensors;

// Odometry is to begin at zero here and now.
typedef struct bv_reset_odometry {
    uint64_t reserved;
} bv_reset_odometry;

// Whether the motors follow commands.
typedef struct bv_motor_power {
    // 0 off, else on
    uint32_t state;
} bv_motor_power;

// As sensor_msgs/Range: distance to the nearest thing within a cone.
typedef struct bv_range {
    // 0 ultrasound, 1 infrared
    uint32_t radiation_type;
    // full angle of the cone, radians
    float field_of_view;
    // metres
    float min_range;
    // metres
    float max_range;
    // metres; -inf too near, +inf nothing in range
    float range;
} bv_range;

// A number that can be set; all three are NaN where a sensor has no such setting.
typedef struct bv_setting {
    double value;
    double min;
    double max;
} bv_setting;

// What of a sensor can be changed, under the names by which the operation configure changes it.
typedef struct bv_sensor_settings {
    // the sensor's name in the robot's description
    char name[64];
    // the streams that it sends, without leading slashes; the rest is empty
    char topics[6][256];
    // frames per second
    struct bv_setting update_rate;
    // of colours in [0, 1] for a camera, of ranges in metres for a lidar
    struct bv_setting noise_mean;
    struct bv_setting noise_stddev;
    // share of the light that a camera's description gives it, 1 as described
    struct bv_setting exposure;
} bv_sensor_settings;

// Where a model or a link is in the world, and how it moves.
typedef struct bv_model_state {
    // model, or model::link
    char name[128];
    double position[3];
    // x y z w
    double orientation[4];
    double linear[3];
    double angular[3];
} bv_model_state;

// What is seen of a thing, and where all of it is in the optical frame of the sensor: x right, y down, z forward.
typedef struct bv_bounding_box {
    // its number, as in the picture of instances
    uint32_t instance;
    // its class, as in the picture of classes
    uint32_t label;
    // how many pixels show it
    uint32_t pixels;
    // first column and row
    uint32_t min[2];
    // last column and row
    uint32_t max[2];
    uint32_t reserved;
    // middle of the box that holds the whole of it, metres
    double position[3];
    // x y z w
    double orientation[4];
    // edges of that box, metres
    double size[3];
} bv_bounding_box;

// Where a tag is seen, and its pose in the optical frame of the sensor: its own x right, y up, z towards the reader.
typedef struct bv_tag_detection {
    // as the file says: tag36h11, qr
    char family[32];
    // its number in the family
    uint32_t id;
    // for each corner 1 if it is in the picture and nothing hides it, else 0
    uint8_t visible[4];
    // edge of its square without the white margin, metres
    double size;
    // column and row of top left, top right, bottom right, bottom left as one reads it; NaN where the lens has no pixel
    double corners[4][2];
    // its middle, metres
    double position[3];
    // x y z w
    double orientation[4];
} bv_tag_detection;

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
