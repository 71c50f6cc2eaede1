//! Measures one entry after the other in this process, and prints the figures for the process that judges.

use super::clock::Clock;
pub use super::figures::Unit;
use super::figures::{Figures, Report};
use super::measure::{Side, measure};
use super::options::Options;
use std::io::{Stdout, Write as _, stdout};

/// An entry to be measured.
#[derive(Debug, Clone, Copy)]
pub struct Entry<'a> {
    /// A scene, or `frames`.
    pub group: &'a str,
    /// The name in its group.
    pub name: &'a str,
    /// The unit of both figures.
    pub unit: Unit,
    /// The name of the other side.
    pub peer: &'a str,
    /// The clock.
    pub clock: Clock,
}

/// A run that measures entries.
pub struct Gate<'a> {
    pub options: &'a Options,
    /// The destination of the figures.
    out: Stdout,
}

impl<'a> Gate<'a> {
    pub fn new(options: &'a Options) -> Self {
        Self { options, out: stdout() }
    }

    /// Prints why an entry is not measured.
    pub fn leave_out(&mut self, group: &str, name: &str, why: &str) {
        self.print(&Report::LeftOut { group: group.into(), name: name.into(), why: why.into() });
    }

    /// Measures an entry and prints its figures.
    pub fn run(
        &mut self,
        entry: Entry<'_>,
        (ours, ours_work): (&mut dyn FnMut(), f64),
        (theirs, theirs_work): (&mut dyn FnMut(), f64),
    ) {
        let ours = Side { call: ours, work: ours_work };
        let theirs = Side { call: theirs, work: theirs_work };
        let measured = measure(entry.clock, self.options.rounds(), ours, theirs);
        self.print(&Report::Measured(Figures {
            group: entry.group.into(),
            name: entry.name.into(),
            unit: entry.unit,
            peer: entry.peer.into(),
            ours_s: measured.ours_s,
            theirs_s: measured.theirs_s,
            ratio: measured.ratio,
        }));
    }

    fn print(&mut self, report: &Report) {
        let line = serde_json::to_string(report).expect("texts and numbers");
        writeln!(self.out, "{line}").expect("somebody takes the figures");
    }
}
