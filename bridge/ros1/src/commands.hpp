// Commands from ROS to the robot.
#pragma once

#include <ros/ros.h>

#include <memory>
#include <set>
#include <string>

#include "domain.hpp"

namespace belvedere_ros {

/// Subscribes to several topics of one kind of command, and forwards them to one stream. The newest command applies.
class Commands {
public:
    /// Returns the commands for a stream, or null if the stream does not carry commands to a robot.
    static std::unique_ptr<Commands> to(const bv_stream_info& stream, Domain& domain, ros::NodeHandle nh,
                                        const std::set<std::string>& topics);

    virtual ~Commands() = default;
};

}  // namespace belvedere_ros
