"""Publishers of commands to a robot."""

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
    """A publisher of commands to the robot; several processes may send."""

    _kind: ClassVar[wire.Kind]

    def __init__(self, node: _native.Node, topic: str) -> None:
        self._sender = Sender(node, topic, self._kind)

    @property
    def topic(self) -> str:
        """The topic without a leading slash."""
        return self._sender.topic

    def wait(self, timeout: float) -> bool:
        """Sleep until a robot receives commands; return False if ``timeout`` seconds pass without one."""
        return self._sender.wait(timeout)

    def close(self) -> None:
        """Close the publisher. A robot that has not polled since it was opened misses its commands."""
        self._sender.close()

    def _send(self, **fields: object) -> bool:
        command = np.zeros((), wire.STRUCTS[self._kind])
        for field, value in fields.items():
            command[field] = value
        return self._sender.send(command)


class VelocityPublisher(CommandPublisher):
    """A publisher of velocities, made by ``Node.velocity_publisher``. The robot stops after a timeout."""

    _kind = wire.Kind.VELOCITY_COMMAND

    def send(
        self,
        forward: float = 0.0,
        turn: float = 0.0,
        *,
        linear: Sequence[float] | None = None,
        angular: Sequence[float] | None = None,
    ) -> bool:
        """Send a velocity in the robot's frame (x forward, y left, z up); return False if no robot receives it.

        ``forward`` is the velocity along x in m/s, and ``turn`` the rate about z in rad/s, counter-clockwise seen
        from above. ``linear`` and ``angular`` set all three components instead.
        """
        return self._send(
            linear=linear if linear is not None else (forward, 0.0, 0.0),
            angular=angular if angular is not None else (0.0, 0.0, turn),
        )


class MotorPowerPublisher(CommandPublisher):
    """A publisher that turns the motors on and off, made by ``Node.motor_power_publisher``."""

    _kind = wire.Kind.MOTOR_POWER

    def send(self, on: bool) -> bool:
        """Send the state; return False if no robot receives it. When off, the wheels hold and velocities are ignored."""
        return self._send(state=int(on))


class ResetOdometryPublisher(CommandPublisher):
    """A publisher that resets odometry, made by ``Node.reset_odometry_publisher``."""

    _kind = wire.Kind.RESET_ODOMETRY

    def send(self) -> bool:
        """Reset odometry to zero at the current pose; return False if no robot receives it. Encoders are not reset."""
        return self._send()
