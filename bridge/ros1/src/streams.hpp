// What is published in the domain, and what appears there later.
#pragma once

#include <belvedere.hpp>

#include <atomic>
#include <functional>
#include <thread>

#include "bell.hpp"
#include "domain.hpp"
#include "reminder.hpp"

namespace belvedere_ros {

/// Watches a domain in a thread of its own.
class Streams {
public:
    using Found = std::function<void(const bv_stream_info&)>;

    /// `found` is called in that thread for every stream at every look, so that one which has changed is noticed.
    Streams(Domain& domain, Found found);
    ~Streams();
    Streams(const Streams&) = delete;
    Streams& operator=(const Streams&) = delete;

    /// Whether a simulator publishes there now.
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
