"""The reading end of a stream, through all that happens to its publisher."""

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

    It can be made before the stream exists, and it outlives the publisher: when that ends, or is killed, and starts
    again, it goes on with the new one. A reader that is slower than the publisher loses the oldest of its own
    waiting frames and slows nobody; ``Frame.missed`` tells how many.
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
        """Publishers now: 0 before the first, and after the last has ended or was found dead."""
        return self._native.publishers

    @property
    def missed_total(self) -> int:
        """Frames that were sent and never taken, over this subscriber's life."""
        return self._native.missed_total

    @property
    def silence(self) -> float:
        """Seconds since the last frame, or since the subscriber was made: the sign that a stream has stopped."""
        return self._native.silence

    def wait(self, timeout: float | None = None) -> bool:
        """Sleep until there is a frame to take; False when ``timeout`` seconds have passed without one.

        Raises:
            IncompatibleError: the stream is there and cannot be read by this version.
            LimitError: all places of the stream are taken.

        """
        return self._native.wait(timeout)

    def fileno(self) -> int:
        """Return a descriptor for the ``select``, ``selectors`` or ``asyncio`` of another event loop.

        It is the same over the subscriber's whole life, and readable when frames may wait or it is time to look for
        the publisher: ``take()`` then until there is none. Do not read from it.
        """
        return self._native.fileno()

    async def __aiter__(self) -> AsyncIterator[Frame]:
        """Go through the frames as they come, each in turn, in ``async for``.

        There is no end and no timeout: ``asyncio.timeout`` around it says how long to wait.
        """
        # Not at the top: it takes a third as long to import as all of this package.
        import asyncio

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
            fd = self.fileno()
            loop.add_reader(fd, _ring, readable)
            try:
                await readable
            finally:
                loop.remove_reader(fd)

    def take(self) -> Frame | None:
        """Return the oldest frame that waits, if any; never sleeps.

        Raises:
            LimitError: too many frames are held.
            BadFrameError: the frame must not be read, and was dropped.
            IncompatibleError: as for ``wait``.

        """
        return _frame(self._native.take())

    def take_newest(self) -> Frame | None:
        """Return the newest frame that waits, if any, and drop those before it, which count as missed."""
        return _frame(self._native.take_newest())

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
        self._native.close()


def _frame(taken: _native.Frame | None) -> Frame | None:
    return None if taken is None else Frame(taken)


def _ring(readable: asyncio.Future[None]) -> None:
    if not readable.done():
        readable.set_result(None)
