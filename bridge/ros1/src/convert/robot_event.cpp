#include "robot_event.hpp"

#include <boost/make_shared.hpp>

namespace belvedere_ros {

namespace {

// As bv_robot_event has them.
enum Source : std::uint32_t { bumper, cliff, wheel_drop };

/// How kobuki_msgs numbers the places left, centre and right of an event; the right wheel is its second.
constexpr int kNone = -1;
constexpr int kPlaces[][3] = {
    {kobuki_msgs::BumperEvent::LEFT, kobuki_msgs::BumperEvent::CENTER, kobuki_msgs::BumperEvent::RIGHT},
    {kobuki_msgs::CliffEvent::LEFT, kobuki_msgs::CliffEvent::CENTER, kobuki_msgs::CliffEvent::RIGHT},
    {kobuki_msgs::WheelDropEvent::LEFT, kNone, kobuki_msgs::WheelDropEvent::RIGHT},
};

struct Event {
    std::uint8_t place;
    std::uint8_t state;
    std::uint16_t value;
};

Event read_event(const Sample& sample, Source source) {
    const auto from = read_struct<bv_robot_event>(sample);
    if (from.source != source) throw Unrepresentable("an event is of source " + std::to_string(from.source) + " there");
    const int place = from.index < 3 ? kPlaces[source][from.index] : kNone;
    if (place == kNone) throw Unrepresentable("an event is of place " + std::to_string(from.index) + ", where nothing is");
    if (from.state > 1) throw Unrepresentable("an event is of state " + std::to_string(from.state));
    return {static_cast<std::uint8_t>(place), static_cast<std::uint8_t>(from.state), static_cast<std::uint16_t>(from.value)};
}

}  // namespace

// 1 is pressed, cliff and dropped in both.
static_assert(kobuki_msgs::BumperEvent::PRESSED == 1 && kobuki_msgs::CliffEvent::CLIFF == 1 &&
              kobuki_msgs::WheelDropEvent::DROPPED == 1);

kobuki_msgs::BumperEventPtr to_bumper_event(const Sample& sample) {
    const Event from = read_event(sample, bumper);
    auto event = boost::make_shared<kobuki_msgs::BumperEvent>();
    event->bumper = from.place;
    event->state = from.state;
    return event;
}

kobuki_msgs::CliffEventPtr to_cliff_event(const Sample& sample) {
    const Event from = read_event(sample, cliff);
    auto event = boost::make_shared<kobuki_msgs::CliffEvent>();
    event->sensor = from.place;
    event->state = from.state;
    event->bottom = from.value;
    return event;
}

kobuki_msgs::WheelDropEventPtr to_wheel_drop_event(const Sample& sample) {
    const Event from = read_event(sample, wheel_drop);
    auto event = boost::make_shared<kobuki_msgs::WheelDropEvent>();
    event->wheel = from.place;
    event->state = from.state;
    return event;
}

}  // namespace belvedere_ros
