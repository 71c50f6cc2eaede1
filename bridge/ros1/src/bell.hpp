// An event that wakes an idle thread.
#pragma once

#include <chrono>

namespace belvedere_ros {

/// Any thread may ring; one thread sleeps. A ring while that thread is awake ends its next sleep.
class Bell {
public:
    Bell();
    ~Bell();
    Bell(const Bell&) = delete;
    Bell& operator=(const Bell&) = delete;

    void ring();

    /// Sleeps until the bell is rung, `descriptor` is readable, or `patience` has passed.
    void sleep(std::chrono::milliseconds patience, int descriptor = -1);

private:
    int event_;
};

}  // namespace belvedere_ros
