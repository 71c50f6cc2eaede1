// What ROS says to the robot.
#pragma once

#include <ros/ros.h>

#include <memory>
#include <set>
#include <string>

#include "domain.hpp"

namespace belvedere_ros {

/// Takes commands of a kind from several topics, and passes them on to one stream. Whatever comes last holds.
class Commands {
public:
    /// Those that a stream takes, or null for a stream of a kind that the robot is not told.
    static std::unique_ptr<Commands> to(const bv_stream_info& stream, Domain& domain, ros::NodeHandle nh,
                                        const std::set<std::string>& topics);

    virtual ~Commands() = default;
};

}  // namespace belvedere_ros
