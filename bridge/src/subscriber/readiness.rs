//! [`Readiness`]: one file descriptor for all that a subscriber waits for, so that foreign event loops can.
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

/// Sleeps until the listener is notified, which it then takes note of, or the time has passed.
///
/// iceoryx2's own `timed_wait` does the same by seven system calls instead of two.
pub(crate) fn wait_for(listener: &Listener<Ipc>, timeout: Duration) -> io::Result<()> {
    let timeout =
        Timespec { tv_sec: timeout.as_secs().cast_signed(), tv_nsec: timeout.subsec_nanos().into() };
    if poll(&mut [PollFd::from_borrowed_fd(fd_of(listener), PollFlags::IN)], Some(&timeout))? > 0 {
        listener.try_wait(|_| {}).map_err(|_| io::Errno::INTR)?;
    }
    Ok(())
}

fn fd_of(listener: &Listener<Ipc>) -> BorrowedFd<'_> {
    // SAFETY: `native_handle` is unsafe because a descriptor that is closed or read elsewhere would break the
    // listener; it is only polled. `borrow_raw` asks for a descriptor that stays open for as long as it is borrowed:
    // the listener owns it, and the result borrows the listener.
    unsafe { BorrowedFd::borrow_raw(listener.file_descriptor().native_handle()) }
}

/// An epoll instance, which can itself be polled, over the listener of the moment and a timer.
///
/// The listener comes and goes with the publisher; the epoll instance stays, so that an event loop needs to be told
/// of one descriptor, once. The timer makes it readable when it is time to look for the publisher.
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
        // A first look at once: what came before is not announced again.
        readiness.look_again_in(Duration::from_nanos(1))?;
        Ok(readiness)
    }

    /// Readable from now on when this listener is, too; until that is closed, which the kernel notices.
    pub(crate) fn follow(&self, listener: &Listener<Ipc>) -> io::Result<()> {
        epoll::add(&self.epoll, fd_of(listener), epoll::EventData::new_u64(1), epoll::EventFlags::IN)
    }

    /// Not readable by the timer before this time has passed.
    pub(crate) fn look_again_in(&self, delay: Duration) -> io::Result<()> {
        let zero = Timespec { tv_sec: 0, tv_nsec: 0 };
        let delay = Timespec { tv_sec: delay.as_secs().cast_signed(), tv_nsec: delay.subsec_nanos().into() };
        let once = Itimerspec { it_interval: zero, it_value: delay };
        // Setting it also takes back an expiry that nobody has read.
        timerfd_settime(&self.timer, TimerfdTimerFlags::empty(), &once).map(drop)
    }
}

impl AsFd for Readiness {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.epoll.as_fd()
    }
}
