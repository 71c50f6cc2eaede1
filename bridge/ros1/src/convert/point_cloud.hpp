// Clouds of points.
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include "header.hpp"

namespace belvedere_ros {

/// Fields x, y, z and rgb, of 32 bytes a point, as depth cameras' drivers send them; or x, y, z, intensity, ring and time,
/// of 22 bytes, as Velodyne's does. Organised when the stream is. The bytes are taken as they are: one copy. Called dense
/// where no point can be NaN: of a lidar in one row.
sensor_msgs::PointCloud2Ptr to_point_cloud(const Sample& sample);

}  // namespace belvedere_ros
