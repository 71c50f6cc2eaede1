// What the converters look at: a header and its payload, wherever they lie.
#pragma once

#include <belvedere.hpp>

namespace belvedere_ros {

/// A frame of a stream, seen without owning it. The header has been checked by the bridge: rows, elements and structs lie
/// within the payload.
struct Sample {
    Sample(const belvedere::Header& frame_header, belvedere::Span<const std::uint8_t> bytes)
        : header(frame_header), payload(bytes) {}
    explicit Sample(const belvedere::Frame& frame) : Sample(frame.header(), frame.payload()) {}

    const belvedere::Header& header;
    belvedere::Span<const std::uint8_t> payload;
};

}  // namespace belvedere_ros
