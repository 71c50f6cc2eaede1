// The master (roscore): waiting for it, and detecting a restart.
#pragma once

#include <string>

namespace belvedere_ros {

/// A client of the master's API, independent of roscpp, which would block in ros::init without a master.
class Master {
public:
    enum class State {
        /// It answers, and lists the node.
        fine,
        /// It does not answer.
        gone,
        /// It answers but was restarted, so earlier registrations are lost.
        forgetful,
    };

    /// Uses the master of __master:=URI, or of ROS_MASTER_URI, or the one on this machine.
    Master(int argc, char** argv);

    const std::string& uri() const { return uri_; }
    /// Returns true if the master answers, and remembers its pid.
    bool answers();
    /// Checks a registered node.
    State look(const std::string& node) const;

private:
    /// An answer of the master: a status, where 1 is success, a text, and the requested value.
    struct Answer {
        /// Negative if there was no answer.
        int status;
        /// The value if it is a number, else 0.
        int value;
    };
    Answer ask(const char* method, const std::string& argument) const;

    std::string uri_;
    /// Process id of the master that answered first.
    int pid_ = 0;
};

}  // namespace belvedere_ros
