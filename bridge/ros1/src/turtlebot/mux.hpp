// Which of several sources of commands is heard.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace belvedere_ros::turtlebot {

/// One that sends commands.
struct Source {
    std::string name;
    std::string topic;
    /// How long it is heard after each command, in seconds.
    double timeout_s = 0;
    /// The higher ones are heard before the lower ones.
    int priority = 0;
};

/// Hears one source at a time: until it has been silent for its timeout, or one of higher priority speaks.
class Mux {
public:
    explicit Mux(std::vector<Source> sources) : sources_(std::move(sources)) {}

    const std::vector<Source>& sources() const { return sources_; }

    /// Whether a command goes on which a source sends now, in seconds of any clock. One that runs backwards begins anew.
    bool hears(std::size_t source, double now_s) {
        const std::optional<std::size_t> active = this->active(now_s);
        if (active && *active != source && sources_[source].priority <= sources_[*active].priority) return false;
        active_ = source;
        last_s_ = now_s;
        return true;
    }

    /// The one that is heard; none when all are silent.
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
