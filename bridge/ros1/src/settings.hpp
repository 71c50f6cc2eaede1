// The settings of the simulator's sensors.
#pragma once

#include <ros/ros.h>

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "bell.hpp"
#include "domain.hpp"
#include "reconfigure.hpp"
#include "reminder.hpp"

namespace belvedere_ros {

/// A client of the simulator's sensor settings in its own thread, which serves each sensor by dynamic_reconfigure in
/// the private namespace of the node, under the sensor's name. A parameter that is set there, before the node starts or
/// later, is applied to each simulator that is found.
class Settings {
public:
    Settings(ros::NodeHandle private_nh, Domain& domain);
    ~Settings();
    Settings(const Settings&) = delete;
    Settings& operator=(const Settings&) = delete;

    /// Returns the current rate of a stream, if the simulator reports it.
    std::optional<double> rate_hz(const std::string& stream) const;

private:
    void run();
    void follow();
    void take(const belvedere::Frame& frame);
    std::string change(const bv_sensor_settings& sensor, const std::string& words);

    ros::NodeHandle private_nh_;
    Domain& domain_;
    mutable std::mutex rates_mutex_;
    std::map<std::string, double> rates_hz_;
    std::mutex control_mutex_;
    std::optional<belvedere::Control> control_;
    std::map<std::string, std::unique_ptr<Reconfigure>> servers_;
    std::uint64_t session_ = 0;
    Reminder trouble_;
    Bell bell_;
    std::atomic<bool> stopping_{false};
    std::thread thread_;
};

}  // namespace belvedere_ros
