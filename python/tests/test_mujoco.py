"""Models of MuJoCo: its own rays judge ours."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from numpy.typing import NDArray

import belvedere

mujoco = pytest.importorskip("mujoco")
bvm = pytest.importorskip("belvedere.mujoco")

#: Every type of geom, and a mesh with texture coordinates. Two bodies move freely.
EVERY_TYPE = """
<mujoco>
  <asset>
    <hfield name="hills" nrow="9" ncol="12" size="2 1.5 0.6 0.2"/>
    <mesh name="wedge" vertex="0 0 0  1 0 0  0 1 0  1 1 0  0 0 0.7  1 0 0.4"/>
    <texture name="tiles" type="2d" builtin="checker" width="64" height="64" rgb1="1 0 0" rgb2="0 0 1"/>
    <material name="tiled" texture="tiles" texrepeat="4 4" specular="0"/>
  </asset>
  <worldbody>
    <light directional="true" dir="0 0 -1"/>
    <geom name="floor" type="plane" size="0 0 1" pos="0 0 -1"/>
    <geom name="table" type="plane" size="1.5 0.7 1" pos="2 -2 0.3" euler="10 20 30" material="tiled"/>
    <geom name="terrain" type="hfield" hfield="hills" pos="-3 2 0" euler="0 0 25"/>
    <geom name="hidden" type="sphere" size="3" rgba="1 1 1 0"/>
    <geom name="guide" type="sphere" size="2" group="4"/>
    <body name="first" pos="0 0 1"><freejoint/>
      <geom name="ball" type="sphere" size="0.4"/>
      <geom name="pill" type="capsule" size="0.2 0.5" pos="1 0 0" euler="30 0 10"/>
      <geom name="egg" type="ellipsoid" size="0.3 0.5 0.2" pos="0 1.2 0" euler="0 40 0"/>
      <site name="lidar" pos="0 0 1" euler="0 0 40"/>
      <camera name="eye" pos="0 0 1.2" xyaxes="0 -1 0 0.3 0 1" fovy="70"/>
    </body>
    <body name="second" pos="-1 -1.5 0.5"><freejoint/>
      <geom name="can" type="cylinder" size="0.3 0.6" euler="60 0 0"/>
      <geom name="crate" type="box" size="0.3 0.4 0.5" pos="1.2 -0.5 0" euler="15 25 35"/>
      <geom name="ramp" type="mesh" mesh="wedge" pos="-1.5 0 0"/>
    </body>
    <camera name="shifted" pos="0 -6 3" xyaxes="1 0 0 0 0.5 1" focalpixel="300 300" principalpixel="20 -10"
            sensorsize="0.01 0.0075" resolution="320 240"/>
    <camera name="flat" pos="0 0 9" projection="orthographic" fovy="5"/>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    model = mujoco.MjModel.from_xml_string(EVERY_TYPE)
    model.hfield_data[:] = np.random.default_rng(3).random(model.hfield_data.shape)
    return model


def random_state(model: mujoco.MjModel, seed: int) -> mujoco.MjData:
    random = np.random.default_rng(seed)
    data = mujoco.MjData(model)
    data.qpos[:] = model.qpos0 + random.normal(0.0, 0.3, model.nq)
    mujoco.mj_forward(model, data)
    return data


def rays_of_mujoco(
    model: mujoco.MjModel, data: mujoco.MjData, origin: NDArray[np.float64], directions: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.float64]]:
    count = len(directions)
    geoms, distances, normals = np.empty(count, np.int32), np.empty(count), np.empty((count, 3))
    groups = np.array([1, 1, 1, 0, 0, 0], np.uint8)
    mujoco.mj_multiRay(
        model, data, origin, directions.ravel(), groups, True, -1, geoms, distances, normals.ravel(), count, 1e9
    )
    distances[geoms < 0] = np.inf
    return distances, geoms, normals


def test_rays_agree_with_mujoco(model: mujoco.MjModel) -> None:
    scene = bvm.Scene(model)
    others = total = 0
    for seed in range(10):
        data = random_state(model, seed)
        random = np.random.default_rng(100 + seed)
        origin = random.uniform([-4, -4, -2], [4, 4, 4])
        directions = random.normal(size=(4000, 3))
        distances, geoms, _ = rays_of_mujoco(model, data, origin, directions)
        hits = scene.cast(data, origin, directions)
        same = hits["geom"] == geoms
        # A grazing ray may hit an edge or the ground behind it.
        others += int((~same).sum())
        total += len(directions)
        seen = same & (geoms >= 0)
        np.testing.assert_allclose(hits["distance"][seen], distances[seen], rtol=2e-5, atol=2e-6)
        assert np.isinf(hits["distance"][hits["geom"] < 0]).all()
        point = origin + directions * distances[:, None]
        np.testing.assert_allclose(hits["point"][seen], point[seen], rtol=2e-5, atol=1e-4)
    assert others <= total * 1e-4, f"{others} of {total} rays hit another geom"


@pytest.mark.parametrize(("name", "height"), [("eye", 240), ("eye", 100), ("shifted", 240), ("shifted", 160)])
def test_pictures_agree_with_rays_of_mujoco(model: mujoco.MjModel, name: str, height: int) -> None:
    scene = bvm.Scene(model)
    data = random_state(model, 5)
    camera = scene.camera(name) if (name, height) == ("shifted", 240) else scene.camera(name, 320, height)
    frame = camera.render(data, channels=("rgb", "depth", "geom", "range"))
    assert frame["rgb"].shape == (height, 320, 3)
    number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_CAMERA, name)
    view = mujoco.MjvCamera()
    view.type, view.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, number
    vertical, horizontal, clip = (np.zeros(2, np.float32) for _ in range(3))
    mujoco.mjv_cameraFrustum(vertical, horizontal, clip, model, view)
    # The rays of OpenGL's frustum, by MuJoCo's documentation of its camera.
    step = (vertical[0] + vertical[1]) / height
    # A sensor with a size is stretched to the picture; otherwise pixels are square.
    across = horizontal.sum() / 320 if horizontal.sum() > 0 else step
    x = (np.arange(320) + 0.5 - 160) * across + (horizontal[1] - horizontal[0]) / 2
    y = vertical[1] - (np.arange(height) + 0.5) * step
    rays = np.stack(np.broadcast_arrays(x[None, :], y[:, None], -clip[0]), axis=-1).reshape(-1, 3)
    turned = (rays / clip[0]) @ data.cam_xmat[number].reshape(3, 3).T
    distances, geoms, _ = rays_of_mujoco(model, data, data.cam_xpos[number].copy(), turned)
    # The renderer sees nothing behind its far clip distance.
    geoms[distances > clip[1]] = -1
    same = frame["geom"].ravel() == geoms
    assert same.mean() > 0.9998
    seen = same & (geoms >= 0)
    np.testing.assert_allclose(frame["depth"].ravel()[seen], distances[seen], rtol=1e-4)


def test_states_in_all_their_forms_are_the_same(model: mujoco.MjModel) -> None:
    scene = bvm.Scene(model)
    camera = scene.camera("eye", 48, 32)
    states = [random_state(model, seed) for seed in range(6)]
    channels = ("rgb", "depth", "geom")
    together = camera.render(states, channels=channels)
    for count, one in enumerate(states):
        alone = camera.render(one, channels=channels, threads=1)
        for channel in channels:
            assert (alone[channel] == together[channel][count]).all(), channel
    positions = np.stack([state.qpos for state in states]).reshape(2, 3, -1)
    by_positions = camera.render(positions, channels=channels)
    names = ("geom_xpos", "geom_xmat", "cam_xpos", "cam_xmat", "light_xpos", "light_xdir")
    by_arrays = camera.render(
        {name: np.stack([getattr(state, name) for state in states]) for name in names}, channels=channels
    )
    for channel in channels:
        assert by_positions[channel].shape == (2, 3, *together[channel].shape[1:])
        assert (by_positions[channel].reshape(together[channel].shape) == together[channel]).all(), channel
        assert (by_arrays[channel] == together[channel]).all(), channel


def test_lamps_do_not_remember_the_last_call(model: mujoco.MjModel) -> None:
    moved = mujoco.MjModel.from_xml_string("""
        <mujoco>
          <visual><headlight active="0"/></visual>
          <worldbody><geom type="plane" size="0 0 1"/><camera name="down" pos="0 0 3"/>
            <body><joint axis="0 1 0"/><geom size="0.1"/><light directional="true" dir="0 0 -1"/></body>
          </worldbody>
        </mujoco>""")
    data = mujoco.MjData(moved)
    mujoco.mj_forward(moved, data)
    camera = bvm.Scene(moved).camera("down", 16, 16)
    arrays = {name: getattr(data, name).copy() for name in ("geom_xpos", "geom_xmat", "cam_xpos", "cam_xmat")}
    first = camera.render(arrays)["rgb"]
    tilted = camera.render(np.array([1.2]))["rgb"]
    assert (tilted != first).any()
    assert (camera.render(arrays)["rgb"] == first).all()


def test_no_states_and_any_names(model: mujoco.MjModel) -> None:
    scene = bvm.Scene(model)
    frames = scene.camera("eye", 8, 4).render(np.zeros((0, model.nq)), channels=("rgb", "geom"))
    assert {name: array.shape for name, array in frames.items()} == {"rgb": (0, 4, 8, 3), "geom": (0, 4, 8)}
    assert scene.lidar("lidar", beams=5).render(np.zeros((0, model.nq)))["range"].shape == (0, 1, 5)
    confusing = "<geom name='geom 1' size='1'/><geom size='1'/><geom name='1' size='1'/>"
    named = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{confusing}</worldbody></mujoco>")
    assert len(bvm.Scene(named).geoms) == 3


def test_lidars_measure_what_rays_hit(model: mujoco.MjModel) -> None:
    scene = bvm.Scene(model)
    data = random_state(model, 2)
    lidar = scene.lidar("lidar", beams=811, angles=(-2.3, 2.3), most=1000.0)
    ranges = lidar.render(data)["range"][0]
    site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, "lidar")
    angles = np.linspace(-2.3, 2.3, 811)
    rays = np.stack([np.cos(angles), np.sin(angles), np.zeros(811)], axis=-1)
    turned = rays @ data.site_xmat[site].reshape(3, 3).T
    distances, geoms, _ = rays_of_mujoco(model, data, data.site_xpos[site].copy(), turned)
    # A lidar sees the backs of planes, which rays of MuJoCo pass through.
    front = np.isclose(ranges, distances, rtol=1e-4) | ~np.isin(geoms, [-1])
    assert np.isclose(ranges[front], distances[front], rtol=1e-4).mean() > 0.99
    scanner = scene.lidar("lidar", preset="vlp16")
    still = scanner.render(data)["range"]
    assert (scanner.render(data, after=data)["range"] == still).all()
    moved = random_state(model, 3)
    assert (scanner.render(data, after=moved)["range"] != still).any()


def matrices_of(data: mujoco.MjData, kind: str) -> NDArray[np.float64]:
    """The poses of all objects of a kind, (objects, 4, 4)."""
    places, turns = getattr(data, f"{kind}_xpos"), getattr(data, f"{kind}_xmat")
    matrices = np.tile(np.eye(4), (len(places), 1, 1))
    matrices[:, :3, :3], matrices[:, :3, 3] = turns.reshape(-1, 3, 3), places
    return matrices


def test_frames_are_those_of_the_sensor_in_the_same_world(model: mujoco.MjModel) -> None:
    # The poses go to the sensor in another way, and no bit may differ.
    scene = bvm.Scene(model)
    lidar, camera = scene.lidar("lidar", beams=300, lines=5, noise=0.01), scene.camera("eye", 48, 32, noise=0.1)
    # The axes of MuJoCo's cameras, x right and y up, in those of ours, x forward and y left.
    turn = np.array([[0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    for seed in range(5):
        data = random_state(model, seed)
        bodies = matrices_of(data, "geom")[scene.geoms]
        given = {"seeds": seed, "frames": 7 * seed, "bodies": dict(enumerate(bodies))}
        ours = lidar.render(data, seeds=seed, frames=7 * seed)["range"]
        site = matrices_of(data, "site")[model.site("lidar").id]
        np.testing.assert_array_equal(ours, lidar.sensor.render(scene.world, site, **given)["range"])
        eye = matrices_of(data, "cam")[model.camera("eye").id] @ turn
        channels = ("depth", "normal", "instance")
        seen = camera.render(data, channels, seeds=seed, frames=7 * seed)
        expected = camera.sensor.render(scene.world, eye, channels=channels, **given)
        for channel in channels:
            np.testing.assert_array_equal(seen[channel], expected[channel])


def test_a_ray_from_one_origin_does_not_depend_on_the_others(model: mujoco.MjModel) -> None:
    scene, data = bvm.Scene(model), random_state(model, 4)
    rays = np.random.default_rng(4).normal(size=(700, 3))
    together = scene.cast(data, (0.1, 0.2, 2.3), rays)
    for part in (slice(0, 1), slice(1, 4), slice(4, 700)):
        alone = scene.cast(data, (0.1, 0.2, 2.3), rays[part])
        for channel in together:
            np.testing.assert_array_equal(alone[channel], together[channel][part])


def test_threads_share_a_scene(model: mujoco.MjModel) -> None:
    scene = bvm.Scene(model)
    lidar, camera = scene.lidar("lidar", beams=300), scene.camera("eye", 24, 16)
    states = [random_state(model, seed) for seed in range(4)]

    def take(state: mujoco.MjData) -> list[bytes]:
        rays = scene.cast(state, (0, 0, 3), [[0, 0, -1], [1, 0, -1]])
        frames = (lidar.render(state), camera.render(state), rays)
        return [array.tobytes() for frame in frames for array in frame.values()]

    expected = [take(state) for state in states]
    with ThreadPoolExecutor(4) as workers:
        for found in workers.map(lambda state: [take(state) for _ in range(50)], states, timeout=60):
            assert all(one in expected for one in found)
        again = list(workers.map(take, states, timeout=60))
    assert again == expected


def test_the_renderer_has_the_interface_of_mujoco(model: mujoco.MjModel) -> None:
    data = random_state(model, 1)
    with bvm.Renderer(model, 60, 80) as renderer:
        with pytest.raises(RuntimeError, match="before update_scene"):
            renderer.render()
        renderer.update_scene(data, "eye")
        picture = renderer.render()
        assert picture.shape == (60, 80, 3)
        assert picture.dtype == np.uint8
        data.qpos[0] += 1.0
        mujoco.mj_forward(model, data)
        assert (renderer.render() == picture).all(), "the state is that of update_scene"
        renderer.enable_depth_rendering()
        depth = renderer.render(out=np.zeros((60, 80)))
        assert depth.max() <= model.vis.map.zfar * model.stat.extent
        renderer.enable_segmentation_rendering()
        segmentation = renderer.render()
        assert segmentation.dtype == np.int32
        assert set(np.unique(segmentation[..., 1])) <= {-1, int(mujoco.mjtObj.mjOBJ_GEOM)}
        renderer.disable_segmentation_rendering()
        with pytest.raises(ValueError, match=r"out: shape \(2, 2\); \(60, 80, 3\) is expected"):
            renderer.render(out=np.zeros((2, 2)))
        option = mujoco.MjvOption()
        option.geomgroup[:] = 0
        renderer.update_scene(data, scene_option=option)
        assert (renderer.render() == 0).all()
    with pytest.raises(RuntimeError, match="after close"):
        renderer.render()


def test_gymnasium_gets_pictures() -> None:
    gymnasium = pytest.importorskip("gymnasium")
    env = bvm.PixelObservation(gymnasium.make("Hopper-v5"), 40, 30, "track", channels=("rgb", "depth"), state=True)
    observation, _ = env.reset(seed=1)
    assert env.observation_space.contains(observation)
    assert observation["rgb"].shape == (30, 40, 3)
    after, *_ = env.step(env.action_space.sample() * 0 + 1)
    assert (after["depth"] != observation["depth"]).any()
    alone = bvm.PixelObservation(gymnasium.make("Hopper-v5"), 8, 8)
    assert alone.observation_space.shape == (8, 8, 3)
    with pytest.raises(ValueError, match="env: an environment with a model of MuJoCo"):
        bvm.PixelObservation(gymnasium.make("CartPole-v1"))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda s, d: bvm.Scene("model"), "model: an MjModel is expected, not str"),
        (lambda s, d: bvm.Scene(s.model, groups=(7,)), "groups: a whole number from 0 to 5"),
        (lambda s, d: s.camera("nowhere"), "camera: there is none named 'nowhere'; there are shifted, flat, eye"),
        (lambda s, d: s.camera(9), "camera: there is no number 9; there are 3"),
        (lambda s, d: s.camera("flat"), "camera: it is orthographic"),
        (lambda s, d: s.camera("eye", 0, 5), "width: a whole number from 1"),
        (lambda s, d: s.camera("eye", sensor=belvedere.Lidar(beams=3)), "sensor: a Camera or DepthCamera"),
        (lambda s, d: s.lidar(), "site, body: one of the two is expected"),
        (lambda s, d: s.lidar("mast"), "site: there is none named 'mast'; there are lidar"),
        (lambda s, d: s.lidar("lidar", preset="nothing"), "preset|nothing"),
        (lambda s, d: s.camera("eye", 4, 4).render([[0.0, 1.0]]), r"states: shape \(1, 2\)"),
        (
            lambda s, d: s.camera("eye", 4, 4).render(np.full((2, 14), np.nan)),
            "states: finite numbers are expected",
        ),
        (
            lambda s, d: s.camera("eye", 4, 4).render({"geom_xpos": d.geom_xpos}),
            "the array 'geom_xmat' is expected",
        ),
        (lambda s, d: s.camera("eye", 4, 4).render(mujoco.MjData(OTHER)), "belongs to another model"),
        (lambda s, d: s.camera("eye", 4, 4).render(without_poses(d)), "states: pose number 0"),
        (
            lambda s, d: s.camera("eye", 4, 4).render(with_lamp(d, np.nan)),
            r"states\['light_xdir'\]: a direction is",
        ),
        (lambda s, d: s.camera("eye", 4, 4).render(with_lamp(d, 0.0)), "which light 0 has in state 0"),
        (lambda s, d: s.cast([d, d], (0, 0, 0), [[0, 0, 1]]), "state: one state is expected, not 2"),
        (lambda s, d: s.camera("eye", 4, 4).render(d, channels=("colour",)), "there is no channel 'colour'"),
    ],
)
def test_bad_input_is_one_clear_error(model: mujoco.MjModel, call, message: str) -> None:  # noqa: ANN001
    scene, data = bvm.Scene(model), random_state(model, 0)
    with pytest.raises(ValueError, match=message):
        call(scene, data)


OTHER = mujoco.MjModel.from_xml_string("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")


def without_poses(data: mujoco.MjData) -> dict[str, NDArray[np.float64]]:
    """Arrays of a state whose geoms have no pose."""
    return {
        "geom_xpos": data.geom_xpos,
        "geom_xmat": data.geom_xmat * np.nan,
        "cam_xpos": data.cam_xpos,
        "cam_xmat": data.cam_xmat,
    }


def with_lamp(data: mujoco.MjData, direction: float) -> dict[str, NDArray[np.float64]]:
    """Arrays of a state whose lamps have this direction in all three axes."""
    names = ("geom_xpos", "geom_xmat", "cam_xpos", "cam_xmat")
    arrays = {name: getattr(data, name) for name in names}
    return arrays | {"light_xdir": np.full_like(data.light_xdir, direction)}
