// Images and depth images.
#pragma once

#include <sensor_msgs/Image.h>

#include "header.hpp"

namespace belvedere_ros {

/// Converts an image (rgb8, bgr8, rgba8, mono8, mono16, bayer_…) or a depth image (32FC1 in metres, 16UC1 in
/// millimetres; REP-118) in one copy, including the padding of rows. Throws Unrepresentable for other encodings and for
/// gaps between pixels.
sensor_msgs::ImagePtr to_image(const Sample& sample);

}  // namespace belvedere_ros
