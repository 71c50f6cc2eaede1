// The simulation's time.
#pragma once

#include <rosgraph_msgs/Clock.h>

#include "header.hpp"

namespace belvedere_ros {

/// For /clock, which nodes with use_sim_time live by.
rosgraph_msgs::ClockPtr to_clock(const Sample& sample);

}  // namespace belvedere_ros
