"""Optional packages, which are imported when they are used."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import ModuleType


def required(module: str, package: str, user: str) -> ModuleType:
    """Import a module of an optional package.

    Raises:
        ImportError: it is not installed; the message says how to install it.

    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise ImportError(
            f"{user} needs the package {package}, which cannot be imported: pip install {package} ({error})"
        ) from error
