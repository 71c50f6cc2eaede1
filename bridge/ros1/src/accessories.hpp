// What a Kobuki has besides its sensors and wheels: lamps, sounds, sockets, buttons.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace belvedere_ros {

/// Takes the commands for them that kobuki_node takes, and advertises its events of them. Nothing of them is simulated: a
/// command changes what diagnostics say of it, and nobody presses a button.
class Accessories {
public:
    /// `space` is the robot's namespace, with its slash; empty: none.
    Accessories(ros::NodeHandle nh, const std::string& space);

    /// What each was last told.
    void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const;

private:
    /// Says it once, in the log, whenever it changes.
    void keep(const std::string& name, const std::string& value);

    const std::string base_;
    mutable std::mutex mutex_;
    std::map<std::string, std::string> told_;
    std::vector<ros::Publisher> events_;
    // The first that end: they use what is above.
    std::vector<ros::Subscriber> commands_;
};

}  // namespace belvedere_ros
