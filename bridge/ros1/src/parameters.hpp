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
    /// Which of the moving transforms are sent.
    enum class Transforms {
        all,
        /// Those in the frame of the odometry, when robot_state_publisher sends the robot's own; no fixed ones either.
        odometry,
        none,
    };

    /// Reads and checks them all. Throws BadParameter; warns of names that it does not know.
    static Parameters read(const ros::NodeHandle& private_nh);

    /// ~domain (text): where the simulator is; empty: BELVEDERE_DOMAIN, else "default".
    std::string domain;
    /// ~publish_clock (true): whether /clock is sent, and (by the node) use_sim_time set unless it is set already.
    bool publish_clock = true;
    /// ~transforms (all): all, odometry or none.
    Transforms transforms = Transforms::all;
    /// ~odom_frame (odom): the frame that odometry is given in.
    std::string odom_frame = "odom";
    /// ~velocity_topics, ~reset_odometry_topics, ~motor_power_topics (lists): the topics of what the robot is told, by the
    /// kinds of the streams that they go to, besides the names of these streams.
    std::map<std::uint16_t, std::vector<std::string>> command_topics = {
        {BV_KIND_VELOCITY_COMMAND, {"commands/velocity", "mobile_base/commands/velocity"}},
        {BV_KIND_RESET_ODOMETRY, {"commands/reset_odometry", "mobile_base/commands/reset_odometry"}},
        {BV_KIND_MOTOR_POWER, {"commands/motor_power", "mobile_base/commands/motor_power"}},
    };
    /// ~gazebo_namespace (/gazebo): where the services and topics of Gazebo are; relative to the node's own namespace
    /// without the slash; empty: nowhere.
    std::string gazebo_namespace = "/gazebo";
    /// ~camera_info_url (text): where calibrations made by set_camera_info are kept, with ${NAME} for the camera's name.
    std::string camera_info_url;
    /// Those of laser scanners that hold for every scan.
    ScanParameters scan;
};

}  // namespace belvedere_ros
