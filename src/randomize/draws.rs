//! Random numbers that depend on nothing but what they are for.

use super::Limits;
use belvedere_sensors::noise::philox4x32;

/// What a number is drawn for, by its index among those of its kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Thing {
    /// All of it.
    World,
    /// A lamp.
    Light(u32),
    /// What moves as one.
    Body(u32),
}

/// The random numbers of one sample.
#[derive(Debug, Clone, Copy)]
pub struct Draws {
    key: [u32; 2],
    number: u64,
    place: u32,
}

/// Numbers of a thing that are kept for what may come.
const SLOTS: u32 = 16;

impl Draws {
    /// Those of a seed and of the sample of this number in a world. Worlds are fewer than 2³⁰.
    pub fn new(seed: u64, world: u32, number: u64) -> Self {
        // The second highest bit of the third word keeps them apart from those that places are drawn with.
        Self { key: [seed as u32, (seed >> 32) as u32], number, place: world | 1 << 30 }
    }

    /// A number of a thing, from 0 to 1 without 1. `slot`, below 16, says which: it is the same whatever else is drawn.
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

    /// A number of a thing between limits.
    pub fn between(&self, [low, high]: Limits, thing: Thing, slot: u32) -> f64 {
        low + (high - low) * self.share(thing, slot)
    }
}
