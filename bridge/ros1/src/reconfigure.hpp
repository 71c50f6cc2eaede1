// The settings of one sensor, as dynamic_reconfigure serves them.
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

/// Speaks dynamic_reconfigure's messages itself: the parameters of that library's Server<> are fixed when a program is
/// compiled, and which ones a sensor has, within which limits, the simulator says.
///
/// Unlike that class it does not keep values on the parameter server, where they would outlive the simulator that had them,
/// and it refuses what is out of its limits instead of changing it.
class Reconfigure {
public:
    /// Asks the simulator to change a sensor; gives its reason when it refuses, else nothing.
    using Change = std::function<std::string(const bv_sensor_settings& sensor, const std::string& words)>;

    /// Serves in the namespace of `nh`: that of the sensor.
    Reconfigure(ros::NodeHandle nh, Change change);

    /// What the simulator says they are now.
    void tell(const bv_sensor_settings& sensor);
    /// Asks for the values of parameters that somebody has set in the namespace.
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
