// Where models and links were at one moment.
#pragma once

#include <belvedere.hpp>

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Twist.h>
#include <tf2/LinearMath/Transform.h>

#include <cstdint>
#include <string>
#include <vector>

namespace belvedere_ros::gazebo {

/// Where something is, and how it moves: its origin in m/s, its turn in rad/s.
struct Motion {
    tf2::Transform pose = tf2::Transform::getIdentity();
    tf2::Vector3 linear{0, 0, 0}, angular{0, 0, 0};

    static Motion of(const bv_model_state& state);

    /// The same as seen from another. Of the velocities the difference, along the other's axes, as Gazebo has it: that
    /// the other turns beneath it is left out.
    Motion relative_to(const Motion& other) const;

    geometry_msgs::Pose to_pose() const;
    geometry_msgs::Twist to_twist() const;
};

/// All that one frame of a stream of states says.
struct States {
    std::uint64_t stamp_ns = 0;
    std::uint64_t session = 0;
    /// On the clock of bv_mono_ns.
    std::uint64_t sent_ns = 0;
    std::vector<bv_model_state> of;

    /// That of a name, or null.
    const bv_model_state* find(const std::string& name) const;
    /// That of model::link, or of the first link that is called so; or null.
    const bv_model_state* find_link(const std::string& name) const;
    /// The names, in their order.
    std::vector<std::string> names() const;
};

/// Whether a reference frame is the world itself.
bool is_world(const std::string& frame);

}  // namespace belvedere_ros::gazebo
