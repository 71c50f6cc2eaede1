"""What the readers of other packages' scenes share: they add meshes to a world, and note what they leave out."""

from __future__ import annotations

import hashlib
import logging
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from belvedere import _arrays
from belvedere._world import World

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable

    from numpy.typing import NDArray

    from belvedere._placed_camera import PlacedCamera

_log = logging.getLogger("belvedere")
#: Rotations to axes with z up, by the axis that is up in a scene.
_UP: dict[str, NDArray[np.float64]] = {
    "z": np.eye(3),
    "y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
}
#: A mesh this many times farther from its origin than it is long would be rough in single precision.
_FAR = 100.0


class Mesh(NamedTuple):
    """Triangles in a frame of their own, and their look."""

    #: (V, 3)
    vertices: NDArray[Any]
    #: (F, 3), counter-clockwise seen from outside.
    faces: NDArray[Any]
    #: Texture coordinates with v upwards, (V, 2).
    uvs: NDArray[Any] | None
    #: Keywords of ``World.add_mesh``.
    look: dict[str, Any]
    #: Outward normals of the vertices, (V, 3); without them, triangles are flat.
    normals: NDArray[Any] | None = None


class _Known(NamedTuple):
    """A mesh that the world has."""

    body: int
    #: The middle that was subtracted from its vertices, (3,).
    middle: NDArray[np.float64]


class Importer:
    """A world that is made of another package's scene.

    Args:
        metres: the length of the scene's unit in metres.
        up: ``z`` or ``y``, the axis of the scene that is up.

    Raises:
        ValueError: an argument is invalid.

    """

    def __init__(self, metres: float = 1.0, up: str = "z") -> None:
        if not isinstance(up, str) or up.lower() not in _UP:
            raise ValueError(f"up: z or y is expected, not {up!r}")
        if not np.isfinite(metres) or metres <= 0.0:
            raise ValueError(f"the scene's unit: a length of more than 0 metres is expected, not {metres!r}")
        self.world = World()
        self.metres = float(metres)
        self.cameras: dict[str, PlacedCamera] = {}
        #: From the scene's frame to the world's, (4, 4).
        self.world_from_scene = np.eye(4)
        self.world_from_scene[:3, :3] = _UP[up.lower()] * metres
        self._known: dict[Hashable, _Known | None] = {}
        self._textures: dict[tuple[tuple[int, ...], bytes], int] = {}
        self._counts: dict[str, int] = {}
        self._names: dict[str, int] = {}

    def note(self, what: str, count: int = 1) -> None:
        """Note something that is left out, or shown in another way."""
        self._counts[what] = self._counts.get(what, 0) + count

    def name(self, wanted: str) -> str:
        """Return a name that no other body has: the given one, or with a number."""
        name = wanted
        while name in self._names:
            self._names[wanted] += 1
            name = f"{wanted}_{self._names[wanted]}"
        self._names[name] = 1
        return name

    def add(self, name: str, key: Hashable, scene_from_mesh: NDArray[Any], mesh: Callable[[], Mesh | None]) -> None:
        """Add a body.

        Args:
            name: its name; a number is appended if another body has it.
            key: bodies with the same key share the mesh and the look.
            scene_from_mesh: (4, 4), any affine transform.
            mesh: makes the mesh, if no body with this key has done so; None for a mesh without triangles.

        Raises:
            ValueError: the mesh or the transform cannot be used.

        """
        matrix = self.world_from_scene @ _matrix(name, scene_from_mesh)
        parts = decomposed(matrix)
        if parts is None:
            # Sheared: the vertices are transformed, and no other body can share them.
            made = mesh()
            body = None if made is None or len(made.faces) == 0 else self._add_baked(name, matrix, made)
        else:
            body = self._add_shared(name, key, matrix, *parts, mesh)
        if body is None:
            self.note("meshes without triangles or without an extent are left out")

    def _add_shared(
        self,
        name: str,
        key: Hashable,
        matrix: NDArray[np.float64],
        rotation: NDArray[np.float64],
        scale: NDArray[np.float64],
        mesh: Callable[[], Mesh | None],
    ) -> int | None:
        pose = np.eye(4)
        pose[:3, :3] = rotation
        if key in self._known:
            known = self._known[key]
            if known is None or not scale.all():
                return None
            pose[:3, 3] = matrix[:3, 3] + matrix[:3, :3] @ known.middle
            return self.world.add_copy(known.body, pose, name=self.name(name), scale=scale)
        made = mesh()
        if made is None or len(made.faces) == 0:
            self._known[key] = None
            return None
        if not scale.all():
            return None
        middle, vertices = _centred(made.vertices)
        pose[:3, 3] = matrix[:3, 3] + matrix[:3, :3] @ middle
        body = self._add(name, vertices, made.faces, made, pose, scale, made.normals)
        self._known[key] = _Known(body, middle)
        return body

    def _add_baked(self, name: str, matrix: NDArray[np.float64], made: Mesh) -> int | None:
        if np.linalg.matrix_rank(matrix[:3, :3]) == 0:
            return None
        middle, vertices = _centred(np.asarray(made.vertices, np.float64) @ matrix[:3, :3].T)
        pose = np.eye(4)
        pose[:3, 3] = matrix[:3, 3] + middle
        is_mirrored = np.linalg.det(matrix[:3, :3]) < 0.0
        faces = np.asarray(made.faces)[:, ::-1] if is_mirrored else made.faces
        normals = made.normals
        if normals is not None:
            # Cofactors are the inverse transpose, up to a factor, and exist without an inverse too.
            columns = matrix[:3, :3].T
            cofactors = np.stack([np.cross(columns[i - 2], columns[i - 1]) for i in range(3)])
            normals = np.asarray(normals, np.float64) @ cofactors * (-1.0 if is_mirrored else 1.0)
        return self._add(name, vertices, faces, made, pose, np.ones(3), normals)

    def _add(
        self,
        name: str,
        vertices: NDArray[Any],
        faces: NDArray[Any],
        made: Mesh,
        pose: NDArray[np.float64],
        scale: NDArray[np.float64],
        normals: NDArray[Any] | None,
    ) -> int:
        look, unique = dict(made.look), self.name(name)
        texture = look.get("texture")
        # Many meshes may have the same large image.
        key = None if texture is None else (texture.shape, hashlib.blake2b(texture.tobytes()).digest())
        if key in self._textures:
            look["texture"] = self._textures[key]
        try:
            body = self.world.add_mesh(
                vertices, faces, pose, uvs=made.uvs, normals=usable(normals), name=unique, scale=scale, **look
            )
        except ValueError as error:
            raise ValueError(f"mesh {name!r}: {error}") from error
        if key is not None:
            self._textures.setdefault(key, body)
        return body

    def add_solid(self, name: str, scene_from_solid: NDArray[Any], add: Callable[..., int]) -> None:
        """Add a shape that is no mesh: ``add`` is called with keywords ``pose``, ``scale`` and ``name``."""
        matrix = self.world_from_scene @ _matrix(name, scene_from_solid)
        parts = decomposed(matrix)
        if parts is None or not parts[1].all():
            self.note("shapes that are sheared or without an extent are left out")
            return
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = parts[0], matrix[:3, 3]
        try:
            add(pose=pose, scale=parts[1], name=self.name(name))
        except ValueError as error:
            raise ValueError(f"shape {name!r}: {error}") from error

    def done(self) -> World:
        """Return the world, and log what was left out."""
        notes = [what if count == 1 else f"{what} ({count} times)" for what, count in self._counts.items()]
        for note in notes:
            _log.warning("%s", note)
        self.world._take(notes, self.cameras)
        return self.world


def _matrix(name: str, given: NDArray[Any]) -> NDArray[np.float64]:
    matrix = _arrays.array(f"transform of {name!r}", given, np.float64)
    if matrix.shape != (4, 4) or not np.isfinite(matrix).all() or not np.allclose(matrix[3], [0, 0, 0, 1]):
        raise ValueError(
            f"transform of {name!r}: a finite matrix (4, 4) with the last row 0 0 0 1 is expected, "
            f"not {matrix.tolist()}"
        )
    return matrix


def decomposed(matrix: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Return rotation (3, 3) and scale (3,) of an affine transform; None if it shears.

    A transform without an extent along an axis has a scale of 0 there.
    """
    linear = matrix[:3, :3]
    scale = np.linalg.norm(linear, axis=0)
    if not scale.all():
        return np.eye(3), np.zeros(3)
    rotation = linear / scale
    if np.abs(rotation.T @ rotation - np.eye(3)).max() > 1e-5:
        return None
    if np.linalg.det(rotation) < 0.0:
        rotation[:, 2] *= -1.0
        scale[2] *= -1.0
    left, _, right = np.linalg.svd(rotation)
    return left @ right, scale


def _centred(vertices: NDArray[Any]) -> tuple[NDArray[np.float64], NDArray[Any]]:
    """Return the middle that was subtracted from vertices, 0 0 0 for those near their origin, and the rest."""
    points = np.asarray(vertices)
    if points.ndim != 2 or points.shape[1:] != (3,) or len(points) == 0 or not np.isfinite(points).all():
        return np.zeros(3), points
    low, high = points.min(axis=0).astype(np.float64), points.max(axis=0).astype(np.float64)
    if np.abs([low, high]).max() <= _FAR * (high - low).max():
        return np.zeros(3), points
    middle = (low + high) / 2.0
    return middle, points - middle


def usable(normals: NDArray[Any] | None) -> NDArray[np.float64] | None:
    """Return normals with length 1; none if one of them has no direction, as the triangles can be shown without."""
    if normals is None:
        return None
    given = np.asarray(normals, np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        unit = given / np.linalg.norm(given, axis=-1, keepdims=True)
    return unit if np.isfinite(unit).all() else None


def displayed(linear: Any) -> NDArray[np.float64]:
    """Return colours of linear light as those of image files (sRGB), which worlds have."""
    light = np.clip(np.asarray(linear, np.float64), 0.0, 1.0)
    curve = 1.055 * light ** (1.0 / 2.4) - 0.055
    colours: NDArray[np.float64] = np.where(light <= 0.0031308, 12.92 * light, curve)
    return colours
