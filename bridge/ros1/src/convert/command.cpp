#include "command.hpp"

#include <algorithm>
#include <cmath>

#include "header.hpp"

namespace belvedere_ros {

bv_velocity_command from_twist(const geometry_msgs::Twist& twist) {
    const bv_velocity_command command{{twist.linear.x, twist.linear.y, twist.linear.z},
                                      {twist.angular.x, twist.angular.y, twist.angular.z}};
    const auto finite = [](const double (&values)[3]) {
        return std::all_of(std::begin(values), std::end(values), [](double value) { return std::isfinite(value); });
    };
    if (!finite(command.linear) || !finite(command.angular)) throw Unrepresentable("a velocity that is not finite is ignored");
    return command;
}

bv_motor_power from_motor_power(const kobuki_msgs::MotorPower& power) {
    if (power.state != kobuki_msgs::MotorPower::ON && power.state != kobuki_msgs::MotorPower::OFF)
        throw Unrepresentable("a state of " + std::to_string(power.state) + ", neither on nor off, is ignored");
    return {power.state};
}

bv_reset_odometry from_empty(const std_msgs::Empty&) {
    return {};
}

}  // namespace belvedere_ros
