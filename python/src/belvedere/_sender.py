"""The sending end of a stream that another process makes, and reads."""

from __future__ import annotations

import ctypes
import secrets
import time

import iceoryx2 as iox2
import numpy as np

from belvedere import _transport, wire
from belvedere._errors import BridgeError


class _Ports:
    """The ports of a stream that is there, for payloads of at most ``room`` bytes."""

    def __init__(self, membership: _transport.Membership, topic: str, room: int) -> None:
        self._frames, events = _transport.open_stream(membership, topic)
        self.room = room
        try:
            self.publisher = self._frames.publisher_builder().initial_max_slice_len(room).create()
            self.notifier = events.notifier_builder().create()
        except (iox2.PublisherCreateError, iox2.NotifierCreateError) as error:
            raise BridgeError(f"opening {topic} for sending: {error}") from error

    @property
    def subscribers(self) -> int:
        return int(self._frames.dynamic_config.number_of_subscribers)

    def close(self) -> None:
        self.publisher.delete()
        self.notifier.delete()


class Sender:
    """Sends single structs of a kind, each with a tail of bytes or without, to whom has made the stream."""

    def __init__(self, membership: _transport.Membership, topic: str, kind: wire.Kind) -> None:
        self._membership = membership
        self.topic = topic
        self._kind = kind
        self._session = secrets.randbelow(2**64 - 1) + 1
        self._seq = 0
        self._ports: _Ports | None = None

    def send(self, struct: np.ndarray, tail: bytes = b"") -> bool:
        """Send it; False while nobody is there to take it."""
        payload = struct.tobytes() + tail
        ports = self._connect(len(payload))
        if ports is None:
            return False
        header = np.zeros((), wire.HEADER)
        fields = {
            "magic": wire.MAGIC,
            "header_len": wire.HEADER_LEN,
            "schema": wire.SCHEMA,
            "kind": self._kind,
            "encoding": wire.Encoding.STRUCT,
            "seq": self._seq,
            "session": self._session,
            "width": 1,
            "height": 1,
            "row_stride": struct.itemsize,
            "elem_stride": struct.itemsize,
            "payload_len": len(payload),
            "orientation": (0.0, 0.0, 0.0, 1.0),
        }
        for field, value in fields.items():
            header[field] = value
        try:
            sample = ports.publisher.loan_slice_uninit(len(payload))
            ctypes.memmove(sample.payload_ptr, payload, len(payload))
            header["publish_mono_ns"] = time.clock_gettime_ns(time.CLOCK_MONOTONIC)
            ctypes.memmove(sample.user_header_ptr, header.tobytes(), wire.HEADER_LEN)
            sample.assume_init().send()
            ports.notifier.notify()
        except (iox2.LoanError, iox2.SendError, iox2.NotifierNotifyError) as error:
            raise BridgeError(f"sending {self.topic}: {error}") from error
        self._seq += 1
        return True

    def wait(self, timeout: float) -> bool:
        """Sleep until there is somebody who takes it; False when ``timeout`` seconds have passed without."""
        deadline = time.monotonic() + timeout
        while self._connect(wire.STRUCTS[self._kind].itemsize) is None:
            if time.monotonic() >= deadline:
                return False
            time.sleep(0.02)
        return True

    def close(self) -> None:
        """Close its ports; the next to be sent opens them again."""
        if self._ports is not None:
            self._ports.close()
            self._ports = None

    def _connect(self, room: int) -> _Ports | None:
        """Open the stream, and open it anew when its maker was started again, or for a longer payload."""
        if self._ports is not None and self._ports.subscribers == 0:
            self.close()
            self._membership.node.try_cleanup_dead_nodes()
        if self._ports is not None and self._ports.room < room:
            # Before the new ones are opened: places for senders are few.
            self.close()
        if self._ports is None:
            try:
                ports = _Ports(self._membership, self.topic, room)
            except _transport.NotThere:
                return None
            if ports.subscribers == 0:
                ports.close()
                return None
            self._ports = ports
        return self._ports
