"""Conversion of arguments to arrays for the native module, with errors that name the argument."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from belvedere import _native

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Anything that numpy converts to an array: arrays, sequences, and arrays of other libraries by ``__dlpack__`` or
#: ``__array__``.
ArrayLike: TypeAlias = Any
#: Poses of bodies by name or number, each (…, 7) or (…, 4, 4); or of all bodies, (…, bodies, 7).
Bodies: TypeAlias = Mapping[str | int, ArrayLike] | ArrayLike


def array(argument: str, value: ArrayLike, dtype: type[np.generic]) -> NDArray[Any]:
    """Return the value as a contiguous array of this type; a copy only if necessary.

    Raises:
        ValueError: it is not an array of numbers.

    """
    if type(value) is np.ndarray and value.ndim and value.dtype == dtype and value.flags.c_contiguous:
        # Nothing to convert, which the steps below find out in ten times as long.
        return value
    try:
        if not isinstance(value, np.ndarray) and hasattr(value, "__dlpack__"):
            value = np.from_dlpack(value)
        converted = np.asarray(value)
        if converted.dtype.kind not in "biuf":
            raise TypeError(f"its elements are {converted.dtype}")
        if np.issubdtype(dtype, np.integer) and converted.size and converted.dtype.kind == "f":
            raise TypeError(f"its elements are {converted.dtype}, and whole numbers are expected")
        if np.issubdtype(dtype, np.unsignedinteger) and converted.size and converted.min() < 0:
            raise TypeError(f"{converted.min()} is among them, and numbers from 0 are expected")
        if converted.dtype == dtype:
            return np.ascontiguousarray(converted)
        with np.errstate(over="ignore", invalid="ignore"):
            return np.ascontiguousarray(converted, dtype)
    except (TypeError, ValueError, BufferError, RuntimeError, OverflowError, MemoryError) as error:
        raise ValueError(f"{argument}: an array of {np.dtype(dtype)} is expected: {error}") from error


def vectors(argument: str, value: ArrayLike, size: int, dtype: type[np.generic] = np.float32) -> NDArray[Any]:
    """Return an array whose last axis has this many numbers."""
    converted = array(argument, value, dtype)
    if converted.ndim == 0 or converted.shape[-1] != size:
        raise ValueError(f"{argument}: shape {converted.shape}; (…, {size}) is expected")
    return converted


def numbers(
    argument: str, value: ArrayLike, size: int, least: float = -math.inf, most: float = math.inf
) -> list[float]:
    """Return a short row of finite numbers within limits."""
    converted = array(argument, value, np.float64)
    if converted.shape != (size,):
        raise ValueError(f"{argument}: shape {converted.shape}; ({size},) is expected")
    row: list[float] = converted.tolist()
    if not all(map(math.isfinite, row)):
        raise ValueError(f"{argument}: finite numbers are expected, not {row}")
    if not least <= min(row) <= max(row) <= most:
        raise ValueError(f"{argument}: numbers{_limits(least, most)} are expected, not {row}")
    return row


def number(argument: str, value: float, least: float = -math.inf, most: float = math.inf) -> float:
    """Return a number within limits, and not NaN."""
    try:
        if isinstance(value, (str, bytes)):
            raise TypeError(f"it is the text {value!r}")
        shape = np.shape(value) if hasattr(value, "shape") or isinstance(value, (list, tuple)) else ()
        if math.prod(shape) != 1:
            raise TypeError(f"it is an array of shape {tuple(shape)}")
        converted = float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{argument}: a number is expected: {error}") from error
    if math.isnan(converted):
        raise ValueError(f"{argument}: a number is expected, not NaN")
    if not least <= converted <= most:
        raise ValueError(f"{argument}: a number{_limits(least, most)} is expected, not {converted}")
    return converted


def _limits(least: float, most: float) -> str:
    return f" of {least:g} or more" if most == math.inf else f" from {least:g} to {most:g}"


def text(argument: str, value: str) -> str:
    """Check that the value is a text, and return it."""
    if not isinstance(value, str):
        raise ValueError(f"{argument}: a text is expected, not {value!r}")
    return value


def texts(argument: str, value: Sequence[str]) -> list[str]:
    """Check that the value is a sequence of texts, and return a copy."""
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise ValueError(f"{argument}: a list of texts is expected, not {value!r}")
    return [text(f"{argument}[{number}]", each) for number, each in enumerate(value)]


def described(argument: str, value: str | os.PathLike[str]) -> str:
    """Return a file name or path as text, or the text itself."""
    given = os.fspath(value) if isinstance(value, os.PathLike) else value
    if not isinstance(given, str):
        raise ValueError(f"{argument}: a name, a path or a text is expected, not {value!r}")
    return given


def count(argument: str, value: int, least: int = 1, most: int = 2**31 - 1) -> int:
    """Return a whole number within limits."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not least <= value <= most:
        raise ValueError(f"{argument}: a whole number from {least} to {most} is expected, not {value!r}")
    return int(value)


def choice(argument: str, value: str, choices: Mapping[str, int]) -> int:
    """Return the value of a word among choices."""
    if not isinstance(value, str) or value not in choices:
        raise ValueError(f"{argument}: one of {', '.join(choices)} is expected, not {value!r}")
    return choices[value]


class Poses(NamedTuple):
    """Poses of any leading shape."""

    #: (N, 7)
    flat: NDArray[np.float64]
    #: The axes before the last ones; their product is N.
    lead: tuple[int, ...]


def poses(argument: str, value: ArrayLike, names: Sequence[str] = ()) -> Poses:
    """Return poses given as (…, 7) or (…, 4, 4); with names, (…, bodies, 7) of the named bodies."""
    given = array(argument, value, np.float64)
    if given.ndim >= 2 and given.shape[-2:] == (4, 4):
        lead, kind = given.shape[:-2], "matrix"
        flat, bad = _native.poses_of_matrices(given.reshape(-1, 4, 4))
    elif given.ndim >= 1 and given.shape[-1] == 7:
        lead, kind = given.shape[:-1], "pose"
        flat, bad = given, _native.bad_pose(given)
    else:
        raise ValueError(
            f"{argument}: shape {given.shape}; (…, 7), x y z qx qy qz qw, or (…, 4, 4), matrices, is expected"
        )
    if bad is not None:
        index, why = bad
        place = [int(part) for part in np.unravel_index(index, lead)]
        shown = f"{kind} {place if len(place) > 1 else index}"
        if names and lead and len(names) == lead[-1]:
            shown += f", of body {names[place[-1]]!r},"
        raise ValueError(
            f"{argument}: {shown} {why}: {given.reshape(-1, *given.shape[len(lead) :])[index].tolist()}"
        )
    return Poses(flat.reshape(math.prod(lead), 7), lead)


def one_pose(argument: str, value: ArrayLike | None) -> NDArray[np.float64]:
    """Return a single pose (7,): the identity for None, and without rotation for a place (3,)."""
    if value is None:
        return np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    given = array(argument, value, np.float64)
    if given.shape == (3,):
        return np.concatenate([given, [0.0, 0.0, 0.0, 1.0]])
    flat, lead = poses(argument, given)
    if lead != ():
        raise ValueError(f"{argument}: shape {given.shape}; a single pose (7,), (4, 4) or place (3,) is expected")
    return np.ascontiguousarray(flat[0])


def bodies(
    argument: str, value: Bodies | None, lead: tuple[int, ...], names: Sequence[str]
) -> tuple[list[int], NDArray[np.float64] | None]:
    """Return the numbers of the moved bodies, and their poses (N, bodies, 7)."""
    if value is None:
        return [], None
    if not isinstance(value, Mapping):
        flat, shape = poses(argument, value, names)
        if shape != (*lead, len(names)):
            raise ValueError(
                f"{argument}: poses of shape {shape}; {(*lead, len(names))} is expected: "
                f"one for each frame and each of the world's {len(names)} bodies; or give a dictionary of some"
            )
        return list(range(len(names))), flat
    moved: list[int] = []
    parts: list[NDArray[np.float64]] = []
    for body, given in value.items():
        moved.append(body_number(argument, body, names))
        named = f"{argument}[{body!r}]"
        flat, shape = poses(named, given)
        try:
            parts.append(np.broadcast_to(flat.reshape(*shape, 7), (*lead, 7)).reshape(-1, 7))
        except ValueError as error:
            raise ValueError(f"{named}: poses of shape {shape}; {lead} is expected, one for each frame") from error
    if len(set(moved)) != len(moved):
        raise ValueError(f"{argument}: a body is named twice")
    if not moved:
        return [], None
    return moved, np.ascontiguousarray(np.stack(parts, axis=1))


def body_number(argument: str, body: str | int, names: Sequence[str]) -> int:
    """Return the number of a body by its name or number."""
    if isinstance(body, str):
        if body not in names:
            shown = ", ".join(names[:8]) + (", …" if len(names) > 8 else "")
            raise ValueError(f"{argument}: there is no body {body!r}; there are {shown or 'none'}")
        return names.index(body)
    if isinstance(body, bool) or not isinstance(body, (int, np.integer)) or not 0 <= body < len(names):
        raise ValueError(f"{argument}: there is no body {body!r}; there are {len(names)}, counted from 0")
    return int(body)


def seeds(argument: str, value: ArrayLike | int, lead: tuple[int, ...]) -> list[int]:
    """Return a seed for each frame: the given ones, or consecutive ones from a given first."""
    total = math.prod(lead)
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool):
        first = _whole_of_64_bits(argument, value)
        return [first] if total == 1 else [(first + index) % 2**64 for index in range(total)]
    try:
        given = np.asarray(value)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{argument}: whole numbers are expected: {error}") from error
    if given.shape != lead or given.dtype.kind not in "iu" or (given.size and int(given.min()) < 0):
        raise ValueError(
            f"{argument}: shape {given.shape} of {given.dtype}; one number is expected, "
            f"or {lead} whole numbers, 0 or more"
        )
    numbers: list[int] = given.ravel().tolist()
    return numbers


def numbers_of_frames(value: ArrayLike | int, lead: tuple[int, ...]) -> list[int]:
    """Return the number of each frame: the given ones, or one for all."""
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool):
        return [_whole_of_64_bits("frames", value)] * math.prod(lead)
    return seeds("frames", value, lead)


def _whole_of_64_bits(argument: str, value: int | np.integer[Any]) -> int:
    """Return a whole number from 0 to 2**64 - 1: a seed, or the number of a frame."""
    if not 0 <= value < 2**64:
        raise ValueError(f"{argument}: a whole number from 0 to 2**64 - 1 is expected, not {value}")
    return int(value)


def threads(value: int | None) -> int:
    """Return the number of threads; 0 for one per processor."""
    return 0 if value is None else count("threads", value, 1, 1024)


def output(argument: str, value: ArrayLike, shape: tuple[int, ...], dtype: np.dtype[Any]) -> NDArray[Any]:
    """Return the caller's memory as an array to write in place."""
    if isinstance(value, np.ndarray):
        given: NDArray[Any] = value
    else:
        try:
            given = _foreign_output(value)
        except (TypeError, AttributeError, ValueError, BufferError, RuntimeError) as error:
            raise ValueError(
                f"{argument}: an array of numpy, or another in main memory with __dlpack__, is expected: {error}"
            ) from error
    if given.shape != shape or given.dtype != dtype:
        raise ValueError(f"{argument}: shape {given.shape} of {given.dtype}; {shape} of {dtype} is expected")
    if not given.flags.writeable:
        raise ValueError(f"{argument}: it is read-only; memory that can be written to is expected")
    if not given.flags.c_contiguous:
        raise ValueError(f"{argument}: strides {given.strides}; rows without gaps (C-contiguous) are expected")
    if not given.flags.aligned:
        raise ValueError(f"{argument}: it is not aligned to its elements")
    return given


def _foreign_output(value: ArrayLike) -> NDArray[Any]:
    """Return another library's memory as an array, writeable if that library permits it.

    Before 2.2, numpy treated all memory from DLPack as read-only. The library's own view of the same memory for
    numpy shows whether it is writeable. A copy, which some libraries return, would lose what is written.
    """
    given: NDArray[Any] = np.from_dlpack(value)
    if not given.flags.writeable and hasattr(value, "__array__"):
        view = np.asarray(value)
        if view.__array_interface__["data"][0] == given.__array_interface__["data"][0]:
            return view
    return given
