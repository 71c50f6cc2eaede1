"""A world that runs, stepped and rendered by its caller."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from belvedere import _arrays, _native, wire
from belvedere._unpicklable import Unpicklable
from belvedere._world import MODELS, World, arguments, folders, report

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from belvedere._arrays import ArrayLike


class Simulation(Unpicklable):
    """A world with robots in it: no other process, no shared memory, no clock.

    Same world, seed and commands give the same bytes as ``belvedere run``.

    Args:
        world: a name, a file or a text, as for ``World``.
        robot: likewise; more are brought by ``spawn``. A robot that is given for a world is alone, without a floor.
        seed: of all noise.
        pose: where the robot stands, which is brought by ``robot``.
        gazebo_compat: Gazebo classic's habits instead of what is right.
        threads: how many render; without it, one a processor.
        package_path: folders of ROS packages.
        xacro: arguments of the robot's xacro.

    Raises:
        ValueError: something in world or robot cannot be used: the lines that the command line prints.

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
                    f"{argument}: it is of robot=…, which is expected beside it: Simulation('empty', robot=…)"
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
        #: The name of the robot that is meant where none is named: the one that came last.
        self.robot: str | None = self._native.thing
        self._told = 0
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
        """Bring a robot or a thing, by name, file or text; return what it is called.

        Args:
            source: as for ``World``.
            name: what it is called; without it, as its file has it.
            namespace: what stands before its topics and frames.
            pose: where it is to be, (7,), (4, 4) or (3,): from there its own ``<pose>`` counts, as when Gazebo spawns it.
            xacro: arguments for ``$(arg name)``.

        Raises:
            ValueError: the name is taken, or something cannot be used. Nothing of it is there then.

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
        """Log what was ignored since the last time."""
        notes = self.notes
        report(notes[self._told :])
        self._told = len(notes)

    @property
    def notes(self) -> list[str]:
        """What was ignored in the descriptions of world and robots, one line each."""
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
        """The names of everybody who is there."""
        return self._native.models

    @property
    def topics(self) -> list[str]:
        """All topics that can be rendered."""
        return self._native.topics()

    def command(self, velocity: ArrayLike, robot: str | None = None) -> None:
        """Give a robot's base a velocity: (forward in m/s, turn in rad/s), followed for as long as its plugin says.

        Raises:
            ValueError: there is no such robot, or it has no base that drives.

        """
        forward, turn = _arrays.numbers("velocity", velocity, 2)
        self._native.command(self._named(robot), forward, turn)

    def step(self, count: int = 1) -> None:
        """Make steps of physics, each as long as the world says. Ctrl-C ends it between two of them."""
        self._native.step(_arrays.count("count", count, 0))

    def run(self, seconds: float) -> None:
        """Make steps until so much simulated time has passed. Ctrl-C ends it between two of them."""
        duration = _arrays.number("seconds", seconds)
        if not 0.0 <= duration <= 1e9:
            raise ValueError(f"seconds: 0 to 1e9 is expected, not {duration}")
        self._native.run_for(round(duration * 1e9))

    def reset(self) -> None:
        """Begin again at time 0, everybody where each was at first: the same bytes follow as after a fresh start."""
        self._native.reset()

    def pose(self, model: str | None = None) -> NDArray[np.float64]:
        """Return where a model's frame is: (7,). Without a name, the robot's."""
        return self._native.pose(self._named(model))

    def place(self, pose: ArrayLike, model: str | None = None) -> None:
        """Put a model somewhere, at rest: (7,), (4, 4) or (3,)."""
        self._native.place(self._named(model), _arrays.one_pose("pose", pose))

    @overload
    def render(self, topic: str) -> NDArray[Any]: ...
    @overload
    def render(self, topic: list[str] | tuple[str, ...]) -> dict[str, NDArray[Any]]: ...
    def render(self, topic: str | list[str] | tuple[str, ...]) -> NDArray[Any] | dict[str, NDArray[Any]]:
        """Return what a topic shows now, as an array; each call takes the next frame of that sensor.

        Of several topics a dictionary: those of one sensor, as its picture and its truth, are then of one frame. The flow
        leads from the frame for which it was asked before; so the first time it is left out.

        Shapes and types are those of ``Frame.array``: pictures (height, width, 3) of uint8, depth (height, width) of
        float32, scans (layers, rays) of float32.

        Raises:
            ValueError: no sensor sends such a topic, those that there are are named; or it has no frame now.

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
            raise ValueError(
                f"topic: {topic!r} has no frame now; flow has one from the second time on that it is asked for"
            )
        return arrays[topic]

    @property
    def world(self) -> World:
        """What is seen now, as a world of its own, for any sensor."""
        return World._of(self._native.world())

    _instead = "make it where it is used: the same arguments and commands give the same bytes"

    def _named(self, name: str | None) -> str:
        name = self.robot if name is None else name
        if name is None:
            raise ValueError("robot: none was spawned; name a model")
        return name
