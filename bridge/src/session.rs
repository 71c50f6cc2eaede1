//! Session numbers, which distinguish one life of a sender from all others.

use std::hash::{BuildHasher as _, RandomState};

/// Returns a random number that no earlier publisher or command has used; never 0.
pub(crate) fn random() -> u64 {
    // `RandomState` is seeded with system randomness in each process, and with a counter within it.
    RandomState::new().hash_one(0).max(1)
}
