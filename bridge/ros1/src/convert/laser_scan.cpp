#include "laser_scan.hpp"

#include <boost/make_shared.hpp>

namespace belvedere_ros {

namespace {

std::vector<float> floats(const Sample& sample, std::size_t offset) {
    const std::size_t bytes = static_cast<std::size_t>(sample.header.width) * sizeof(float);
    if (offset + bytes > sample.payload.size()) throw Unrepresentable("the scan ends before its last ray");
    std::vector<float> values;
    // Payloads are aligned to 64 bytes, and planes begin at multiples of a float's size.
    const auto* begin = reinterpret_cast<const float*>(sample.payload.data() + offset);
    values.assign(begin, begin + sample.header.width);
    return values;
}

}  // namespace

sensor_msgs::LaserScanPtr to_laser_scan(const Sample& sample) {
    const belvedere::Header& header = sample.header;
    if (header.height != 1)
        throw Unrepresentable("the lidar has " + std::to_string(header.height) + " layers; a sensor_msgs/LaserScan has one");
    if (header.encoding != BV_ENCODING_RANGES_F32 || header.elem_stride != sizeof(float) || header.row_stride % sizeof(float) != 0)
        throw Unrepresentable("the scan is not of packed 32-bit floats");
    const bv_scan_geometry& geometry = header.block.scan;
    auto scan = boost::make_shared<sensor_msgs::LaserScan>();
    scan->header = to_header(sample);
    scan->angle_min = static_cast<float>(geometry.angle_min);
    scan->angle_increment = static_cast<float>(geometry.angle_increment);
    const double last = header.width == 0 ? 0.0 : header.width - 1.0;
    scan->angle_max = static_cast<float>(geometry.angle_min + last * geometry.angle_increment);
    scan->time_increment = static_cast<float>(geometry.time_increment);
    scan->scan_time = static_cast<float>(geometry.scan_time);
    scan->range_min = geometry.range_min;
    scan->range_max = geometry.range_max;
    scan->ranges = floats(sample, 0);
    if ((header.flags & BV_HAS_INTENSITIES) != 0) scan->intensities = floats(sample, header.row_stride);
    return scan;
}

}  // namespace belvedere_ros
