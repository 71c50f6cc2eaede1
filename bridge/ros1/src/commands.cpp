#include "commands.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

namespace belvedere_ros {

VelocityCommands::VelocityCommands(ros::NodeHandle nh, Domain& domain, const std::string& stream,
                                   const std::vector<std::string>& topics)
    : publisher_(domain.velocity(stream)) {
    for (const std::string& topic : topics) {
        const boost::function<void(const geometry_msgs::TwistConstPtr&)> received =
            [this, topic](const geometry_msgs::TwistConstPtr& twist) { send(*twist, topic); };
        // The newest command is the one that matters.
        subscribers_.push_back(
            nh.subscribe<geometry_msgs::Twist>(topic, 1, received, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
    }
}

void VelocityCommands::send(const geometry_msgs::Twist& twist, const std::string& topic) {
    const bv_velocity_command command{{twist.linear.x, twist.linear.y, twist.linear.z},
                                      {twist.angular.x, twist.angular.y, twist.angular.z}};
    const auto finite = [](const double (&values)[3]) {
        return std::all_of(std::begin(values), std::end(values), [](double value) { return std::isfinite(value); });
    };
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!finite(command.linear) || !finite(command.angular)) {
        if (trouble_.due()) ROS_WARN_STREAM(topic << ": a velocity that is not finite is ignored");
        return;
    }
    try {
        publisher_.send(command);
    } catch (const std::exception& error) {
        if (trouble_.due()) ROS_WARN_STREAM(topic << ": " << error.what());
    }
}

}  // namespace belvedere_ros
