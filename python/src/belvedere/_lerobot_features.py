"""Features of data sets of LeRobot, and their statistics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from belvedere import _arrays

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from belvedere._arrays import ArrayLike

_QUANTILES = (0.01, 0.10, 0.50, 0.90, 0.99)
#: Names of a data set's own columns.
_TAKEN = ("timestamp", "frame_index", "episode_index", "index", "task_index", "task")


@dataclass(frozen=True)
class Feature:
    """A column of frames."""

    #: ``image``, or a type of numpy.
    dtype: str
    #: The shape in a frame.
    shape: tuple[int, ...]
    names: tuple[str, ...] | None

    @property
    def arrow(self) -> str:
        """The type of Arrow."""
        return "bool_" if self.dtype == "bool" else self.dtype

    def described(self) -> dict[str, Any]:
        """Return what ``info.json`` has."""
        return {"dtype": self.dtype, "shape": list(self.shape), "names": list(self.names) if self.names else None}


def features_of(
    arrays: Mapping[str, ArrayLike], names: Mapping[str, list[str]]
) -> tuple[dict[str, Feature], dict[str, NDArray[Any]]]:
    """Return the features of an episode, and its arrays as they are stored.

    Raises:
        ValueError: an array has another shape or type than LeRobot has, or another length than the others.

    """
    if not isinstance(arrays, Mapping) or not arrays:
        raise ValueError(f"arrays: a dictionary of arrays by the name of their feature is expected, not {arrays!r}")
    features, columns = {}, {}
    count: int | None = None
    for key, value in arrays.items():
        if not isinstance(key, str) or not key or "/" in key or key in _TAKEN:
            raise ValueError(
                f"arrays: {key!r} is no name of a feature; one such as 'observation.state' is expected"
            )
        argument = f"arrays[{key!r}]"
        given = np.asarray(value)
        if given.dtype.kind not in "biuf":
            raise ValueError(f"{argument}: its elements are {given.dtype}, and numbers are expected")
        if given.ndim == 1:
            given = given[:, None]
        if given.ndim == 4 and given.dtype == np.uint8 and given.shape[-1] == 3 and 0 not in given.shape:
            features[key] = Feature("image", given.shape[1:], ("height", "width", "channels"))
        elif given.ndim == 2 and 0 not in given.shape:
            given = _stored(argument, given)
            own = names.get(key)
            if own is not None and len(own) != given.shape[1]:
                raise ValueError(f"names[{key!r}]: {len(own)} names for {given.shape[1]} numbers")
            features[key] = Feature(str(given.dtype), given.shape[1:], None if own is None else tuple(own))
        else:
            raise ValueError(
                f"{argument}: shape {given.shape} of {given.dtype}; images (T, height, width, 3) of uint8, or rows "
                "(T, numbers) are expected, one frame at least"
            )
        if count is not None and len(given) != count:
            raise ValueError(f"{argument}: {len(given)} frames; {count}, as the other arrays have, are expected")
        count, columns[key] = len(given), np.ascontiguousarray(given)
    for key in names:
        if key not in features or features[key].dtype == "image":
            raise ValueError(f"names: {key!r} is no feature with numbers; there are {list(features)}")
    return features, columns


def _stored(argument: str, given: NDArray[Any]) -> NDArray[Any]:
    """Return rows of numbers in the type in which they are stored."""
    if given.dtype.kind == "b":
        return given
    if given.dtype.kind in "iu":
        return _arrays.array(argument, given, np.int64)
    stored = _arrays.array(argument, given, np.float32)
    if not np.isfinite(stored).all():
        raise ValueError(f"{argument}: finite numbers are expected, within single precision")
    return stored


class Statistics:
    """Least, greatest, mean, deviation and quantiles of a feature: exact, also of several episodes together."""

    def __init__(self, values: NDArray[Any], *, is_image: bool) -> None:
        self._is_image = is_image
        self._frames = len(values)
        #: The values, or for images the number of pixels of each colour and channel, (3, 256).
        self._parts: list[NDArray[Any]] = [values.reshape(len(values), -1)]
        if is_image:
            channels = values.reshape(-1, 3)
            self._parts = [np.stack([np.bincount(channels[:, channel], minlength=256) for channel in range(3)])]

    def add(self, other: Statistics) -> None:
        """Include the values of another."""
        self._frames += other._frames
        if self._is_image:
            self._parts = [self._parts[0] + other._parts[0]]
        else:
            self._parts.extend(other._parts)

    def as_lists(self) -> dict[str, Any]:
        """Return them in LeRobot's names; those of images as (3, 1, 1), from 0 to 1."""
        if self._is_image:
            made = {name: (value / 255.0).reshape(3, 1, 1) for name, value in self._of_pixels().items()}
        else:
            values = np.concatenate(self._parts).astype(np.float64)
            made = {"min": values.min(axis=0), "max": values.max(axis=0), "mean": values.mean(axis=0)}
            made |= {"std": values.std(axis=0)}
            for share, value in zip(_QUANTILES, np.quantile(values, _QUANTILES, axis=0), strict=True):
                made[_name(share)] = value
        return {name: value.tolist() for name, value in made.items()} | {"count": [self._frames]}

    def _of_pixels(self) -> dict[str, NDArray[np.float64]]:
        counts, levels = self._parts[0].astype(np.float64), np.arange(256.0)
        total = counts.sum(axis=1)
        mean = counts @ levels / total
        variance = counts @ levels**2 / total - mean**2
        made = {
            "min": (counts > 0).argmax(axis=1).astype(np.float64),
            "max": 255.0 - (counts[:, ::-1] > 0).argmax(axis=1),
            "mean": mean,
            "std": np.sqrt(np.maximum(variance, 0.0)),
        }
        below = counts.cumsum(axis=1)
        for share in _QUANTILES:
            made[_name(share)] = (below >= share * total[:, None]).argmax(axis=1).astype(np.float64)
        return made


def _name(share: float) -> str:
    return f"q{round(share * 100):02d}"
