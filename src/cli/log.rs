//! Logging to standard error, which leaves the live status whole.

use indicatif::MultiProgress;
use std::io::{self, IsTerminal as _, Write};
use std::sync::OnceLock;
use tracing_subscriber::EnvFilter;

/// What is shown without `RUST_LOG`. Zenoh tells at length of each connection that is lost; a link says so itself.
const DEFAULT_FILTER: &str = "warn,belvedere=info,zenoh=off";

/// The lines of the live status, if there is one: log lines go above them.
pub fn status_lines() -> &'static MultiProgress {
    static LINES: OnceLock<MultiProgress> = OnceLock::new();
    LINES.get_or_init(MultiProgress::new)
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
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        status_lines().suspend(|| io::stderr().write(text))
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stderr().flush()
    }
}
