// The content of /tf_static for all robots together.
#pragma once

#include <boost/make_shared.hpp>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <string>

namespace belvedere_ros {

/// The set of all fixed transforms. A latched topic keeps one message per node. With several robots it must contain the
/// transforms of all of them, or late subscribers would receive only the last one.
class StaticTransforms {
public:
    /// Adds the transforms of a message and returns all of them; null if nothing is new, since a latched message is
    /// published once.
    tf2_msgs::TFMessagePtr with(const tf2_msgs::TFMessagePtr& message) {
        const std::lock_guard<std::mutex> lock(mutex_);
        const bool same = std::all_of(message->transforms.begin(), message->transforms.end(), [&](const auto& transform) {
            const auto known = known_.find(transform.child_frame_id);
            return known != known_.end() && known->second.header.frame_id == transform.header.frame_id &&
                   known->second.transform == transform.transform;
        });
        if (same) return nullptr;
        for (const auto& transform : message->transforms) known_[transform.child_frame_id] = transform;
        const auto all = boost::make_shared<tf2_msgs::TFMessage>();
        for (const auto& [child, transform] : known_) all->transforms.push_back(transform);
        return all;
    }

private:
    std::mutex mutex_;
    /// Keyed by the child frame.
    std::map<std::string, geometry_msgs::TransformStamped> known_;
};

}  // namespace belvedere_ros
