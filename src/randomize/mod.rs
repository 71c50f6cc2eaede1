//! Random lights and materials between limits, for machine learning. Each value depends only on a seed, a sample and an
//! object.
//!
//! | file | is |
//! |---|---|
//! | `draws` | the random numbers |
//! | `lights` | lights: brightness, colour, direction, position |
//! | `materials` | colours and textures of bodies |

mod draws;
mod lights;
mod materials;

pub use draws::{Draws, Thing};
pub use lights::{DrawnLight, LightRanges};
pub use materials::{Colors, DrawnMaterial, MaterialRanges};

/// Lower and upper limit.
pub type Limits = [f64; 2];
