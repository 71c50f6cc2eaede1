// A topic of ROS, and how a frame becomes its message.
#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include <functional>
#include <memory>
#include <utility>

#include "bell.hpp"
#include "convert/header.hpp"

namespace belvedere_ros {

/// Where a relay sends its frames.
class Output {
public:
    virtual ~Output() = default;
    /// The topic with its namespace, as it is after remapping.
    virtual std::string topic() const = 0;
    /// Who listens now, in this process or another.
    virtual std::uint32_t subscribers() const = 0;
    /// Converts and publishes. Throws Unrepresentable.
    virtual void publish(belvedere::Frame frame) = 0;
};

/// A converter: the message of a frame, or null when there is nothing to say.
template <class Message>
using Convert = std::function<boost::shared_ptr<Message>(const Sample&)>;

/// A topic as roscpp publishes it. `bell` is rung when somebody comes or goes.
template <class Message>
class TopicOutput : public Output {
public:
    TopicOutput(ros::NodeHandle nh, const std::string& topic, std::uint32_t queue, bool latch, const std::shared_ptr<Bell>& bell,
                Convert<Message> convert)
        : convert_(std::move(convert)) {
        const auto changed = [bell](const ros::SingleSubscriberPublisher&) { bell->ring(); };
        publisher_ = nh.advertise<Message>(topic, queue, changed, changed, ros::VoidConstPtr(), latch);
    }

    std::string topic() const override { return publisher_.getTopic(); }
    std::uint32_t subscribers() const override { return publisher_.getNumSubscribers(); }
    void publish(belvedere::Frame frame) override {
        if (const auto message = convert_(Sample(frame))) publisher_.publish(message);
    }

private:
    Convert<Message> convert_;
    ros::Publisher publisher_;
};

/// Images, with all the transports that are installed.
class ImageOutput : public Output {
public:
    ImageOutput(const ros::NodeHandle& nh, const std::string& topic, std::uint32_t queue, const std::shared_ptr<Bell>& bell,
                Convert<sensor_msgs::Image> convert)
        : convert_(std::move(convert)) {
        const auto changed = [bell](const image_transport::SingleSubscriberPublisher&) { bell->ring(); };
        publisher_ = image_transport::ImageTransport(nh).advertise(topic, queue, changed, changed);
    }

    std::string topic() const override { return publisher_.getTopic(); }
    std::uint32_t subscribers() const override { return publisher_.getNumSubscribers(); }
    void publish(belvedere::Frame frame) override {
        if (const auto message = convert_(Sample(frame))) publisher_.publish(message);
    }

private:
    Convert<sensor_msgs::Image> convert_;
    image_transport::Publisher publisher_;
};

}  // namespace belvedere_ros
