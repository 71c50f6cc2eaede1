//! The live status of a run: one line per stream, and the real-time factor.

use super::log::status_lines;
use crate::rig::{Outlet, Rig, Tally};
use indicatif::{ProgressBar, ProgressStyle};
use std::collections::VecDeque;
use std::fmt::Write as _;
use std::io::IsTerminal as _;
use std::time::{Duration, Instant};

/// Time between two refreshes on a terminal.
const REFRESH: Duration = Duration::from_millis(500);
/// Refreshes over which a rate is taken.
const WINDOW: usize = 4;
/// Time between two log lines where there is no terminal.
const REPORT: Duration = Duration::from_secs(10);

/// Shows how a run goes.
pub(super) struct Status {
    lines: Option<Vec<ProgressBar>>,
    history: VecDeque<Sample>,
    started: Sample,
    next: Instant,
}

struct Sample {
    at: Instant,
    time_ns: u64,
    tallies: Vec<Tally>,
}

impl Sample {
    fn now(rig: &Rig, time_ns: u64) -> Self {
        Self {
            at: Instant::now(),
            time_ns,
            tallies: rig.outlets().iter().map(|outlet| outlet.tally()).collect(),
        }
    }
}

impl Status {
    pub(super) fn new(rig: &Rig) -> Self {
        let lines = std::io::stderr().is_terminal().then(|| {
            let style =
                ProgressStyle::with_template("{msg}").unwrap_or_else(|_| ProgressStyle::default_spinner());
            let line = || status_lines().add(ProgressBar::new_spinner().with_style(style.clone()));
            // One per stream, a heading above, the whole below.
            (0..rig.outlets().len() + 2).map(|_| line()).collect()
        });
        let period = if lines.is_some() { REFRESH } else { REPORT };
        Self { lines, history: VecDeque::new(), started: Sample::now(rig, 0), next: Instant::now() + period }
    }

    /// Refreshes the status if it is time.
    pub(super) fn refresh(&mut self, rig: &Rig, time_ns: u64) {
        let now = Instant::now();
        if now < self.next {
            return;
        }
        let sample = Sample::now(rig, time_ns);
        let before = self.history.front().unwrap_or(&self.started);
        if let Some(lines) = &self.lines {
            self.next = now + REFRESH;
            let outlets = rig.outlets();
            let text = table(&outlets, before, &sample);
            for (line, text) in lines.iter().zip(text.lines()) {
                line.set_message(text.to_owned());
            }
        } else {
            self.next = now + REPORT;
            let (frames, dropped) = totals(&sample);
            tracing::info!(
                "{:.1} s simulated, real-time factor {:.3}, {frames} frames, {dropped} dropped",
                time_ns as f64 * 1e-9,
                factor(before, &sample)
            );
        }
        self.history.push_back(sample);
        if self.history.len() > WINDOW {
            self.history.pop_front();
        }
    }

    /// Takes the live lines away and gives the table over the whole run.
    pub(super) fn finish(self, rig: &Rig, time_ns: u64) -> String {
        for line in self.lines.iter().flatten() {
            line.finish_and_clear();
        }
        table(&rig.outlets(), &self.started, &Sample::now(rig, time_ns))
    }
}

fn table(outlets: &[&Outlet], before: &Sample, now: &Sample) -> String {
    let topics: Vec<&str> = outlets.iter().map(|outlet| outlet.topic()).collect();
    let width = topics.iter().map(|topic| topic.len()).max().unwrap_or(0).max(5);
    let seconds = (now.at - before.at).as_secs_f64().max(1e-9);
    let mut text = format!(
        "{:width$} {:>9} {:>9} {:>11} {:>8} {:>10}\n",
        "TOPIC", "RATE Hz", "ASKED Hz", "SUBSCRIBERS", "DROPPED", "FRAME ms"
    );
    for (index, outlet) in outlets.iter().enumerate() {
        let (earlier, tally) = (&before.tallies[index], &now.tallies[index]);
        let frames = tally.frames - earlier.frames;
        let made_ms = tally.busy.saturating_sub(earlier.busy).as_secs_f64() * 1e3 / frames.max(1) as f64;
        let asked = outlet.rate_hz().map_or_else(|| "-".into(), |rate| format!("{rate:.2}"));
        let made = if tally.busy.is_zero() { "-".into() } else { format!("{made_ms:.2}") };
        let subscribers = outlet.subscribers();
        let rate = match frames as f64 / seconds {
            0.0 if subscribers == 0 && outlet.rate_hz().is_some() => "idle".into(),
            rate => format!("{rate:.2}"),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:width$} {rate:>9} {asked:>9} {subscribers:>11} {:>8} {made:>10}",
            topics[index], tally.dropped,
        );
    }
    let (frames, dropped) = totals(now);
    let _ = writeln!(
        text,
        "{:.1} s simulated, real-time factor {:.3}, {frames} frames, {dropped} dropped",
        now.time_ns as f64 * 1e-9,
        factor(before, now)
    );
    text
}

fn totals(sample: &Sample) -> (u64, u64) {
    sample
        .tallies
        .iter()
        .fold((0, 0), |(frames, dropped), tally| (frames + tally.frames, dropped + tally.dropped))
}

fn factor(before: &Sample, now: &Sample) -> f64 {
    (now.time_ns - before.time_ns) as f64 * 1e-9 / (now.at - before.at).as_secs_f64().max(1e-9)
}
