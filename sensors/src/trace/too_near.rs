//! The treatment of surfaces nearer than a sensor can measure.

/// The treatment of surfaces nearer than the smallest distance of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TooNear {
    /// They block the ray, and the distance is −∞ (REP 117).
    Blocks,
    /// Rays begin at the smallest distance and see what lies behind, as in Gazebo.
    SeenThrough,
}
