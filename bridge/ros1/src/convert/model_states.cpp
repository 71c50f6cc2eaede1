#include "model_states.hpp"

#include <boost/make_shared.hpp>

#include "geometry.hpp"

namespace belvedere_ros {

namespace {

// The two types differ only in their names.
template <class States>
boost::shared_ptr<States> to_states(const Sample& sample) {
    auto states = boost::make_shared<States>();
    for (std::uint32_t index = 0; index < struct_count(sample); ++index) {
        const auto state = read_struct<bv_model_state>(sample, index);
        states->name.push_back(to_text(state.name));
        states->pose.emplace_back();
        states->pose.back().position = to_xyz<geometry_msgs::Point>(state.position);
        states->pose.back().orientation = to_quaternion(state.orientation);
        states->twist.emplace_back();
        states->twist.back().linear = to_xyz<geometry_msgs::Vector3>(state.linear);
        states->twist.back().angular = to_xyz<geometry_msgs::Vector3>(state.angular);
    }
    return states;
}

}  // namespace

gazebo_msgs::ModelStatesPtr to_model_states(const Sample& sample) {
    return to_states<gazebo_msgs::ModelStates>(sample);
}

gazebo_msgs::LinkStatesPtr to_link_states(const Sample& sample) {
    return to_states<gazebo_msgs::LinkStates>(sample);
}

}  // namespace belvedere_ros
