//! The limit of open files, and whether it is the cause of a failure.
//!
//! Each stream takes 7 descriptors of its publisher, so several robots need more than the usual soft limit of
//! 1,024. iceoryx2's errors do not say that the limit was reached, and some of its steps treat it as a stream that does
//! not exist. So the bridge checks before each step that a few descriptors are available.

use std::io;

use rustix::{
    event::{EventfdFlags, eventfd},
    process::{Resource, Rlimit, getrlimit, setrlimit},
};

/// An upper bound on the files that one step opens: joining a domain, opening a stream, creating a port.
const AT_ONCE: usize = 12;
/// The limit that error messages propose.
const PROPOSED: u64 = 65_536;

/// Raises this process's soft limit of open files to its hard limit, which needs no privileges. Returns the new limit;
/// `None` if there is none.
///
/// A program that opens many streams calls this at its start; the library does not change limits by itself. A program
/// that uses `select`, which supports no descriptor above 1,023, should not call it.
///
/// ```
/// let limit = belvedere_bridge::open_files::raise_limit()?;
/// assert_eq!(belvedere_bridge::open_files::raise_limit()?, limit);
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// If the system refuses to raise the limit.
pub fn raise_limit() -> io::Result<Option<u64>> {
    let Rlimit { current, maximum } = getrlimit(Resource::Nofile);
    if current != maximum {
        setrlimit(Resource::Nofile, Rlimit { current: maximum, maximum })?;
    }
    Ok(maximum)
}

/// The limit of a process that cannot open as many files as a step needs.
pub(crate) struct Reached {
    /// The soft limit.
    pub(crate) limit: u64,
    /// How to raise it.
    pub(crate) remedy: String,
}

/// Returns the limit of this process if fewer files than a step needs can still be opened. Takes some microseconds.
pub(crate) fn limit_reached() -> Option<Reached> {
    // The files are opened and closed again: counting the open ones takes longer, and a descriptor itself.
    let more = eventfd(0, EventfdFlags::CLOEXEC).and_then(|first| {
        (1..AT_ONCE).map(|_| rustix::io::fcntl_dupfd_cloexec(&first, 0)).collect::<Result<Vec<_>, _>>()
    });
    if more.err() != Some(rustix::io::Errno::MFILE) {
        return None;
    }
    let Rlimit { current, maximum } = getrlimit(Resource::Nofile);
    let limit = current.unwrap_or(u64::MAX);
    Some(Reached { limit, remedy: remedy(limit, maximum) })
}

/// Returns how to raise a limit with this soft and hard value.
fn remedy(soft: u64, hard: Option<u64>) -> String {
    match hard {
        Some(hard) if hard <= soft => format!(
            "that is also the hard limit, which an administrator raises: LimitNOFILE={PROPOSED} in a systemd unit, docker run --ulimit nofile={PROPOSED}, or a line in /etc/security/limits.conf"
        ),
        hard => {
            let proposed = hard.unwrap_or(PROPOSED).min(PROPOSED).max(soft.saturating_add(1));
            format!("raise it in the shell that starts this program: ulimit -n {proposed}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_remedy_is_one_that_this_user_can_take() {
        assert!(remedy(1024, Some(4096)).ends_with("ulimit -n 4096"));
        assert!(remedy(1024, Some(1 << 20)).ends_with("ulimit -n 65536"));
        assert!(remedy(1024, None).ends_with("ulimit -n 65536"));
        assert!(remedy(100_000, Some(200_000)).ends_with("ulimit -n 100001"));
        assert!(remedy(u64::MAX, None).contains("ulimit -n"));
        let hard = remedy(64, Some(64));
        assert!(hard.contains("hard limit") && hard.contains("--ulimit nofile="), "{hard}");
    }
}
