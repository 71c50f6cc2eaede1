"""Invalid arguments: a ValueError names the argument, nothing crashes, and nothing is partly written."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import belvedere as bv

if TYPE_CHECKING:
    from collections.abc import Callable

HERE = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
#: Settings that give the same inputs on each run.
quick = settings(
    max_examples=60, deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck)
)


@pytest.fixture(scope="module")
def world() -> bv.World:
    world = bv.World()
    world.add_box((1, 1, 1), (3, 0, 0), name="box")
    return world


CAMERA = bv.DepthCamera(8, 6, fov=1.0)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"poses": [1, 2, 3]}, r"poses: shape \(3,\); \(…, 7\), x y z qx qy qz qw, or \(…, 4, 4\)"),
        ({"poses": "here"}, r"poses: an array of float64 is expected"),
        ({"poses": [[0, 0, np.nan, 0, 0, 0, 1]]}, r"poses: pose 0 is not finite"),
        ({"poses": [HERE, [0, 0, 0, 0, 0, 0, 0]]}, r"poses: pose 1 has a quaternion .* whose length is not 1"),
        ({"poses": np.zeros((4, 4))}, r"poses: matrix 0 does not end in the row 0 0 0 1"),
        ({"poses": np.diag([1, 1, 2, 1])}, r"poses: matrix 0 has no rotation"),
        ({"channels": ("depht",)}, r"channels: there is no channel 'depht'; there are depth, depth_mm"),
        ({"channels": ()}, r"channels: none is requested"),
        (
            {"out": {"depth": np.zeros((1, 6, 8))}},
            r"out\['depth'\]: shape \(1, 6, 8\) of float64; \(6, 8\) of float32",
        ),
        ({"out": {"depth": np.zeros((6, 16), np.float32)[:, ::2]}}, r"out\['depth'\]: strides .* without gaps"),
        ({"out": {"depth": [[0.0]]}}, r"out\['depth'\]: an array of numpy"),
        (
            {"out": {"depth": np.zeros((6, 8), np.float32)}, "channels": ("rgb",)},
            r"out\['depth'\]: this channel is not among",
        ),
        ({"seeds": [1, 2]}, r"seeds: shape \(2,\)"),
        ({"seeds": -1}, r"seeds: a whole number from 0 to"),
        ({"bodies": {"bix": HERE}}, r"bodies: there is no body 'bix'; there are box"),
        ({"bodies": {3: HERE}}, r"bodies: there is no body 3; there are 1"),
        ({"bodies": {"box": [HERE, HERE]}}, r"bodies\['box'\]: poses of shape \(2,\); \(\) is expected"),
        ({"bodies": [HERE, HERE]}, r"bodies: poses of shape \(2,\); \(1,\) is expected"),
        ({"bodies": {"box": [0, 0, np.inf, 0, 0, 0, 1]}}, r"bodies\['box'\]: pose 0 is not finite"),
        ({"bodies": [[0, 0, np.inf, 0, 0, 0, 1]]}, r"bodies: pose 0, of body 'box', is not finite"),
        ({"poses": np.full((2, 3, 7), np.nan)}, r"poses: pose \[0, 0\] is not finite"),
        ({"out": np.zeros((6, 8), np.float32)}, "out: a dictionary of arrays by channel is expected, not ndarray"),
        ({"out": [1]}, "out: a dictionary of arrays by channel is expected, not list"),
        ({"channels": 3}, "channels: names of channels are expected, not 3"),
        ({"bodies": {"box": HERE, 0: HERE}}, r"bodies: a body is named twice"),
        ({"after": [HERE, HERE]}, r"after: poses of shape \(2,\); \(\), as poses, is expected"),
        ({"bodies_after": {"box": HERE}}, r"bodies_after: after=poses is expected"),
        ({"threads": 0}, r"threads: a whole number from 1 to 1024 is expected, not 0"),
    ],
)
def test_arguments_of_a_batch(world: bv.World, arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        CAMERA.render(world, **{"poses": HERE, **arguments})


def test_memory_that_cannot_be_written_to(world: bv.World) -> None:
    memory = np.zeros((6, 8), np.float32)
    memory.flags.writeable = False
    with pytest.raises(ValueError, match=r"out\['depth'\]: it is read-only"):
        CAMERA.render(world, HERE, out={"depth": memory})
    same = np.zeros((6, 8), np.float32)
    with pytest.raises(ValueError, match=r"out\[.*\]: .*already borrowed.*nothing else uses"):
        CAMERA.render(world, HERE, out={"depth": same, "true_depth": same})
    assert (same == 0).all()
    with pytest.raises(ValueError, match="world: a World is expected, not int"):
        CAMERA.render(3, HERE)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: bv.Camera(0, 5, 1.0), "width: a whole number from 1 to 16384 is expected, not 0"),
        (lambda: bv.Camera(8, 5.5, 1.0), "height: a whole number"),  # type: ignore[arg-type]
        (lambda: bv.Camera(8, 6), "fov, lens: one of the two is expected"),
        (lambda: bv.Camera(8, 6, 4.0), "^fov: an angle in radians between 0 and π is expected, not 4"),
        (lambda: bv.Camera(8, 6, 60), "^fov: an angle in radians between 0 and π is expected, not 60"),
        (
            lambda: bv.DepthCamera(4, 4, 1e-9, model="d435"),
            "^fov: d435 takes focal lengths of .* pixels, not 4.000e9",
        ),
        (lambda: bv.Camera(8, 6, 1.0, device=3), "^device: a text is expected, not 3"),  # type: ignore[arg-type]
        (lambda: bv.Camera(8, 6, lens="pinhole"), "^lens: a Lens is expected, .*, not 'pinhole'"),  # type: ignore[arg-type]
        (
            lambda: bv.Camera(8, 6, lens=bv.Lens("kanala_brandt", (9,) * 9)),
            '^lens: .*no model "kanala_brandt"; .* mei',
        ),
        (
            lambda: bv.Camera(8, 6, lens=bv.Lens("kannala_brandt", (20, 20, 3, 3, 0, 0.1, 0, 0))),
            "^lens: kannala_brandt: fx fy cx cy skew k1 k2 k3 k4 are expected, not 8 numbers",
        ),
        (lambda: bv.Camera(8, 6, lens=bv.Lens("pinhole", (1, 1))), "^lens: pinhole: .* not 2 numbers"),
        (lambda: bv.Lens.kannala_brandt(1, 1, 1, 1, k=3), "^k: shape"),  # type: ignore[arg-type]
        (lambda: bv.Camera(8, 6, 1.0, near=2.0, far=1.0), "near_m of the camera is 2"),
        (lambda: bv.Camera(8, 6, 1.0, exposure=-1), "exposure of the camera is -1"),
        (lambda: bv.Camera(8, 6, 1.0, noise=float("nan")), "noise: a number is expected"),
        (lambda: bv.Camera(8, 6, 1.0, device="phone"), "device: .*webcam, machine_vision"),
        (lambda: bv.DepthCamera(8, 6, 1.0, model="kinekt"), "model: one of kinect_v1"),
        (lambda: bv.DepthCamera(), "width, height: two whole numbers"),
        (lambda: bv.DepthCamera(8, 6, 1.0, least=2, most=1), "min_depth_m of the depth camera is 2"),
        (lambda: bv.DepthCamera(model="kinect_v1", noise=0.1), "noise: the model has its own"),
        (lambda: bv.Lidar(0), "beams: a whole number"),
        (lambda: bv.Lidar(5, angles=(1, -1)), "horizontal.max_angle_rad of the lidar is -1"),
        (lambda: bv.Lidar(5, least=3, most=2), "range_min_m of the lidar is 3"),
        (lambda: bv.Lidar(5, sees="nothing"), "sees: one of visual, collision, all is expected"),
        (lambda: bv.Scanner(None), "^preset: a text is expected, not None"),  # type: ignore[arg-type]
        (lambda: bv.Scanner("vlp16", columns=100), "^columns: vlp16 has no choice of columns"),
        (
            lambda: bv.Scanner("os1_64", columns=2048, rate=20),
            "^columns: os1_64 has no such mode: .*, 2048 at 10, not 2048 at 20",
        ),
        (lambda: bv.Scanner("vlp"), 'preset: there is none called "vlp"; there are '),
        (lambda: bv.Scanner(bv.Scanner.presets()[0], returns="some"), "returns: strongest, first"),
        (lambda: bv.Scanner(bv.Scanner.presets()[0], rate=1e9), "rate: .* has no such mode"),
        (lambda: bv.Lens.kannala_brandt(0, 1, 2, 3), None),
        (lambda: bv.Camera(8, 6, lens=bv.Lens.kannala_brandt(0, 1, 2, 3)), "lens: .*fx"),
    ],
)
def test_invalid_sensors(make: Any, words: str | None) -> None:
    if words is None:
        make()
        return
    with pytest.raises(ValueError, match=words):
        make()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"directions": [[0, 0, 0]]}, "directions: that of ray 0 is 0 0 0"),
        ({"directions": [[0, 0, np.nan]]}, "directions: that of ray 0 is not finite"),
        ({"origins": [[0, 0]]}, r"origins: shape \(1, 2\); \(…, 3\) is expected"),
        ({"origins": [[0, 0, 0]] * 2}, r"origins: shape \(2, 3\); \(1, 3\), as directions, or \(3,\)"),
        ({"ranges": [[2.0, 1.0]]}, "ranges: of ray 0, 0 <= 2 < 1 does not hold"),
        ({"ranges": [1.0, 2.0]}, r"ranges: shape \(2,\)"),
        ({"faces": "back"}, "faces: one of front, both is expected"),
    ],
)
def test_arguments_of_a_cast(world: bv.World, arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        world.cast(**{"origins": (0, 0, 0), "directions": [[1, 0, 0]], **arguments})


def refused(act: Callable[[], object], *arguments: str) -> bool:
    """Return True if the call raises a ValueError that begins with one of these arguments."""
    try:
        act()
    except ValueError as error:
        named = re.match(r"\w+", str(error))
        assert named is not None and named[0] in arguments, error  # noqa: PT017, PT018
        return True
    return False


anything = st.one_of(
    st.none(),
    st.integers(),
    st.floats(),
    st.text(max_size=4),
    arrays.arrays(
        st.sampled_from([np.float64, np.float32, np.int32, np.uint8, np.bool_, np.complex64, "S3"]),
        arrays.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=7),
    ),
)


@quick
@given(poses=anything, seeds=anything, bodies=anything, after=anything)
def test_any_poses(poses: Any, seeds: Any, bodies: Any, after: Any) -> None:
    world = bv.World()
    world.add_sphere(1, (3, 0, 0))
    memory = np.full((6, 8), 7.0, np.float32)
    if refused(
        lambda: CAMERA.render(world, poses, {"depth": memory}, seeds=seeds, bodies=bodies, after=after),
        *("poses", "seeds", "bodies", "after", "out"),
    ):
        assert (memory == 7).all()


@quick
@given(
    vertices=arrays.arrays(np.float64, st.tuples(st.integers(0, 9), st.integers(2, 4))),
    faces=arrays.arrays(np.int64, st.tuples(st.integers(0, 5), st.integers(2, 4)), elements=st.integers(-2, 9)),
    uvs=st.one_of(st.none(), anything),
    normals=st.one_of(st.none(), anything, arrays.arrays(np.float64, st.tuples(st.integers(0, 9), st.just(3)))),
)
def test_any_mesh(vertices: Any, faces: Any, uvs: Any, normals: Any) -> None:
    world = bv.World()
    names = ("vertices", "faces", "uvs", "normals")
    if refused(lambda: world.add_mesh(vertices, faces, uvs=uvs, normals=normals), *names):
        assert world.bodies == []
    CAMERA.render(world, HERE, channels=("depth", "rgb", "normal"))


@quick
@given(size=anything, pose=anything, color=anything, scale=anything)
def test_any_shape(size: Any, pose: Any, color: Any, scale: Any) -> None:
    world = bv.World()
    if refused(lambda: world.add_box(size, pose, color=color, scale=scale), "size", "pose", "color", "scale"):
        assert world.bodies == []
    CAMERA.render(world, HERE)


@quick
@given(origins=anything, directions=anything, ranges=anything)
def test_any_rays(origins: Any, directions: Any, ranges: Any) -> None:
    world = bv.World()
    world.add_sphere(1, (3, 0, 0))
    refused(lambda: world.cast(origins, directions, ranges=ranges), "origins", "directions", "ranges")


@quick
@given(text=st.text(max_size=60))
def test_any_description(text: str) -> None:
    with pytest.raises(ValueError, match=r".+"):
        bv.World("<" + text)
