"""Matching of frames of several streams by their stamps."""

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
    """A stream, and its oldest frame that has no partners yet."""

    def __init__(self, subscriber: Subscriber) -> None:
        self.subscriber = subscriber
        self.head: Frame | None = None
        self.newest_stamp_ns = 0
        #: True if the head is the first frame after a restart or a reset of time.
        self.anew = False


class Synchronizer(Closing):
    """A synchroniser, which returns frames captured at the same time: an image, its depth and its ``camera_info``.

    The stamps are in simulated time. A set is complete if the stamps of all streams' oldest frames lie within the
    tolerance. A frame that is older than the newest of them by more than the tolerance cannot find a partner any
    more, and is skipped. So each frame is in at most one set, and sets come in order. If a simulator is restarted,
    the remaining frames from before are skipped. A synchroniser holds at most one frame of each stream. A
    subscriber may hold two, so one set may be kept while the next is awaited. Made by ``Node.synchronize``.
    """

    def __init__(self, subscribers: Sequence[Subscriber], tolerance: float) -> None:
        if len(subscribers) < 2:
            raise ValueError("a set needs two streams or more")
        if not tolerance >= 0:
            raise ValueError(f"tolerance is {tolerance} s: it is the largest difference of stamps, 0 or more")
        self._lanes = [_Lane(subscriber) for subscriber in subscribers]
        self._tolerance_ns = round(tolerance * 1e9)
        self._skipped = 0

    @property
    def skipped(self) -> int:
        """Number of frames that were taken and found no partner."""
        return self._skipped

    @property
    def missed_total(self) -> int:
        """Number of frames that were sent and never taken, over all streams."""
        return sum(lane.subscriber.missed_total for lane in self._lanes)

    def wait(self, timeout: float | None = None) -> bool:
        """Sleep until a set is available; return False if ``timeout`` seconds pass without one.

        Raises:
            BridgeError: as ``Subscriber.take``.

        """
        deadline = None if timeout is None else time.monotonic() + timeout
        while True:
            missing = self._missing()
            if missing is None:
                return True
            # Waiting for one of the missing streams suffices: no set is complete before its frame.
            left = None if deadline is None else deadline - time.monotonic()
            if (left is not None and left <= 0) or not missing.subscriber.wait(left):
                return self._missing() is None

    def take(self) -> tuple[Frame, ...] | None:
        """Return the next set, in the order of the topics, or None if it is not complete; never sleeps.

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
        """Iterate over the sets as they arrive.

        Raises:
            StreamTimeoutError: no set arrived for ``timeout`` seconds.

        """
        while True:
            if not self.wait(timeout):
                topics = ", ".join(lane.subscriber.topic for lane in self._lanes)
                raise StreamTimeoutError(f"no frames of {topics} with matching stamps for {timeout} s")
            frames = self.take()
            if frames is not None:
                yield frames
                # Do not hold them while the next ones are taken.
                del frames

    def close(self) -> None:
        """Close all subscriptions; frames that were taken remain valid."""
        for lane in self._lanes:
            lane.head = None
            lane.subscriber.close()

    def _missing(self) -> _Lane | None:
        """Take and skip frames; return None once all heads match, or a stream without a frame."""
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
        """Take the next frame of a stream; if it is the first after a restart or reset, drop the others' old frames."""
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
