//! Reproducible random numbers.

use std::io::Write as _;

/// A generator of random numbers, `SplitMix64`: Steele, Lea, Flood, "Fast splittable pseudorandom number generators",
/// OOPSLA 2014.
pub(crate) struct Random(u64);

impl Random {
    /// Creates a generator from the seed in the environment variable `BELVEDERE_SEED`: a number, or `new` for a new one,
    /// which is printed; 1 by default.
    pub(crate) fn new() -> Self {
        let text = std::env::var("BELVEDERE_SEED").unwrap_or_else(|_| "1".to_owned());
        if text != "new" {
            return Self(
                text.parse().unwrap_or_else(|_| {
                    panic!("BELVEDERE_SEED is \"{text}\"; it must be a number or \"new\"")
                }),
            );
        }
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        let new = now.map_or(0, |now| now.as_nanos() as u64);
        let _ = writeln!(std::io::stderr(), "BELVEDERE_SEED={new}");
        Self(new)
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// Returns one of `0..end`.
    pub(crate) fn below(&mut self, end: u64) -> u64 {
        self.next() % end
    }

    /// Returns one of `values`.
    pub(crate) fn one_of<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.below(values.len() as u64) as usize]
    }
}
