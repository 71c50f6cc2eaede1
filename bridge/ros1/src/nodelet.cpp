// The bridge as a nodelet: subscribers in the same manager receive its messages without a copy.

#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

#include <memory>

#include "bridge.hpp"

namespace belvedere_ros {

class BridgeNodelet : public nodelet::Nodelet {
    void onInit() override { bridge_ = std::make_unique<Bridge>(getNodeHandle(), getPrivateNodeHandle()); }

    std::unique_ptr<Bridge> bridge_;
};

}  // namespace belvedere_ros

PLUGINLIB_EXPORT_CLASS(belvedere_ros::BridgeNodelet, nodelet::Nodelet)
