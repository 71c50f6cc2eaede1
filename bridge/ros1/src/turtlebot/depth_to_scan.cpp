// A scan from a depth camera, with the topics and parameters of depthimage_to_laserscan: image and its camera_info,
// scan; ~scan_height, ~scan_time, ~range_min, ~range_max, ~output_frame_id. It subscribes to images while the scan has
// subscribers.

#include <image_transport/image_transport.h>
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

#include <memory>
#include <mutex>

#include "../parameter_readers.hpp"
#include "../reminder.hpp"
#include "depth_scan.hpp"

namespace belvedere_ros::turtlebot {

using Value = XmlRpc::XmlRpcValue;

class DepthToScan : public nodelet::Nodelet {
    void onInit() override {
        ros::NodeHandle &nh = getNodeHandle(), &own = getPrivateNodeHandle();
        const auto number = [](float& into) { return [&into](Value& value) { into = static_cast<float>(to_number(value)); }; };
        read_all(own, {
            {"scan_height", [this](Value& value) {
                const double rows = to_number(value);
                if (rows < 1 || rows > 65535 || rows != static_cast<int>(rows)) throw BadParameter("a number of rows, 1 at least");
                settings_.scan_height = static_cast<int>(rows);
            }},
            {"scan_time", number(settings_.scan_time)},
            {"range_min", number(settings_.range_min)},
            {"range_max", number(settings_.range_max)},
            {"output_frame_id", [this](Value& value) { settings_.output_frame_id = to_text(value); }},
        });
        if (!(settings_.range_min >= 0 && settings_.range_min < settings_.range_max))
            throw BadParameter(own.resolveName("range_min") + " is " + std::to_string(settings_.range_min) +
                               "; it must be 0 at least, and below range_max, " + std::to_string(settings_.range_max));
        images_ = std::make_unique<image_transport::ImageTransport>(nh);
        const auto heard = [this](const ros::SingleSubscriberPublisher&) { follow(); };
        const std::lock_guard<std::mutex> lock(mutex_);
        scans_ = nh.advertise<sensor_msgs::LaserScan>("scan", 10, heard, heard);
    }

    /// Subscribes to the camera if the scan has subscribers, else unsubscribes.
    void follow() {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (scans_.getNumSubscribers() == 0) {
            camera_.shutdown();
        } else if (!camera_) {
            camera_ = images_->subscribeCamera("image", 2, &DepthToScan::take, this);
        }
    }

    void take(const sensor_msgs::ImageConstPtr& depth, const sensor_msgs::CameraInfoConstPtr& info) {
        try {
            scans_.publish(settings_.scan(*depth, *info));
        } catch (const BadDepth& error) {
            if (trouble_.due()) NODELET_WARN_STREAM("no scan of " << error.what());
        }
    }

    DepthScan settings_;
    Reminder trouble_;
    std::mutex mutex_;
    std::unique_ptr<image_transport::ImageTransport> images_;
    ros::Publisher scans_;
    image_transport::CameraSubscriber camera_;
};

}  // namespace belvedere_ros::turtlebot

PLUGINLIB_EXPORT_CLASS(belvedere_ros::turtlebot::DepthToScan, nodelet::Nodelet)
