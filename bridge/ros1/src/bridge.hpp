// The bridge from a domain of the simulator to ROS.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "accessories.hpp"
#include "commands.hpp"
#include "domain.hpp"
#include "gazebo/namespace.hpp"
#include "parameters.hpp"
#include "relay.hpp"
#include "settings.hpp"
#include "served.hpp"
#include "streams.hpp"
#include "topics.hpp"

namespace belvedere_ros {

/// The implementation shared by the node and the nodelet.
class Bridge {
public:
    /// Starts the bridge. Throws BadParameter, and belvedere::Error if the domain cannot be joined.
    Bridge(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);

    /// Serves a stream, unless it is served already. A stream that cannot be served is skipped for ever, with one
    /// warning.
    void serve(const bv_stream_info& stream);

private:
    /// A stream that is served, to other processes and within this one.
    struct Serving {
        std::unique_ptr<Relay> relay;
        std::unique_ptr<Served::Place> place;
        /// Set for laser scanners only.
        std::uint32_t layers = 0;
        std::optional<double> time_offset = std::nullopt;
    };

    void drop(std::map<std::string, Serving>::iterator relay);
    void diagnose_simulator(diagnostic_updater::DiagnosticStatusWrapper& status) const;
    void diagnose_topic(const std::string& stream, diagnostic_updater::DiagnosticStatusWrapper& status);

    ros::NodeHandle nh_;
    const Parameters parameters_;
    Domain domain_;
    Topics topics_;
    diagnostic_updater::Updater diagnostics_;
    std::mutex serving_, mutex_;
    std::map<std::string, Serving> relays_;
    std::map<std::string, std::unique_ptr<Commands>> commands_;
    /// Keyed by the robot's namespace.
    std::map<std::string, std::unique_ptr<Accessories>> accessories_;
    std::set<std::string> skipped_;
    Settings settings_;
    gazebo::Namespace gazebo_;
    // Declared last so that they start last and end first: they use the members above.
    std::unique_ptr<Streams> streams_;
    ros::WallTimer diagnostics_timer_;
};

}  // namespace belvedere_ros
