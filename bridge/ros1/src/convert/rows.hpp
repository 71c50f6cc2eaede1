// The one copy that a payload makes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "header.hpp"

namespace belvedere_ros {

/// Copies the rows of a picture or cloud into a message; gives the bytes from row to row there.
///
/// No header makes it take more than the payload and the padding of one row: the distance of rows is checked where
/// there are several, so that of a single row is not believed.
inline std::uint32_t copy_rows(const Sample& sample, std::vector<std::uint8_t>& data) {
    const belvedere::Header& header = sample.header;
    if (header.width == 0 || header.height == 0) return 0;
    const std::uint32_t step = header.height > 1 ? header.row_stride : header.width * header.elem_stride;
    const std::size_t size = static_cast<std::size_t>(header.height) * step;
    const std::uint8_t* begin = sample.payload.data();
    // assign() does not write zeros first, as resize() and a copy would. The last row may come without its padding.
    data.assign(begin, begin + std::min(size, sample.payload.size()));
    data.resize(size);
    return step;
}

}  // namespace belvedere_ros
