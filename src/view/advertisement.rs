//! [`Advertiser`]: announces channels to Foxglove clients, which depends on the version of the protocol.
//!
//! In `foxglove.sdk.v1` and before it each channel contains its schema. In `foxglove.sdk.v1.1` schemas have numbers,
//! starting at 1 in each connection: an advertisement contains the schemas that the client does not have yet, and
//! channels refer to them by number.

use crate::recording::ros::RosStream;
use belvedere_bridge::Ros;
use serde_json::{Value, json};
use std::collections::BTreeMap;

const WITH_TABLE: &str = "foxglove.sdk.v1.1";
/// Names of the protocol, in order of preference.
pub(super) const SUBPROTOCOLS: [&str; 3] = [WITH_TABLE, "foxglove.sdk.v1", "foxglove.websocket.v1"];

/// Returns the preferred protocol among those in the client's header.
pub(super) fn common_protocol(offered: &str) -> Option<&'static str> {
    let offered: Vec<&str> = offered.split(',').map(str::trim).collect();
    SUBPROTOCOLS.into_iter().find(|known| offered.contains(known))
}

/// The schemas that were announced to a client.
pub(super) struct Advertiser {
    /// Numbers of the client's schemas by their names; `None` if each channel contains its schema.
    sent: Option<BTreeMap<&'static str, usize>>,
}

impl Advertiser {
    pub(super) fn new(protocol: &str) -> Self {
        Self { sent: (protocol == WITH_TABLE).then(BTreeMap::new) }
    }

    /// Returns the message that announces these channels, which are given with their numbers.
    pub(super) fn advertise<'a>(&mut self, came: impl Iterator<Item = (u32, &'a RosStream)>) -> Value {
        let mut schemas = Vec::new();
        let channels: Vec<Value> = came
            .map(|(id, RosStream { topic, message_type, .. })| {
                let (name, encoding) = (message_type.name, "ros1msg");
                let Some(sent) = &mut self.sent else {
                    return json!({
                        "id": id, "topic": topic, "encoding": "ros1",
                        "schemaName": name, "schema": message_type.definition(Ros::One), "schemaEncoding": encoding,
                    });
                };
                let next = sent.len() + 1;
                let schema = *sent.entry(name).or_insert_with(|| {
                    let data = message_type.definition(Ros::One);
                    schemas.push(json!({ "id": next, "name": name, "encoding": encoding, "data": data }));
                    next
                });
                json!({ "id": id, "topic": topic, "encoding": "ros1", "schemaId": schema })
            })
            .collect();
        if schemas.is_empty() {
            json!({ "op": "advertise", "channels": channels })
        } else {
            json!({ "op": "advertise", "schemas": schemas, "channels": channels })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_bridge::Kind;

    #[test]
    fn the_newest_common_protocol_is_chosen() {
        assert_eq!(common_protocol("foxglove.sdk.v1, foxglove.sdk.v1.1"), Some("foxglove.sdk.v1.1"));
        assert_eq!(common_protocol("foxglove.websocket.v1,foxglove.sdk.v1"), Some("foxglove.sdk.v1"));
        assert_eq!(common_protocol("foxglove.sdk.v1.2"), None);
    }

    #[test]
    fn a_schema_is_sent_once() {
        let stream = |kind, topic| RosStream::new(Ros::One, kind, topic, None).unwrap();
        let one = [stream(Kind::Image, "left"), stream(Kind::Image, "right"), stream(Kind::Odometry, "odom")];
        let mut advertiser = Advertiser::new("foxglove.sdk.v1.1");
        let message = advertiser.advertise((10..).zip(&one));
        let numbers = |message: &Value| -> Vec<u64> {
            message["channels"].as_array().unwrap().iter().map(|c| c["schemaId"].as_u64().unwrap()).collect()
        };
        assert_eq!(numbers(&message), [1, 1, 2]);
        let schemas = message["schemas"].as_array().unwrap();
        assert_eq!(schemas.len(), 2);
        assert_eq!((&schemas[1]["id"], &schemas[1]["name"]), (&json!(2), &json!("nav_msgs/Odometry")));
        assert!(schemas[1]["data"].as_str().unwrap().contains("child_frame_id"));
        assert!(message["channels"][0].get("schema").is_none());

        // Schemas that the client already has are only referred to.
        let other = [stream(Kind::Odometry, "b/odom"), stream(Kind::LaserScan, "scan")];
        let message = advertiser.advertise((20..).zip(&other));
        assert_eq!((numbers(&message), message["schemas"].as_array().unwrap().len()), (vec![2, 3], 1));
        let message = advertiser.advertise((30..).zip(&one));
        assert_eq!((numbers(&message), message.get("schemas")), (vec![1, 1, 2], None));
    }

    #[test]
    fn in_older_protocols_each_channel_contains_its_schema() {
        let odometry = RosStream::new(Ros::One, Kind::Odometry, "odom", None).unwrap();
        let message = Advertiser::new("foxglove.sdk.v1").advertise([(1, &odometry)].into_iter());
        assert_eq!(message["channels"][0]["schemaName"], "nav_msgs/Odometry");
        assert!(message.get("schemas").is_none() && message["channels"][0].get("schemaId").is_none());
    }
}
