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
        /// It answers, and was started again: it does not know what was registered with the one before.
        forgetful,
    };

    /// That of __master:=URI, else of ROS_MASTER_URI, else the one on this machine.
    Master(int argc, char** argv);

    const std::string& uri() const { return uri_; }
    /// Remembers which one it is.
    bool answers();
    /// Asks it about a node that is registered there.
    State look(const std::string& node) const;

private:
    /// What it answers: a status, 1 is success, a text, and the value that was asked for.
    struct Answer {
        /// Nothing answered: negative.
        int status;
        /// If it is a number; 0 otherwise.
        int value;
    };
    Answer ask(const char* method, const std::string& argument) const;

    std::string uri_;
    /// Process of the master that answered first.
    int pid_ = 0;
};

}  // namespace belvedere_ros
