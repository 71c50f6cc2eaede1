//! Numbers that tell one life of a sender from all others.

use std::hash::{BuildHasher as _, RandomState};

/// A number that no publisher or command before has had; never 0.
pub(crate) fn random() -> u64 {
    // Seeded by the system's random numbers for each process, and by a counter within it.
    RandomState::new().hash_one(0).max(1)
}
