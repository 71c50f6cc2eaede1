//! [`Lossless`]: the consumers that a publisher waits for.

use std::time::Duration;

use crate::Consumer;

/// The consumers that a publisher waits for if there is no room for its frame, so that they lose none.
///
/// Sending then takes as long as the slowest of them: a simulator that waits slows its simulated time. Other consumers
/// do not slow the publisher. If one of them has no room it loses the newest frame, where it would otherwise lose the
/// oldest.
#[derive(Clone, Debug)]
pub struct Lossless {
    /// Names of the nodes to wait for; empty for all.
    pub consumers: Vec<String>,
    /// How long one frame waits for one of them. After that the consumer loses the frame, and
    /// [`send`](crate::LoanedFrame::send) names it.
    pub patience: Duration,
    /// Returns true if a frame is not to wait for this consumer any longer, for example because the user wants to end
    /// the program. It is called again and again while a frame waits. The consumer then loses the frame, which is no
    /// error.
    pub gives_up: fn(&Consumer) -> bool,
}

impl Lossless {
    /// The default patience: long enough for a consumer that loads a model at its first frame.
    pub const PATIENCE: Duration = Duration::from_secs(10);
}

/// Waits for all consumers, with [`Lossless::PATIENCE`], and does not give up before.
impl Default for Lossless {
    fn default() -> Self {
        Self { consumers: Vec::new(), patience: Self::PATIENCE, gives_up: |_| false }
    }
}

/// Two values with the same function in `gives_up` may differ all the same, because a function can have several
/// addresses.
impl PartialEq for Lossless {
    fn eq(&self, other: &Self) -> bool {
        self.consumers == other.consumers
            && self.patience == other.patience
            && std::ptr::fn_addr_eq(self.gives_up, other.gives_up)
    }
}
