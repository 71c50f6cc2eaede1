//! The number of inputs that a property is tested with, and their seed.

use belvedere_sensors::noise::philox4x32;
use proptest::test_runner::{Config, RngSeed};
use std::io::Write as _;
use std::sync::OnceLock;

/// Returns true if a hundred times the usual number of inputs is requested.
pub(crate) fn is_full() -> bool {
    std::env::var_os("BELVEDERE_FULL").is_some_and(|full| full == "1")
}

/// The seed from the environment variable `BELVEDERE_SEED`: a number, or `new` for a new one, which is printed; 1 by
/// default.
fn seed() -> u64 {
    static SEED: OnceLock<u64> = OnceLock::new();
    *SEED.get_or_init(|| {
        let text = std::env::var("BELVEDERE_SEED").unwrap_or_else(|_| "1".to_owned());
        if text == "new" {
            let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
            let new = now.map_or(0, |now| now.as_nanos() as u64);
            // `eprintln` would not do, because the test harness hides its output for passing tests.
            let _ = writeln!(std::io::stderr(), "BELVEDERE_SEED={new}");
            return new;
        }
        text.parse()
            .unwrap_or_else(|_| panic!("BELVEDERE_SEED is \"{text}\"; it must be a number or \"new\""))
    })
}

/// Number `index` of a fixed seed, uniform on a range, for the cases of a test; independent of the numbers that sensors
/// draw.
pub(crate) fn case(seed: u32, index: u32, [least, most]: [f64; 2]) -> f64 {
    let words = philox4x32::<7>([4 * (index / 16) + index % 4, 0, 1000, 0], [seed, 7]);
    let uniform = (f64::from(words[(index / 4 % 4) as usize] >> 9) + 0.5) / f64::from(1_u32 << 23);
    least + uniform * (most - least)
}

/// Tests a property with `count` inputs, or 100 times as many with `BELVEDERE_FULL=1` in the environment. They are the
/// same in every run, so that the results of a commit's tests depend on the commit alone; `BELVEDERE_SEED` selects
/// others.
pub(crate) fn tries(count: u32) -> Config {
    let cases = count * if is_full() { 100 } else { 1 };
    Config { cases, rng_seed: RngSeed::Fixed(seed()), failure_persistence: None, ..Config::default() }
}
