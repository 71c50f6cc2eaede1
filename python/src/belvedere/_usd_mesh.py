"""Meshes of OpenUSD as triangles."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from belvedere._coloured import coloured_with_normals
from belvedere._importer import Importer, Mesh, displayed
from belvedere._required import required

if TYPE_CHECKING:
    from collections.abc import Hashable

    from numpy.typing import NDArray

    from belvedere._usd_material import Materials, Surface

#: The colour of shapes without one.
_GREY = [0.7, 0.7, 0.7]


class _Corners(NamedTuple):
    """The triangles of a mesh: numbers of its corners, which its vertices and faces are looked up by."""

    #: (T, 3), among all corners of the mesh, in their order in the file.
    corners: NDArray[np.int64]
    #: The face that each triangle is of, (T,).
    faces: NDArray[np.int64]


class Meshes:
    """Adds the meshes of a stage at a time."""

    def __init__(self, importer: Importer, materials: Materials, time: Any) -> None:
        self._importer, self._materials, self._time = importer, materials, time
        self._geom = required("pxr.UsdGeom", "usd-core", "World.from_usd")
        self._shade = required("pxr.UsdShade", "usd-core", "World.from_usd")

    def add(self, prim: Any, matrix: NDArray[np.float64], name: str) -> None:
        """Add a mesh, or a body for each of its subsets with a material of their own."""
        binding = self._shade.MaterialBindingAPI(prim)
        parts: list[tuple[str, Any, NDArray[np.int64] | None]] = []
        taken: list[NDArray[np.int64]] = []
        for subset in binding.GetMaterialBindSubsets():
            own = np.asarray(subset.GetIndicesAttr().Get(self._time) or [], np.int64)
            parts.append((f"{name}/{subset.GetPrim().GetName()}", subset.GetPrim(), own))
            taken.append(own)
        if taken:
            total = len(self._geom.Mesh(prim).GetFaceVertexCountsAttr().Get(self._time) or [])
            rest = np.setdiff1d(np.arange(total), np.concatenate(taken))
            parts = [*parts, (name, prim, rest)] if len(rest) else parts
        else:
            parts = [(name, prim, None)]
        for part_name, owner, faces in parts:
            surface, material = self._surface(owner)
            key = (_original(prim), part_name.removeprefix(name), material, self._color_key(prim))
            self._importer.add(part_name, key, matrix, functools.partial(self._mesh, prim, faces, surface))

    def look_of_solid(self, prim: Any) -> dict[str, Any]:
        """Return the look of a shape that is no mesh."""
        surface, _ = self._surface(prim)
        if surface is not None and surface.texture is not None:
            self._importer.note("textures of shapes that are no meshes are shown by their mean colour")
            mean = surface.texture.reshape(-1, 3).mean(axis=0) / 255.0
            color = [*(np.array(surface.look["color"][:3]) * mean).tolist(), surface.look["color"][3]]
            return surface.look | {"color": color}
        look = {} if surface is None else dict(surface.look)
        colors, _ = self._primvar(prim, "displayColor")
        if surface is None or surface.has_display_color:
            look["color"] = _GREY if colors is None else displayed(colors.mean(axis=0)).tolist()
            look["color"] = [*look["color"], self._opacity(prim)]
        return look

    def _opacity(self, prim: Any) -> float:
        """Return the mean opacity of a shape that is shown by its display colour."""
        values, _ = self._primvar(prim, "displayOpacity")
        if values is None:
            return 1.0
        if (values != values.flat[0]).any():
            self._importer.note("the primvar displayOpacity is shown by its mean")
        return float(np.clip(values.mean(), 0.0, 1.0))

    def _surface(self, prim: Any) -> tuple[Surface | None, Hashable]:
        material, _ = self._shade.MaterialBindingAPI(prim).ComputeBoundMaterial()
        if not material:
            return None, None
        return self._materials.surface(material), _original(material.GetPrim())

    def _color_key(self, prim: Any) -> Hashable:
        """Return where the colours of a mesh are from: instances of a prototype may inherit their own."""
        api = self._geom.PrimvarsAPI(prim)
        primvars = [api.FindPrimvarWithInheritance(name) for name in ("displayColor", "displayOpacity")]
        return tuple(_original(primvar.GetAttr().GetPrim()) if primvar else None for primvar in primvars)

    def _mesh(self, prim: Any, chosen: NDArray[np.int64] | None, surface: Surface | None) -> Mesh | None:
        mesh = self._geom.Mesh(prim)
        points = np.asarray(mesh.GetPointsAttr().Get(self._time) or [], np.float64).reshape(-1, 3)
        counts = np.asarray(mesh.GetFaceVertexCountsAttr().Get(self._time) or [], np.int64)
        numbers = np.asarray(mesh.GetFaceVertexIndicesAttr().Get(self._time) or [], np.int64)
        name = str(prim.GetPath())
        if counts.size and (counts.min() < 0 or counts.sum() != len(numbers)):
            raise ValueError(
                f"mesh {name!r}: faceVertexCounts sum to {counts.sum()}, and there are {len(numbers)} indices"
            )
        if numbers.size and not 0 <= numbers.min() <= numbers.max() < len(points):
            wrong = numbers.min() if numbers.min() < 0 else numbers.max()
            raise ValueError(f"mesh {name!r}: faceVertexIndices are from 0 to {len(points) - 1}, not {wrong}")
        self._note(prim, mesh)
        keep = np.ones(len(counts), bool)
        if chosen is not None:
            keep[:] = False
            keep[chosen[(chosen >= 0) & (chosen < len(counts))]] = True
        holes = np.asarray(mesh.GetHoleIndicesAttr().Get(self._time) or [], np.int64)
        keep[holes[(holes >= 0) & (holes < len(counts))]] = False
        triangles = self._triangles(points, counts, numbers, keep)
        if len(triangles.corners) == 0:
            return None
        if mesh.GetOrientationAttr().Get(self._time) == self._geom.Tokens.leftHanded:
            triangles = triangles._replace(corners=triangles.corners[:, ::-1])
        return self._dressed(prim, points, numbers, triangles, surface)

    def _dressed(
        self,
        prim: Any,
        points: NDArray[np.float64],
        numbers: NDArray[np.int64],
        triangles: _Corners,
        surface: Surface | None,
    ) -> Mesh:
        """Return triangles with their colours or their texture."""
        faces = numbers[triangles.corners]
        normals = self._normals(prim, numbers, triangles)
        look: dict[str, Any] = {} if surface is None else dict(surface.look)
        if surface is not None and surface.texture is not None:
            uvs = self._at_corners(prim, surface.uv_name, numbers, triangles)
            if uvs is not None and uvs.shape[-1] == 2:
                own = np.arange(faces.size).reshape(-1, 3)
                coordinates = surface.placed(uvs.reshape(-1, 2))
                look |= {"texture": surface.texture}
                return Mesh(points[faces.reshape(-1)], own, coordinates, look, normals)
            self._importer.note("textures of meshes without texture coordinates are left out")
        if normals is not None:
            # A vertex may have several normals, so each corner is a vertex of its own.
            points, faces = points[faces.reshape(-1)], np.arange(faces.size).reshape(-1, 3)
        vertices, used = (points, faces) if normals is not None else _used(points, faces)
        if surface is None or surface.has_display_color:
            colors = self._at_corners(prim, "displayColor", numbers, triangles)
            if colors is not None and colors.shape[-1] == 3:
                corners = np.rint(displayed(colors) * 255.0).astype(np.uint8)
                vertices, normals, used, own_uvs, shown = coloured_with_normals(points, normals, faces, corners)
                shown["color"] = [*shown["color"], self._opacity(prim)]
                return Mesh(vertices, used, own_uvs, look | shown, normals)
            look["color"] = [*_GREY, self._opacity(prim)]
        return Mesh(vertices, used, None, look, normals)

    def _normals(self, prim: Any, numbers: NDArray[np.int64], triangles: _Corners) -> NDArray[Any] | None:
        """Return the normals of the corners of triangles, (3·T, 3); None if the mesh has none, or is subdivided."""
        mesh = self._geom.Mesh(prim)
        if mesh.GetSubdivisionSchemeAttr().Get(self._time) != self._geom.Tokens.none:
            return None
        values, interpolation = self._primvar(prim, "normals")
        if values is None:
            given = mesh.GetNormalsAttr().Get(self._time)
            values = None if given is None else np.asarray(given, np.float64)
            interpolation = str(mesh.GetNormalsInterpolation())
        normals = self._placed("normals", values, interpolation, numbers, triangles)
        return None if normals is None or normals.shape[-1] != 3 else normals.reshape(-1, 3)

    def _at_corners(
        self, prim: Any, primvar: str, numbers: NDArray[np.int64], triangles: _Corners
    ) -> NDArray[Any] | None:
        """Return the values of a primvar at the corners of triangles, (T, 3, …); None without fitting ones."""
        return self._placed(primvar, *self._primvar(prim, primvar), numbers, triangles)

    def _placed(
        self,
        primvar: str,
        values: NDArray[Any] | None,
        interpolation: str,
        numbers: NDArray[np.int64],
        triangles: _Corners,
    ) -> NDArray[Any] | None:
        if values is None or values.ndim != 2 or len(values) == 0:
            return None
        if interpolation == "constant":
            return np.broadcast_to(values[0], (*triangles.corners.shape, values.shape[1]))
        places = {
            "uniform": np.repeat(triangles.faces[:, None], 3, axis=1),
            "faceVarying": triangles.corners,
        }.get(interpolation, numbers[triangles.corners])
        if places.max() >= len(values):
            self._importer.note(f"primvars {primvar} with too few values are left out")
            return None
        at_corners: NDArray[Any] = values[places]
        return at_corners

    def _primvar(self, prim: Any, name: str) -> tuple[NDArray[Any] | None, str]:
        primvar = self._geom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
        values = primvar.ComputeFlattened(self._time) if primvar and primvar.HasValue() else None
        if values is None:
            return None, ""
        given = np.atleast_2d(np.asarray(values, np.float64))
        return (given if given.size else None), str(primvar.GetInterpolation())

    def _triangles(
        self,
        points: NDArray[np.float64],
        counts: NDArray[np.int64],
        numbers: NDArray[np.int64],
        keep: NDArray[np.bool_],
    ) -> _Corners:
        """Divide polygons into fans of triangles, each from a corner that sees all the others."""
        first = np.concatenate([[0], np.cumsum(counts)[:-1]]) if len(counts) else counts
        corners, faces = [np.zeros((0, 3), np.int64)], [np.zeros(0, np.int64)]
        for count in np.unique(counts[keep]).tolist():
            if count < 3:
                continue
            own = np.flatnonzero(keep & (counts == count))
            ring = first[own][:, None] + np.arange(count)
            if count > 3:
                ring, is_whole = _fans(points[numbers], ring)
                if not is_whole.all():
                    self._importer.note(
                        "polygons that no corner sees whole are divided wrongly", int((~is_whole).sum())
                    )
            fan = np.stack([np.repeat(ring[:, :1], count - 2, axis=1), ring[:, 1:-1], ring[:, 2:]], axis=-1)
            corners.append(fan.reshape(-1, 3))
            faces.append(np.repeat(own, count - 2))
        return _Corners(np.concatenate(corners), np.concatenate(faces))

    def _note(self, prim: Any, mesh: Any) -> None:
        if mesh.GetSubdivisionSchemeAttr().Get(self._time) != self._geom.Tokens.none:
            self._importer.note("meshes with a subdivision scheme are shown without subdivision")
        if mesh.GetDoubleSidedAttr().Get(self._time):
            self._importer.note("the insides of double-sided surfaces are not seen by cameras")
        if prim.GetRelationship("skel:skeleton").HasAuthoredTargets() or prim.HasAttribute(
            "primvars:skel:jointIndices"
        ):
            self._importer.note("meshes with a skeleton are shown without their pose")


def _fans(places: NDArray[np.float64], ring: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Turn rings of corners so that the first sees all others, (N, count); and whether it does, (N,)."""
    turned, is_whole = ring.copy(), np.zeros(len(ring), bool)
    around = places[ring]
    normal = np.cross(around - around[:, :1], np.roll(around, -1, axis=1) - around[:, :1]).sum(axis=1)
    # A corner that sees all is among the first for nearly all polygons, and trying each takes quadratic time.
    for start in range(min(ring.shape[1], 16)):
        left = np.flatnonzero(~is_whole)
        if len(left) == 0:
            break
        tried = np.roll(ring[left], -start, axis=1)
        at = places[tried]
        parts = np.cross(at[:, 1:-1] - at[:, :1], at[:, 2:] - at[:, :1])
        sees = (
            np.einsum("nci,ni->nc", parts, normal[left]) >= -1e-9 * (normal[left] ** 2).sum(axis=1)[:, None]
        ).all(axis=1)
        turned[left[sees]] = tried[sees]
        is_whole[left[sees]] = True
    return turned, is_whole


def _used(points: NDArray[np.float64], faces: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return only the points that faces use."""
    used, numbers = np.unique(faces, return_inverse=True)
    return points[used], numbers.reshape(-1, 3)


def _original(prim: Any) -> str:
    """Return the path of a prim, or that of its original in the prototype that it is an instance of."""
    return str((prim.GetPrimInPrototype() if prim.IsInstanceProxy() else prim).GetPath())
