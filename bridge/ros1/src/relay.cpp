#include "relay.hpp"

#include <exception>
#include <utility>

namespace belvedere_ros {

namespace {

using std::chrono::milliseconds;

// The interval of retries to subscribe, and of checks without an event.
constexpr milliseconds kPatience{1000};
// The interval of checks whether a held frame was released.
constexpr milliseconds kRoom{10};

}  // namespace

Relay::Stamps Relay::stamps_of(const bv_stream_info& stream) {
    switch (stream.kind) {
        case BV_KIND_STATIC_TRANSFORMS:
        case BV_KIND_MODEL_STATES: return Stamps::any;
        case BV_KIND_ROBOT_EVENT: return Stamps::new_ones;
        default: return Stamps::rising;
    }
}

Relay::Relay(Domain& domain, const bv_stream_info& stream, std::unique_ptr<Output> output, std::shared_ptr<Bell> bell,
             Stamps stamps, std::chrono::microseconds busy_poll)
    : domain_(domain), stream_(stream.topic), kind_(stream.kind), stamps_(stamps), busy_poll_(busy_poll),
      output_(std::move(output)), bell_(std::move(bell)), flow_(stream.rate_hz), thread_([this] { run(); }) {}

Relay::~Relay() {
    stopping_ = true;
    bell_->ring();
    thread_.join();
}

bool Relay::wanted() const {
    return !stopping_ && output_->subscribers() > 0;
}

void Relay::run() {
    while (!stopping_) {
        try {
            if (wanted()) follow();
        } catch (const std::exception& error) {
            complain(error.what());
        }
        // A ring at the end may have been consumed already.
        if (!stopping_) bell_->sleep(kPatience);
    }
}

void Relay::follow() {
    belvedere::Subscriber subscriber = domain_.subscribe(stream_);
    subscriber.set_busy_poll(busy_poll_);
    const int frames = subscriber.fd();
    flow_.begin();
    while (wanted()) {
        bool full = false;
        try {
            while (wanted()) {
                auto frame = subscriber.take();
                if (!frame) break;
                pass_on(std::move(*frame));
            }
        } catch (const belvedere::Error& error) {
            full = error.status() == BV_STATUS_LIMIT;
            if (!full && error.status() != BV_STATUS_BAD_FRAME) throw;
            complain(error.what());
        }
        flow_.publishers(subscriber.publishers());
        // While the maximum number of frames is held, the descriptor is readable but no frame can be taken.
        if (full)
            bell_->sleep(kRoom);
        else
            bell_->sleep(kPatience, frames);
    }
    flow_.end();
}

void Relay::pass_on(belvedere::Frame frame) {
    const belvedere::Header& header = frame.header();
    if (header.kind != kind_) return complain("a frame is of kind " + std::to_string(header.kind) + " there");
    if (header.session != session_) {
        session_ = header.session;
        last_stamp_ns_ = 0;
    }
    // Sent before the subscription, and so too old to publish.
    if (stamps_ != Stamps::any && frame.is_from_history()) return;
    if (stamps_ == Stamps::rising) {
        // A repeated stamp is not published again. After a reset stamps restart.
        if (header.stamp_ns == 0 || header.stamp_ns == last_stamp_ns_) return;
        last_stamp_ns_ = header.stamp_ns;
    }
    flow_.count(frame.missed());
    try {
        output_->publish(std::move(frame));
    } catch (const Unrepresentable& error) {
        complain(error.what());
    }
}

void Relay::complain(const std::string& problem) {
    if (flow_.problem(problem)) ROS_WARN_STREAM(output_->topic() << " (stream " << stream_ << "): " << problem);
}

Flow::Report Relay::report() {
    return flow_.report(output_->subscribers());
}

}  // namespace belvedere_ros
