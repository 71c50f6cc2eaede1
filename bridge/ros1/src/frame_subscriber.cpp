#include "belvedere_ros/frame_subscriber.hpp"

#include <boost/make_shared.hpp>

#include "output.hpp"
#include "relay.hpp"
#include "served.hpp"

namespace belvedere_ros {

namespace {

/// An output that passes frames to a callback unchanged.
class FrameOutput : public Output {
public:
    FrameOutput(std::string topic, FrameSubscriber::Callback callback) : topic_(std::move(topic)), callback_(std::move(callback)) {}

    std::string topic() const override { return topic_; }
    std::uint32_t subscribers() const override { return 1; }
    void publish(belvedere::Frame frame) override {
        auto header = to_header(Sample(frame));
        callback_(boost::make_shared<FrameView>(std::move(header), std::move(frame)));
    }

private:
    const std::string topic_;
    FrameSubscriber::Callback callback_;
};

}  // namespace

class FrameSubscriber::Following : public Served::Seeker {
public:
    Following(std::string topic, Callback callback, std::chrono::microseconds busy_poll)
        : topic_(std::move(topic)), callback_(std::move(callback)), busy_poll_(busy_poll) {
        Served::here().seek(topic_, *this);
    }
    ~Following() override { Served::here().forget(topic_, *this); }

    const std::string& topic() const { return topic_; }
    bool is_served() const { return is_served_; }

    void serve(const Source* source) override {
        is_served_ = source != nullptr;
        relay_.reset();
        if (source == nullptr) return;
        relay_ = std::make_unique<Relay>(source->domain, source->stream, std::make_unique<FrameOutput>(topic_, callback_),
                                         std::make_shared<Bell>(), Relay::stamps_of(source->stream), busy_poll_);
    }

private:
    const std::string topic_;
    const Callback callback_;
    const std::chrono::microseconds busy_poll_;
    std::atomic<bool> is_served_{false};
    std::unique_ptr<Relay> relay_;
};

FrameSubscriber::FrameSubscriber(const ros::NodeHandle& nh, const std::string& topic, Callback callback,
                                 std::chrono::microseconds busy_poll)
    : following_(std::make_unique<Following>(nh.resolveName(topic), std::move(callback), busy_poll)) {}

FrameSubscriber::~FrameSubscriber() = default;

const std::string& FrameSubscriber::topic() const {
    return following_->topic();
}

bool FrameSubscriber::is_served() const {
    return following_->is_served();
}

}  // namespace belvedere_ros
