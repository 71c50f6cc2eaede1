#include "robot_event.hpp"

#include <boost/make_shared.hpp>

namespace belvedere_ros {

namespace {

// The values of bv_robot_event.
enum Source : std::uint32_t { bumper, cliff, wheel_drop };

// The index of a place where a Kobuki has no such sensor.
constexpr int kNone = -1;

/// Converts an event of one source. `places` are the message's numbers for left, centre and right; the one of the event
/// is written to `place`.
template <class Message>
boost::shared_ptr<Message> to_event(const Sample& sample, Source source, std::uint8_t Message::*place, const int (&places)[3]) {
    const auto from = read_struct<bv_robot_event>(sample);
    if (from.source != source) throw Unrepresentable("an event is of source " + std::to_string(from.source) + " there");
    const int number = from.index < 3 ? places[from.index] : kNone;
    if (number == kNone) throw Unrepresentable("an event is of place " + std::to_string(from.index) + ", where nothing is");
    if (from.state > 1) throw Unrepresentable("an event is of state " + std::to_string(from.state));
    auto event = boost::make_shared<Message>();
    event.get()->*place = static_cast<std::uint8_t>(number);
    event->state = static_cast<std::uint8_t>(from.state);
    return event;
}

}  // namespace

using kobuki_msgs::BumperEvent, kobuki_msgs::CliffEvent, kobuki_msgs::WheelDropEvent;

// 1 means pressed, cliff or dropped in both.
static_assert(BumperEvent::PRESSED == 1 && CliffEvent::CLIFF == 1 && WheelDropEvent::DROPPED == 1);

kobuki_msgs::BumperEventPtr to_bumper_event(const Sample& sample) {
    return to_event(sample, bumper, &BumperEvent::bumper, {BumperEvent::LEFT, BumperEvent::CENTER, BumperEvent::RIGHT});
}

kobuki_msgs::CliffEventPtr to_cliff_event(const Sample& sample) {
    auto event = to_event(sample, cliff, &CliffEvent::sensor, {CliffEvent::LEFT, CliffEvent::CENTER, CliffEvent::RIGHT});
    event->bottom = static_cast<std::uint16_t>(read_struct<bv_robot_event>(sample).value);
    return event;
}

kobuki_msgs::WheelDropEventPtr to_wheel_drop_event(const Sample& sample) {
    // The right wheel is number 1 in the message.
    return to_event(sample, wheel_drop, &WheelDropEvent::wheel, {WheelDropEvent::LEFT, kNone, WheelDropEvent::RIGHT});
}

}  // namespace belvedere_ros
