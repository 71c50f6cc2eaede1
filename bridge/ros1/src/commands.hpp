// What ROS says to the robot.
#pragma once

#include <geometry_msgs/Twist.h>
#include <ros/ros.h>

#include <mutex>
#include <string>
#include <vector>

#include "domain.hpp"
#include "reminder.hpp"

namespace belvedere_ros {

/// Takes velocities from several topics, and passes them on to one stream. Whatever comes last holds.
class VelocityCommands {
public:
    VelocityCommands(ros::NodeHandle nh, Domain& domain, const std::string& stream, const std::vector<std::string>& topics);

private:
    void send(const geometry_msgs::Twist& twist, const std::string& topic);

    std::mutex mutex_;
    Reminder trouble_;
    belvedere::VelocityPublisher publisher_;
    std::vector<ros::Subscriber> subscribers_;
};

}  // namespace belvedere_ros
