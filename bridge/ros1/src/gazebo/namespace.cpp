#include "namespace.hpp"

#include <ros/connection_manager.h>
#include <ros/console.h>

#include <utility>

#include "services.hpp"

namespace belvedere_ros::gazebo {

namespace {

// The longest time between finding no server and having registered a service, for nodes that start at the same time.
constexpr std::chrono::milliseconds kSettled{400};

}  // namespace

Namespace::Namespace(const ros::NodeHandle& nh, const std::string& name, Domain& domain)
    : nh_(nh, name), is_wanted_(!name.empty()), port_(ros::ConnectionManager::instance()->getTCPPort()), domain_(domain) {}

Namespace::~Namespace() = default;

void Namespace::look() {
    if (!is_wanted_) return;
    const auto now = std::chrono::steady_clock::now();
    if (!services_) {
        if (Services::are_at(nh_)) return leave();
        services_ = std::make_unique<Services>(nh_, domain_);
        claimed_ = now;
    } else if (!services_->are_ours(port_)) {
        leave();
    } else if (!is_ours_ && now - claimed_ >= kSettled) {
        services_->serve_all();
        is_ours_ = true;
        if (std::exchange(is_left_, false)) ROS_INFO_STREAM("serving " << nh_.getNamespace() << ", as the other node has ended");
    }
}

void Namespace::leave() {
    services_.reset();
    is_ours_ = false;
    if (!std::exchange(is_left_, true))
        ROS_WARN_STREAM("another node serves " << nh_.getNamespace() << ", so this one does not while that runs; give it a ~gazebo_namespace "
                                               << "of its own, or an empty one");
}

}  // namespace belvedere_ros::gazebo
