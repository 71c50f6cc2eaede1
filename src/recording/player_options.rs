//! [`PlayerOptions`]: how a recording is played.

use crate::server::attendance::Awaited;
use std::time::Duration;

/// How fast a recording is played.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// So many recorded seconds in a second; greater than 0.
    Rate(f64),
    /// As fast as it can.
    Max,
}

/// How a recording is played.
#[derive(Debug, Clone)]
pub struct PlayerOptions {
    /// How fast.
    pub pace: Pace,
    /// Where to begin: seconds after the beginning of the recording.
    pub start: Duration,
    /// How much of it; all if there is none.
    pub duration: Option<Duration>,
    /// Whether to begin standing, until a command resumes or steps it.
    pub paused: bool,
    /// Consumers that lose no frame and are waited for before the first.
    pub wait_for: Vec<Awaited>,
    /// How long a frame, and the first of all, waits for one of them; if nothing is asked for, as long as a simulation
    /// does.
    pub patience: Option<Duration>,
}

impl Default for PlayerOptions {
    /// All of it, as it was.
    fn default() -> Self {
        Self {
            pace: Pace::Rate(1.0),
            start: Duration::ZERO,
            duration: None,
            paused: false,
            wait_for: Vec::new(),
            patience: None,
        }
    }
}
