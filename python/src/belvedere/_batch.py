"""Many worlds with the same geometry."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from belvedere import _arrays
from belvedere._channels import prepare
from belvedere._frames import Frames
from belvedere._sensors import Sensor
from belvedere._unpicklable import Unpicklable
from belvedere._world import World

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from belvedere._arrays import ArrayLike
    from belvedere._native import _Looks, _Places

#: Limits of a lamp's light, and of its distance in metres.
_LARGEST, _FARTHEST = float(np.finfo(np.float32).max), 1e12


def _within(rows: NDArray[Any], least: float, most: float) -> NDArray[np.bool_]:
    """Return which rows are within the limits; NaN is not."""
    inside: NDArray[np.bool_] = np.all((rows >= least) & (rows <= most), axis=-1)
    return inside


class Batch(Unpicklable):
    """Worlds that share their shapes; each has its own poses, colours, lamps and noise.

    The properties of each world are in arrays that the caller may write into: ``batch.poses[worlds, body] = …``.

    Args:
        world: the shapes; later changes to this world have no effect.
        n: the number of worlds.
        randomize: called as ``randomize(batch, index, random)`` for each world that is reset, to write into the
            arrays; ``random`` is a numpy generator whose numbers depend on the seed, the index, and the number of
            resets of that world.
        seed: the seed of world 0; the other worlds use the following numbers.

    Raises:
        ValueError: an argument is invalid.

    """

    def __init__(
        self,
        world: World,
        n: int,
        *,
        randomize: Callable[[Batch, int, np.random.Generator], None] | None = None,
        seed: int = 0,
    ) -> None:
        if not isinstance(world, World):
            raise ValueError(f"world: a World is expected, not {type(world).__name__}")
        self._world = world._native.snapshot()
        self._names = self._world.bodies
        self._randomize = randomize
        #: The number of worlds.
        self.n = _arrays.count("n", n)
        self._seed = _arrays.count("seed", seed, 0, 2**63 - 1)
        lamps = self._world.lights()
        self._stand = np.stack([self._world.pose(body) for body in range(len(self._names))] or [np.zeros(7)])
        self._lamp_vectors = np.array([vector for vector, _, _ in lamps], np.float64).reshape(-1, 3)
        self._lamp_colors = np.array([color for _, color, _ in lamps], np.float32).reshape(-1, 3)
        self._is_parallel = np.array([is_parallel for _, _, is_parallel in lamps], bool)
        bodies, count = len(self._names), self.n
        #: Poses of bodies: (n, bodies, 7), x y z qx qy qz qw.
        self.poses: NDArray[np.float64] = np.zeros((count, bodies, 7))
        #: Colours of bodies: (n, bodies, 3), from 0 to 1; three NaN for the colour of the world.
        self.colors: NDArray[np.float32] = np.zeros((count, bodies, 3), np.float32)
        #: True if bodies have their textures: (n, bodies). Transparency from a texture always remains.
        self.textured: NDArray[np.bool_] = np.ones((count, bodies), np.bool_)
        #: Colours of lamps times brightness, 0 or more: (n, lamps, 3).
        self.light_colors: NDArray[np.float32] = np.zeros((count, len(lamps), 3), np.float32)
        #: Directions of directional lamps, of any length but 0; positions of the others: (n, lamps, 3).
        self.light_vectors: NDArray[np.float64] = np.zeros((count, len(lamps), 3))
        #: Ambient light, 0 or more: (n, 3).
        self.ambient: NDArray[np.float32] = np.zeros((count, 3), np.float32)
        #: Seeds of noise: (n,).
        self.seeds: NDArray[np.uint64] = np.arange(self._seed, self._seed + count, dtype=np.uint64)
        #: Number of the next frame of each world, counted since its last reset: (n,).
        self.frames: NDArray[np.uint64] = np.zeros(count, np.uint64)
        #: Number of resets of each world after its start: (n,).
        self.episodes: NDArray[np.int64] = np.full(count, -1, np.int64)
        self.reset()

    @property
    def bodies(self) -> list[str]:
        """The names of the bodies, in the order of their numbers."""
        return list(self._names)

    @property
    def memory(self) -> int:
        """Bytes of the properties of one world."""
        own = (self.poses, self.colors, self.textured, self.light_colors, self.light_vectors, self.ambient)
        return sum(np.asarray(array).nbytes for array in (*own, self.seeds, self.frames, self.episodes)) // self.n

    def number(self, body: str | int) -> int:
        """Return the number of a body by its name.

        Raises:
            ValueError: there is no such body.

        """
        return _arrays.body_number("body", body, self._names)

    def reset(self, mask: ArrayLike | None = None) -> None:
        """Reset some worlds to the original world, and then apply ``randomize``.

        Args:
            mask: the worlds, (n,) of bool; all by default.

        """
        chosen = self._mask(mask)
        for name in self._shapes():
            if not isinstance(getattr(self, name), np.ndarray):
                # The array was replaced, for example by a list.
                setattr(self, name, self._own(name))
        if not isinstance(self.frames, np.ndarray):
            self.frames = np.array(_arrays.seeds("batch.frames", self.frames, (self.n,)), np.uint64)
        self.poses[chosen] = self._stand[: len(self._names)]
        self.colors[chosen] = np.nan
        self.textured[chosen] = True
        self.light_colors[chosen] = self._lamp_colors
        self.light_vectors[chosen] = self._lamp_vectors
        self.ambient[chosen] = self._world.ambient()
        self.frames[chosen] = 0
        self.episodes[chosen] += 1
        if self._randomize is not None:
            for index in np.flatnonzero(chosen).tolist():
                random = np.random.default_rng([self._seed, index, int(self.episodes[index])])
                self._randomize(self, index, random)

    def render(
        self,
        sensor: Sensor,
        poses: ArrayLike,
        out: Mapping[str, ArrayLike] | None = None,
        *,
        mask: ArrayLike | None = None,
        channels: Sequence[str] | None = None,
        after: ArrayLike | None = None,
        before: ArrayLike | None = None,
        threads: int | None = None,
    ) -> Frames:
        """Render a frame of each world. Each call increments the frame numbers, and so changes the noise.

        Args:
            sensor: the sensor.
            poses: the sensor's poses: (n, 7) or (n, 4, 4), or one for all.
            out: arrays to write into, (n, …).
            mask: the worlds, (n,) of bool. Frames of the others are unchanged in ``out``, and 0 in new arrays.
            channels: the channels to render.
            after: the sensor's poses at the next frame, like ``poses``; bodies keep their poses.
            before: the sensor's poses at the previous frame.
            threads: the number of threads.

        Raises:
            ValueError: an argument, or an array of the batch, is invalid in any world. Nothing is written then.
            KeyboardInterrupt: Ctrl-C; frames that were not begun are not written, and no frame is counted.

        """
        lead = (self.n,)
        if not isinstance(sensor, Sensor):
            raise ValueError(f"sensor: a Camera, Lidar or other Sensor is expected, not {type(sensor).__name__}")
        chosen = self._mask(mask)
        outputs = prepare(
            sensor._channels, sensor._default, channels, out, lead, sensor._frame, zeros=not chosen.all()
        )
        moved = _arrays.bodies("batch.poses", self._own("poses"), lead, self._names)
        if not self._names:
            moved = [], None

        def moment(argument: str, value: ArrayLike) -> _Places:
            flat, shape = _arrays.poses(argument, value)
            if shape not in (lead, ()):
                raise ValueError(
                    f"{argument}: poses of shape {shape}; {lead}, one for each world, or () is expected"
                )
            return np.ascontiguousarray(np.broadcast_to(flat, (self.n, 7))), *moved

        now = moment("poses", poses)
        later = None if after is None else moment("after", after)
        earlier = None if before is None else moment("before", before)
        numbers = _arrays.seeds("batch.frames", self.frames, lead)
        each = (_arrays.seeds("batch.seeds", self.seeds, lead), numbers, chosen.tolist(), self._looks())
        if not isinstance(self.frames, np.ndarray) or not self.frames.flags.writeable:
            self.frames = np.array(numbers, np.uint64)
        sensor._take(self._world, lead, now, later, earlier, each, outputs, threads)
        self.frames[chosen] += 1
        return Frames(outputs, lead, sensor._frame, sensor, numbers)

    def _shapes(self) -> dict[str, tuple[tuple[int, ...], type[np.generic]]]:
        """Shapes and types of the worlds' arrays."""
        bodies, lamps = len(self._names), len(self._lamp_vectors)
        return {
            "poses": ((self.n, bodies, 7), np.float64),
            "colors": ((self.n, bodies, 3), np.float32),
            "textured": ((self.n, bodies), np.bool_),
            "light_colors": ((self.n, lamps, 3), np.float32),
            "light_vectors": ((self.n, lamps, 3), np.float64),
            "ambient": ((self.n, 3), np.float32),
        }

    def _own(self, name: str) -> NDArray[Any]:
        """Return a checked array of the worlds, which the caller may have replaced."""
        shape, dtype = self._shapes()[name]
        array = _arrays.array(f"batch.{name}", getattr(self, name), dtype)
        if array.shape != shape:
            raise ValueError(f"batch.{name}: shape {array.shape}; {shape} is expected")
        return array

    def _looks(self) -> _Looks:
        """Return the appearance of each world.

        Raises:
            ValueError: a colour or lamp is invalid in some world.

        """
        colors, light_colors, vectors, ambient = (
            self._own(name) for name in ("colors", "light_colors", "light_vectors", "ambient")
        )
        own = np.isnan(colors).all(axis=-1) | _within(colors, 0.0, 1.0)
        self._refuse("colors", ~own, "numbers from 0 to 1 are expected, or NaN in all three for the world's own")
        for name, lights in (("light_colors", light_colors), ("ambient", ambient)):
            self._refuse(name, ~_within(lights, 0.0, _LARGEST), "finite numbers of 0 or more are expected")
        self._refuse("light_vectors", ~_within(vectors, -_FARTHEST, _FARTHEST), "numbers up to 1e12 are expected")
        nowhere = self._is_parallel & (vectors == 0).all(axis=-1)
        self._refuse("light_vectors", nowhere, "a direction of any length but 0 is expected")
        return colors, light_colors, vectors, ambient, self._own("textured"), None

    def _refuse(self, name: str, bad: NDArray[np.bool_], expected: str) -> None:
        """Raise an error that names the first bad row of an array of the worlds."""
        if not bad.any():
            return
        world, *rest = (int(part) for part in np.argwhere(bad)[0])
        whose = f"world {world}"
        if rest:
            whose += f", {f'body {self._names[rest[0]]!r}' if name == 'colors' else f'lamp {rest[0]}'}"
        row = self._own(name)[(world, *rest)]
        raise ValueError(f"batch.{name}: of {whose}, {expected}, not {row.tolist()}")

    def _mask(self, mask: ArrayLike | None) -> NDArray[np.bool_]:
        if mask is None:
            return np.ones(self.n, bool)
        given = np.asarray(mask)
        if given.shape != (self.n,) or given.dtype != np.bool_:
            raise ValueError(
                f"mask: shape {given.shape} of {given.dtype}; ({self.n},) of bool is expected: np.array(mask, bool)"
            )
        return given

    _instead = "create it in the process that uses it, from its world, seed and randomize"

    def __repr__(self) -> str:
        """Return the numbers of worlds and bodies."""
        return f"<Batch of {self.n} worlds of {len(self._names)} bodies>"
