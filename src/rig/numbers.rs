//! [`Numbers`]: the numbers that distinguish the noise of sensors.

use std::collections::{HashMap, HashSet};
use xxhash_rust::xxh3::xxh3_64_with_seed;

/// The numbers in use; no two sensors have the same number.
pub(super) struct Numbers {
    taken: HashSet<u32>,
    /// For each hash of a name: the number of attempts that gave numbers in use. They are not repeated for that name.
    attempts: HashMap<u64, u64>,
}

impl Numbers {
    /// Creates it with the numbers of existing sensors.
    pub(super) fn of(taken: impl IntoIterator<Item = u32>) -> Self {
        Self { taken: taken.into_iter().collect(), attempts: HashMap::new() }
    }

    /// Returns a number for a name given in parts. It is a hash of the name, so that it does not depend on other
    /// sensors; only a name whose number is in use gets the next one.
    pub(super) fn take(&mut self, name: [&str; 3]) -> u32 {
        // No part contains a zero byte, because XML allows none.
        let name = name.join("\0");
        let first = xxh3_64_with_seed(name.as_bytes(), 0);
        let attempt = self.attempts.entry(first).or_default();
        loop {
            let number = xxh3_64_with_seed(name.as_bytes(), *attempt) as u32;
            *attempt += 1;
            if self.taken.insert(number) {
                return number;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_depend_on_names_and_are_never_the_same() {
        let mut alone = Numbers::of([]);
        let eye = alone.take(["", "base", "eye"]);
        let mut both = Numbers::of([]);
        let other = both.take(["", "base", "other"]);
        assert_eq!(both.take(["", "base", "eye"]), eye);
        assert_ne!(other, eye);
        // The boundaries of the parts matter.
        assert_ne!(both.take(["", "bas", "eeye"]), eye);
        let again: Vec<u32> = (0..100).map(|_| both.take(["", "base", "eye"])).collect();
        let all: HashSet<u32> = again.iter().copied().chain([eye]).collect();
        assert_eq!(all.len(), 101);
    }

    #[test]
    fn each_attempt_is_made_once() {
        let mut numbers = Numbers::of([]);
        for _ in 0..5000 {
            numbers.take(["", "base", "eye"]);
        }
        // A few more attempts than numbers, because some hashes collide.
        let made: u64 = numbers.attempts.values().sum();
        assert!((5000..5010).contains(&made), "{made}");
        // The numbers do not depend on the stored attempts: a later start finds the next one as well.
        let mut later = Numbers::of(numbers.taken.iter().copied());
        assert_eq!(later.take(["", "base", "eye"]), numbers.take(["", "base", "eye"]));
    }
}
