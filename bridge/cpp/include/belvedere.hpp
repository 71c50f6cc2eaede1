// Belvedere's frames in shared memory, for C++17. SPDX-License-Identifier: MIT OR Apache-2.0
//
//   belvedere::Node node("default", "me");
//   belvedere::Subscriber camera = node.subscribe("camera/rgb/image_raw");
//   while (camera.wait(std::chrono::seconds(1)))
//       while (std::optional<belvedere::Frame> frame = camera.take())
//           look_at(frame->row<std::uint8_t>(0));  // where the simulator wrote it
//
// Every object owns its handle and may be moved, also to another thread; one thread at a time may use it. Failures
// are belvedere::Error with the words of bv_last_error().
//
// belvedere/opencv.hpp, belvedere/eigen.hpp and belvedere/pcl.hpp show frames as the types of these libraries.
#ifndef BELVEDERE_HPP
#define BELVEDERE_HPP

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "belvedere.h"
#include "belvedere/wire.hpp"

namespace belvedere {

using Header = bv_frame_header;

class Error : public std::runtime_error {
public:
    explicit Error(bv_status status) : Error(status, bv_last_error()) {}
    Error(bv_status status, const std::string& text) : std::runtime_error(text), status_(status) {}
    bv_status status() const noexcept { return status_; }

private:
    bv_status status_;
};

namespace detail {

/// Throws for an error; otherwise whether there was something.
inline bool check(bv_status status) {
    if (static_cast<int>(status) < 0) throw Error(status);
    return status == BV_STATUS_OK;
}

/// As the C interface takes it: not negative, 24 days at most.
inline std::uint32_t milliseconds(std::chrono::milliseconds timeout) {
    const auto ms = timeout.count() < 0 ? 0 : timeout.count() > 0x7fffffff ? 0x7fffffff : timeout.count();
    return static_cast<std::uint32_t>(ms);
}

template <class Handle, void (*close)(Handle*)>
struct Closer {
    void operator()(Handle* handle) const noexcept { close(handle); }
};

template <class Handle, void (*close)(Handle*)>
using Owned = std::unique_ptr<Handle, Closer<Handle, close>>;

}  // namespace detail

/// Consecutive values that somebody else owns.
template <class T>
class Span {
public:
    Span() = default;
    Span(T* data, std::size_t size) : data_(data), size_(size) {}
    T* data() const noexcept { return data_; }
    std::size_t size() const noexcept { return size_; }
    bool empty() const noexcept { return size_ == 0; }
    T* begin() const noexcept { return data_; }
    T* end() const noexcept { return data_ + size_; }
    T& operator[](std::size_t index) const { return data_[index]; }

private:
    T* data_ = nullptr;
    std::size_t size_ = 0;
};

/// A received frame where it lies in shared memory; unchanged and valid as long as this lives.
class Frame {
public:
    explicit Frame(bv_frame* handle) : handle_(handle) {}

    const Header& header() const { return *bv_frame_get_header(handle_.get()); }
    bv_kind kind() const { return static_cast<bv_kind>(header().kind); }
    bv_encoding encoding() const { return static_cast<bv_encoding>(header().encoding); }

    /// The frame that the data are given in.
    std::string frame_id() const {
        const char* id = header().frame_id;
        return std::string(id, std::find(id, id + sizeof header().frame_id, '\0'));
    }
    /// How pixels map to directions. Throws std::invalid_argument for a kind that has none.
    const bv_intrinsics& intrinsics() const {
        if (kind() != BV_KIND_IMAGE && kind() != BV_KIND_DEPTH_IMAGE && kind() != BV_KIND_POINT_CLOUD)
            throw std::invalid_argument("a frame of this kind has no intrinsics");
        return header().block.intrinsics;
    }

    /// All bytes, aligned to 64.
    Span<const std::uint8_t> payload() const {
        return {bv_frame_get_payload(handle_.get()), static_cast<std::size_t>(header().payload_len)};
    }

    /// One row as values of T: bytes or pixels of an image, float of depth and ranges.
    /// Throws std::out_of_range for a row that is not there or a T that does not fit.
    template <class T>
    Span<const T> row(std::uint32_t y) const {
        return plane_row<T>(0, y);
    }

    /// One row of intensities behind the ranges.
    template <class T = float>
    Span<const T> intensity_row(std::uint32_t y) const {
        const Header& h = header();
        if ((h.flags & BV_HAS_INTENSITIES) == 0) throw std::out_of_range("the scan has no intensities");
        return plane_row<T>(static_cast<std::size_t>(h.height) * h.row_stride, y);
    }

    /// The structs of a stream of fixed messages, such as bv_transform, copied out.
    template <class T>
    std::vector<T> structs() const {
        static_assert(std::is_trivially_copyable<T>::value, "T must be one of the structs of belvedere.h");
        const Header& h = header();
        // The stride of rows is that of structs, so that no height makes more of them than the payload has.
        if (h.encoding != BV_ENCODING_STRUCT || h.elem_stride < sizeof(T) || (h.height > 1 && h.row_stride < sizeof(T)))
            throw std::out_of_range("the frame does not hold structs of this size");
        std::vector<T> values(h.width == 0 ? 0 : h.height);
        const Span<const std::uint8_t> bytes = payload();
        for (std::size_t i = 0; i < values.size(); ++i) {
            const std::size_t offset = i * h.row_stride;
            if (offset + sizeof(T) > bytes.size()) throw std::out_of_range("the frame is too short for this struct");
            std::memcpy(&values[i], bytes.data() + offset, sizeof(T));
        }
        return values;
    }

    /// Frames that were sent between the last one taken and this one.
    std::uint64_t missed() const { return bv_frame_missed(handle_.get()); }
    /// Whether the simulator was started again since the frame before.
    bool restarted() const { return bv_frame_restarted(handle_.get()); }
    /// Whether it was sent before the subscriber was connected: its age says nothing then.
    bool is_from_history() const { return bv_frame_is_from_history(handle_.get()); }
    /// Time since it was sent.
    std::chrono::nanoseconds age() const {
        return std::chrono::nanoseconds(static_cast<std::int64_t>(bv_frame_age_ns(handle_.get())));
    }

private:
    template <class T>
    Span<const T> plane_row(std::size_t plane, std::uint32_t y) const {
        static_assert(std::is_trivially_copyable<T>::value, "T must be a plain value");
        const Header& h = header();
        const std::size_t bytes = static_cast<std::size_t>(h.width) * h.elem_stride;
        const std::size_t offset = plane + static_cast<std::size_t>(y) * h.row_stride;
        if (y >= h.height || offset % alignof(T) != 0 || bytes % sizeof(T) != 0 ||
            offset + bytes > payload().size())
            throw std::out_of_range("no such row in the frame");
        return {reinterpret_cast<const T*>(payload().data() + offset), bytes / sizeof(T)};
    }

    detail::Owned<bv_frame, bv_frame_release> handle_;
};

/// The reading end of a stream: there before its publisher, and after. Goes on by itself when the publisher ends, or
/// is killed, and starts again.
class Subscriber {
public:
    explicit Subscriber(bv_subscriber* handle) : handle_(handle) {}

    /// Sleeps until there is a frame; false when the time has passed, or a signal came, without one.
    bool wait(std::chrono::milliseconds timeout) {
        return detail::check(bv_subscriber_wait(handle_.get(), detail::milliseconds(timeout)));
    }
    /// The oldest frame that waits, if any; never sleeps. Two may be held at a time.
    std::optional<Frame> take() { return take_with(bv_subscriber_take); }
    /// The newest frame that waits, if any, dropping those before it; never sleeps.
    std::optional<Frame> take_newest() { return take_with(bv_subscriber_take_newest); }

    /// A descriptor for the poll, select or epoll of another event loop: the same over the subscriber's whole life.
    /// It is readable when frames may wait or it is time to look for the publisher: take() then until there is none.
    /// Do not read from it, nor close it.
    int fd() {
        int fd = -1;
        detail::check(bv_subscriber_fd(handle_.get(), &fd));
        return fd;
    }

    std::uint64_t missed_total() const { return bv_subscriber_missed_total(handle_.get()); }
    std::size_t publishers() const { return bv_subscriber_publishers(handle_.get()); }
    /// Time since the last frame: the sign that a stream has stopped.
    std::chrono::nanoseconds silence() const {
        return std::chrono::nanoseconds(static_cast<std::int64_t>(bv_subscriber_silence_ns(handle_.get())));
    }

private:
    std::optional<Frame> take_with(bv_status (*take)(bv_subscriber*, bv_frame**)) {
        bv_frame* frame = nullptr;
        if (!detail::check(take(handle_.get(), &frame))) return std::nullopt;
        return Frame(frame);
    }

    detail::Owned<bv_subscriber, bv_subscriber_close> handle_;
};

/// Gives the frames of N streams that were taken at the same time: a picture with its depth and its camera_info.
/// Each frame is in one set at most, sets come in order, and a frame that can find no partner any more is skipped. One
/// set may be kept while the next is waited for.
template <std::size_t N>
class Synchronizer {
    static_assert(N >= 2 && N <= BV_SYNCHRONIZER_MAX, "a set is of 2 to 8 streams");

public:
    explicit Synchronizer(bv_synchronizer* handle) : handle_(handle) {}

    /// Sleeps until there is a set; false when the time has passed, or a signal came, without one.
    bool wait(std::chrono::milliseconds timeout) {
        return detail::check(bv_synchronizer_wait(handle_.get(), detail::milliseconds(timeout)));
    }
    /// The next set, in the order of the topics, if it is complete; never sleeps.
    std::optional<std::array<Frame, N>> take() {
        bv_frame* frames[N];
        if (!detail::check(bv_synchronizer_take(handle_.get(), frames))) return std::nullopt;
        return set(frames, std::make_index_sequence<N>());
    }

    /// Frames that were taken and found no partner.
    std::uint64_t skipped() const { return bv_synchronizer_skipped(handle_.get()); }
    /// Frames that were sent and never taken, over all streams.
    std::uint64_t missed_total() const { return bv_synchronizer_missed_total(handle_.get()); }

private:
    template <std::size_t... I>
    static std::array<Frame, N> set(bv_frame* const (&frames)[N], std::index_sequence<I...>) {
        return {Frame(frames[I])...};
    }

    detail::Owned<bv_synchronizer, bv_synchronizer_close> handle_;
};

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

/// A command that the simulator did not follow; its text says why.
class Refused : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Where a model is to be.
struct Place {
    /// Metres.
    std::array<double, 3> position{};
    /// x y z w.
    std::array<double, 4> orientation{0, 0, 0, 1};
    /// The frame that they are given in: a model, model::link, or nothing for the world.
    std::string reference{};
};

/// Controls a simulation. All but call() wait for the answer as long as was said to Node::control(), and give the
/// simulated time in ns at which it was done. They throw Refused, and Error with BV_STATUS_NOTHING when no simulator
/// answers in time.
class Control {
public:
    explicit Control(bv_control* handle, std::chrono::milliseconds timeout = std::chrono::seconds(5))
        : handle_(handle), timeout_(timeout) {}

    /// Lets simulated time stand.
    std::uint64_t pause() { return done(command(BV_OPERATION_PAUSE)); }
    /// Lets it go on.
    std::uint64_t resume() { return done(command(BV_OPERATION_RESUME)); }
    /// Runs some steps of physics with all that is published on the way, then pauses.
    std::uint64_t step(std::uint64_t steps = 1) {
        bv_simulation_command step = command(BV_OPERATION_STEP);
        step.steps = steps;
        return done(step);
    }
    /// Puts every model back to where it was at the start, at rest; time goes on.
    std::uint64_t reset_world() { return done(command(BV_OPERATION_RESET_WORLD)); }
    /// Begins again at time 0: what follows are the bytes of a fresh start.
    std::uint64_t reset() { return done(command(BV_OPERATION_RESET_SIMULATION)); }
    /// Moves a model, which is at rest then.
    std::uint64_t move(const std::string& model, const Place& place) {
        return done(command(BV_OPERATION_SET_MODEL_STATE, model, place));
    }
    /// Puts the model of a text, URDF or SDF, into the world; without a name, under its own.
    std::uint64_t spawn(const std::string& text, const std::string& name = {}, const Place& place = {}) {
        return done(command(BV_OPERATION_SPAWN, name, place), text);
    }
    /// Takes a model out.
    std::uint64_t remove(const std::string& model) { return done(command(BV_OPERATION_DELETE, model)); }
    /// Changes settings of a sensor, named or told by a topic that it sends, from its next frame on: words such as
    /// "update_rate=15 exposure=0.5", all of them or none.
    std::uint64_t configure(const std::string& sensor, const std::string& settings) {
        return done(command(BV_OPERATION_CONFIGURE, sensor), settings);
    }

    /// Sends any command, with the text of a model to be spawned or of settings, and waits for its result: none in time,
    /// none at all. One that was refused has `done` 0 and a reason. An id of 0 is replaced by one that no other has.
    std::optional<bv_simulation_result> call(const bv_simulation_command& command, std::chrono::milliseconds timeout,
                                             const std::string& text = {}) {
        bv_simulation_result result;
        const auto status = bv_control_call(handle_.get(), &command, text.c_str(), detail::milliseconds(timeout), &result);
        if (!detail::check(status)) return std::nullopt;
        return result;
    }
    /// Whether there is a simulator that listens now; never sleeps.
    bool is_connected() {
        bool connected = false;
        detail::check(bv_control_is_connected(handle_.get(), &connected));
        return connected;
    }
    /// When the last result was sent, on the clock of a header's publish_mono_ns; 0 before the first. What was sent later
    /// shows what the command has changed.
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
    std::uint64_t done(const bv_simulation_command& command, const std::string& text = {}) {
        const auto result = call(command, timeout_, text);
        if (!result)
            throw Error(BV_STATUS_NOTHING,
                        "no simulator answered; the most to wait was " + std::to_string(timeout_.count()) + " ms");
        const char* reason = result->reason;
        if (result->done == 0) throw Refused(std::string(reason, std::find(reason, reason + sizeof result->reason, '\0')));
        return result->time_ns;
    }

    detail::Owned<bv_control, bv_control_close> handle_;
    std::chrono::milliseconds timeout_;
};

/// Membership of a domain; what was made from it outlives it.
class Node {
public:
    /// Without a domain it is that of the environment variable BELVEDERE_DOMAIN, else "default".
    explicit Node(const std::string& domain = {}, const std::string& name = "belvedere-cpp") {
        bv_node* node = nullptr;
        detail::check(bv_node_open(domain.empty() ? nullptr : domain.c_str(), name.c_str(), &node));
        handle_.reset(node);
    }
    /// Follows a stream, whether it exists already or not.
    Subscriber subscribe(const std::string& topic) {
        bv_subscriber* subscriber = nullptr;
        detail::check(bv_subscribe(handle_.get(), topic.c_str(), &subscriber));
        return Subscriber(subscriber);
    }
    /// Follows several streams at once. Stamps of a set differ by at most the tolerance: none for what is captured at
    /// one moment, more for sensors of different rates.
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
    /// Commands to the robot of a kind, under the name that a TurtleBot has for them, or another.
    template <class Command>
    CommandPublisher<Command> commands(const std::string& topic = detail::CommandStream<Command>::topic) {
        return CommandPublisher<Command>(open_commands<Command>(topic));
    }
    VelocityPublisher velocity(const std::string& topic = detail::CommandStream<bv_velocity_command>::topic) {
        return VelocityPublisher(open_commands<bv_velocity_command>(topic));
    }
    /// Controls the simulation of the domain, whether it runs already or not. The timeout is that of each answer.
    Control control(std::chrono::milliseconds timeout = std::chrono::seconds(5)) {
        bv_control* control = nullptr;
        detail::check(bv_control_open(handle_.get(), &control));
        return Control(control, timeout);
    }
    /// What is published in the domain, by topic.
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
