// What wakes a thread that has nothing to do.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace belvedere_ros {

/// Rung by whoever has changed what a sleeping thread waits for.
class Bell {
public:
    void ring() {
        const std::lock_guard<std::mutex> lock(mutex_);
        condition_.notify_all();
    }

    /// Sleeps until `true_now` is, looking again at every ring. Whether it is, after at most `patience`.
    template <class Predicate>
    bool wait(std::chrono::milliseconds patience, Predicate true_now) {
        std::unique_lock<std::mutex> lock(mutex_);
        return condition_.wait_for(lock, patience, true_now);
    }

private:
    std::mutex mutex_;
    std::condition_variable condition_;
};

}  // namespace belvedere_ros
