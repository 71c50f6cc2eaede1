// A nodelet that reads images in the memory that the simulator wrote, without a copy, and publishes their mean brightness.
//
//   roslaunch examples/ros1/brightness/brightness.launch
//   rostopic echo /brightness

#include <belvedere_ros/frame_subscriber.hpp>
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>
#include <std_msgs/Float64.h>

#include <memory>
#include <numeric>

namespace examples {

class Brightness : public nodelet::Nodelet {
    void onInit() override {
        publisher_ = getNodeHandle().advertise<std_msgs::Float64>("brightness", 1);
        frames_ = std::make_unique<belvedere_ros::FrameSubscriber>(
            getNodeHandle(), "image_raw", [this](const belvedere_ros::FrameViewConstPtr& view) { look_at(view->frame()); });
    }

    void look_at(const belvedere::Frame& picture) const {
        double sum = 0.0, count = 0.0;
        for (std::uint32_t y = 0; y < picture.header().height; ++y) {
            const auto row = picture.row<std::uint8_t>(y);
            sum = std::accumulate(row.begin(), row.end(), sum);
            count += static_cast<double>(row.size());
        }
        std_msgs::Float64 mean;
        mean.data = sum / count;
        publisher_.publish(mean);
    }

    ros::Publisher publisher_;
    std::unique_ptr<belvedere_ros::FrameSubscriber> frames_;
};

}  // namespace examples

PLUGINLIB_EXPORT_CLASS(examples::Brightness, nodelet::Nodelet)
