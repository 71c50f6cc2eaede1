// Which topic and type of ROS a stream is served as.
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

/// Makes relays. Topics are named as the streams, relative to the node's namespace; tf, tf_static and clock are global.
class Topics {
public:
    Topics(ros::NodeHandle nh, ros::NodeHandle private_nh, Parameters parameters)
        : nh_(std::move(nh)), private_nh_(std::move(private_nh)), parameters_(std::move(parameters)) {}

    /// The relay of a stream, or null when the parameters leave it out. Throws Unrepresentable for a kind that is not known.
    std::unique_ptr<Relay> relay(Domain& domain, const bv_stream_info& stream) const;

    /// What a laser scanner's stream is adjusted by. Throws BadParameter.
    ScanParameters scan_parameters(const std::string& stream) const { return parameters_.scan.of_topic(private_nh_, stream); }

private:
    std::unique_ptr<Output> output(const bv_stream_info& stream, const std::shared_ptr<Bell>& bell) const;
    Convert<sensor_msgs::CameraInfo> camera_info_converter(const std::string& topic) const;

    ros::NodeHandle nh_, private_nh_;
    Parameters parameters_;
    std::shared_ptr<StaticTransforms> static_transforms_ = std::make_shared<StaticTransforms>();
};

}  // namespace belvedere_ros
