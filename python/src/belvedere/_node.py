"""This process's membership of a domain."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NamedTuple

from belvedere import _native
from belvedere._closing import Closing
from belvedere._commands import MotorPowerPublisher, ResetOdometryPublisher, VelocityPublisher
from belvedere._control import SimulationControl
from belvedere._errors import BridgeError
from belvedere._subscriber import Subscriber
from belvedere._synchronizer import Synchronizer

if TYPE_CHECKING:
    from collections.abc import Sequence


class StreamInfo(NamedTuple):
    """An existing stream; fields that its publisher did not declare are None."""

    topic: str
    kind: str | None
    encoding: str | None
    rate_hz: float | None
    frame_id: str | None
    #: Number of layers of a lidar.
    layers: int | None


class Node(Closing):
    """Membership of a domain, the name under which one simulation shares its streams.

    If ``domain`` is None, it is that of the environment variable ``BELVEDERE_DOMAIN``, or ``default``. ``name`` is
    shown in listings. No signal handler is installed.
    """

    def __init__(self, name: str = "python", domain: str | None = None) -> None:
        self._domain = domain if domain is not None else os.environ.get("BELVEDERE_DOMAIN") or "default"
        self._native: _native.Node | None = _native.Node(self._domain, name)

    @property
    def domain(self) -> str:
        """The domain that was joined."""
        return self._domain

    def subscribe(self, topic: str) -> Subscriber:
        """Subscribe to a stream, which may be created later. A leading slash is ignored."""
        return Subscriber(self._joined(), topic)

    def synchronize(self, topics: Sequence[str], tolerance: float = 0.0) -> Synchronizer:
        """Subscribe to several streams, for sets of frames that were captured at the same time.

        The stamps of a set differ by at most ``tolerance`` seconds of simulated time: 0 for frames captured at the
        same time, more for sensors of different rates.
        """
        return Synchronizer([self.subscribe(topic) for topic in topics], tolerance)

    def velocity_publisher(self, topic: str = "cmd_vel") -> VelocityPublisher:
        """Open a velocity command stream for sending; several processes may."""
        return VelocityPublisher(self._joined(), topic)

    def motor_power_publisher(self, topic: str = "mobile_base/commands/motor_power") -> MotorPowerPublisher:
        """Open the stream that turns the robot's motors on and off."""
        return MotorPowerPublisher(self._joined(), topic)

    def reset_odometry_publisher(
        self, topic: str = "mobile_base/commands/reset_odometry"
    ) -> ResetOdometryPublisher:
        """Open the stream that resets the robot's odometry."""
        return ResetOdometryPublisher(self._joined(), topic)

    def control(self, timeout: float = 5.0) -> SimulationControl:
        """Open the control of the domain's simulation, which may start later; the timeout applies to each answer."""
        return SimulationControl(self._joined(), timeout)

    def streams(self) -> list[StreamInfo]:
        """List the streams of the domain, by topic."""
        return [StreamInfo(*stream) for stream in self._joined().streams()]

    def close(self) -> None:
        """Leave the domain once all subscribers and publishers made from this node are closed."""
        self._native = None

    def _joined(self) -> _native.Node:
        if self._native is None:
            raise BridgeError("the node was closed: open another")
        return self._native
