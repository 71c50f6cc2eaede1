// The offsets in Belvedere's frames, checked at compile time against compiler flags that change layouts.
// SPDX-License-Identifier: MIT OR Apache-2.0
//
// Generated from bridge/src/wire by bridge/c/tests/bindings; do not edit.
#ifndef BELVEDERE_WIRE_HPP
#define BELVEDERE_WIRE_HPP

#include <cstddef>
#include <cstdint>

#include "belvedere.h"

#define BELVEDERE_AT(type, field, offset) \
    static_assert(offsetof(type, field) == (offset), #type "." #field " is not where the wire format has it")
static_assert(sizeof(bv_frame_header) == 384, "wire format");
BELVEDERE_AT(bv_frame_header, magic, 0);
BELVEDERE_AT(bv_frame_header, header_len, 4);
BELVEDERE_AT(bv_frame_header, schema, 6);
BELVEDERE_AT(bv_frame_header, kind, 8);
BELVEDERE_AT(bv_frame_header, encoding, 10);
BELVEDERE_AT(bv_frame_header, flags, 12);
BELVEDERE_AT(bv_frame_header, seq, 16);
BELVEDERE_AT(bv_frame_header, session, 24);
BELVEDERE_AT(bv_frame_header, stamp_ns, 32);
BELVEDERE_AT(bv_frame_header, publish_mono_ns, 40);
BELVEDERE_AT(bv_frame_header, width, 48);
BELVEDERE_AT(bv_frame_header, height, 52);
BELVEDERE_AT(bv_frame_header, row_stride, 56);
BELVEDERE_AT(bv_frame_header, elem_stride, 60);
BELVEDERE_AT(bv_frame_header, payload_len, 64);
BELVEDERE_AT(bv_frame_header, frame_id, 72);
BELVEDERE_AT(bv_frame_header, position, 136);
BELVEDERE_AT(bv_frame_header, orientation, 160);
BELVEDERE_AT(bv_frame_header, block, 176);
static_assert(sizeof(bv_intrinsics) == 208, "wire format");
BELVEDERE_AT(bv_intrinsics, fx, 0);
BELVEDERE_AT(bv_intrinsics, fy, 8);
BELVEDERE_AT(bv_intrinsics, cx, 16);
BELVEDERE_AT(bv_intrinsics, cy, 24);
BELVEDERE_AT(bv_intrinsics, skew, 32);
BELVEDERE_AT(bv_intrinsics, distortion, 40);
BELVEDERE_AT(bv_intrinsics, near, 152);
BELVEDERE_AT(bv_intrinsics, far, 156);
BELVEDERE_AT(bv_intrinsics, tx, 160);
BELVEDERE_AT(bv_intrinsics, distortion_model, 164);
BELVEDERE_AT(bv_intrinsics, distortion_len, 166);
BELVEDERE_AT(bv_intrinsics, reserved, 168);
static_assert(sizeof(bv_scan_geometry) == 208, "wire format");
BELVEDERE_AT(bv_scan_geometry, angle_min, 0);
BELVEDERE_AT(bv_scan_geometry, angle_increment, 8);
BELVEDERE_AT(bv_scan_geometry, time_increment, 16);
BELVEDERE_AT(bv_scan_geometry, scan_time, 24);
BELVEDERE_AT(bv_scan_geometry, range_min, 32);
BELVEDERE_AT(bv_scan_geometry, range_max, 36);
BELVEDERE_AT(bv_scan_geometry, vertical_angle_min, 40);
BELVEDERE_AT(bv_scan_geometry, vertical_angle_increment, 48);
BELVEDERE_AT(bv_scan_geometry, reserved, 56);
static_assert(sizeof(bv_camera_info) == 400, "wire format");
BELVEDERE_AT(bv_camera_info, width, 0);
BELVEDERE_AT(bv_camera_info, height, 4);
BELVEDERE_AT(bv_camera_info, distortion_model, 8);
BELVEDERE_AT(bv_camera_info, d, 40);
BELVEDERE_AT(bv_camera_info, d_len, 152);
BELVEDERE_AT(bv_camera_info, reserved, 156);
BELVEDERE_AT(bv_camera_info, k, 160);
BELVEDERE_AT(bv_camera_info, r, 232);
BELVEDERE_AT(bv_camera_info, p, 304);
static_assert(sizeof(bv_odometry) == 744, "wire format");
BELVEDERE_AT(bv_odometry, child_frame_id, 0);
BELVEDERE_AT(bv_odometry, position, 64);
BELVEDERE_AT(bv_odometry, orientation, 88);
BELVEDERE_AT(bv_odometry, linear, 120);
BELVEDERE_AT(bv_odometry, angular, 144);
BELVEDERE_AT(bv_odometry, pose_covariance, 168);
BELVEDERE_AT(bv_odometry, twist_covariance, 456);
static_assert(sizeof(bv_transform) == 184, "wire format");
BELVEDERE_AT(bv_transform, parent, 0);
BELVEDERE_AT(bv_transform, child, 64);
BELVEDERE_AT(bv_transform, translation, 128);
BELVEDERE_AT(bv_transform, rotation, 152);
static_assert(sizeof(bv_joint_state) == 88, "wire format");
BELVEDERE_AT(bv_joint_state, name, 0);
BELVEDERE_AT(bv_joint_state, position, 64);
BELVEDERE_AT(bv_joint_state, velocity, 72);
BELVEDERE_AT(bv_joint_state, effort, 80);
static_assert(sizeof(bv_clock) == 8, "wire format");
BELVEDERE_AT(bv_clock, now_ns, 0);
static_assert(sizeof(bv_velocity_command) == 48, "wire format");
BELVEDERE_AT(bv_velocity_command, linear, 0);
BELVEDERE_AT(bv_velocity_command, angular, 24);
static_assert(sizeof(bv_imu) == 296, "wire format");
BELVEDERE_AT(bv_imu, orientation, 0);
BELVEDERE_AT(bv_imu, angular_velocity, 32);
BELVEDERE_AT(bv_imu, linear_acceleration, 56);
BELVEDERE_AT(bv_imu, orientation_covariance, 80);
BELVEDERE_AT(bv_imu, angular_velocity_covariance, 152);
BELVEDERE_AT(bv_imu, linear_acceleration_covariance, 224);
static_assert(sizeof(bv_robot_event) == 16, "wire format");
BELVEDERE_AT(bv_robot_event, source, 0);
BELVEDERE_AT(bv_robot_event, index, 4);
BELVEDERE_AT(bv_robot_event, state, 8);
BELVEDERE_AT(bv_robot_event, value, 12);
static_assert(sizeof(bv_core_sensors) == 20, "wire format");
BELVEDERE_AT(bv_core_sensors, time_stamp, 0);
BELVEDERE_AT(bv_core_sensors, bumper, 2);
BELVEDERE_AT(bv_core_sensors, wheel_drop, 3);
BELVEDERE_AT(bv_core_sensors, cliff, 4);
BELVEDERE_AT(bv_core_sensors, buttons, 5);
BELVEDERE_AT(bv_core_sensors, left_encoder, 6);
BELVEDERE_AT(bv_core_sensors, right_encoder, 8);
BELVEDERE_AT(bv_core_sensors, left_pwm, 10);
BELVEDERE_AT(bv_core_sensors, right_pwm, 11);
BELVEDERE_AT(bv_core_sensors, charger, 12);
BELVEDERE_AT(bv_core_sensors, battery, 13);
BELVEDERE_AT(bv_core_sensors, bottom, 14);
static_assert(sizeof(bv_reset_odometry) == 8, "wire format");
BELVEDERE_AT(bv_reset_odometry, reserved, 0);
static_assert(sizeof(bv_motor_power) == 4, "wire format");
BELVEDERE_AT(bv_motor_power, state, 0);
static_assert(sizeof(bv_simulation_command) == 320, "wire format");
BELVEDERE_AT(bv_simulation_command, id, 0);
BELVEDERE_AT(bv_simulation_command, operation, 8);
BELVEDERE_AT(bv_simulation_command, reserved, 10);
BELVEDERE_AT(bv_simulation_command, text_len, 12);
BELVEDERE_AT(bv_simulation_command, steps, 16);
BELVEDERE_AT(bv_simulation_command, name, 24);
BELVEDERE_AT(bv_simulation_command, reference, 88);
BELVEDERE_AT(bv_simulation_command, position, 152);
BELVEDERE_AT(bv_simulation_command, orientation, 176);
BELVEDERE_AT(bv_simulation_command, linear, 208);
BELVEDERE_AT(bv_simulation_command, angular, 232);
BELVEDERE_AT(bv_simulation_command, robot_namespace, 256);
static_assert(sizeof(bv_simulation_result) == 512, "wire format");
BELVEDERE_AT(bv_simulation_result, id, 0);
BELVEDERE_AT(bv_simulation_result, time_ns, 8);
BELVEDERE_AT(bv_simulation_result, done, 16);
BELVEDERE_AT(bv_simulation_result, operation, 18);
BELVEDERE_AT(bv_simulation_result, reserved, 20);
BELVEDERE_AT(bv_simulation_result, reason, 24);
static_assert(sizeof(bv_model_state) == 232, "wire format");
BELVEDERE_AT(bv_model_state, name, 0);
BELVEDERE_AT(bv_model_state, position, 128);
BELVEDERE_AT(bv_model_state, orientation, 152);
BELVEDERE_AT(bv_model_state, linear, 184);
BELVEDERE_AT(bv_model_state, angular, 208);
static_assert(sizeof(bv_nav_sat_fix) == 120, "wire format");
BELVEDERE_AT(bv_nav_sat_fix, latitude, 0);
BELVEDERE_AT(bv_nav_sat_fix, longitude, 8);
BELVEDERE_AT(bv_nav_sat_fix, altitude, 16);
BELVEDERE_AT(bv_nav_sat_fix, velocity, 24);
BELVEDERE_AT(bv_nav_sat_fix, position_covariance, 48);
static_assert(sizeof(bv_magnetic_field) == 96, "wire format");
BELVEDERE_AT(bv_magnetic_field, magnetic_field, 0);
BELVEDERE_AT(bv_magnetic_field, covariance, 24);
static_assert(sizeof(bv_fluid_pressure) == 16, "wire format");
BELVEDERE_AT(bv_fluid_pressure, fluid_pressure, 0);
BELVEDERE_AT(bv_fluid_pressure, variance, 8);
static_assert(sizeof(bv_altimeter) == 32, "wire format");
BELVEDERE_AT(bv_altimeter, vertical_position, 0);
BELVEDERE_AT(bv_altimeter, vertical_velocity, 8);
BELVEDERE_AT(bv_altimeter, vertical_reference, 16);
BELVEDERE_AT(bv_altimeter, variance, 24);
static_assert(sizeof(bv_vector3) == 24, "wire format");
BELVEDERE_AT(bv_vector3, vector, 0);
static_assert(sizeof(bv_range) == 20, "wire format");
BELVEDERE_AT(bv_range, radiation_type, 0);
BELVEDERE_AT(bv_range, field_of_view, 4);
BELVEDERE_AT(bv_range, min_range, 8);
BELVEDERE_AT(bv_range, max_range, 12);
BELVEDERE_AT(bv_range, range, 16);
static_assert(sizeof(bv_setting) == 24, "wire format");
BELVEDERE_AT(bv_setting, value, 0);
BELVEDERE_AT(bv_setting, min, 8);
BELVEDERE_AT(bv_setting, max, 16);
static_assert(sizeof(bv_sensor_settings) == 1696, "wire format");
BELVEDERE_AT(bv_sensor_settings, name, 0);
BELVEDERE_AT(bv_sensor_settings, topics, 64);
BELVEDERE_AT(bv_sensor_settings, update_rate, 1600);
BELVEDERE_AT(bv_sensor_settings, noise_mean, 1624);
BELVEDERE_AT(bv_sensor_settings, noise_stddev, 1648);
BELVEDERE_AT(bv_sensor_settings, exposure, 1672);
static_assert(sizeof(bv_bounding_box) == 112, "wire format");
BELVEDERE_AT(bv_bounding_box, instance, 0);
BELVEDERE_AT(bv_bounding_box, label, 4);
BELVEDERE_AT(bv_bounding_box, pixels, 8);
BELVEDERE_AT(bv_bounding_box, min, 12);
BELVEDERE_AT(bv_bounding_box, max, 20);
BELVEDERE_AT(bv_bounding_box, reserved, 28);
BELVEDERE_AT(bv_bounding_box, position, 32);
BELVEDERE_AT(bv_bounding_box, orientation, 56);
BELVEDERE_AT(bv_bounding_box, size, 88);
static_assert(sizeof(bv_tag_detection) == 168, "wire format");
BELVEDERE_AT(bv_tag_detection, family, 0);
BELVEDERE_AT(bv_tag_detection, id, 32);
BELVEDERE_AT(bv_tag_detection, visible, 36);
BELVEDERE_AT(bv_tag_detection, size, 40);
BELVEDERE_AT(bv_tag_detection, corners, 48);
BELVEDERE_AT(bv_tag_detection, position, 112);
BELVEDERE_AT(bv_tag_detection, orientation, 136);
#undef BELVEDERE_AT

namespace belvedere {
namespace detail {

/// Returns true if streams of this kind carry Ts.
template <class T>
constexpr bool carries(std::uint16_t kind) = delete;
template <>
constexpr bool carries<bv_camera_info>(std::uint16_t kind) {
    return kind == BV_KIND_CAMERA_INFO;
}
template <>
constexpr bool carries<bv_odometry>(std::uint16_t kind) {
    return kind == BV_KIND_ODOMETRY;
}
template <>
constexpr bool carries<bv_transform>(std::uint16_t kind) {
    return kind == BV_KIND_TRANSFORMS || kind == BV_KIND_STATIC_TRANSFORMS;
}
template <>
constexpr bool carries<bv_joint_state>(std::uint16_t kind) {
    return kind == BV_KIND_JOINT_STATES;
}
template <>
constexpr bool carries<bv_clock>(std::uint16_t kind) {
    return kind == BV_KIND_CLOCK;
}
template <>
constexpr bool carries<bv_velocity_command>(std::uint16_t kind) {
    return kind == BV_KIND_VELOCITY_COMMAND;
}
template <>
constexpr bool carries<bv_imu>(std::uint16_t kind) {
    return kind == BV_KIND_IMU;
}
template <>
constexpr bool carries<bv_robot_event>(std::uint16_t kind) {
    return kind == BV_KIND_ROBOT_EVENT;
}
template <>
constexpr bool carries<bv_core_sensors>(std::uint16_t kind) {
    return kind == BV_KIND_CORE_SENSORS;
}
template <>
constexpr bool carries<bv_reset_odometry>(std::uint16_t kind) {
    return kind == BV_KIND_RESET_ODOMETRY;
}
template <>
constexpr bool carries<bv_motor_power>(std::uint16_t kind) {
    return kind == BV_KIND_MOTOR_POWER;
}
template <>
constexpr bool carries<bv_simulation_command>(std::uint16_t kind) {
    return kind == BV_KIND_SIMULATION_COMMAND;
}
template <>
constexpr bool carries<bv_simulation_result>(std::uint16_t kind) {
    return kind == BV_KIND_SIMULATION_RESULT;
}
template <>
constexpr bool carries<bv_model_state>(std::uint16_t kind) {
    return kind == BV_KIND_MODEL_STATES;
}
template <>
constexpr bool carries<bv_nav_sat_fix>(std::uint16_t kind) {
    return kind == BV_KIND_NAV_SAT_FIX;
}
template <>
constexpr bool carries<bv_magnetic_field>(std::uint16_t kind) {
    return kind == BV_KIND_MAGNETIC_FIELD;
}
template <>
constexpr bool carries<bv_fluid_pressure>(std::uint16_t kind) {
    return kind == BV_KIND_FLUID_PRESSURE;
}
template <>
constexpr bool carries<bv_altimeter>(std::uint16_t kind) {
    return kind == BV_KIND_ALTIMETER;
}
template <>
constexpr bool carries<bv_vector3>(std::uint16_t kind) {
    return kind == BV_KIND_VECTOR3;
}
template <>
constexpr bool carries<bv_range>(std::uint16_t kind) {
    return kind == BV_KIND_RANGE;
}
template <>
constexpr bool carries<bv_sensor_settings>(std::uint16_t kind) {
    return kind == BV_KIND_SENSOR_SETTINGS;
}
template <>
constexpr bool carries<bv_bounding_box>(std::uint16_t kind) {
    return kind == BV_KIND_BOUNDING_BOXES;
}
template <>
constexpr bool carries<bv_tag_detection>(std::uint16_t kind) {
    return kind == BV_KIND_TAG_DETECTIONS;
}

}  // namespace detail
}  // namespace belvedere

#endif  // BELVEDERE_WIRE_HPP
