//! The messages on the network: keys, the announcement of streams, frames. All received data are checked here before
//! they are used.

use super::transport::MAX_MESSAGE;
use belvedere_bridge::payload::SimulationCommand;
use belvedere_bridge::{Encoding, FrameError, FrameHeader, Kind, StreamInfo, StreamSpec};
use serde::{Deserialize, Serialize};
use std::io::Read;

/// The version of keys and announcements. Frames have their own version in each header.
const VERSION: u32 = 1;
/// Most streams of an announcement.
const MAX_STREAMS: usize = 4096;
/// Longest text of a command to the simulation, bytes.
const MAX_TEXT: usize = 4 << 20;
/// Longest announcement, bytes.
const MAX_ANNOUNCEMENT: usize = 4 << 20;

/// Returns the key of the announcements of a domain; `*` for all domains.
pub(super) fn announcement_key(domain: &str) -> String {
    format!("belvedere/{domain}/streams")
}

/// Returns the domain of such a key.
pub(super) fn announced_domain(key: &str) -> Option<&str> {
    key.strip_prefix("belvedere/")?.strip_suffix("/streams")
}

/// Returns the key of a stream from the robot.
pub(super) fn frame_key(domain: &str, topic: &str) -> String {
    format!("belvedere/{domain}/frames/{topic}")
}

/// Returns the key of a stream to the robot.
pub(super) fn command_key(domain: &str, topic: &str) -> String {
    format!("belvedere/{domain}/commands/{topic}")
}

/// The streams of a domain, announced once a second.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Announcement {
    version: u32,
    pub(super) streams: Vec<Described>,
}

/// The description of a stream, with which another machine can open it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Described {
    pub(super) topic: String,
    kind: String,
    encoding: String,
    frame_id: String,
    rate_hz: Option<f64>,
    layers: Option<u32>,
    max_payload_len: usize,
    /// Whether new subscribers get the last frame.
    keeps_last: bool,
}

/// Returns true for commands to a robot or its simulator.
pub(super) fn is_command(kind: Kind) -> bool {
    kind.is_robot_command() || kind == Kind::SimulationCommand
}

/// Returns the bytes of shared memory that a mirror of the stream may take here. Pools of commands belong to their
/// publishers.
pub(super) fn pool_bytes(spec: &StreamSpec) -> u64 {
    if is_command(spec.kind) { 0 } else { spec.pool_bytes() }
}

/// The reason why a message from the network is refused.
#[derive(Debug, thiserror::Error)]
pub(super) enum Refusal {
    #[error("{0} bytes are too few for a frame, whose header has {header}", header = size_of::<FrameHeader>())]
    Short(usize),
    #[error("it is larger than the limit of {most} bytes", most = .0)]
    Large(usize),
    #[error(transparent)]
    Frame(#[from] FrameError),
    #[error("its payload is {there} bytes long, its header says {said}")]
    Length { said: u64, there: usize },
    #[error("it is of kind {kind} and encoding {encoding}, not what was announced")]
    Other { kind: u16, encoding: u16 },
    #[error("its session is 0")]
    Session,
    #[error("its sender has put it on another key: \"{0}\"")]
    Key(String),
    #[error("{0}")]
    Announcement(String),
}

impl Announcement {
    pub(super) fn new(streams: Vec<Described>) -> Self {
        Self { version: VERSION, streams }
    }

    pub(super) fn to_bytes(&self) -> Vec<u8> {
        // This cannot fail for a struct of texts and numbers.
        serde_json::to_vec(self).unwrap_or_default()
    }

    /// Refuses a message that is too long for an announcement, before its pieces are joined.
    pub(super) fn check_len(len: usize) -> Result<(), Refusal> {
        if len > MAX_ANNOUNCEMENT { Err(Refusal::Large(MAX_ANNOUNCEMENT)) } else { Ok(()) }
    }

    pub(super) fn read(bytes: &[u8]) -> Result<Self, Refusal> {
        #[derive(Deserialize)]
        struct Versioned {
            version: u32,
        }
        let refused = |what: String| Err(Refusal::Announcement(what));
        Self::check_len(bytes.len())?;
        match serde_json::from_slice(bytes) {
            Ok(Versioned { version: VERSION }) => {}
            Ok(Versioned { version }) => {
                return refused(format!(
                    "the other side uses version {version} of links, this one {VERSION}: use the same version of Belvedere on both"
                ));
            }
            Err(error) => return refused(format!("the list of streams is invalid: {error}")),
        }
        match serde_json::from_slice::<Self>(bytes) {
            Ok(announcement) if announcement.streams.len() > MAX_STREAMS => {
                refused(format!("{} streams, the limit is {MAX_STREAMS}", announcement.streams.len()))
            }
            Ok(announcement) => Ok(announcement),
            Err(error) => refused(format!("the list of streams is invalid: {error}")),
        }
    }
}

impl Described {
    /// Describes a stream of this machine. Returns `None` for a stream without a publisher, for one that this version
    /// does not know, and for commands without a subscriber.
    pub(super) fn new(info: &StreamInfo) -> Option<Self> {
        let (kind, encoding) = (info.kind?, info.encoding?);
        let is_there = if is_command(kind) { info.subscribers > 0 } else { info.publishers > 0 };
        is_there.then(|| Self {
            topic: info.topic.clone(),
            kind: kind.to_string(),
            encoding: encoding.to_string(),
            frame_id: info.frame_id.clone(),
            rate_hz: info.rate_hz,
            layers: info.layers,
            max_payload_len: if is_command(kind) { 0 } else { info.max_payload_len },
            keeps_last: info.history > 0,
        })
    }

    /// Returns the specification with which the other side opens the stream, or `None` if it is unknown to this version
    /// or invalid.
    pub(super) fn spec(&self) -> Option<StreamSpec> {
        let (kind, encoding): (Kind, Encoding) = (self.kind.parse().ok()?, self.encoding.parse().ok()?);
        let spec = match kind {
            Kind::SimulationCommand => StreamSpec::simulation_command(0),
            Kind::SimulationResult => StreamSpec::simulation_result(),
            kind if is_command(kind) => StreamSpec::command(&self.topic, kind),
            kind if encoding == Encoding::Struct => StreamSpec::structs(&self.topic, kind, 1),
            kind => StreamSpec::new(&self.topic, kind, encoding, 0),
        };
        let history = usize::from(self.keeps_last);
        let max_payload_len = spec.max_payload_len.max(self.max_payload_len);
        let fits = max_payload_len <= MAX_MESSAGE - size_of::<FrameHeader>();
        let is_right = spec.encoding == encoding && spec.name().is_ok_and(|name| name == self.topic);
        let rate_hz = self.rate_hz.filter(|rate| rate.is_finite() && *rate > 0.0);
        let spec = StreamSpec { history, max_payload_len, rate_hz, layers: self.layers, ..spec }
            .frame_id(&self.frame_id);
        (fits && is_right && spec.header().is_ok()).then_some(spec)
    }
}

/// Checks that a message arrived at the key that its sender attached.
pub(super) fn is_at(said: &str, key: &str) -> Result<(), Refusal> {
    if said == key { Ok(()) } else { Err(Refusal::Key(said.chars().take(300).collect())) }
}

/// Returns a frame as a message.
pub(super) fn frame(header: &FrameHeader, payload: &[u8]) -> Vec<u8> {
    let mut message = Vec::with_capacity(size_of::<FrameHeader>() + payload.len());
    message.extend_from_slice(bytemuck::bytes_of(header));
    message.extend_from_slice(payload);
    message
}

/// Reads the header of a message of this many bytes, and checks everything that a reader of its payload relies on. The
/// payload is then left in `message`.
pub(super) fn header(mut message: impl Read, len: usize, spec: &StreamSpec) -> Result<FrameHeader, Refusal> {
    let mut header = FrameHeader::default();
    let Some(there) = len.checked_sub(size_of::<FrameHeader>()) else { return Err(Refusal::Short(len)) };
    message.read_exact(bytemuck::bytes_of_mut(&mut header)).map_err(|_| Refusal::Short(len))?;
    header.check(there)?;
    if header.payload_len != there as u64 {
        return Err(Refusal::Length { said: header.payload_len, there });
    }
    if header.kind != spec.kind.to_wire() || header.encoding != spec.encoding.to_wire() {
        return Err(Refusal::Other { kind: header.kind, encoding: header.encoding });
    }
    if header.session == 0 {
        return Err(Refusal::Session);
    }
    let most = match spec.kind {
        Kind::SimulationCommand => size_of::<SimulationCommand>() + MAX_TEXT,
        _ => spec.max_payload_len,
    };
    if there > most {
        return Err(Refusal::Large(most));
    }
    Ok(header)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> (StreamSpec, FrameHeader, Vec<u8>) {
        let spec = StreamSpec::new("image_raw", Kind::Image, Encoding::Rgb8, 64 * 48 * 3).frame_id("camera");
        let mut header = FrameHeader { session: 7, seq: 3, stamp_ns: 5, ..spec.header().unwrap() };
        let len = header.set_packed(64, 48);
        header.payload_len = len as u64;
        (spec, header, (0..len).map(|at| at as u8).collect())
    }

    fn read(message: &[u8], spec: &StreamSpec) -> Result<FrameHeader, Refusal> {
        header(message, message.len(), spec)
    }

    #[test]
    fn frames_are_read_back_unchanged() {
        let (spec, header, payload) = picture();
        let message = frame(&header, &payload);
        assert_eq!(bytemuck::bytes_of(&read(&message, &spec).unwrap()), bytemuck::bytes_of(&header));
        assert_eq!(message[size_of::<FrameHeader>()..], payload);
    }

    #[test]
    fn messages_that_are_not_frames_of_the_stream_are_refused() {
        let (spec, header, payload) = picture();
        let message = frame(&header, &payload);
        for len in [0, 1, 383, 384, 385, message.len() - 1] {
            assert!(read(&message[..len], &spec).is_err(), "{len} bytes");
        }
        assert!(matches!(read(&[&message[..], &[0]].concat(), &spec), Err(Refusal::Length { .. })));
        let spoilt = [
            FrameHeader { magic: 0, ..header },
            FrameHeader { schema: 1, ..header },
            FrameHeader { width: 65, ..header },
            FrameHeader { height: u32::MAX, ..header },
            FrameHeader { payload_len: u64::MAX, ..header },
            FrameHeader { kind: Kind::DepthImage.to_wire(), ..header },
            FrameHeader { encoding: Encoding::Mono8.to_wire(), ..header },
            FrameHeader { session: 0, ..header },
        ];
        for spoilt in spoilt {
            assert!(read(&frame(&spoilt, &payload), &spec).is_err(), "{spoilt:?}");
        }
        let small = StreamSpec { max_payload_len: payload.len() - 1, ..spec };
        assert!(matches!(read(&message, &small), Err(Refusal::Large(_))));
    }

    #[test]
    fn streams_are_described_so_that_they_can_be_opened() {
        let described = Described {
            topic: "robot1/scan".into(),
            kind: "laser_scan".into(),
            encoding: "ranges_f32".into(),
            frame_id: "robot1/laser".into(),
            rate_hz: Some(5.5),
            layers: Some(16),
            max_payload_len: 2880,
            keeps_last: false,
        };
        let bytes = Announcement::new(vec![described.clone()]).to_bytes();
        assert_eq!(Announcement::read(&bytes).unwrap().streams, std::slice::from_ref(&described));
        let spec = described.spec().unwrap();
        assert_eq!((spec.kind, spec.encoding, spec.history), (Kind::LaserScan, Encoding::RangesF32, 0));
        assert_eq!((spec.rate_hz, spec.layers, spec.max_payload_len), (Some(5.5), Some(16), 2880));
        let command =
            Described { kind: "velocity_command".into(), encoding: "struct".into(), ..described.clone() };
        assert_eq!(command.spec().unwrap().max_publishers, 8);
        let spoilt = [
            Described { topic: "/scan".into(), ..described.clone() },
            Described { topic: "a//b".into(), ..described.clone() },
            Described { topic: "x".repeat(300), ..described.clone() },
            Described { kind: "of the future".into(), ..described.clone() },
            Described { kind: "velocity_command".into(), ..described.clone() },
            Described { frame_id: "x".repeat(64), ..described.clone() },
            Described { max_payload_len: MAX_MESSAGE, ..described.clone() },
            Described { max_payload_len: usize::MAX, ..described.clone() },
        ];
        for spoilt in spoilt {
            assert_eq!(spoilt.spec(), None, "{spoilt:?}");
        }
    }

    #[test]
    fn invalid_announcements_are_refused_with_a_reason() {
        let good = Announcement::new(Vec::new()).to_bytes();
        for len in 0..good.len() {
            assert!(Announcement::read(&good[..len]).is_err());
        }
        let words = Announcement::read(br#"{"version":2,"others":[]}"#).unwrap_err().to_string();
        assert!(words.contains("the same version of Belvedere"), "{words}");
        let large = vec![b' '; MAX_ANNOUNCEMENT + 1];
        assert!(matches!(Announcement::read(&large), Err(Refusal::Large(_))));
    }
}
