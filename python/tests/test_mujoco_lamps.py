"""Lamps of models of MuJoCo that move or turn from state to state."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

mujoco = pytest.importorskip("mujoco")
bvm = pytest.importorskip("belvedere.mujoco")

#: What a dictionary of arrays must have for a camera of the model.
POSES = ("geom_xpos", "geom_xmat", "cam_xpos", "cam_xmat")
MODES = {
    "fixed": 'mode="fixed"',
    "track": 'mode="track"',
    "trackcom": 'mode="trackcom"',
    "targetbody": 'mode="targetbody" target="ball"',
    "targetbodycom": 'mode="targetbodycom" target="ball"',
}


def model_of(light: str) -> Any:
    """A lamp of this kind on a swinging body, over a ball that slides on a plane."""
    return mujoco.MjModel.from_xml_string(f"""
        <mujoco>
          <visual><headlight active="0"/></visual>
          <worldbody>
            <geom type="plane" size="4 4 1"/>
            <body name="swing" pos="0 0 1.5"><joint axis="0 1 0"/>
              <geom type="box" size="0.1 0.1 0.1" pos="0 0 0.4"/>
              <light {light} pos="0 0 0.1" dir="0 0.1 -1" cutoff="60" exponent="20"/>
            </body>
            <body name="ball" pos="0 0 0.2"><joint type="slide" axis="1 0 0"/><geom size="0.2"/></body>
            <camera name="down" pos="0 0 6" fovy="45"/>
          </worldbody>
        </mujoco>""")


def data_of(model: Any, positions: NDArray[np.float64]) -> list[Any]:
    states = []
    for position in positions:
        states.append(mujoco.MjData(model))
        states[-1].qpos[:] = position
        mujoco.mj_forward(model, states[-1])
    return states


def arrays_of(states: list[Any], names: tuple[str, ...]) -> dict[str, NDArray[np.float64]]:
    return {name: np.stack([getattr(state, name) for state in states]) for name in names}


def seen_alone(light: str, state: Any, lamp: Any) -> NDArray[np.uint8]:
    """Return the picture of a state by a scene whose lamp hangs where it is in the state ``lamp``, and never moves."""
    model = model_of(light)
    model.light_mode[:] = int(mujoco.mjtCamLight.mjCAMLIGHT_FIXED)
    model.light_bodyid[:] = 0
    model.light_pos[:], model.light_dir[:] = lamp.light_xpos, lamp.light_xdir
    poses = {name: array[0] for name, array in arrays_of([state], POSES).items()}
    picture: NDArray[np.uint8] = bvm.Scene(model).camera("down", 48, 48).render(poses)["rgb"]
    return picture


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("form", ["spot", "directional"])
def test_lamps_have_the_direction_of_each_state(mode: str, form: str) -> None:
    light = f'{MODES[mode]} type="{form}"'
    model = model_of(light)
    positions = np.array([[0.0, 0.0], [0.5, 0.0], [0.0, 1.0], [-0.4, -0.7]])
    states = data_of(model, positions)
    camera = bvm.Scene(model).camera("down", 48, 48)
    alone = np.stack([seen_alone(light, state, state) for state in states])
    lamps = ("light_xpos", "light_xdir")
    forms = {"qpos": positions, "MjData": states, "arrays": arrays_of(states, (*POSES, *lamps))}
    for name, given in forms.items():
        assert (camera.render(given)["rgb"] == alone).all(), name
    for state, picture in zip(states, alone, strict=True):
        assert (camera.render(state, threads=1)["rgb"] == picture).all()
    # Arrays without lamps have those of the first pose in all states.
    kept = camera.render(arrays_of(states, POSES))["rgb"]
    assert (kept == np.stack([seen_alone(light, state, states[0]) for state in states])).all()
    decide = lamps if form == "spot" else lamps[1:]
    is_moved = any((getattr(state, name) != getattr(states[0], name)).any() for state in states for name in decide)
    assert (kept != alone).any() == is_moved


def test_positions_without_directions_move_spotlights() -> None:
    light = 'type="spot"'
    model = model_of(light)
    states = data_of(model, np.array([[0.0, 0.0], [0.5, 0.3]]))
    seen = bvm.Scene(model).camera("down", 48, 48).render(arrays_of(states, (*POSES, "light_xpos")))["rgb"]
    states[0].light_xpos[:] = states[1].light_xpos
    assert (seen[1] == seen_alone(light, states[1], states[0])).all()


@pytest.mark.parametrize("form", ["spot", "directional"])
@pytest.mark.parametrize("direction", [0.0, np.nan, np.inf])
def test_a_lamp_without_direction_is_refused(form: str, direction: float) -> None:
    model = model_of(f'type="{form}"')
    arrays = arrays_of(data_of(model, np.zeros((2, 2))), (*POSES, "light_xpos", "light_xdir"))
    arrays["light_xdir"][1] = direction
    with pytest.raises(ValueError, match=r"states\['light_xdir'\]: a direction is .* light 0 has in state 1"):
        bvm.Scene(model).camera("down", 4, 4).render(arrays)
