// What the base says of all its sensors at once.
#pragma once

#include <kobuki_msgs/SensorState.h>

#include "header.hpp"

namespace belvedere_ros {

/// Bits and units are the same. Currents and inputs, which are not simulated, are as many zeros as a Kobuki sends.
kobuki_msgs::SensorStatePtr to_core_sensors(const Sample& sample);

}  // namespace belvedere_ros
