// The parameters of laser scanners.
#pragma once

#include <ros/node_handle.h>

#include <limits>
#include <string>

#include "parameter_readers.hpp"

namespace belvedere_ros {

/// As REP-138 names them. They are read once; `~NAME` holds for every scan, `~TOPIC/NAME` for that of the topic.
struct ScanParameters {
    /// ~frame_id (text): the frame in place of the simulator's; empty: that.
    std::string frame_id;
    /// ~angle_min, ~angle_max (radians): what lies outside is left out, ray by ray.
    double angle_min = -std::numeric_limits<double>::infinity();
    double angle_max = std::numeric_limits<double>::infinity();
    /// More than any clock is off, in seconds.
    static constexpr double most_offset = 1e9;
    /// ~time_offset (seconds, at most `most_offset` either way): added to every stamp.
    double time_offset = 0.0;
    /// ~publish_intensity (true): whether intensities are sent.
    bool publish_intensity = true;

    /// These, but for what is given for the topic. Throws BadParameter.
    ScanParameters of_topic(const ros::NodeHandle& private_nh, const std::string& topic) const;

    /// How each is read into this one.
    Readers readers();
    /// Throws BadParameter when they cannot hold together.
    void check(const std::string& where) const;
};

}  // namespace belvedere_ros
