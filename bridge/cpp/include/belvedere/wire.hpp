// The structs of Belvedere's frames: their sizes, and the kinds of streams that carry them.
// SPDX-License-Identifier: MIT OR Apache-2.0
#ifndef BELVEDERE_WIRE_HPP
#define BELVEDERE_WIRE_HPP

#include <cstdint>
#include <type_traits>

#include "belvedere.h"

// Compiler flags can change layouts. No struct has padding, so that one of the right size has the right offsets.
#define BELVEDERE_HAS_SIZE(type, size) \
    static_assert(sizeof(type) == (size), #type " is not as the wire format has it");
BV_STRUCTS(BELVEDERE_HAS_SIZE)
#undef BELVEDERE_HAS_SIZE

namespace belvedere {
namespace detail {

/// Returns true if streams of this kind carry Ts.
template <class T>
constexpr bool carries(std::uint16_t kind) {
#define BELVEDERE_IS(type, of_kind) || std::is_same<T, type>::value
    static_assert(false BV_PAYLOADS(BELVEDERE_IS), "no stream carries structs of this type");
#undef BELVEDERE_IS
#define BELVEDERE_CARRIES(type, of_kind) || (std::is_same<T, type>::value && kind == (of_kind))
    return false BV_PAYLOADS(BELVEDERE_CARRIES);
#undef BELVEDERE_CARRIES
}

}  // namespace detail
}  // namespace belvedere

#endif  // BELVEDERE_WIRE_HPP
