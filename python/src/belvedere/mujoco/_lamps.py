"""The lamps of a model, and the one at the camera."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import mujoco
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from belvedere import _native
    from belvedere._world import World
    from belvedere.mujoco._states import States

_KINDS = {
    int(mujoco.mjtLightType.mjLIGHT_SPOT): "spot",
    int(mujoco.mjtLightType.mjLIGHT_DIRECTIONAL): "directional",
    int(mujoco.mjtLightType.mjLIGHT_POINT): "point",
}
#: Ambient light of a model without lamps.
_DARK = 0.3
#: The largest falloff of a lamp.
_MOST_FALLOFF = 1e4
#: A spotlight that is less bright than this at its cutoff needs no edge there.
_DARK_EDGE = 0.05
#: Exponents that are tried for spotlights with an edge, and cosines between that of the edge, 0, and 1.
_FALLOFFS = 2.0 ** (np.arange(-56, 57) / 8.0)[:, None]
_ABOVE = (np.arange(256) + 0.5) / 256


class Lamps:
    """Lamps of a model, in a world whose background is black."""

    def __init__(self, world: World, model: mujoco.MjModel) -> None:
        #: Differences from MuJoCo's renderer.
        self.notes: list[str] = []
        #: The number of each lamp in the model.
        self._lights: list[int] = []
        headlight = model.vis.headlight
        ambient = np.zeros(3)
        first = _first_pose(model)
        for light in range(model.nlight):
            if not model.light_active[light]:
                continue
            kind = _KINDS.get(int(model.light_type[light]))
            if kind is None:
                self.notes.append(f"light {light}: images are not lamps here, so it is dark")
                continue
            try:
                self._add(world, model, light, kind, first)
            except ValueError as error:
                raise ValueError(f"model: light {light}: {error}") from error
            ambient += model.light_ambient[light]
        self._headlight = len(self._lights) if headlight.active else None
        if headlight.active:
            world.add_light(
                "directional",
                direction=(1, 0, 0),
                color=headlight.diffuse,
                specular=headlight.specular,
                shadows=False,
            )
            ambient += headlight.ambient
        elif not self._lights:
            ambient += _DARK
        try:
            world.set_environment(ambient, np.zeros(3))
        except ValueError as error:
            raise ValueError(f"model: lights: {error}") from error

    def _add(self, world: World, model: mujoco.MjModel, light: int, kind: str, first: mujoco.MjData) -> None:
        direction = first.light_xdir[light] if np.any(first.light_xdir[light]) else (0.0, 0.0, -1.0)
        cone, falloff, difference = _cone(float(model.light_cutoff[light]), float(model.light_exponent[light]))
        if kind == "spot" and difference:
            name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_LIGHT, light) or f"number {light}"
            self.notes.append(f"light {name}: {difference}")
        world.add_light(
            kind,
            position=first.light_xpos[light],
            direction=direction,
            color=np.maximum(model.light_diffuse[light], 0.0),
            specular=np.maximum(model.light_specular[light], 0.0),
            attenuation=np.maximum(model.light_attenuation[light], 0.0),
            cone=cone,
            falloff=falloff,
            shadows=bool(model.light_castshadow[light]),
        )
        self._lights.append(light)

    def place(
        self, world: _native.World, states: States, matrices: NDArray[np.float64], camera: int
    ) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
        """Return the positions of the lamps of each state, or directions of directional ones, (N, lamps, 3).

        Directions of spotlights are the second array, if there are any and the states have them.

        Args:
            world: the world of the lamps.
            states: the states.
            matrices: those of cameras, (N, cameras, 9).
            camera: the camera that has the headlight.

        Raises:
            ValueError: a lamp has no place, or no direction.

        """
        # Arrays of poses may be without lamps, which then stay where they are in the model.
        places, ways = (
            states.field(name) if self._lights and name in states.fields else None
            for name in ("light_xpos", "light_xdir")
        )
        headlight = None if self._headlight is None else (self._headlight, matrices, camera)
        return world.placed_lights(self._lights, places, ways, headlight, states.count)


def _first_pose(model: mujoco.MjModel) -> mujoco.MjData:
    """Return the state with the model's first pose and the lamps of it.

    ``light_dir0`` is not their direction there, since it ignores the body that a lamp looks at.
    """
    first = mujoco.MjData(model)
    if model.nlight:
        mujoco.mj_kinematics(model, first)
        mujoco.mj_comPos(model, first)
        mujoco.mj_camlight(model, first)
    return first


def _cone(cutoff: float, exponent: float) -> tuple[tuple[float, float], float, str]:
    """Return the cone and the falloff that are most like a spotlight of MuJoCo, and what differs, if anything does.

    Its brightness at an angle is the cosine to this power, and 0 from the cutoff (degrees) on. Here it is 0 from an
    angle on, too, but a power of what the cosine is above its value there.
    """
    edge = math.radians(min(cutoff, 90.0))
    power = min(max(exponent, 0.0), _MOST_FALLOFF)
    least = max(math.cos(edge), 0.0)
    at_edge = least**power if edge < math.pi / 2.0 else 0.0
    wide = (0.0, math.pi / 2.0)
    if at_edge < _DARK_EDGE:
        return wide, power, ""
    if power == 0.0:
        return (edge, edge), 1.0, ""
    # Squares of errors over all directions, with the light of MuJoCo inside the edge, and with an edge.
    without_edge = least * at_edge**2 / (2.0 * power + 1.0)
    errors = (_ABOVE**_FALLOFFS - (least + (1.0 - least) * _ABOVE) ** power) ** 2
    with_edge = errors.mean(axis=1) * (1.0 - least)
    best = int(np.argmin(with_edge))
    if without_edge < with_edge[best]:
        return wide, power, "it has no edge"
    return (0.0, edge), float(_FALLOFFS[best, 0]), "its edge is less sharp"
