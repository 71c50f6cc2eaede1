"""The reading end of a stream, which outlives its publishers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from belvedere._closing import Closing
from belvedere._errors import StreamTimeoutError
from belvedere._frame import Frame

if TYPE_CHECKING:
    import asyncio
    from collections.abc import AsyncIterator, Iterator

    from belvedere import _native


class Subscriber(Closing):
    """The reading end of a stream, made by ``Node.subscribe``.

    A subscriber can be created before its stream exists, and it outlives the publisher: if that ends or is killed,
    and starts again, the subscriber continues with the new one. A subscriber that is slower than the publisher
    loses the oldest of its own queued frames and does not slow the publisher; ``Frame.missed`` tells how many it
    lost.
    """

    def __init__(self, node: _native.Node, topic: str) -> None:
        self._topic = topic.removeprefix("/")
        self._native = node.subscriber(topic)

    @property
    def topic(self) -> str:
        """The topic without a leading slash."""
        return self._topic

    @property
    def publishers(self) -> int:
        """Number of publishers now: 0 before the first, and after the last has ended or was found dead."""
        return self._native.publishers

    @property
    def missed_total(self) -> int:
        """Number of frames that were sent and never taken, over this subscriber's life."""
        return self._native.missed_total

    @property
    def silence(self) -> float:
        """Seconds since the last frame, or since the subscriber was created; a long silence means a stopped stream."""
        return self._native.silence

    def wait(self, timeout: float | None = None) -> bool:
        """Sleep until a frame is available; return False if ``timeout`` seconds pass without one.

        Raises:
            IncompatibleError: the stream exists and cannot be read by this version.
            LimitError: the stream has no subscriber slot left.

        """
        return self._native.wait(timeout)

    def fileno(self) -> int:
        """Return a descriptor for the ``select``, ``selectors`` or ``asyncio`` of another event loop.

        It is the same over the subscriber's whole life. It is readable if frames may be queued or the publisher
        must be checked: then call ``take()`` until it returns None. Do not read from it.
        """
        return self._native.fileno()

    async def __aiter__(self) -> AsyncIterator[Frame]:
        """Iterate over the frames as they arrive, in ``async for``.

        There is no end and no timeout: use ``asyncio.timeout`` around it.
        """
        # Not at the top, since it adds a third to the import time of this package.
        import asyncio

        loop = asyncio.get_running_loop()
        while True:
            frame = self.take()
            if frame is not None:
                yield frame
                # Do not hold it while the next one is taken.
                del frame
                continue
            # Registered only while no frame is queued: a frame that waits for the loop's body would make the
            # descriptor readable all the time.
            readable = loop.create_future()
            fd = self.fileno()
            loop.add_reader(fd, _ring, readable)
            try:
                await readable
            finally:
                loop.remove_reader(fd)

    def take(self) -> Frame | None:
        """Return the oldest queued frame, or None; never sleeps.

        Raises:
            LimitError: too many frames are held.
            BadFrameError: the frame has an invalid header, and was dropped.
            IncompatibleError: as for ``wait``.

        """
        return _frame(self._native.take())

    def take_newest(self) -> Frame | None:
        """Return the newest queued frame, or None, and drop older ones, which count as missed."""
        return _frame(self._native.take_newest())

    def frames(self, timeout: float | None = None, *, newest: bool = False) -> Iterator[Frame]:
        """Iterate over the frames as they arrive: all of them, or only the ``newest`` of those queued.

        A frame is released when the variables that hold it or its arrays are gone, that is one iteration later in a
        loop.

        Raises:
            StreamTimeoutError: no frame arrived for ``timeout`` seconds.

        """
        while True:
            if not self.wait(timeout):
                raise StreamTimeoutError(
                    f"no frame of {self._topic} for {timeout} s; publishers: {self.publishers}"
                )
            frame = self.take_newest() if newest else self.take()
            if frame is not None:
                yield frame
                # Do not hold it while the next one is taken.
                del frame

    def close(self) -> None:
        """Close the subscription; frames that are held remain valid."""
        self._native.close()


def _frame(taken: _native.Frame | None) -> Frame | None:
    return None if taken is None else Frame(taken)


def _ring(readable: asyncio.Future[None]) -> None:
    if not readable.done():
        readable.set_result(None)
