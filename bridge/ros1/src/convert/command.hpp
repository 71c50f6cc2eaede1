// Conversion of ROS's commands for the simulator.
#pragma once

#include <belvedere.h>
#include <geometry_msgs/Twist.h>
#include <kobuki_msgs/MotorPower.h>
#include <std_msgs/Empty.h>

namespace belvedere_ros {

/// Converts a velocity; throws Unrepresentable if it is not finite.
bv_velocity_command from_twist(const geometry_msgs::Twist& twist);
/// Converts a state; throws Unrepresentable if it is neither on nor off.
bv_motor_power from_motor_power(const kobuki_msgs::MotorPower& power);
bv_reset_odometry from_empty(const std_msgs::Empty& empty);

}  // namespace belvedere_ros
