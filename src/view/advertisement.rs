//! How channels are made known to Foxglove's clients, in which the versions of the protocol differ.
//!
//! In `foxglove.sdk.v1` and before it each channel brings its schema. In `foxglove.sdk.v1.1` schemas have numbers, from 1 for
//! each connection; an advertisement brings those that the client has not been sent before, and channels name the number.

use crate::recording::ros1::RosStream;
use serde_json::{Value, json};
use std::collections::BTreeMap;

const WITH_TABLE: &str = "foxglove.sdk.v1.1";
/// Names of the protocol, the one that is preferred first.
pub(super) const SUBPROTOCOLS: [&str; 3] = [WITH_TABLE, "foxglove.sdk.v1", "foxglove.websocket.v1"];

/// The name that a client and this server have in common, by the header in which it names its own.
pub(super) fn common_protocol(offered: &str) -> Option<&'static str> {
    let offered: Vec<&str> = offered.split(',').map(str::trim).collect();
    SUBPROTOCOLS.into_iter().find(|known| offered.contains(known))
}

/// What a client has been told of channels.
pub(super) struct Advertiser {
    /// Numbers of the schemas that it has, by their names; none if channels bring their own.
    sent: Option<BTreeMap<&'static str, usize>>,
}

impl Advertiser {
    pub(super) fn new(protocol: &str) -> Self {
        Self { sent: (protocol == WITH_TABLE).then(BTreeMap::new) }
    }

    /// The message that makes channels known, by their numbers.
    pub(super) fn advertise<'a>(&mut self, came: impl Iterator<Item = (u32, &'a RosStream)>) -> Value {
        let mut schemas = Vec::new();
        let channels: Vec<Value> = came
            .map(|(id, RosStream { topic, message_type, .. })| {
                let (name, encoding) = (message_type.name, "ros1msg");
                let Some(sent) = &mut self.sent else {
                    return json!({
                        "id": id, "topic": topic, "encoding": "ros1",
                        "schemaName": name, "schema": message_type.definition(), "schemaEncoding": encoding,
                    });
                };
                let next = sent.len() + 1;
                let schema = *sent.entry(name).or_insert_with(|| {
                    let data = message_type.definition();
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
    fn the_newest_common_name_is_taken() {
        assert_eq!(common_protocol("foxglove.sdk.v1, foxglove.sdk.v1.1"), Some("foxglove.sdk.v1.1"));
        assert_eq!(common_protocol("foxglove.websocket.v1,foxglove.sdk.v1"), Some("foxglove.sdk.v1"));
        assert_eq!(common_protocol("foxglove.sdk.v1.2"), None);
    }

    #[test]
    fn a_schema_is_sent_once() {
        let stream = |kind, topic| RosStream::new(kind, topic, None).unwrap();
        let one = [stream(Kind::Image, "left"), stream(Kind::Image, "right"), stream(Kind::Odometry, "odom")];
        let mut advertiser = Advertiser::new("foxglove.sdk.v1.1");
        let told = advertiser.advertise((10..).zip(&one));
        let numbers = |told: &Value| -> Vec<u64> {
            told["channels"].as_array().unwrap().iter().map(|c| c["schemaId"].as_u64().unwrap()).collect()
        };
        assert_eq!(numbers(&told), [1, 1, 2]);
        let schemas = told["schemas"].as_array().unwrap();
        assert_eq!(schemas.len(), 2);
        assert_eq!((&schemas[1]["id"], &schemas[1]["name"]), (&json!(2), &json!("nav_msgs/Odometry")));
        assert!(schemas[1]["data"].as_str().unwrap().contains("child_frame_id"));
        assert!(told["channels"][0].get("schema").is_none());

        // What the client has already is only named.
        let other = [stream(Kind::Odometry, "b/odom"), stream(Kind::LaserScan, "scan")];
        let told = advertiser.advertise((20..).zip(&other));
        assert_eq!((numbers(&told), told["schemas"].as_array().unwrap().len()), (vec![2, 3], 1));
        let told = advertiser.advertise((30..).zip(&one));
        assert_eq!((numbers(&told), told.get("schemas")), (vec![1, 1, 2], None));
    }

    #[test]
    fn before_there_was_a_table_each_channel_has_its_own() {
        let odometry = RosStream::new(Kind::Odometry, "odom", None).unwrap();
        let told = Advertiser::new("foxglove.sdk.v1").advertise([(1, &odometry)].into_iter());
        assert_eq!(told["channels"][0]["schemaName"], "nav_msgs/Odometry");
        assert!(told.get("schemas").is_none() && told["channels"][0].get("schemaId").is_none());
    }
}
