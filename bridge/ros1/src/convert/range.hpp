// The measurement of a rangefinder.
#pragma once

#include <sensor_msgs/Range.h>

#include "header.hpp"

namespace belvedere_ros {

sensor_msgs::RangePtr to_range(const Sample& sample);

}  // namespace belvedere_ros
