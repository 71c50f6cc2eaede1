// Frames without a copy, for nodelets in the bridge's own process.
//
//   frames_ = std::make_unique<belvedere_ros::FrameSubscriber>(getNodeHandle(), "image_raw",
//       [this](const belvedere_ros::FrameViewConstPtr& view) { look_at(view->frame().row<std::uint8_t>(0)); });
//
// What roscpp hands from nodelet to nodelet is a message, into which the bridge has copied the payload. This hands over the
// frame itself, where the simulator wrote it.
#pragma once

#include <boost/shared_ptr.hpp>
#include <ros/node_handle.h>
#include <std_msgs/Header.h>

#include <belvedere.hpp>

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace belvedere_ros {

/// A frame in shared memory, which is unchanged for as long as somebody holds this. Any thread may read it.
class FrameView {
public:
    FrameView(std_msgs::Header header, belvedere::Frame frame) : header_(std::move(header)), frame_(std::move(frame)) {}

    /// Stamp and frame_id, as the message of this frame has them.
    const std_msgs::Header& header() const { return header_; }
    /// Sizes, encoding, intrinsics, rows and bytes; belvedere/opencv.hpp, eigen.hpp and pcl.hpp show it as the types of these
    /// libraries.
    const belvedere::Frame& frame() const { return frame_; }

private:
    std_msgs::Header header_;
    belvedere::Frame frame_;
};

using FrameViewConstPtr = boost::shared_ptr<const FrameView>;

/// Gives the frames of a topic that a bridge in this process serves, now or later.
///
/// Its callback runs in a thread of its own, one at a time, with no queue between: that would cost a second awakening. A
/// view may be kept; while two are, there is no room for a third, frames are missed, and the log says so.
class FrameSubscriber {
public:
    using Callback = std::function<void(const FrameViewConstPtr&)>;

    /// The topic is resolved and remapped as that of a ros::Subscriber. Throws ros::InvalidNameException.
    ///
    /// With `busy_poll`, frames are looked for when they are due, for at most so long each, instead of slept for: they come
    /// microseconds after they were sent, at the price of processor time (belvedere::Subscriber::set_busy_poll).
    FrameSubscriber(const ros::NodeHandle& nh, const std::string& topic, Callback callback, std::chrono::microseconds busy_poll = {});
    /// No callback runs afterwards. Not to be called from the callback.
    ~FrameSubscriber();
    FrameSubscriber(const FrameSubscriber&) = delete;
    FrameSubscriber& operator=(const FrameSubscriber&) = delete;

    const std::string& topic() const;
    /// Whether a bridge in this process serves the topic now.
    bool is_served() const;

private:
    class Following;
    std::unique_ptr<Following> following_;
};

}  // namespace belvedere_ros
