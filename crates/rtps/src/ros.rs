//! What ROS 2 adds to DDS: names of topics and types, hashes of types, and which node has which readers and writers.

use crate::bytes::Append;
use crate::guid::Guid;

/// The topic on which participants say which nodes they have.
pub(crate) const GRAPH_TOPIC: &str = "ros_discovery_info";
pub(crate) const GRAPH_TYPE: &str = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";

/// A name of parts between slashes, each with letters, digits and _, of which the first is no digit.
pub(crate) fn is_name(name: &str) -> bool {
    let is_part = |part: &str| {
        !part.is_empty()
            && !part.starts_with(|first: char| first.is_ascii_digit())
            && part.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
    };
    name.len() <= 255 && name.split('/').all(is_part)
}

/// `/scan` is `rt/scan`.
pub(crate) fn topic(name: &str) -> String {
    format!("rt/{}", name.trim_start_matches('/'))
}

/// `sensor_msgs/msg/Image` is `sensor_msgs::msg::dds_::Image_`; `None` if it is not of this form.
pub(crate) fn type_name(name: &str) -> Option<String> {
    let mut parts = name.split('/');
    let (package, kind, name) = (parts.next()?, parts.next()?, parts.next()?);
    let fits = parts.next().is_none() && is_name(package) && is_name(kind) && is_name(name);
    fits.then(|| format!("{package}::{kind}::dds_::{name}_"))
}

/// The user data of a reader or writer.
pub(crate) fn user_data(hash: &str) -> Vec<u8> {
    if hash.is_empty() { Vec::new() } else { format!("typehash={hash};").into_bytes() }
}

/// The sample by which a participant says what its node has.
pub(crate) fn graph(
    participant: Guid,
    namespace: &str,
    node: &str,
    readers: &[Guid],
    writers: &[Guid],
) -> Vec<u8> {
    let mut payload = vec![0, 1, 0, 0];
    payload.extend_from_slice(&participant.bytes());
    payload.put_u32(1);
    payload.put_string(namespace);
    payload.pad();
    payload.put_string(node);
    for guids in [readers, writers] {
        payload.pad();
        payload.put_u32(guids.len() as u32);
        for guid in guids {
            payload.extend_from_slice(&guid.bytes());
        }
    }
    payload
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_rmw() {
        assert_eq!(topic("/camera/image_raw"), "rt/camera/image_raw");
        assert_eq!(type_name("sensor_msgs/msg/Image").as_deref(), Some("sensor_msgs::msg::dds_::Image_"));
        for bad in ["Image", "sensor_msgs/Image", "sensor_msgs/msg/", "a/b/c/d", ""] {
            assert_eq!(type_name(bad), None, "{bad}");
        }
    }
}
