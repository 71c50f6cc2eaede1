// The header of ROS messages, and reading of values from a frame.
#pragma once

#include <std_msgs/Header.h>

#include <cstring>
#include <stdexcept>
#include <string>

#include "../sample.hpp"

namespace belvedere_ros {

/// The error for a frame that the message type cannot represent.
class Unrepresentable : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Converts nanoseconds of simulated time to ROS time; throws Unrepresentable beyond 2³² s.
ros::Time to_time(std::uint64_t nanoseconds);

/// Converts stamp and frame_id; roscpp sets the sequence number.
std_msgs::Header to_header(const Sample& sample);

/// Returns the text of a field, without the leading slash that tf2 refuses.
template <std::size_t length>
std::string to_text(const char (&field)[length]) {
    const char* begin = field[0] == '/' ? field + 1 : field;
    return {begin, strnlen(begin, static_cast<std::size_t>(field + length - begin))};
}

/// Returns the number of structs in the frame.
inline std::uint32_t struct_count(const Sample& sample) {
    return sample.header.width == 0 ? 0 : sample.header.height;
}

/// Returns a copy of one of the structs. Throws Unrepresentable if the frame holds smaller ones.
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
