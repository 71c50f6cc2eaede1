// Ranges of a lidar of one layer.
#pragma once

#include <sensor_msgs/LaserScan.h>

#include "header.hpp"

namespace belvedere_ros {

/// Stamped at its first ray, counter-clockwise about +z; -inf too near, +inf nothing in range (REP-117). Without
/// intensities, their array is empty. Unrepresentable for a lidar of several layers.
sensor_msgs::LaserScanPtr to_laser_scan(const Sample& sample);

}  // namespace belvedere_ros
