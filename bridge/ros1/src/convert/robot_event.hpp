// Events of the base's sensors.
#pragma once

#include <kobuki_msgs/BumperEvent.h>
#include <kobuki_msgs/CliffEvent.h>
#include <kobuki_msgs/WheelDropEvent.h>

#include "header.hpp"

namespace belvedere_ros {

/// Each of the three throws Unrepresentable for an event of another source, and for a place where a Kobuki has no
/// sensor.
kobuki_msgs::BumperEventPtr to_bumper_event(const Sample& sample);
kobuki_msgs::CliffEventPtr to_cliff_event(const Sample& sample);
kobuki_msgs::WheelDropEventPtr to_wheel_drop_event(const Sample& sample);

}  // namespace belvedere_ros
