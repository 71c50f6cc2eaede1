//! Numbers that tell one life of a sender from all others.

use std::hash::{BuildHasher as _, Hasher as _, RandomState};

use crate::clock;

/// A number that no publisher or command before has had; never 0.
pub(crate) fn random() -> u64 {
    // Seeded by the system's random numbers for each process, by a counter within it.
    let mut hasher = RandomState::new().build_hasher();
    hasher.write_u64(clock::mono_ns());
    hasher.finish().max(1)
}
