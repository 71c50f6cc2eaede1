// Selects which of several nodes serves Gazebo's namespace.
#pragma once

#include <ros/node_handle.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "../domain.hpp"

namespace belvedere_ros::gazebo {

class Services;

/// A service has one server. The master gives its name to the last node that registers it, without notice to the
/// others. So a node that finds no server registers one of the services, and if it still owns it at a later check, it
/// serves all of them. A node that finds another server, or that has lost the service, logs this once and leaves the
/// services to the other node as long as that lives.
class Namespace {
public:
    /// Uses the namespace `name` of `nh`; if it is empty, no services are offered.
    Namespace(const ros::NodeHandle& nh, const std::string& name, Domain& domain);
    ~Namespace();

    /// Checks for another server, and serves if there is none. Must be called repeatedly once there is a simulator.
    void look();

    /// Returns true if this node serves the namespace.
    bool is_ours() const { return is_ours_; }

private:
    void leave();

    const ros::NodeHandle nh_;
    const bool is_wanted_;
    /// The service port of this process. It is stored because requesting it from roscpp after a shutdown, which another
    /// thread may start at any time, aborts the process.
    const std::uint32_t port_;
    Domain& domain_;
    std::unique_ptr<Services> services_;
    std::chrono::steady_clock::time_point claimed_;
    bool is_ours_ = false;
    bool is_left_ = false;
};

}  // namespace belvedere_ros::gazebo
