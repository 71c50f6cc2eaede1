#include "registrations.hpp"

#include <ros/connection_manager.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/service_manager.h>
#include <ros/service_publication.h>
#include <ros/this_node.h>
#include <ros/xmlrpc_manager.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace belvedere_ros {

namespace {

using Value = XmlRpc::XmlRpcValue;

// The slave API lists a node's topics, but nothing lists its services: roscpp stores them in a private member, which an
// explicit instantiation may access. If the installed header has other members, this does not compile.
using Services = ros::L_ServicePublication ros::ServiceManager::*;
using Mutex = boost::mutex ros::ServiceManager::*;
std::pair<Services, Mutex> members();
template <Services services, Mutex mutex>
struct Reach {
    friend std::pair<Services, Mutex> members() { return {services, mutex}; }
};
template struct Reach<&ros::ServiceManager::service_publications_, &ros::ServiceManager::service_publications_mutex_>;

std::vector<std::string> own_services() {
    const auto [services, mutex] = members();
    ros::ServiceManager& manager = *ros::ServiceManager::instance();
    const boost::mutex::scoped_lock lock(manager.*mutex);
    std::vector<std::string> names;
    for (const ros::ServicePublicationPtr& service : manager.*services) names.push_back(service->getName());
    return names;
}

std::string own_uri() {
    return ros::XMLRPCManager::instance()->getServerURI();
}

/// Registers a topic or a service with the master.
bool enter(const char* method, const std::string& name, const std::string& what, Value& answer) {
    Value arguments, response;
    arguments[0] = ros::this_node::getName();
    arguments[1] = name;
    arguments[2] = what;
    arguments[3] = own_uri();
    return ros::master::execute(method, arguments, response, answer, false);
}

/// Calls the slave API of this node.
bool ask_self(const char* method, Value arguments, Value& answer) {
    std::string host;
    std::uint32_t port = 0;
    ros::network::splitURI(own_uri(), host, port);
    XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
    Value response;
    const bool answered = client.execute(method, arguments, response) && !client.isFault() &&
                          ros::XMLRPCManager::instance()->validateXmlrpcResponse(method, response, answer);
    client.close();
    return answered;
}

bool ask_self(const char* method, Value& answer) {
    Value arguments;
    arguments[0] = ros::this_node::getName();
    return ask_self(method, arguments, answer);
}

/// Returns the connected publishers of each topic, by the addresses of their nodes.
bool connected_publishers(std::map<std::string, std::set<std::string>>& publishers) {
    Value connections;
    if (!ask_self("getBusInfo", connections)) return false;
    for (int index = 0; index < connections.size(); ++index) {
        // A connection has a number, the address of the other node, direction, transport and topic.
        Value& connection = connections[index];
        if (static_cast<std::string>(connection[2]) == "i")
            publishers[static_cast<std::string>(connection[4])].insert(static_cast<std::string>(connection[1]));
    }
    return true;
}

/// Connects a subscriber to the publishers that the master lists. The list given to roscpp includes those that are
/// connected already: it disconnects from all others.
bool connect(const std::string& topic, Value& known, const std::set<std::string>& connected) {
    std::set<std::string> publishers = connected;
    for (int index = 0; index < known.size(); ++index)
        if (const std::string publisher = known[index]; publisher != own_uri()) publishers.insert(publisher);
    if (publishers == connected) return true;
    Value arguments, answer;
    arguments[0] = ros::this_node::getName();
    arguments[1] = topic;
    int index = 0;
    for (const std::string& publisher : publishers) arguments[2][index++] = publisher;
    return ask_self("publisherUpdate", arguments, answer);
}

}  // namespace

bool register_again() {
    std::map<std::string, std::set<std::string>> connected;
    Value publications, subscriptions, answer;
    if (!ask_self("getPublications", publications) || !ask_self("getSubscriptions", subscriptions) || !connected_publishers(connected))
        return false;
    for (int index = 0; index < publications.size(); ++index)
        if (!enter("registerPublisher", publications[index][0], publications[index][1], answer)) return false;
    for (int index = 0; index < subscriptions.size(); ++index) {
        const std::string topic = subscriptions[index][0];
        if (!enter("registerSubscriber", topic, subscriptions[index][1], answer) || !connect(topic, answer, connected[topic]))
            return false;
    }
    const std::string address = "rosrpc://" + ros::network::getHost() + ':' + std::to_string(ros::ConnectionManager::instance()->getTCPPort());
    const std::vector<std::string> services = own_services();
    return std::all_of(services.begin(), services.end(),
                       [&](const std::string& service) { return enter("registerService", service, address, answer); });
}

}  // namespace belvedere_ros
