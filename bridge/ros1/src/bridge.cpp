#include "bridge.hpp"

#include <exception>

namespace belvedere_ros {

namespace {

using Status = diagnostic_msgs::DiagnosticStatus;

// REP-107.
constexpr double kDiagnosticPeriod = 1.0;
// The share of its rate that a stream must reach.
constexpr double kEnough = 0.9;

/// Returns the robot's namespace in the name of a stream of commands: "robot1/" for robot1/cmd_vel, empty for cmd_vel.
std::string namespace_of(const bv_stream_info& stream) {
    const std::string name = stream.topic;
    for (const std::string own : {"cmd_vel", "mobile_base/commands/reset_odometry", "mobile_base/commands/motor_power"}) {
        if (name.size() > own.size() && name.compare(name.size() - own.size(), own.size(), own) == 0)
            return name.substr(0, name.size() - own.size());
    }
    return "";
}

}  // namespace

Bridge::Bridge(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
    : nh_(nh), parameters_(Parameters::read(private_nh)), domain_(parameters_.domain), topics_(nh, private_nh, parameters_),
      diagnostics_(nh, private_nh, private_nh.getNamespace()), settings_(private_nh, domain_),
      gazebo_(nh, parameters_.gazebo_namespace, domain_) {
    diagnostics_.setHardwareID("belvedere domain " + domain_.name());
    diagnostics_.add("simulator", [this](auto& status) { diagnose_simulator(status); });
    streams_ = std::make_unique<Streams>(domain_, [this](const bv_stream_info& stream) { serve(stream); });
    // By wall time: simulated time stops with the simulator, which is when diagnostics matter.
    diagnostics_timer_ =
        nh_.createWallTimer(ros::WallDuration(kDiagnosticPeriod), [this](const ros::WallTimerEvent&) { diagnostics_.force_update(); });
}

void Bridge::serve(const bv_stream_info& stream) {
    // Lock order: serving_, then mutex_. Writers of relays_ hold both, readers either. The updater must not be called
    // with mutex_ held: it calls diagnose_topic(), which takes mutex_, with a lock of its own held.
    const std::lock_guard<std::mutex> serving(serving_);
    const std::string name = stream.topic;
    try {
        const auto others = parameters_.command_topics.find(stream.kind);
        if (others != parameters_.command_topics.end()) {
            // Topics are in the namespace of the commanded robot.
            const std::string space = namespace_of(stream);
            std::set<std::string> topics{name};
            for (const std::string& other : others->second) topics.insert(space + other);
            if (commands_.count(name) == 0) commands_[name] = Commands::to(stream, domain_, nh_, topics);
            // A base with a motor power command is a Kobuki, or accepts its commands.
            if (stream.kind == BV_KIND_MOTOR_POWER && accessories_.count(space) == 0) {
                Accessories& its = *(accessories_[space] = std::make_unique<Accessories>(nh_, space));
                diagnostics_.add(space + "mobile_base", [&its](auto& status) { its.diagnose(status); });
            }
            return;
        }
        if (stream.kind == BV_KIND_SIMULATION_RESULT) {
            // Served once the first simulator is found, as in Gazebo: a program that waits for a service also waits for
            // the world.
            if (stream.publishers > 0) gazebo_.look();
            return;
        }
        const auto known = relays_.find(name);
        if (stream.kind == BV_KIND_MODEL_STATES && !gazebo_.is_ours()) {
            if (known != relays_.end()) drop(known);
            return;
        }
        if (known != relays_.end()) {
            // Another simulator may use the name for a different stream.
            const Serving& now = known->second;
            const bool same = now.relay->kind() == stream.kind && now.layers == stream.layers;
            if (same || stream.kind == 0 || stream.publishers == 0) return;
            drop(known);
        } else if (stream.publishers == 0 || skipped_.count(name) != 0) {
            return;
        }
        auto relay = topics_.relay(domain_, stream);
        if (!relay) {
            skipped_.insert(name);
            return;
        }
        ROS_INFO_STREAM("serving " << relay->topic());
        auto place = std::make_unique<Served::Place>(relay->topic(), domain_, stream);
        std::optional<double> time_offset;
        if (stream.kind == BV_KIND_LASER_SCAN) time_offset = topics_.scan_parameters(name).time_offset;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            relays_[name] = {std::move(relay), std::move(place), stream.layers, time_offset};
        }
        diagnostics_.add(name, [this, name](auto& status) { diagnose_topic(name, status); });
    } catch (const std::exception& error) {
        // Warn once, since the cause will not change by itself.
        if (skipped_.insert(name).second) ROS_WARN_STREAM("stream " << name << " is skipped: " << error.what());
    }
}

void Bridge::drop(std::map<std::string, Serving>::iterator relay) {
    diagnostics_.removeByName(relay->first);
    const std::lock_guard<std::mutex> lock(mutex_);
    relays_.erase(relay);
}

void Bridge::diagnose_simulator(diagnostic_updater::DiagnosticStatusWrapper& status) const {
    const bool there = streams_ && streams_->simulator_is_there();
    status.summary(there ? Status::OK : Status::WARN, there ? "publishes" : "no simulator in the domain");
    status.add("domain", domain_.name());
}

void Bridge::diagnose_topic(const std::string& stream, diagnostic_updater::DiagnosticStatusWrapper& status) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = relays_.find(stream);
    if (found == relays_.end()) return;
    if (const auto rate_hz = settings_.rate_hz(stream)) found->second.relay->expect(*rate_hz);
    const Flow::Report report = found->second.relay->report();
    const bool slow = report.nominal_rate_hz > 0 && report.rate_hz < kEnough * report.nominal_rate_hz;
    if (!report.problem.empty())
        status.summary(Status::WARN, report.problem);
    else if (!streams_ || !streams_->simulator_is_there())
        status.summary(Status::WARN, "the simulator is gone");
    else if (report.subscribers == 0)
        status.summary(Status::OK, "no subscribers");
    else if (!report.followed || report.publishers == 0)
        status.summary(Status::WARN, "the stream is not published");
    else if (slow)
        status.summaryf(Status::WARN, "%.2f Hz instead of %.2f", report.rate_hz, report.nominal_rate_hz);
    else
        status.summary(Status::OK, "flows");
    status.add("topic", found->second.relay->topic());
    status.add("subscribers", report.subscribers);
    status.addf("rate (Hz)", "%.2f", report.rate_hz);
    status.addf("nominal rate (Hz)", "%.2f", report.nominal_rate_hz);
    if (const auto time_offset = found->second.time_offset) {
        // REP-138's diagnostic keys of laser scanners, as far as they apply.
        status.add("Vendor Name", "Belvedere");
        status.add("Device ID", domain_.name() + "/" + stream);
        status.addf("User Time Offset", "%.3f s", *time_offset);
    }
    status.add("frames", report.frames_total);
    status.add("frames missed", report.missed_total);
}

}  // namespace belvedere_ros
