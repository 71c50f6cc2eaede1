//! Runs kept in MCAP files, and played again.
//!
//! | part | is |
//! |---|---|
//! | [`RecordingWriter`] | frames into a file: ROS 1's message of each, and beside it what that leaves out |
//! | [`RecordingReader`] | what is in a file, in order |
//! | [`Recorder`] | all streams of a domain into a file |
//! | [`Player`] | a file into a domain, as if it were the simulator |
//! | [`Timeline`] | where it is, and where somebody wants it to be |
//!
//! A file is of MCAP's profile `ros1`. It has for each stream that ROS has a message for a channel with ROS's topic, type and
//! definition, and for each stream a channel `/belvedere/frames/TOPIC` of the type `belvedere/Frame`: the header of each
//! frame, and its payload unless the message before has it byte by byte, as those of pictures and clouds do. Times are
//! simulated: `publish_time` is the stamp, `log_time` never goes back. Metadata: `belvedere` on how it came about,
//! `belvedere.stream` for each stream, `belvedere.hashes` at the end. Attachments: the robots and the world as they were read.

mod attachment;
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
pub mod ros1;
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
pub use writer::{Compression, RecordingWriter, StreamId, StreamTally};
