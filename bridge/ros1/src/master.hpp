// The master (roscore): waiting for it, and noticing that it was started again.
#pragma once

#include <string>

namespace belvedere_ros {

/// Asked directly, not through roscpp, which would wait inside ros::init when there is none.
class Master {
public:
    enum class State {
        /// It answers, and knows the node.
        fine,
        /// It does not answer.
        gone,
        /// It answers, and has never heard of the node: it was started again.
        forgetful,
    };

    /// That of __master:=URI, else of ROS_MASTER_URI, else the one on this machine.
    Master(int argc, char** argv);

    const std::string& uri() const { return uri_; }
    bool answers() const;
    /// Asks it about a node that is registered there.
    State look(const std::string& node) const;

private:
    /// Its answer's status: 1 is success. Nothing answered: negative.
    int ask(const char* method, const std::string& argument) const;

    std::string uri_;
};

}  // namespace belvedere_ros
