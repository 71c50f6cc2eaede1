// Ranges of a lidar with one layer.
#pragma once

#include <sensor_msgs/LaserScan.h>

#include "header.hpp"

namespace belvedere_ros {

/// Converts a scan, with the stamp of its first ray, counter-clockwise about +z; -inf too near, +inf nothing in range
/// (REP-117). The array of intensities is empty if there are none. Throws Unrepresentable for a lidar with several
/// layers.
sensor_msgs::LaserScanPtr to_laser_scan(const Sample& sample);

}  // namespace belvedere_ros
