// The bridge as a node of its own.

#include <ros/ros.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <vector>

#include "bridge.hpp"
#include "master.hpp"
#include "reminder.hpp"

namespace {

using belvedere_ros::Bridge;
using belvedere_ros::Master;

// Parameters that outlive the master which kept them.
constexpr const char* kKeptParameters = "BELVEDERE_ROS_PARAMETERS";

// SIGINT and SIGTERM are taken by the main thread alone, and by nothing that roscpp installs: roscpp ends at SIGTERM
// without telling the master, which would go on listing this node.
sigset_t block_signals() {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    return signals;
}

// Whether one of them came within half a second.
bool signalled(const sigset_t& signals) {
    const timespec patience{0, 500'000'000};
    return sigtimedwait(&signals, nullptr, &patience) > 0;
}

// False when a signal came first.
bool wait_for(Master& master, const sigset_t& signals) {
    belvedere_ros::Reminder reminder;
    while (!master.answers()) {
        if (reminder.due()) ROS_WARN_STREAM("waiting for roscore at " << master.uri() << " (ROS_MASTER_URI)");
        if (signalled(signals)) return false;
    }
    return true;
}

void restore_parameters() {
    const char* kept = std::getenv(kKeptParameters);
    if (kept == nullptr) return;
    int offset = 0;
    XmlRpc::XmlRpcValue parameters(kept, &offset);
    if (parameters.getType() == XmlRpc::XmlRpcValue::TypeStruct && !ros::param::has("~")) ros::param::set("~", parameters);
}

// As Gazebo's ROS plugin does, so that launch files need not. Before the first handle: roscpp looks at it then.
void use_simulated_time() {
    if (ros::param::param("~publish_clock", true) && !ros::param::has("/use_sim_time")) ros::param::set("/use_sim_time", true);
}

void keep_parameters() {
    XmlRpc::XmlRpcValue parameters;
    if (ros::param::get("~", parameters)) setenv(kKeptParameters, parameters.toXml().c_str(), 1);
}

enum class End { asked_for, failed, master_forgot };

// Serves until a signal, `rosnode kill`, or a master that was started again.
End serve(const Master& master, const sigset_t& signals) {
    const ros::NodeHandle nh;  // as long as there is one, roscpp runs, and logs
    try {
        const Bridge bridge{nh, ros::NodeHandle("~")};
        ros::AsyncSpinner spinner(2);
        spinner.start();
        bool gone = false;
        while (!signalled(signals) && ros::ok()) {
            const Master::State state = master.look(ros::this_node::getName());
            // Told to end by `rosnode kill`, it is unregistered a moment before it is not ok.
            if (state == Master::State::forgetful) return ros::isShuttingDown() ? End::asked_for : End::master_forgot;
            if (const bool now = state == Master::State::gone; now != gone) {
                gone = now;
                if (gone)
                    ROS_WARN_STREAM("roscore at " << master.uri() << " is gone; waiting for it");
                else
                    ROS_INFO("roscore answers again");
            }
        }
    } catch (const std::exception& error) {
        ROS_FATAL_STREAM(error.what());
        return End::failed;
    }
    return End::asked_for;
}

}  // namespace

int main(int argc, char** argv) try {
    const std::vector<char*> arguments(argv, argv + argc + 1);  // with the null at the end; ros::init takes some away
    const sigset_t signals = block_signals();
    std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // into a file or a pipe, what is said would come late
    Master master(argc, argv);
    if (!wait_for(master, signals)) return 0;
    ros::init(argc, argv, "belvedere", ros::init_options::NoSigintHandler);
    restore_parameters();
    use_simulated_time();
    const End end = serve(master, signals);
    if (end == End::master_forgot) keep_parameters();
    ros::shutdown();
    if (end != End::master_forgot) return end == End::asked_for ? 0 : 1;

    // roscpp registers what it has with one master only. The program begins anew, in the same process, so that whoever has
    // started it notices nothing.
    execv("/proc/self/exe", arguments.data());
    std::perror("cannot begin anew with the new roscore");
    return 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "belvedere_ros: %s\n", error.what());
    return 1;
}
