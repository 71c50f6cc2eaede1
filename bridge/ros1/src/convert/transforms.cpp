#include "transforms.hpp"

#include <boost/make_shared.hpp>

#include "geometry.hpp"

namespace belvedere_ros {

namespace {

/// Returns true if a frame has this name, in the namespace of any robot: robot1/odom is odom.
bool is_named(const std::string& frame, const std::string& name) {
    if (frame.size() <= name.size()) return frame == name;
    const std::size_t rest = frame.size() - name.size();
    return frame[rest - 1] == '/' && frame.compare(rest, name.size(), name) == 0;
}

}  // namespace

tf2_msgs::TFMessagePtr to_transforms(const Sample& sample, const std::string& parent) {
    auto message = boost::make_shared<tf2_msgs::TFMessage>();
    const std_msgs::Header header = to_header(sample);
    for (std::uint32_t index = 0; index < struct_count(sample); ++index) {
        const auto from = read_struct<bv_transform>(sample, index);
        geometry_msgs::TransformStamped to;
        to.header = header;
        to.header.frame_id = to_text(from.parent);
        if (!parent.empty() && !is_named(to.header.frame_id, parent)) continue;
        to.child_frame_id = to_text(from.child);
        to.transform.translation = to_xyz<geometry_msgs::Vector3>(from.translation);
        to.transform.rotation = to_quaternion(from.rotation);
        message->transforms.push_back(to);
    }
    return message;
}

}  // namespace belvedere_ros
