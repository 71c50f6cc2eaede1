#include "joint_states.hpp"

#include <boost/make_shared.hpp>

namespace belvedere_ros {

sensor_msgs::JointStatePtr to_joint_states(const Sample& sample) {
    auto joints = boost::make_shared<sensor_msgs::JointState>();
    joints->header = to_header(sample);
    for (std::uint32_t index = 0; index < struct_count(sample); ++index) {
        const auto joint = read_struct<bv_joint_state>(sample, index);
        joints->name.push_back(to_text(joint.name));
        joints->position.push_back(joint.position);
        joints->velocity.push_back(joint.velocity);
        joints->effort.push_back(joint.effort);
    }
    return joints;
}

}  // namespace belvedere_ros
