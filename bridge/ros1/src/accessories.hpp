// Accessories of a Kobuki besides its sensors and wheels: lamps, sounds, sockets, buttons.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace belvedere_ros {

/// Accepts the commands for accessories that kobuki_node accepts, and advertises its events. Accessories are not
/// simulated: a command only changes what diagnostics report, and no button event is sent.
class Accessories {
public:
    /// Subscribes and advertises; `space` is the robot's namespace with its slash, or empty.
    Accessories(ros::NodeHandle nh, const std::string& space);

    /// Reports the last command of each accessory.
    void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const;

private:
    /// Records a value, and logs it whenever it changes.
    void keep(const std::string& name, const std::string& value);

    const std::string base_;
    mutable std::mutex mutex_;
    std::map<std::string, std::string> told_;
    std::vector<ros::Publisher> events_;
    // Declared last so that they end first: they use the members above.
    std::vector<ros::Subscriber> commands_;
};

}  // namespace belvedere_ros
