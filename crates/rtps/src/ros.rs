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

/// The topics of requests and replies of the service `/belvedere/get_parameters`:
/// `rq/belvedere/get_parametersRequest` and `rr/belvedere/get_parametersReply`.
pub(crate) fn service_topics(name: &str) -> [String; 2] {
    let name = name.trim_start_matches('/');
    [format!("rq/{name}Request"), format!("rr/{name}Reply")]
}

/// The types of requests and replies of the service `rcl_interfaces/srv/GetParameters`; `None` if it is not of this
/// form.
pub(crate) fn service_types(name: &str) -> Option<[String; 2]> {
    let parts = type_name(name)?;
    Some([format!("{parts}Request_"), format!("{parts}Response_")])
}

/// A sample whose length is a multiple of four, as numbers that follow it in a datagram are read where they are aligned.
/// The header says how many bytes do not count.
pub(crate) fn padded(mut sample: Vec<u8>) -> Vec<u8> {
    let padding = sample.len().next_multiple_of(4) - sample.len();
    sample.resize(sample.len() + padding, 0);
    if let Some(options) = sample.get_mut(3) {
        *options |= padding as u8;
    }
    sample
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
        let name = "rcl_interfaces::srv::dds_::GetParameters";
        let types = [format!("{name}_Request_"), format!("{name}_Response_")];
        assert_eq!(service_types("rcl_interfaces/srv/GetParameters"), Some(types));
        let topics = ["rq/belvedere/get_parametersRequest", "rr/belvedere/get_parametersReply"];
        assert_eq!(service_topics("/belvedere/get_parameters"), topics);
    }
}
