// What ROS tells the robot, as the simulator takes it.
#pragma once

#include <belvedere.h>
#include <geometry_msgs/Twist.h>
#include <kobuki_msgs/MotorPower.h>
#include <std_msgs/Empty.h>

namespace belvedere_ros {

/// Unrepresentable for a velocity that is not finite.
bv_velocity_command from_twist(const geometry_msgs::Twist& twist);
/// Unrepresentable for a state that is neither on nor off.
bv_motor_power from_motor_power(const kobuki_msgs::MotorPower& power);
bv_reset_odometry from_empty(const std_msgs::Empty& empty);

}  // namespace belvedere_ros
