//! Measures one entry after the other, and judges.

use super::clock::Clock;
use super::measure::{Measured, Side, measure};
use super::options::Options;
use super::verdict::{TOLERANCE, Verdict, judge};
use crate::budgets::Budgets;

/// An entry that seems to have fallen is measured so many times, and the best counts: noise passes. What is
/// recorded is the worst of as many.
const TRIES: usize = 3;

/// How the figures of an entry are printed.
#[derive(Debug, Clone, Copy)]
pub enum Unit {
    /// Million units of work a second.
    Rate,
    /// Milliseconds a unit of work.
    Time,
}

/// What is compared.
#[derive(Debug, Clone, Copy)]
pub struct Entry<'a> {
    /// A scene, or `frames`.
    pub group: &'a str,
    /// In its group.
    pub name: &'a str,
    /// Of both figures.
    pub unit: Unit,
    /// What the other side is.
    pub peer: &'a str,
    /// Which time.
    pub clock: Clock,
}

/// The run.
pub struct Gate<'a> {
    pub options: &'a Options,
    pub level: &'static str,
    pub processor: String,
    pub budgets: Budgets,
    /// How far ratios may fall.
    pub tolerance: f64,
    /// Names of those that fell.
    pub fallen: Vec<String>,
    /// How many were measured.
    pub measured: usize,
    /// How many could not be.
    pub left_out: usize,
}

impl<'a> Gate<'a> {
    pub fn new(
        options: &'a Options,
        (level, processor): (&'static str, String),
        budgets: Budgets,
        tolerance: f64,
    ) -> Self {
        Self { options, level, processor, budgets, tolerance, fallen: Vec::new(), measured: 0, left_out: 0 }
    }

    /// The head of the table.
    pub fn print_head(&self) {
        println!(
            "{:<22} {:>16} {:>16}  {:<22} {:>8} {:>9}  verdict ({})",
            "entry", "belvedere", "other", "the other is", "ratio", "recorded", self.level
        );
    }

    /// Says why an entry is not measured.
    pub fn leave_out(&mut self, group: &str, name: &str, why: &str) {
        self.left_out += 1;
        println!("{:<22} not measured: {why}", format!("{group}/{name}"));
    }

    /// Measures an entry, prints its line and keeps or records its ratio.
    pub fn run(
        &mut self,
        entry: Entry<'_>,
        (ours, ours_work): (&mut dyn FnMut(), f64),
        (theirs, theirs_work): (&mut dyn FnMut(), f64),
    ) {
        let elsewhere = self.budgets.ratio_elsewhere(&self.processor, self.level, entry.group, entry.name);
        let tolerance = elsewhere.map_or(self.tolerance, |_| TOLERANCE);
        let recorded = elsewhere.or_else(|| self.budgets.ratio(self.level, entry.group, entry.name));
        let mut kept: Option<(Measured, Verdict)> = None;
        for _ in 0..TRIES {
            let ours = Side { call: &mut *ours, work: ours_work };
            let theirs = Side { call: &mut *theirs, work: theirs_work };
            let measured = measure(entry.clock, self.options.rounds(), ours, theirs);
            let verdict = judge(measured.ratio, recorded, tolerance);
            let keep = |(kept, _): (Measured, Verdict)| {
                if self.options.record { measured.ratio < kept.ratio } else { measured.ratio > kept.ratio }
            };
            if kept.is_none_or(keep) {
                kept = Some((measured, verdict));
            }
            if self.options.test || verdict != Verdict::Falls && !self.options.record {
                break;
            }
        }
        let Some((measured, verdict)) = kept else { return };
        self.measured += 1;
        let name = format!("{}/{}", entry.group, entry.name);
        println!(
            "{name:<22} {:>16} {:>16}  {:<22} {:>7.2}× {:>9}  {verdict}",
            entry.unit.show(measured.ours_s),
            entry.unit.show(measured.theirs_s),
            entry.peer,
            measured.ratio,
            recorded.map_or("–".into(), |recorded| format!("{recorded:.2}×")),
        );
        if self.options.record {
            self.budgets.record(self.level, entry.group, entry.name, measured.ratio);
        } else if verdict == Verdict::Falls {
            self.fallen.push(name);
        }
    }
}

impl Unit {
    fn show(self, seconds: f64) -> String {
        match self {
            Self::Rate => format!("{:.2} Mray/s", 1e-6 / seconds),
            Self::Time => format!("{:.3} ms", 1e3 * seconds),
        }
    }
}
