"""Frames of several streams that belong together."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from belvedere._closing import Closing
from belvedere._errors import StreamTimeoutError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from belvedere._frame import Frame
    from belvedere._subscriber import Subscriber


class _Lane:
    """One stream, and its oldest frame that has no partners yet."""

    def __init__(self, subscriber: Subscriber) -> None:
        self.subscriber = subscriber
        self.head: Frame | None = None
        self.newest_stamp_ns = 0
        #: Whether the head is the first of a new time.
        self.anew = False


class Synchronizer(Closing):
    """Gives the frames that were taken at the same time: a picture with its depth and its ``camera_info``.

    Time is that of the stamps. A set is complete when the stamps of all streams' oldest frames lie within the
    tolerance; a frame that is further behind the newest of them can find no partner any more, and is skipped. So
    each frame is in one set at most, and sets come in order. When a simulator is started again, what is left of the
    old time is skipped. It holds one frame of each stream at most: with the two that may be held, one set may be
    kept while the next is waited for. Made by ``Node.synchronize``.
    """

    def __init__(self, subscribers: Sequence[Subscriber], tolerance: float) -> None:
        if len(subscribers) < 2:
            raise ValueError("a set is of two streams or more")
        if not tolerance >= 0:
            raise ValueError(f"tolerance is {tolerance} s: it is the most that stamps may differ, 0 or more")
        self._lanes = [_Lane(subscriber) for subscriber in subscribers]
        self._tolerance_ns = round(tolerance * 1e9)
        self._skipped = 0

    @property
    def skipped(self) -> int:
        """Frames that were taken and found no partner."""
        return self._skipped

    @property
    def missed_total(self) -> int:
        """Frames that were sent and never taken, over all streams."""
        return sum(lane.subscriber.missed_total for lane in self._lanes)

    def wait(self, timeout: float | None = None) -> bool:
        """Sleep until there is a set to take; False when ``timeout`` seconds have passed without one.

        Raises:
            BridgeError: as ``Subscriber.take``.

        """
        deadline = None if timeout is None else time.monotonic() + timeout
        while True:
            missing = self._missing()
            if missing is None:
                return True
            # One of those that are missing is as good as all: no set is complete before it comes.
            left = None if deadline is None else deadline - time.monotonic()
            if (left is not None and left <= 0) or not missing.subscriber.wait(left):
                return self._missing() is None

    def take(self) -> tuple[Frame, ...] | None:
        """Return the next set, in the order of the topics, if it is complete; never sleeps.

        Raises:
            BridgeError: as ``Subscriber.take``.

        """
        if self._missing() is not None:
            return None
        heads = tuple(lane.head for lane in self._lanes if lane.head is not None)
        for lane in self._lanes:
            lane.head = None
        return heads

    def sets(self, timeout: float | None = None) -> Iterator[tuple[Frame, ...]]:
        """Go through the sets as they come.

        Raises:
            StreamTimeoutError: no set has come for ``timeout`` seconds.

        """
        while True:
            if not self.wait(timeout):
                topics = ", ".join(lane.subscriber.topic for lane in self._lanes)
                raise StreamTimeoutError(f"no frames of one time of {topics} for {timeout} s")
            frames = self.take()
            if frames is not None:
                yield frames
                # Not held here while the next are taken.
                del frames

    def close(self) -> None:
        """End all subscriptions; frames that were taken stay valid."""
        for lane in self._lanes:
            lane.head = None
            lane.subscriber.close()

    def _missing(self) -> _Lane | None:
        """Take and skip until all heads belong together: None; or until a stream has none: that stream."""
        while True:
            for lane in self._lanes:
                if lane.head is None:
                    self._refill(lane)
            stamps_ns = [lane.head.stamp_ns for lane in self._lanes if lane.head is not None]
            if len(stamps_ns) < len(self._lanes):
                return next(lane for lane in self._lanes if lane.head is None)
            newest = max(stamps_ns)
            together = True
            for lane, stamp_ns in zip(self._lanes, stamps_ns, strict=True):
                if newest - stamp_ns > self._tolerance_ns:
                    lane.head = None
                    self._skipped += 1
                    together = False
            if together:
                return None

    def _refill(self, lane: _Lane) -> None:
        """Take the next frame of a stream. If it is the first of a new time, frames of the old one go."""
        frame = lane.subscriber.take()
        if frame is None:
            return
        lane.anew = frame.restarted or frame.stamp_ns < lane.newest_stamp_ns
        lane.newest_stamp_ns = frame.stamp_ns
        lane.head = frame
        if lane.anew:
            for other in self._lanes:
                if other is not lane and not other.anew and other.head is not None:
                    other.head = None
                    self._skipped += 1
