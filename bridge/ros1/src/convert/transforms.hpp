// Transforms between frames.
#pragma once

#include <tf2_msgs/TFMessage.h>

#include "header.hpp"

namespace belvedere_ros {

/// Converts moving or fixed transforms, all with the stamp of the frame. With a `parent`, only those in that frame.
tf2_msgs::TFMessagePtr to_transforms(const Sample& sample, const std::string& parent = {});

}  // namespace belvedere_ros
