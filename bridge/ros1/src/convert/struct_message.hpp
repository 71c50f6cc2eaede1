// Payload structs as serialized messages, for all kinds whose message needs nothing else.
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>

#include <boost/shared_ptr.hpp>

#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "header.hpp"

namespace belvedere_ros {

/// A message that is serialized already. roscpp sends it as it is, whatever its type.
struct Serialized {
    std::vector<std::uint8_t> bytes;
};

/// A converter from the frames of one stream. The library knows the types of ROS and their layouts.
class StructMessage {
public:
    /// Throws Unrepresentable if ROS has no type for streams of this kind and topic.
    StructMessage(std::uint16_t kind, const std::string& topic);

    std::string name() const { return bv_ros1_name(message_.get()); }
    std::string md5() const { return bv_ros1_md5(message_.get()); }
    std::string definition() const { return bv_ros1_definition(message_.get()); }
    /// Returns true if messages begin with a std_msgs/Header, whose sequence number roscpp sets.
    bool has_header() const;

    /// Throws Unrepresentable.
    boost::shared_ptr<Serialized> operator()(const Sample& sample) const;

private:
    struct Close {
        void operator()(bv_ros1_message* message) const { bv_ros1_close(message); }
    };
    std::unique_ptr<bv_ros1_message, Close> message_;
};

}  // namespace belvedere_ros

namespace ros {
namespace message_traits {

template <>
struct IsMessage<belvedere_ros::Serialized> : TrueType {};

template <>
struct MD5Sum<belvedere_ros::Serialized> {
    static const char* value(const belvedere_ros::Serialized&) { return value(); }
    static const char* value() { return "*"; }
};

template <>
struct DataType<belvedere_ros::Serialized> {
    static const char* value(const belvedere_ros::Serialized&) { return value(); }
    static const char* value() { return "*"; }
};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<belvedere_ros::Serialized> {
    template <class Stream>
    static void write(Stream& stream, const belvedere_ros::Serialized& message) {
        if (!message.bytes.empty())
            std::memcpy(stream.advance(serializedLength(message)), message.bytes.data(), message.bytes.size());
    }
    static std::uint32_t serializedLength(const belvedere_ros::Serialized& message) {
        return static_cast<std::uint32_t>(message.bytes.size());
    }
};

}  // namespace serialization
}  // namespace ros
