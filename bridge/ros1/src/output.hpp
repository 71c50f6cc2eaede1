// A ROS topic, with the conversion of frames to its messages.
#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include <functional>
#include <memory>
#include <utility>

#include "bell.hpp"
#include "convert/header.hpp"
#include "convert/struct_message.hpp"

namespace belvedere_ros {

/// The destination of a relay's frames.
class Output {
public:
    virtual ~Output() = default;
    /// Returns the topic with its namespace, after remapping.
    virtual std::string topic() const = 0;
    /// Returns the number of subscribers now, in this process or others.
    virtual std::uint32_t subscribers() const = 0;
    /// Converts and publishes a frame. Throws Unrepresentable.
    virtual void publish(belvedere::Frame frame) = 0;
};

/// A converter, which returns the message of a frame, or null if there is none to publish.
template <class Message>
using Convert = std::function<boost::shared_ptr<Message>(const Sample&)>;

/// A topic published by roscpp. It rings `bell` when a subscriber connects or disconnects.
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

/// A topic of structs, whose type and messages come from the library.
class StructOutput : public Output {
public:
    StructOutput(ros::NodeHandle nh, const std::string& topic, std::uint32_t queue, const std::shared_ptr<Bell>& bell, StructMessage convert)
        : convert_(std::move(convert)) {
        const auto changed = [bell](const ros::SingleSubscriberPublisher&) { bell->ring(); };
        ros::AdvertiseOptions options(topic, queue, convert_.md5(), convert_.name(), convert_.definition(), changed, changed);
        options.has_header = convert_.has_header();
        publisher_ = nh.advertise(options);
    }

    std::string topic() const override { return publisher_.getTopic(); }
    std::uint32_t subscribers() const override { return publisher_.getNumSubscribers(); }
    void publish(belvedere::Frame frame) override { publisher_.publish(convert_(Sample(frame))); }

private:
    StructMessage convert_;
    ros::Publisher publisher_;
};

/// A topic of images, with all installed transports.
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
