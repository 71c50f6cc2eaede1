"""Any input of belvedere.mujoco: frames or a ValueError that names the argument, and never another exception."""

from __future__ import annotations

import copy
import os
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import belvedere as bv

if TYPE_CHECKING:
    from collections.abc import Callable

mujoco = pytest.importorskip("mujoco")
bvm = pytest.importorskip("belvedere.mujoco")

#: Settings that give the same inputs on each run.
quick = settings(
    max_examples=2000 if os.environ.get("BELVEDERE_FULL") == "1" else 50,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=list(HealthCheck),
)
MODEL = mujoco.MjModel.from_xml_string("""
<mujoco>
  <asset>
    <texture name="tiles" type="2d" builtin="checker" width="8" height="8" rgb1="1 0 0" rgb2="0 0 1"/>
    <material name="tiled" texture="tiles"/>
  </asset>
  <worldbody>
    <light name="lamp" pos="0 0 3"/>
    <geom name="floor" type="plane" size="3 3 1" material="tiled"/>
    <body name="robot" pos="0 0 1"><freejoint/>
      <geom name="ball" size="0.4"/><site name="mast" pos="0 0 1"/><camera name="eye" pos="0 0 1"/>
    </body>
  </worldbody>
</mujoco>""")
OTHER = mujoco.MjModel.from_xml_string("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
EMPTY = mujoco.MjModel.from_xml_string("<mujoco><worldbody><camera name='eye' pos='0 0 1'/></worldbody></mujoco>")
SCENE = bvm.Scene(MODEL)
CAMERA, LIDAR = SCENE.camera("eye", 6, 4), SCENE.lidar("mast", beams=3)
SCANNER = SCENE.lidar("mast", preset="utm30lx")
DATA, FOREIGN = mujoco.MjData(MODEL), mujoco.MjData(OTHER)
mujoco.mj_forward(MODEL, DATA)
mujoco.mj_forward(OTHER, FOREIGN)

numbers = st.one_of(st.floats(), st.floats(-2.0, 2.0), st.sampled_from([0.0, 1.0, 1e300, -1e30, 1e-300]))
dtypes = st.sampled_from([np.float64, np.float32, np.int32, np.uint8, np.bool_, np.complex64, "S3", "O", "M8[s]"])
anything = st.one_of(
    st.none(),
    st.integers(),
    st.floats(),
    st.text(max_size=4),
    st.sampled_from(
        [DATA, FOREIGN, MODEL, SCENE, object(), "eye", "mast", b"eye", True, [[]], {}, 2**70, -(2**70)]
    ),
    st.lists(st.one_of(st.integers(), st.text(max_size=3), st.none()), max_size=3),
    arrays.arrays(dtypes, arrays.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=9)),
)
#: Positions of nearly the right shape.
positions = st.one_of(
    arrays.arrays(np.float64, st.tuples(st.integers(0, 3), st.sampled_from([6, 7, 7, 7, 8])), elements=numbers),
    st.lists(st.sampled_from([DATA, FOREIGN, None, 3]), max_size=3),
)
fields = [
    "geom_xpos",
    "geom_xmat",
    "cam_xpos",
    "cam_xmat",
    "site_xpos",
    "site_xmat",
    "light_xpos",
    "xpos",
    "nothing",
    3,
]


@st.composite
def dictionaries(draw: st.DrawFn) -> dict[Any, Any]:
    """Arrays of states, some of which are missing, or have another shape, type or value."""
    lead = draw(st.sampled_from([(), (1,), (2,), (2, 1), (0,)]))
    made: dict[Any, Any] = {}
    for name in draw(st.lists(st.sampled_from(fields), unique=True)) + fields[: draw(st.sampled_from([0, 6]))]:
        value = np.array(getattr(DATA, str(name), np.zeros(3)))
        given = np.broadcast_to(value, (*lead, *value.shape)).copy()
        if given.size and draw(st.integers(0, 3)) == 0:
            given.flat[draw(st.integers(0, given.size - 1))] = draw(numbers)
        made[name] = draw(anything) if draw(st.integers(0, 9)) == 0 else given
    return made


states = st.one_of(positions, dictionaries(), anything)


def is_refused(act: Callable[[], Any], *arguments: str) -> bool:
    """Return True if the call raises a ValueError that begins with one of these arguments."""
    try:
        act()
    except ValueError as error:
        assert str(error).startswith(arguments), error  # noqa: PT017
        return True
    return False


@quick
@given(states=states, channels=st.one_of(st.none(), st.just(("rgb", "geom")), anything), seeds=anything)
def test_any_states_of_a_camera(states: Any, channels: Any, seeds: Any) -> None:
    is_refused(lambda: CAMERA.render(states, channels), "states", "channels", "poses", "poses[")
    is_refused(lambda: CAMERA.render(DATA, channels, seeds=seeds), "channels", "seeds")
    is_refused(lambda: CAMERA.render(DATA, frames=seeds, threads=seeds), "frames", "threads")


@quick
@given(states=states, after=st.one_of(st.none(), states), channels=st.one_of(st.none(), anything))
def test_any_states_of_a_lidar(states: Any, after: Any, channels: Any) -> None:
    is_refused(lambda: LIDAR.render(states, after, channels=channels), "states", "after", "channels", "poses")
    is_refused(lambda: SCANNER.render(states, after, channels=channels), "states", "after", "channels", "poses")


@quick
@given(state=states, origins=anything, directions=st.one_of(st.just([[0.0, 0.0, -1.0]]), anything))
def test_any_rays(state: Any, origins: Any, directions: Any) -> None:
    is_refused(lambda: SCENE.cast(state, (0, 0, 5), [[0.0, 0.0, -1.0]]), "state", "states")
    is_refused(lambda: SCENE.cast(DATA, origins, directions), "origins", "directions")


@quick
@given(name=anything, width=anything, height=anything, groups=anything)
def test_any_sensors(name: Any, width: Any, height: Any, groups: Any) -> None:
    is_refused(lambda: SCENE.camera(name), "camera")
    is_refused(lambda: SCENE.camera("eye", width, height), "width", "height")
    is_refused(lambda: SCENE.camera("eye", sensor=width), "sensor")
    is_refused(lambda: SCENE.lidar(name, beams=2), "site")
    is_refused(lambda: SCENE.lidar(body=name, beams=2), "site", "body")
    is_refused(lambda: SCENE.lidar("mast", preset=name), "preset")
    is_refused(lambda: SCENE.lidar("mast", beams=width, lines=height), "beams", "lines", "number of all beams")
    is_refused(lambda: bvm.Scene(MODEL, groups=groups), "groups")
    is_refused(lambda: bvm.Scene(name), "model")


@quick
@given(data=anything, camera=anything, option=anything, out=anything, size=anything)
def test_any_use_of_the_renderer(data: Any, camera: Any, option: Any, out: Any, size: Any) -> None:
    is_refused(lambda: bvm.Renderer(MODEL, size, 4), "height")
    with bvm.Renderer(MODEL, 4, 6) as renderer:
        is_refused(lambda: renderer.update_scene(data, camera, option), "states", "camera", "scene_option")
        renderer.update_scene(DATA, "eye")
        is_refused(lambda: renderer.render(out=out), "out")
        is_refused(lambda: renderer.render(out=np.zeros((4, 6, 3), getattr(out, "dtype", np.uint8))), "out")


@quick
@given(
    kind=st.sampled_from([mujoco.mjtCamera.mjCAMERA_FIXED, mujoco.mjtCamera.mjCAMERA_FREE]),
    number=st.integers(-(2**31), 2**31 - 1),
    values=arrays.arrays(np.float64, 6, elements=numbers),
)
def test_any_free_camera(kind: Any, number: int, values: Any) -> None:
    camera = mujoco.MjvCamera()
    camera.type, camera.fixedcamid = kind, number
    camera.lookat[:], camera.distance, camera.azimuth, camera.elevation = values[:3], *values[3:]
    is_refused(lambda: SCENE.camera(camera, 4, 4).render(DATA), "camera", "poses", "lens")


FIELDS_OF_THE_MODEL = ["geom_size", "geom_rgba", "mat_rgba", "mat_texrepeat", "mat_specular", "mat_shininess"]


@quick
@given(
    field=st.sampled_from(
        [*FIELDS_OF_THE_MODEL, "mat_emission", "light_ambient", "light_attenuation", "light_cutoff"]
    ),
    value=numbers,
)
def test_any_values_of_a_model(field: str, value: float) -> None:
    model = copy.copy(MODEL)
    with np.errstate(over="ignore"):
        getattr(model, field).flat[:] = value
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    is_refused(lambda: bvm.Scene(model).camera("eye", 4, 4).render(data), "model: geom", "model: light", "states")


@pytest.mark.parametrize("field", ["tex_width", "tex_height"])
def test_a_texture_of_no_size_is_left_out(field: str) -> None:
    model = copy.copy(MODEL)
    getattr(model, field)[0] = 0
    scene = bvm.Scene(model)
    assert "material tiled: its texture has no pixels" in scene.notes
    assert scene.camera("eye", 4, 4).render(np.zeros((0, model.nq)))["rgb"].shape == (0, 4, 4, 3)


def test_a_model_without_joints_and_geoms() -> None:
    camera = bvm.Scene(EMPTY).camera("eye", 4, 4)
    assert camera.render(np.zeros((2, 3, 0)), ("geom",))["geom"].shape == (2, 3, 4, 4)
    arrays_of_none = {"geom_xpos": np.zeros((5, 0, 3)), "geom_xmat": np.zeros((5, 0, 9))}
    arrays_of_none |= {"cam_xpos": np.zeros((5, 1, 3)), "cam_xmat": np.tile(np.eye(3), (5, 1, 1, 1))}
    assert (camera.render(arrays_of_none, ("geom",))["geom"] == -1).all()


def test_frames_that_no_memory_holds() -> None:
    # A petabyte of pixels, of states that are one.
    many = np.broadcast_to(np.float64(1.0), (2_000_000, 7))
    large = SCENE.camera("eye", 16384, 16384)
    with pytest.raises(
        ValueError, match=r"^channels: there is no memory for rgb of shape \(2000000, 16384, 16384, 3\)"
    ):
        bv.Camera(16384, 16384, 1.0).render(bv.World(), np.broadcast_to([0, 0, 0, 0, 0, 0, 1.0], many.shape))
    assert large.sensor.frame_shape == (16384, 16384)
    endless = np.broadcast_to(np.float64(1.0), (2**45, 7))
    with pytest.raises(ValueError, match=r"^states: an array of float64 is expected: .*llocate"):
        large.render(endless)
