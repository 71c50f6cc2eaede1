"""Stages of OpenUSD for tests, and what usd-core says about them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: A wedge: quadrilaterals and triangles, counter-clockwise seen from outside.
POINTS = [[0, 0, 0], [1, 0, 0], [1, 2, 0], [0, 2, 0], [0, 0, 1], [0, 2, 1]]
RINGS = [[0, 3, 2, 1], [0, 1, 4], [1, 2, 5, 4], [2, 3, 5], [0, 4, 5, 3]]


def stage(up: str = "Z", metres: float = 1.0) -> Any:
    made = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(made, up)
    UsdGeom.SetStageMetersPerUnit(made, metres)
    return made


def mesh(
    on: Any, path: str, points: Any = POINTS, rings: Any = RINGS, matrix: NDArray[np.float64] | None = None
) -> Any:
    made = UsdGeom.Mesh.Define(on, path)
    made.CreatePointsAttr([Gf.Vec3f(*map(float, point)) for point in points])
    made.CreateFaceVertexCountsAttr([len(ring) for ring in rings])
    made.CreateFaceVertexIndicesAttr([number for ring in rings for number in ring])
    made.CreateSubdivisionSchemeAttr("none")
    if matrix is not None:
        UsdGeom.Xformable(made).AddTransformOp().Set(Gf.Matrix4d(*matrix.T.ravel().tolist()))
    return made


def place(prim: Any, matrix: NDArray[np.float64]) -> None:
    UsdGeom.Xformable(prim).AddTransformOp().Set(Gf.Matrix4d(*matrix.T.ravel().tolist()))


def triangles_of(made: Any) -> dict[str, NDArray[np.float64]]:
    """Return the triangles of each visible mesh of a stage in its own axes and units, by usd-core's transforms."""
    found = {}
    cache = UsdGeom.XformCache()
    for prim in Usd.PrimRange(made.GetPseudoRoot(), Usd.TraverseInstanceProxies()):
        if prim.IsA(UsdGeom.Mesh):
            shape = UsdGeom.Mesh(prim)
            matrix = np.array(cache.GetLocalToWorldTransform(prim))
            points = np.array(shape.GetPointsAttr().Get()) @ matrix[:3, :3] + matrix[3, :3]
            corners, first = [], 0
            numbers = list(shape.GetFaceVertexIndicesAttr().Get())
            for count in shape.GetFaceVertexCountsAttr().Get():
                ring = numbers[first : first + count]
                corners += [[ring[0], ring[i], ring[i + 1]] for i in range(1, count - 1)]
                first += count
            found[str(prim.GetPath())] = points[corners]
    return found


def first_hits(
    triangles: NDArray[np.float64], origins: NDArray[np.float64], directions: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return distances and numbers of the first triangles that rays meet, in double precision (Möller and Trumbore)."""
    nearest, numbers = np.full(len(origins), np.inf), np.full(len(origins), -1)
    for number, (a, b, c) in enumerate(triangles):
        side = np.cross(directions, c - a)
        determinant = side @ (b - a)
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = 1.0 / determinant
            u = np.einsum("ij,ij->i", origins - a, side) * inverse
            across = np.cross(origins - a, b - a)
            v = np.einsum("ij,ij->i", directions, across) * inverse
            distance = across @ (c - a) * inverse
        hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (distance > 0) & (distance < nearest)
        nearest[hit], numbers[hit] = distance[hit], number
    return nearest, numbers


def shader(on: Any, path: str, kind: str, **inputs: Any) -> Any:
    types = {float: "Float", tuple: "Color3f", str: "Token", Sdf.AssetPath: "Asset"}
    made = UsdShade.Shader.Define(on, path)
    made.CreateIdAttr(kind)
    for name, value in inputs.items():
        if isinstance(value, UsdShade.Output):
            made.CreateInput(name, Sdf.ValueTypeNames.Float3).ConnectToSource(value)
        else:
            made.CreateInput(name, getattr(Sdf.ValueTypeNames, types[type(value)])).Set(value)
    return made


def material(on: Any, path: str, **inputs: Any) -> Any:
    made = UsdShade.Material.Define(on, path)
    surface = shader(on, f"{path}/surface", "UsdPreviewSurface", **inputs)
    made.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
    return made


def bind(prim: Any, to: Any) -> None:
    UsdShade.MaterialBindingAPI.Apply(prim.GetPrim()).Bind(to)
