// States of models and links at one time.
#pragma once

#include <belvedere.hpp>

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Twist.h>
#include <tf2/LinearMath/Transform.h>

#include <cstdint>
#include <string>
#include <vector>

namespace belvedere_ros::gazebo {

/// A pose and the velocities of its origin in m/s and rad/s.
struct Motion {
    tf2::Transform pose = tf2::Transform::getIdentity();
    tf2::Vector3 linear{0, 0, 0}, angular{0, 0, 0};

    static Motion of(const bv_model_state& state);

    /// Returns the motion relative to another. Like Gazebo, it returns the difference of the velocities along the
    /// other's axes, and ignores the rotation of the other frame.
    Motion relative_to(const Motion& other) const;

    geometry_msgs::Pose to_pose() const;
    geometry_msgs::Twist to_twist() const;
};

/// The content of one frame of a stream of states.
struct States {
    std::uint64_t stamp_ns = 0;
    std::uint64_t session = 0;
    /// Time of sending, on the clock of bv_mono_ns.
    std::uint64_t sent_ns = 0;
    std::vector<bv_model_state> of;

    /// Returns the state with this name, or null.
    const bv_model_state* find(const std::string& name) const;
    /// Returns the state of model::link, or of the first link with this name; or null.
    const bv_model_state* find_link(const std::string& name) const;
    /// Returns the names in order.
    std::vector<std::string> names() const;
};

/// Returns true if a reference frame is the world.
bool is_world(const std::string& frame);

}  // namespace belvedere_ros::gazebo
