// Simulated time.
#pragma once

#include <rosgraph_msgs/Clock.h>

#include "header.hpp"

namespace belvedere_ros {

/// Converts the time for /clock, which nodes with use_sim_time follow.
rosgraph_msgs::ClockPtr to_clock(const Sample& sample);

}  // namespace belvedere_ros
