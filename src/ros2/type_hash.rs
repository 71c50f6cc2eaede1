//! Hashes of types, by which nodes of ROS 2 see that they mean the same message.
//!
//! The hash of a type (RIHS01) is the SHA-256 of its description in JSON: names and types of its fields, then those of
//! every type it contains, by name.

use belvedere_bridge::RosPrimitive;
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Returns the hash of the type `name`, such as `sensor_msgs/msg/Image`, with this definition in the form of `ros2msg`.
pub(super) fn type_hash(name: &str, definition: &str) -> String {
    let line = format!("\n{}\nMSG: ", "=".repeat(80));
    let mut sections = definition.split(&line);
    let own = sections.next().unwrap_or_default();
    let parts = sections
        .filter_map(|part| part.split_once('\n'))
        .map(|(name, own)| (full_name(name), own.to_owned()));
    hash(name, own, &parts.collect())
}

/// Returns the hash of a message that contains messages of this table of names and definitions. Every message that a
/// definition contains has its package before its name, such as `builtin_interfaces/Time`.
pub(super) fn message_hash(name: &str, definition: &str, messages: &[(&str, &str)]) -> String {
    let mut parts = BTreeMap::new();
    collect(definition, messages, &mut parts);
    hash(name, definition, &parts)
}

/// Returns the hash of a service, such as `rcl_interfaces/srv/GetParameters`. Its definition has the request, a line
/// `---` and the response, with the packages of messages as for [`message_hash`].
pub(super) fn service_hash(name: &str, definition: &str, messages: &[(&str, &str)]) -> String {
    // A service without a request begins with the line.
    let (request, response) = definition.trim_start().split_once("---").unwrap_or_default();
    let [requested, responded, event] = ["Request", "Response", "Event"].map(|part| format!("{name}_{part}"));
    let told = format!("{EVENT_INFO} info\n{requested}[<=1] request\n{responded}[<=1] response");
    let own = format!("{requested} request_message\n{responded} response_message\n{event} event_message");
    let mut parts = BTreeMap::new();
    for (name, definition) in [(&requested, request), (&responded, response), (&event, &told)] {
        collect(definition, messages, &mut parts);
        parts.insert(name.clone(), definition.to_owned());
    }
    parts.insert(full_name(EVENT_INFO), EVENT_INFO_FIELDS.to_owned());
    parts.insert(full_name("builtin_interfaces/Time"), TIME.to_owned());
    hash(name, &own, &parts)
}

/// What every service says of an event, if its introspection is on.
const EVENT_INFO: &str = "service_msgs/ServiceEventInfo";
const EVENT_INFO_FIELDS: &str =
    "uint8 event_type\nbuiltin_interfaces/Time stamp\nuint8[16] client_gid\nint64 sequence_number";
const TIME: &str = "int32 sec\nuint32 nanosec";

/// Adds the messages of the table that a definition contains, and those that they contain.
fn collect(definition: &str, messages: &[(&str, &str)], parts: &mut BTreeMap<String, String>) {
    for (of, _) in fields(definition) {
        let name = full_name(of.split('[').next().unwrap_or_default());
        let found = messages.iter().find(|(known, _)| full_name(known) == name);
        if let Some((_, own)) = found.filter(|_| !parts.contains_key(&name)) {
            parts.insert(name, (*own).to_owned());
            collect(own, messages, parts);
        }
    }
}

/// Returns the hash of a type with this definition, and the definitions of all types that it contains.
fn hash(name: &str, definition: &str, parts: &BTreeMap<String, String>) -> String {
    let mut text = format!(
        "{{\"type_description\": {}, \"referenced_type_descriptions\": [",
        describe(name, definition)
    );
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
    match name.split_once('/') {
        Some((package, name)) if !name.contains('/') => format!("{package}/msg/{name}"),
        _ => name.to_owned(),
    }
}

/// Returns the types and names of the fields of a definition, without constants.
fn fields(definition: &str) -> impl Iterator<Item = (&str, &str)> {
    let lines = definition.lines().map(|line| line.split('#').next().unwrap_or_default().trim());
    // A sequence of limited length has "<=" in its type.
    lines.filter(|line| !line.replace("<=", "").contains('=')).filter_map(|line| {
        let mut words = line.split_whitespace();
        words.next().zip(words.next())
    })
}

/// Returns the description of one type, without those of the types that it contains.
fn describe(name: &str, definition: &str) -> String {
    let mut fields: Vec<String> = fields(definition).map(|(of, name)| field(of, name)).collect();
    if fields.is_empty() {
        fields.push(field("uint8", "structure_needs_at_least_one_member"));
    }
    format!("{{\"type_name\": \"{name}\", \"fields\": [{}]}}", fields.join(", "))
}

/// Returns the description of a field of the type `of`.
fn field(of: &str, name: &str) -> String {
    /// Added to the number of a type for an array of fixed length, one of limited length, and one of any length.
    const ARRAYS: [u32; 3] = [48, 96, 144];
    let (element, array, capacity) = match of.strip_suffix(']').and_then(|of| of.split_once('[')) {
        None => (of, 0, "0"),
        Some((element, "")) => (element, ARRAYS[2], "0"),
        Some((element, count)) => match count.strip_prefix("<=") {
            Some(most) => (element, ARRAYS[1], most),
            None => (element, ARRAYS[0], count),
        },
    };
    let known = RosPrimitive::of_word(element).map(RosPrimitive::number);
    let nested = if known.is_none() { full_name(element) } else { String::new() };
    format!(
        "{{\"name\": \"{name}\", \"type\": {{\"type_id\": {}, \"capacity\": {capacity}, \"string_capacity\": 0, \
         \"nested_type_name\": \"{nested}\"}}}}",
        known.unwrap_or(1) + array,
    )
}

#[cfg(test)]
mod tests {
    use super::super::rcl_interfaces::{MESSAGES, PARAMETER_EVENT, SERVICES};
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
            // That of vision_msgs 4.1.
            (
                Kind::BoundingBoxes,
                "image_raw/truth/boxes",
                "vision_msgs/msg/Detection2DArray",
                "214274120007f4a683866481336b70310268cfa107aebe9d594a6acf75bda968",
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
        assert_eq!(
            message_hash("rcl_interfaces/msg/ParameterEvent", PARAMETER_EVENT, MESSAGES),
            "RIHS01_043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204"
        );
        let string = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18";
        assert_eq!(type_hash("std_msgs/msg/String", "string data"), string);
    }

    /// The hashes are those of Jazzy's packages.
    #[test]
    fn services_have_the_hashes_of_ros2() {
        let hashes = [
            "3e6062bfbb27bfb8730d4cef2558221f51a11646d78e7bb30a1e83afac3aad9d",
            "bf9803d5c74cf989a5de3e0c2e99444599a627c7ff75f97b8c05b01003675cbc",
            "da199c878688b3e530bdfe3ca8f74cb9fa0c303101e980a9e8f260e25e1c80ca",
            "845b484d71eb0673dae682f2e3ba3c4851a65a3dcfb97bddd82c5b57e91e4cff",
            "56eed9a67e169f9cb6c1f987bc88f868c14a8fc9f743a263bc734c154015d7e0",
            "0e192ef259c07fc3c07a13191d27002222e65e00ccec653ca05e856f79285fcd",
        ];
        for (of, hash) in SERVICES.iter().zip(hashes) {
            let found = service_hash(of.service, of.definition, MESSAGES);
            assert_eq!(found, format!("RIHS01_{hash}"), "{}", of.service);
        }
    }
}
