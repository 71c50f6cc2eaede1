// The private parameters of the node.
#pragma once

#include <belvedere.h>
#include <ros/node_handle.h>

#include <map>
#include <string>
#include <vector>

#include "parameter_readers.hpp"
#include "scan_parameters.hpp"

namespace belvedere_ros {

struct Parameters {
    /// The moving transforms that are published.
    enum class Transforms {
        all,
        /// Those in the odometry frame, for use with robot_state_publisher, which publishes the robot's own; no fixed
        /// ones either.
        odometry,
        none,
    };

    /// Reads and checks all parameters. Throws BadParameter; warns about unknown names.
    static Parameters read(const ros::NodeHandle& private_nh);

    /// ~domain (text): the simulator's domain; empty: BELVEDERE_DOMAIN, or "default".
    std::string domain;
    /// ~publish_clock (true): publishes /clock, and (by the node) sets use_sim_time unless it is set already.
    bool publish_clock = true;
    /// ~transforms (all): all, odometry or none.
    Transforms transforms = Transforms::all;
    /// ~odom_frame (odom): the frame of odometry.
    std::string odom_frame = "odom";
    /// ~velocity_topics, ~reset_odometry_topics, ~motor_power_topics (lists): additional topics of commands to the
    /// robot, by the kind of the command stream.
    std::map<std::uint16_t, std::vector<std::string>> command_topics = {
        {BV_KIND_VELOCITY_COMMAND, {"commands/velocity", "mobile_base/commands/velocity"}},
        {BV_KIND_RESET_ODOMETRY, {"commands/reset_odometry", "mobile_base/commands/reset_odometry"}},
        {BV_KIND_MOTOR_POWER, {"commands/motor_power", "mobile_base/commands/motor_power"}},
    };
    /// ~gazebo_namespace (/gazebo): the namespace of Gazebo's services and topics; without the slash, relative to the
    /// node's own namespace; if empty, they are not offered.
    std::string gazebo_namespace = "/gazebo";
    /// ~camera_info_url (text): the storage of calibrations set by set_camera_info, with ${NAME} for the camera's name.
    std::string camera_info_url;
    /// The parameters of laser scanners that apply to every scan.
    ScanParameters scan;
};

}  // namespace belvedere_ros
