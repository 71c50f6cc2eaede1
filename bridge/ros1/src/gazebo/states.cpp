#include "states.hpp"

#include <algorithm>

#include "../convert/header.hpp"

namespace belvedere_ros::gazebo {

Motion Motion::of(const bv_model_state& state) {
    const auto vector = [](const double (&v)[3]) { return tf2::Vector3(v[0], v[1], v[2]); };
    const auto& q = state.orientation;
    return {tf2::Transform(tf2::Quaternion(q[0], q[1], q[2], q[3]), vector(state.position)), vector(state.linear), vector(state.angular)};
}

Motion Motion::relative_to(const Motion& other) const {
    const tf2::Transform other_from_world = other.pose.inverse();
    const tf2::Matrix3x3& rotation = other_from_world.getBasis();
    return {other_from_world * pose, rotation * (linear - other.linear), rotation * (angular - other.angular)};
}

geometry_msgs::Pose Motion::to_pose() const {
    geometry_msgs::Pose to;
    to.position.x = pose.getOrigin().x();
    to.position.y = pose.getOrigin().y();
    to.position.z = pose.getOrigin().z();
    const tf2::Quaternion rotation = pose.getRotation();
    to.orientation.x = rotation.x();
    to.orientation.y = rotation.y();
    to.orientation.z = rotation.z();
    to.orientation.w = rotation.w();
    return to;
}

geometry_msgs::Twist Motion::to_twist() const {
    geometry_msgs::Twist to;
    to.linear.x = linear.x();
    to.linear.y = linear.y();
    to.linear.z = linear.z();
    to.angular.x = angular.x();
    to.angular.y = angular.y();
    to.angular.z = angular.z();
    return to;
}

const bv_model_state* States::find(const std::string& name) const {
    const auto found = std::find_if(of.begin(), of.end(), [&](const auto& state) { return to_text(state.name) == name; });
    return found == of.end() ? nullptr : &*found;
}

const bv_model_state* States::find_link(const std::string& name) const {
    if (const auto* scoped = find(name)) return scoped;
    const std::string ending = "::" + name;
    const auto found = std::find_if(of.begin(), of.end(), [&](const auto& state) {
        const std::string scoped = to_text(state.name);
        return scoped.size() > ending.size() && scoped.compare(scoped.size() - ending.size(), ending.size(), ending) == 0;
    });
    return found == of.end() ? nullptr : &*found;
}

std::vector<std::string> States::names() const {
    std::vector<std::string> names;
    for (const bv_model_state& state : of) names.push_back(to_text(state.name));
    return names;
}

bool is_world(const std::string& frame) {
    return frame.empty() || frame == "world" || frame == "map" || frame == "/map";
}

}  // namespace belvedere_ros::gazebo
