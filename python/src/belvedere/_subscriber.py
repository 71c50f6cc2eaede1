"""The reading end of a stream, through all that happens to its publisher."""

from __future__ import annotations

import asyncio
import contextlib
import time
from typing import TYPE_CHECKING, Any

import iceoryx2 as iox2

from belvedere import _transport
from belvedere._closing import Closing
from belvedere._errors import BridgeError, LimitError, StreamTimeoutError
from belvedere._frame import Frame
from belvedere._readiness import SEARCH_INTERVAL, WATCH_INTERVAL, Readiness

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Iterator

#: After so many seconds of silence the publisher may have been killed: see who is dead.
SUSPICIOUS_SILENCE = 1.0


class _Connection:
    """The ports of a stream that is there.

    When a port closes, iceoryx2's publisher takes back all that went through it and writes into it again, held or
    not. So the ports stay open as long as the subscriber or any frame refers to them.
    """

    def __init__(self, membership: _transport.Membership, topic: str) -> None:
        # Outlives the rest, see Membership.
        self._membership = membership
        self.frames, events = _transport.open_stream(membership, topic)
        if self.publishers == 0:
            # What other subscribers are about to let go.
            raise _transport.NotThere
        # The listener first: who is seen as a subscriber is then sure to be woken.
        self.listener = events.listener_builder().create()
        settings = self.frames.static_config
        history = min(settings.history_size, settings.subscriber_max_buffer_size)
        try:
            self.port = self.frames.subscriber_builder().history_request(history).create()
        except iox2.SubscriberCreateError as error:
            if "ExceedsMaxSupportedSubscribers" in str(error):
                raise LimitError(
                    f"{topic} has its {settings.max_subscribers} subscribers already: close one"
                ) from error
            raise BridgeError(f"subscribing to {topic}: {error}") from error
        self.since_mono_ns = time.clock_gettime_ns(time.CLOCK_MONOTONIC)

    @property
    def publishers(self) -> int:
        return int(self.frames.dynamic_config.number_of_publishers)

    def __del__(self) -> None:
        for port in ("port", "listener"):
            if hasattr(self, port):
                getattr(self, port).delete()
        # Before the membership, not in whatever order the fields go.
        self.frames = None


class Subscriber(Closing):
    """The reading end of a stream, made by ``Node.subscribe``.

    It can be made before the stream exists, and it outlives the publisher: when that ends, or is killed, and starts
    again, it goes on with the new one. A reader that is slower than the publisher loses the oldest of its own
    waiting frames and slows nobody; ``Frame.missed`` tells how many.
    """

    def __init__(self, membership: _transport.Membership, topic: str) -> None:
        self._membership = membership
        self._topic = topic
        self._connection: _Connection | None = None
        #: Only of subscribers that somebody polls.
        self._readiness: Readiness | None = None
        self._next_search = 0.0
        self._last: tuple[int, int] | None = None
        self._missed_total = 0
        self._last_sign_of_life = self._last_clean_up = time.monotonic()

    @property
    def topic(self) -> str:
        """The topic without a leading slash."""
        return self._topic

    @property
    def publishers(self) -> int:
        """Publishers now: 0 before the first, and after the last has ended or was found dead."""
        return self._connection.publishers if self._connection else 0

    @property
    def missed_total(self) -> int:
        """Frames that were sent and never taken, over this subscriber's life."""
        return self._missed_total

    @property
    def silence(self) -> float:
        """Seconds since the last frame, or since the subscriber was made: the sign that a stream has stopped."""
        return time.monotonic() - self._last_sign_of_life

    def wait(self, timeout: float | None = None) -> bool:
        """Sleep until there is a frame to take; False when ``timeout`` seconds have passed without one.

        Raises:
            IncompatibleError: the stream is there and cannot be read by this version.
            LimitError: all places of the stream are taken.

        """
        deadline = None if timeout is None else time.monotonic() + timeout
        while True:
            self._search()
            if self._connection and self._connection.port.has_samples():
                return True
            self._watch_publisher()
            left = WATCH_INTERVAL if deadline is None else min(deadline - time.monotonic(), WATCH_INTERVAL)
            if left <= 0:
                return False
            if self._readiness:
                self._readiness.wait(left)
            elif self._connection:
                # Interrupted by a signal: Python calls its handler now, and goes on if that does.
                with contextlib.suppress(iox2.ListenerWaitError):
                    self._connection.listener.timed_wait(iox2.Duration.from_secs_f64(left))
            else:
                time.sleep(min(left, SEARCH_INTERVAL))

    def fileno(self) -> int:
        """Return a descriptor for the ``select``, ``selectors`` or ``asyncio`` of another event loop.

        It is the same over the subscriber's whole life, and readable when frames may wait or it is time to look for
        the publisher: ``take()`` then until there is none. Do not read from it. iceoryx2's Python package has no
        descriptor of its own; a thread that sleeps beside is the price of this one.
        """
        if self._readiness is None:
            self._readiness = Readiness()
            self._readiness.follow(self._connection)
        return self._readiness.fd

    async def __aiter__(self) -> AsyncIterator[Frame]:
        """Go through the frames as they come, each in turn, in ``async for``.

        There is no end and no timeout: ``asyncio.timeout`` around it says how long to wait.
        """
        loop = asyncio.get_running_loop()
        while True:
            frame = self.take()
            if frame is not None:
                yield frame
                # Not held here while the next is taken.
                del frame
                continue
            # Heard only while nothing is there: a frame that waits for the loop's body would ring all the time.
            readable = loop.create_future()
            loop.add_reader(self.fileno(), _ring, readable)
            try:
                await readable
            finally:
                loop.remove_reader(self.fileno())

    def take(self) -> Frame | None:
        """Return the oldest frame that waits, if any; never sleeps.

        Raises:
            LimitError: too many frames are held.
            BadFrameError: the frame must not be read, and was dropped.
            IncompatibleError: as for ``wait``.

        """
        if self._readiness:
            # Before the look: what comes after it rings again.
            self._readiness.clear()
        self._search()
        sample = self._receive()
        if sample is None:
            self._watch_publisher()
            return None
        if self._readiness:
            # There may be more.
            self._readiness.ring()
        return self._accept(sample)

    def take_newest(self) -> Frame | None:
        """Return the newest frame that waits, if any, and drop those before it, which count as missed."""
        newest = self.take()
        while newest is not None and self._connection and self._connection.port.has_samples():
            # Before the next is taken: the other place may be that of the frame that the caller still holds.
            newest.release()
            frame = self.take()
            if frame is None:
                break
            frame.missed += newest.missed + 1
            frame.restarted |= newest.restarted
            self._missed_total += 1
            newest = frame
        return newest

    def frames(self, timeout: float | None = None, *, newest: bool = False) -> Iterator[Frame]:
        """Go through the frames as they come, each in turn or only the ``newest`` of those that wait.

        A frame is released when the variables that hold it or its arrays are gone, in a loop thus one turn later.

        Raises:
            StreamTimeoutError: no frame has come for ``timeout`` seconds.

        """
        while True:
            if not self.wait(timeout):
                raise StreamTimeoutError(
                    f"no frame of {self._topic} for {timeout} s; publishers: {self.publishers}"
                )
            frame = self.take_newest() if newest else self.take()
            if frame is not None:
                yield frame
                # Not held here while the next is taken.
                del frame

    def close(self) -> None:
        """End the subscription; frames that are held stay valid."""
        if self._readiness:
            self._readiness.close()
            self._readiness = None
        self._connection = None
        self._next_search = float("inf")

    def _receive(self) -> Any:
        if self._connection is None:
            return None
        try:
            return self._connection.port.receive()
        except iox2.ReceiveError as error:
            if "ExceedsMaxBorrows" in str(error):
                held = self._connection.frames.static_config.subscriber_max_borrowed_samples
                raise LimitError(
                    f"{held} frames of {self._topic} are held: release one, or copy() what is needed"
                ) from error
            raise BridgeError(f"receiving {self._topic}: {error}") from error

    def _accept(self, sample: Any) -> Frame:
        self._last_sign_of_life = time.monotonic()
        since = self._connection.since_mono_ns if self._connection else 0
        frame = Frame(sample, self._connection, missed=0, restarted=False, from_history=False)
        frame.from_history = int(frame.header["publish_mono_ns"]) < since
        if self._last is not None:
            session, seq = self._last
            frame.restarted = frame.session != session
            if not frame.restarted:
                frame.missed = max(0, frame.seq - seq - 1)
        self._last = (frame.session, frame.seq)
        self._missed_total += frame.missed
        return frame

    def _search(self) -> None:
        if self._connection is None and time.monotonic() >= self._next_search:
            self._next_search = time.monotonic() + SEARCH_INTERVAL
            with contextlib.suppress(_transport.NotThere):
                self._connection = _Connection(self._membership, self._topic)
                if self._readiness:
                    self._readiness.follow(self._connection)

    def _watch_publisher(self) -> None:
        """Let go of a stream whose publisher has gone, so that the next one finds nothing of the old."""
        if self._connection is None:
            return
        now = time.monotonic()
        if min(self.silence, now - self._last_clean_up) > SUSPICIOUS_SILENCE:
            self._last_clean_up = now
            self._membership.node.try_cleanup_dead_nodes()
        # In this order: a publisher's last frame is there before it is gone.
        if self._connection.publishers == 0 and not self._connection.port.has_samples():
            if self._readiness:
                self._readiness.follow(None)
            self._connection = None


def _ring(readable: asyncio.Future[None]) -> None:
    if not readable.done():
        readable.set_result(None)
