"""Appearance of bodies, converted for the native module."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from belvedere import _arrays, _native

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from belvedere._arrays import ArrayLike

#: Bits of the sensors that see a body.
SEES = {"visual": 1, "collision": 2, "all": 3}


#: Whether a texture is multiplied by all light, instead of by the reflectance alone.
TEXTURE_MODES = {"reflectance": False, "light": True}


def round_size(radius: float, length: float) -> list[float]:
    return [_arrays.number("radius", radius), _arrays.number("length", length)]


def table(argument: str, value: ArrayLike, columns: int, dtype: type[np.generic]) -> NDArray[Any]:
    converted = _arrays.array(argument, value, dtype)
    if converted.ndim != 2 or converted.shape[1] != columns:
        raise ValueError(f"{argument}: shape {converted.shape}; (N, {columns}) is expected")
    return converted


def look_of(pose: ArrayLike | None, look: dict[str, Any]) -> tuple[_native._Look, _native._Said]:
    """Convert the arguments that describe a body for the native module."""
    rest = dict(look)
    color = rgba(rest.pop("color", (0.7, 0.7, 0.7)))
    texture = rest.pop("texture", None)
    pbr = _pbr(rest.pop("roughness", None), rest.pop("metalness", None))
    by_light = bool(_arrays.choice("texture_mode", rest.pop("texture_mode", "reflectance"), TEXTURE_MODES))
    if by_light and pbr is not None:
        raise ValueError("texture_mode: light is for surfaces without roughness and metalness")
    appearance = (
        color,
        _arrays.numbers("emissive", rest.pop("emissive", (0.0, 0.0, 0.0)), 3, 0.0),
        _arrays.numbers("specular", rest.pop("specular", (0.0, 0.0, 0.0)), 3, 0.0),
        _arrays.number("shininess", rest.pop("shininess", 0.0)),
        pbr,
        None if texture is None else _texture(texture),
        _arrays.numbers("texture_repeat", rest.pop("texture_repeat", (1.0, 1.0)), 2, 1e-12),
        by_light,
        _arrays.numbers("texture_stretch", rest.pop("texture_stretch", (1.0, 1.0, 1.0)), 3),
    )
    said = (
        _arrays.text("name", rest.pop("name", "")),
        _arrays.one_pose("pose", pose),
        _arrays.numbers("scale", rest.pop("scale", (1.0, 1.0, 1.0)), 3),
        _arrays.count("class_id", rest.pop("class_id", 0), 0, 2**32 - 1),
        _arrays.numbers("laser_retro", [rest.pop("laser_retro", 0.0)], 1, 0.0)[0],
        _arrays.choice("seen_by", rest.pop("seen_by", "all"), SEES),
    )
    if rest:
        raise TypeError(f"there is no argument {next(iter(rest))!r}")
    return appearance, said


def rgba(given: ArrayLike) -> list[float]:
    """Return red, green, blue and alpha."""
    color = _arrays.array("color", given, np.float64).tolist()
    if not isinstance(color, list) or len(color) not in (3, 4):
        raise ValueError(f"color: (red, green, blue) or (red, green, blue, alpha) is expected, not {color}")
    return [*_arrays.numbers("color", color, len(color), 0.0, 1.0), 1.0][:4]


def _pbr(roughness: float | None, metalness: float | None) -> list[float] | None:
    if roughness is None and metalness is None:
        return None
    return [
        _arrays.number("roughness", 1.0 if roughness is None else roughness, 0.0, 1.0),
        _arrays.number("metalness", 0.0 if metalness is None else metalness, 0.0, 1.0),
    ]


def cube(argument: str, faces: ArrayLike) -> tuple[NDArray[np.uint8], int]:
    """Return the six faces of a cube with alpha, and their size."""
    expected = "(6, size, size, 3 or 4) of uint8, the faces +x, -x, +y, -y, +z and -z of a cube, is expected"
    try:
        texels = np.asarray(faces)
    except ValueError as error:
        raise ValueError(f"{argument}: arrays of several shapes; {expected}") from error
    shape = texels.shape
    is_cube = len(shape) == 4 and shape[0] == 6 and shape[1] == shape[2] > 0 and shape[3] in (3, 4)
    if not is_cube or texels.dtype != np.uint8:
        raise ValueError(f"{argument}: shape {shape} of {texels.dtype}; {expected}")
    return _with_alpha(texels), int(shape[1])


def _texture(value: ArrayLike | int) -> tuple[NDArray[np.uint8], int, bool] | int:
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool):
        return _arrays.count("texture", int(value), 0)
    texels = np.asarray(value)
    if texels.ndim == 4:
        return *cube("texture", texels), True
    if texels.ndim != 3 or texels.shape[2] not in (3, 4) or texels.dtype != np.uint8 or 0 in texels.shape:
        raise ValueError(
            f"texture: shape {texels.shape} of {texels.dtype}; (height, width, 3 or 4) of uint8 is expected"
        )
    return _with_alpha(texels), int(texels.shape[1]), False


def _with_alpha(texels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    if texels.shape[-1] == 3:
        opaque = np.full((*texels.shape[:-1], 1), 255, np.uint8)
        texels = np.concatenate([texels, opaque], axis=-1)
    return np.ascontiguousarray(texels)
