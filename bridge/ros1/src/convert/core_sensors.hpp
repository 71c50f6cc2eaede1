// The state of all sensors of the base.
#pragma once

#include <kobuki_msgs/SensorState.h>

#include "header.hpp"

namespace belvedere_ros {

/// Converts the state, whose bits and units are the same. Currents and inputs are not simulated; the message has as
/// many zeros for them as a Kobuki sends values.
kobuki_msgs::SensorStatePtr to_core_sensors(const Sample& sample);

}  // namespace belvedere_ros
