//! [`Draws`]: random numbers that depend only on their purpose.

use super::Limits;
use belvedere_sensors::noise::philox4x32;

/// The object that a number is drawn for, by its index among objects of its kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Thing {
    /// The whole world.
    World,
    /// A light.
    Light(u32),
    /// A body (a link).
    Body(u32),
}

/// The random numbers of one sample.
#[derive(Debug, Clone, Copy)]
pub struct Draws {
    key: [u32; 2],
    number: u64,
    place: u32,
}

/// Number of slots that are reserved for each object.
const SLOTS: u32 = 16;

impl Draws {
    /// Returns the numbers for a seed and the sample with this number in a world. There must be fewer than 2³⁰ worlds.
    pub fn new(seed: u64, world: u32, number: u64) -> Self {
        // The second highest bit of the third word distinguishes them from the numbers for random poses.
        Self { key: [seed as u32, (seed >> 32) as u32], number, place: world | 1 << 30 }
    }

    /// Returns a number for an object, from 0 up to but not including 1. `slot`, below 16, selects the number, which
    /// does not depend on other draws.
    pub fn share(&self, thing: Thing, slot: u32) -> f64 {
        let index = match thing {
            Thing::World => 0,
            Thing::Light(index) => 1 + 2 * index,
            Thing::Body(index) => 2 + 2 * index,
        };
        let block = index * (SLOTS / 4) + slot / 4;
        let words =
            philox4x32::<10>([self.number as u32, block, self.place, (self.number >> 32) as u32], self.key);
        f64::from(words[slot as usize % 4]) / 4_294_967_296.0
    }

    /// Returns a number for an object between limits.
    pub fn between(&self, [low, high]: Limits, thing: Thing, slot: u32) -> f64 {
        low + (high - low) * self.share(thing, slot)
    }
}
