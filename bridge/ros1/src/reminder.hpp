// Saying the same thing again, but not too often.
#pragma once

#include <chrono>

namespace belvedere_ros {

/// By the clock on the wall: the throttles of rosconsole go by simulated time, which stands still when there is most to
/// say. One thread may use it.
class Reminder {
public:
    /// Whether ten seconds have passed since it was last due; at first, yes.
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
