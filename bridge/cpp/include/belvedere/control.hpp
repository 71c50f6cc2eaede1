// Control of a simulation. SPDX-License-Identifier: MIT OR Apache-2.0
#ifndef BELVEDERE_CONTROL_HPP
#define BELVEDERE_CONTROL_HPP

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include "base.hpp"

namespace belvedere {

/// The error for a command that the simulator refused, with the reason.
class Refused : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// A pose for a model.
struct Place {
    /// Position, metres.
    std::array<double, 3> position{};
    /// Orientation, x y z w.
    std::array<double, 4> orientation{0, 0, 0, 1};
    /// The reference frame: a model, model::link, or empty for the world.
    std::string reference{};
};

/// The answer to a query.
struct SimulationDescription {
    /// Simulated time, ns.
    std::uint64_t time_ns{};
    /// Words, separated by spaces: playing, paused or stepping; replay; robot, actor, static or object; spawned. Later
    /// versions may add others.
    std::string words{};
    /// Returns true if a word is among them.
    bool is(const std::string& word) const { return (" " + words + " ").find(" " + word + " ") != std::string::npos; }
};

/// The control of a simulation. All functions but call() wait for the result for the timeout given to Node::control(),
/// and all but query() return the simulated time in ns at which the command was executed. They throw Refused, and Error with
/// BV_STATUS_NOTHING if no simulator answers in time.
class Control {
public:
    explicit Control(bv_control* handle, std::chrono::milliseconds timeout = std::chrono::seconds(5))
        : handle_(handle), timeout_(timeout) {}

    /// Pauses simulated time.
    std::uint64_t pause() { return done(command(BV_OPERATION_PAUSE)); }
    /// Resumes simulated time.
    std::uint64_t resume() { return done(command(BV_OPERATION_RESUME)); }
    /// Runs physics steps and publishes everything that is due, then pauses.
    std::uint64_t step(std::uint64_t steps = 1) {
        bv_simulation_command step = command(BV_OPERATION_STEP);
        step.steps = steps;
        return done(step);
    }
    /// Returns every model to its initial pose, at rest; time continues.
    std::uint64_t reset_world() { return done(command(BV_OPERATION_RESET_WORLD)); }
    /// Restarts at time 0; the output is the same as after a fresh start.
    std::uint64_t reset() { return done(command(BV_OPERATION_RESET_SIMULATION)); }
    /// Moves a model and stops it.
    std::uint64_t move(const std::string& model, const Place& place) {
        return done(command(BV_OPERATION_SET_MODEL_STATE, model, place));
    }
    /// Adds the model of a text, URDF or SDF, to the world; without a name, under the model's own.
    std::uint64_t spawn(const std::string& text, const std::string& name = {}, const Place& place = {}) {
        return done(command(BV_OPERATION_SPAWN, name, place), text);
    }
    /// Removes a model.
    std::uint64_t remove(const std::string& model) { return done(command(BV_OPERATION_DELETE, model)); }
    /// Changes settings of a sensor, given by its name or by a topic that it publishes, from its next frame on. The
    /// settings are words such as "update_rate=15 exposure=0.5"; either all of them are applied or none.
    std::uint64_t configure(const std::string& sensor, const std::string& settings) {
        return done(command(BV_OPERATION_CONFIGURE, sensor), settings);
    }

    /// Asks what the simulation is doing and, if there is a name, what a model is. Changes nothing.
    SimulationDescription query(const std::string& model = {}) {
        const bv_simulation_result result = answer(command(BV_OPERATION_QUERY, model));
        return {result.time_ns, text_of(result)};
    }

    /// Sends any command, with the text of a model to be spawned or of settings, and waits for its result. Returns
    /// std::nullopt if none arrives in time. A refused command has `done` 0 and a reason. An id of 0 is replaced by a
    /// unique one.
    std::optional<bv_simulation_result> call(const bv_simulation_command& command, std::chrono::milliseconds timeout,
                                             const std::string& text = {}) {
        bv_simulation_result result;
        const auto status = bv_control_call(handle_.get(), &command, text.c_str(), detail::count_of(timeout), &result);
        if (!detail::check(status)) return std::nullopt;
        return result;
    }
    /// Returns true if a simulator is listening now; never sleeps.
    bool is_connected() {
        bool connected = false;
        detail::check(bv_control_is_connected(handle_.get(), &connected));
        return connected;
    }
    /// Returns when the last result was sent, on the clock of a header's publish_mono_ns; 0 before the first. Frames
    /// that were sent later show the effect of the command.
    std::uint64_t answered_ns() const { return bv_control_answered_ns(handle_.get()); }

private:
    static bv_simulation_command command(bv_operation operation, const std::string& name = {}, const Place& place = {}) {
        bv_simulation_command command{};
        command.operation = operation;
        put(command.name, name);
        put(command.reference, place.reference);
        std::copy(place.position.begin(), place.position.end(), command.position);
        std::copy(place.orientation.begin(), place.orientation.end(), command.orientation);
        return command;
    }
    template <std::size_t length>
    static void put(char (&field)[length], const std::string& name) {
        if (name.size() >= length)
            throw Refused("the name '" + name + "' has more than " + std::to_string(length - 1) + " bytes");
        name.copy(field, length);
    }
    static std::string text_of(const bv_simulation_result& result) {
        const char* reason = result.reason;
        return std::string(reason, std::find(reason, reason + sizeof result.reason, '\0'));
    }
    std::uint64_t done(const bv_simulation_command& command, const std::string& text = {}) {
        return answer(command, text).time_ns;
    }
    bv_simulation_result answer(const bv_simulation_command& command, const std::string& text = {}) {
        const auto result = call(command, timeout_, text);
        if (!result)
            throw Error(BV_STATUS_NOTHING,
                        "no simulator answered within " + std::to_string(timeout_.count()) + " ms");
        if (result->done == 0) throw Refused(text_of(*result));
        return *result;
    }

    detail::Owned<bv_control, bv_control_close> handle_;
    std::chrono::milliseconds timeout_;
};

}  // namespace belvedere

#endif
