//! Skipping of tests that need what a machine may lack.

use std::{fmt::Display, io::Write as _};

/// Reports on standard error why a test is skipped. With `BELVEDERE_NO_SKIP=1` in the environment, as in CI, the test
/// fails instead.
pub fn skip(reason: impl Display) {
    let forbidden = std::env::var_os("BELVEDERE_NO_SKIP").is_some_and(|value| value == "1");
    assert!(!forbidden, "this test would be skipped, which BELVEDERE_NO_SKIP forbids: {reason}");
    // Not by `eprintln`, whose output the test harness captures if a test passes.
    let _ = writeln!(std::io::stderr(), "skipped {}: {reason}", super::this_test());
}
