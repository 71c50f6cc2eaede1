// A laser scan from a depth image.
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/LaserScan.h>

#include <stdexcept>
#include <string>

namespace belvedere_ros::turtlebot {

/// The error for an image that has no depths, or has fewer rows than requested.
class BadDepth : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The conversion and its parameters, with the defaults of depthimage_to_laserscan.
struct DepthScan {
    /// Number of rows around the principal point; the nearest of their depths is used.
    int scan_height = 1;
    float scan_time = 1.0f / 30.0f;
    float range_min = 0.45f;
    float range_max = 10.0f;
    /// A frame with x forward and z up: not the optical frame.
    std::string output_frame_id = "camera_depth_frame";

    /// Converts a depth image to a scan with one ray per column, in equal angles counter-clockwise. Each ray uses the
    /// column that it falls into. Ranges beyond the limits are ignored; if none remains, the ray is ±infinity, like the
    /// depths, or NaN. Depths are 32FC1 in metres or 16UC1 in millimetres, 0 for none. Throws BadDepth.
    sensor_msgs::LaserScanPtr scan(const sensor_msgs::Image& depth, const sensor_msgs::CameraInfo& info) const;
};

}  // namespace belvedere_ros::turtlebot
