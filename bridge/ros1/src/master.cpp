#include "master.hpp"

#include <ros/network.h>
#include <xmlrpcpp/XmlRpc.h>

#include <cstdlib>
#include <stdexcept>

namespace belvedere_ros {

namespace {

constexpr int kSuccess = 1;
constexpr int kSilence = -100;

std::string uri_of(int argc, char** argv) {
    const std::string remap = "__master:=";
    for (int index = 1; index < argc; ++index)
        if (const std::string argument = argv[index]; argument.rfind(remap, 0) == 0) return argument.substr(remap.size());
    const char* of_environment = std::getenv("ROS_MASTER_URI");
    return of_environment != nullptr && *of_environment != '\0' ? of_environment : "http://localhost:11311";
}

}  // namespace

Master::Master(int argc, char** argv) : uri_(uri_of(argc, argv)) {
    std::string host;
    std::uint32_t port = 0;
    if (!ros::network::splitURI(uri_, host, port))
        throw std::runtime_error("ROS_MASTER_URI is " + uri_ + "; it must be like http://localhost:11311");
}

Master::Answer Master::ask(const char* method, const std::string& argument) const {
    std::string host;
    std::uint32_t port = 0;
    ros::network::splitURI(uri_, host, port);
    XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
    XmlRpc::XmlRpcValue arguments, answer;
    arguments[0] = "/belvedere_ros";
    if (!argument.empty()) arguments[1] = argument;
    const bool answered = client.execute(method, arguments, answer) && !client.isFault() &&
                          answer.getType() == XmlRpc::XmlRpcValue::TypeArray && answer.size() == 3 &&
                          answer[0].getType() == XmlRpc::XmlRpcValue::TypeInt;
    client.close();
    if (!answered) return {kSilence, 0};
    const bool is_number = answer[2].getType() == XmlRpc::XmlRpcValue::TypeInt;
    return {static_cast<int>(answer[0]), is_number ? static_cast<int>(answer[2]) : 0};
}

bool Master::answers() {
    const Answer pid = ask("getPid", {});
    pid_ = pid.value;
    return pid.status == kSuccess;
}

Master::State Master::look(const std::string& node) const {
    const int status = ask("lookupNode", node).status;
    if (status == kSilence) return State::gone;
    // A restarted master may already list this node, since roscpp repeats pending registrations with it. Only its pid
    // shows that it is another master.
    const Answer pid = ask("getPid", {});
    const bool is_other = pid.status == kSuccess && pid.value != pid_;
    return status == kSuccess && !is_other ? State::fine : State::forgetful;
}

}  // namespace belvedere_ros
