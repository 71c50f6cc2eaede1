// The calibration of a camera.
#pragma once

#include <sensor_msgs/CameraInfo.h>

#include "header.hpp"

namespace belvedere_ros {

/// Converts a camera_info as specified by REP-104: D has the length of the model's parameters, K and P are filled in,
/// stamp and frame_id are those of the image.
sensor_msgs::CameraInfoPtr to_camera_info(const Sample& sample);

}  // namespace belvedere_ros
