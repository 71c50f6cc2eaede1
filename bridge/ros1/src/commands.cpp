#include "commands.hpp"

#include <exception>
#include <mutex>
#include <vector>

#include "convert/command.hpp"
#include "reminder.hpp"

namespace belvedere_ros {

namespace {

template <class Message, class Command>
class CommandsOf : public Commands {
public:
    using Convert = Command (*)(const Message&);

    CommandsOf(belvedere::CommandPublisher<Command> publisher, ros::NodeHandle nh, const std::set<std::string>& topics,
               Convert convert)
        : convert_(convert), publisher_(std::move(publisher)) {
        for (const std::string& topic : topics) {
            const boost::function<void(const boost::shared_ptr<const Message>&)> received =
                [this, topic](const boost::shared_ptr<const Message>& message) { send(*message, topic); };
            // A queue of one: only the newest command matters.
            subscribers_.push_back(
                nh.subscribe<Message>(topic, 1, received, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
        }
    }

private:
    void send(const Message& message, const std::string& topic) {
        const std::lock_guard<std::mutex> lock(mutex_);
        try {
            publisher_.send(convert_(message));
        } catch (const std::exception& error) {
            if (trouble_.due()) ROS_WARN_STREAM(topic << ": " << error.what());
        }
    }

    const Convert convert_;
    std::mutex mutex_;
    Reminder trouble_;
    belvedere::CommandPublisher<Command> publisher_;
    // Declared last so that they end first: they use the members above.
    std::vector<ros::Subscriber> subscribers_;
};

}  // namespace

std::unique_ptr<Commands> Commands::to(const bv_stream_info& stream, Domain& domain, ros::NodeHandle nh,
                                       const std::set<std::string>& topics) {
    const auto take = [&](auto convert, auto message) -> std::unique_ptr<Commands> {
        using Message = decltype(message);
        using Command = decltype(convert(message));
        return std::make_unique<CommandsOf<Message, Command>>(domain.commands<Command>(stream.topic), nh, topics, convert);
    };
    switch (stream.kind) {
        case BV_KIND_VELOCITY_COMMAND: return take(from_twist, geometry_msgs::Twist());
        case BV_KIND_RESET_ODOMETRY: return take(from_empty, std_msgs::Empty());
        case BV_KIND_MOTOR_POWER: return take(from_motor_power, kobuki_msgs::MotorPower());
        default: return nullptr;
    }
}

}  // namespace belvedere_ros
