// What this node has registered with the master.
#pragma once

namespace belvedere_ros {

/// Registers all publishers, subscribers and services of this process with the master, as it is needed after roscore was
/// started again: roscpp registers each with the master of its beginning only. Connections that exist are kept. False if
/// the master does not take them, as one that has gone again.
bool register_again();

}  // namespace belvedere_ros
