// Frames, subscribers and synchronisers. SPDX-License-Identifier: MIT OR Apache-2.0
#ifndef BELVEDERE_FRAMES_HPP
#define BELVEDERE_FRAMES_HPP

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base.hpp"
#include "wire.hpp"

namespace belvedere {

/// A received frame in shared memory, unchanged and valid as long as this object lives.
class Frame {
public:
    explicit Frame(bv_frame* handle) : handle_(handle) {}

    // Views are deleted for temporaries: the frame would be released at the end of the statement.
    const Header& header() const& { return *bv_frame_get_header(handle_.get()); }
    const Header& header() const&& = delete;
    bv_kind kind() const { return static_cast<bv_kind>(header().kind); }
    bv_encoding encoding() const { return static_cast<bv_encoding>(header().encoding); }

    /// Returns the coordinate frame of the data.
    std::string frame_id() const {
        const char* id = header().frame_id;
        return std::string(id, std::find(id, id + sizeof header().frame_id, '\0'));
    }
    /// Returns the mapping from pixels to directions. Throws std::invalid_argument for a kind without intrinsics.
    const bv_intrinsics& intrinsics() const&& = delete;
    const bv_intrinsics& intrinsics() const& {
        if (kind() != BV_KIND_IMAGE && kind() != BV_KIND_DEPTH_IMAGE && kind() != BV_KIND_POINT_CLOUD)
            throw std::invalid_argument("a frame of this kind has no intrinsics");
        return header().block.intrinsics;
    }
    /// Returns the distortion model of the lens; 0 for none. Throws std::invalid_argument for a kind without
    /// intrinsics.
    bv_distortion_model distortion_model() const {
        return static_cast<bv_distortion_model>(intrinsics().distortion_model);
    }
    /// Returns the parameters of the distortion model.
    Span<const double> distortion() const&& = delete;
    Span<const double> distortion() const& {
        const bv_intrinsics& lens = intrinsics();
        return {lens.distortion, std::min<std::size_t>(lens.distortion_len, std::size(lens.distortion))};
    }

    /// Returns all bytes of the payload, aligned to 64.
    Span<const std::uint8_t> payload() const&& = delete;
    Span<const std::uint8_t> payload() const& {
        return {bv_frame_get_payload(handle_.get()), static_cast<std::size_t>(header().payload_len)};
    }

    /// Returns one row as values of T: bytes or pixels of an image, float for depth and ranges.
    /// Throws std::out_of_range if the row does not exist or T does not fit.
    template <class T>
    Span<const T> row(std::uint32_t) const&& = delete;
    template <class T>
    Span<const T> row(std::uint32_t y) const& {
        return plane_row<T>(0, y);
    }

    /// Returns one row of the intensities that follow the ranges.
    template <class T = float>
    Span<const T> intensity_row(std::uint32_t) const&& = delete;
    template <class T = float>
    Span<const T> intensity_row(std::uint32_t y) const& {
        const Header& h = header();
        if ((h.flags & BV_HAS_INTENSITIES) == 0) throw std::out_of_range("the scan has no intensities");
        return plane_row<T>(static_cast<std::size_t>(h.height) * h.row_stride, y);
    }

    /// Returns copies of the structs of a stream of fixed messages, such as bv_transform.
    /// Throws std::out_of_range if the frame holds other structs.
    template <class T>
    std::vector<T> structs() const {
        static_assert(std::is_trivially_copyable<T>::value, "T must be one of the structs of belvedere.h");
        const Header& h = header();
        // Requiring a row stride of at least one struct bounds the number of structs by the size of the payload.
        if (!detail::carries<T>(h.kind)) throw std::out_of_range("the frame is of a kind that does not hold these structs");
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

    /// Returns the number of frames that were sent between the previously taken frame and this one.
    std::uint64_t missed() const { return bv_frame_missed(handle_.get()); }
    /// Returns true if the simulator was restarted since the previous frame.
    bool restarted() const { return bv_frame_restarted(handle_.get()); }
    /// Returns true if the frame was sent before the subscriber connected: its age then does not show the latency.
    bool is_from_history() const { return bv_frame_is_from_history(handle_.get()); }
    /// Returns the time since the frame was sent.
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

/// The result of a take: a std::optional that must be named before its content is used. `camera.take()->header()` does
/// not compile, since it would be read after the frame is released, and would dereference an empty optional if there
/// was no frame.
template <class T>
class Taken : public std::optional<T> {
public:
    using std::optional<T>::optional;
    const T* operator->() const& { return std::optional<T>::operator->(); }
    T* operator->() & { return std::optional<T>::operator->(); }
    const T* operator->() const&& = delete;
};

/// The reading end of a stream. It may exist before its publisher and after it. If the publisher ends or is killed, and
/// starts again, the subscriber continues with the new one.
class Subscriber {
public:
    explicit Subscriber(bv_subscriber* handle) : handle_(handle) {}

    /// Sleeps until a frame is available; returns false if the timeout passes, or a signal arrives, without one.
    bool wait(std::chrono::milliseconds timeout) {
        return detail::check(bv_subscriber_wait(handle_.get(), detail::count_of(timeout)));
    }
    /// Enables busy polling: frames that are due are polled for without sleeping, for at most `limit` each, which
    /// reduces their latency to microseconds at the cost of processor time; see bv_subscriber_set_busy_poll(). Zero,
    /// the default, disables it.
    void set_busy_poll(std::chrono::microseconds limit) {
        detail::check(bv_subscriber_set_busy_poll(handle_.get(), detail::count_of(limit)));
    }
    /// Returns the oldest queued frame, if any; never sleeps. Two frames may be held at a time.
    Taken<Frame> take() { return take_with(bv_subscriber_take); }
    /// Returns the newest queued frame, if any, and drops older ones; never sleeps.
    Taken<Frame> take_newest() { return take_with(bv_subscriber_take_newest); }

    /// Returns a descriptor for the poll, select or epoll of another event loop, the same over the subscriber's whole
    /// life. It is readable if frames may be queued or the publisher must be checked: then call take() until it returns
    /// none. Do not read from it or close it.
    int fd() {
        int fd = -1;
        detail::check(bv_subscriber_fd(handle_.get(), &fd));
        return fd;
    }

    std::uint64_t missed_total() const { return bv_subscriber_missed_total(handle_.get()); }
    std::size_t publishers() const { return bv_subscriber_publishers(handle_.get()); }
    /// Returns the time since the last frame: a long silence is the only reliable sign that a stream has stopped.
    std::chrono::nanoseconds silence() const {
        return std::chrono::nanoseconds(static_cast<std::int64_t>(bv_subscriber_silence_ns(handle_.get())));
    }

private:
    Taken<Frame> take_with(bv_status (*take)(bv_subscriber*, bv_frame**)) {
        bv_frame* frame = nullptr;
        if (!detail::check(take(handle_.get(), &frame))) return std::nullopt;
        return Frame(frame);
    }

    detail::Owned<bv_subscriber, bv_subscriber_close> handle_;
};

/// A synchroniser, which returns frames of N streams that were captured at the same time: an image with its depth image
/// and its camera_info. Each frame is in at most one set, sets come in order, and a frame that cannot find a partner
/// any more is skipped. One set may be kept while the next is awaited.
template <std::size_t N>
class Synchronizer {
    static_assert(N >= 2 && N <= BV_SYNCHRONIZER_MAX, "a set has 2 to 8 streams");

public:
    explicit Synchronizer(bv_synchronizer* handle) : handle_(handle) {}

    /// Sleeps until a set is available; returns false if the timeout passes, or a signal arrives, without one.
    bool wait(std::chrono::milliseconds timeout) {
        return detail::check(bv_synchronizer_wait(handle_.get(), detail::count_of(timeout)));
    }
    /// Returns the next set, in the order of the topics, if it is complete; never sleeps.
    Taken<std::array<Frame, N>> take() {
        bv_frame* frames[N];
        if (!detail::check(bv_synchronizer_take(handle_.get(), frames))) return std::nullopt;
        return set(frames, std::make_index_sequence<N>());
    }

    /// Returns the number of frames that were taken and found no partner.
    std::uint64_t skipped() const { return bv_synchronizer_skipped(handle_.get()); }
    /// Returns the number of frames that were sent and never taken, over all streams.
    std::uint64_t missed_total() const { return bv_synchronizer_missed_total(handle_.get()); }

private:
    template <std::size_t... I>
    static std::array<Frame, N> set(bv_frame* const (&frames)[N], std::index_sequence<I...>) {
        return {Frame(frames[I])...};
    }

    detail::Owned<bv_synchronizer, bv_synchronizer_close> handle_;
};

}  // namespace belvedere

#endif
