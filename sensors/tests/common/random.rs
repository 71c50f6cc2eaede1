//! How often a property is tried, and with what.

use belvedere_sensors::noise::philox4x32;
use proptest::test_runner::{Config, RngSeed};
use std::io::Write as _;
use std::sync::OnceLock;

/// A hundred times what is wanted otherwise.
pub(crate) fn is_full() -> bool {
    std::env::var_os("BELVEDERE_FULL").is_some_and(|full| full == "1")
}

/// The number of the environment variable `BELVEDERE_SEED`; a new one, which is printed, if it holds `new`; 1 without it.
fn seed() -> u64 {
    static SEED: OnceLock<u64> = OnceLock::new();
    *SEED.get_or_init(|| {
        let text = std::env::var("BELVEDERE_SEED").unwrap_or_else(|_| "1".to_owned());
        if text == "new" {
            let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
            let new = now.map_or(0, |now| now.as_nanos() as u64);
            // Not by `eprintln`, whose lines the test harness keeps to itself when a test passes.
            let _ = writeln!(std::io::stderr(), "BELVEDERE_SEED={new}");
            return new;
        }
        text.parse().unwrap_or_else(|_| panic!("BELVEDERE_SEED is a number or \"new\", not \"{text}\""))
    })
}

/// Number `index` of a fixed seed, uniform on a range: those of a test's cases, whatever the sensors draw.
pub(crate) fn case(seed: u32, index: u32, [least, most]: [f64; 2]) -> f64 {
    let words = philox4x32::<7>([4 * (index / 16) + index % 4, 0, 1000, 0], [seed, 7]);
    let uniform = (f64::from(words[(index / 4 % 4) as usize] >> 9) + 0.5) / f64::from(1_u32 << 23);
    least + uniform * (most - least)
}

/// Tries a property with `count` inputs, or 100 times as many with `BELVEDERE_FULL=1` in the environment. They are the
/// same on every run, so that what a commit's tests say depends on the commit alone; `BELVEDERE_SEED` chooses others.
pub(crate) fn tries(count: u32) -> Config {
    let cases = count * if is_full() { 100 } else { 1 };
    Config { cases, rng_seed: RngSeed::Fixed(seed()), failure_persistence: None, ..Config::default() }
}
