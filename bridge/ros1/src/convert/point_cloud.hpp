// Point clouds.
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include "header.hpp"

namespace belvedere_ros {

/// Converts a cloud in one copy. Its fields are x, y, z and rgb in points of 32 bytes, as in depth camera drivers; x,
/// y, z, intensity, ring and time in points of 22 bytes, as in Velodyne's driver; or those of the other lidar drivers.
/// It is organised if the stream is. It is marked dense if no point can be NaN: a lidar's cloud in one row.
sensor_msgs::PointCloud2Ptr to_point_cloud(const Sample& sample);

}  // namespace belvedere_ros
