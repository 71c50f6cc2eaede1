// How pixels of an image map to directions.
#pragma once

#include <sensor_msgs/CameraInfo.h>

#include "header.hpp"

namespace belvedere_ros {

/// As REP-104 has it: D as long as the model's, K and P filled in, stamp and frame_id those of the image.
sensor_msgs::CameraInfoPtr to_camera_info(const Sample& sample);

}  // namespace belvedere_ros
