//! The benchmark gate measures with fresh copies of its program, and combines their results.

#[allow(unreachable_pub, reason = "part of another target")]
#[path = "../../benches/gate/copies.rs"]
mod copies;
#[allow(dead_code, unreachable_pub, reason = "parts of another target")]
#[path = "../../benches/gate/figures.rs"]
mod figures;

use figures::{Figures, Pooled, Unit, gains, median, pool};
use std::fs;
use std::path::Path;

/// A folder with a copy of a system program.
fn folder_with(program: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(program, folder.path().join("program")).unwrap();
    folder
}

fn names_in(folder: &Path) -> Vec<String> {
    fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn each_copy_is_a_separate_file_and_is_removed() {
    let folder = folder_with("/bin/readlink");
    let program = folder.path().join("program");
    let run = || copies::run(&program, &["/proc/self/exe"]).unwrap();
    let (first, second) = (run(), run());
    for path in [&first, &second] {
        assert!(path.starts_with(folder.path().to_str().unwrap()), "{path}");
        assert!(!path.starts_with(program.to_str().unwrap()), "{path}");
    }
    assert_ne!(first, second);
    assert_eq!(names_in(folder.path()), ["program"]);
}

#[test]
fn a_failing_copy_is_an_error_and_is_removed() {
    let folder = folder_with("/bin/false");
    let message = copies::run(&folder.path().join("program"), &[""; 0]).unwrap_err();
    assert!(message.contains("exit status: 1"), "{message}");
    assert_eq!(names_in(folder.path()), ["program"]);
    fs::write(folder.path().join("program"), "no program").unwrap();
    let message = copies::run(&folder.path().join("program"), &[""; 0]).unwrap_err();
    assert!(message.contains("cannot be run"), "{message}");
    assert_eq!(names_in(folder.path()), ["program"]);
}

fn figures(group: &str, name: &str, peer: &str, ratio: f64) -> Figures {
    let (group, name, peer) = (group.into(), name.into(), peer.into());
    Figures { group, name, unit: Unit::Time, peer, ours_s: 1.0, theirs_s: ratio, ratio }
}

#[test]
fn the_median_of_the_copies_is_used() {
    // One copy is slow because of its position in memory, and one did not measure the second entry.
    let copy = |first: f64, second: Option<f64>| {
        let second = second.map(|ratio| figures("S1", "R2", "parry3d", ratio));
        [Some(figures("S1", "R1", "parry3d", first)), second].into_iter().flatten().collect::<Vec<_>>()
    };
    let copies = [copy(10.0, Some(4.0)), copy(7.9, None), copy(10.2, Some(5.0))];
    let pooled = pool(&copies);
    let ratios: Vec<_> = pooled.iter().map(|entry| (entry.figures.title(), entry.figures.ratio)).collect();
    assert_eq!(ratios, [("S1/R1".into(), 10.0), ("S1/R2".into(), 4.5)]);
    assert_eq!(pooled[0].range, [7.9, 10.2]);
    assert!((pooled[0].spread() - 0.23).abs() < 1e-9, "{}", pooled[0].spread());
    assert_eq!(pool(&[]), []);
}

#[test]
fn medians_are_the_middle_one_or_the_mean_of_the_middle_two() {
    assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
    assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), 2.5);
    assert!(median(vec![]).is_nan());
}

#[test]
fn the_gain_of_a_level_is_the_geometric_mean_of_entries_with_parry3d() {
    let level = |[a, b, own, frame]: [f64; 4]| {
        pool(&[vec![
            figures("S1", "R1", "parry3d", a),
            figures("S1", "R2", "parry3d", b),
            figures("frames", "depth", "its trace alone", own),
            figures("frames", "rgb", "depth by parry3d", frame),
        ]])
    };
    let (narrow, wide) = (level([10.0, 5.0, 0.5, 2.0]), level([20.0, 10.0 * 2.0, 0.1, 3.0]));
    let whole: Vec<Figures> = wide.iter().map(|entry: &Pooled| entry.figures.clone()).collect();
    let found = gains(&wide, &narrow, &whole);
    let names: Vec<_> = found.iter().map(|(group, _)| group.as_str()).collect();
    assert_eq!(names, ["S1", "frames"]);
    // √(2 · 4); entries that are compared with themselves do not count.
    for ((_, gain), expected) in found.iter().zip([8_f64.sqrt(), 1.5]) {
        assert!((gain - expected).abs() < 1e-12, "{gain} is not {expected}");
    }
    // A part of a group has another gain than the whole.
    let found = gains(&wide[1..], &narrow, &whole);
    assert!(matches!(&found[..], [(group, _)] if group == "frames"), "{found:?}");
}
