// Reading and checking of values on the parameter server.
#pragma once

#include <ros/node_handle.h>

#include <functional>
#include <map>
#include <stdexcept>
#include <string>

namespace belvedere_ros {

/// The error for an invalid parameter, with its name, its value and the valid values.
class BadParameter : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Readers of parameters by name. A reader throws BadParameter with the expected kind of value.
using Readers = std::map<std::string, std::function<void(XmlRpc::XmlRpcValue&)>>;

/// Reads the parameters that are set in the namespace of `nh`. Throws BadParameter.
void read_all(const ros::NodeHandle& nh, const Readers& readers);

std::string to_text(XmlRpc::XmlRpcValue& value);
bool to_bool(XmlRpc::XmlRpcValue& value);
/// Reads a finite number, integer or not.
double to_number(XmlRpc::XmlRpcValue& value);

}  // namespace belvedere_ros
