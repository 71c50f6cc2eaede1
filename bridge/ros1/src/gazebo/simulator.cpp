#include "simulator.hpp"

#include <algorithm>
#include <cstring>

#include "../convert/header.hpp"

namespace belvedere_ros::gazebo {

namespace {

using std::chrono::milliseconds;

// Timeouts of an answer: the simulator may have to render a frame first, or to read a model's meshes.
constexpr milliseconds kPatience{5'000};
constexpr milliseconds kPatienceWithText{20'000};
// The interval of checks that the simulator still exists.
constexpr milliseconds kLook{100};
// The age at which states are outdated: they are sent 50 times per simulated second, and ten times a second while
// paused.
constexpr std::uint64_t kNow_ns = 250'000'000;
// The time for which the streams are kept after their last use.
constexpr std::chrono::seconds kKeep{5};

std::string seconds_of(milliseconds patience) {
    return std::to_string(patience.count() / 1000) + " s";
}

}  // namespace

bool Simulator::is_there() {
    if (!control_) control_ = domain_.control();
    return control_->is_connected();
}

void Simulator::require() {
    if (!is_there())
        throw Refused("there is no simulator in domain " + domain_.name() + "; start one: belvedere run --domain " + domain_.name());
}

void Simulator::command(const bv_simulation_command& command, const std::string& text) {
    used_ = Clock::now();
    require();
    const milliseconds patience = text.empty() ? kPatience : kPatienceWithText;
    const auto result = control_->call(command, patience, text);
    if (!result) {
        require();
        throw Refused("the simulator in domain " + domain_.name() + " has not answered within " + seconds_of(patience) +
                      "; it may still do it");
    }
    answered_ns_ = control_->answered_ns();
    if (result->done == 0) throw Refused(to_text(result->reason));
}

std::uint64_t Simulator::oldest_that_is_now() const {
    const std::uint64_t now_ns = bv_mono_ns();
    return std::max(answered_ns_, now_ns - std::min(now_ns, kNow_ns));
}

void Simulator::follow(Stream& stream, std::uint64_t sent_after_ns, Clock::time_point deadline) {
    if (!stream.subscriber) {
        require();
        stream.subscriber = domain_.subscribe(stream.topic);
    }
    for (Clock::time_point now = Clock::now();; now = Clock::now()) {
        if (const auto frame = stream.subscriber->take_newest()) {
            const belvedere::Header& header = frame->header();
            stream.newest = {header.stamp_ns, header.session, header.publish_mono_ns, frame->structs<bv_model_state>()};
        }
        if (stream.newest.sent_ns > sent_after_ns) return;
        if (now >= deadline)
            throw Refused("the simulator in domain " + domain_.name() + " has sent no states within " + seconds_of(kPatience));
        const auto left = std::chrono::duration_cast<milliseconds>(deadline - now) + milliseconds(1);
        if (!stream.subscriber->wait(std::min(kLook, left))) require();
    }
}

const States& Simulator::models() {
    used_ = Clock::now();
    follow(models_, oldest_that_is_now(), used_ + kPatience);
    return models_.newest;
}

Simulator::Both Simulator::models_and_links() {
    used_ = Clock::now();
    const Clock::time_point deadline = used_ + kPatience;
    const std::uint64_t sent_after_ns = oldest_that_is_now();
    const States &models = models_.newest, &links = links_.newest;
    follow(models_, sent_after_ns, deadline);
    follow(links_, sent_after_ns, deadline);
    // States with the same stamp are sent directly one after the other.
    while (models.stamp_ns != links.stamp_ns) {
        Stream& older = models.sent_ns < links.sent_ns ? models_ : links_;
        follow(older, older.newest.sent_ns, deadline);
    }
    return {models, links};
}

void Simulator::rest() {
    if (Clock::now() - used_ < kKeep) return;
    control_.reset();
    for (Stream* stream : {&models_, &links_}) {
        stream->subscriber.reset();
        stream->newest = {};
    }
}

bv_simulation_command command_of(bv_operation operation) {
    bv_simulation_command command{};
    command.operation = operation;
    command.orientation[3] = 1.0;
    return command;
}

void set_name(char (&field)[64], const std::string& name) {
    if (name.size() >= sizeof field) throw Refused("the name '" + name + "' has more than 63 bytes");
    if (name.find('\0') != std::string::npos) throw Refused("the name '" + name + "' has a zero byte in it");
    std::memset(field, 0, sizeof field);
    std::memcpy(field, name.data(), name.size());
}

}  // namespace belvedere_ros::gazebo
