"""A descriptor that tells other event loops of a listener, which has none in Python."""

from __future__ import annotations

import contextlib
import os
import select
import threading
from typing import Any, Protocol

import iceoryx2 as iox2

#: Seconds between two looks for a stream that is not there.
SEARCH_INTERVAL = 0.02
#: Seconds that a wait sleeps at most before it looks whether the publisher is still there.
WATCH_INTERVAL = 0.1


class Listening(Protocol):
    """What has a listener of iceoryx2."""

    listener: Any


class Readiness:
    """An eventfd that is readable from a ring to the next clear, and a thread that rings.

    It rings when the listener of the moment is notified, and when it is time to look for the publisher.
    """

    def __init__(self) -> None:
        self.fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        self._state = _State(self.fd)
        self._thread = threading.Thread(target=self._state.listen, name="belvedere-readiness")
        # A first look at once: what came before is not announced again.
        self.ring()
        self._thread.start()

    def follow(self, connection: Listening | None) -> None:
        """Listen to this one from now on, or to none."""
        self._state.connection = connection

    def ring(self) -> None:
        """Make it readable."""
        os.eventfd_write(self.fd, 1)

    def clear(self) -> None:
        """Make it unreadable."""
        with contextlib.suppress(BlockingIOError):
            os.eventfd_read(self.fd)

    def wait(self, timeout: float) -> None:
        """Sleep until it rings."""
        poll = select.poll()
        poll.register(self.fd, select.POLLIN)
        poll.poll(timeout * 1000)
        self.clear()

    def close(self) -> None:
        """End the thread, then the descriptor."""
        if not self._state.closed:
            self._state.closed = True
            self._thread.join()
            os.close(self.fd)

    def __del__(self) -> None:
        self.close()


class _State:
    """What the thread knows: not its ``Readiness``, which could not go while the thread runs."""

    def __init__(self, fd: int) -> None:
        self.fd = fd
        #: All of it, since it cannot end while its listener sleeps: the last to let go of it ends it.
        self.connection: Listening | None = None
        self.closed = False
        self._pause = threading.Event()

    def listen(self) -> None:
        """Sleep and ring, until it is closed or the program ends."""
        main = threading.main_thread()
        while not self.closed and main.is_alive():
            connection = self.connection
            if connection is None:
                self._pause.wait(SEARCH_INTERVAL)
            else:
                # Interrupted by a signal: as good a reason to look as any.
                with contextlib.suppress(iox2.ListenerWaitError):
                    connection.listener.timed_wait(iox2.Duration.from_secs_f64(WATCH_INTERVAL))
            del connection
            if not self.closed:
                os.eventfd_write(self.fd, 1)
