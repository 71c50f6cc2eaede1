//! The time that building a tree may take.

/// The effort spent on building a tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quality {
    /// Fast to build, for meshes that change often.
    Fast,
    /// Slower to build and faster to trace, for meshes that are traced often.
    #[default]
    High,
}
