// The settings of one sensor, served by dynamic_reconfigure.
#pragma once

#include <belvedere.hpp>
#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/ros.h>

#include <functional>
#include <mutex>
#include <optional>
#include <string>

namespace belvedere_ros {

/// A server of dynamic_reconfigure's messages. The library's Server<> has parameters that are fixed at compile time,
/// but the simulator defines which ones a sensor has, and their limits.
///
/// Unlike that class, it does not keep values on the parameter server, where they would outlive the simulator. It
/// refuses values beyond their limits instead of changing them.
class Reconfigure {
public:
    /// A request to the simulator to change a sensor; returns the reason if it refuses, else an empty string.
    using Change = std::function<std::string(const bv_sensor_settings& sensor, const std::string& words)>;

    /// Serves in the namespace of `nh`, the sensor's.
    Reconfigure(ros::NodeHandle nh, Change change);

    /// Publishes the current settings from the simulator.
    void tell(const bv_sensor_settings& sensor);
    /// Requests the values of parameters that are set in the namespace.
    void apply_given();

private:
    bool set(dynamic_reconfigure::Reconfigure::Request& request, dynamic_reconfigure::Reconfigure::Response& response);
    void describe();

    ros::NodeHandle nh_;
    const Change change_;
    std::mutex mutex_;
    std::optional<bv_sensor_settings> first_, now_;
    ros::Publisher descriptions_, updates_;
    ros::ServiceServer service_;
};

}  // namespace belvedere_ros
