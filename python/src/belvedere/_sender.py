"""Publishers for streams that another process creates and reads."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

    from belvedere import _native, wire


class Sender:
    """A publisher of single structs of a kind, each optionally followed by bytes, to the owner of the stream."""

    def __init__(self, node: _native.Node, topic: str, kind: wire.Kind) -> None:
        self._native = node.sender(topic, kind)

    @property
    def topic(self) -> str:
        """The topic without a leading slash."""
        return self._native.topic

    def send(self, struct: np.ndarray, tail: bytes = b"") -> bool:
        """Send a struct; return False if no process receives it."""
        return self._native.send(struct.tobytes(), tail)

    def wait(self, timeout: float) -> bool:
        """Sleep until a process receives the stream; return False if ``timeout`` seconds pass without one."""
        deadline = time.monotonic() + timeout
        while not self._native.is_taken():
            if time.monotonic() >= deadline:
                return False
            time.sleep(0.02)
        return True

    def close(self) -> None:
        """Close the stream; the next ``send`` opens it again."""
        self._native.close()
