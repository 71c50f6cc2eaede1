//! Participants that talk with each other over the sockets of this machine. `.ci/rtps` has the tests with ROS 2.

mod datagrams;
mod participants;
