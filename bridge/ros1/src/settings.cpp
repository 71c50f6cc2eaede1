#include "settings.hpp"

#include <algorithm>
#include <cctype>
#include <exception>
#include <utility>
#include <vector>

#include "convert/header.hpp"

namespace belvedere_ros {

namespace {

constexpr const char* kStream = "simulation/sensor_settings";
// The interval of retries to subscribe, and of checks without an event.
constexpr std::chrono::milliseconds kPatience{1000};
// The timeout of an answer, which may take as long as a frame.
constexpr std::chrono::milliseconds kAnswer{3000};

// ROS names consist of letters, digits and underscores, and begin with a letter.
std::string ros_name(std::string name) {
    std::replace_if(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0 || c > 0x7f; }, '_');
    return name.empty() || std::isalpha(static_cast<unsigned char>(name[0])) == 0 ? "sensor_" + name : name;
}

}  // namespace

Settings::Settings(ros::NodeHandle private_nh, Domain& domain)
    : private_nh_(std::move(private_nh)), domain_(domain), thread_([this] { run(); }) {}

Settings::~Settings() {
    stopping_ = true;
    bell_.ring();
    thread_.join();
}

std::optional<double> Settings::rate_hz(const std::string& stream) const {
    const std::lock_guard<std::mutex> lock(rates_mutex_);
    const auto found = rates_hz_.find(stream);
    return found == rates_hz_.end() ? std::nullopt : std::optional<double>(found->second);
}

void Settings::run() {
    while (!stopping_) {
        try {
            follow();
        } catch (const std::exception& error) {
            if (trouble_.due()) ROS_WARN_STREAM("settings of sensors cannot be followed: " << error.what());
        }
        // A ring at the end may have been consumed already.
        if (!stopping_) bell_.sleep(kPatience);
    }
}

void Settings::follow() {
    belvedere::Subscriber subscriber = domain_.subscribe(kStream);
    const int frames = subscriber.fd();
    while (!stopping_) {
        while (const auto frame = subscriber.take_newest()) take(*frame);
        bell_.sleep(kPatience, frames);
    }
}

void Settings::take(const belvedere::Frame& frame) {
    if (frame.kind() != BV_KIND_SENSOR_SETTINGS) return;
    const auto sensors = frame.structs<bv_sensor_settings>();
    std::map<std::string, double> rates_hz;
    for (const bv_sensor_settings& sensor : sensors)
        for (const auto& topic : sensor.topics)
            if (topic[0] != '\0') rates_hz[to_text(topic)] = sensor.update_rate.value;
    {
        const std::lock_guard<std::mutex> lock(rates_mutex_);
        rates_hz_ = std::move(rates_hz);
    }

    const bool is_new = std::exchange(session_, frame.header().session) != frame.header().session;
    std::map<std::string, std::unique_ptr<Reconfigure>> servers;
    std::vector<std::pair<Reconfigure*, const bv_sensor_settings*>> told;
    for (const bv_sensor_settings& sensor : sensors) {
        std::string name = ros_name(to_text(sensor.name));
        // Two sensors of one name, on different links in the description, are distinguished by their topics.
        if (servers.count(name) != 0) name = ros_name(to_text(sensor.topics[0]));
        auto& server = servers[name] = std::move(servers_[name]);
        if (!server)
            server = std::make_unique<Reconfigure>(
                ros::NodeHandle(private_nh_, name),
                [this](const bv_sensor_settings& of, const std::string& words) { return change(of, words); });
        told.emplace_back(server.get(), &sensor);
    }
    servers_ = std::move(servers);
    for (const auto& [server, sensor] : told) server->tell(*sensor);
    if (!is_new) return;
    // Applied last and to all sensors: each change causes a new message.
    for (const auto& [server, sensor] : told) server->apply_given();
}

/// Returns the reason of a refusal; empty on success.
std::string Settings::change(const bv_sensor_settings& sensor, const std::string& words) {
    const std::lock_guard<std::mutex> lock(control_mutex_);
    bv_simulation_command command{};
    command.operation = BV_OPERATION_CONFIGURE;
    // A topic belongs to one sensor only.
    const std::string topic = to_text(sensor.topics[0]);
    const std::string name = topic.size() < sizeof command.name ? topic : to_text(sensor.name);
    std::copy(name.begin(), name.end(), command.name);
    try {
        if (!control_) control_.emplace(domain_.control());
        const auto result = control_->call(command, kAnswer, words);
        if (!result) return "no simulator answers in domain " + domain_.name();
        return result->done == 1 ? std::string() : to_text(result->reason);
    } catch (const std::exception& error) {
        control_.reset();
        return error.what();
    }
}

}  // namespace belvedere_ros
