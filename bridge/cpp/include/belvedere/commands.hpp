// Commands to a robot. SPDX-License-Identifier: MIT OR Apache-2.0
#ifndef BELVEDERE_COMMANDS_HPP
#define BELVEDERE_COMMANDS_HPP

#include <cstdint>

#include "base.hpp"

namespace belvedere {

namespace detail {

/// Which streams take a command, and which of them a TurtleBot has.
template <class Command>
struct CommandStream;
template <>
struct CommandStream<bv_velocity_command> {
    static constexpr bv_kind kind = BV_KIND_VELOCITY_COMMAND;
    static constexpr const char* topic = "cmd_vel";
};
template <>
struct CommandStream<bv_reset_odometry> {
    static constexpr bv_kind kind = BV_KIND_RESET_ODOMETRY;
    static constexpr const char* topic = "mobile_base/commands/reset_odometry";
};
template <>
struct CommandStream<bv_motor_power> {
    static constexpr bv_kind kind = BV_KIND_MOTOR_POWER;
    static constexpr const char* topic = "mobile_base/commands/motor_power";
};

}  // namespace detail

/// Sends commands to the robot: bv_velocity_command, bv_reset_odometry or bv_motor_power; several processes may. The
/// robot takes what comes while this lives: leave it a step or two of its simulation after the last.
template <class Command>
class CommandPublisher {
public:
    explicit CommandPublisher(bv_command_publisher* handle) : handle_(handle) {}
    void send(const Command& command) { detail::check(bv_command_send(handle_.get(), &command, sizeof command)); }

private:
    detail::Owned<bv_command_publisher, bv_command_close> handle_;
};

/// Sends velocities.
class VelocityPublisher : public CommandPublisher<bv_velocity_command> {
public:
    using CommandPublisher::CommandPublisher;
    using CommandPublisher::send;
    /// Forward in m/s, turn to the left in rad/s.
    void send(double forward, double turn) { send(bv_velocity_command{{forward, 0, 0}, {0, 0, turn}}); }
};

}  // namespace belvedere

#endif
