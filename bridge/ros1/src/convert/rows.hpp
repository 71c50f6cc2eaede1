// The one copy that a payload makes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "header.hpp"

namespace belvedere_ros {

/// Copies the rows of a picture or cloud into a message; gives the bytes from row to row there.
///
/// No header makes it take more than twice the payload, which has all but the padding of the last row. The distance of rows
/// is checked where there are several, that of elements likewise; of a single row the elements say how long it is, and
/// nothing says it of a single element. Throws Unrepresentable for one that is longer.
inline std::uint32_t copy_rows(const Sample& sample, std::vector<std::uint8_t>& data) {
    const belvedere::Header& header = sample.header;
    if (header.width == 0 || header.height == 0) return 0;
    const std::uint64_t step = header.height > 1 ? header.row_stride : std::uint64_t{header.width} * header.elem_stride;
    const std::uint64_t most = std::min<std::uint64_t>(2 * sample.payload.size(), std::numeric_limits<std::uint32_t>::max());
    if (step > most / header.height)
        throw Unrepresentable("rows are " + std::to_string(step) + " bytes long, in a payload of " + std::to_string(sample.payload.size()));
    const std::size_t size = header.height * step;
    const std::uint8_t* begin = sample.payload.data();
    // assign() does not write zeros first, as resize() and a copy would. The last row may come without its padding.
    data.assign(begin, begin + std::min(size, sample.payload.size()));
    data.resize(size);
    return static_cast<std::uint32_t>(step);
}

}  // namespace belvedere_ros
