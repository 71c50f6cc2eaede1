"""Scenes of trimesh as worlds."""

from __future__ import annotations

import functools
import os
from typing import TYPE_CHECKING, Any

import numpy as np

from belvedere._coloured import coloured_with_normals
from belvedere._importer import Importer, Mesh, displayed
from belvedere._placed_camera import PlacedCamera, pose_of
from belvedere._required import required

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from belvedere._world import World

#: The colour of a material that was given none.
_NO_COLOR = np.array([0.4, 0.4, 0.4, 1.0])
#: Maps of a material with roughness and metalness that are not shown.
_UNSHOWN_MAPS = {
    "emissiveTexture": "emissive maps",
    "normalTexture": "normal maps",
    "occlusionTexture": "occlusion maps",
}


def world_of(given: Any, up: str) -> World:
    """Return the world of a scene, a mesh or a file."""
    trimesh = required("trimesh", "trimesh", "World.from_trimesh")
    if isinstance(given, (str, os.PathLike)):
        try:
            given = trimesh.load_scene(os.fspath(given))
        except Exception as error:
            # Each of trimesh's readers raises exceptions of its own.
            raise ValueError(f"scene: trimesh cannot read {os.fspath(given)!r}: {error}") from error
    if isinstance(given, trimesh.Trimesh):
        given = trimesh.Scene({"mesh": given})
    if not isinstance(given, trimesh.Scene):
        raise ValueError(
            f"scene: a Scene or Trimesh of trimesh, or a path, is expected, not {type(given).__name__}"
        )
    importer = Importer(_metres(trimesh, given), up)
    for node in given.graph.nodes_geometry:
        matrix, name = given.graph[node]
        geometry = given.geometry[name]
        if isinstance(geometry, trimesh.Trimesh):
            importer.add(str(node), name, matrix, functools.partial(_mesh, importer, geometry))
        else:
            importer.note(f"geometries of the type {type(geometry).__name__} are left out")
    if given.has_camera:
        _add_camera(importer, given)
    if vars(given).get("_lights"):
        importer.note("the scene's lights are left out; World.add_light adds some")
    return importer.done()


def _metres(trimesh: Any, scene: Any) -> float:
    if scene.units is None:
        return 1.0
    try:
        return float(trimesh.units.unit_conversion(scene.units, "meters"))
    except (KeyError, ValueError) as error:
        raise ValueError(f"scene: trimesh does not know its unit {scene.units!r}; set scene.units") from error


def _mesh(importer: Importer, geometry: Any) -> Mesh:
    vertices, faces, visual = geometry.vertices, geometry.faces, geometry.visual
    normals = _normals(geometry)
    if len(faces) == 0 or not visual.defined:
        return Mesh(vertices, faces, None, {}, normals)
    if visual.kind == "texture":
        look, image = _look(importer, visual.material)
        uvs = getattr(visual, "uv", None)
        if image is not None and uvs is not None and len(uvs) == len(vertices):
            return Mesh(vertices, faces, uvs, look | {"texture": image}, normals)
        if image is not None:
            importer.note("textures of meshes without texture coordinates are shown by their mean colour")
            mean = image.reshape(-1, 3).mean(axis=0) / 255.0
            look["color"] = [*(np.array(look["color"][:3]) * mean).tolist(), look["color"][3]]
        return Mesh(vertices, faces, None, look, normals)
    if visual.kind == "face":
        corners = np.repeat(np.asarray(visual.face_colors, np.uint8)[:, None], 3, axis=1)
    else:
        corners = np.asarray(visual.vertex_colors, np.uint8)[faces]
    alpha = corners[..., 3]
    if (alpha != alpha[0, 0]).any():
        importer.note("the transparency of single vertices and faces is shown by its mean")
    vertices, normals, faces, uvs, look = coloured_with_normals(vertices, normals, faces, corners[..., :3])
    look["color"].append(float(alpha.mean()) / 255.0)
    return Mesh(vertices, faces, uvs, look, normals)


def _normals(geometry: Any) -> Any:
    """Return the normals of vertices of a file or of the caller; none for a mesh for which trimesh would compute them.

    Computed ones are round at the edges of a box too. As when trimesh writes glTF, those count that the mesh holds.
    """
    held = vars(geometry).get("_cache", ())
    return geometry.vertex_normals if "vertex_normals" in held else None


def _look(importer: Importer, material: Any) -> tuple[dict[str, Any], NDArray[np.uint8] | None]:
    """Return the look of a material without its image, and the image."""
    if hasattr(material, "baseColorFactor"):
        return _physical_look(importer, material)
    if not hasattr(material, "diffuse"):
        importer.note(f"materials of the type {type(material).__name__} are shown grey")
        return {"color": [0.7, 0.7, 0.7, 1.0]}, None
    specular = np.asarray(material.specular, np.float64)[:3] / 255.0
    diffuse = np.asarray(material.diffuse, np.float64) / 255.0
    # A material without a colour has this grey, which would make its image dark.
    if material.image is not None and (diffuse == _NO_COLOR).all():
        diffuse = np.ones(4)
    look = {
        "color": diffuse.tolist(),
        "specular": specular.tolist(),
        "shininess": max(float(material.glossiness or 0.0), 0.0),
    }
    return look, _image(importer, material.image)


def _physical_look(importer: Importer, material: Any) -> tuple[dict[str, Any], NDArray[np.uint8] | None]:
    """Return the look of a material by roughness and metalness, as glTF has them: its factors are linear light."""
    for attribute, what in _UNSHOWN_MAPS.items():
        if getattr(material, attribute) is not None:
            importer.note(f"{what} of materials are not shown")
    factor = material.baseColorFactor
    rgba = np.ones(4) if factor is None else np.asarray(factor, np.float64) / 255.0
    mode = material.alphaMode or "OPAQUE"
    if mode == "MASK":
        importer.note("surfaces whose textures cut holes are shown without the holes")
    shares = []
    maps = _image(importer, material.metallicRoughnessTexture)
    for factor, channel in ((material.roughnessFactor, 1), (material.metallicFactor, 2)):
        mean = 1.0 if maps is None else float(maps[..., channel].mean()) / 255.0
        shares.append(float(np.clip(mean * (1.0 if factor is None else factor), 0.0, 1.0)))
    if maps is not None:
        importer.note("metallic-roughness maps are shown by their mean")
    # The factor of a map that is not shown would make the whole surface emit light.
    has_glow = material.emissiveFactor is not None and material.emissiveTexture is None
    if material.doubleSided:
        importer.note("the insides of double-sided surfaces are not seen by cameras")
    look = {
        "color": [*displayed(rgba[:3]).tolist(), float(rgba[3]) if mode == "BLEND" else 1.0],
        "emissive": displayed(material.emissiveFactor).tolist() if has_glow else [0.0, 0.0, 0.0],
        "roughness": shares[0],
        "metalness": shares[1],
    }
    return look, _image(importer, material.baseColorTexture)


def _image(importer: Importer, image: Any) -> NDArray[np.uint8] | None:
    if image is None:
        return None
    texels: NDArray[np.uint8] = np.asarray(image.convert("RGB"), np.uint8)
    return texels


def _add_camera(importer: Importer, scene: Any) -> None:
    camera = scene.camera
    (fx, fy), (cx, cy) = np.diag(camera.K)[:2], camera.K[:2, 2]
    width, height = (int(pixels) for pixels in camera.resolution)
    importer.cameras[str(camera.name)] = PlacedCamera(
        pose=pose_of(importer.world_from_scene @ scene.camera_transform),
        frustum=(-cx / fx, (width - cx) / fx, -(height - cy) / fy, cy / fy),
        near=max(float(camera.z_near) * importer.metres, 1e-6),
        far=float(camera.z_far) * importer.metres,
        size=(width, height),
    )
