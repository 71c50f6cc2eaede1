//! [`Lossless`]: whom a publisher waits for.

use std::time::Duration;

/// Whom a publisher waits for when there is no room for its frame, so that they lose none.
///
/// Sending then takes as long as the slowest of them: a simulator that sends slows its own time. Other consumers
/// slow nobody, but lose the newest frame when they have no room, where they would otherwise lose the oldest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lossless {
    /// Names of the nodes that are waited for; all when it is empty.
    pub consumers: Vec<String>,
    /// How long one frame waits for one of them. After that it is lost to it, and [`send`](crate::LoanedFrame::send)
    /// says who it was.
    pub patience: Duration,
}

impl Lossless {
    /// Patience when none is named: long enough for a consumer that loads a model at its first frame.
    pub const PATIENCE: Duration = Duration::from_secs(10);
}

/// For all consumers, with [`Lossless::PATIENCE`].
impl Default for Lossless {
    fn default() -> Self {
        Self { consumers: Vec::new(), patience: Self::PATIENCE }
    }
}
