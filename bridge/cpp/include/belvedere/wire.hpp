// Where everything lies in Belvedere's frames, held at compile time. SPDX-License-Identifier: MIT OR Apache-2.0
#ifndef BELVEDERE_WIRE_HPP
#define BELVEDERE_WIRE_HPP

#include <cstddef>

#include "belvedere.h"

// The wire format: every offset is pinned here, in Rust and in bridge/WIRE.md.
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
static_assert(sizeof(bv_scan_geometry) == 208, "wire format");
BELVEDERE_AT(bv_scan_geometry, angle_min, 0);
BELVEDERE_AT(bv_scan_geometry, angle_increment, 8);
BELVEDERE_AT(bv_scan_geometry, time_increment, 16);
BELVEDERE_AT(bv_scan_geometry, scan_time, 24);
BELVEDERE_AT(bv_scan_geometry, range_min, 32);
BELVEDERE_AT(bv_scan_geometry, range_max, 36);
BELVEDERE_AT(bv_scan_geometry, vertical_angle_min, 40);
BELVEDERE_AT(bv_scan_geometry, vertical_angle_increment, 48);
static_assert(sizeof(bv_camera_info) == 400, "wire format");
BELVEDERE_AT(bv_camera_info, distortion_model, 8);
BELVEDERE_AT(bv_camera_info, d, 40);
BELVEDERE_AT(bv_camera_info, d_len, 152);
BELVEDERE_AT(bv_camera_info, k, 160);
BELVEDERE_AT(bv_camera_info, r, 232);
BELVEDERE_AT(bv_camera_info, p, 304);
static_assert(sizeof(bv_odometry) == 744, "wire format");
BELVEDERE_AT(bv_odometry, position, 64);
BELVEDERE_AT(bv_odometry, orientation, 88);
BELVEDERE_AT(bv_odometry, linear, 120);
BELVEDERE_AT(bv_odometry, angular, 144);
BELVEDERE_AT(bv_odometry, pose_covariance, 168);
BELVEDERE_AT(bv_odometry, twist_covariance, 456);
static_assert(sizeof(bv_transform) == 184, "wire format");
BELVEDERE_AT(bv_transform, child, 64);
BELVEDERE_AT(bv_transform, translation, 128);
BELVEDERE_AT(bv_transform, rotation, 152);
static_assert(sizeof(bv_joint_state) == 88, "wire format");
BELVEDERE_AT(bv_joint_state, position, 64);
BELVEDERE_AT(bv_joint_state, velocity, 72);
BELVEDERE_AT(bv_joint_state, effort, 80);
static_assert(sizeof(bv_clock) == 8, "wire format");
static_assert(sizeof(bv_velocity_command) == 48, "wire format");
BELVEDERE_AT(bv_velocity_command, angular, 24);
static_assert(sizeof(bv_imu) == 296, "wire format");
BELVEDERE_AT(bv_imu, angular_velocity, 32);
BELVEDERE_AT(bv_imu, linear_acceleration, 56);
BELVEDERE_AT(bv_imu, orientation_covariance, 80);
BELVEDERE_AT(bv_imu, angular_velocity_covariance, 152);
BELVEDERE_AT(bv_imu, linear_acceleration_covariance, 224);
static_assert(sizeof(bv_robot_event) == 16, "wire format");
BELVEDERE_AT(bv_robot_event, index, 4);
BELVEDERE_AT(bv_robot_event, state, 8);
BELVEDERE_AT(bv_robot_event, value, 12);
static_assert(sizeof(bv_core_sensors) == 20, "wire format");
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
static_assert(sizeof(bv_motor_power) == 4, "wire format");
static_assert(sizeof(bv_range) == 20, "wire format");
BELVEDERE_AT(bv_range, field_of_view, 4);
BELVEDERE_AT(bv_range, min_range, 8);
BELVEDERE_AT(bv_range, max_range, 12);
BELVEDERE_AT(bv_range, range, 16);
static_assert(sizeof(bv_setting) == 24, "wire format");
BELVEDERE_AT(bv_setting, min, 8);
BELVEDERE_AT(bv_setting, max, 16);
static_assert(sizeof(bv_sensor_settings) == 1696, "wire format");
BELVEDERE_AT(bv_sensor_settings, topics, 64);
BELVEDERE_AT(bv_sensor_settings, update_rate, 1600);
BELVEDERE_AT(bv_sensor_settings, noise_mean, 1624);
BELVEDERE_AT(bv_sensor_settings, noise_stddev, 1648);
BELVEDERE_AT(bv_sensor_settings, exposure, 1672);
static_assert(sizeof(bv_simulation_command) == 320, "wire format");
BELVEDERE_AT(bv_simulation_command, operation, 8);
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
BELVEDERE_AT(bv_simulation_result, time_ns, 8);
BELVEDERE_AT(bv_simulation_result, done, 16);
BELVEDERE_AT(bv_simulation_result, operation, 18);
BELVEDERE_AT(bv_simulation_result, reason, 24);
static_assert(sizeof(bv_model_state) == 232, "wire format");
BELVEDERE_AT(bv_model_state, position, 128);
BELVEDERE_AT(bv_model_state, orientation, 152);
BELVEDERE_AT(bv_model_state, linear, 184);
BELVEDERE_AT(bv_model_state, angular, 208);
#undef BELVEDERE_AT

#endif  // BELVEDERE_WIRE_HPP
