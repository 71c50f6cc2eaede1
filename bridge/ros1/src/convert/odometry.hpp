// Odometry from the robot's wheels and gyro.
#pragma once

#include <nav_msgs/Odometry.h>

#include "header.hpp"

namespace belvedere_ros {

/// Converts the pose in frame_id and the velocity in child_frame_id, with their covariances.
nav_msgs::OdometryPtr to_odometry(const Sample& sample);

}  // namespace belvedere_ros
