// Throttling of repeated messages.
#pragma once

#include <chrono>

namespace belvedere_ros {

/// A throttle by wall time: the throttles of rosconsole use simulated time, which stops when messages matter most. Only
/// one thread may use it.
class Reminder {
public:
    /// Returns true if ten seconds have passed since it last returned true, and at first.
    bool due() {
        const auto now = std::chrono::steady_clock::now();
        if (now < next_) return false;
        next_ = now + std::chrono::seconds(10);
        return true;
    }

private:
    std::chrono::steady_clock::time_point next_{};
};

}  // namespace belvedere_ros
