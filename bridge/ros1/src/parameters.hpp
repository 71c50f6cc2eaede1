// The private parameters of the node.
#pragma once

#include <ros/node_handle.h>

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
    /// ~velocity_topics (list): topics that move the robot besides the simulator's own cmd_vel.
    std::vector<std::string> velocity_topics = {"commands/velocity", "mobile_base/commands/velocity"};
    /// ~camera_info_url (text): where calibrations made by set_camera_info are kept, with ${NAME} for the camera's name.
    std::string camera_info_url;
    /// Those of laser scanners that hold for every scan.
    ScanParameters scan;
};

}  // namespace belvedere_ros
