// Conversion of a scan with several layers to a cloud.
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include "header.hpp"

namespace belvedere_ros {

/// Converts a scan to an organised cloud: one row per layer, the lowest first, and one column per ray. Its fields are
/// those of Velodyne's driver: x, y, z, intensity if available, ring (the layer), time (seconds after the stamp). A ray
/// without a range is NaN.
sensor_msgs::PointCloud2Ptr to_scan_cloud(const Sample& sample);

}  // namespace belvedere_ros
