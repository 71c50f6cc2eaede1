// Selects which of several sources of commands is active.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace belvedere_ros::turtlebot {

/// A source of commands.
struct Source {
    std::string name;
    std::string topic;
    /// How long it stays active after each command, in seconds.
    double timeout_s = 0;
    /// Sources of higher priority replace those of lower priority.
    int priority = 0;
};

/// A multiplexer with one active source at a time: until it has been silent for its timeout, or a source of higher
/// priority sends.
class Mux {
public:
    explicit Mux(std::vector<Source> sources) : sources_(std::move(sources)) {}

    const std::vector<Source>& sources() const { return sources_; }

    /// Returns true if a command that a source sends now is forwarded. The time is in seconds of any clock; if it runs
    /// backwards, the multiplexer starts anew.
    bool hears(std::size_t source, double now_s) {
        const std::optional<std::size_t> active = this->active(now_s);
        if (active && *active != source && sources_[source].priority <= sources_[*active].priority) return false;
        active_ = source;
        last_s_ = now_s;
        return true;
    }

    /// Returns the active source; none if all are silent.
    std::optional<std::size_t> active(double now_s) {
        if (active_ && (now_s < last_s_ || now_s - last_s_ > sources_[*active_].timeout_s)) active_.reset();
        return active_;
    }

private:
    const std::vector<Source> sources_;
    std::optional<std::size_t> active_;
    double last_s_ = 0;
};

}  // namespace belvedere_ros::turtlebot
