// What an inertial measurement unit measures.
#pragma once

#include <sensor_msgs/Imu.h>

#include "header.hpp"

namespace belvedere_ros {

/// By REP-145: +g upwards at rest; covariances of zeros are not known, -1 first is not measured.
sensor_msgs::ImuPtr to_imu(const Sample& sample);

}  // namespace belvedere_ros
