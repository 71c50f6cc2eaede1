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


class Lamps:
    """Lamps of a model, in a world whose background is black."""

    def __init__(self, world: World, model: mujoco.MjModel) -> None:
        #: Differences from MuJoCo's renderer.
        self.notes: list[str] = []
        #: The number of each lamp in the model, and whether it has a direction instead of a position.
        self._lights: list[tuple[int, bool]] = []
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
        cone, falloff, error = _cone(float(model.light_cutoff[light]), float(model.light_exponent[light]))
        if kind == "spot":
            name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_LIGHT, light) or f"number {light}"
            edge = "" if error < 0.05 else "it has no edge, and "
            self.notes.append(f"light {name}: {edge}it keeps the direction that it has in the model's first pose")
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
        self._lights.append((light, kind == "directional"))

    def place(
        self, world: _native.World, states: States, matrices: NDArray[np.float64], camera: int
    ) -> NDArray[np.float64]:
        """Return the positions and directions of the lamps of each state, (N, lamps, 3).

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


def _cone(cutoff: float, exponent: float) -> tuple[tuple[float, float], float, float]:
    """Return the cone and the falloff that are most like a spotlight of MuJoCo, and the largest error of its brightness.

    Its brightness at an angle is the cosine to this power, and 0 from the cutoff (degrees) on.
    """
    edge = math.radians(min(cutoff, 90.0))
    power = min(max(exponent, 0.0), _MOST_FALLOFF)
    at_edge = max(math.cos(edge), 0.0) ** power if edge < math.pi / 2.0 else 0.0
    if at_edge > 0.5:
        return (edge, edge), 1.0, 1.0 - at_edge
    return (0.0, math.pi / 2.0), power, at_edge
