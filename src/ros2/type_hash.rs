//! Hashes of types, by which nodes of ROS 2 see that they mean the same message.
//!
//! The hash of a type (RIHS01) is the SHA-256 of its description in JSON: names and types of its fields, then those of
//! every type it contains, by name.

use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Returns the hash of the type `name`, such as `sensor_msgs/msg/Image`, with this definition in the form of `ros2msg`.
pub(super) fn type_hash(name: &str, definition: &str) -> String {
    let line = format!("\n{}\nMSG: ", "=".repeat(80));
    let mut sections = definition.split(&line);
    let own = sections.next().unwrap_or_default();
    let parts: BTreeMap<String, &str> =
        sections.filter_map(|part| part.split_once('\n')).map(|(name, own)| (full_name(name), own)).collect();
    let mut text =
        format!("{{\"type_description\": {}, \"referenced_type_descriptions\": [", describe(name, own));
    for (index, (name, own)) in parts.iter().enumerate() {
        let comma = if index > 0 { ", " } else { "" };
        let _ = write!(text, "{comma}{}", describe(name, own));
    }
    text.push_str("]}");
    let digest = Sha256::digest(text);
    digest.iter().fold("RIHS01_".to_owned(), |hash, byte| format!("{hash}{byte:02x}"))
}

/// `std_msgs/Header` is `std_msgs/msg/Header`.
fn full_name(name: &str) -> String {
    name.split_once('/').map_or_else(|| name.to_owned(), |(package, name)| format!("{package}/msg/{name}"))
}

/// Returns the description of one type, without those of the types that it contains.
fn describe(name: &str, definition: &str) -> String {
    let lines = definition.lines().map(|line| line.split('#').next().unwrap_or_default().trim());
    let mut fields: Vec<String> = lines
        .filter(|line| !line.contains('='))
        .filter_map(|line| line.split_once(' '))
        .map(|(of, name)| field(of, name.trim()))
        .collect();
    if fields.is_empty() {
        fields.push(field("uint8", "structure_needs_at_least_one_member"));
    }
    format!("{{\"type_name\": \"{name}\", \"fields\": [{}]}}", fields.join(", "))
}

/// Returns the description of a field of the type `of`.
fn field(of: &str, name: &str) -> String {
    /// Added to the number of a type for an array of fixed length, and for one of any length.
    const ARRAYS: [u32; 2] = [48, 144];
    let (element, array, capacity) = match of.strip_suffix(']').and_then(|of| of.split_once('[')) {
        None => (of, 0, "0"),
        Some((element, "")) => (element, ARRAYS[1], "0"),
        Some((element, count)) => (element, ARRAYS[0], count),
    };
    let known = number(element);
    let nested = if known.is_none() { full_name(element) } else { String::new() };
    format!(
        "{{\"name\": \"{name}\", \"type\": {{\"type_id\": {}, \"capacity\": {capacity}, \"string_capacity\": 0, \
         \"nested_type_name\": \"{nested}\"}}}}",
        known.unwrap_or(1) + array,
    )
}

/// Returns the number of a type that is not a message.
fn number(of: &str) -> Option<u32> {
    let number = match of {
        "int8" => 2,
        "uint8" => 3,
        "int16" => 4,
        "uint16" => 5,
        "int32" => 6,
        "uint32" => 7,
        "int64" => 8,
        "uint64" => 9,
        "float32" => 10,
        "float64" => 11,
        "bool" => 15,
        "string" => 17,
        _ => return None,
    };
    Some(number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::ros::RosStream;
    use belvedere_bridge::{Kind, Ros};

    /// The hashes are those of Jazzy's packages.
    #[test]
    fn types_have_the_hashes_of_ros2() {
        for (kind, topic, name, hash) in [
            (
                Kind::Image,
                "image",
                "sensor_msgs/msg/Image",
                "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47",
            ),
            (
                Kind::PointCloud,
                "points",
                "sensor_msgs/msg/PointCloud2",
                "9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5",
            ),
            (
                Kind::VelocityCommand,
                "cmd_vel",
                "geometry_msgs/msg/Twist",
                "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a",
            ),
        ] {
            let stream = RosStream::new(Ros::Two, kind, topic, None).unwrap();
            let definition = stream.message_type.definition(Ros::Two);
            assert_eq!(Ros::Two.type_name(stream.message_type.name), name);
            assert_eq!(type_hash(name, &definition), format!("RIHS01_{hash}"), "{definition}");
        }
        let string = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18";
        assert_eq!(type_hash("std_msgs/msg/String", "string data"), string);
    }
}
