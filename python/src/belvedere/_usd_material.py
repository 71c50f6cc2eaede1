"""Materials of OpenUSD: UsdPreviewSurface with colours and textures."""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from belvedere._importer import Importer, displayed
from belvedere._required import required

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Inputs of a surface that are not shown, and the values that have no effect.
_UNSHOWN: dict[str, tuple[Any, str]] = {
    "normal": (None, "normal maps"),
    "occlusion": (None, "occlusion maps"),
    "displacement": (0.0, "displacement"),
    "clearcoat": (0.0, "clear coats"),
}


class Surface(NamedTuple):
    """A material as keywords of shapes."""

    look: dict[str, Any]
    texture: NDArray[np.uint8] | None = None
    #: The primvar of the texture's coordinates.
    uv_name: str = "st"
    #: Their transform, (2, 3).
    uv_transform: NDArray[np.float64] | None = None
    #: Whether the colour is that of the primvar ``displayColor``.
    has_display_color: bool = False

    def placed(self, uvs: NDArray[Any]) -> NDArray[Any]:
        """Return texture coordinates as the texture is placed, (N, 2)."""
        if self.uv_transform is None:
            return uvs
        moved: NDArray[Any] = uvs @ self.uv_transform[:, :2].T + self.uv_transform[:, 2]
        return moved


class Materials:
    """Reads materials, each once."""

    def __init__(self, importer: Importer, time: Any) -> None:
        self._importer, self._time = importer, time
        self._shade = required("pxr.UsdShade", "usd-core", "World.from_usd")
        self._surfaces: dict[str, Surface | None] = {}
        self._pictures: dict[str, NDArray[np.uint8] | None] = {}

    def surface(self, material: Any) -> Surface | None:
        """Return a material; None if shapes are to be shown by their display colour."""
        path = str(material.GetPath())
        if path not in self._surfaces:
            self._surfaces[path] = self._read(material)
        return self._surfaces[path]

    def _read(self, material: Any) -> Surface | None:
        shader = material.ComputeSurfaceSource()[0]
        kind = shader.GetIdAttr().Get() if shader else None
        if kind != "UsdPreviewSurface":
            what = f"of the type {kind}" if kind else "without a UsdPreviewSurface"
            self._importer.note(f"materials {what} are not shown, only the primvar displayColor of their shapes")
            return None
        for name, (harmless, what) in _UNSHOWN.items():
            value, node = self._input(shader, name, harmless)
            if node or (harmless is not None and value != harmless):
                self._importer.note(f"{what} of materials are not shown")
        color, node = self._input(shader, "diffuseColor", (0.18, 0.18, 0.18))
        alpha = self._plain(shader, "opacity", 1.0)
        if alpha < self._plain(shader, "opacityThreshold", 0.0):
            alpha = 0.0
        look: dict[str, Any] = {"roughness": float(np.clip(self._plain(shader, "roughness", 0.5), 0.0, 1.0))}
        look["metalness"] = float(np.clip(self._plain(shader, "metallic", 0.0), 0.0, 1.0))
        if self._plain(shader, "useSpecularWorkflow", 0):
            self._importer.note("specular colours of materials are not shown")
            look["metalness"] = 0.0
        emissive = self._plain(shader, "emissiveColor", (0.0, 0.0, 0.0))
        look["emissive"] = displayed(emissive).tolist()
        look["color"] = [*displayed(color).tolist(), float(np.clip(alpha, 0.0, 1.0))]
        return Surface(look) if node is None else self._textured(Surface(look), node)

    def _textured(self, surface: Surface, node: Any) -> Surface:
        """Add the texture that is the base colour."""
        kind = str(node.GetIdAttr().Get())
        if kind.startswith("UsdPrimvarReader"):
            name, _ = self._input(node, "varname", "")
            if str(name) == "displayColor":
                return surface._replace(has_display_color=True)
        picture = None
        if kind == "UsdUVTexture":
            asset, _ = self._input(node, "file", None)
            picture = None if asset is None else self._picture(asset)
        if picture is None:
            self._importer.note(f"base colours from a {kind} that cannot be read are shown grey")
            surface.look["color"][:3] = [0.7, 0.7, 0.7]
            return surface
        scale, _ = self._input(node, "scale", (1.0, 1.0, 1.0, 1.0))
        bias, _ = self._input(node, "bias", (0.0, 0.0, 0.0, 0.0))
        if any(bias):
            self._importer.note("the bias of textures has no effect")
        surface.look["color"][:3] = displayed(tuple(scale)[:3]).tolist()
        for name in ("wrapS", "wrapT"):
            wrap, _ = self._input(node, name, "useMetadata")
            if str(wrap) in ("clamp", "mirror", "black"):
                self._importer.note(f"textures with {name} = {wrap} are repeated beyond their edges")
        name, transform = self._coordinates(node)
        return surface._replace(texture=picture, uv_name=name, uv_transform=transform)

    def _coordinates(self, node: Any) -> tuple[str, NDArray[np.float64] | None]:
        """Return the primvar of a texture's coordinates, and their transform."""
        transform = None
        _, reader = self._input(node, "st", None)
        if reader is not None and reader.GetIdAttr().Get() == "UsdTransform2d":
            angle = math.radians(self._input(reader, "rotation", 0.0)[0])
            (x, y), (u, v) = (
                self._input(reader, key, (one, one))[0] for key, one in (("scale", 1.0), ("translation", 0.0))
            )
            cos, sin = math.cos(angle), math.sin(angle)
            transform = np.array([[cos * x, -sin * y, u], [sin * x, cos * y, v]])
            _, reader = self._input(reader, "in", None)
        if reader is None:
            return "st", transform
        return str(self._input(reader, "varname", "st")[0]), transform

    def _plain(self, shader: Any, name: str, default: Any) -> Any:
        """Return the value of an input that must be no map."""
        value, node = self._input(shader, name, default)
        if node is not None:
            self._importer.note(f"maps of {name} are not shown")
            return default
        return value

    def _input(self, shader: Any, name: str, default: Any) -> tuple[Any, Any]:
        """Return the value of an input, and the shader that it is connected to, if it is."""
        given = shader.GetInput(name)
        attributes = given.GetValueProducingAttributes() if given else []
        if not attributes:
            return default, None
        if self._shade.Utils.GetType(attributes[0].GetName()) == self._shade.AttributeType.Output:
            return default, self._shade.Shader(attributes[0].GetPrim())
        value = attributes[0].Get(self._time)
        return default if value is None else value, None

    def _picture(self, asset: Any) -> NDArray[np.uint8] | None:
        """Return the pixels of an image, (height, width, 3); None if it cannot be read."""
        path = asset.resolvedPath or asset.path
        if path not in self._pictures:
            self._pictures[path] = self._decoded(path)
        return self._pictures[path]

    def _decoded(self, path: str) -> NDArray[np.uint8] | None:
        image = required("PIL.Image", "Pillow", "World.from_usd, for textures,")
        ar = required("pxr.Ar", "usd-core", "World.from_usd")
        asset = ar.GetResolver().OpenAsset(ar.ResolvedPath(path))
        if not asset:
            self._importer.note(f"there is no texture {path}")
            return None
        try:
            with image.open(io.BytesIO(bytes(asset.GetBuffer()))) as picture:
                if picture.mode.startswith(("I", "F")):
                    self._importer.note(
                        f"texture {path}: images of {picture.mode} are left out; those of 8 bits are shown"
                    )
                    return None
                return np.asarray(picture.convert("RGB"), np.uint8)
        except (OSError, ValueError, SyntaxError, image.DecompressionBombError) as error:
            self._importer.note(f"texture {path} cannot be read: {error}")
            return None
