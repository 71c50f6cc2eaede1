//! [`Making`]: reports progress to the caller, who may stop the work.

/// Receives progress, and may stop the work.
pub trait Making: Sync {
    /// Called when a sample is done.
    fn sample_done(&self) {}

    /// Returns true to stop at the next sample.
    fn is_stopped(&self) -> bool {
        false
    }
}
