// The master (roscore): waiting for it, and noticing that it was started again.
#pragma once

namespace belvedere_ros {

class Master {
public:
    enum class State {
        /// It answers and knows this node, or nothing is known yet.
        fine,
        /// It does not answer.
        gone,
        /// It answers, and has never heard of this node: it was started again.
        forgetful,
    };

    /// Whether it answers.
    static bool answers();
    /// Asks it about this node.
    State look() const;
};

}  // namespace belvedere_ros
