// Errors, handles and spans. SPDX-License-Identifier: MIT OR Apache-2.0
#ifndef BELVEDERE_BASE_HPP
#define BELVEDERE_BASE_HPP

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "belvedere.h"

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

/// Throws on an error; otherwise returns true unless nothing was available.
inline bool check(bv_status status) {
    if (static_cast<int>(status) < 0) throw Error(status);
    return status == BV_STATUS_OK;
}

/// Converts a time for the C interface, clamped to 0 to 2^31 - 1.
template <class Duration>
std::uint32_t count_of(Duration time) {
    return static_cast<std::uint32_t>(time.count() < 0 ? 0 : time.count() > 0x7fffffff ? 0x7fffffff : time.count());
}

template <class Handle, void (*close)(Handle*)>
struct Closer {
    void operator()(Handle* handle) const noexcept { close(handle); }
};

template <class Handle, void (*close)(Handle*)>
using Owned = std::unique_ptr<Handle, Closer<Handle, close>>;

}  // namespace detail

/// A view of consecutive values, which it does not own.
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

}  // namespace belvedere

#endif
