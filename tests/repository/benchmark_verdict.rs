//! The gate of the benchmarks opens and shuts where it says.

#[allow(dead_code, unreachable_pub, reason = "parts of another target")]
#[path = "../../benches/budgets.rs"]
mod budgets;
#[allow(unreachable_pub, reason = "part of another target")]
#[path = "../../benches/gate/verdict.rs"]
mod verdict;

use budgets::Budgets;
use verdict::{TOLERANCE, TOLERANCE_ELSEWHERE, Verdict, judge};

#[test]
fn a_ratio_falls_when_it_is_more_than_a_tenth_below_its_record() {
    assert_eq!(judge(8.99, Some(10.0), TOLERANCE), Verdict::Falls);
    assert_eq!(judge(9.01, Some(10.0), TOLERANCE), Verdict::Holds);
    assert_eq!(judge(10.99, Some(10.0), TOLERANCE), Verdict::Holds);
    assert_eq!(judge(11.01, Some(10.0), TOLERANCE), Verdict::Better);
    assert_eq!(judge(0.1, None, TOLERANCE), Verdict::NotRecorded);
    assert_eq!(judge(8.99, Some(10.0), TOLERANCE_ELSEWHERE), Verdict::Holds);
    assert_eq!(judge(4.0, Some(10.0), TOLERANCE_ELSEWHERE), Verdict::Falls);
    assert_eq!(judge(f64::NAN, Some(10.0), TOLERANCE), Verdict::Falls);
}

#[test]
fn the_recorded_budgets_can_be_read_and_written_back() {
    let budgets = Budgets::read().expect("the file in the repository");
    assert!(!budgets.levels.is_empty(), "nothing is recorded");
    assert!(!budgets.instructions.is_empty(), "no instruction counts are recorded");
    let text = budgets.to_text().expect("TOML");
    assert_eq!(Budgets::parse(&text).expect("TOML"), budgets);
    assert!(budgets.levels.keys().eq(budgets.processors.keys()), "each level's processor is recorded");
}

#[test]
fn a_record_is_kept_for_its_level_alone() {
    let mut budgets = Budgets::default();
    budgets.record("avx2", "S1", "R1", 12.345);
    budgets.record("avx2", "S3", "R2", 0.012_345);
    assert_eq!(budgets.ratio("avx2", "S1", "R1"), Some(12.3));
    assert_eq!(budgets.ratio("avx2", "S3", "R2"), Some(0.0123));
    assert_eq!(budgets.ratio("avx512", "S1", "R1"), None);
    let text = "[elsewhere.\"some processor\".avx2.S1]\nR1 = 4.0\n[avx2.S1]\nR1 = 7.0";
    let budgets = Budgets::parse(text).expect("TOML");
    assert_eq!(budgets.ratio("avx2", "S1", "R1"), Some(7.0));
    let found = |processor: &str, level: &str| budgets.ratio_elsewhere(processor, level, "S1", "R1");
    assert_eq!(found("some processor", "avx2"), Some(4.0));
    assert_eq!((found("some processor", "avx512"), found("another", "avx2")), (None, None));
}

#[test]
fn a_record_that_nothing_could_fall_below_is_an_error() {
    for bad in [
        "[avx2.S1]\nR1 = nan",
        "[avx2.S1]\nR1 = 0.0",
        "[avx2.S1]\nR1 = -3.0",
        "[avx2]\nR1 = 3.0",
        "[elsewhere.p.avx2.S1]\nR1 = 0.0",
    ] {
        assert!(Budgets::parse(bad).is_err(), "{bad}");
    }
}
