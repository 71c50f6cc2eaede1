// The bridge as a node.

#include <ros/ros.h>
#include <signal.h>
#include <time.h>

#include <cstdio>
#include <exception>
#include <map>
#include <string>

#include "bridge.hpp"
#include "master.hpp"
#include "registrations.hpp"
#include "reminder.hpp"

namespace {

using belvedere_ros::Bridge;
using belvedere_ros::Master;

// Blocks SIGINT and SIGTERM, so that only the main thread receives them, and not a handler of roscpp: at SIGTERM roscpp
// exits without unregistering from the master, which would still list this node.
sigset_t block_signals() {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    return signals;
}

// Returns true if one of the signals arrives within half a second.
bool signalled(const sigset_t& signals) {
    const timespec patience{0, 500'000'000};
    return sigtimedwait(&signals, nullptr, &patience) > 0;
}

// Waits for the master. Returns false if a signal arrives first.
bool wait_for(Master& master, const sigset_t& signals) {
    belvedere_ros::Reminder reminder;
    while (!master.answers()) {
        if (reminder.due()) ROS_WARN_STREAM("waiting for roscore at " << master.uri() << " (ROS_MASTER_URI)");
        if (signalled(signals)) return false;
    }
    return true;
}

// Sets use_sim_time as Gazebo's ROS plugin does, so that launch files need not. Must be called before the first handle,
// when roscpp reads it.
void use_simulated_time() {
    if (ros::param::param("~publish_clock", true) && !ros::param::has("/use_sim_time")) ros::param::set("/use_sim_time", true);
}

// The private parameters of the node at the start, from roslaunch, the command line or another program, and
// /use_sim_time: a restarted roscore has lost them.
class KeptParameters {
public:
    KeptParameters() {
        keep("/use_sim_time");
        Value own;
        if (!ros::param::get("~", own) || own.getType() != Value::TypeStruct) return;
        for (const auto& parameter : own) keep("~" + parameter.first);
    }

    // Sets those that are missing on the master.
    void restore() const {
        for (const auto& [name, value] : values_)
            if (!ros::param::has(name)) ros::param::set(name, value);
    }

private:
    using Value = XmlRpc::XmlRpcValue;

    void keep(const std::string& name) {
        if (Value value; ros::param::get(name, value)) values_[name] = value;
    }

    std::map<std::string, Value> values_;
};

// Serves until a signal or `rosnode kill`. Returns false on an error.
bool serve(Master& master, const sigset_t& signals) {
    const ros::NodeHandle nh;  // keeps roscpp running, for logging
    const KeptParameters parameters;
    try {
        const Bridge bridge{nh, ros::NodeHandle("~")};
        ros::AsyncSpinner spinner(2);
        spinner.start();
        bool gone = false, registered = true;
        while (!signalled(signals) && ros::ok()) {
            const Master::State state = master.look(ros::this_node::getName());
            // `rosnode kill` unregisters the node shortly before ros::ok() becomes false.
            if (ros::isShuttingDown()) break;
            registered = registered && state != Master::State::forgetful;
            if (!registered && master.answers()) {
                parameters.restore();
                registered = belvedere_ros::register_again();
                if (registered) ROS_INFO_STREAM("registered with the new roscore at " << master.uri());
            }
            if (const bool now = state == Master::State::gone; now != gone) {
                gone = now;
                if (gone)
                    ROS_WARN_STREAM("roscore at " << master.uri() << " is gone; waiting for it");
                else
                    ROS_INFO("roscore answers again");
            }
        }
        // Before the bridge ends: its threads may be waiting for a roscore that is gone, to register.
        ros::shutdown();
    } catch (const std::exception& error) {
        ROS_FATAL_STREAM(error.what());
        return false;
    }
    return true;
}

}  // namespace

int main(int argc, char** argv) try {
    const sigset_t signals = block_signals();
    std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // lines reach a file or pipe at once
    Master master(argc, argv);
    if (!wait_for(master, signals)) return 0;
    ros::init(argc, argv, "belvedere", ros::init_options::NoSigintHandler);
    use_simulated_time();
    return serve(master, signals) ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "belvedere_ros: %s\n", error.what());
    return 1;
}
