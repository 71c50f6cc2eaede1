//! Frames on shared memory.
