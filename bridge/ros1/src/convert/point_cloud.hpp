// Clouds of coloured points.
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include "header.hpp"

namespace belvedere_ros {

/// Fields x, y, z and rgb, of 32 bytes a point, as depth cameras' drivers send them; organised when the stream is. The
/// bytes are taken as they are: one copy. Never called dense, since points may be NaN.
sensor_msgs::PointCloud2Ptr to_point_cloud(const Sample& sample);

}  // namespace belvedere_ros
