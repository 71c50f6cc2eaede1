"""States of a model: the poses of its geoms, cameras, sites and lamps."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from belvedere import _arrays

if TYPE_CHECKING:
    from typing import TypeAlias

    from numpy.typing import NDArray

    from belvedere._arrays import ArrayLike

    #: Places (N, objects, 3) and matrices (N, objects, 9).
    Frames: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float64]]

#: What is read of a state: the field of MjData, the number of objects by the field of MjModel, and their shape.
_FIELDS = {
    "geom_xpos": ("ngeom", (3,)),
    "geom_xmat": ("ngeom", (9,)),
    "cam_xpos": ("ncam", (3,)),
    "cam_xmat": ("ncam", (9,)),
    "site_xpos": ("nsite", (3,)),
    "site_xmat": ("nsite", (9,)),
    "xpos": ("nbody", (3,)),
    "xmat": ("nbody", (9,)),
    "light_xpos": ("nlight", (3,)),
    "light_xdir": ("nlight", (3,)),
}
#: What a dictionary of arrays must have.
_NEEDED = ("geom_xpos", "geom_xmat")


@dataclass(frozen=True)
class States:
    """The poses of N states, by the field of MjData: (N, objects, 3 or 9)."""

    #: The shape of the batch that the caller gave: () for one ``MjData``.
    lead: tuple[int, ...]
    #: The number of states.
    count: int
    fields: Mapping[str, NDArray[np.float64]]

    def field(self, name: str) -> NDArray[np.float64]:
        """Return the poses of a field.

        Raises:
            ValueError: the caller gave arrays without it.

        """
        try:
            return self.fields[name]
        except KeyError:
            known = ", ".join(self.fields)
            raise ValueError(f"states: the array {name!r} is expected, too; there are {known}") from None

    def frames(self, kind: str) -> Frames:
        """Return places and matrices of all objects of a kind: ``geom_``, ``cam_``, ``site_``, or empty for bodies.

        Raises:
            ValueError: the caller gave arrays without them.

        """
        return self.field(f"{kind}xpos"), self.field(f"{kind}xmat")


def states_of(model: mujoco.MjModel, states: Any) -> States:
    """Read states: an ``MjData``, a sequence of them, an array of ``qpos`` (…, nq), or a dictionary of arrays.

    Raises:
        ValueError: the states are none, or belong to another model.

    """
    if isinstance(states, States):
        return states
    if isinstance(states, mujoco.MjData):
        return States((), 1, _Read(model, states))
    if isinstance(states, Mapping):
        return _of_arrays(model, states)
    if isinstance(states, Sequence) and len(states) > 0 and isinstance(states[0], mujoco.MjData):
        read = []
        for number, state in enumerate(states):
            if not isinstance(state, mujoco.MjData):
                raise ValueError(f"states[{number}]: an MjData is expected, as the first one is, not {state!r}")
            read.append(_Read(model, state))
        return States(
            (len(read),), len(read), {name: np.concatenate([one[name] for one in read]) for name in _FIELDS}
        )
    return _of_positions(model, states)


class _Read(Mapping[str, "NDArray[np.float64]"]):
    """The fields of an ``MjData``, which are read when they are used, without a copy."""

    def __init__(self, model: mujoco.MjModel, state: mujoco.MjData) -> None:
        if state.signature != model.signature:
            raise ValueError(
                "states: an MjData of this scene's model is expected; this one belongs to another model"
            )
        self._state = state

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        if name not in _FIELDS:
            raise KeyError(name)
        field: NDArray[np.float64] = getattr(self._state, name)
        return field[None]

    def __contains__(self, name: object) -> bool:
        return name in _FIELDS

    def __iter__(self) -> Iterator[str]:
        return iter(_FIELDS)

    def __len__(self) -> int:
        return len(_FIELDS)


def _of_positions(model: mujoco.MjModel, positions: ArrayLike) -> States:
    given = _arrays.array("states", positions, np.float64)
    if given.ndim == 0 or given.shape[-1] != model.nq:
        raise ValueError(
            f"states: shape {given.shape}; an MjData, a list of them, a dictionary of arrays, or qpos "
            f"(…, {model.nq}) is expected"
        )
    lead = given.shape[:-1]
    rows = given.reshape(math.prod(lead), model.nq)
    bad = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(bad):
        raise ValueError(f"states: finite numbers are expected; qpos of state {bad[0]} is {rows[bad[0]].tolist()}")
    fields = {
        name: np.empty((len(rows), getattr(model, count), *shape)) for name, (count, shape) in _FIELDS.items()
    }
    data = mujoco.MjData(model)
    read = _Read(model, data)
    for number, row in enumerate(rows):
        data.qpos[:] = row
        mujoco.mj_kinematics(model, data)
        # Cameras and lamps that follow something need the centres of mass.
        mujoco.mj_comPos(model, data)
        mujoco.mj_camlight(model, data)
        for name, values in read.items():
            fields[name][number] = values[0]
    return States(lead, len(rows), fields)


def _of_arrays(model: mujoco.MjModel, states: Mapping[str, ArrayLike]) -> States:
    fields: dict[str, NDArray[np.float64]] = {}
    lead: tuple[int, ...] | None = None
    for name in (*_NEEDED, *states):
        if name not in states:
            known = ", ".join(map(str, states)) or "none"
            raise ValueError(f"states: the array {name!r} is expected; there are {known}")
        if name not in _FIELDS:
            raise ValueError(f"states: there is no array {name!r}; there are {', '.join(_FIELDS)}")
        count, shape = getattr(model, _FIELDS[name][0]), _FIELDS[name][1]
        given = _arrays.array(f"states[{name!r}]", states[name], np.float64)
        if shape == (9,) and given.shape[-2:] == (3, 3):
            given = given.reshape(*given.shape[:-2], 9)
        if given.shape[-2:] != (count, *shape) or (lead is not None and given.shape[:-2] != lead):
            wanted = "…" if lead is None else ", ".join(map(str, lead))
            raise ValueError(f"states[{name!r}]: shape {given.shape}; ({wanted}, {count}, {shape[0]}) is expected")
        lead = given.shape[:-2]
        fields[name] = given.reshape(math.prod(lead), count, *shape)
    assert lead is not None
    return States(lead, math.prod(lead), fields)
