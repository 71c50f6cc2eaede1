// The simulator as seen by the services: it executes commands and reports states.
#pragma once

#include <belvedere.hpp>

#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>

#include "../domain.hpp"
#include "states.hpp"

namespace belvedere_ros::gazebo {

/// The error of a request, with a reason for the caller.
class Refused : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Commands, and the states of models and links. Everything throws Refused: immediately if there is no simulator, and
/// on a timeout. Only one thread may use it.
class Simulator {
public:
    explicit Simulator(Domain& domain) : domain_(domain) {}

    /// Sends a command and waits for its success.
    void command(const bv_simulation_command& command, const std::string& text = {});

    /// Returns the states of all models, now and after all previous commands.
    const States& models();

    struct Both {
        const States& models;
        const States& links;
    };
    /// Returns models and links with the same stamp.
    Both models_and_links();

    /// Unsubscribes if the streams have not been used for a while, since streams without subscribers are not computed.
    void rest();

private:
    using Clock = std::chrono::steady_clock;

    // A stream of states, subscribed from its first use on.
    struct Stream {
        const char* topic;
        std::optional<belvedere::Subscriber> subscriber = std::nullopt;
        States newest = {};
    };

    bool is_there();
    void require();
    std::uint64_t oldest_that_is_now() const;
    void follow(Stream& stream, std::uint64_t sent_after_ns, Clock::time_point deadline);

    Domain& domain_;
    std::optional<belvedere::Control> control_;
    Stream models_{"simulation/model_states"}, links_{"simulation/link_states"};
    // Time of the last command's answer; everything sent later includes its effect.
    std::uint64_t answered_ns_ = 0;
    Clock::time_point used_{};
};

/// Returns a command with zero fields.
bv_simulation_command command_of(bv_operation operation);

/// Writes a name; throws Refused if it is too long.
void set_name(char (&field)[64], const std::string& name);

}  // namespace belvedere_ros::gazebo
