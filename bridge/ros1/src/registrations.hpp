// The registrations of this node with the master.
#pragma once

namespace belvedere_ros {

/// Registers all publishers, subscribers and services of this process with the master again after a restart of roscore:
/// roscpp registers each only once. Existing connections are kept. Returns false if the master refuses or is gone
/// again.
bool register_again();

}  // namespace belvedere_ros
