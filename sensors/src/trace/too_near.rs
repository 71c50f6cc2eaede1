//! What is nearer than a sensor can measure.

/// What happens to something nearer than the smallest distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TooNear {
    /// REP-117: it is in the way, and the distance is −∞.
    Blocks,
    /// As Gazebo: the ray begins at the smallest distance and sees what lies behind.
    SeenThrough,
}
