// Where frames are in other frames.
#pragma once

#include <tf2_msgs/TFMessage.h>

#include "header.hpp"

namespace belvedere_ros {

/// Moving and fixed transforms alike; all have the stamp of the frame. With a `parent`, only those that are given in it.
tf2_msgs::TFMessagePtr to_transforms(const Sample& sample, const std::string& parent = {});

}  // namespace belvedere_ros
