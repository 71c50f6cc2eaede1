"""Triangle meshes of Open3D as worlds.

They are known by their attributes, so that this module does not import Open3D, which is large.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from belvedere._coloured import coloured_with_normals
from belvedere._importer import Importer, Mesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from belvedere._world import World

#: Images of a material record that are not shown.
_UNSHOWN = {
    "normal_img": "normal maps",
    "ao_img": "occlusion maps",
    "ao_rough_metal_img": "maps of occlusion, roughness and metalness",
    "roughness_img": "roughness maps",
    "metallic_img": "metalness maps",
    "reflectance_img": "reflectance maps",
    "clearcoat_img": "clear coats",
    "anisotropy_img": "anisotropy maps",
}


class _Surface(NamedTuple):
    """A material: keywords without a texture, and the texture."""

    look: dict[str, Any]
    texture: NDArray[np.uint8] | None


class _Geometry(NamedTuple):
    """A mesh in numpy arrays, with colours from 0 to 1; None for what it does not have."""

    vertices: NDArray[Any]
    faces: NDArray[Any]
    #: The coordinates of corners, (F, 3, 2).
    uvs: NDArray[Any] | None
    #: The colours of corners, (F, 3, 3).
    colors: NDArray[Any] | None
    #: The number of the material of each face, (F,).
    materials: NDArray[Any]
    surfaces: Sequence[_Surface]
    #: The normals of vertices, (V, 3).
    normals: NDArray[Any] | None = None


def world_of(given: Any, up: str) -> World:
    """Return the world of a geometry, or of several."""
    importer = Importer(up=up)
    several = given if isinstance(given, Sequence) and not isinstance(given, (str, bytes)) else [given]
    for number, item in enumerate(several):
        name, geometry, material = f"mesh_{number}", item, None
        if isinstance(item, Mapping):
            if "geometry" not in item:
                raise ValueError(f"geometries: number {number} is a dictionary without 'geometry'")
            name, geometry, material = str(item.get("name", name)), item["geometry"], item.get("material")
        _add(importer, name, geometry, material)
    return importer.done()


def _add(importer: Importer, name: str, given: Any, material: Any) -> None:
    if hasattr(given, "meshes") and hasattr(given, "materials"):
        for part in given.meshes:
            _add(importer, f"{name}/{part.mesh_name}", part.mesh, material or given.materials[part.material_idx])
        return
    if hasattr(given, "triangles") and hasattr(given, "vertices"):
        read = _plain(importer, given)
    elif hasattr(given, "triangle") and hasattr(given, "vertex"):
        read = _tensor(importer, given)
    elif type(given).__module__.partition(".")[0] == "open3d":
        importer.note(f"geometries of the type {type(given).__name__} are left out")
        return
    else:
        raise ValueError(f"geometries: {name!r} is a {type(given).__name__}; a mesh of Open3D is expected")
    if material is not None:
        read = read._replace(surfaces=[_record(importer, material)], materials=np.zeros(len(read.faces), np.int64))
    numbers = np.unique(read.materials).tolist()
    for number in numbers or [0]:
        part_name = name if len(numbers) < 2 else f"{name}/{number}"
        make = functools.partial(_mesh, importer, read, read.materials == number, number)
        importer.add(part_name, (name, id(given), number), np.eye(4), make)


def _mesh(importer: Importer, read: _Geometry, chosen: NDArray[np.bool_], number: int) -> Mesh:
    """Return the faces that have a material."""
    faces = read.faces[chosen]
    surface = read.surfaces[number] if 0 <= number < len(read.surfaces) else _Surface({}, None)
    if len(faces) == 0:
        return Mesh(read.vertices, faces, None, {})
    if surface.texture is not None and read.uvs is not None:
        own = read.vertices[faces.reshape(-1)]
        corners = np.arange(len(own)).reshape(-1, 3)
        look = {"color": [1.0, 1.0, 1.0]} | surface.look | {"texture": surface.texture}
        normals = None if read.normals is None else read.normals[faces.reshape(-1)]
        return Mesh(own, corners, read.uvs[chosen].reshape(-1, 2), look, normals)
    if surface.texture is not None:
        importer.note("textures of meshes without texture coordinates are left out")
    if read.colors is not None:
        colors = np.rint(np.clip(read.colors[chosen], 0.0, 1.0) * 255.0).astype(np.uint8)
        vertices, normals, faces, uvs, look = coloured_with_normals(read.vertices, read.normals, faces, colors)
        base = np.ones(4) if "color" not in surface.look else np.array(surface.look["color"])
        look["color"] = [*(base[:3] * look["color"]).tolist(), *base[3:].tolist()]
        return Mesh(vertices, faces, uvs, surface.look | look, normals)
    used, corners = np.unique(faces, return_inverse=True)
    normals = None if read.normals is None else read.normals[used]
    return Mesh(read.vertices[used], corners.reshape(-1, 3), None, surface.look, normals)


def _plain(importer: Importer, mesh: Any) -> _Geometry:
    """Read a ``geometry.TriangleMesh``."""
    faces = np.asarray(mesh.triangles)
    uvs, colors = np.asarray(mesh.triangle_uvs), np.asarray(mesh.vertex_colors)
    numbers = np.asarray(mesh.triangle_material_ids)
    # Their first row is at v = 0.
    textures = [_texels(importer, picture) for picture in mesh.textures]
    surfaces = [_Surface({}, None if texels is None else texels[::-1]) for texels in textures]
    return _Geometry(
        np.asarray(mesh.vertices),
        faces,
        uvs.reshape(-1, 3, 2) if len(uvs) == 3 * len(faces) > 0 else None,
        colors[faces] if len(colors) else None,
        numbers if len(numbers) == len(faces) else np.zeros(len(faces), np.int64),
        surfaces,
        _normals(np.asarray(mesh.vertex_normals), np.asarray(mesh.vertices)),
    )


def _tensor(importer: Importer, mesh: Any) -> _Geometry:
    """Read a ``t.geometry.TriangleMesh``, wherever its arrays are."""
    if hasattr(mesh, "cpu"):
        mesh = mesh.cpu()
    corner, face = _arrays_of(mesh.vertex), _arrays_of(mesh.triangle)
    vertices = corner.get("positions", np.zeros((0, 3), np.float32))
    faces = face.get("indices", np.zeros((0, 3), np.int64))
    uvs = face.get("texture_uvs")
    if uvs is None and "texture_uvs" in corner:
        uvs = corner["texture_uvs"][faces]
    colors = corner["colors"][faces] if "colors" in corner else None
    if "colors" in face:
        colors = np.repeat(face["colors"][:, None], 3, axis=1)
    if colors is not None and colors.dtype == np.uint8:
        colors = colors / 255.0
    surfaces = []
    material = getattr(mesh, "material", None)
    if material is not None and material.is_valid():
        vectors, scalars = dict(material.vector_properties), dict(material.scalar_properties)
        maps = [key for key in material.texture_maps if key != "albedo"]
        for key in maps:
            importer.note(f"{key} maps are not shown")
        look = _look(vectors.get("base_color", np.ones(4)), scalars.get("roughness"), scalars.get("metallic"))
        surfaces = [_Surface(look, _texels(importer, dict(material.texture_maps).get("albedo")))]
    normals = _normals(corner.get("normals"), vertices)
    return _Geometry(vertices, faces, uvs, colors, np.zeros(len(faces), np.int64), surfaces, normals)


def _normals(given: NDArray[Any] | None, vertices: NDArray[Any]) -> NDArray[Any] | None:
    """Return the normals of a mesh that has one for each vertex."""
    return given if given is not None and given.shape == vertices.shape and len(given) else None


def _arrays_of(attributes: Any) -> dict[str, NDArray[Any]]:
    return {str(key): np.asarray(attributes[key].numpy()) for key in attributes}


def _record(importer: Importer, material: Any) -> _Surface:
    """Read a ``visualization.rendering.MaterialRecord``."""
    for attribute, what in _UNSHOWN.items():
        if getattr(material, attribute, None) is not None:
            importer.note(f"{what} are not shown")
    look = _look(material.base_color, material.base_roughness, material.base_metallic)
    look["emissive"] = np.maximum(np.asarray(material.emissive_color, np.float64)[:3], 0.0).tolist()
    return _Surface(look, _texels(importer, material.albedo_img))


def _look(base: Any, roughness: float | None, metalness: float | None) -> dict[str, Any]:
    look: dict[str, Any] = {"color": np.clip(np.asarray(base, np.float64), 0.0, 1.0).tolist()}
    if roughness is not None or metalness is not None:
        look["roughness"] = float(np.clip(1.0 if roughness is None else roughness, 0.0, 1.0))
        look["metalness"] = float(np.clip(0.0 if metalness is None else metalness, 0.0, 1.0))
    return look


def _texels(importer: Importer, picture: Any) -> NDArray[np.uint8] | None:
    """Return the pixels of an image (height, width, 3)."""
    if picture is None:
        return None
    texels = np.asarray(picture.as_tensor().numpy() if hasattr(picture, "as_tensor") else picture)
    if texels.size == 0:
        return None
    if texels.dtype != np.uint8:
        importer.note(f"images of {texels.dtype} are left out; those of uint8 are textures")
        return None
    if texels.ndim == 2:
        texels = texels[..., None]
    return texels[..., :3] if texels.shape[2] >= 3 else np.repeat(texels[..., :1], 3, axis=2)
