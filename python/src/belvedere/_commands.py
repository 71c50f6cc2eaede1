"""What a robot is told."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from belvedere import wire
from belvedere._closing import Closing
from belvedere._sender import Sender

if TYPE_CHECKING:
    from collections.abc import Sequence

    from belvedere import _native


class CommandPublisher(Closing):
    """The sending end of a stream of commands to the robot; several processes may."""

    _kind: ClassVar[wire.Kind]

    def __init__(self, node: _native.Node, topic: str) -> None:
        self._sender = Sender(node, topic, self._kind)

    @property
    def topic(self) -> str:
        """The topic without a leading slash."""
        return self._sender.topic

    def wait(self, timeout: float) -> bool:
        """Sleep until there is a robot that takes commands; False when ``timeout`` seconds have passed without."""
        return self._sender.wait(timeout)

    def close(self) -> None:
        """Close it. A robot that has not looked since it was opened misses what was sent."""
        self._sender.close()

    def _send(self, **fields: object) -> bool:
        command = np.zeros((), wire.STRUCTS[self._kind])
        for field, value in fields.items():
            command[field] = value
        return self._sender.send(command)


class VelocityPublisher(CommandPublisher):
    """Sends wanted velocities; made by ``Node.velocity_publisher``. The robot stops when none comes for a while."""

    _kind = wire.Kind.VELOCITY_COMMAND

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
        return self._send(
            linear=linear if linear is not None else (forward, 0.0, 0.0),
            angular=angular if angular is not None else (0.0, 0.0, turn),
        )


class MotorPowerPublisher(CommandPublisher):
    """Turns the motors on and off; made by ``Node.motor_power_publisher``."""

    _kind = wire.Kind.MOTOR_POWER

    def send(self, on: bool) -> bool:
        """Send it; False while no robot is there to take it. Off, the wheels hold, and velocities are lost."""
        return self._send(state=int(on))


class ResetOdometryPublisher(CommandPublisher):
    """Lets odometry begin at zero; made by ``Node.reset_odometry_publisher``."""

    _kind = wire.Kind.RESET_ODOMETRY

    def send(self) -> bool:
        """Send it; False while no robot is there to take it. Zero is where the robot then is; encoders count on."""
        return self._send()
