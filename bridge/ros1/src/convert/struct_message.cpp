#include "struct_message.hpp"

#include <boost/make_shared.hpp>

namespace belvedere_ros {

StructMessage::StructMessage(std::uint16_t kind, const std::string& topic) {
    bv_ros1_message* message = nullptr;
    const bv_status status = bv_ros1_open(kind, topic.c_str(), &message);
    if (status == BV_STATUS_NOTHING)
        throw Unrepresentable("ROS has no message type for a stream of kind " + std::to_string(kind) + " with this name");
    if (status != BV_STATUS_OK) throw Unrepresentable(bv_last_error());
    message_.reset(message);
}

bool StructMessage::has_header() const {
    // Constants come before it in sensor_msgs/Range.
    return ("\n" + definition()).find("\nHeader header\n") < ("\n" + definition()).find("\nMSG: ");
}

boost::shared_ptr<Serialized> StructMessage::operator()(const Sample& sample) const {
    const std::uint8_t* bytes = nullptr;
    std::size_t size = 0;
    if (bv_ros1_write(message_.get(), &sample.header, sample.payload.data(), sample.payload.size(), &bytes, &size) != BV_STATUS_OK)
        throw Unrepresentable(bv_last_error());
    auto message = boost::make_shared<Serialized>();
    message->bytes.assign(bytes, bytes + size);
    return message;
}

}  // namespace belvedere_ros
