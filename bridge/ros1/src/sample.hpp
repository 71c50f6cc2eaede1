// The input of converters: a header and its payload, wherever they are stored.
#pragma once

#include <belvedere.hpp>

namespace belvedere_ros {

/// A view of a frame. The bridge has checked the header: rows, elements and structs lie within the payload.
struct Sample {
    Sample(const belvedere::Header& frame_header, belvedere::Span<const std::uint8_t> bytes)
        : header(frame_header), payload(bytes) {}
    explicit Sample(const belvedere::Frame& frame) : Sample(frame.header(), frame.payload()) {}

    const belvedere::Header& header;
    belvedere::Span<const std::uint8_t> payload;
};

}  // namespace belvedere_ros
