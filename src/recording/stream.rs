//! [`RecordedStream`]: the description of a stream in a recording, with which a replay opens it again.

use belvedere_bridge::{Encoding, Kind, StreamInfo, StreamSpec};
use std::collections::BTreeMap;

/// A stream of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedStream {
    /// The topic, without a leading slash.
    pub topic: String,
    /// Kind of its frames.
    pub kind: Kind,
    /// Encoding of its frames.
    pub encoding: Encoding,
    /// Coordinate frame of the data.
    pub frame_id: String,
    /// Intended rate, frames per second.
    pub rate_hz: Option<f64>,
    /// Number of a lidar's layers.
    pub layers: Option<u32>,
    /// Largest payload in bytes; 0 if that was not known.
    pub max_payload_len: usize,
}

/// Streams that are not recorded: commands to the simulator and its results. They concern the recorded run, and a
/// replay has its own.
const LEFT_OUT: [Kind; 2] = [Kind::SimulationCommand, Kind::SimulationResult];

impl RecordedStream {
    /// Describes a stream of a domain. Returns `None` if it is not recorded, or of a kind that this version does not
    /// know.
    pub fn new(info: &StreamInfo) -> Option<Self> {
        let (kind, encoding) = (info.kind?, info.encoding?);
        (!LEFT_OUT.contains(&kind)).then(|| Self {
            topic: info.topic.clone(),
            kind,
            encoding,
            frame_id: info.frame_id.clone(),
            rate_hz: info.rate_hz,
            layers: info.layers,
            max_payload_len: info.max_payload_len,
        })
    }

    /// Converts the description to the fields of a metadata record.
    pub(super) fn to_metadata(&self) -> BTreeMap<String, String> {
        let mut words = BTreeMap::from([
            ("topic", self.topic.clone()),
            ("kind", self.kind.to_string()),
            ("encoding", self.encoding.to_string()),
            ("frame_id", self.frame_id.clone()),
            ("max_payload_len", self.max_payload_len.to_string()),
        ]);
        if let Some(rate_hz) = self.rate_hz {
            words.insert("rate_hz", rate_hz.to_string());
        }
        if let Some(layers) = self.layers {
            words.insert("layers", layers.to_string());
        }
        words.into_iter().map(|(name, word)| (name.to_owned(), word)).collect()
    }

    /// Converts a metadata record back. Returns `None` if a field is missing or wrong.
    pub(super) fn from_metadata(words: &BTreeMap<String, String>) -> Option<Self> {
        Some(Self {
            topic: words.get("topic")?.clone(),
            kind: words.get("kind")?.parse().ok()?,
            encoding: words.get("encoding")?.parse().ok()?,
            frame_id: words.get("frame_id")?.clone(),
            rate_hz: words.get("rate_hz").map(|word| word.parse()).transpose().ok()?,
            layers: words.get("layers").map(|word| word.parse()).transpose().ok()?,
            max_payload_len: words.get("max_payload_len")?.parse().ok()?,
        })
    }

    /// Returns the specification with which a replay opens the stream.
    pub(super) fn spec(&self) -> StreamSpec {
        let spec = if self.kind.is_robot_command() {
            StreamSpec::command(&self.topic, self.kind)
        } else if self.encoding == Encoding::Struct {
            StreamSpec::structs(&self.topic, self.kind, 1)
        } else {
            StreamSpec::new(&self.topic, self.kind, self.encoding, 0)
        };
        let max_payload_len = spec.max_payload_len.max(self.max_payload_len);
        let (frame_id, rate_hz, layers) = (self.frame_id.clone(), self.rate_hz, self.layers);
        StreamSpec { frame_id, rate_hz, layers, max_payload_len, ..spec }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metadata_are_read_back_unchanged() {
        let full = RecordedStream {
            topic: "robot1/scan".into(),
            kind: Kind::LaserScan,
            encoding: Encoding::RangesF32,
            frame_id: "robot1/laser".into(),
            rate_hz: Some(1.0 / 3.0),
            layers: Some(16),
            max_payload_len: 720 * 4,
        };
        let bare = RecordedStream { rate_hz: None, layers: None, frame_id: String::new(), ..full.clone() };
        for stream in [full, bare] {
            assert_eq!(RecordedStream::from_metadata(&stream.to_metadata()), Some(stream.clone()));
            let mut words = stream.to_metadata();
            words.insert("kind".into(), "of the future".into());
            assert_eq!(RecordedStream::from_metadata(&words), None);
        }
    }
}
