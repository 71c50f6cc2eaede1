#include "header.hpp"

#include <limits>

namespace belvedere_ros {

ros::Time to_time(std::uint64_t nanoseconds) {
    const std::uint64_t seconds = nanoseconds / 1'000'000'000;
    if (seconds > std::numeric_limits<std::uint32_t>::max())
        throw Unrepresentable("the stamp is beyond 2^32 s, where time of ROS 1 ends");
    return {static_cast<std::uint32_t>(seconds), static_cast<std::uint32_t>(nanoseconds % 1'000'000'000)};
}

std_msgs::Header to_header(const Sample& sample) {
    std_msgs::Header header;
    header.stamp = to_time(sample.header.stamp_ns);
    header.frame_id = to_text(sample.header.frame_id);
    return header;
}

}  // namespace belvedere_ros
