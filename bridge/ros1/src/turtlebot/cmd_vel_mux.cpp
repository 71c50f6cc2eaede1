// The TurtleBot's multiplexer of velocity commands, with the topics and parameters of yocs_cmd_vel_mux: ~subscribers, a
// list of name, topic, timeout and priority, and ~publisher. Topics are in the nodelet's private namespace, next to
// ~active.

#include <geometry_msgs/Twist.h>
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>
#include <std_msgs/String.h>

#include <memory>
#include <mutex>

#include "../parameter_readers.hpp"
#include "mux.hpp"

namespace belvedere_ros::turtlebot {

namespace {

using Value = XmlRpc::XmlRpcValue;

constexpr double kLookPeriod = 0.05;

Source to_source(Value& value) {
    const auto number = [&](const char* name) {
        if (!value.hasMember(name)) throw BadParameter(std::string("a list of sources with a ") + name + " each");
        return to_number(value[name]);
    };
    if (value.getType() != Value::TypeStruct) throw BadParameter("a list of sources: name, topic, timeout, priority");
    if (!value.hasMember("topic")) throw BadParameter("a list of sources with a topic each");
    Source source;
    source.topic = to_text(value["topic"]);
    source.name = value.hasMember("name") ? to_text(value["name"]) : source.topic;
    source.timeout_s = number("timeout");
    source.priority = static_cast<int>(number("priority"));
    if (source.timeout_s <= 0) throw BadParameter("a list of sources with a timeout above 0 s each");
    return source;
}

}  // namespace

class CmdVelMux : public nodelet::Nodelet {
    void onInit() override {
        ros::NodeHandle& nh = getPrivateNodeHandle();
        std::vector<Source> sources;
        std::string publisher = "output";
        read_all(nh, {
            {"subscribers", [&](Value& list) {
                if (list.getType() != Value::TypeArray) throw BadParameter("a list of sources: name, topic, timeout, priority");
                for (int i = 0; i < list.size(); ++i) sources.push_back(to_source(list[i]));
            }},
            {"publisher", [&](Value& value) { publisher = to_text(value); }},
        });
        if (sources.empty())
            throw BadParameter(nh.resolveName("subscribers") + " is not set; it must be a list of sources: name, topic, timeout, priority");
        mux_ = std::make_unique<Mux>(std::move(sources));
        output_ = nh.advertise<geometry_msgs::Twist>(publisher, 10);
        active_ = nh.advertise<std_msgs::String>("active", 1, true);
        tell("idle");
        for (std::size_t i = 0; i < mux_->sources().size(); ++i) {
            const boost::function<void(const geometry_msgs::TwistConstPtr&)> received =
                [this, i](const geometry_msgs::TwistConstPtr& command) { take(i, command); };
            inputs_.push_back(nh.subscribe<geometry_msgs::Twist>(mux_->sources()[i].topic, 10, received, ros::VoidConstPtr(),
                                                                 ros::TransportHints().tcpNoDelay()));
        }
        timer_ = nh.createTimer(ros::Duration(kLookPeriod), [this](const ros::TimerEvent&) { look(); });
    }

    void take(std::size_t source, const geometry_msgs::TwistConstPtr& command) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!mux_->hears(source, ros::Time::now().toSec())) return;
        tell(mux_->sources()[source].name);
        output_.publish(command);
    }

    void look() {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!mux_->active(ros::Time::now().toSec())) tell("idle");
    }

    /// Publishes the active source when it changes.
    void tell(const std::string& name) {
        if (name == told_) return;
        told_ = name;
        std_msgs::String message;
        message.data = name;
        active_.publish(message);
    }

    std::mutex mutex_;
    std::unique_ptr<Mux> mux_;
    std::string told_;
    ros::Publisher output_, active_;
    // Declared last so that they end first: they use the members above.
    std::vector<ros::Subscriber> inputs_;
    ros::Timer timer_;
};

}  // namespace belvedere_ros::turtlebot

PLUGINLIB_EXPORT_CLASS(belvedere_ros::turtlebot::CmdVelMux, nodelet::Nodelet)
