#include "reconfigure.hpp"

#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>

namespace belvedere_ros {

namespace {

struct Parameter {
    const char* name;
    bv_setting bv_sensor_settings::*setting;
    const char* description;
};

constexpr Parameter kParameters[] = {
    {"update_rate", &bv_sensor_settings::update_rate, "Frames per second"},
    {"noise_mean", &bv_sensor_settings::noise_mean, "Mean of the noise: metres of ranges, or of colours in [0, 1]"},
    {"noise_stddev", &bv_sensor_settings::noise_stddev, "Standard deviation of the noise: metres of ranges, or of colours in [0, 1]"},
    {"exposure", &bv_sensor_settings::exposure, "Factor of the light: 1 as described"},
};

// dynamic_reconfigure's name of the group of all parameters.
constexpr const char* kGroup = "Default";

/// Calls `function` for each parameter that the sensor has.
template <class Function>
void for_each(const bv_sensor_settings& sensor, Function function) {
    for (const Parameter& parameter : kParameters)
        if (const bv_setting& setting = sensor.*parameter.setting; !std::isnan(setting.value)) function(parameter, setting);
}

/// Returns the values, or the limits, of all parameters.
dynamic_reconfigure::Config to_config(const bv_sensor_settings& sensor, double bv_setting::*part) {
    dynamic_reconfigure::Config config;
    for_each(sensor, [&](const Parameter& parameter, const bv_setting& setting) {
        dynamic_reconfigure::DoubleParameter value;
        value.name = parameter.name;
        value.value = setting.*part;
        config.doubles.push_back(value);
    });
    dynamic_reconfigure::GroupState group;
    group.name = kGroup;
    group.state = true;
    config.groups.push_back(group);
    return config;
}

/// Returns the shortest text that is read as the same number.
std::string to_word(const char* name, double value) {
    char digits[32];
    const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
    return std::string(name) + '=' + std::string(digits, end) + ' ';
}

bool same_limits(const bv_sensor_settings& one, const bv_sensor_settings& other) {
    bool same = true;
    for (const Parameter& parameter : kParameters) {
        const bv_setting &left = one.*parameter.setting, &right = other.*parameter.setting;
        // Compare bits: missing settings are NaN.
        same = same && std::memcmp(&left.min, &right.min, sizeof left.min) == 0 &&
               std::memcmp(&left.max, &right.max, sizeof left.max) == 0;
    }
    return same;
}

}  // namespace

Reconfigure::Reconfigure(ros::NodeHandle nh, Change change)
    : nh_(std::move(nh)), change_(std::move(change)),
      descriptions_(nh_.advertise<dynamic_reconfigure::ConfigDescription>("parameter_descriptions", 1, true)),
      updates_(nh_.advertise<dynamic_reconfigure::Config>("parameter_updates", 1, true)),
      service_(nh_.advertiseService("set_parameters", &Reconfigure::set, this)) {}

void Reconfigure::tell(const bv_sensor_settings& sensor) {
    const std::lock_guard<std::mutex> lock(mutex_);
    now_ = sensor;
    if (!first_ || !same_limits(*first_, sensor)) {
        first_ = sensor;
        describe();
    }
    updates_.publish(to_config(sensor, &bv_setting::value));
}

void Reconfigure::describe() {
    dynamic_reconfigure::ConfigDescription description;
    dynamic_reconfigure::Group group;
    group.name = kGroup;
    for_each(*first_, [&](const Parameter& known, const bv_setting&) {
        dynamic_reconfigure::ParamDescription parameter;
        parameter.name = known.name;
        parameter.type = "double";
        parameter.description = known.description;
        group.parameters.push_back(parameter);
    });
    description.groups.push_back(group);
    description.min = to_config(*first_, &bv_setting::min);
    description.max = to_config(*first_, &bv_setting::max);
    description.dflt = to_config(*first_, &bv_setting::value);
    descriptions_.publish(description);
}

void Reconfigure::apply_given() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!now_) return;
    std::string words;
    for_each(*now_, [&](const Parameter& parameter, const bv_setting& setting) {
        double value = 0;
        if (nh_.getParam(parameter.name, value) && value != setting.value) words += to_word(parameter.name, value);
    });
    if (words.empty()) return;
    if (const std::string reason = change_(*now_, words); !reason.empty())
        ROS_WARN_STREAM("parameters of " << nh_.getNamespace() << ": " << reason);
}

bool Reconfigure::set(dynamic_reconfigure::Reconfigure::Request& request, dynamic_reconfigure::Reconfigure::Response& response) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!now_) return false;
    bv_sensor_settings wanted = *now_;
    std::string words, reason;
    for (const auto& value : request.config.doubles) {
        bv_setting bv_sensor_settings::*setting = nullptr;
        for_each(*now_, [&](const Parameter& parameter, const bv_setting&) {
            if (parameter.name == value.name) setting = parameter.setting;
        });
        if (setting == nullptr) {
            reason = "there is no parameter " + value.name;
            continue;
        }
        // Clients send all parameters: skip unchanged ones.
        if ((wanted.*setting).value == value.value) continue;
        (wanted.*setting).value = value.value;
        words += to_word(value.name.c_str(), value.value);
    }
    if (!request.config.ints.empty() || !request.config.strs.empty() || !request.config.bools.empty())
        reason = "all parameters are of type double";
    if (reason.empty() && !words.empty()) reason = change_(*now_, words);
    if (reason.empty())
        now_ = wanted;
    else
        ROS_WARN_STREAM(nh_.getNamespace() << "/set_parameters: " << reason);
    response.config = to_config(*now_, &bv_setting::value);
    return true;
}

}  // namespace belvedere_ros
