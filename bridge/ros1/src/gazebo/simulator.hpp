// The simulator as services see it: it does what it is told, and says where everything is.
#pragma once

#include <belvedere.hpp>

#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>

#include "../domain.hpp"
#include "states.hpp"

namespace belvedere_ros::gazebo {

/// What could not be done, and why, in words for who asked.
class Refused : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Commands, and the states of models and links. Everything throws Refused: also when there is no simulator, which is
/// said at once, and when it does not answer in time. One thread may use it.
class Simulator {
public:
    explicit Simulator(Domain& domain) : domain_(domain) {}

    /// Has it do something.
    void command(const bv_simulation_command& command, const std::string& text = {});

    /// Where all models are, now and after all commands before.
    const States& models();

    struct Both {
        const States& models;
        const States& links;
    };
    /// Models and links at one and the same moment.
    Both models_and_links();

    /// Lets go of the streams if they have not been used for a while: what is followed is made.
    void rest();

private:
    using Clock = std::chrono::steady_clock;

    // A stream of states, followed from its first use on.
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
    // When the last command was answered; in the past of all that is sent later.
    std::uint64_t answered_ns_ = 0;
    Clock::time_point used_{};
};

/// A command, its fields zero.
bv_simulation_command command_of(bv_operation operation);

/// Fills in a name; Refused when it is too long.
void set_name(char (&field)[64], const std::string& name);

}  // namespace belvedere_ros::gazebo
