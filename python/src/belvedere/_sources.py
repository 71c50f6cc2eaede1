"""Arguments that say where worlds and robots are read from, and what was ignored in them."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from belvedere import _arrays

_log = logging.getLogger("belvedere")


def folders(package_path: Sequence[str | os.PathLike[str]] | str | os.PathLike[str]) -> list[str]:
    """Return folders as texts."""
    if isinstance(package_path, (str, os.PathLike)):
        package_path = [package_path]
    if not isinstance(package_path, Iterable):
        raise ValueError(f"package_path: folders are expected, not {package_path!r}")
    return [_arrays.described("package_path", folder) for folder in package_path]


def arguments(xacro: Mapping[str, Any] | None) -> list[tuple[str, str]]:
    """Return arguments of xacro as texts."""
    if xacro is None:
        return []
    if not isinstance(xacro, Mapping):
        raise ValueError(f"xacro: a dictionary of arguments is expected, not {xacro!r}")
    return [(str(name), str(value)) for name, value in xacro.items()]


def report(notes: Sequence[str]) -> None:
    """Log the elements of a description that were ignored."""
    for note in notes:
        _log.warning("%s", note)
