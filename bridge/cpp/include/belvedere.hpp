// Belvedere's frames in shared memory, for C++17. SPDX-License-Identifier: MIT OR Apache-2.0
//
//   belvedere::Node node("default", "me");
//   belvedere::Subscriber camera = node.subscribe("camera/rgb/image_raw");
//   while (camera.wait(std::chrono::seconds(1)))
//       while (std::optional<belvedere::Frame> frame = camera.take())
//           process(frame->row<std::uint8_t>(0));  // the simulator's own memory, not a copy
//
// Every object owns its handle and can be moved, also to another thread; only one thread at a time may use it. Failures
// are reported as belvedere::Error with the message of bv_last_error().
//
// belvedere/opencv.hpp, belvedere/eigen.hpp and belvedere/pcl.hpp give access to frames as the types of these
// libraries.
#ifndef BELVEDERE_HPP
#define BELVEDERE_HPP

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "belvedere/base.hpp"
#include "belvedere/commands.hpp"
#include "belvedere/control.hpp"
#include "belvedere/frames.hpp"
#include "belvedere/wire.hpp"

namespace belvedere {

/// Membership of a domain. Objects made from it outlive it.
class Node {
public:
    /// Joins a domain; by default that of the environment variable BELVEDERE_DOMAIN, or "default".
    explicit Node(const std::string& domain = {}, const std::string& name = "belvedere-cpp") {
        bv_node* node = nullptr;
        detail::check(bv_node_open(domain.empty() ? nullptr : domain.c_str(), name.c_str(), &node));
        handle_.reset(node);
    }
    /// Subscribes to a stream, which may be created later.
    Subscriber subscribe(const std::string& topic) {
        bv_subscriber* subscriber = nullptr;
        detail::check(bv_subscribe(handle_.get(), topic.c_str(), &subscriber));
        return Subscriber(subscriber);
    }
    /// Subscribes to several streams at once. The stamps of a set differ by at most the tolerance: zero for frames
    /// captured at the same time, more for sensors of different rates.
    template <class... Topics>
    Synchronizer<sizeof...(Topics)> synchronize(std::chrono::nanoseconds tolerance, const Topics&... topics) {
        const std::array<std::string, sizeof...(Topics)> names{std::string(topics)...};
        std::array<const char*, sizeof...(Topics)> texts{};
        for (std::size_t i = 0; i < names.size(); ++i) texts[i] = names[i].c_str();
        const auto tolerance_ns = static_cast<std::uint64_t>(tolerance.count() < 0 ? 0 : tolerance.count());
        bv_synchronizer* synchronizer = nullptr;
        detail::check(bv_synchronizer_open(handle_.get(), texts.data(), texts.size(), tolerance_ns, &synchronizer));
        return Synchronizer<sizeof...(Topics)>(synchronizer);
    }
    /// Opens a stream of commands to the robot, by default under the topic of a TurtleBot.
    template <class Command>
    CommandPublisher<Command> commands(const std::string& topic = detail::CommandStream<Command>::topic) {
        return CommandPublisher<Command>(open_commands<Command>(topic));
    }
    VelocityPublisher velocity(const std::string& topic = detail::CommandStream<bv_velocity_command>::topic) {
        return VelocityPublisher(open_commands<bv_velocity_command>(topic));
    }
    /// Opens the control of the domain's simulation, which may start later. The timeout applies to each call.
    Control control(std::chrono::milliseconds timeout = std::chrono::seconds(5)) {
        bv_control* control = nullptr;
        detail::check(bv_control_open(handle_.get(), &control));
        return Control(control, timeout);
    }
    /// Returns the streams of the domain, by topic.
    std::vector<bv_stream_info> streams() {
        bv_stream_info* streams = nullptr;
        std::size_t count = 0;
        detail::check(bv_streams(handle_.get(), &streams, &count));
        std::vector<bv_stream_info> copy(streams, streams + count);
        bv_streams_free(streams, count);
        return copy;
    }

private:
    template <class Command>
    bv_command_publisher* open_commands(const std::string& topic) {
        bv_command_publisher* publisher = nullptr;
        detail::check(bv_command_open(handle_.get(), topic.c_str(), detail::CommandStream<Command>::kind, &publisher));
        return publisher;
    }

    detail::Owned<bv_node, bv_node_close> handle_;
};

}  // namespace belvedere

#endif  // BELVEDERE_HPP
