// What every message of ROS begins with, and how values are read out of a frame.
#pragma once

#include <std_msgs/Header.h>

#include <cstring>
#include <stdexcept>
#include <string>

#include "../sample.hpp"

namespace belvedere_ros {

/// A frame that the message type has no way to say.
class Unrepresentable : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Nanoseconds of simulation as time of ROS; Unrepresentable beyond 2³² s.
ros::Time to_time(std::uint64_t nanoseconds);

/// Stamp and frame_id; the number is roscpp's to count.
std_msgs::Header to_header(const Sample& sample);

/// Text of a fixed field, without the leading slash that tf2 refuses.
template <std::size_t length>
std::string to_text(const char (&field)[length]) {
    const char* begin = field[0] == '/' ? field + 1 : field;
    return {begin, strnlen(begin, static_cast<std::size_t>(field + length - begin))};
}

/// How many structs the frame holds.
inline std::uint32_t struct_count(const Sample& sample) {
    return sample.header.width == 0 ? 0 : sample.header.height;
}

/// One of them, copied out. Unrepresentable when the frame holds something smaller.
template <class T>
T read_struct(const Sample& sample, std::uint32_t index = 0) {
    static_assert(std::is_trivially_copyable<T>::value, "T must be one of the structs of belvedere.h");
    const std::size_t offset = static_cast<std::size_t>(index) * sample.header.row_stride;
    if (sample.header.encoding != BV_ENCODING_STRUCT || index >= struct_count(sample) ||
        sample.header.elem_stride < sizeof(T) || offset + sizeof(T) > sample.payload.size())
        throw Unrepresentable("the frame does not hold the structs of its kind");
    T value;
    std::memcpy(&value, sample.payload.data() + offset, sizeof(T));
    return value;
}

}  // namespace belvedere_ros
