#include "master.hpp"

#include <ros/master.h>
#include <ros/this_node.h>

namespace belvedere_ros {

bool Master::answers() {
    return ros::master::check();
}

Master::State Master::look() const {
    XmlRpc::XmlRpcValue arguments, result, payload;
    arguments[0] = ros::this_node::getName();
    arguments[1] = ros::this_node::getName();
    // Fails when there is no answer, and when the answer is that there is no such node.
    if (ros::master::execute("lookupNode", arguments, result, payload, false)) return State::fine;
    return answers() ? State::forgetful : State::gone;
}

}  // namespace belvedere_ros
