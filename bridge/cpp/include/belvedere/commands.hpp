// Commands to a robot. SPDX-License-Identifier: MIT OR Apache-2.0
#ifndef BELVEDERE_COMMANDS_HPP
#define BELVEDERE_COMMANDS_HPP

#include <cstdint>

#include "base.hpp"

namespace belvedere {

namespace detail {

/// The stream kind of a command, and its topic on a TurtleBot.
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

/// A publisher of commands to the robot: bv_velocity_command, bv_reset_odometry or bv_motor_power. Several processes
/// may send. The robot receives commands while this object lives: keep it for one or two steps of the simulation after
/// the last command.
template <class Command>
class CommandPublisher {
public:
    explicit CommandPublisher(bv_command_publisher* handle) : handle_(handle) {}
    void send(const Command& command) { detail::check(bv_command_send(handle_.get(), &command, sizeof command)); }

private:
    detail::Owned<bv_command_publisher, bv_command_close> handle_;
};

/// A publisher of velocity commands.
class VelocityPublisher : public CommandPublisher<bv_velocity_command> {
public:
    using CommandPublisher::CommandPublisher;
    using CommandPublisher::send;
    /// Sends a velocity: forward in m/s, turn to the left in rad/s.
    void send(double forward, double turn) { send(bv_velocity_command{{forward, 0, 0}, {0, 0, turn}}); }
};

}  // namespace belvedere

#endif
