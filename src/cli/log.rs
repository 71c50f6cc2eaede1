//! Logging to standard error, above the live status.

use super::live_lines::LiveLines;
use indicatif::MultiProgress;
use std::io::{self, IsTerminal as _, Write};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use terminal_size::terminal_size_of;
use tracing_subscriber::EnvFilter;

/// The filter without `RUST_LOG`. Zenoh is silenced because it logs each lost connection at length; `belvedere link`
/// reports it itself.
const DEFAULT_FILTER: &str = "warn,belvedere=info,zenoh=off";

/// The progress bars, if any: log lines are written above them.
pub fn status_lines() -> &'static MultiProgress {
    static LINES: OnceLock<MultiProgress> = OnceLock::new();
    LINES.get_or_init(MultiProgress::new)
}

/// The table of a run, if any: log lines are written above it.
static TABLE: Mutex<LiveLines> = Mutex::new(LiveLines::new());

fn table() -> MutexGuard<'static, LiveLines> {
    TABLE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns columns and rows of the terminal on standard error, or `None` if it is not a terminal or reports no size.
pub(super) fn terminal() -> Option<(usize, usize)> {
    let (columns, rows) = terminal_size_of(io::stderr())?;
    Some((columns.0.into(), rows.0.into()))
}

/// Replaces the lines at the bottom of the terminal.
pub(super) fn show_table(lines: Vec<String>, columns: usize) {
    let mut table = table();
    write_codes(&table.draw(lines, columns));
}

/// Writes to the terminal. Errors are ignored, because a closed terminal shows no table.
fn write_codes(codes: &str) {
    let mut terminal = io::stderr().lock();
    let _ = terminal.write_all(codes.as_bytes()).and_then(|()| terminal.flush());
}

/// Starts logging with the filter in `RUST_LOG`.
pub(super) fn start() {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(DEFAULT_FILTER));
    // This fails only if a program that uses this library has already set up logging, which then stays in effect.
    let _ = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_target(false)
        .without_time()
        .with_ansi(
            io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|set| set.is_empty()),
        )
        .with_writer(|| AboveStatus)
        .try_init();
}

struct AboveStatus;

impl Write for AboveStatus {
    /// Always reports success: a log that cannot be written must not end the simulation.
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        let mut table = table();
        match terminal().filter(|_| table.is_shown()) {
            Some((columns, _)) => write_codes(&table.write_above(&String::from_utf8_lossy(text), columns)),
            None => drop(status_lines().suspend(|| io::stderr().write_all(text))),
        }
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stderr().flush()
    }
}
