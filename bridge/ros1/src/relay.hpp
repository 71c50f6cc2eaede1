// One stream, served as one topic for as long as somebody subscribes.
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

/// Follows a stream in a thread of its own while its output has subscribers, and at no other time: a stream that nobody
/// wants is neither read nor converted, and the simulator sees no subscriber. Goes on by itself when the simulator is
/// started again.
class Relay {
public:
    /// What a frame's stamp must be to be passed on.
    enum class Stamps {
        /// Another than that before, and not zero; and not older than the subscription.
        rising,
        /// Whatever it is, as several events may happen at one time; but not older than the subscription.
        new_ones,
        /// Whatever it is: what is sent holds always.
        any,
    };

    /// What a stream needs.
    static Stamps stamps_of(const bv_stream_info& stream);

    /// Frames are looked for when they are due for at most `busy_poll`, see belvedere::Subscriber::set_busy_poll.
    Relay(Domain& domain, const bv_stream_info& stream, std::unique_ptr<Output> output, std::shared_ptr<Bell> bell, Stamps stamps,
          std::chrono::microseconds busy_poll = {});
    ~Relay();
    Relay(const Relay&) = delete;
    Relay& operator=(const Relay&) = delete;

    const std::string& stream() const { return stream_; }
    std::uint16_t kind() const { return kind_; }
    std::string topic() const { return output_->topic(); }
    /// Another rate is intended than the stream was made with.
    void expect(double rate_hz) { flow_.expect(rate_hz); }
    /// How it went since this was last asked.
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
