#include "core_sensors.hpp"

#include <boost/make_shared.hpp>

namespace belvedere_ros {

namespace {

constexpr std::size_t kMotors = 2;
constexpr std::size_t kAnalogInputs = 4;

}  // namespace

kobuki_msgs::SensorStatePtr to_core_sensors(const Sample& sample) {
    const auto from = read_struct<bv_core_sensors>(sample);
    auto state = boost::make_shared<kobuki_msgs::SensorState>();
    state->header = to_header(sample);
    state->time_stamp = from.time_stamp;
    state->bumper = from.bumper;
    state->wheel_drop = from.wheel_drop;
    state->cliff = from.cliff;
    state->left_encoder = from.left_encoder;
    state->right_encoder = from.right_encoder;
    state->left_pwm = from.left_pwm;
    state->right_pwm = from.right_pwm;
    state->buttons = from.buttons;
    state->charger = from.charger;
    state->battery = from.battery;
    state->bottom.assign(std::begin(from.bottom), std::end(from.bottom));
    state->current.assign(kMotors, 0);
    state->analog_input.assign(kAnalogInputs, 0);
    return state;
}

}  // namespace belvedere_ros
