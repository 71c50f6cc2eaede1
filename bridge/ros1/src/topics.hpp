// The ROS topic and type of each stream.
#pragma once

#include <camera_info_manager/camera_info_manager.h>

#include <map>
#include <memory>
#include <string>

#include "output.hpp"
#include "parameters.hpp"
#include "relay.hpp"
#include "static_transforms.hpp"

namespace belvedere_ros {

/// A factory of relays. Topics are named like the streams, relative to the node's namespace; tf, tf_static and clock
/// are global.
class Topics {
public:
    Topics(ros::NodeHandle nh, ros::NodeHandle private_nh, Parameters parameters)
        : nh_(std::move(nh)), private_nh_(std::move(private_nh)), parameters_(std::move(parameters)) {}

    /// Returns the relay of a stream, or null if the parameters exclude it. Throws Unrepresentable for an unknown kind.
    std::unique_ptr<Relay> relay(Domain& domain, const bv_stream_info& stream) const;

    /// Returns the parameters that adjust a laser scanner's stream. Throws BadParameter.
    ScanParameters scan_parameters(const std::string& stream) const { return parameters_.scan.of_topic(private_nh_, stream); }

private:
    std::unique_ptr<Output> output(const bv_stream_info& stream, const std::shared_ptr<Bell>& bell) const;
    Convert<sensor_msgs::CameraInfo> camera_info_converter(const std::string& topic) const;

    ros::NodeHandle nh_, private_nh_;
    Parameters parameters_;
    std::shared_ptr<StaticTransforms> static_transforms_ = std::make_shared<StaticTransforms>();
};

}  // namespace belvedere_ros
