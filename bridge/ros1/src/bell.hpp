// What wakes a thread that has nothing to do.
#pragma once

#include <chrono>

namespace belvedere_ros {

/// Rung by any thread; one thread sleeps. A ring while it is awake wakes it from its next sleep.
class Bell {
public:
    Bell();
    ~Bell();
    Bell(const Bell&) = delete;
    Bell& operator=(const Bell&) = delete;

    void ring();

    /// Sleeps until it is rung, `descriptor` can be read, or `patience` is over.
    void sleep(std::chrono::milliseconds patience, int descriptor = -1);

private:
    int event_;
};

}  // namespace belvedere_ros
