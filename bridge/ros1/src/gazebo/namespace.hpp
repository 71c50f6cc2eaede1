// Which of several nodes serves Gazebo's namespace.
#pragma once

#include <ros/node_handle.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "../domain.hpp"

namespace belvedere_ros::gazebo {

class Services;

/// A service has one server, and the master gives its name to the last node that registers it, telling nobody. So a node
/// that finds nobody there registers one of the services; if it has that still at a later look, it serves them all. One
/// that finds another there, or itself outdone, says so once and leaves all to the other for as long as that lives.
class Namespace {
public:
    /// `name` as it is given to `nh`; empty: nobody serves anything.
    Namespace(const ros::NodeHandle& nh, const std::string& name, Domain& domain);
    ~Namespace();

    /// Looks whose it is, and serves it if it may. To be called again and again once there is a simulator.
    void look();

    /// Whether it is served here.
    bool is_ours() const { return is_ours_; }

private:
    void leave();

    const ros::NodeHandle nh_;
    const bool is_wanted_;
    /// Where this process serves. Once roscpp shuts down, which another thread may have it do at any time, asking for it
    /// aborts the process.
    const std::uint32_t port_;
    Domain& domain_;
    std::unique_ptr<Services> services_;
    std::chrono::steady_clock::time_point claimed_;
    bool is_ours_ = false;
    bool is_left_ = false;
};

}  // namespace belvedere_ros::gazebo
