//! The process that judges. Copies of the program measure; this process does not.

use super::budgets::Budgets;
use super::figures::{Figures, Pooled, Report, gains, pool};
use super::options::Options;
use super::verdict::{Mark, Source, TOLERANCE_ELSEWHERE, Verdict, judge, mark};
use super::{copies, idle, machine, table};
use std::time::Duration;

/// An entry that seems to have fallen is measured this many times in total, each time with fresh copies, and the best
/// median counts, because noise disappears and a loss does not.
const TRIES: usize = 8;
/// Pause before each further try. What else runs on the same processor, also for other virtual machines, often lasts
/// for seconds.
const PAUSE: Duration = Duration::from_secs(5);
/// The level and group of the budgets that say how many times as fast a group is at AVX-512 as at AVX2.
const GAIN: (&str, &str) = ("avx512_by_avx2", "gain");

/// Measures all requested entries at every level of this machine, and judges them.
pub fn run(options: &Options) -> Result<(), String> {
    let session = Session { options, budgets: Budgets::read()?, processor: machine::processor() };
    if options.record {
        idle::require()?;
    }
    let levels = options.levels();
    let first = session.measure(levels.iter().map(|level| (*level, Vec::new())))?;
    if first.iter().all(|level| level.entries.is_empty() && level.left_out.is_empty()) {
        return Err(format!("no entry's name contains {:?}", options.filter));
    }
    let mut judged = session.judge(&first, &first);
    if !options.test {
        for _ in 1..TRIES {
            let again = to_repeat(&first, &judged);
            if again.is_empty() {
                break;
            }
            std::thread::sleep(PAUSE);
            keep_best(&mut judged, session.judge(&session.measure(again)?, &first));
        }
    }
    session.print(&first, &judged);
    if options.record {
        idle::require()?;
        session.record(&judged)?;
    }
    session.conclude(&judged)
}

/// A run.
struct Session<'a> {
    options: &'a Options,
    budgets: Budgets,
    processor: String,
}

/// The measurements of the copies at one SIMD level.
struct Measured {
    level: &'static str,
    entries: Vec<Pooled>,
    /// Names of entries that were not measured, with the reasons.
    left_out: Vec<(String, String)>,
}

/// A ratio and its verdict.
struct Judged {
    level: &'static str,
    group: String,
    name: String,
    ratio: f64,
    /// The figures of an entry; a gain has none.
    entry: Option<Pooled>,
    mark: Option<Mark>,
    verdict: Verdict,
}

impl Judged {
    /// Returns the name as in `--filter` and in the table.
    fn title(&self) -> String {
        match self.entry {
            Some(_) => format!("{}/{}", self.group, self.name),
            None => self.name.clone(),
        }
    }

    fn has_fallen(&self) -> bool {
        self.verdict == Verdict::Falls
    }

    fn is_held_to_another_processor(&self) -> bool {
        self.mark.is_some_and(|mark| mark.source == Source::RecordElsewhere)
    }
}

impl Session<'_> {
    /// Lets copies measure the entries of each level, or all entries if none are named. The levels alternate.
    fn measure(
        &self,
        levels: impl IntoIterator<Item = (&'static str, Vec<String>)>,
    ) -> Result<Vec<Measured>, String> {
        let levels: Vec<_> = levels.into_iter().collect();
        let program = std::env::current_exe()
            .map_err(|error| format!("the path of this program is unknown: {error}"))?;
        let mut reports: Vec<Vec<Vec<Report>>> = vec![Vec::new(); levels.len()];
        for _ in 0..self.options.copies() {
            for ((level, entries), reports) in levels.iter().zip(&mut reports) {
                let printed = copies::run(&program, &self.options.of_copy(level, entries))?;
                let parsed: Result<_, _> = printed.lines().map(serde_json::from_str).collect();
                reports
                    .push(parsed.map_err(|error| format!("the output of a copy is not a report: {error}"))?);
            }
        }
        Ok(levels.iter().zip(&reports).map(|((level, _), reports)| Measured::new(level, reports)).collect())
    }

    /// Judges the measurements; `whole` is a run of all entries.
    fn judge(&self, measured: &[Measured], whole: &[Measured]) -> Vec<Judged> {
        let judge_one = |level, group: &str, name: &str, ratio, entry: Option<&Pooled>| {
            let mark = mark(&self.budgets, &self.processor, level, group, name);
            let verdict = judge(ratio, mark);
            Judged {
                level,
                group: group.into(),
                name: name.into(),
                ratio,
                entry: entry.cloned(),
                mark,
                verdict,
            }
        };
        let entries = measured.iter().flat_map(|run| run.entries.iter().map(move |entry| (run.level, entry)));
        let mut judged: Vec<_> = entries
            .map(|(level, entry)| {
                let Figures { group, name, ratio, .. } = &entry.figures;
                judge_one(level, group, name, *ratio, Some(entry))
            })
            .collect();
        // The gain of a part of a group is not comparable.
        if let ([narrow, wide], [all, _], "") = (measured, whole, self.options.filter.as_str()) {
            let all: Vec<_> = all.entries.iter().map(|entry| entry.figures.clone()).collect();
            let (level, within) = GAIN;
            let gains = gains(&wide.entries, &narrow.entries, &all);
            judged.extend(gains.iter().map(|(group, ratio)| judge_one(level, within, group, *ratio, None)));
        }
        judged
    }

    fn print(&self, measured: &[Measured], judged: &[Judged]) {
        println!("{}: {} copies of {} rounds", self.processor, self.options.copies(), self.options.rounds());
        if judged.iter().any(Judged::is_held_to_another_processor) {
            println!(
                "What is held to a record was recorded on another processor, and may fall {:.0} %.",
                100.0 * TOLERANCE_ELSEWHERE
            );
        }
        for run in measured {
            table::head(run.level);
            for judged in judged.iter().filter(|judged| judged.level == run.level) {
                let Some(entry) = &judged.entry else { continue };
                table::row(&judged.title(), entry, judged.mark, judged.verdict);
            }
            for (name, why) in &run.left_out {
                table::left_out(name, why);
            }
        }
        let gains: Vec<_> = judged.iter().filter(|judged| judged.entry.is_none()).collect();
        if !gains.is_empty() {
            table::head_of_gains();
        }
        for gain in gains {
            table::gain(&gain.title(), gain.ratio, gain.mark, gain.verdict);
        }
    }

    /// Writes all entries except those that fell below a best. An entry that is too slow for the record of another
    /// processor becomes the first best of this one.
    fn record(&self, judged: &[Judged]) -> Result<(), String> {
        let mut budgets = self.budgets.clone();
        let is_kept = |judged: &&Judged| !judged.has_fallen() || judged.is_held_to_another_processor();
        for Judged { level, group, name, ratio, .. } in judged.iter().filter(is_kept) {
            budgets.record(&self.processor, level, group, name, *ratio);
        }
        budgets.write()?;
        println!("recorded in {}", Budgets::path().display());
        Ok(())
    }

    /// Returns an error if an entry fell.
    fn conclude(&self, judged: &[Judged]) -> Result<(), String> {
        let fallen: Vec<_> = judged.iter().filter(|judged| judged.has_fallen()).collect();
        if fallen.is_empty() || self.options.test {
            return Ok(());
        }
        let names = fallen.iter().map(|judged| {
            let below = judged.mark.map_or(f64::NAN, |mark| 100.0 * (1.0 - judged.ratio / mark.ratio));
            format!("{} at {} ({below:.0} %)", judged.title(), judged.level)
        });
        Err(format!(
            "{} of {} ratios fell too far below what they are held to: {}. Find out why (benches/README.md). If \
             something was gained in return, lower the best in {} by hand, with a table under [lowered] that says what.",
            fallen.len(),
            judged.len(),
            names.collect::<Vec<_>>().join(", "),
            Budgets::path().display()
        ))
    }
}

impl Measured {
    fn new(level: &'static str, copies: &[Vec<Report>]) -> Self {
        let figures = |copy: &Vec<Report>| -> Vec<Figures> {
            let figures = copy.iter().filter_map(|report| match report {
                Report::Measured(figures) => Some(figures.clone()),
                Report::LeftOut { .. } => None,
            });
            figures.collect()
        };
        let entries = pool(&copies.iter().map(figures).collect::<Vec<_>>());
        let mut left_out: Vec<(String, String)> = Vec::new();
        for report in copies.iter().flatten() {
            let Report::LeftOut { group, name, why } = report else { continue };
            let title = format!("{group}/{name}");
            let is_measured = entries.iter().any(|entry| entry.figures.title() == title);
            if !is_measured && left_out.iter().all(|(done, _)| *done != title) {
                left_out.push((title, why.clone()));
            }
        }
        Self { level, entries, left_out }
    }
}

/// Returns the entries to measure again at each level: those that fell, and all entries of a gain that fell.
fn to_repeat(whole: &[Measured], judged: &[Judged]) -> Vec<(&'static str, Vec<String>)> {
    let fallen = || judged.iter().filter(|judged| judged.has_fallen());
    let is_wanted = |level: &str, figures: &Figures| {
        fallen().any(|judged| match judged.entry {
            Some(_) => judged.level == level && judged.title() == figures.title(),
            None => judged.name == figures.group && figures.is_beside_parry(),
        })
    };
    if fallen().next().is_none() {
        return Vec::new();
    }
    let of_level = |run: &Measured| {
        let figures = run.entries.iter().map(|entry| &entry.figures);
        (run.level, figures.filter(|figures| is_wanted(run.level, figures)).map(Figures::title).collect())
    };
    let levels: Vec<(&str, Vec<String>)> = whole.iter().map(of_level).collect();
    levels.into_iter().filter(|(_, entries)| !entries.is_empty()).collect()
}

/// Keeps the better of both verdicts for entries that were judged again.
fn keep_best(judged: &mut [Judged], again: Vec<Judged>) {
    for later in again {
        let same = |earlier: &&mut Judged| {
            (earlier.level, &earlier.group, &earlier.name) == (later.level, &later.group, &later.name)
        };
        if let Some(earlier) = judged.iter_mut().find(same)
            && (later.ratio > earlier.ratio || earlier.ratio.is_nan())
        {
            *earlier = later;
        }
    }
}
