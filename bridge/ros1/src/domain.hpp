// Membership of a domain, shared by the threads of the bridge.
#pragma once

#include <belvedere.hpp>

#include <mutex>
#include <string>
#include <vector>

namespace belvedere_ros {

/// A belvedere::Node that several threads may use.
class Domain {
public:
    /// Joins a domain. An empty name selects that of BELVEDERE_DOMAIN, or "default". Throws belvedere::Error for an
    /// unusable name.
    explicit Domain(const std::string& name);

    const std::string& name() const { return name_; }
    std::vector<bv_stream_info> streams();
    belvedere::Subscriber subscribe(const std::string& topic);
    belvedere::Control control();
    template <class Command>
    belvedere::CommandPublisher<Command> commands(const std::string& topic) {
        const std::lock_guard<std::mutex> lock(mutex_);
        return node_.commands<Command>(topic);
    }

private:
    std::string name_;
    std::mutex mutex_;
    belvedere::Node node_;
};

}  // namespace belvedere_ros
