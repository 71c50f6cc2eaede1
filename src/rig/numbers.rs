//! The numbers by which the noises of sensors differ.

use std::collections::HashSet;
use xxhash_rust::xxh3::xxh3_64_with_seed;

/// Numbers that are taken: no two sensors have the same.
pub(super) struct Numbers(HashSet<u32>);

impl Numbers {
    /// Those of the sensors that are there.
    pub(super) fn of(taken: impl IntoIterator<Item = u32>) -> Self {
        Self(taken.into_iter().collect())
    }

    /// A number for what has this name, part by part. It is a hash of the name, so that it does not depend on what else
    /// there is; only a name whose number is taken gets the next one.
    pub(super) fn take(&mut self, name: [&str; 3]) -> u32 {
        // No part has a zero byte: XML has none.
        let name = name.join("\0");
        let mut numbers = (0..).map(|attempt| xxh3_64_with_seed(name.as_bytes(), attempt) as u32);
        let is_free = |number: &u32| self.0.insert(*number);
        numbers.find(is_free).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_go_by_names_and_are_never_the_same() {
        let mut alone = Numbers::of([]);
        let eye = alone.take(["", "base", "eye"]);
        let mut both = Numbers::of([]);
        let other = both.take(["", "base", "other"]);
        assert_eq!(both.take(["", "base", "eye"]), eye);
        assert_ne!(other, eye);
        // Parts are parts.
        assert_ne!(both.take(["", "bas", "eeye"]), eye);
        let again: Vec<u32> = (0..100).map(|_| both.take(["", "base", "eye"])).collect();
        let all: HashSet<u32> = again.iter().copied().chain([eye]).collect();
        assert_eq!(all.len(), 101);
    }
}
