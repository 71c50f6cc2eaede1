"""Commands to a running simulation, and their results."""

from __future__ import annotations

import secrets
import time
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from belvedere import wire
from belvedere._closing import Closing
from belvedere._errors import BadFrameError, InvalidNameError, RefusedError, StreamTimeoutError
from belvedere._sender import Sender
from belvedere._subscriber import Subscriber
from belvedere.wire import Operation

if TYPE_CHECKING:
    from collections.abc import Sequence

    from belvedere import _native

_COMMAND = wire.STRUCTS[wire.Kind.SIMULATION_COMMAND]
_ORIGIN = (0.0, 0.0, 0.0)
_UPRIGHT = (0.0, 0.0, 0.0, 1.0)


class SimulationDescription(NamedTuple):
    """The answer of ``SimulationControl.query``.

    ``time_ns`` is the simulated time in nanoseconds. ``words`` are ``playing``, ``paused`` or ``stepping``; ``replay``
    for a recording; for a model ``robot``, ``actor``, ``static`` or ``object``, and ``spawned`` if a command added
    it. Later versions may add others.
    """

    time_ns: int
    words: frozenset[str]


class SimulationControl(Closing):
    """The client side of simulation control, made by ``Node.control``.

    Every command is applied between two frames. It waits for the simulator's answer and, except for ``query``, returns
    the simulated time in nanoseconds at which it was executed.

    Raises:
        RefusedError: the simulator refused the command; the text is its reason.
        StreamTimeoutError: no simulator answered within ``timeout`` seconds, or it ended meanwhile.

    """

    def __init__(self, node: _native.Node, timeout: float) -> None:
        self.timeout = timeout
        self._node = node
        self._results = Subscriber(node, "simulation/result")
        self._sender = Sender(node, "simulation/command", wire.Kind.SIMULATION_COMMAND)

    def pause(self) -> int:
        """Pause simulated time."""
        return self._call(Operation.PAUSE)

    def resume(self) -> int:
        """Resume simulated time."""
        return self._call(Operation.RESUME)

    def step(self, steps: int = 1) -> int:
        """Run physics steps, publish everything that is due, and pause; wait until they are done."""
        return self._call(Operation.STEP, steps=steps)

    def reset_world(self) -> int:
        """Return every model to its initial pose, at rest; time continues."""
        return self._call(Operation.RESET_WORLD)

    def reset(self) -> int:
        """Restart at time 0; the output is the same as after a fresh start."""
        return self._call(Operation.RESET_SIMULATION)

    def move(
        self,
        model: str,
        position: Sequence[float],
        orientation: Sequence[float] = _UPRIGHT,
        *,
        linear: Sequence[float] = _ORIGIN,
        angular: Sequence[float] = _ORIGIN,
        reference: str = "",
    ) -> int:
        """Set a model's pose (metres; x y z w) and its velocity (m/s, rad/s), which is zero by default.

        All are in the frame ``reference``: a model, ``model::link``, or empty for the world.
        """
        return self._call(
            Operation.SET_MODEL_STATE,
            name=model,
            reference=reference,
            position=position,
            orientation=orientation,
            linear=linear,
            angular=angular,
        )

    def spawn(
        self,
        text: str,
        name: str = "",
        position: Sequence[float] = _ORIGIN,
        orientation: Sequence[float] = _UPRIGHT,
        *,
        reference: str = "",
        namespace: str = "",
    ) -> int:
        """Add the model of a text, URDF or SDF, to the world under a name, by default its own.

        Its base and its sensors are added, too; their topics are ``/namespace/...`` and their frames
        ``namespace/...``.
        """
        return self._call(
            Operation.SPAWN,
            text,
            name=name,
            reference=reference,
            robot_namespace=namespace,
            position=position,
            orientation=orientation,
        )

    def delete(self, model: str) -> int:
        """Remove a model from the world."""
        return self._call(Operation.DELETE, name=model)

    def configure(self, sensor: str, **settings: float) -> int:
        """Change settings of a sensor, given by its name or a topic, from its next frame on: all or none.

        They are ``update_rate`` (Hz), ``noise_mean``, ``noise_stddev`` and, for a camera, ``exposure``. The stream
        ``simulation/sensor_settings`` has their values and limits.
        """
        words = " ".join(f"{name}={float(value)!r}" for name, value in settings.items())
        return self._call(Operation.CONFIGURE, words, name=sensor)

    def query(self, model: str = "") -> SimulationDescription:
        """Ask what the simulation is doing and, if a model is named, what it is; change nothing."""
        result = self._ask(Operation.QUERY, name=model)
        return SimulationDescription(int(result["time_ns"]), frozenset(result["reason"].decode().split()))

    def close(self) -> None:
        """Close the control; the simulation continues."""
        self._sender.close()
        self._results.close()

    def _call(self, operation: Operation, text: str = "", **fields: object) -> int:
        return int(self._ask(operation, text, **fields)["time_ns"])

    def _ask(self, operation: Operation, text: str = "", **fields: object) -> np.void:
        command = np.zeros((), _COMMAND)
        # A unique id, which the result repeats.
        command["id"] = secrets.randbelow(2**64 - 1) + 1
        command["operation"] = operation
        tail = text.encode()
        command["text_len"] = len(tail)
        for field, value in fields.items():
            command[field] = _name(value) if isinstance(value, str) else value
        deadline = time.monotonic() + self.timeout
        # Remnants of a killed simulator would accept the command and not answer it.
        self._node.clean_up_dead()
        # Connect to the results before sending. This also discards old results.
        while self._take() is not None or self._results.publishers == 0 or not self._sender.send(command, tail):
            self._sleep_until(deadline)
        while (result := self._take()) is None or result["id"] != command["id"]:
            if result is None:
                self._sleep_until(deadline)
            if self._results.publishers == 0:
                raise StreamTimeoutError(f"the simulator has ended without an answer to {operation.name.lower()}")
        if not result["done"]:
            raise RefusedError(result["reason"].decode(errors="replace"))
        return result

    def _take(self) -> np.void | None:
        frame = self._results.take()
        if frame is None:
            return None
        with frame:
            if frame.kind != wire.Kind.SIMULATION_RESULT:
                raise BadFrameError(f"simulation/result has a frame of kind {frame.header['kind']}")
            result: np.void = frame.array[0].copy()
            return result

    def _sleep_until(self, deadline: float) -> None:
        left = deadline - time.monotonic()
        if left <= 0:
            raise StreamTimeoutError(f"no simulator has answered within {self.timeout} s")
        self._results.wait(min(left, 0.02))


def _name(text: str) -> bytes:
    name, longest = text.encode(), _COMMAND["name"].itemsize - 1
    if len(name) > longest:
        raise InvalidNameError(f"the name {text!r} has {len(name)} bytes, but at most {longest} are possible")
    return name
