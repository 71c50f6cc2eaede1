"""Shapes of geoms as shapes of a world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from belvedere._world import World
    from belvedere.mujoco._looks import Looks

_Geom = mujoco.mjtGeom


def add_geom(world: World, model: mujoco.MjModel, geom: int, name: str, looks: Looks) -> str | None:
    """Add the shape of a geom as a body of the world.

    Returns:
        None, or the reason why it cannot be added.

    """
    kind = _Geom(int(model.geom_type[geom]))
    size = [float(length) for length in model.geom_size[geom]]
    look: dict[str, Any] = {"name": name, "class_id": geom, "seen_by": looks.seen_by(geom) or "all"}
    if kind == _Geom.mjGEOM_PLANE:
        edges = [2.0 * size[0], 2.0 * size[1]]
        if max(edges) == 0.0:
            world.add_plane(**look | looks.of_plane(geom, edges, edges))
            return None
        # Infinite along one axis: as long as the largest distance that matters.
        far = float(model.vis.map.zfar * model.stat.extent)
        lengths = [edge if edge > 0.0 else 2.0 * far for edge in edges]
        world.add_rectangle(lengths, **look | looks.of_plane(geom, edges, lengths))
        return None
    if kind in (_Geom.mjGEOM_MESH, _Geom.mjGEOM_SDF):
        if model.geom_dataid[geom] < 0:
            return "it has no mesh"
        vertices, faces, uvs, normals = mesh(model, int(model.geom_dataid[geom]))
        shown, uvs = looks.of_vertices(geom, vertices, uvs)
        world.add_mesh(vertices, faces, uvs=uvs, normals=normals, **look, **shown)
        return None
    if kind == _Geom.mjGEOM_HFIELD:
        vertices, faces = height_field(model, int(model.geom_dataid[geom]))
        shown, uvs = looks.of_vertices(geom, vertices, None)
        world.add_mesh(vertices, faces, uvs=uvs, **look, **shown)
        return None
    look |= looks.of(geom)
    if kind == _Geom.mjGEOM_SPHERE:
        world.add_sphere(size[0], **look)
    elif kind == _Geom.mjGEOM_CAPSULE:
        world.add_capsule(size[0], 2.0 * size[1], **look)
    elif kind == _Geom.mjGEOM_ELLIPSOID:
        world.add_ellipsoid(size, **look)
    elif kind == _Geom.mjGEOM_CYLINDER:
        world.add_cylinder(size[0], 2.0 * size[1], **look)
    elif kind == _Geom.mjGEOM_BOX:
        world.add_box([2.0 * half for half in size], **look)
    else:
        return f"geoms of type {kind.name} have no shape"
    return None


def mesh(
    model: mujoco.MjModel, number: int
) -> tuple[NDArray[np.float32], NDArray[np.int32], NDArray[np.float32] | None, NDArray[np.float32]]:
    """Return vertices (V, 3), faces (F, 3), texture coordinates (V, 2) of a mesh, if it has them, and normals (V, 3)."""
    first, count = int(model.mesh_vertadr[number]), int(model.mesh_vertnum[number])
    start, total = int(model.mesh_faceadr[number]), int(model.mesh_facenum[number])
    first_normal, normal_count = int(model.mesh_normaladr[number]), int(model.mesh_normalnum[number])
    texts = int(model.mesh_texcoordadr[number])
    # A vertex has one place, and several normals and texture coordinates; here each combination is a vertex of its own.
    places = [model.mesh_face[start : start + total], model.mesh_facenormal[start : start + total]]
    if texts >= 0:
        places.append(model.mesh_facetexcoord[start : start + total])
    rows = np.stack(places, axis=-1).reshape(-1, len(places))
    unique, corners = np.unique(rows, axis=0, return_inverse=True)
    vertices = model.mesh_vert[first : first + count][unique[:, 0]]
    normals = model.mesh_normal[first_normal : first_normal + normal_count][unique[:, 1]].copy()
    # Triangles without area may have no direction.
    normals[~(np.isfinite(normals).all(axis=1) & normals.any(axis=1))] = (0.0, 0.0, 1.0)
    faces = corners.reshape(-1, 3).astype(np.int32)
    if texts < 0:
        return vertices, faces, None, normals
    uvs = model.mesh_texcoord[texts : texts + int(model.mesh_texcoordnum[number])][unique[:, 2]].copy()
    # Rows of textures are counted from the top, and v upwards.
    uvs[:, 1] = 1.0 - uvs[:, 1]
    return vertices, faces, uvs, normals


def height_field(model: mujoco.MjModel, number: int) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Return a height field with its sides and its base as triangles: vertices (V, 3) and faces (F, 3)."""
    rows, columns = int(model.hfield_nrow[number]), int(model.hfield_ncol[number])
    half_x, half_y, height, base = (float(length) for length in model.hfield_size[number])
    first = int(model.hfield_adr[number])
    tops = model.hfield_data[first : first + rows * columns].reshape(rows, columns) * height
    x, y = np.linspace(-half_x, half_x, columns), np.linspace(-half_y, half_y, rows)
    grid = np.stack([*np.meshgrid(x, y), tops], axis=-1)
    ground = grid.copy()
    ground[..., 2] = -base
    numbers = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, 1:], numbers[1:, :-1]
    # Each cell is divided along the diagonal from its least to its greatest corner.
    faces = [np.stack(corners, axis=-1).reshape(-1, 3) for corners in ((a, b, c), (a, c, d))]
    below = rows * columns
    for edge in (numbers[0], numbers[::-1, 0], numbers[-1, ::-1], numbers[:, -1]):
        low, high = edge[:-1], edge[1:]
        faces += [
            np.stack([low, low + below, high + below], axis=-1),
            np.stack([low, high + below, high], axis=-1),
        ]
    corners = np.array([numbers[0, 0], numbers[-1, 0], numbers[-1, -1], numbers[0, -1]]) + below
    faces.append(corners[[[0, 1, 2], [0, 2, 3]]])
    vertices = np.concatenate([grid.reshape(-1, 3), ground.reshape(-1, 3)])
    return vertices.astype(np.float32), np.concatenate(faces).astype(np.int32)
