//! [`Channels`]: the ROS topics that are offered to Foxglove clients for the streams of a domain.

use crate::recording::ros::RosStream;
use belvedere_bridge::{Ros, StreamInfo, StreamSpec};
use std::collections::{BTreeMap, BTreeSet};

/// A ROS topic, made from one stream or several, such as /tf of several robots.
pub(super) struct Channel {
    pub(super) id: u32,
    /// Topics of its streams, without a leading slash.
    pub(super) topics: BTreeSet<String>,
    pub(super) ros: RosStream,
}

/// All channels, by their ROS topics.
#[derive(Default)]
pub(super) struct Channels {
    known: BTreeMap<String, Channel>,
    last_id: u32,
}

/// Channels that were added or removed.
#[derive(Default)]
pub(super) struct Changes {
    pub(super) came: Vec<(u32, RosStream)>,
    pub(super) gone: Vec<u32>,
}

impl Channels {
    /// Updates the channels to these streams.
    pub(super) fn update(&mut self, streams: &[StreamInfo]) -> Changes {
        let mut now: BTreeMap<String, Vec<(&StreamInfo, RosStream)>> = BTreeMap::new();
        for stream in streams {
            if let Some(ros) = ros_stream(stream) {
                now.entry(ros.topic.clone()).or_default().push((stream, ros));
            }
        }
        let mut changes = Changes::default();
        self.known.retain(|topic, channel| {
            let stays = now.contains_key(topic);
            if !stays {
                changes.gone.push(channel.id);
            }
            stays
        });
        for (topic, streams) in now {
            let topics = followed(&streams);
            if let Some(channel) = self.known.get_mut(&topic) {
                channel.topics = topics;
            } else if let Some((_, ros)) = streams.into_iter().next() {
                self.last_id += 1;
                changes.came.push((self.last_id, ros.clone()));
                self.known.insert(topic, Channel { id: self.last_id, topics, ros });
            }
        }
        changes
    }

    /// Returns the channel with this number.
    pub(super) fn get(&self, id: u32) -> Option<&Channel> {
        self.known.values().find(|channel| channel.id == id)
    }
}

/// Returns the topics of a channel to subscribe to: those of streams with a publisher. A stream exists for as long as
/// it has subscribers, so the streams of a deleted robot would otherwise never disappear. If no stream has a publisher,
/// for example between two runs of the simulator, returns all of them.
fn followed(streams: &[(&StreamInfo, RosStream)]) -> BTreeSet<String> {
    let is_published = |stream: &StreamInfo| stream.publishers > 0;
    let are_all_idle = !streams.iter().any(|(stream, _)| is_published(stream));
    let followed = streams.iter().filter(|(stream, _)| are_all_idle || is_published(stream));
    followed.map(|(stream, _)| stream.topic.clone()).collect()
}

/// Returns the ROS topic of a stream, or `None` for commands to the robot or the simulation.
fn ros_stream(stream: &StreamInfo) -> Option<RosStream> {
    let kind = stream.kind?;
    let is_command = kind.is_robot_command() || stream.topic == StreamSpec::SIMULATION_COMMAND;
    (!is_command).then(|| RosStream::new(Ros::One, kind, &stream.topic, stream.layers)).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_bridge::Kind;

    fn stream(topic: &str, kind: Kind, publishers: usize) -> StreamInfo {
        StreamInfo {
            topic: topic.into(),
            kind: Some(kind),
            encoding: None,
            rate_hz: None,
            layers: None,
            frame_id: String::new(),
            publishers,
            subscribers: 0,
            max_payload_len: 0,
            history: 0,
        }
    }

    fn topics(channels: &Channels, id: u32) -> Vec<&str> {
        channels.get(id).unwrap().topics.iter().map(String::as_str).collect()
    }

    #[test]
    fn a_channel_has_the_streams_with_publishers() {
        let transforms = |topic: &str, publishers| stream(topic, Kind::Transforms, publishers);
        let mut channels = Channels::default();
        let changes =
            channels.update(&[transforms("one/tf", 1), stream("cmd_vel", Kind::VelocityCommand, 1)]);
        let [(id, ros)] = &changes.came[..] else { panic!("not one channel") };
        assert_eq!(ros.topic, "/tf");
        // A new robot's stream joins the same channel; a removed robot's stream remains while it has subscribers.
        let changes = channels.update(&[transforms("one/tf", 1), transforms("two/tf", 1)]);
        assert!(changes.came.is_empty() && changes.gone.is_empty());
        assert_eq!(topics(&channels, *id), ["one/tf", "two/tf"]);
        channels.update(&[transforms("one/tf", 0), transforms("two/tf", 1)]);
        assert_eq!(topics(&channels, *id), ["two/tf"]);
        // Between two runs of the simulator there are no publishers.
        channels.update(&[transforms("one/tf", 0), transforms("two/tf", 0)]);
        assert_eq!(topics(&channels, *id), ["one/tf", "two/tf"]);
        assert_eq!(channels.update(&[]).gone, [*id]);
        assert!(channels.get(*id).is_none());
    }
}
