#include "parameter_readers.hpp"

#include <cmath>
#include <sstream>

namespace belvedere_ros {

using Value = XmlRpc::XmlRpcValue;

namespace {

std::string text_of(const Value& value) {
    std::ostringstream text;
    text << value;
    return text.str();
}

}  // namespace

// The command line converts a name of digits to a number.
std::string to_text(Value& value) {
    if (value.getType() == Value::TypeInt) return std::to_string(static_cast<int>(value));
    if (value.getType() != Value::TypeString) throw BadParameter("text");
    return static_cast<std::string>(value);
}

bool to_bool(Value& value) {
    if (value.getType() != Value::TypeBoolean) throw BadParameter("true or false");
    return static_cast<bool>(value);
}

double to_number(Value& value) {
    const double number = value.getType() == Value::TypeInt      ? static_cast<int>(value)
                          : value.getType() == Value::TypeDouble ? static_cast<double>(value)
                                                                 : std::nan("");
    if (!std::isfinite(number)) throw BadParameter("a number");
    return number;
}

void read_all(const ros::NodeHandle& nh, const Readers& readers) {
    for (const auto& [name, reader] : readers) {
        Value value;
        if (!nh.getParam(name, value)) continue;
        try {
            reader(value);
        } catch (const BadParameter& expected) {
            throw BadParameter(nh.resolveName(name) + " is " + text_of(value) + "; it must be " + expected.what());
        }
    }
}

}  // namespace belvedere_ros
