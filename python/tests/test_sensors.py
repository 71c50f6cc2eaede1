"""Sensors in worlds that are simple enough to know the result."""

from __future__ import annotations

import copy
import math
import pickle

import numpy as np
import pytest

import belvedere as bv

HERE = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]


def poses_along_x(count: int, step: float = 0.1) -> np.ndarray:
    poses = np.tile(np.array(HERE), (count, 1))
    poses[:, 0] = np.arange(count) * step
    return poses


@pytest.fixture
def wall() -> bv.World:
    """Return a world with a wall 3 m ahead, a sphere of 0.5 m in front of it, and a floor."""
    world = bv.World()
    world.add_box((0.2, 10, 10), (3.1, 0, 0), name="wall", color=(0.9, 0.1, 0.1), class_id=7)
    world.add_sphere(0.5, (2, 0, 0), name="ball", color=(0.1, 0.1, 0.9), class_id=9)
    world.add_plane((0, 0, -1), name="floor")
    world.add_light("directional", direction=(1, 0.2, -1))
    return world


def test_depth_of_a_wall_and_a_ball(wall: bv.World) -> None:
    frames = bv.DepthCamera(65, 49, fov=1.0).render(wall, poses_along_x(4))
    depth = frames["depth"]
    assert depth.shape == (4, 49, 65)
    assert depth.dtype == np.float32
    np.testing.assert_allclose(depth[:, 24, 32], [1.5, 1.4, 1.3, 1.2], atol=1e-6)
    np.testing.assert_allclose(depth[:, 0, 0], [3.0, 2.9, 2.8, 2.7], atol=1e-6)


def test_truth_of_a_pixel(wall: bv.World) -> None:
    channels = ("rgb", "depth", "range", "normal", "instance", "class", "incidence")
    frames = bv.Camera(65, 49, fov=1.0).render(wall, HERE, channels=channels)
    assert frames["rgb"].shape == (49, 65, 3)
    assert frames["depth"][24, 32] == frames["range"][24, 32] == 1.5
    np.testing.assert_allclose(frames["normal"][24, 32], [-1, 0, 0], atol=1e-6)
    assert frames["class"][24, 32] == 9
    assert frames["class"][0, 0] == 7
    assert wall.bodies[wall.instance_bodies[frames["instance"][0, 0]]] == "wall"
    assert frames["incidence"][24, 32] == pytest.approx(0, abs=1e-3)
    red, _, blue = frames["rgb"][24, 32].astype(int)
    assert blue > red
    red, _, blue = frames["rgb"][0, 0].astype(int)
    assert red > blue


def test_matrices_are_poses(wall: bv.World) -> None:
    # A quarter turn to the left, half a metre to the right.
    half = math.sqrt(0.5)
    pose = [1.0, -0.5, 0.0, 0.0, 0.0, half, half]
    matrix = np.array([[0, -1, 0, 1.0], [1, 0, 0, -0.5], [0, 0, 1, 0], [0, 0, 0, 1]])
    camera = bv.Camera(32, 24, fov=1.2)
    by_pose = camera.render(wall, pose, channels=("rgb", "depth"))
    by_matrix = camera.render(wall, matrix, channels=("rgb", "depth"))
    np.testing.assert_array_equal(by_pose["rgb"], by_matrix["rgb"])
    np.testing.assert_allclose(by_pose["depth"], by_matrix["depth"], rtol=1e-5)


def test_points_are_where_depths_are(wall: bv.World) -> None:
    camera = bv.DepthCamera(65, 49, fov=1.0)
    frames = camera.render(wall, HERE, channels=("depth", "points", "depth_mm"))
    focal = 65 / (2 * math.tan(0.5))
    z = frames["depth"]
    columns, rows = np.meshgrid(np.arange(65) - 32, np.arange(49) - 24)
    expected = np.stack([columns * z / focal, rows * z / focal, z], axis=2)
    np.testing.assert_allclose(frames["points"], expected, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(frames["depth_mm"], z * 1000, atol=0.51)


def test_the_lidar_measures_all_round() -> None:
    world = bv.World()
    world.add_box((2, 2, 2), (0, 0, 0), name="room")
    scan = bv.Lidar(5, angles=(-math.pi, math.pi)).render(world, HERE)["range"]
    np.testing.assert_allclose(scan, [[1, 1, 1, 1, 1]], atol=1e-6)
    nothing = bv.Lidar(3, sees="visual", most=0.5).render(world, HERE)["range"]
    assert np.isposinf(nothing).all()


def test_every_scanner_has_frames(wall: bv.World) -> None:
    assert "vlp16" in bv.Scanner.presets()
    for preset in bv.Scanner.presets():
        scanner = bv.Scanner(preset, sees="all")
        frames = scanner.render(wall, HERE, channels=("range", "points", "time", "laser"))
        ranges, points = frames["range"][:, 0], frames["points"][:, 0]
        assert ranges.shape == frames["time"].shape == frames["laser"].shape
        hit = np.isfinite(ranges)
        assert hit.sum() > 10, preset
        # Ranges are measured from the origin of the firing, which is a little off the sensor's origin.
        assert np.abs(np.linalg.norm(points[hit], axis=1) - ranges[hit]).max() < 0.2, preset


def test_a_scanner_that_moves(wall: bv.World) -> None:
    scanner = bv.Scanner("rplidar_a1", sees="all")
    still = scanner.render(wall, HERE)["range"]
    moved = scanner.render(wall, HERE, after=[0.5, 0, 0, 0, 0, 0, 1])["range"]
    assert (np.isfinite(still) & np.isfinite(moved) & (still != moved)).any()


def about_z(angle: float) -> list[float]:
    return [0.0, 0.0, 0.0, 0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2)]


@pytest.mark.parametrize("angle", [0.04, 0.5, 2.0, 3.1, 4.0])
def test_a_scanner_that_turns(angle: float) -> None:
    world = bv.World()
    world.add_box((0.1, 4000, 4000), (10.05, 0, 0))
    scanner = bv.Scanner("vlp16")
    frames = scanner.render(world, HERE, after=about_z(angle), channels=("points", "time"))
    # A rotation by more than half a turn becomes a smaller one in the opposite direction.
    turned = (angle if angle <= math.pi else angle - 2 * math.pi) * frames["time"] / scanner.period
    x, y, _ = frames["points"][:, 0].T
    ahead = np.cos(turned) * x - np.sin(turned) * y
    hit = np.hypot(x, y) < 30
    assert hit.sum() > 3000
    # Ranges have noise; an error of the rotation grows with the lateral distance.
    side = (np.sin(turned) * x + np.cos(turned) * y)[hit]
    assert np.abs(np.polyfit(side, ahead[hit], 1)[0]) < 5e-4
    assert np.abs(ahead[hit] - 10).max() < 0.2


def test_bodies_that_turn_before_a_scanner() -> None:
    # A wall that revolves around the scanner: its link turns, and the wall is offset from the link.
    world = bv.World(
        """<robot name="door"><link name="leaf"><visual><origin xyz="10 0 0"/>
        <geometry><box size="0.1 20 20"/></geometry></visual></link></robot>"""
    )
    scanner = bv.Scanner("vlp16", sees="visual")
    there = {"door::leaf": about_z(2.0)}
    frames = scanner.render(
        world, HERE, bodies={"door::leaf": HERE}, after=HERE, bodies_after=there, channels=("points", "time")
    )
    turned = 2.0 * frames["time"] / scanner.period
    x, y, _ = frames["points"][:, 0].T
    hit = np.isfinite(x)
    assert hit.sum() > 1000
    assert np.abs(np.cos(turned) * x + np.sin(turned) * y - 9.95)[hit].max() < 0.2


def test_a_stereo_camera_without_its_projector_needs_texture() -> None:
    world = bv.World()
    world.add_box((0.1, 20, 20), pose=(2, 0, 0, 0, 0, 0, 1))
    found = {
        on: np.isfinite(
            bv.DepthCamera(120, 90, 1.0, model="d435", projector=on).render(world, [0, 0, 0, 0, 0, 0, 1])["depth"]
        )
        for on in (True, False)
    }
    assert found[True][:, 60:110].mean() > 0.98
    assert not found[False].any()
    with pytest.raises(ValueError, match="projector: a xtion cannot measure without its projector"):
        bv.DepthCamera(model="xtion", projector=False)


@pytest.mark.parametrize("model", bv.DepthCamera.models())
def test_every_model_has_noise_of_its_seed(wall: bv.World, model: str) -> None:
    camera = bv.DepthCamera(160, 120, fov=1.0, model=model)
    frames = camera.render(wall, np.tile(HERE, (3, 1)), seeds=np.array([4, 5, 4]))["depth"]
    np.testing.assert_array_equal(frames[0], frames[2])
    assert (frames[0] != frames[1]).any()
    valid = np.isfinite(frames[0])
    assert valid.mean() > 0.3
    true = camera.render(wall, HERE, channels=("true_depth",))["true_depth"]
    assert np.median(np.abs(frames[0] - true)[valid]) < 0.05


def test_a_model_has_its_own_size() -> None:
    assert bv.DepthCamera(model="kinect_v1").frame_shape == (480, 640)


def test_flow_is_how_far_points_move(wall: bv.World) -> None:
    camera = bv.Camera(65, 49, fov=1.0)
    before, after = poses_along_x(2)
    frames = camera.render(wall, before, after=after, channels=("flow",))
    focal = 65 / (2 * math.tan(0.5))
    # A point of the wall moves outwards as its distance falls from 3 m to 2.9 m.
    expected = (-32 / focal * 3.0) / 2.9 * focal + 32
    np.testing.assert_allclose(frames["flow"][0, 0, 0], expected, atol=1e-3)
    with pytest.raises(ValueError, match=r"channels: 'flow' needs the poses at another time: give after=poses"):
        camera.render(wall, before, channels=("flow",))


def test_bodies_elsewhere(wall: bv.World) -> None:
    camera = bv.DepthCamera(65, 49, fov=1.0)
    moves = poses_along_x(3)
    moves[:, 0] += 2.0
    frames = camera.render(wall, np.tile(HERE, (3, 1)), bodies={"ball": moves})["depth"]
    np.testing.assert_allclose(frames[:, 24, 32], [1.5, 1.6, 1.7], atol=1e-6)
    everybody = np.stack([wall.pose(body) for body in wall.bodies])
    everybody[1, 0] = 2.2
    frame = camera.render(wall, HERE, bodies=everybody)["depth"]
    np.testing.assert_array_equal(frame, frames[2])
    # The world itself is unchanged until it is modified.
    assert camera.render(wall, HERE)["depth"][24, 32] == 1.5
    wall.set_pose("ball", (2.2, 0, 0))
    np.testing.assert_array_equal(camera.render(wall, HERE)["depth"], frames[2])


@pytest.mark.parametrize(
    "lens",
    [
        bv.Lens.pinhole(50, 50, 31.5, 23.5),
        bv.Lens.brown_conrady(50, 50, 31.5, 23.5, (-0.2, 0.05, 0, 0)),
        bv.Lens.kannala_brandt(20, 20, 31.5, 23.5),
        bv.Lens.eucm(20, 20, 31.5, 23.5, 0.6, 1.1),
        bv.Lens.double_sphere(20, 20, 31.5, 23.5, -0.2, 0.55),
        bv.Lens.mei(20, 20, 31.5, 23.5, 0.8),
        bv.Lens.equirectangular(64, 48),
    ],
    ids=lambda lens: lens.model,
)
def test_lenses_see_the_ball_ahead(wall: bv.World, lens: bv.Lens) -> None:
    frames = bv.DepthCamera(64, 48, lens=lens).render(wall, HERE, channels=("depth", "range", "class"))
    assert frames["class"][24, 32] == 9
    # The pixel is a little off the axis, at an angle that depends on the lens.
    assert frames["range"][24, 32] == pytest.approx(1.5, abs=0.02)


def test_noise_and_devices(wall: bv.World) -> None:
    for camera in (bv.Camera(64, 48, 1.0, noise=0.02), bv.Camera(64, 48, 1.0, device="webcam")):
        frames = camera.render(wall, np.tile(HERE, (2, 1)), seeds=11)["rgb"]
        assert (frames[0] != frames[1]).any()
        np.testing.assert_array_equal(camera.render(wall, HERE, seeds=12)["rgb"], frames[1])
    assert bv.Camera(8, 6, 1.0, grey=True).render(wall, HERE)["rgb"].shape == (6, 8)


def test_frames_in_jupyter(wall: bv.World) -> None:
    frames = bv.DepthCamera(64, 48, 1.0).render(wall, poses_along_x(3))
    file = frames._repr_png_()
    assert file is not None
    assert file.startswith(b"\x89PNG\r\n\x1a\n")
    width, height = int.from_bytes(file[16:20], "big"), int.from_bytes(file[20:24], "big")
    assert (width, height) == (3 * 64, 48)
    assert frames.picture("depth", 1).shape == (48, 64, 3)
    # The ball is near and red; the wall beside it is far and blue.
    near, far = frames.picture("depth")[24, 32].astype(int), frames.picture("depth")[4, 32].astype(int)
    assert near[0] > near[2]
    assert far[2] > far[0]
    assert "depth: float32[3, 48, 64]" in repr(frames)
    assert bv.Lidar(90).render(wall, HERE).picture().shape == (16, 90, 3)
    assert bv.Camera(8, 6, 1.0).render(wall, np.empty((0, 7)))._repr_png_() is None
    with pytest.raises(ValueError, match="channel: one of depth is expected"):
        frames.picture("rgb")
    with pytest.raises(ValueError, match="index: 3 is not within"):
        frames.picture("depth", 3)
    with pytest.raises(ValueError, match="above: frames of a Lidar or a Scanner"):
        frames.above()


def size(file: bytes | None) -> tuple[int, int]:
    assert file is not None
    return int.from_bytes(file[16:20], "big"), int.from_bytes(file[20:24], "big")


def test_rays_in_jupyter(wall: bv.World) -> None:
    random = np.random.default_rng(0)
    for shape, expected in [((48, 64), (64, 48)), ((50,), (50, 16)), ((), (16, 16)), ((2, 48, 64), (128, 48))]:
        hits = wall.cast((0, 0, 0), random.normal(size=(*shape, 3)))
        assert size(hits._repr_png_()) == expected
        for channel in hits:
            shown = hits.picture(channel, (0,) * len(hits.lead))
            assert shown.shape[:2] == (expected[1], expected[0] // 2 if len(shape) == 3 else expected[0])
    assert wall.cast((0, 0, 0), np.zeros((0, 3)))._repr_png_() is None


def test_scans_in_jupyter(wall: bv.World) -> None:
    # The wall is 3 m ahead, so it is drawn above the middle; there is nothing behind.
    for sensor in (bv.Lidar(3000, angles=(-1, 1)), bv.Scanner("vlp16"), bv.Scanner("mid360", returns="dual")):
        for channels in (("range",), sensor.channels[:3], ("intensity",)):
            frames = sensor.render(wall, HERE, channels=channels)
            assert size(frames._repr_png_()) == (481, 481)
            for channel in channels:
                assert frames.above(channel).shape == (481, 481, 3)
        seen = (frames.above() < 190).any(axis=2)
        assert seen[:230].any()
        again = pickle.loads(pickle.dumps(frames))
        np.testing.assert_array_equal(again.above(), frames.above())
    assert bv.Scanner("vlp16").render(wall, HERE, channels=("time", "laser")).picture().shape == (481, 481, 3)
    sheet = bv.Lidar(3000, 4).render(wall, poses_along_x(2), channels="class")
    assert sheet.picture("class", 1).shape == (16, 3000, 3)


@pytest.mark.parametrize(
    "sensor",
    [
        bv.Camera(8, 6, lens=bv.Lens.kannala_brandt(4, 4, 3.5, 2.5), noise=0.1),
        bv.DepthCamera(16, 12, 1.0, model="d435"),
        bv.Lidar(9, 2, elevations=(-0.1, 0.1), noise=0.1),
        bv.Scanner("rplidar_a1", sees="all"),
    ],
    ids=lambda sensor: type(sensor).__name__,
)
def test_sensors_are_pickled_and_copied(wall: bv.World, sensor: bv.Sensor) -> None:
    expected = sensor.render(wall, HERE, seeds=3)
    for other in (pickle.loads(pickle.dumps(sensor)), copy.deepcopy(sensor)):
        again = other.render(wall, HERE, seeds=3)
        for channel, values in expected.items():
            np.testing.assert_array_equal(again[channel], values)


def test_a_depth_camera_sees_meshes_whichever_way_their_triangles_run() -> None:
    corners = [[2, 3, 3], [2, -3, 3], [2, -3, -3], [2, 3, -3]]
    counter_clockwise = [[0, 2, 1], [0, 3, 2]]
    clockwise = [triangle[::-1] for triangle in counter_clockwise]
    for faces, seen in (("both", [2.0, 2.0]), ("front", [2.0, np.inf])):
        camera = bv.DepthCamera(17, 13, fov=1.0, faces=faces)
        found = []
        for triangles in (counter_clockwise, clockwise):
            world = bv.World()
            world.add_mesh(corners, triangles, color=(1, 0, 0))
            frames = camera.render(world, HERE, channels=("depth", "true_depth", "points", "rgb", "instance"))
            depth = frames["depth"].reshape(13, 17)
            assert np.array_equal(depth, frames["true_depth"].reshape(13, 17))
            is_seen = np.isfinite(depth)
            assert np.array_equal(is_seen, np.isfinite(frames["points"][..., 2].reshape(13, 17)))
            assert np.array_equal(is_seen, frames["instance"].reshape(13, 17) == 0)
            # The colour belongs to the surface whose depth is measured.
            red, green, _ = np.moveaxis(frames["rgb"].reshape(13, 17, 3).astype(int), -1, 0)
            assert np.array_equal(is_seen, red > green)
            found.append(float(depth[6, 8]))
        assert found == pytest.approx(seen, rel=1e-6)
    assert bv.DepthCamera(8, 6, fov=1.0).render(world, HERE)["depth"].max() < 3  # "both" is the default
    with pytest.raises(ValueError, match="faces"):
        bv.DepthCamera(8, 6, fov=1.0, faces="back")
