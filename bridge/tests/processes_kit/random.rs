//! Reproducible random numbers for tests.

use std::{io::Write as _, sync::OnceLock};

pub const SEED: &str = "BELVEDERE_SEED";

/// A generator of random numbers, `SplitMix64`: Steele, Lea, Flood, "Fast splittable pseudorandom number generators",
/// OOPSLA 2014.
pub struct Random(u64);

impl Random {
    /// Creates a generator from [`seed`], or from `fixed` if there is none.
    pub fn new(fixed: u64) -> Self {
        Self(seed().unwrap_or(fixed))
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// Returns one of `0..end`.
    pub fn below(&mut self, end: u64) -> u64 {
        self.next() % end
    }

    /// Returns one of `values`.
    pub fn one_of<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.below(values.len() as u64) as usize]
    }
}

/// Returns the number in the environment variable [`SEED`]; a new one, which is printed, if it holds `new`; `None`
/// without it, so that each test uses its own fixed number.
pub fn seed() -> Option<u64> {
    static SEEDS: OnceLock<Option<u64>> = OnceLock::new();
    *SEEDS.get_or_init(|| {
        let text = std::env::var(SEED).ok()?;
        if text == "new" {
            let new = belvedere_bridge::clock::mono_ns();
            // Not by `eprintln`, whose output the test harness captures if a test passes.
            let _ = writeln!(std::io::stderr(), "{SEED}={new}");
            return Some(new);
        }
        Some(text.parse().unwrap_or_else(|_| panic!("{SEED} is a number or \"new\", not \"{text}\"")))
    })
}
