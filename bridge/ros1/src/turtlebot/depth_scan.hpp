// What a lidar would see of a depth picture.
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/LaserScan.h>

#include <stdexcept>
#include <string>

namespace belvedere_ros::turtlebot {

/// A picture that is none of depths, or has fewer rows than asked for.
class BadDepth : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// With the defaults of depthimage_to_laserscan.
struct DepthScan {
    /// Rows around the principal point, of which the nearest depth counts.
    int scan_height = 1;
    float scan_time = 1.0f / 30.0f;
    float range_min = 0.45f;
    float range_max = 10.0f;
    /// x forward, z up: not the optical frame.
    std::string output_frame_id = "camera_depth_frame";

    /// A ray for each column, in equal angles counter-clockwise; of each the column that it lies in. A range outside the
    /// limits does not count; where none does it is ±infinity, as the depths are, or NaN. Depths are 32FC1 in metres or
    /// 16UC1 in millimetres, 0 for none. Throws BadDepth.
    sensor_msgs::LaserScanPtr scan(const sensor_msgs::Image& depth, const sensor_msgs::CameraInfo& info) const;
};

}  // namespace belvedere_ros::turtlebot
