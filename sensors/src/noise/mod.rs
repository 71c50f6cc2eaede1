//! Counter-based random numbers and the noise models built on them.
