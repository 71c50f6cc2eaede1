#include "domain.hpp"

#include <cstdlib>

namespace belvedere_ros {

namespace {

std::string or_of_environment(const std::string& name) {
    if (!name.empty()) return name;
    const char* of_environment = std::getenv("BELVEDERE_DOMAIN");
    return of_environment != nullptr && *of_environment != '\0' ? of_environment : "default";
}

}  // namespace

Domain::Domain(const std::string& name) : name_(or_of_environment(name)), node_(name_, "belvedere_ros") {}

std::vector<bv_stream_info> Domain::streams() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return node_.streams();
}

belvedere::Subscriber Domain::subscribe(const std::string& topic) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return node_.subscribe(topic);
}

belvedere::Control Domain::control() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return node_.control();
}

}  // namespace belvedere_ros
