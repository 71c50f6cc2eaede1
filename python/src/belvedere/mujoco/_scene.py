"""A model of MuJoCo as a world that sensors see."""

from __future__ import annotations

import functools
import logging
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from belvedere import _arrays, _native
from belvedere._frames import Frames
from belvedere._looks import SEES
from belvedere._unpicklable import Unpicklable
from belvedere._world import World
from belvedere.mujoco._cameras import SceneCamera
from belvedere.mujoco._geoms import add_geom
from belvedere.mujoco._lamps import Lamps
from belvedere.mujoco._lidars import SceneLidar
from belvedere.mujoco._looks import Looks
from belvedere.mujoco._states import States, states_of
from belvedere.mujoco._worlds import Worlds

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from belvedere._arrays import ArrayLike
    from belvedere._sensors import Sensor
    from belvedere.mujoco._states import Frames as FramesOfStates

_log = logging.getLogger("belvedere")
#: A ray continues behind the back of a plane by this fraction of its distance, and by this many of its lengths.
_BEHIND = 1e-6
#: Origins of rays are nearer than this, in metres: single precision has no larger numbers.
_FAR = 1e38


class Scene(Unpicklable):
    """The shapes, materials, lamps and cameras of a model.

    Shapes and their trees are built once; a state only moves them. As in MuJoCo, geoms whose alpha is 0 are left out,
    and planes with a size end there. ``notes`` lists what is left out or shown in another way than by MuJoCo's
    renderer; each line is logged as ``belvedere``.

    Args:
        model: the model; later changes to it have no effect.
        groups: the groups of geoms that are seen, by default those that MuJoCo shows.

    Raises:
        ValueError: an argument is invalid.

    """

    _instead = "create it in the other process, from its model"

    def __init__(self, model: mujoco.MjModel, *, groups: Iterable[int] = (0, 1, 2)) -> None:
        if not isinstance(model, mujoco.MjModel):
            raise ValueError(f"model: an MjModel is expected, not {type(model).__name__}")
        try:
            groups = tuple(groups)
        except TypeError as error:
            raise ValueError(f"groups: numbers of groups are expected, not {groups!r}") from error
        for group in groups:
            _arrays.count("groups", group, 0, mujoco.mjNGROUP - 1)
        self.model = model
        #: The world of all geoms that are seen, a body each.
        self.world = World()
        #: Differences from MuJoCo's renderer, one line each.
        self.notes: list[str] = []
        looks = Looks(model)
        geoms: list[int] = []
        for geom in range(model.ngeom):
            if int(model.geom_group[geom]) not in groups or looks.seen_by(geom) is None:
                continue
            name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, geom) or ""
            # A geom may have any name, so only the number makes the names of bodies different from each other.
            try:
                why = add_geom(self.world, model, geom, f"{geom} {name}".rstrip(), looks)
            except ValueError as error:
                raise ValueError(f"model: geom {name or geom}: {error}") from error
            if why is None:
                looks.added(len(geoms))
                geoms.append(geom)
            else:
                self.notes.append(f"geom {name or geom}: {why}, so it is not seen")
        #: The geom of each body of the world.
        self.geoms: NDArray[np.int64] = np.array(geoms, np.int64)
        self.world.set_sky(looks.sky())
        lamps = Lamps(self.world, model)
        #: Renders a frame in the world of each state.
        self.worlds = Worlds(self.world, lamps)
        self._note_rest(looks, lamps)
        self._geom_of_instance = np.append(self.geoms[self.world.instance_bodies], -1).astype(np.int32)
        # The last element is that of no geom.
        self._is_plane = np.append(model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE, False)

    def _note_rest(self, looks: Looks, lamps: Lamps) -> None:
        self.notes += [*looks.notes, *lamps.notes]
        for kind, count in (("flex", self.model.nflex), ("skin", self.model.nskin)):
            if count:
                self.notes.append(f"{count} objects of type {kind} are not seen, since their shapes change")
        for note in self.notes:
            _log.warning("%s", note)

    def camera(
        self,
        camera: str | int | mujoco.MjvCamera = -1,
        width: int | None = None,
        height: int | None = None,
        *,
        sensor: Sensor | None = None,
        **options: Any,
    ) -> SceneCamera:
        """Return a camera of the model.

        Args:
            camera: its name or number; −1 is the free camera as it starts; or an ``MjvCamera``, fixed or free.
            width: pixels across; by default those of the camera, or of MuJoCo's offscreen buffer.
            height: pixels down.
            sensor: a ``Camera`` or ``DepthCamera`` of this package, with any lens and preset, in the place of the
                model's own; then there are no size and options.
            **options: keywords of :class:`belvedere.Camera` other than size and lens: ``noise``, ``smooth``, …

        Raises:
            ValueError: there is no such camera, or it is orthographic.

        """
        return SceneCamera(self, camera, width, height, sensor, options)

    def lidar(
        self,
        site: str | int | None = None,
        *,
        body: str | int | None = None,
        preset: str | None = None,
        sensor: Sensor | None = None,
        **options: Any,
    ) -> SceneLidar:
        """Return a lidar on a site, or on a body: it looks along +x there, and +z is up.

        Args:
            site: name or number of a site.
            body: name or number of a body, instead of a site.
            preset: a preset of :class:`belvedere.Scanner`, such as ``os1_128``.
            sensor: a ``Lidar`` or ``Scanner`` of this package.
            **options: keywords of :class:`belvedere.Scanner` with a preset, otherwise of :class:`belvedere.Lidar`:
                ``beams``, ``lines``, ``angles``, …

        Raises:
            ValueError: there is no such site, body or preset.

        """
        return SceneLidar(self, site, body, preset, sensor, options)

    def cast(self, state: Any, origins: ArrayLike, directions: ArrayLike, *, threads: int | None = None) -> Frames:
        """Cast rays and return the first hit of each, as ``mj_ray`` does: a plane is hit only from its front.

        Args:
            state: one state: an ``MjData``, ``qpos`` (nq,), or a dictionary of arrays.
            origins: (…, 3) in metres, or one for all rays (3,).
            directions: (…, 3) of any length but 0.
            threads: the number of threads; one per processor by default.

        Returns:
            ``distance`` float32, in lengths of the direction, ∞ without a hit; ``normal`` float32 (…, 3), outwards,
            0 without a hit; ``geom`` int32, −1 without a hit; ``point`` float64 (…, 3), NaN without a hit.

        Raises:
            ValueError: an argument is invalid.

        """
        read = states_of(self.model, state)
        if read.lead != ():
            raise ValueError(f"state: one state is expected, not {read.count}")
        rays = _arrays.vectors("directions", directions, 3, np.float64)
        starts = _arrays.vectors("origins", origins, 3, np.float64)
        if starts.shape not in (rays.shape, (3,)):
            raise ValueError(f"origins: shape {starts.shape}; {rays.shape}, as directions, or (3,) is expected")
        if not (np.abs(starts) < _FAR).all():
            raise ValueError(f"origins: numbers of less than {_FAR:g} in size are expected")
        lead, is_one = rays.shape[:-1], starts.ndim == 1
        starts, rays = starts.reshape(-1, 3), rays.reshape(-1, 3)
        # Single precision counts from the middle of the origins.
        reference = starts[0] if is_one else starts.mean(axis=0) if len(starts) else np.zeros(3)
        moves = self.places(read, read.frames("geom_"), None)
        common = moves, reference, _arrays.threads(threads)
        distance, normal, geom, behind = self._hits(starts - reference, rays, None, *common)
        left = np.flatnonzero(behind)
        while len(left):
            # These rays hit the backs of planes, and continue behind them.
            limits = np.full((len(left), 2), np.inf, np.float32)
            limits[:, 0] = distance[left] * (1.0 + _BEHIND) + _BEHIND
            offsets = (starts if is_one else starts[left]) - reference
            hits = self._hits(offsets, rays[left], limits, *common)
            distance[left], normal[left], geom[left], behind = hits
            left = left[behind]
        point = starts + rays * np.where(geom < 0, np.nan, distance)[:, None].astype(np.float64)
        answers = {"distance": distance, "normal": normal, "geom": geom, "point": point}
        shaped = {name: array.reshape(lead + array.shape[1:]) for name, array in answers.items()}
        return Frames(shaped, lead[:-2], lead[-2:])

    def _hits(
        self,
        starts: NDArray[np.float64],
        rays: NDArray[np.float64],
        limits: NDArray[np.float32] | None,
        moves: _native.States,
        reference: NDArray[np.float64],
        threads: int,
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.int32], NDArray[np.bool_]]:
        """Return distance, normal and geom of the first hit of each ray, and whether it is the back of a plane."""
        count = len(rays)
        distance, normal = np.empty(count, np.float32), np.empty((count, 3), np.float32)
        instance = np.empty(count, np.uint32)
        hits = {"distance": distance, "normal": normal, "instance": instance}
        with np.errstate(over="ignore"):
            # The native module refuses what is not finite.
            origins, directions = starts.astype(np.float32), rays.astype(np.float32)
        sees = SEES["collision"]
        self.world._native.cast(origins, directions, limits, reference.tolist(), sees, True, moves, hits, threads)
        geom = self.geom_of(instance)
        behind: NDArray[np.bool_] = self._is_plane[geom]
        if behind.any():
            behind &= np.einsum("ij,ij->i", normal.astype(np.float64), rays) > 0.0
        return distance, normal, geom, behind

    @functools.cached_property
    def still(self) -> mujoco.MjData:
        """A state that nothing moves, for functions of MuJoCo that want one. To make one takes as long as a frame."""
        return mujoco.MjData(self.model)

    def geom_of(self, instances: NDArray[np.uint32]) -> NDArray[np.int32]:
        """Return the geoms of the channel ``instance``, −1 where nothing was hit."""
        last = np.uint32(len(self._geom_of_instance) - 1)
        geoms: NDArray[np.int32] = self._geom_of_instance[np.minimum(instances, last)]
        return geoms

    def places(
        self, states: States, frames: FramesOfStates, number: int | None, *, is_camera: bool = False
    ) -> _native.States:
        """Return the poses of a sensor and of the bodies of the world in each state.

        Args:
            states: the states.
            frames: places and matrices of objects in each state.
            number: the object that is the sensor's place; without one, the poses are only those of the bodies.
            is_camera: True if the object has the axes of MuJoCo's cameras.

        Raises:
            ValueError: a pose is not a rotation and a translation.

        """
        return _native.States(frames, number, is_camera, states.frames("geom_"), self.geoms)

    def __repr__(self) -> str:
        """Return the number of geoms that are seen."""
        return f"<Scene of {len(self.geoms)} of {self.model.ngeom} geoms>"
