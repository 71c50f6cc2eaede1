"""Materials and textures of a model as keywords of a world's shapes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: The colour of geoms without a colour and a material. A geom of this colour has that of its material.
_GREY = (0.5, 0.5, 0.5, 1.0)
#: Shininess of 1 is this exponent of highlights.
_EXPONENT = 128.0
#: The least exponent: MuJoCo's highlights of shininess 0 are equally bright everywhere, and there are none here at 0.
_LEAST_EXPONENT = 1e-3
#: Specular and shininess of a geom without a material.
_PLAIN = (0.5, 0.5)
#: The linear value of each value of sRGB, both from 0 to 255.
_SRGB = np.arange(256) / 255.0
_LINEAR = np.where(_SRGB <= 0.04045, _SRGB / 12.92, ((_SRGB + 0.055) / 1.055) ** 2.4)
_LINEAR = np.round(_LINEAR * 255.0).astype(np.uint8)
#: More repetitions than this of a texture would be noise.
_MOST_REPEATS = 1e9


class Looks:
    """The materials of a model; ``notes`` has a line for each one that is not shown as MuJoCo shows it."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self._model = model
        self._textures: dict[int, NDArray[np.uint8]] = {}
        #: The body of the world that has a cube texture, for others to share.
        self._bodies: dict[int, int] = {}
        #: The cube texture of the last look.
        self._last = -1
        #: Differences, each once.
        self.notes: dict[str, None] = {}

    def rgba(self, geom: int) -> NDArray[np.float64]:
        """Return the colour of a geom, (4,)."""
        model = self._model
        rgba, material = model.geom_rgba[geom], int(model.geom_matid[geom])
        if material >= 0 and tuple(rgba.tolist()) == _GREY:
            rgba = model.mat_rgba[material]
        colour: NDArray[np.float64] = np.clip(rgba.astype(np.float64), 0.0, 1.0)
        return colour

    def seen_by(self, geom: int) -> str | None:
        """Return the sensors that see a geom, as a keyword of shapes; None if no sensor does.

        Pictures of MuJoCo leave out geoms that are shown with an alpha of 0. Its rays leave out those whose material
        has an alpha of 0, whatever their own colour is, and without a material those whose colour has.
        """
        material = int(self._model.geom_matid[geom])
        is_shown = self.rgba(geom)[3] > 0.0
        colors = self._model.geom_rgba[geom] if material < 0 else self._model.mat_rgba[material]
        is_hit = bool(colors[3] > 0.0)
        if is_shown and is_hit:
            return "all"
        return "visual" if is_shown else "collision" if is_hit else None

    def of(self, geom: int) -> dict[str, Any]:
        """Return the look of a shape without texture coordinates that is not a plane."""
        look, texture, material = self._plain(geom)
        if texture < 0:
            return look
        if not self._is_image(texture):
            return look | self._wrapped(geom, texture, material)
        return self._mean(look, texture, material, "only planes, meshes and height fields have textures of images")

    def of_vertices(
        self, geom: int, vertices: NDArray[np.float32], uvs: NDArray[np.float32] | None
    ) -> tuple[dict[str, Any], NDArray[np.float32] | None]:
        """Return the look of a mesh with these vertices (V, 3), and its texture coordinates (V, 2).

        Args:
            geom: the geom.
            vertices: its vertices.
            uvs: the coordinates that the mesh has.

        """
        look, texture, material = self._plain(geom)
        if texture < 0:
            return look, uvs
        if self._is_image(texture):
            if uvs is not None:
                return look | _painted(self._texels(texture), self._model.mat_texrepeat[material].tolist()), uvs
            return look | _painted(self._texels(texture), [1.0, 1.0]), self._projected(geom, material, vertices)
        if uvs is None:
            return look | self._wrapped(geom, texture, material), None
        return self._mean(look, texture, material, "meshes with coordinates have no cube textures"), uvs

    def _projected(self, geom: int, material: int, vertices: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the texture coordinates that MuJoCo gives to vertices without their own.

        The image lies in the plane of x and y, and its middle in the middle of the geom. It is as large as the geom, or
        two metres with texuniform.
        """
        halves = self._model.geom_size[geom, :2].astype(np.float64)
        if self._model.mat_texuniform[material]:
            halves = np.ones(2)
        per_metre = 0.5 * self._repeat(material) / np.where(halves > 0.0, halves, 1.0)
        return np.asarray(vertices[:, :2] * per_metre + 0.5, np.float32)

    def _mean(self, look: dict[str, Any], texture: int, material: int, why: str) -> dict[str, Any]:
        """Return the look with the mean colour of a texture."""
        self._note(material, f"its texture is shown by its mean colour, since {why}")
        mean = self._texels(texture).mean(axis=(0, 1)) / 255.0
        for light in ("specular", "emissive"):
            look[light] = (np.array(look[light]) * mean).tolist()
        look["color"] = [*(np.array(look["color"][:3]) * mean).tolist(), look["color"][3]]
        return look

    def _is_image(self, texture: int) -> bool:
        return bool(int(self._model.tex_type[texture]) == mujoco.mjtTexture.mjTEXTURE_2D)

    def of_plane(self, geom: int, edges: list[float], lengths: list[float]) -> dict[str, Any]:
        """Return the look of a plane with these edges, of which 0 means infinite, shown with these lengths."""
        look, texture, material = self._plain(geom)
        if texture < 0:
            return look
        if not self._is_image(texture):
            look = self.of(geom)
            # MuJoCo does not stretch planes.
            halves = [length / 2.0 if length > 0.0 else 1.0 for length in lengths]
            look["texture_stretch"] = (np.array(look["texture_stretch"]) * [*halves, 1.0]).tolist()
            return look
        given = self._repeat(material)
        is_uniform = bool(self._model.mat_texuniform[material])
        texels, repeat = self._texels(texture), given.tolist()
        for axis, (edge, length) in enumerate(zip(edges, lengths, strict=True)):
            if edge > 0.0:
                # MuJoCo counts repetitions over two metres, or over the whole plane, from its left and its upper edge.
                repeat[axis] *= edge / 2.0 if is_uniform else 1.0
                shift = 0.0 if axis == 0 else repeat[axis]
            else:
                # It counts them over two metres, and the middle of the texture is in the middle.
                repeat[axis] *= length / 2.0 if length > 0.0 else 0.5
                shift = 0.5 + (repeat[axis] / 2.0 if length > 0.0 else 0.0)
            turned = round(shift * texels.shape[1 - axis])
            texels = np.roll(texels, turned if axis == 0 else -turned, axis=1 - axis)
        return look | _painted(texels, repeat)

    def added(self, body: int) -> None:
        """Take the number of the body that was added with the last look."""
        if self._last >= 0:
            self._bodies.setdefault(self._last, body)
        self._last = -1

    def sky(self) -> NDArray[np.uint8] | None:
        """Return the faces of the sky, (6, size, size, 3), if there is one."""
        skies = np.flatnonzero(self._model.tex_type == mujoco.mjtTexture.mjTEXTURE_SKYBOX)
        # MuJoCo shows the first one.
        return self.cube(int(skies[0])) if len(skies) else None

    def cube(self, texture: int) -> NDArray[np.uint8] | None:
        """Return the faces of a cube texture, (6, size, size, 3), or None if it has no pixels."""
        texels = self._texels(texture)
        height, width, _ = texels.shape
        if 0 in (height, width):
            return None
        # One face stands for all.
        return np.repeat(texels[None], 6, axis=0) if height == width else texels.reshape(6, width, width, 3)

    def _wrapped(self, geom: int, texture: int, material: int) -> dict[str, Any]:
        """Return the cube texture of a look."""
        kind, size = int(self._model.geom_type[geom]), self._model.geom_size[geom].astype(np.float64)
        if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
            size = size[[0, 0, 0]]
        elif kind in (mujoco.mjtGeom.mjGEOM_CAPSULE, mujoco.mjtGeom.mjGEOM_CYLINDER):
            size = size[[0, 0, 1]]
        # MuJoCo multiplies points on a shape of size 1, and those of meshes, by the size.
        stretch = size if self._model.mat_texuniform[material] else np.ones(3)
        self._last = texture
        shared = self._bodies.get(texture)
        texels = self.cube(texture) if shared is None else shared
        return {"texture": texels, "texture_stretch": stretch.tolist(), "texture_mode": "light"}

    def _plain(self, geom: int) -> tuple[dict[str, Any], int, int]:
        """Return the look of a geom without its texture, the texture, and the material; -1 for none."""
        self._last = -1
        model, material = self._model, int(self._model.geom_matid[geom])
        color = self.rgba(geom)
        specular, shininess = _PLAIN
        emission, texture = 0.0, -1
        if material >= 0:
            specular, shininess = self._number("specular", material), self._number("shininess", material)
            emission = self._number("emission", material)
            roles = model.mat_texid[material]
            textures = [
                int(roles[role])
                for role in (mujoco.mjtTextureRole.mjTEXROLE_RGB, mujoco.mjtTextureRole.mjTEXROLE_RGBA)
            ]
            texture = max(textures)
            if texture >= 0 and 0 in (model.tex_height[texture], model.tex_width[texture]):
                self._note(material, "its texture has no pixels")
                texture = -1
            if float(model.mat_reflectance[material]) > 0.0:
                self._note(material, "it does not reflect other shapes")
        alpha = float(color[3])
        if int(model.geom_type[geom]) != mujoco.mjtGeom.mjGEOM_PLANE:
            # MuJoCo draws the far side of a transparent shape, too; here only the near side is seen.
            alpha = 1.0 - (1.0 - alpha) ** 2
        look: dict[str, Any] = {
            "color": [*color[:3].tolist(), alpha],
            "specular": [max(specular, 0.0)] * 3,
            "shininess": max(shininess * _EXPONENT, _LEAST_EXPONENT),
            "emissive": (color[:3] * max(emission, 0.0)).tolist(),
        }
        return look, texture, material

    def _repeat(self, material: int) -> NDArray[np.float64]:
        """Return how often an image is repeated along both axes, (2,)."""
        given: NDArray[np.float64] = self._model.mat_texrepeat[material].astype(np.float64)
        if not (np.abs(given) < _MOST_REPEATS).all():
            raise ValueError(
                f"texrepeat of its material: numbers below {_MOST_REPEATS:g} are expected, not {given}"
            )
        return given

    def _number(self, name: str, material: int) -> float:
        value = float(getattr(self._model, f"mat_{name}")[material])
        if not math.isfinite(value):
            raise ValueError(f"{name} of its material: a finite number is expected, not {value}")
        return value

    def _texels(self, texture: int) -> NDArray[np.uint8]:
        """Return the pixels of a texture, (height, width, 3); those of a cube are the six sides, one below the other."""
        if texture not in self._textures:
            model = self._model
            height, width = int(model.tex_height[texture]), int(model.tex_width[texture])
            count, first = int(model.tex_nchannel[texture]), int(model.tex_adr[texture])
            pixels = model.tex_data[first : first + height * width * count].reshape(height, width, count)
            colours = pixels[..., :3] if count >= 3 else np.repeat(pixels[..., :1], 3, axis=-1)
            if self._is_srgb(texture):
                colours = _LINEAR[colours]
            self._textures[texture] = np.ascontiguousarray(colours)
        return self._textures[texture]

    def _is_srgb(self, texture: int) -> bool:
        """Return whether MuJoCo shows the linear values of a texture: only of images that say that they are sRGB."""
        spaces = getattr(self._model, "tex_colorspace", None)
        if spaces is None or not self._is_image(texture):
            return False
        return bool(int(spaces[texture]) == mujoco.mjtColorSpace.mjCOLORSPACE_SRGB)

    def _note(self, material: int, difference: str) -> None:
        name = mujoco.mj_id2name(self._model, mujoco.mjtObj.mjOBJ_MATERIAL, material) or f"number {material}"
        self.notes[f"material {name}: {difference}"] = None


def _painted(texels: NDArray[np.uint8], repeat: list[float]) -> dict[str, Any]:
    """Return the texture of a look. MuJoCo multiplies all light by it, with highlights and emitted light."""
    return {"texture": texels, "texture_repeat": repeat, "texture_mode": "light"}
