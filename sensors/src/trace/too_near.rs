//! The treatment of surfaces nearer than a sensor can measure.

/// The treatment of surfaces nearer than the smallest distance of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TooNear {
    /// REP-117: they are in the way, and the distance is −∞.
    Blocks,
    /// As in Gazebo: rays begin at the smallest distance, and see what lies behind.
    SeenThrough,
}
