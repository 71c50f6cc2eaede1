// Values on the parameter server, read and checked.
#pragma once

#include <ros/node_handle.h>

#include <functional>
#include <map>
#include <stdexcept>
#include <string>

namespace belvedere_ros {

/// A parameter that cannot be what it is; its text names it, its value and what it may be.
class BadParameter : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// How parameters are read, by name; what a reader throws is a BadParameter of the kind of value that is expected.
using Readers = std::map<std::string, std::function<void(XmlRpc::XmlRpcValue&)>>;

/// Reads those that are set in the namespace of `nh`. Throws BadParameter.
void read_all(const ros::NodeHandle& nh, const Readers& readers);

std::string to_text(XmlRpc::XmlRpcValue& value);
bool to_bool(XmlRpc::XmlRpcValue& value);
/// Finite; whole or not.
double to_number(XmlRpc::XmlRpcValue& value);

}  // namespace belvedere_ros
