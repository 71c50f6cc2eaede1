// A scan of several layers as a cloud.
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include "header.hpp"

namespace belvedere_ros {

/// Organised: a row for each layer, the lowest first, and a column for each ray. Fields as those of a Velodyne's driver:
/// x, y, z, intensity where there is one, ring (the layer), time (seconds after the stamp). A ray that measures nothing is
/// NaN.
sensor_msgs::PointCloud2Ptr to_scan_cloud(const Sample& sample);

}  // namespace belvedere_ros
