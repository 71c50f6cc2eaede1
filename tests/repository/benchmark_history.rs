//! No commit lowers the bests of the benchmark gate silently: a best ratio only falls with a line that says what was
//! gained.

use super::benchmark_verdict::budgets::{Budgets, Lowered};
use std::process::Command;

fn lowered<'a>(
    budgets: &'a Budgets,
    processor: &str,
    level: &str,
    group: &str,
    entry: &str,
) -> Option<&'a Lowered> {
    budgets.lowered.get(processor)?.get(level)?.get(group)?.get(entry)
}

/// The bests that a file lowers or removes compared with an earlier one, without a line that says why.
fn lowered_silently(now: &Budgets, earlier: &Budgets) -> Vec<String> {
    let mut silent = Vec::new();
    for (processor, levels) in &earlier.best {
        for (level, groups) in levels {
            for (group, entry, was) in groups
                .iter()
                .flat_map(|(group, entries)| entries.iter().map(move |(entry, was)| (group, entry, *was)))
            {
                let best = now.best(processor, level, group, entry);
                let is_allowed = lowered(now, processor, level, group, entry).is_some_and(|line| {
                    line.best >= was
                        && best.is_none_or(|best| line.now.is_some_and(|allowed| best >= allowed))
                });
                if !is_allowed && best.is_none_or(|best| best < was) {
                    let best = best.map_or("is gone".into(), |best| format!("is {best}"));
                    silent.push(format!(
                        "[best.\"{processor}\".{level}.{group}] {entry} was {was} and {best}: restore it, or say in \
                         [lowered.\"{processor}\".{level}.{group}.{entry}] what was gained in return"
                    ));
                }
            }
        }
    }
    silent
}

/// The output of git; `None` without git or without a history. The ownership of the files does not matter.
fn git(arguments: &[&str]) -> Option<String> {
    let mut git = Command::new("git");
    git.args(["-c", "safe.directory=*"]).args(arguments).current_dir(env!("CARGO_MANIFEST_DIR"));
    let output = git.output().ok()?;
    String::from_utf8(output.stdout).ok().filter(|_| output.status.success())
}

#[test]
fn no_best_is_lower_than_in_an_earlier_commit_without_a_line_that_says_why() {
    let now = Budgets::read().expect("the file in the repository");
    let Some(commits) = git(&["log", "--format=%H", "--", "benches/budgets.toml"]) else {
        // A source archive has no history; the consistency of the file is checked when it is read.
        eprintln!("there is no git, or no history: budgets.toml is not compared with earlier commits");
        return;
    };
    assert!(!commits.is_empty(), "no commit has benches/budgets.toml");
    for commit in commits.lines() {
        let Some(text) = git(&["show", &format!("{commit}:benches/budgets.toml")]) else { continue };
        // Files from before the introduction of bests have other tables.
        if !text.contains("\n[best.") {
            continue;
        }
        let earlier = Budgets::parse(&text).unwrap_or_else(|error| panic!("{commit}: {error}"));
        let silent = lowered_silently(&now, &earlier);
        assert!(silent.is_empty(), "benches/budgets.toml, since {commit}:\n{}", silent.join("\n"));
    }
}

const BEFORE: &str = "[best.p.avx2.S1]\nR1 = 90.0\nR2 = 13.2";

fn silent_in(text: &str) -> Vec<String> {
    lowered_silently(&Budgets::parse(text).expect(text), &Budgets::parse(BEFORE).expect(BEFORE))
}

#[test]
fn a_best_that_is_lowered_or_removed_without_a_line_is_found() {
    assert_eq!(silent_in(BEFORE), [""; 0]);
    assert_eq!(silent_in("[best.p.avx2.S1]\nR1 = 95.0\nR2 = 13.2\nR3 = 1.0"), [""; 0]);
    let found = silent_in("[best.p.avx2.S1]\nR1 = 89.9\nR2 = 13.2");
    assert!(
        matches!(&found[..], [one] if one.contains("R1 was 90 and is 89.9") && one.contains("[lowered."))
    );
    let found = silent_in("[best.p.avx2.S1]\nR1 = 90.0");
    assert!(matches!(&found[..], [one] if one.contains("R2 was 13.2 and is gone")));
    // For another processor or level, it is a different best.
    assert_eq!(silent_in("[best.q.avx2.S1]\nR1 = 90.0\nR2 = 13.2").len(), 2);
    assert_eq!(silent_in("[best.p.avx512.S1]\nR1 = 90.0\nR2 = 13.2").len(), 2);
}

#[test]
fn a_line_allows_a_best_only_down_to_its_value() {
    let line = |best: f64, now: f64, allowed: f64| {
        format!(
            "[best.p.avx2.S1]\nR1 = {now}\nR2 = 13.2\n[lowered.p.avx2.S1.R1]\nbest = {best}\nnow = {allowed}\n\
             why = \"Distances are exact to the last bit.\""
        )
    };
    assert_eq!(silent_in(&line(90.0, 80.0, 80.0)), [""; 0]);
    // It has improved again, but is not as good as it was.
    assert_eq!(silent_in(&line(90.0, 85.0, 80.0)), [""; 0]);
    // A line about an earlier, lower best does not allow this one.
    assert_eq!(silent_in(&line(85.0, 80.0, 80.0)).len(), 1);
    let gone =
        "[best.p.avx2.S1]\nR1 = 90.0\n[lowered.p.avx2.S1.R2]\nbest = 13.2\nwhy = \"The entry is R3 now.\"";
    assert_eq!(silent_in(gone), [""; 0]);
}
