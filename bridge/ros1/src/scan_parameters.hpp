// The parameters of laser scanners.
#pragma once

#include <ros/node_handle.h>

#include <limits>
#include <string>

#include "parameter_readers.hpp"

namespace belvedere_ros {

/// Parameters with the names of REP-138. They are read once; `~NAME` applies to every scan, `~TOPIC/NAME` to that of
/// the topic.
struct ScanParameters {
    /// ~frame_id (text): replaces the simulator's frame; empty: keeps it.
    std::string frame_id;
    /// ~angle_min, ~angle_max (radians): rays outside are removed.
    double angle_min = -std::numeric_limits<double>::infinity();
    double angle_max = std::numeric_limits<double>::infinity();
    /// The largest absolute offset in seconds, beyond any real clock error.
    static constexpr double most_offset = 1e9;
    /// ~time_offset (seconds, absolute value at most `most_offset`): added to every stamp.
    double time_offset = 0.0;
    /// ~publish_intensity (true): publishes intensities.
    bool publish_intensity = true;

    /// Returns these parameters with the overrides of the topic. Throws BadParameter.
    ScanParameters of_topic(const ros::NodeHandle& private_nh, const std::string& topic) const;

    /// Returns the readers of the parameters into this object.
    Readers readers();
    /// Throws BadParameter if the values contradict each other.
    void check(const std::string& where) const;
};

}  // namespace belvedere_ros
