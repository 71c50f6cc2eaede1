#include "accessories.hpp"

#include <kobuki_msgs/ButtonEvent.h>
#include <kobuki_msgs/DigitalInputEvent.h>
#include <kobuki_msgs/DigitalOutput.h>
#include <kobuki_msgs/ExternalPower.h>
#include <kobuki_msgs/Led.h>
#include <kobuki_msgs/PowerSystemEvent.h>
#include <kobuki_msgs/Sound.h>

namespace belvedere_ros {

namespace {

constexpr std::uint32_t kQueue = 10;

/// Returns the name of a value, or its number.
std::string name_of(unsigned value, const std::vector<std::string>& names) {
    return value < names.size() ? names[value] : std::to_string(value);
}

}  // namespace

Accessories::Accessories(ros::NodeHandle nh, const std::string& space) : base_(space + "mobile_base") {
    const auto take = [&](const std::string& name, auto message, auto keep) {
        using Message = decltype(message);
        const boost::function<void(const boost::shared_ptr<const Message>&)> received =
            [keep](const boost::shared_ptr<const Message>& command) { keep(*command); };
        commands_.push_back(nh.subscribe<Message>(base_ + "/commands/" + name, kQueue, received));
    };
    for (const std::string led : {"led1", "led2"}) {
        take(led, kobuki_msgs::Led(), [this, led](const kobuki_msgs::Led& command) {
            keep(led, name_of(command.value, {"black", "green", "orange", "red"}));
        });
    }
    take("sound", kobuki_msgs::Sound(), [this](const kobuki_msgs::Sound& command) {
        keep("sound", name_of(command.value, {"on", "off", "recharge", "button", "error", "cleaning start", "cleaning end"}));
    });
    take("digital_output", kobuki_msgs::DigitalOutput(), [this](const kobuki_msgs::DigitalOutput& command) {
        for (std::size_t i = 0; i < command.mask.size(); ++i)
            if (command.mask[i]) keep("digital_output " + std::to_string(i), command.values[i] ? "on" : "off");
    });
    take("external_power", kobuki_msgs::ExternalPower(), [this](const kobuki_msgs::ExternalPower& command) {
        const std::string source = name_of(command.source, {"3.3 V 1 A", "5 V 1 A", "12 V 5 A", "12 V 1.5 A"});
        keep("external_power " + source, name_of(command.state, {"off", "on"}));
    });
    events_.push_back(nh.advertise<kobuki_msgs::ButtonEvent>(base_ + "/events/button", kQueue));
    events_.push_back(nh.advertise<kobuki_msgs::DigitalInputEvent>(base_ + "/events/digital_input", kQueue));
    events_.push_back(nh.advertise<kobuki_msgs::PowerSystemEvent>(base_ + "/events/power_system", kQueue));
}

void Accessories::keep(const std::string& name, const std::string& value) {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::string& now = told_[name];
    if (now == value) return;
    now = value;
    ROS_INFO_STREAM(base_ << ": " << name << " is set to " << value << ", which is not simulated");
}

void Accessories::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    status.summary(diagnostic_msgs::DiagnosticStatus::OK, told_.empty() ? "told nothing" : "told, and not simulated");
    for (const auto& [name, value] : told_) status.add(name, value);
}

}  // namespace belvedere_ros
