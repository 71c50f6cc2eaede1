//! [`PlayerOptions`]: options for playing a recording.

use crate::server::attendance::Awaited;
use belvedere_bridge::Consumer;
use std::time::Duration;

/// The speed at which a recording is played.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// Factor of real time; greater than 0.
    Rate(f64),
    /// As fast as possible.
    Max,
}

/// Options for playing a recording.
#[derive(Debug, Clone)]
pub struct PlayerOptions {
    /// Name of the recording in warnings.
    pub name: String,
    /// The speed.
    pub pace: Pace,
    /// Start, counted from the beginning of the recording.
    pub start: Duration,
    /// Recorded time to play; none for everything.
    pub duration: Option<Duration>,
    /// True to start paused, until a command resumes or steps it.
    pub paused: bool,
    /// Consumers that lose no frame, and that must connect before the first frame.
    pub wait_for: Vec<Awaited>,
    /// Longest wait of a frame, and of the start, for one of these consumers; the defaults are those of a simulation.
    pub patience: Option<Duration>,
    /// Returns true if frames no longer wait for this consumer: see [`belvedere_bridge::Lossless::gives_up`].
    pub gives_up: fn(&Consumer) -> bool,
}

impl Default for PlayerOptions {
    /// Plays everything at the original speed.
    fn default() -> Self {
        Self {
            name: "the recording".into(),
            pace: Pace::Rate(1.0),
            start: Duration::ZERO,
            duration: None,
            paused: false,
            wait_for: Vec::new(),
            patience: None,
            gives_up: |_| false,
        }
    }
}
