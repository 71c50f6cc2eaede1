"""A simulation in this process, stepped and rendered by its caller."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from belvedere import _arrays, _native, wire
from belvedere._sources import arguments, folders, report
from belvedere._unpicklable import Unpicklable
from belvedere._world import MODELS, World

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from belvedere._arrays import ArrayLike


class Simulation(Unpicklable):
    """A world with robots, without another process, shared memory or a real-time clock.

    The same world, seed and commands give the same bytes as ``belvedere run``.

    Args:
        world: a name, a file or a text, as for ``World``.
        robot: a name, a file or a text; ``spawn`` adds more. A robot given as the world is alone, without a floor.
        seed: the seed of all noise.
        pose: the pose of the robot given by ``robot``.
        gazebo_compat: reproduce quirks of Gazebo classic instead of correct values.
        threads: the number of threads that render; one per processor by default.
        package_path: folders of ROS packages.
        xacro: arguments of the robot's xacro.

    Raises:
        ValueError: the world or robot cannot be used; the message has the lines that the command line prints.

    """

    def __init__(
        self,
        world: str | os.PathLike[str] = "empty",
        robot: str | os.PathLike[str] | None = None,
        *,
        seed: int = 1,
        pose: ArrayLike | None = None,
        gazebo_compat: bool = False,
        threads: int | None = None,
        package_path: Sequence[str | os.PathLike[str]] = (),
        xacro: Mapping[str, Any] | None = None,
    ) -> None:
        for argument, given in (("pose", pose), ("xacro", xacro)):
            if robot is None and given is not None:
                raise ValueError(
                    f"{argument}: it applies to robot=…, which is missing: Simulation('empty', robot=…)"
                )
        self._package_path = folders(package_path)
        self._native = _native.Simulation(
            _arrays.described("world", world),
            _arrays.count("seed", seed, 0, 2**64 - 1),
            bool(gazebo_compat),
            _arrays.threads(threads),
            self._package_path,
            MODELS,
        )
        #: The default robot of the methods: the one spawned last.
        self.robot: str | None = self._native.thing
        self._reported = 0
        self._tell()
        if robot is not None:
            self.spawn(_arrays.described("robot", robot), pose=pose, xacro=xacro)

    def spawn(
        self,
        source: str | os.PathLike[str],
        *,
        name: str = "",
        namespace: str = "",
        pose: ArrayLike | None = None,
        xacro: Mapping[str, Any] | None = None,
    ) -> str:
        """Spawn a robot or an object by name, file or text; return its name.

        Args:
            source: a name, a file or a text, as for ``World``.
            name: its name; by default the one in its file.
            namespace: the prefix of its topics and frames.
            pose: its pose, (7,), (4, 4) or (3,); its own ``<pose>`` is relative to it, as when Gazebo spawns a
                model.
            xacro: arguments for ``$(arg name)``.

        Raises:
            ValueError: the name is taken, or the description cannot be used. Nothing is added then.

        """
        called = self._native.spawn(
            _arrays.described("source", source),
            _arrays.text("name", name),
            _arrays.text("namespace", namespace),
            _arrays.one_pose("pose", pose),
            self._package_path,
            MODELS,
            arguments(xacro),
        )
        self.robot = called
        self._tell()
        return called

    def _tell(self) -> None:
        """Log the notes since the last call."""
        notes = self.notes
        report(notes[self._reported :])
        self._reported = len(notes)

    @property
    def notes(self) -> list[str]:
        """Elements that were ignored in the descriptions of world and robots, one line each."""
        return self._native.notes

    @property
    def time(self) -> float:
        """Simulated time in seconds."""
        return self._native.time_ns * 1e-9

    @property
    def time_ns(self) -> int:
        """Simulated time in nanoseconds."""
        return self._native.time_ns

    @property
    def models(self) -> list[str]:
        """The names of all models."""
        return self._native.models

    @property
    def topics(self) -> list[str]:
        """All topics that can be rendered."""
        return self._native.topics()

    def command(self, velocity: ArrayLike, robot: str | None = None) -> None:
        """Command a robot's velocity (forward in m/s, turn in rad/s), which its plugin follows until its timeout.

        Raises:
            ValueError: there is no such robot, or it has no base that drives.

        """
        forward, turn = _arrays.numbers("velocity", velocity, 2)
        self._native.command(self._named(robot), forward, turn)

    def step(self, count: int = 1) -> None:
        """Run physics steps, each as long as the world defines. Ctrl-C stops between two of them."""
        self._native.step(_arrays.count("count", count, 0))

    def run(self, seconds: float) -> None:
        """Run physics steps for this simulated time. Ctrl-C stops between two of them."""
        duration = _arrays.number("seconds", seconds)
        if not 0.0 <= duration <= 1e9:
            raise ValueError(f"seconds: 0 to 1e9 is expected, not {duration}")
        self._native.run_for(round(duration * 1e9))

    def reset(self) -> None:
        """Restart at time 0 with all models at their initial poses; the output is the same as after a fresh start."""
        self._native.reset()

    def pose(self, model: str | None = None) -> NDArray[np.float64]:
        """Return the pose of a model's frame, (7,); by default the robot's."""
        return self._native.pose(self._named(model))

    def place(self, pose: ArrayLike, model: str | None = None) -> None:
        """Move a model to a pose (7,), (4, 4) or (3,) and stop it."""
        self._native.place(self._named(model), _arrays.one_pose("pose", pose))

    @overload
    def render(self, topic: str) -> NDArray[Any]: ...
    @overload
    def render(self, topic: list[str] | tuple[str, ...]) -> dict[str, NDArray[Any]]: ...
    def render(self, topic: str | list[str] | tuple[str, ...]) -> NDArray[Any] | dict[str, NDArray[Any]]:
        """Render the current frame of a topic as an array; each call renders the sensor's next frame.

        For several topics, return a dictionary. Topics of one sensor, such as its image and its ground truth, are
        then of the same frame. Optical flow is relative to the frame of the previous call, so it is left out the
        first time.

        Shapes and types are those of ``Frame.array``: images (height, width, 3) of uint8, depth (height, width) of
        float32, scans (layers, rays) of float32.

        Raises:
            ValueError: no sensor publishes this topic, in which case the message lists the existing ones; or it has
                no frame now.

        """
        topics = [topic] if isinstance(topic, str) else [_arrays.text("topic", each) for each in topic]
        arrays = {}
        for name, rendered in zip(topics, self._native.render(topics), strict=True):
            if rendered is not None:
                raw, payload = rendered
                header = np.frombuffer(raw, wire.HEADER)[0]
                wire.check(header, len(payload))
                arrays[name] = wire.plane(header, payload)
        if not isinstance(topic, str):
            return arrays
        if topic not in arrays:
            raise ValueError(f"topic: {topic!r} has no frame now; optical flow has one from the second call on")
        return arrays[topic]

    @property
    def world(self) -> World:
        """A copy of the current state as a world, for any sensor."""
        return World._of(self._native.world())

    _instead = "create it in the process that uses it: the same arguments and commands give the same bytes"

    def _named(self, name: str | None) -> str:
        name = self.robot if name is None else name
        if name is None:
            raise ValueError("robot: none was spawned; name a model")
        return name
