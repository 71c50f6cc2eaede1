//! [`Readiness`]: one file descriptor for everything that a subscriber waits for, for use in other event loops.
#![allow(unsafe_code)]

use std::{
    os::fd::{AsFd, BorrowedFd, OwnedFd},
    time::Duration,
};

use iceoryx2::{port::listener::Listener, prelude::FileDescriptorBased as _};
use rustix::{
    event::{PollFd, PollFlags, epoll, poll},
    io,
    time::{
        Itimerspec, TimerfdClockId, TimerfdFlags, TimerfdTimerFlags, Timespec, timerfd_create,
        timerfd_settime,
    },
};

use crate::domain::Ipc;

/// Sleeps until the listener is notified or the timeout passes. Clears the notification.
///
/// iceoryx2's own `timed_wait` does the same with seven system calls instead of two.
pub(crate) fn wait_for(listener: &Listener<Ipc>, timeout: Duration) -> io::Result<()> {
    let timeout =
        Timespec { tv_sec: timeout.as_secs().cast_signed(), tv_nsec: timeout.subsec_nanos().into() };
    poll(&mut [PollFd::from_borrowed_fd(fd_of(listener), PollFlags::IN)], Some(&timeout))?;
    // Also after a timeout. iceoryx2 0.10 can lose the datagram of a notification that is sent while it clears another
    // one (`drain_events` reads the socket twice), and still counts it as sent. Until the notification is cleared, no
    // notifier sends another datagram, and the descriptor stays unreadable for ever.
    listener.try_wait(|_| {}).map(drop).map_err(|_| io::Errno::INTR)
}

fn fd_of(listener: &Listener<Ipc>) -> BorrowedFd<'_> {
    // SAFETY: `native_handle` is unsafe because a descriptor that is closed or read elsewhere would break the
    // listener; it is only polled. `borrow_raw` asks for a descriptor that stays open for as long as it is borrowed:
    // the listener owns it, and the result borrows the listener.
    unsafe { BorrowedFd::borrow_raw(listener.file_descriptor().native_handle()) }
}

/// An epoll instance, which can itself be polled, over the current listener and a timer.
///
/// The listener changes with the publisher, but the epoll instance stays, so that an event loop registers one
/// descriptor, once. The timer makes it readable when the publisher must be checked.
#[derive(Debug)]
pub(crate) struct Readiness {
    epoll: OwnedFd,
    timer: OwnedFd,
}

impl Readiness {
    pub(crate) fn new() -> io::Result<Self> {
        let epoll = epoll::create(epoll::CreateFlags::CLOEXEC)?;
        let timer =
            timerfd_create(TimerfdClockId::Monotonic, TimerfdFlags::CLOEXEC | TimerfdFlags::NONBLOCK)?;
        epoll::add(&epoll, &timer, epoll::EventData::new_u64(0), epoll::EventFlags::IN)?;
        let readiness = Self { epoll, timer };
        // Check at once: frames that arrived earlier are not announced again.
        readiness.look_again_in(Duration::from_nanos(1))?;
        Ok(readiness)
    }

    /// Makes the descriptor readable when this listener is notified, until the listener is closed, which the kernel
    /// detects.
    pub(crate) fn follow(&self, listener: &Listener<Ipc>) -> io::Result<()> {
        epoll::add(&self.epoll, fd_of(listener), epoll::EventData::new_u64(1), epoll::EventFlags::IN)
    }

    /// Sets the timer, so that it makes the descriptor readable after `delay` and not before.
    pub(crate) fn look_again_in(&self, delay: Duration) -> io::Result<()> {
        let zero = Timespec { tv_sec: 0, tv_nsec: 0 };
        let delay = Timespec { tv_sec: delay.as_secs().cast_signed(), tv_nsec: delay.subsec_nanos().into() };
        let once = Itimerspec { it_interval: zero, it_value: delay };
        // Setting the timer also clears an unread expiry.
        timerfd_settime(&self.timer, TimerfdTimerFlags::empty(), &once).map(drop)
    }
}

impl AsFd for Readiness {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.epoll.as_fd()
    }
}

#[cfg(test)]
mod tests {
    use std::{os::unix::net::UnixDatagram, time::Instant};

    use super::*;
    use crate::{Domain, Kind, Node, StreamSpec, stream};

    #[test]
    fn a_lost_datagram_delays_one_wait_and_not_all_later_ones() {
        let domain = Domain::new(&format!("lost-datagram-{}", std::process::id())).unwrap();
        let node = Node::open(&domain, "test").unwrap();
        let spec = StreamSpec::structs("clock", Kind::Clock, 1);
        let (_frames, events) = stream::open_or_create(&node, &spec).unwrap();
        let (listener, notifier) =
            (events.listener_builder().create().unwrap(), events.notifier_builder().create().unwrap());
        notifier.notify().unwrap();
        let socket = UnixDatagram::from(fd_of(&listener).try_clone_to_owned().unwrap());
        assert_eq!(socket.recv(&mut [0; 8]).unwrap(), 1);

        let long = Duration::from_secs(60);
        wait_for(&listener, Duration::from_millis(1)).unwrap();
        notifier.notify().unwrap();
        let begin = Instant::now();
        wait_for(&listener, long).unwrap();
        assert!(begin.elapsed() < long, "the second notification does not wake it");
    }
}
