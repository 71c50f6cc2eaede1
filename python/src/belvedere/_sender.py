"""The sending end of a stream that another process makes, and reads."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

    from belvedere import _native, wire


class Sender:
    """Sends single structs of a kind, each with a tail of bytes or without, to whom has made the stream."""

    def __init__(self, node: _native.Node, topic: str, kind: wire.Kind) -> None:
        self._native = node.sender(topic, kind)

    @property
    def topic(self) -> str:
        """The topic without a leading slash."""
        return self._native.topic

    def send(self, struct: np.ndarray, tail: bytes = b"") -> bool:
        """Send it; False while nobody is there to take it."""
        return self._native.send(struct.tobytes(), tail)

    def wait(self, timeout: float) -> bool:
        """Sleep until there is somebody who takes it; False when ``timeout`` seconds have passed without."""
        deadline = time.monotonic() + timeout
        while not self._native.is_taken():
            if time.monotonic() >= deadline:
                return False
            time.sleep(0.02)
        return True

    def close(self) -> None:
        """Close the stream; the next to be sent opens it again."""
        self._native.close()
