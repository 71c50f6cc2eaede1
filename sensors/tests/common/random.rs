//! How often a property is tried, and with what.

use proptest::test_runner::{Config, RngSeed};

/// A hundred times what is wanted otherwise.
pub(crate) fn is_full() -> bool {
    std::env::var_os("BELVEDERE_FULL").is_some_and(|full| full == "1")
}

/// Tries a property with `count` inputs, the same on every run, so that what a commit's tests say depends on the
/// commit alone. With `BELVEDERE_FULL=1` in the environment: with 100 times as many, others on each run, by which
/// faults are looked for.
pub(crate) fn tries(count: u32) -> Config {
    let (factor, rng_seed) = if is_full() { (100, RngSeed::Random) } else { (1, RngSeed::Fixed(1)) };
    Config { cases: count * factor, rng_seed, failure_persistence: None, ..Config::default() }
}
