//! Recording of runs to MCAP files, and their replay.
//!
//! | part | is |
//! |---|---|
//! | [`RecordingWriter`] | writes frames to a file: a ROS message of each, and the data that the message lacks |
//! | [`RecordingReader`] | reads the contents of a file in order |
//! | [`Recorder`] | records all streams of a domain to a file |
//! | [`Player`] | plays a file in a domain, in place of the simulator |
//! | [`Timeline`] | the position in a recording, and requests to seek |
//!
//! Files have MCAP's profile `ros1` or `ros2`. Each stream that has a ROS message gets a channel with ROS's topic, type
//! and definition. In addition each stream gets a channel `/belvedere/frames/TOPIC` of the type `belvedere/Frame`: the
//! header of each frame, and its payload unless the previous message contains it byte by byte, as messages of images
//! and clouds do. Times are simulated: `publish_time` is the timestamp, and `log_time` never goes back. Metadata:
//! `belvedere` describes how the recording was made, `belvedere.stream` describes each stream, and `belvedere.hashes`
//! is at the end. Attachments: the robots and the world as they were read.

mod attachment;
mod backlog;
mod chunk_sizes;
mod error;
mod file;
mod lengths;
mod log_time;
mod play_clock;
mod player;
mod player_options;
mod reader;
mod recorder;
mod records;
mod replay_streams;
pub mod ros;
mod seeking;
mod send_order;
mod skip;
mod stream;
mod timeline;
mod writer;
mod zstd;

pub use attachment::Attachment;
pub use error::RecordingError;
pub use file::NewFile;
pub use player::{Ending, Player};
pub use player_options::{Pace, PlayerOptions};
pub use reader::{Item, Message, RecordedFrame, RecordingReader};
pub use recorder::{Progress, Recorder, RecorderOptions, about};
pub use skip::Skipping;
pub use stream::RecordedStream;
pub use timeline::{Playhead, Timeline};
pub use writer::{Compression, Profile, RecordingWriter, StreamId, StreamTally};
