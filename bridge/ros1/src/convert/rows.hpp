// The only copy of a payload.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "header.hpp"

namespace belvedere_ros {

/// Copies the rows of an image or cloud into a message. Returns the message's row stride.
///
/// For any header, the message takes at most twice the size of the payload, which lacks only the padding of the last
/// row. The row stride has been checked only if there are several rows, and the element stride only if there are
/// several elements. A single row takes its length from the elements. For a single element nothing bounds the stride.
/// Throws Unrepresentable if the message would be larger than that.
inline std::uint32_t copy_rows(const Sample& sample, std::vector<std::uint8_t>& data) {
    const belvedere::Header& header = sample.header;
    if (header.width == 0 || header.height == 0) return 0;
    const std::uint64_t step = header.height > 1 ? header.row_stride : std::uint64_t{header.width} * header.elem_stride;
    const std::uint64_t most = std::min<std::uint64_t>(2 * sample.payload.size(), std::numeric_limits<std::uint32_t>::max());
    if (step > most / header.height)
        throw Unrepresentable("rows are " + std::to_string(step) + " bytes long, in a payload of " + std::to_string(sample.payload.size()));
    const std::size_t size = header.height * step;
    const std::uint8_t* begin = sample.payload.data();
    // assign() does not write zeros first, as resize() and a copy would. The last row may be unpadded.
    data.assign(begin, begin + std::min(size, sample.payload.size()));
    data.resize(size);
    return static_cast<std::uint32_t>(step);
}

}  // namespace belvedere_ros
