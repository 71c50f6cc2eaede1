// One stream, served as one topic while it has subscribers.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "bell.hpp"
#include "domain.hpp"
#include "flow.hpp"
#include "output.hpp"

namespace belvedere_ros {

/// A relay, which subscribes to a stream in its own thread while its output has subscribers. A stream without ROS
/// subscribers is neither read nor converted, and the simulator sees no subscriber. The relay continues by itself if
/// the simulator is restarted.
class Relay {
public:
    /// The condition on a frame's stamp for it to be published.
    enum class Stamps {
        /// Different from the previous stamp and not zero; the frame must not be older than the subscription.
        rising,
        /// Any stamp, as several events may have the same; the frame must not be older than the subscription.
        new_ones,
        /// Any stamp and age, for latched data.
        any,
    };

    /// Returns the condition for a stream.
    static Stamps stamps_of(const bv_stream_info& stream);

    /// Starts a relay. Frames that are due are polled for, for at most `busy_poll`: see
    /// belvedere::Subscriber::set_busy_poll.
    Relay(Domain& domain, const bv_stream_info& stream, std::unique_ptr<Output> output, std::shared_ptr<Bell> bell, Stamps stamps,
          std::chrono::microseconds busy_poll = {});
    ~Relay();
    Relay(const Relay&) = delete;
    Relay& operator=(const Relay&) = delete;

    const std::string& stream() const { return stream_; }
    std::uint16_t kind() const { return kind_; }
    std::string topic() const { return output_->topic(); }
    /// Sets the intended rate, which may differ from the stream's original one.
    void expect(double rate_hz) { flow_.expect(rate_hz); }
    /// Returns the report since the previous call.
    Flow::Report report();

private:
    bool wanted() const;
    void run();
    void follow();
    void pass_on(belvedere::Frame frame);
    void complain(const std::string& problem);

    Domain& domain_;
    const std::string stream_;
    const std::uint16_t kind_;
    const Stamps stamps_;
    const std::chrono::microseconds busy_poll_;
    std::unique_ptr<Output> output_;
    std::shared_ptr<Bell> bell_;
    Flow flow_;
    std::uint64_t session_ = 0;
    std::uint64_t last_stamp_ns_ = 0;
    std::atomic<bool> stopping_{false};
    std::thread thread_;
};

}  // namespace belvedere_ros
