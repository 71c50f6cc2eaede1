// What /tf_static says: of all robots together.
#pragma once

#include <boost/make_shared.hpp>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <string>

namespace belvedere_ros {

/// All transforms that never change. A latched topic keeps one message of a node: with several robots it has to be that of
/// all of them, or who comes late knows only the last.
class StaticTransforms {
public:
    /// All of them, with those of a message; null if these say nothing new: what is latched is sent once.
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
    /// By the child's frame.
    std::map<std::string, geometry_msgs::TransformStamped> known_;
};

}  // namespace belvedere_ros
