// The states of joints.
#pragma once

#include <sensor_msgs/JointState.h>

#include "header.hpp"

namespace belvedere_ros {

/// Converts all movable joints, in the order of the stream; radians or metres.
sensor_msgs::JointStatePtr to_joint_states(const Sample& sample);

}  // namespace belvedere_ros
