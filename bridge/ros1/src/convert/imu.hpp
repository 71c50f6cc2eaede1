// The measurement of an inertial measurement unit.
#pragma once

#include <sensor_msgs/Imu.h>

#include "header.hpp"

namespace belvedere_ros {

/// Converts a measurement as specified by REP-145: +g upwards at rest; a covariance of zeros means unknown, −1 as its
/// first element means not measured.
sensor_msgs::ImuPtr to_imu(const Sample& sample);

}  // namespace belvedere_ros
