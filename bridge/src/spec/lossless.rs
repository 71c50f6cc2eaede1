//! [`Lossless`]: the consumers that a publisher waits for.

use std::time::Duration;

/// The consumers that a publisher waits for if there is no room for its frame, so that they lose none.
///
/// Sending then takes as long as the slowest of them: a simulator that waits slows its simulated time. Other consumers
/// do not slow the publisher. If one of them has no room it loses the newest frame, where it would otherwise lose the
/// oldest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lossless {
    /// Names of the nodes to wait for; empty for all.
    pub consumers: Vec<String>,
    /// How long one frame waits for one of them. After that the consumer loses the frame, and
    /// [`send`](crate::LoanedFrame::send) names it.
    pub patience: Duration,
}

impl Lossless {
    /// The default patience: long enough for a consumer that loads a model at its first frame.
    pub const PATIENCE: Duration = Duration::from_secs(10);
}

/// Waits for all consumers, with [`Lossless::PATIENCE`].
impl Default for Lossless {
    fn default() -> Self {
        Self { consumers: Vec::new(), patience: Self::PATIENCE }
    }
}
