"""Stages of OpenUSD as worlds."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, Any

import numpy as np

from belvedere import _arrays
from belvedere._importer import Importer
from belvedere._placed_camera import PlacedCamera, pose_of
from belvedere._required import required
from belvedere._usd_material import Materials
from belvedere._usd_mesh import Meshes

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from belvedere._world import World

#: Rotations that turn the z axis into the axis of a solid, (3, 3).
_AXES: dict[str, list[list[float]]] = {
    "X": [[0, 0, 1], [0, 1, 0], [-1, 0, 0]],
    "Y": [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
    "Z": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
}
#: Shapes that are left out.
_LEFT_OUT = {"PointBased", "Gprim", "Volume"}


def world_of(given: Any, time: float | None) -> World:
    """Return the world of a stage or a file."""
    usd = required("pxr.Usd", "usd-core", "World.from_usd")
    if isinstance(given, (str, os.PathLike)):
        tf = required("pxr.Tf", "usd-core", "World.from_usd")
        try:
            given = usd.Stage.Open(os.fspath(given))
        except tf.ErrorException as error:
            raise ValueError(f"stage: {os.fspath(given)!r} cannot be opened: {error}") from error
    if not isinstance(given, usd.Stage):
        raise ValueError(f"stage: a pxr.Usd.Stage or a path is expected, not {type(given).__name__}")
    code = usd.TimeCode.EarliestTime() if time is None else usd.TimeCode(_arrays.number("time", time))
    return _Reader(given, code).read()


class _Reader:
    """Reads the prims of a stage at a time."""

    def __init__(self, stage: Any, time: Any) -> None:
        self._usd = required("pxr.Usd", "usd-core", "World.from_usd")
        self._geom = required("pxr.UsdGeom", "usd-core", "World.from_usd")
        self._lux = required("pxr.UsdLux", "usd-core", "World.from_usd")
        self._stage, self._time = stage, time
        up = str(self._geom.GetStageUpAxis(stage))
        self._importer = Importer(self._geom.GetStageMetersPerUnit(stage), up)
        self._cache = self._geom.XformCache(time)
        self._meshes = Meshes(self._importer, Materials(self._importer, time), time)
        #: Makes the shapes that are no meshes: a world's method with its sizes, and the axis of the shape.
        self._solids: dict[str, Callable[[Any, Any], tuple[Callable[..., int], str]]] = {
            "Cube": lambda prim, world: ((lambda **to: world.add_box([prim("size")] * 3, **to)), "Z"),
            "Sphere": lambda prim, world: ((lambda **to: world.add_sphere(prim("radius"), **to)), "Z"),
            "Cylinder": lambda prim, world: (_round(world.add_cylinder, prim), prim("axis")),
            "Capsule": lambda prim, world: (_round(world.add_capsule, prim), prim("axis")),
            "Cone": lambda prim, world: (_round(world.add_cone, prim), prim("axis")),
        }

    def read(self) -> World:
        for error in self._stage.GetCompositionErrors():
            self._importer.note(f"the stage is not whole: {error}")
        self._walk(self._stage.GetPseudoRoot(), np.eye(4), None, ())
        return self._importer.done()

    def _walk(self, root: Any, place: NDArray[np.float64], name: str | None, inside: tuple[Any, ...]) -> None:
        """Add what is below a prim.

        Args:
            root: the prim.
            place: the transform of the prim's frame, (4, 4).
            name: of the root, or None for names that are the paths of prims.
            inside: the paths of the instancers above.

        """
        prims = self._usd.PrimRange(root, self._usd.TraverseInstanceProxies(self._usd.PrimDefaultPredicate))
        walk = iter(prims)
        for prim in walk:
            imageable = self._geom.Imageable(prim)
            if not imageable:
                continue
            if imageable.GetVisibilityAttr().Get(self._time) == self._geom.Tokens.invisible:
                walk.PruneChildren()
                continue
            matrix = place @ self._relative(prim, root)
            path = str(prim.GetPath())
            shown = path if name is None else name + path.removeprefix(str(root.GetPath()))
            if prim.IsA(self._geom.PointInstancer):
                walk.PruneChildren()
                self._instances(prim, matrix, shown, inside)
            elif imageable.ComputePurpose() not in (self._geom.Tokens.guide, self._geom.Tokens.proxy):
                self._add(prim, matrix, shown)

    def _relative(self, prim: Any, root: Any) -> NDArray[np.float64]:
        """Return the transform from a prim's frame to that of a prim above it, (4, 4)."""
        if prim == root:
            return np.eye(4)
        if root.IsPseudoRoot():
            return np.array(self._cache.GetLocalToWorldTransform(prim)).T
        return np.array(self._cache.ComputeRelativeTransform(prim, root)[0]).T

    def _add(self, prim: Any, matrix: NDArray[np.float64], name: str) -> None:
        kind = str(prim.GetTypeName())
        if prim.IsA(self._geom.Mesh):
            self._meshes.add(prim, matrix, name)
        elif prim.IsA(self._geom.Camera):
            self._add_camera(prim, matrix, name)
        elif kind in self._solids:
            add, axis = self._solids[kind](lambda key: prim.GetAttribute(key).Get(self._time), self._importer.world)
            turned = matrix.copy()
            turned[:3, :3] = matrix[:3, :3] @ np.array(_AXES[str(axis)])
            look = self._meshes.look_of_solid(prim)
            self._importer.add_solid(name, turned, lambda **to: add(**to, **look))
        elif prim.IsA(self._geom.Gprim) or kind == "Volume":
            self._importer.note(f"prims of the type {kind} are left out")
        elif prim.HasAPI(self._lux.LightAPI):
            self._importer.note(f"lights of the type {kind} are left out; World.add_light adds some")

    def _instances(self, prim: Any, matrix: NDArray[np.float64], name: str, inside: tuple[Any, ...]) -> None:
        """Add the instances of a point instancer."""
        instancer = self._geom.PointInstancer(prim)
        path = prim.GetPath()
        if path in inside:
            self._importer.note("instancers that contain themselves are left out")
            return
        roots = [self._stage.GetPrimAtPath(target) for target in instancer.GetPrototypesRel().GetTargets()]
        numbers = instancer.GetProtoIndicesAttr().Get(self._time) or []
        places = instancer.ComputeInstanceTransformsAtTime(
            self._time,
            self._time,
            self._geom.PointInstancer.IncludeProtoXform,
            self._geom.PointInstancer.IgnoreMask,
        )
        shown = instancer.ComputeMaskAtTime(self._time) or [True] * len(numbers)
        if not len(places) == len(numbers) == len(shown):
            self._importer.note(f"{name} has {len(numbers)} instances with {len(places)} places, and is left out")
            return
        for index, (number, place) in enumerate(zip(numbers, places, strict=True)):
            if not shown[index]:
                continue
            if not 0 <= number < len(roots) or not roots[number]:
                self._importer.note("instances without a prototype are left out")
                continue
            of = f"{name}/{roots[number].GetName()}_{index}"
            self._walk(roots[number], matrix @ np.array(place).T, of, (*inside, path))

    def _add_camera(self, prim: Any, matrix: NDArray[np.float64], name: str) -> None:
        camera = self._geom.Camera(prim).GetCamera(self._time)
        if camera.projection != camera.Perspective:
            self._importer.note("orthographic cameras are left out")
            return
        window = camera.frustum.window
        (left, below), (right, above) = window.GetMin(), window.GetMax()
        near, far = camera.clippingRange.min, camera.clippingRange.max
        values = (left, right, below, above, near, far)
        if not all(math.isfinite(value) for value in values) or left >= right or below >= above:
            self._importer.note("cameras without an aperture or a focal length are left out")
            return
        metres = self._importer.metres
        self._importer.cameras[name] = PlacedCamera(
            pose=pose_of(self._importer.world_from_scene @ matrix),
            frustum=(left, right, below, above),
            near=max(near * metres, 1e-6),
            far=far * metres,
        )


def _round(add: Callable[..., int], prim: Any) -> Callable[..., int]:
    return lambda **to: add(prim("radius"), prim("height"), **to)
