//! How a client's thread sleeps.

use super::pipe::Pipe;
use super::socket::Socket;
use belvedere_bridge::Subscriber;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::time::Duration;

/// Sleeps until the client says something, or one of these streams has something for it. While it does not take what was
/// sent, by its socket or by `pipe`, the connection for frames, it is waited for that instead.
pub(super) fn wait<'a>(
    socket: &Socket,
    pipe: Option<&Pipe>,
    followed: impl Iterator<Item = &'a mut Subscriber>,
    at_most: Duration,
) {
    let flags = if socket.has_unsent() { PollFlags::OUT } else { PollFlags::IN };
    let mut fds = vec![PollFd::from_borrowed_fd(socket.descriptor(), flags)];
    let full = pipe.filter(|pipe| pipe.has_unsent());
    if let Some(pipe) = full {
        fds.push(PollFd::from_borrowed_fd(pipe.descriptor(), PollFlags::OUT));
    }
    let unsent = socket.has_unsent() || full.is_some();
    // While the client is slow, frames wait where they are, and the oldest give way.
    for subscriber in followed.filter(|_| !unsent) {
        if let Ok(readiness) = subscriber.readiness() {
            fds.push(PollFd::from_borrowed_fd(readiness, PollFlags::IN));
        }
    }
    let nap = Timespec { tv_sec: 0, tv_nsec: i64::from(at_most.subsec_nanos()) };
    // Interrupted: looked at again at once.
    let _ = poll(&mut fds, Some(&nap));
}
