//! Logging to standard error, which leaves the live status whole.

use super::live_lines::LiveLines;
use indicatif::MultiProgress;
use std::io::{self, IsTerminal as _, Write};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use terminal_size::terminal_size_of;
use tracing_subscriber::EnvFilter;

/// What is shown without `RUST_LOG`. Zenoh tells at length of each connection that is lost; a link says so itself.
const DEFAULT_FILTER: &str = "warn,belvedere=info,zenoh=off";

/// The progress bars, if there are some: log lines go above them.
pub fn status_lines() -> &'static MultiProgress {
    static LINES: OnceLock<MultiProgress> = OnceLock::new();
    LINES.get_or_init(MultiProgress::new)
}

/// The table of a run, if there is one: log lines go above it.
static TABLE: Mutex<LiveLines> = Mutex::new(LiveLines::new());

fn table() -> MutexGuard<'static, LiveLines> {
    TABLE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Columns and rows of the terminal that standard error goes to; none if it goes elsewhere, or the terminal does not know.
pub(super) fn terminal() -> Option<(usize, usize)> {
    let (columns, rows) = terminal_size_of(io::stderr())?;
    Some((columns.0.into(), rows.0.into()))
}

/// Shows these lines at the bottom of the terminal from now on, in the place of those before.
pub(super) fn show_table(lines: Vec<String>, columns: usize) {
    let mut table = table();
    write_codes(&table.draw(lines, columns));
}

/// Writes what has to be written to the terminal. Nobody reads a table in a terminal that is gone.
fn write_codes(codes: &str) {
    let mut terminal = io::stderr().lock();
    let _ = terminal.write_all(codes.as_bytes()).and_then(|()| terminal.flush());
}

/// Starts logging as `RUST_LOG` asks.
pub(super) fn start() {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(DEFAULT_FILTER));
    // Fails only if a program that uses this library has already set up its own logging; then that holds.
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
    /// Takes the whole text even where it cannot be written: a log that nobody reads ends no simulation.
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
