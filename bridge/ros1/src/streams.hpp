// The streams of the domain, including those that appear later.
#pragma once

#include <belvedere.hpp>

#include <atomic>
#include <functional>
#include <thread>

#include "bell.hpp"
#include "domain.hpp"
#include "reminder.hpp"

namespace belvedere_ros {

/// A watcher of a domain in its own thread.
class Streams {
public:
    using Found = std::function<void(const bv_stream_info&)>;

    /// Calls `found` in that thread for every stream at every check, so that changed streams are noticed.
    Streams(Domain& domain, Found found);
    ~Streams();
    Streams(const Streams&) = delete;
    Streams& operator=(const Streams&) = delete;

    /// Returns true if a simulator publishes in the domain now.
    bool simulator_is_there() const { return simulator_is_there_; }

private:
    void run();
    void look();

    Domain& domain_;
    Found found_;
    Bell bell_;
    Reminder trouble_, waiting_;
    std::atomic<bool> simulator_is_there_{false};
    std::atomic<bool> stopping_{false};
    std::thread thread_;
};

}  // namespace belvedere_ros
