#include "parameters.hpp"

#include <ros/console.h>
#include <ros/names.h>

#include <algorithm>
#include <map>

namespace belvedere_ros {

namespace {

using Value = XmlRpc::XmlRpcValue;

std::vector<std::string> to_texts(Value& value) {
    if (value.getType() != Value::TypeArray) throw BadParameter("a list of topics");
    std::vector<std::string> texts;
    for (int index = 0; index < value.size(); ++index) {
        if (value[index].getType() != Value::TypeString) throw BadParameter("a list of topics");
        texts.push_back(static_cast<std::string>(value[index]));
    }
    return texts;
}

std::string to_namespace(Value& value) {
    std::string error;
    if (value.getType() != Value::TypeString || !ros::names::validate(static_cast<std::string>(value), error))
        throw BadParameter("a namespace, such as /gazebo, or empty");
    return static_cast<std::string>(value);
}

Parameters::Transforms to_transforms(Value& value) {
    using Transforms = Parameters::Transforms;
    const std::map<std::string, Transforms> known = {
        {"all", Transforms::all}, {"odometry", Transforms::odometry}, {"none", Transforms::none}};
    const auto found = value.getType() == Value::TypeString ? known.find(static_cast<std::string>(value)) : known.end();
    if (found == known.end()) throw BadParameter("all, odometry or none");
    return found->second;
}

}  // namespace

Parameters Parameters::read(const ros::NodeHandle& private_nh) {
    Parameters parameters;
    Readers readers = {
        {"domain", [&](Value& value) { parameters.domain = to_text(value); }},
        {"publish_clock", [&](Value& value) { parameters.publish_clock = to_bool(value); }},
        {"transforms", [&](Value& value) { parameters.transforms = to_transforms(value); }},
        {"odom_frame", [&](Value& value) { parameters.odom_frame = to_text(value); }},
        {"velocity_topics", [&](Value& value) { parameters.command_topics[BV_KIND_VELOCITY_COMMAND] = to_texts(value); }},
        {"reset_odometry_topics", [&](Value& value) { parameters.command_topics[BV_KIND_RESET_ODOMETRY] = to_texts(value); }},
        {"motor_power_topics", [&](Value& value) { parameters.command_topics[BV_KIND_MOTOR_POWER] = to_texts(value); }},
        {"gazebo_namespace", [&](Value& value) { parameters.gazebo_namespace = to_namespace(value); }},
        {"camera_info_url", [&](Value& value) { parameters.camera_info_url = to_text(value); }},
    };
    readers.merge(parameters.scan.readers());
    read_all(private_nh, readers);
    parameters.scan.check(private_nh.getNamespace());

    Value all;
    const std::string own = private_nh.getNamespace();
    if (private_nh.getParam(own, all) && all.getType() == Value::TypeStruct) {
        for (const auto& entry : all) {
            // Parameters of diagnostic_updater and of image transports are not checked here.
            if (readers.count(entry.first) != 0 || entry.first == "diagnostic_period" ||
                entry.second.getType() == Value::TypeStruct)
                continue;
            std::string known;
            for (const auto& reader : readers) known += (known.empty() ? "" : ", ") + reader.first;
            ROS_WARN_STREAM(own << '/' << entry.first << " is not a parameter of this node, and is ignored; these are: " << known);
        }
    }
    return parameters;
}

}  // namespace belvedere_ros
