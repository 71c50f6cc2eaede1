#include "depth_scan.hpp"

#include <boost/make_shared.hpp>
#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace belvedere_ros::turtlebot {

namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

template <class T>
T at(const sensor_msgs::Image& image, std::size_t row, std::size_t column) {
    T value;
    std::memcpy(&value, image.data.data() + row * image.step + column * sizeof value, sizeof value);
    return value;
}

float metres(const sensor_msgs::Image& image, std::size_t row, std::size_t column) {
    if (image.encoding == sensor_msgs::image_encodings::TYPE_32FC1) return at<float>(image, row, column);
    const auto millimetres = at<std::uint16_t>(image, row, column);
    return millimetres == 0 ? kNone : static_cast<float>(millimetres) * 1e-3f;
}

}  // namespace

sensor_msgs::LaserScanPtr DepthScan::scan(const sensor_msgs::Image& depth, const sensor_msgs::CameraInfo& info) const {
    namespace encodings = sensor_msgs::image_encodings;
    const bool is_float = depth.encoding == encodings::TYPE_32FC1;
    if (!is_float && depth.encoding != encodings::TYPE_16UC1)
        throw BadDepth("a picture of encoding " + depth.encoding + "; depths are 32FC1 or 16UC1");
    const double focal = info.K[0], centre = info.K[2];
    if (!(focal > 0) || depth.width < 2 || depth.is_bigendian || depth.step < depth.width * (is_float ? 4u : 2u) ||
        depth.data.size() < static_cast<std::size_t>(depth.step) * depth.height)
        throw BadDepth("a depth picture without a focal length, or of a size that its bytes do not have");
    const auto first = static_cast<long>(std::lround(info.K[5] - 0.5 * (scan_height - 1)));
    if (first < 0 || first + scan_height > static_cast<long>(depth.height))
        throw BadDepth("a depth picture of " + std::to_string(depth.height) + " rows, of which scan_height wants " +
                       std::to_string(scan_height) + " around the principal point");

    auto scan = boost::make_shared<sensor_msgs::LaserScan>();
    scan->header.stamp = depth.header.stamp;
    scan->header.frame_id = output_frame_id;
    const double left = std::atan(centre / focal), right = std::atan((depth.width - 1 - centre) / focal);
    scan->angle_min = static_cast<float>(-right);
    scan->angle_max = static_cast<float>(left);
    scan->angle_increment = static_cast<float>((left + right) / (depth.width - 1));
    scan->time_increment = 0;
    scan->scan_time = scan_time;
    scan->range_min = range_min;
    scan->range_max = range_max;
    scan->ranges.resize(depth.width);
    for (std::size_t ray = 0; ray < depth.width; ++ray) {
        const double angle = -right + static_cast<double>(ray) * (left + right) / (depth.width - 1);
        const double column = std::clamp(std::round(centre - focal * std::tan(angle)), 0.0, depth.width - 1.0);
        // The image plane is upright: only the column determines the ratio of range to depth.
        const auto slant = static_cast<float>(std::hypot(1.0, (column - centre) / focal));
        float nearest = kNone;
        for (long row = first; row < first + scan_height; ++row) {
            const float range = slant * metres(depth, static_cast<std::size_t>(row), static_cast<std::size_t>(column));
            const bool counts = std::isfinite(range) ? range >= range_min && range <= range_max : !std::isnan(range);
            const bool is_better = std::isfinite(range) ? !(std::isfinite(nearest) && nearest <= range) : !std::isfinite(nearest);
            if (counts && is_better) nearest = range;
        }
        scan->ranges[ray] = nearest;
    }
    return scan;
}

}  // namespace belvedere_ros::turtlebot
