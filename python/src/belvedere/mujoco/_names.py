"""Objects of a model by name or number."""

from __future__ import annotations

import mujoco
import numpy as np


def number_of(model: mujoco.MjModel, kind: mujoco.mjtObj, argument: str, given: str | int, count: int) -> int:
    """Return the number of an object.

    Raises:
        ValueError: there is no such object.

    """
    if isinstance(given, str):
        number = int(mujoco.mj_name2id(model, kind, given))
        if number >= 0:
            return number
        names = [mujoco.mj_id2name(model, kind, index) for index in range(count)]
        known = [name for name in names if name]
        shown = ", ".join(known[:8]) + (", …" if len(known) > 8 else "")
        raise ValueError(f"{argument}: there is none named {given!r}; there are {shown or 'none with names'}")
    if isinstance(given, bool) or not isinstance(given, (int, np.integer)) or not 0 <= given < count:
        raise ValueError(f"{argument}: there is no number {given!r}; there are {count}, counted from 0")
    return int(given)
