// Frames with known bytes, for tests of converters.
#pragma once

#include <gtest/gtest.h>
#include <std_msgs/Header.h>

#include <boost/make_shared.hpp>

#include <cstring>
#include <string>
#include <vector>

#include "../src/convert/struct_message.hpp"

namespace belvedere_ros {

/// A frame that owns its bytes.
struct Known {
    belvedere::Header header{};
    std::vector<std::uint8_t> bytes;

    Known(bv_kind kind, bv_encoding encoding, std::uint32_t width, std::uint32_t height, std::uint32_t elem_stride,
          std::uint32_t padding = 0) {
        header.magic = BV_MAGIC;
        header.header_len = sizeof header;
        header.schema = BV_SCHEMA;
        header.kind = static_cast<std::uint16_t>(kind);
        header.encoding = static_cast<std::uint16_t>(encoding);
        header.stamp_ns = 12'033'333'333;
        header.width = width;
        header.height = height;
        header.elem_stride = elem_stride;
        header.row_stride = width * elem_stride + padding;
        std::strcpy(header.frame_id, "sensor_frame");
        bytes.resize(static_cast<std::size_t>(height) * header.row_stride);
        for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * 7 + 3);
    }

    template <class T>
    static Known structs(bv_kind kind, const std::vector<T>& values) {
        Known known(kind, BV_ENCODING_STRUCT, 1, static_cast<std::uint32_t>(values.size()), sizeof(T));
        std::memcpy(known.bytes.data(), values.data(), values.size() * sizeof(T));
        return known;
    }

    Sample sample() {
        header.payload_len = bytes.size();
        return {header, {bytes.data(), bytes.size()}};
    }
};

/// Returns what a subscriber of the topic gets of a frame.
template <class Message>
boost::shared_ptr<Message> received(const Sample& sample, const std::string& topic = "") {
    const StructMessage convert(sample.header.kind, topic);
    EXPECT_EQ(convert.name(), ros::message_traits::datatype<Message>());
    EXPECT_EQ(convert.md5(), ros::message_traits::md5sum<Message>());
    EXPECT_EQ(convert.has_header(), ros::message_traits::hasHeader<Message>());
    auto serialized = convert(sample);
    auto message = boost::make_shared<Message>();
    ros::serialization::IStream stream(serialized->bytes.data(), static_cast<std::uint32_t>(serialized->bytes.size()));
    ros::serialization::deserialize(stream, *message);
    EXPECT_EQ(stream.getLength(), 0u);
    return message;
}

inline void expect_header(const std_msgs::Header& header) {
    EXPECT_EQ(header.stamp.sec, 12u);
    EXPECT_EQ(header.stamp.nsec, 33'333'333u);
    EXPECT_EQ(header.frame_id, "sensor_frame");
}

}  // namespace belvedere_ros
