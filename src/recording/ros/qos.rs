//! The quality of service with which a topic of ROS 2 is offered, as `ros2 bag` stores it with a channel.

/// Returns the profile of a topic in the YAML of rosbag2: reliable, the last ten messages, and for `/tf_static` also
/// for subscribers that come later. Policies are numbers, as before version 9 of rosbag2's metadata; all versions read
/// them if the file says so ([`OLD_METADATA`]).
pub(crate) fn offered_qos_profiles(topic: &str) -> String {
    // 1 is transient local, 2 is volatile.
    let durability = if topic == "/tf_static" { 1 } else { 2 };
    // Durations without a limit.
    let [deadline, lifespan, lease] = ["deadline", "lifespan", "liveliness_lease_duration"]
        .map(|name| format!("  {name}:\n    sec: 9223372036\n    nsec: 854775807\n"));
    format!(
        "- history: 1\n  depth: 10\n  reliability: 1\n  durability: {durability}\n{deadline}{lifespan}  liveliness: \
         1\n{lease}  avoid_ros_namespace_conventions: false"
    )
}

/// Name, key and value of a metadata record. Since Jazzy, `ros2 bag` takes the policies of a file with this record for
/// numbers, and otherwise for words.
pub(crate) const OLD_METADATA: [&str; 3] = ["rosbag2", "serialized_metadata", ""];
