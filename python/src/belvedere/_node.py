"""This process's membership of a domain."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NamedTuple

import iceoryx2 as iox2

from belvedere import _transport
from belvedere._closing import Closing
from belvedere._commands import MotorPowerPublisher, ResetOdometryPublisher, VelocityPublisher
from belvedere._control import SimulationControl
from belvedere._errors import BridgeError
from belvedere._subscriber import Subscriber
from belvedere._synchronizer import Synchronizer

if TYPE_CHECKING:
    from collections.abc import Sequence


class StreamInfo(NamedTuple):
    """A stream that exists; None where its publisher says nothing."""

    topic: str
    kind: str | None
    encoding: str | None
    rate_hz: float | None
    frame_id: str | None
    #: Of a lidar.
    layers: int | None


class Node(Closing):
    """Membership of a domain, which is one simulation's name for all that it shares.

    If ``domain`` is None it is that of the environment variable ``BELVEDERE_DOMAIN``, else ``default``. ``name`` is
    for listings. No signal handler is installed.
    """

    def __init__(self, name: str = "python", domain: str | None = None) -> None:
        self._domain = domain if domain is not None else os.environ.get("BELVEDERE_DOMAIN") or "default"
        self._membership: _transport.Membership | None = _transport.Membership(self._domain, name)

    @property
    def domain(self) -> str:
        """The domain that was joined."""
        return self._domain

    def subscribe(self, topic: str) -> Subscriber:
        """Follow a stream, whether it exists already or not. A leading slash is ignored."""
        return Subscriber(self._joined(), _transport.topic_of(topic))

    def synchronize(self, topics: Sequence[str], tolerance: float = 0.0) -> Synchronizer:
        """Give the frames of several streams that were taken at the same time.

        Stamps of a set differ by at most ``tolerance`` seconds of simulation time: 0 for what is captured at one
        moment, more for sensors of different rates.
        """
        return Synchronizer([self.subscribe(topic) for topic in topics], tolerance)

    def velocity_publisher(self, topic: str = "cmd_vel") -> VelocityPublisher:
        """Open a velocity command stream for sending; several processes may."""
        return VelocityPublisher(self._joined(), _transport.topic_of(topic))

    def motor_power_publisher(self, topic: str = "mobile_base/commands/motor_power") -> MotorPowerPublisher:
        """Open the stream that turns the robot's motors on and off."""
        return MotorPowerPublisher(self._joined(), _transport.topic_of(topic))

    def reset_odometry_publisher(
        self, topic: str = "mobile_base/commands/reset_odometry"
    ) -> ResetOdometryPublisher:
        """Open the stream that lets the robot's odometry begin at zero."""
        return ResetOdometryPublisher(self._joined(), _transport.topic_of(topic))

    def control(self, timeout: float = 5.0) -> SimulationControl:
        """Control the simulation of the domain, whether it runs already or not, waiting so long for each answer."""
        return SimulationControl(self._joined(), timeout)

    def streams(self) -> list[StreamInfo]:
        """List what is there in the domain, by topic."""
        found = {}
        for service in iox2.Service.list(self._joined().node.config, iox2.ServiceType.Ipc):
            topic = _transport.topic_of_service(service.name().to_string())
            if topic is None or service.messaging_pattern() != iox2.MessagingPattern.PublishSubscribe:
                continue
            said = {
                attribute.key.to_string(): attribute.value.to_string() for attribute in service.attributes().values
            }
            rate, layers = said.get("rate_hz"), said.get("layers")
            found[topic] = StreamInfo(
                topic,
                said.get("kind"),
                said.get("encoding"),
                float(rate) if rate else None,
                said.get("frame_id"),
                int(layers) if layers else None,
            )
        return [found[topic] for topic in sorted(found)]

    def close(self) -> None:
        """Leave the domain, as far as subscribers and publishers made from it are closed."""
        self._membership = None

    def _joined(self) -> _transport.Membership:
        if self._membership is None:
            raise BridgeError("the node was closed: open another")
        return self._membership
