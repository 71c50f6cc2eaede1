//! The live status of a run: one line per stream, and the real-time factor.

mod table;

use super::log::{show_table, terminal};
use crate::description::text::count;
use crate::rig::{Outlet, Rig, Tally};
use std::collections::{HashMap, VecDeque};
use std::io::IsTerminal as _;
use std::time::{Duration, Instant};
use table::{Row, table};

/// Time between two refreshes on a terminal: a table with sixty changing lines takes 3 kB.
const REFRESH: Duration = Duration::from_secs(1);
/// Number of refreshes over which a rate is averaged.
const WINDOW: usize = 2;
/// Time between two log lines if there is no terminal.
const REPORT: Duration = Duration::from_secs(10);
/// Columns and rows assumed for a terminal that does not report its size.
const USUAL_TERMINAL: (usize, usize) = (80, 24);

/// Shows the progress of a run.
pub(super) struct Status {
    is_terminal: bool,
    /// The rig's edition when its streams were last read.
    edition: u64,
    /// State of each stream when it was added, by topic.
    since: HashMap<String, Mark>,
    history: VecDeque<Sample>,
    started: Sample,
    next: Instant,
}

/// The tally of a stream at a simulated time.
#[derive(Clone, Copy)]
struct Mark {
    time_ns: u64,
    tally: Tally,
}

/// All streams at a moment. They are keyed by topic because their indices change when other streams come and go.
struct Sample {
    at: Instant,
    time_ns: u64,
    streams: HashMap<String, Mark>,
}

impl Sample {
    fn now(rig: &Rig, time_ns: u64) -> Self {
        let mark = |outlet: &Outlet| (outlet.topic().to_owned(), Mark { time_ns, tally: outlet.tally() });
        Self { at: Instant::now(), time_ns, streams: rig.outlets().into_iter().map(mark).collect() }
    }
}

impl Status {
    pub(super) fn new(rig: &Rig) -> Self {
        let is_terminal = std::io::stderr().is_terminal();
        let started = Sample::now(rig, 0);
        Self {
            is_terminal,
            edition: rig.edition(),
            since: started.streams.clone(),
            history: VecDeque::new(),
            next: started.at + if is_terminal { REFRESH } else { REPORT },
            started,
        }
    }

    /// Refreshes the status if it is time.
    pub(super) fn refresh(&mut self, rig: &Rig, time_ns: u64) {
        self.follow(rig, time_ns);
        let now = Instant::now();
        if now < self.next {
            return;
        }
        let sample = Sample::now(rig, time_ns);
        let before = self.history.front().unwrap_or(&self.started);
        let total = total(rig, before, &sample);
        if self.is_terminal {
            self.next = now + REFRESH;
            let (columns, rows) = terminal().unwrap_or(USUAL_TERMINAL);
            show_table(table(&self.rows(rig, before, &sample), &total, columns, rows), columns);
        } else {
            self.next = now + REPORT;
            tracing::info!("{total}");
        }
        self.history.push_back(sample);
        if self.history.len() > WINDOW {
            self.history.pop_front();
        }
    }

    /// Removes the live lines, so that other output can follow.
    pub(super) fn hide(&mut self) {
        if self.is_terminal {
            show_table(Vec::new(), terminal().unwrap_or(USUAL_TERMINAL).0);
        }
    }

    /// Returns the table over the whole run.
    pub(super) fn finish(mut self, rig: &Rig, time_ns: u64) -> String {
        self.follow(rig, time_ns);
        let columns = self.is_terminal.then(|| terminal().unwrap_or(USUAL_TERMINAL).0);
        let sample = Sample::now(rig, time_ns);
        let whole = Sample { streams: self.since.clone(), ..self.started };
        let rows = self.rows(rig, &whole, &sample);
        let total = total(rig, &whole, &sample);
        table(&rows, &total, columns.unwrap_or(usize::MAX), usize::MAX).join("\n") + "\n"
    }

    /// Starts to count new streams and forgets removed ones.
    fn follow(&mut self, rig: &Rig, time_ns: u64) {
        if self.edition == rig.edition() {
            return;
        }
        self.edition = rig.edition();
        let mut now = Sample::now(rig, time_ns).streams;
        for (topic, mark) in &mut now {
            // A stream that has sent fewer frames than before is a new one on the same topic.
            let since = self.since.get(topic).filter(|since| since.tally.frames <= mark.tally.frames);
            *mark = since.copied().unwrap_or(*mark);
        }
        self.since = now;
        self.history.clear();
    }

    fn rows(&self, rig: &Rig, before: &Sample, now: &Sample) -> Vec<Row> {
        let row = |outlet: &Outlet| {
            let topic = outlet.topic();
            let now = Mark { time_ns: now.time_ns, tally: outlet.tally() };
            let before = before.streams.get(topic).or(self.since.get(topic)).copied().unwrap_or(now);
            Row::new(topic, outlet.rate_hz(), outlet.subscribers(), &before, &now)
        };
        rig.outlets().into_iter().map(row).collect()
    }
}

impl Row {
    fn new(topic: &str, asked_hz: Option<f64>, subscribers: usize, before: &Mark, now: &Mark) -> Self {
        let frames = now.tally.frames.saturating_sub(before.tally.frames);
        let seconds = now.time_ns.saturating_sub(before.time_ns) as f64 * 1e-9;
        let is_idle = frames == 0 && subscribers == 0;
        let rate = match asked_hz {
            Some(_) if is_idle => "idle".into(),
            None if frames == 0 => "-".into(),
            _ if seconds == 0.0 => "-".into(),
            _ => format!("{:.2}", frames as f64 / seconds),
        };
        let asked = asked_hz.map_or_else(|| "on event".into(), |asked| format!("{asked:.2}"));
        let busy_ms = now.tally.busy.saturating_sub(before.tally.busy).as_secs_f64() * 1e3;
        let is_made = !now.tally.busy.is_zero() && frames > 0;
        let made = if is_made { format!("{:.2}", busy_ms / frames as f64) } else { "-".into() };
        let cells = [rate, asked, subscribers.to_string(), now.tally.dropped.to_string(), made];
        Self { topic: topic.to_owned(), cells, is_idle }
    }
}

fn total(rig: &Rig, before: &Sample, now: &Sample) -> String {
    let Tally { frames, dropped, .. } = rig.tally();
    let simulated_s = now.time_ns.saturating_sub(before.time_ns) as f64 * 1e-9;
    let factor = simulated_s / (now.at - before.at).as_secs_f64().max(1e-9);
    let time_s = now.time_ns as f64 * 1e-9;
    format!(
        "{time_s:.1} s simulated, real-time factor {factor:.3}, {}, {dropped} dropped",
        count(frames, "frame")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_in_simulated_time_and_never_absurd() {
        let mark = |time_s: u64, frames| Mark {
            time_ns: time_s * 1_000_000_000,
            tally: Tally { frames, ..Tally::default() },
        };
        let rate = |asked, subscribers, before, now| {
            let [rate, asked, ..] = Row::new("/t", asked, subscribers, &before, &now).cells;
            (rate, asked)
        };
        let is = |rate: &str, asked: &str| (rate.to_owned(), asked.to_owned());
        assert_eq!(rate(Some(30.0), 1, mark(10, 50), mark(12, 110)), is("30.00", "30.00"));
        assert_eq!(rate(Some(30.0), 0, mark(10, 50), mark(12, 50)), is("idle", "30.00"));
        assert_eq!(rate(Some(30.0), 1, mark(10, 50), mark(12, 50)), is("0.00", "30.00"));
        // Paused.
        assert_eq!(rate(Some(30.0), 1, mark(10, 50), mark(10, 50)), is("-", "30.00"));
        assert_eq!(rate(None, 1, mark(10, 1), mark(12, 1)), is("-", "on event"));
        assert_eq!(rate(None, 0, mark(10, 1), mark(12, 5)), is("2.00", "on event"));
        // A new stream on the same topic.
        assert_eq!(rate(Some(30.0), 1, mark(10, 500), mark(12, 3)), is("0.00", "30.00"));
    }
}
