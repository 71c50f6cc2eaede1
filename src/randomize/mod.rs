//! Looks drawn at random between limits, for learning: lamps and materials, each a function of a seed, a sample and a thing.
//!
//! | file | is |
//! |---|---|
//! | `draws` | the random numbers |
//! | `lights` | lamps: brightness, colour, direction, place |
//! | `materials` | colours and pictures of bodies |

mod draws;
mod lights;
mod materials;

pub use draws::{Draws, Thing};
pub use lights::{DrawnLight, LightRanges};
pub use materials::{Colors, DrawnMaterial, MaterialRanges};

/// The least and the greatest.
pub type Limits = [f64; 2];
