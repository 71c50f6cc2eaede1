// The services by which programs control Gazebo, for a Belvedere simulator.
#pragma once

#include <gazebo_msgs/DeleteModel.h>
#include <gazebo_msgs/GetLinkState.h>
#include <gazebo_msgs/GetModelState.h>
#include <gazebo_msgs/GetWorldProperties.h>
#include <gazebo_msgs/ModelState.h>
#include <gazebo_msgs/SetModelState.h>
#include <gazebo_msgs/SpawnModel.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <cstdint>
#include <string>
#include <vector>

#include "../domain.hpp"
#include "../reminder.hpp"
#include "simulator.hpp"

namespace belvedere_ros::gazebo {

/// Services with the names and answers of gazebo_ros, in their own thread, so that a slow simulator delays nothing
/// else. A failed request is answered with success false and the reason.
class Services {
public:
    /// Serves the first service, by which nodes detect the owner. `nh` is the handle of Gazebo's namespace.
    Services(const ros::NodeHandle& nh, Domain& domain);

    /// Serves the other services. Must be called once.
    void serve_all();

    /// Returns true if the master has the first service at this process's port; false if another node has registered it
    /// since.
    bool are_ours(std::uint32_t own_port) const;

    /// Returns true if a node serves them already.
    static bool are_at(const ros::NodeHandle& nh);

private:
    void serve_empty(const std::string& name, bv_operation operation);
    template <class Service>
    void serve(const std::string& name, const std::string& speaker,
               void (Services::*answer)(const typename Service::Request&, typename Service::Response&));

    void get_model_state(const gazebo_msgs::GetModelStateRequest& request, gazebo_msgs::GetModelStateResponse& response);
    void get_link_state(const gazebo_msgs::GetLinkStateRequest& request, gazebo_msgs::GetLinkStateResponse& response);
    void get_world_properties(const gazebo_msgs::GetWorldPropertiesRequest& request, gazebo_msgs::GetWorldPropertiesResponse& response);
    void set_model_state(const gazebo_msgs::SetModelStateRequest& request, gazebo_msgs::SetModelStateResponse& response);
    void spawn_model(const gazebo_msgs::SpawnModelRequest& request, gazebo_msgs::SpawnModelResponse& response);
    void delete_model(const gazebo_msgs::DeleteModelRequest& request, gazebo_msgs::DeleteModelResponse& response);

    void move(const gazebo_msgs::ModelState& state);
    void received(const gazebo_msgs::ModelState& state);

    ros::CallbackQueue queue_;
    ros::NodeHandle nh_;
    Simulator simulator_;
    Reminder trouble_;
    std::uint32_t state_requests_ = 0;
    std::vector<ros::ServiceServer> servers_;
    ros::Subscriber states_;
    ros::WallTimer rest_;
    // Declared last so that it starts last and ends first.
    ros::AsyncSpinner spinner_;
};

}  // namespace belvedere_ros::gazebo
