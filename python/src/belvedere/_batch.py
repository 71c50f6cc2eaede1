"""Many worlds of one geometry."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from belvedere import _arrays
from belvedere._channels import prepare
from belvedere._frames import Frames
from belvedere._world import World

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from belvedere._arrays import ArrayLike
    from belvedere._sensors import Sensor


class Batch:
    """Worlds that share their shapes; each has poses, colours, lamps and noise of its own.

    What a world has of its own lies in arrays that are the caller's to write into: ``batch.poses[worlds, body] = …``.

    Args:
        world: the shapes, as they are now: later changes of it are not seen.
        n: how many worlds.
        randomize: called as ``randomize(batch, index, random)`` for each world that begins anew, to write into the arrays;
            ``random`` is a generator of numpy whose numbers depend on the seed, the index, and how often that world began.
        seed: of world 0; those of the others follow.

    Raises:
        ValueError: an argument is not as it must be.

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
        #: How many worlds.
        self.n = _arrays.count("n", n)
        self._seed = _arrays.count("seed", seed, 0, 2**63 - 1)
        lamps = self._world.lights()
        self._stand = np.stack([self._world.pose(body) for body in range(len(self._names))] or [np.zeros(7)])
        self._lamp_vectors = np.array([vector for vector, _ in lamps], np.float64).reshape(-1, 3)
        self._lamp_colors = np.array([color for _, color in lamps], np.float32).reshape(-1, 3)
        bodies, count = len(self._names), self.n
        #: Where bodies are: (n, bodies, 7), x y z qx qy qz qw.
        self.poses: NDArray[np.float64] = np.zeros((count, bodies, 7))
        #: Colours of bodies: (n, bodies, 3), from 0 to 1; NaN for that of the world.
        self.colors: NDArray[np.float32] = np.zeros((count, bodies, 3), np.float32)
        #: Whether pictures are on bodies: (n, bodies). What is cut out or clear by its picture keeps it.
        self.textured: NDArray[np.bool_] = np.ones((count, bodies), np.bool_)
        #: Colours of lamps times brightness: (n, lamps, 3).
        self.light_colors: NDArray[np.float32] = np.zeros((count, len(lamps), 3), np.float32)
        #: Which way directional lamps shine, where the others are: (n, lamps, 3).
        self.light_vectors: NDArray[np.float64] = np.zeros((count, len(lamps), 3))
        #: Light from everywhere: (n, 3).
        self.ambient: NDArray[np.float32] = np.zeros((count, 3), np.float32)
        #: Seeds of noise: (n,).
        self.seeds: NDArray[np.uint64] = np.arange(self._seed, self._seed + count, dtype=np.uint64)
        #: Numbers of the next frames, counted since each world began: (n,).
        self.frames: NDArray[np.uint64] = np.zeros(count, np.uint64)
        #: How often each world began anew: (n,).
        self.episodes: NDArray[np.int64] = np.full(count, -1, np.int64)
        self.reset()

    @property
    def bodies(self) -> list[str]:
        """The names of the bodies, in the order of their numbers."""
        return list(self._names)

    @property
    def memory(self) -> int:
        """Bytes that a world has of its own."""
        own = (self.poses, self.colors, self.textured, self.light_colors, self.light_vectors, self.ambient)
        return sum(array.nbytes for array in (*own, self.seeds, self.frames, self.episodes)) // self.n

    def number(self, body: str | int) -> int:
        """Return the number of a body by its name.

        Raises:
            ValueError: there is no such body.

        """
        return _arrays.body_number("body", body, self._names)

    def reset(self, mask: ArrayLike | None = None) -> None:
        """Begin some worlds anew: as the world was, and then as ``randomize`` has it.

        Args:
            mask: which: (n,) of bool; without it, all.

        """
        chosen = self._mask(mask)
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
        """Take a frame of each world; the next one has another number, and so other noise.

        Args:
            sensor: what takes them.
            poses: where it is: (n, 7) or (n, 4, 4), or one for all.
            out: arrays to write into, (n, …).
            mask: which worlds: (n,) of bool. Frames of the others stay as they are in ``out``, and are 0 in new arrays.
            channels: which are wanted.
            after: where the sensor is then; bodies are where they are now.
            before: where the sensor was then.
            threads: how many work.

        Raises:
            ValueError: an argument is not as it must be. Nothing is written then.

        """
        lead = (self.n,)
        chosen = self._mask(mask)
        flat, shape = _arrays.poses("poses", poses)
        if shape not in (lead, ()):
            raise ValueError(f"poses: poses of shape {shape}; {lead}, one for each world, or () is expected")
        flat = np.ascontiguousarray(np.broadcast_to(flat.reshape(-1, 7), (self.n, 7)))
        outputs = prepare(
            sensor._channels, sensor._default, channels, out, lead, sensor._frame, zeros=not chosen.all()
        )
        moved = _arrays.bodies("batch.poses", self._own("poses", np.float64), lead, self._names)
        if not self._names:
            moved = [], None
        later = sensor._moment("after", after, None, lead, self._names, moved)
        earlier = sensor._moment("before", before, None, lead, self._names, moved)
        looks = (
            self._own("colors", np.float32),
            self._own("light_colors", np.float32),
            self._own("light_vectors", np.float64),
            self._own("ambient", np.float32),
            self._own("textured", np.bool_),
        )
        numbers = _arrays.seeds("batch.frames", self.frames, lead)
        each = (_arrays.seeds("batch.seeds", self.seeds, lead), numbers, chosen.tolist(), looks)
        sensor._take(self._world, lead, (flat, *moved), later, earlier, each, outputs, threads)
        self.frames[chosen] += np.uint64(1)
        return Frames(outputs, lead)

    def _own(self, name: str, dtype: type[np.generic]) -> NDArray[Any]:
        """Return an array of the worlds as it must be, if somebody put another in its place."""
        lamps = len(self._lamp_vectors)
        shapes = {
            "poses": (self.n, len(self._names), 7),
            "colors": (self.n, len(self._names), 3),
            "textured": (self.n, len(self._names)),
            "light_colors": (self.n, lamps, 3),
            "light_vectors": (self.n, lamps, 3),
            "ambient": (self.n, 3),
        }
        array = _arrays.array(f"batch.{name}", getattr(self, name), dtype)
        if array.shape != shapes[name]:
            raise ValueError(f"batch.{name}: shape {array.shape}; {shapes[name]} is expected")
        return array

    def _mask(self, mask: ArrayLike | None) -> NDArray[np.bool_]:
        if mask is None:
            return np.ones(self.n, bool)
        given = np.asarray(mask)
        if given.shape != (self.n,) or given.dtype != np.bool_:
            raise ValueError(f"mask: shape {given.shape} of {given.dtype}; ({self.n},) of bool is expected")
        return given

    def __repr__(self) -> str:
        """How many worlds and bodies it has."""
        return f"<Batch of {self.n} worlds of {len(self._names)} bodies>"
