#include "streams.hpp"

#include <ros/console.h>

#include <algorithm>
#include <exception>
#include <utility>
#include <vector>

namespace belvedere_ros {

namespace {

// The interval at which the domain is listed.
constexpr std::chrono::milliseconds kPeriod{500};

/// Returns true for streams whose publishers are consumers of the simulator.
bool is_command(std::uint16_t kind) {
    switch (kind) {
        case BV_KIND_VELOCITY_COMMAND:
        case BV_KIND_RESET_ODOMETRY:
        case BV_KIND_MOTOR_POWER:
        case BV_KIND_SIMULATION_COMMAND: return true;
        default: return false;
    }
}

}  // namespace

Streams::Streams(Domain& domain, Found found)
    : domain_(domain), found_(std::move(found)), thread_([this] { run(); }) {}

Streams::~Streams() {
    stopping_ = true;
    bell_.ring();
    thread_.join();
}

void Streams::run() {
    while (!stopping_) {
        try {
            look();
        } catch (const std::exception& error) {
            if (trouble_.due()) ROS_WARN_STREAM("cannot list the streams of domain " << domain_.name() << ": " << error.what());
        }
        bell_.sleep(kPeriod);
    }
}

void Streams::look() {
    const std::vector<bv_stream_info> streams = domain_.streams();
    const bool there = std::any_of(streams.begin(), streams.end(), [](const auto& stream) {
        return stream.publishers > 0 && !is_command(stream.kind);
    });
    if (there != simulator_is_there_.exchange(there))
        ROS_INFO_STREAM((there ? "found a simulator in domain " : "the simulator has gone from domain ") << domain_.name());
    if (!there && waiting_.due())
        ROS_WARN_STREAM("waiting for a simulator in domain " << domain_.name() << " (belvedere run --domain " << domain_.name() << ')');
    for (const bv_stream_info& stream : streams) found_(stream);
}

}  // namespace belvedere_ros
