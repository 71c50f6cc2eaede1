//! How many files this process may have open, and whether that is why something failed.
//!
//! Each stream costs its publisher some 6 descriptors, so that several robots need more than the usual soft limit of
//! 1,024. iceoryx2's errors do not say that a limit was reached, and some of its steps take it for a stream that is not
//! there; so a few descriptors are asked for before each step.

use std::io;

use rustix::{
    event::{EventfdFlags, eventfd},
    process::{Resource, Rlimit, getrlimit, setrlimit},
};

/// More than any one step opens: joining a domain, opening a stream, making a port.
const AT_ONCE: usize = 12;
/// What is proposed to those whose limit is too low.
const PROPOSED: u64 = 65_536;

/// Raises this process's limit of open files as far as it may without privileges, from its soft limit to its hard one,
/// and gives what it is now; `None` where there is none.
///
/// For a program to call at its start, before it opens many streams; the library does not change a limit by itself. A
/// program that uses `select`, which knows no descriptor above 1,023, should not call it.
///
/// ```
/// let limit = belvedere_bridge::open_files::raise_limit()?;
/// assert_eq!(belvedere_bridge::open_files::raise_limit()?, limit);
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// When the system refuses it.
pub fn raise_limit() -> io::Result<Option<u64>> {
    let Rlimit { current, maximum } = getrlimit(Resource::Nofile);
    if current != maximum {
        setrlimit(Resource::Nofile, Rlimit { current: maximum, maximum })?;
    }
    Ok(maximum)
}

/// The limit of a process that may not open as many files as a step needs.
pub(crate) struct Reached {
    /// The soft limit.
    pub(crate) limit: u64,
    /// How to raise it.
    pub(crate) remedy: String,
}

/// The limit of this process, if fewer files than a step needs may still be opened. It takes some microseconds.
pub(crate) fn limit_reached() -> Option<Reached> {
    // They are opened and closed again, since a count of those that are open takes longer, and a descriptor itself.
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

/// How a limit is raised whose hard limit is `hard`.
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
