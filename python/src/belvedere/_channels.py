"""Preparation of the arrays that channels are written into."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from belvedere import _arrays

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from belvedere._arrays import ArrayLike

#: Type of each channel, and the shape of its value for one ray.
Channels: TypeAlias = Mapping[str, tuple[np.dtype[Any], tuple[int, ...]]]


def prepare(
    known: Channels,
    default: tuple[str, ...],
    channels: Sequence[str] | None,
    out: Mapping[str, ArrayLike] | None,
    lead: tuple[int, ...],
    frame: tuple[int, ...],
    *,
    zeros: bool = False,
) -> dict[str, NDArray[Any]]:
    """Return the arrays to write into: the caller's, and new ones for the other channels."""
    if out is not None and not isinstance(out, Mapping):
        raise ValueError(f"out: a dictionary of arrays by channel is expected, not {type(out).__name__}")
    given = {} if out is None else dict(out)
    wanted = names_of(channels, tuple(given) or default)
    for name in (*wanted, *given):
        if not isinstance(name, str) or name not in known:
            raise ValueError(f"channels: there is no channel {name!r}; there are {', '.join(known)}")
    for name in given:
        if name not in wanted:
            raise ValueError(f"out[{name!r}]: this channel is not among those requested, {', '.join(wanted)}")
    if not wanted:
        raise ValueError("channels: none is requested; name at least one")
    outputs: dict[str, NDArray[Any]] = {}
    for name in wanted:
        dtype, rest = known[name]
        shape = lead + (frame if name not in ("time", "laser") else frame[:1]) + rest
        if name in given:
            outputs[name] = _arrays.output(f"out[{name!r}]", given[name], shape, dtype)
        else:
            outputs[name] = _new(name, shape, dtype, zeros=zeros)
    return outputs


def names_of(channels: Sequence[str] | None, default: tuple[str, ...]) -> list[str]:
    """Return the names of channels that a caller gave, or the default ones.

    Raises:
        ValueError: they are no names.

    """
    if isinstance(channels, str):
        return [channels]
    if channels is None:
        return list(default)
    try:
        names = list(channels)
    except TypeError as error:
        raise ValueError(f"channels: names of channels are expected, not {channels!r}") from error
    for name in names:
        if not isinstance(name, str):
            raise ValueError(f"channels: names of channels are expected, not {name!r}")
    return names


def _new(name: str, shape: tuple[int, ...], dtype: np.dtype[Any], *, zeros: bool) -> NDArray[Any]:
    try:
        return np.zeros(shape, dtype) if zeros else np.empty(shape, dtype)
    except (MemoryError, ValueError) as error:
        # numpy has another exception for more bytes than addresses.
        raise ValueError(f"channels: there is no memory for {name} of shape {shape}: {error}") from error
