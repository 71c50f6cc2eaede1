// The rate and losses of a stream, for diagnostics.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>

namespace belvedere_ros {

/// Counts frames between reports. Any thread may use it.
class Flow {
public:
    using Clock = std::chrono::steady_clock;

    struct Report {
        std::uint32_t subscribers;
        /// True if the stream had subscribers for the whole time.
        bool followed;
        std::size_t publishers;
        double rate_hz;
        /// 0 without a fixed rate.
        double nominal_rate_hz;
        std::uint64_t frames_total;
        std::uint64_t missed_total;
        /// The last problem since the previous report, or empty.
        std::string problem;
    };

    explicit Flow(double nominal_rate_hz) : nominal_rate_hz_(nominal_rate_hz) {}

    /// Sets the intended rate.
    void expect(double nominal_rate_hz);
    void begin();
    void end();
    void publishers(std::size_t count);
    void count(std::uint64_t missed);
    /// Records a problem. Returns true if it differs from the previous one, and should be logged.
    bool problem(const std::string& text);
    Report report(std::uint32_t subscribers);

private:
    std::mutex mutex_;
    double nominal_rate_hz_;
    bool followed_ = false;
    std::size_t publishers_ = 0;
    std::uint64_t frames_total_ = 0;
    std::uint64_t missed_total_ = 0;
    std::string problem_;
    std::string last_problem_;
    // The frame counts at the last reports, the oldest first. The rate is measured over several seconds, as slow
    // streams require.
    struct Mark {
        Clock::time_point time;
        std::uint64_t frames;
    };
    std::deque<Mark> marks_;
};

}  // namespace belvedere_ros
