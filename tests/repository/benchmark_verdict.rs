//! The verdicts of the benchmark gate.

#[allow(dead_code, unreachable_pub, reason = "parts of another target")]
#[path = "../../benches/budgets/mod.rs"]
pub(super) mod budgets;
#[allow(unreachable_pub, reason = "part of another target")]
#[path = "../../benches/gate/verdict.rs"]
mod verdict;

use budgets::Budgets;
use verdict::{Mark, Source, TOLERANCE, TOLERANCE_ELSEWHERE, Verdict, judge, mark};

fn parse(text: &str) -> Budgets {
    Budgets::parse(text).unwrap_or_else(|error| panic!("{text}\n{error}"))
}

#[test]
fn a_ratio_falls_if_it_is_more_than_a_tenth_below_its_mark() {
    let at = |tolerance| Some(Mark { ratio: 10.0, tolerance, source: Source::Best });
    assert_eq!(judge(8.99, at(TOLERANCE)), Verdict::Falls);
    assert_eq!(judge(9.01, at(TOLERANCE)), Verdict::Holds);
    assert_eq!(judge(10.99, at(TOLERANCE)), Verdict::Holds);
    assert_eq!(judge(11.01, at(TOLERANCE)), Verdict::Better);
    assert_eq!(judge(f64::NAN, at(TOLERANCE)), Verdict::Falls);
    assert_eq!(judge(0.1, None), Verdict::NotRecorded);
    assert_eq!(judge(6.51, at(TOLERANCE_ELSEWHERE)), Verdict::Holds);
    assert_eq!(judge(6.49, at(TOLERANCE_ELSEWHERE)), Verdict::Falls);
}

/// A level with two entries, recorded on one processor, and bests of two processors.
const BUDGETS: &str = "[processors]\navx2 = \"zen\"\n[avx2.S1]\nR1 = 7.0\nR2 = 5.0\n\
                       [best.zen.avx2.S1]\nR1 = 7.5\n[best.lake.avx2.S1]\nR1 = 4.0";

#[test]
fn the_best_decides_even_if_the_record_is_lower() {
    let budgets = parse(BUDGETS);
    let on =
        |processor: &str, entry: &str, ratio| judge(ratio, mark(&budgets, processor, "avx2", "S1", entry));
    // 6.7 is within a tenth of the record of 7.0, but not of the best of 7.5.
    assert_eq!(on("zen", "R1", 6.7), Verdict::Falls);
    assert_eq!(on("zen", "R1", 6.8), Verdict::Holds);
    // Another processor has its own best, and its record does not matter there.
    assert_eq!(on("lake", "R1", 3.5), Verdict::Falls);
    assert_eq!(on("lake", "R1", 3.7), Verdict::Holds);
    // Without a best, the record decides: within a tenth on the processor where it was measured, and a wider tolerance
    // elsewhere.
    assert_eq!(on("zen", "R2", 4.4), Verdict::Falls);
    assert_eq!(on("lake", "R2", 4.4), Verdict::Holds);
    assert_eq!(on("lake", "R2", 3.2), Verdict::Falls);
    assert_eq!(mark(&budgets, "zen", "avx512", "S1", "R1"), None);
}

#[test]
fn declared_noise_widens_the_tolerance_of_its_entry_only() {
    let noise = "[noise.S1.R1]\ntolerance = 0.2\nwhy = \"One of two copies is a fifth slower.\"";
    let budgets = parse(&format!("{BUDGETS}\n{noise}"));
    let on =
        |processor: &str, entry: &str, ratio| judge(ratio, mark(&budgets, processor, "avx2", "S1", entry));
    assert_eq!([on("zen", "R1", 6.1), on("zen", "R1", 5.9)], [Verdict::Holds, Verdict::Falls]);
    assert_eq!([on("zen", "R2", 4.6), on("zen", "R2", 4.4)], [Verdict::Holds, Verdict::Falls]);
    // The tolerance is already wider for another processor.
    assert_eq!(on("lake", "R2", 3.3), Verdict::Holds);
    for (bad, what) in [
        ("tolerance = 0.2", "why"),
        ("tolerance = 0.2\nwhy = \"\"", "`why` is empty"),
        ("tolerance = 0.5\nwhy = \"It varies.\"", "at most 0.25"),
        ("tolerance = nan\nwhy = \"It varies.\"", "at most 0.25"),
        ("tolerance = 0.05\nwhy = \"It varies.\"", "more than 0.1"),
    ] {
        let message = refused(&format!("[noise.S1.R1]\n{bad}"));
        assert!(message.contains(what), "{bad}\n{message}");
    }
}

#[test]
fn the_recorded_budgets_can_be_read_and_written_back() {
    let budgets = Budgets::read().expect("the file in the repository");
    assert!(!budgets.levels.is_empty(), "nothing is recorded");
    assert!(!budgets.instructions.is_empty(), "no instruction counts are recorded");
    let text = budgets.to_text().expect("TOML");
    assert_eq!(parse(&text), budgets);
    assert!(budgets.levels.keys().eq(budgets.processors.keys()), "each level's processor is recorded");
    let file = std::fs::read_to_string(Budgets::path()).expect("the file in the repository");
    assert_eq!(file, text, "`--record` would change more than ratios");
}

#[test]
fn each_record_has_a_best_of_its_processor() {
    let budgets = Budgets::read().expect("the file in the repository");
    for (level, groups) in &budgets.levels {
        for (group, entries) in groups {
            for entry in entries.keys() {
                let best = budgets.best(&budgets.processors[level], level, group, entry);
                assert!(best.is_some(), "[{level}.{group}] {entry} has none");
            }
        }
    }
}

#[test]
fn a_record_is_kept_for_its_level_only() {
    let mut budgets = Budgets::default();
    budgets.record("zen", "avx2", "S1", "R1", 12.345);
    budgets.record("zen", "avx2", "S3", "R2", 0.012_345);
    assert_eq!(budgets.ratio("avx2", "S1", "R1"), Some(12.3));
    assert_eq!(budgets.ratio("avx2", "S3", "R2"), Some(0.0123));
    assert_eq!(budgets.ratio("avx512", "S1", "R1"), None);
    assert_eq!(budgets.best("zen", "avx2", "S1", "R1"), Some(12.3));
    assert_eq!(budgets.best("lake", "avx2", "S1", "R1"), None);
}

#[test]
fn recording_raises_a_best_and_never_lowers_one() {
    let mut budgets = parse(BUDGETS);
    budgets.record("zen", "avx2", "S1", "R1", 6.9);
    assert_eq!(budgets.ratio("avx2", "S1", "R1"), Some(6.9));
    assert_eq!(budgets.best("zen", "avx2", "S1", "R1"), Some(7.5));
    budgets.record("zen", "avx2", "S1", "R1", 8.0);
    assert_eq!(budgets.best("zen", "avx2", "S1", "R1"), Some(8.0));
    // Another processor raises its own best, and leaves the records of the level unchanged.
    budgets.record("lake", "avx2", "S1", "R1", 4.2);
    assert_eq!(budgets.best("lake", "avx2", "S1", "R1"), Some(4.2));
    assert_eq!(budgets.best("zen", "avx2", "S1", "R1"), Some(8.0));
    assert_eq!(budgets.ratio("avx2", "S1", "R1"), Some(8.0));
}

#[test]
fn recorded_files_can_be_read() {
    // The lowest ratio that still holds, for bests whose tenth is rounded up or down.
    for best in [1.23, 1.26, 9.97, 10.1, 0.111, 120.0] {
        let mut budgets = Budgets::default();
        budgets.record("zen", "avx2", "S1", "R1", best);
        budgets.record("zen", "avx2", "S1", "R1", best * (1.0 - TOLERANCE));
        assert_eq!(parse(&budgets.to_text().expect("TOML")), budgets);
    }
}

#[test]
fn a_record_below_which_nothing_can_fall_is_an_error() {
    for bad in [
        "[avx2.S1]\nR1 = nan",
        "[avx2.S1]\nR1 = 0.0",
        "[avx2.S1]\nR1 = -3.0",
        "[avx2]\nR1 = 3.0",
        "[best.p.avx2.S1]\nR1 = 0.0",
        "[best.p.avx2.S1]\nR1 = inf",
    ] {
        assert!(Budgets::parse(bad).is_err(), "{bad}");
    }
}

/// The error for a file with these tables.
fn refused(text: &str) -> String {
    Budgets::parse(text).expect_err(text)
}

#[test]
fn a_record_far_below_the_best_is_refused() {
    let file = |record: f64| {
        format!(
            "[processors]\navx512 = \"zen\"\n[avx512.frames]\nrgb = {record}\n[best.zen.avx512.frames]\nrgb = 7.5"
        )
    };
    parse(&file(6.8));
    let message = refused(&file(5.1));
    assert!(message.contains("[avx512.frames] rgb = 5.1"), "{message}");
    assert!(
        message.contains("raise the record") && message.contains("[lowered.\"zen\".avx512.frames.rgb]"),
        "{message}"
    );
    let message = refused(&file(7.6));
    assert!(message.contains("above the best"), "{message}");
}

#[test]
fn a_line_of_a_lowered_best_must_say_why_and_hold() {
    let file =
        |best: &str, line: &str| format!("[best.zen.avx2.S1]\n{best}\n[lowered.zen.avx2.S1.R1]\n{line}");
    let why = "why = \"Distances are exact to the last bit.\"";
    parse(&file("R1 = 6.0", &format!("best = 7.5\nnow = 6.0\n{why}")));
    parse(&file("R1 = 7.0", &format!("best = 7.5\nnow = 6.0\n{why}")));
    parse(&file("R2 = 1.0", &format!("best = 7.5\n{why}")));
    for (best, line, what) in [
        ("R1 = 6.0", "best = 7.5\nnow = 6.0".into(), "why"),
        ("R1 = 6.0", "best = 7.5\nnow = 6.0\nwhy = \" \"".into(), "`why` is empty"),
        ("R1 = 5.9", format!("best = 7.5\nnow = 6.0\n{why}"), "the best is 5.9"),
        ("R2 = 6.0", format!("best = 7.5\nnow = 6.0\n{why}"), "the best is not there"),
        ("R1 = 6.0", format!("best = 7.5\n{why}"), "the entry is gone"),
        ("R1 = 8.0", format!("best = 7.5\nnow = 8.0\n{why}"), "less than `best`"),
        ("R1 = 6.0", format!("best = 7.5\nnow = nan\n{why}"), "more than 0"),
        ("R1 = 6.0", format!("best = 7.5\nthen = 6.0\n{why}"), "then"),
    ] {
        let message = refused(&file(best, &line));
        assert!(message.contains(what), "{line}\n{message}");
    }
}
