#include "flow.hpp"

#include <utility>

namespace belvedere_ros {

namespace {

// The number of reports over which the rate is measured.
constexpr std::size_t kReports = 5;

}  // namespace

void Flow::expect(double nominal_rate_hz) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (std::exchange(nominal_rate_hz_, nominal_rate_hz) == nominal_rate_hz) return;
    // Frames at the old rate do not count towards the new one.
    if (!marks_.empty()) marks_ = {{Clock::now(), frames_total_}};
}

void Flow::begin() {
    const std::lock_guard<std::mutex> lock(mutex_);
    followed_ = true;
    publishers_ = 0;
    marks_ = {{Clock::now(), frames_total_}};
}

void Flow::end() {
    const std::lock_guard<std::mutex> lock(mutex_);
    followed_ = false;
}

void Flow::publishers(std::size_t count) {
    const std::lock_guard<std::mutex> lock(mutex_);
    publishers_ = count;
}

void Flow::count(std::uint64_t missed) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++frames_total_;
    missed_total_ += missed;
}

bool Flow::problem(const std::string& text) {
    const std::lock_guard<std::mutex> lock(mutex_);
    problem_ = text;
    return std::exchange(last_problem_, text) != text;
}

Flow::Report Flow::report(std::uint32_t subscribers) {
    const std::lock_guard<std::mutex> lock(mutex_);
    double rate_hz = 0.0;
    if (!marks_.empty()) {
        const Mark now{Clock::now(), frames_total_};
        const double seconds = std::chrono::duration<double>(now.time - marks_.front().time).count();
        if (seconds > 0) rate_hz = static_cast<double>(now.frames - marks_.front().frames) / seconds;
        marks_.push_back(now);
        if (marks_.size() > kReports) marks_.pop_front();
    }
    return {subscribers, followed_, publishers_, rate_hz, nominal_rate_hz_, frames_total_, missed_total_, std::exchange(problem_, {})};
}

}  // namespace belvedere_ros
