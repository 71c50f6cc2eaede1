//! Channels: the topics of ROS that the streams of a domain make for Foxglove's clients.

use crate::recording::ros1::RosStream;
use belvedere_bridge::{Kind, StreamInfo, StreamSpec};
use std::collections::{BTreeMap, BTreeSet};

/// A topic of ROS: of one stream, or of several, as /tf of several robots.
pub(super) struct Channel {
    pub(super) id: u32,
    /// Of streams, without a leading slash.
    pub(super) topics: BTreeSet<String>,
    pub(super) ros: RosStream,
}

/// The channels that there are, by their topics of ROS.
#[derive(Default)]
pub(super) struct Channels {
    known: BTreeMap<String, Channel>,
    last_id: u32,
}

/// What has become of channels.
#[derive(Default)]
pub(super) struct Changes {
    pub(super) came: Vec<(u32, RosStream)>,
    pub(super) gone: Vec<u32>,
}

impl Channels {
    /// Takes the streams that there are now.
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

    /// The channel of this number.
    pub(super) fn get(&self, id: u32) -> Option<&Channel> {
        self.known.values().find(|channel| channel.id == id)
    }
}

/// The streams of a channel that are to be followed: those that are published. A stream stays for as long as it has
/// subscribers, so those of a robot that was deleted would never go. If none is published, as between two runs of the
/// simulator, it is all of them.
fn followed(streams: &[(&StreamInfo, RosStream)]) -> BTreeSet<String> {
    let is_published = |stream: &StreamInfo| stream.publishers > 0;
    let are_all_idle = !streams.iter().any(|(stream, _)| is_published(stream));
    let followed = streams.iter().filter(|(stream, _)| are_all_idle || is_published(stream));
    followed.map(|(stream, _)| stream.topic.clone()).collect()
}

/// What a stream is for ROS; none for those that lead to the robot.
fn ros_stream(stream: &StreamInfo) -> Option<RosStream> {
    let kind = stream.kind?;
    let is_command = matches!(kind, Kind::VelocityCommand | Kind::ResetOdometry | Kind::MotorPower);
    let is_ours = stream.topic == StreamSpec::SIMULATION_COMMAND;
    (!is_command && !is_ours).then(|| RosStream::new(kind, &stream.topic, stream.layers)).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn a_channel_has_the_streams_that_are_published() {
        let transforms = |topic: &str, publishers| stream(topic, Kind::Transforms, publishers);
        let mut channels = Channels::default();
        let changes =
            channels.update(&[transforms("one/tf", 1), stream("cmd_vel", Kind::VelocityCommand, 1)]);
        let [(id, ros)] = &changes.came[..] else { panic!("not one channel") };
        assert_eq!(ros.topic, "/tf");
        // A robot that comes is of the same channel; one that goes leaves its stream to who follows it.
        let changes = channels.update(&[transforms("one/tf", 1), transforms("two/tf", 1)]);
        assert!(changes.came.is_empty() && changes.gone.is_empty());
        assert_eq!(topics(&channels, *id), ["one/tf", "two/tf"]);
        channels.update(&[transforms("one/tf", 0), transforms("two/tf", 1)]);
        assert_eq!(topics(&channels, *id), ["two/tf"]);
        // Between two runs of the simulator none is published.
        channels.update(&[transforms("one/tf", 0), transforms("two/tf", 0)]);
        assert_eq!(topics(&channels, *id), ["one/tf", "two/tf"]);
        assert_eq!(channels.update(&[]).gone, [*id]);
        assert!(channels.get(*id).is_none());
    }
}
