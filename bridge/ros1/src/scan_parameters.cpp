#include "scan_parameters.hpp"

#include <belvedere.h>

#include <cmath>

namespace belvedere_ros {

namespace {

std::string to_frame(XmlRpc::XmlRpcValue& value) {
    const std::string frame = to_text(value);
    if (frame.size() >= sizeof bv_frame_header::frame_id) throw BadParameter("a frame of at most 63 bytes");
    return frame;
}

}  // namespace

Readers ScanParameters::readers() {
    using Value = XmlRpc::XmlRpcValue;
    return {
        {"frame_id", [this](Value& value) { frame_id = to_frame(value); }},
        {"angle_min", [this](Value& value) { angle_min = to_number(value); }},
        {"angle_max", [this](Value& value) { angle_max = to_number(value); }},
        {"time_offset", [this](Value& value) { time_offset = to_number(value); }},
        {"publish_intensity", [this](Value& value) { publish_intensity = to_bool(value); }},
    };
}

ScanParameters ScanParameters::of_topic(const ros::NodeHandle& private_nh, const std::string& topic) const {
    ScanParameters own = *this;
    const ros::NodeHandle nh(private_nh, topic);
    read_all(nh, own.readers());
    own.check(nh.getNamespace());
    return own;
}

void ScanParameters::check(const std::string& where) const {
    if (std::abs(time_offset) > most_offset)
        throw BadParameter(where + "/time_offset is " + std::to_string(time_offset) + "; it must be seconds, at most 1e9 either way");
    if (angle_min > angle_max)
        throw BadParameter(where + "/angle_min is " + std::to_string(angle_min) + "; it must not be above angle_max, " +
                           std::to_string(angle_max));
}

}  // namespace belvedere_ros
