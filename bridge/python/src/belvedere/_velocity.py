"""The sending end of a velocity command stream."""

from __future__ import annotations

import ctypes
import secrets
import time
from typing import TYPE_CHECKING

import iceoryx2 as iox2
import numpy as np

from belvedere import _transport, wire
from belvedere._closing import Closing
from belvedere._errors import BridgeError

if TYPE_CHECKING:
    from collections.abc import Sequence

_COMMAND = wire.STRUCTS[wire.Kind.VELOCITY_COMMAND]


class _Ports:
    """The ports of a command stream that is there."""

    def __init__(self, membership: _transport.Membership, topic: str) -> None:
        self._frames, events = _transport.open_stream(membership, topic)
        try:
            self.publisher = self._frames.publisher_builder().initial_max_slice_len(_COMMAND.itemsize).create()
            self.notifier = events.notifier_builder().create()
        except (iox2.PublisherCreateError, iox2.NotifierCreateError) as error:
            raise BridgeError(f"opening {topic} for sending: {error}") from error

    @property
    def subscribers(self) -> int:
        return int(self._frames.dynamic_config.number_of_subscribers)

    def close(self) -> None:
        self.publisher.delete()
        self.notifier.delete()


class VelocityPublisher(Closing):
    """Sends wanted velocities; made by ``Node.velocity_publisher``. The robot stops when none comes for a while."""

    def __init__(self, membership: _transport.Membership, topic: str) -> None:
        self._membership = membership
        self._topic = topic
        self._session = secrets.randbelow(2**64 - 1) + 1
        self._seq = 0
        self._ports: _Ports | None = None

    @property
    def topic(self) -> str:
        """The topic without a leading slash."""
        return self._topic

    def send(
        self,
        forward: float = 0.0,
        turn: float = 0.0,
        *,
        linear: Sequence[float] | None = None,
        angular: Sequence[float] | None = None,
    ) -> bool:
        """Send a velocity in the robot's frame (x forward, y left, z up); False while no robot is there to take it.

        ``forward`` is that along x in m/s and ``turn`` that about z in rad/s, counter-clockwise seen from above;
        ``linear`` and ``angular`` give all three components instead.
        """
        command = np.zeros((), _COMMAND)
        command["linear"] = linear if linear is not None else (forward, 0.0, 0.0)
        command["angular"] = angular if angular is not None else (0.0, 0.0, turn)
        header = np.zeros((), wire.HEADER)
        fields = {
            "magic": wire.MAGIC,
            "header_len": wire.HEADER_LEN,
            "schema": wire.SCHEMA,
            "kind": wire.Kind.VELOCITY_COMMAND,
            "encoding": wire.Encoding.STRUCT,
            "seq": self._seq,
            "session": self._session,
            "width": 1,
            "height": 1,
            "row_stride": _COMMAND.itemsize,
            "elem_stride": _COMMAND.itemsize,
            "payload_len": _COMMAND.itemsize,
            "orientation": (0.0, 0.0, 0.0, 1.0),
        }
        for field, value in fields.items():
            header[field] = value
        ports = self._connect()
        if ports is None:
            return False
        try:
            sample = ports.publisher.loan_slice_uninit(_COMMAND.itemsize)
            ctypes.memmove(sample.payload_ptr, command.tobytes(), _COMMAND.itemsize)
            header["publish_mono_ns"] = time.clock_gettime_ns(time.CLOCK_MONOTONIC)
            ctypes.memmove(sample.user_header_ptr, header.tobytes(), wire.HEADER_LEN)
            sample.assume_init().send()
            ports.notifier.notify()
        except (iox2.LoanError, iox2.SendError, iox2.NotifierNotifyError) as error:
            raise BridgeError(f"sending {self._topic}: {error}") from error
        self._seq += 1
        return True

    def close(self) -> None:
        """Close it. A robot that has not looked since it was opened misses what was sent."""
        if self._ports is not None:
            self._ports.close()
            self._ports = None

    def wait(self, timeout: float) -> bool:
        """Sleep until there is a robot that takes commands; False when ``timeout`` seconds have passed without."""
        deadline = time.monotonic() + timeout
        while self._connect() is None:
            if time.monotonic() >= deadline:
                return False
            time.sleep(0.02)
        return True

    def _connect(self) -> _Ports | None:
        """Open the stream, which the robot makes, and open it anew when the robot was started again."""
        if self._ports is not None and self._ports.subscribers == 0:
            self.close()
            self._membership.node.try_cleanup_dead_nodes()
        if self._ports is None:
            try:
                ports = _Ports(self._membership, self._topic)
            except _transport.NotThere:
                return None
            if ports.subscribers == 0:
                ports.close()
                return None
            self._ports = ports
        return self._ports
