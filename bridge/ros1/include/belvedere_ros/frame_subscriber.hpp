// Frames without a copy, for nodelets in the process of the bridge.
//
//   frames_ = std::make_unique<belvedere_ros::FrameSubscriber>(getNodeHandle(), "image_raw",
//       [this](const belvedere_ros::FrameViewConstPtr& view) { process(view->frame().row<std::uint8_t>(0)); });
//
// roscpp passes messages from nodelet to nodelet, into which the bridge has copied the payload. This class passes the
// frame itself, in the simulator's own memory.
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

/// A frame in shared memory, which does not change as long as a reference to this object exists. Any thread may read
/// it.
class FrameView {
public:
    FrameView(std_msgs::Header header, belvedere::Frame frame) : header_(std::move(header)), frame_(std::move(frame)) {}

    /// Returns stamp and frame_id, as in the message of this frame.
    const std_msgs::Header& header() const { return header_; }
    /// Returns the frame with sizes, encoding, intrinsics, rows and bytes; belvedere/opencv.hpp, eigen.hpp and pcl.hpp
    /// convert it to the types of these libraries.
    const belvedere::Frame& frame() const { return frame_; }

private:
    std_msgs::Header header_;
    belvedere::Frame frame_;
};

using FrameViewConstPtr = boost::shared_ptr<const FrameView>;

/// A subscriber to the frames of a topic that a bridge in this process serves, now or later.
///
/// The callback runs in its own thread, one call at a time. There is no queue in between, which would cost a second
/// wakeup. A view may be kept. While two are kept, there is no room for a third: frames are missed, and the log reports
/// it.
class FrameSubscriber {
public:
    using Callback = std::function<void(const FrameViewConstPtr&)>;

    /// Subscribes to a topic, which is resolved and remapped like that of a ros::Subscriber. Throws
    /// ros::InvalidNameException.
    ///
    /// With `busy_poll`, frames that are due are polled for without sleeping, for at most this time each, which reduces
    /// their latency to microseconds at the cost of processor time (belvedere::Subscriber::set_busy_poll).
    FrameSubscriber(const ros::NodeHandle& nh, const std::string& topic, Callback callback, std::chrono::microseconds busy_poll = {});
    /// Ends the subscription: no callback runs afterwards. Must not be called from the callback.
    ~FrameSubscriber();
    FrameSubscriber(const FrameSubscriber&) = delete;
    FrameSubscriber& operator=(const FrameSubscriber&) = delete;

    const std::string& topic() const;
    /// Returns true if a bridge in this process serves the topic now.
    bool is_served() const;

private:
    class Following;
    std::unique_ptr<Following> following_;
};

}  // namespace belvedere_ros
