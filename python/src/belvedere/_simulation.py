"""A world that runs, stepped and rendered by its caller."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from belvedere import _arrays, _native, wire
from belvedere._world import MODELS, World, arguments, folders, report

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from belvedere._arrays import ArrayLike


class Simulation:
    """A world with robots in it: no other process, no shared memory, no clock.

    Same world, seed and commands give the same bytes as ``belvedere run``.

    Args:
        world: a name, a file or a text, as for ``World``.
        robot: likewise; more are brought by ``spawn``.
        seed: of all noise.
        pose: where the robot stands.
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
        self._package_path = folders(package_path)
        self._native = _native.Simulation(
            os.fspath(world),
            _arrays.count("seed", seed, 0, 2**64 - 1),
            bool(gazebo_compat),
            _arrays.threads(threads),
            self._package_path,
            MODELS,
        )
        #: The name of the robot that is meant where none is named: the one that came last.
        self.robot: str | None = None
        if robot is None:
            report(self._native.notes)
        else:
            self.spawn(robot, pose=pose, xacro=xacro)

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
            pose: where its frame is to be: (7,), (4, 4) or (3,).
            xacro: arguments for ``$(arg name)``.

        Raises:
            ValueError: the name is taken, or something cannot be used. Nothing of it is there then.

        """
        called = self._native.spawn(
            os.fspath(source),
            name,
            namespace,
            _arrays.one_pose("pose", pose),
            self._package_path,
            MODELS,
            arguments(xacro),
        )
        self.robot = called
        report(self._native.notes)
        return called

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
        """Make steps of physics, each as long as the world says."""
        self._native.step(_arrays.count("count", count, 0))

    def run(self, seconds: float) -> None:
        """Make steps until so much simulated time has passed."""
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

    def render(self, topic: str) -> NDArray[Any]:
        """Return what a topic shows now, as an array; each call takes the next frame of that sensor.

        Shapes and types are those of ``Frame.array``: pictures (height, width, 3) of uint8, depth (height, width) of
        float32, scans (layers, rays) of float32.

        Raises:
            ValueError: no sensor sends such a topic; those that there are are named.

        """
        raw, payload = self._native.render(topic)
        header = np.frombuffer(raw, wire.HEADER)[0]
        wire.check(header, len(payload))
        return wire.plane(header, payload)

    @property
    def world(self) -> World:
        """What is seen now, as a world of its own, for any sensor."""
        return World._of(self._native.world())

    def _named(self, name: str | None) -> str:
        name = self.robot if name is None else name
        if name is None:
            raise ValueError("robot: none was spawned; name a model")
        return name
