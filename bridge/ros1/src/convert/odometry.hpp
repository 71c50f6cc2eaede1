// What the robot's wheels and gyro say of its way.
#pragma once

#include <nav_msgs/Odometry.h>

#include "header.hpp"

namespace belvedere_ros {

/// Pose in frame_id, velocity in child_frame_id, with their covariances.
nav_msgs::OdometryPtr to_odometry(const Sample& sample);

}  // namespace belvedere_ros
