//! The sleep of a client's thread.

use super::pipe::Pipe;
use super::socket::Socket;
use belvedere_bridge::Subscriber;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::time::Duration;

/// Sleeps until the client sends a message, or one of these streams has a frame. While data still waits to be sent
/// through the socket or `pipe`, the connection for frames, waits for room there instead of for frames.
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
    // While the client is slow, frames stay in shared memory, where the oldest are overwritten.
    for subscriber in followed.filter(|_| !unsent) {
        if let Ok(readiness) = subscriber.readiness() {
            fds.push(PollFd::from_borrowed_fd(readiness, PollFlags::IN));
        }
    }
    let nap = Timespec { tv_sec: 0, tv_nsec: i64::from(at_most.subsec_nanos()) };
    // If the sleep is interrupted, the caller just checks again earlier.
    let _ = poll(&mut fds, Some(&nap));
}
