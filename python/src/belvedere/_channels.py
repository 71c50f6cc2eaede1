"""Preparation of the arrays that channels are written into."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
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
    if isinstance(channels, str):
        channels = (channels,)
    if out is not None and not isinstance(out, Mapping):
        raise ValueError(f"out: a dictionary of arrays by channel is expected, not {type(out).__name__}")
    if channels is not None and not isinstance(channels, Iterable):
        raise ValueError(f"channels: names of channels are expected, not {channels!r}")
    given = {} if out is None else dict(out)
    wanted = list(channels if channels is not None else (given or default))
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
            outputs[name] = np.zeros(shape, dtype) if zeros else np.empty(shape, dtype)
    return outputs
