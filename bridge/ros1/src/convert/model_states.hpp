// Poses and velocities of all models or links.
#pragma once

#include <gazebo_msgs/LinkStates.h>
#include <gazebo_msgs/ModelStates.h>

#include "header.hpp"

namespace belvedere_ros {

/// Converts names, poses and velocities in the world, in the order of the stream.
gazebo_msgs::ModelStatesPtr to_model_states(const Sample& sample);

/// Converts a stream of links, whose names are model::link.
gazebo_msgs::LinkStatesPtr to_link_states(const Sample& sample);

}  // namespace belvedere_ros
