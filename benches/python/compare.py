"""Belvedere beside what a user would pick instead: the same scenes, poses and outputs, one run, ratios.

    python benches/python/compare.py [--seconds 1.0] [--threads 1,2]

Peers that are not installed are named and left out: open3d (or open3d-cpu), embreex with trimesh, mujoco, pybullet,
pyrender.
Rates are the median of some rounds in which everybody takes turns, so that whatever else the machine does meets all alike.
"""

from __future__ import annotations

import argparse
import math
import os
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, field

# Before anything starts threads.
os.environ.setdefault("MUJOCO_GL", "egl")
os.environ.setdefault("PYOPENGL_PLATFORM", "egl")
os.environ.setdefault("LP_NUM_THREADS", "1")

import numpy as np

import belvedere as bv

FOV = 1.2  # horizontal, radians


@dataclass
class Part:
    """Triangles of a body, and what else it is for peers that have shapes of their own."""

    vertices: np.ndarray
    faces: np.ndarray
    shape: tuple[str, tuple[float, ...]] | None
    pose: np.ndarray


@dataclass
class Scene:
    """What all of them see, and from where."""

    name: str
    parts: list[Part]
    poses: np.ndarray = field(default_factory=lambda: np.zeros((0, 7)))
    #: Belvedere's own, of shapes where there are shapes.
    world: bv.World = field(default_factory=bv.World)

    @property
    def triangles(self) -> int:
        return sum(len(part.faces) for part in self.parts)

    def soup(self) -> tuple[np.ndarray, np.ndarray]:
        """All triangles in the world."""
        vertices, faces, first = [], [], 0
        for part in self.parts:
            vertices.append(part.vertices @ rotation(part.pose[3:]).T + part.pose[:3])
            faces.append(part.faces + first)
            first += len(part.vertices)
        return np.concatenate(vertices).astype(np.float32), np.concatenate(faces).astype(np.uint32)


def rotation(q: np.ndarray) -> np.ndarray:
    x, y, z, w = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def sphere(radius: float, around: int, down: int) -> tuple[np.ndarray, np.ndarray]:
    """A ball of triangles."""
    rows = np.linspace(0, math.pi, down + 1)
    columns = np.linspace(0, 2 * math.pi, around, endpoint=False)
    ring = np.stack([np.cos(columns), np.sin(columns)], axis=1)
    vertices = [np.concatenate([ring * math.sin(row), np.full((around, 1), math.cos(row))], axis=1) for row in rows]
    faces = []
    for row in range(down):
        for column in range(around):
            a, b = row * around + column, row * around + (column + 1) % around
            c, d = a + around, b + around
            if row > 0:
                faces.append((a, c, b))
            if row < down - 1:
                faces.append((b, c, d))
    return np.concatenate(vertices) * radius, np.array(faces)


def box(size: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]) * size
    faces = [
        (0, 1, 3),
        (0, 3, 2),
        (4, 6, 7),
        (4, 7, 5),
        (0, 4, 5),
        (0, 5, 1),
        (2, 3, 7),
        (2, 7, 6),
        (0, 2, 6),
        (0, 6, 4),
        (1, 5, 7),
        (1, 7, 3),
    ]
    return corners, np.array(faces)


def pose(x: float, y: float, z: float) -> np.ndarray:
    return np.array([x, y, z, 0, 0, 0, 1.0])


def look_at(eye: np.ndarray, target: np.ndarray) -> np.ndarray:
    """A sensor's pose: +x to the target, z up."""
    x = (target - eye) / np.linalg.norm(target - eye)
    y = np.cross([0, 0, 1.0], x)
    y /= np.linalg.norm(y)
    m = np.stack([x, y, np.cross(x, y)], axis=1)
    # The largest of the four parts first: any rotation.
    w = math.sqrt(max(0.0, 1 + m[0, 0] + m[1, 1] + m[2, 2])) / 2
    qx = math.copysign(math.sqrt(max(0.0, 1 + m[0, 0] - m[1, 1] - m[2, 2])) / 2, m[2, 1] - m[1, 2])
    qy = math.copysign(math.sqrt(max(0.0, 1 - m[0, 0] + m[1, 1] - m[2, 2])) / 2, m[0, 2] - m[2, 0])
    qz = math.copysign(math.sqrt(max(0.0, 1 - m[0, 0] - m[1, 1] + m[2, 2])) / 2, m[1, 0] - m[0, 1])
    return np.array([*eye, qx, qy, qz, w])


def around(target: tuple[float, float, float], radius: float, height: float, count: int = 32) -> np.ndarray:
    angles = np.linspace(0, 2 * math.pi, count, endpoint=False)
    at = np.array(target)
    return np.stack([look_at(at + [radius * math.cos(a), radius * math.sin(a), height], at) for a in angles])


def balls() -> Scene:
    """40 balls on a plane: the scene of the issue's figures."""
    random = np.random.default_rng(3)
    scene = Scene("40 balls on a plane", [])
    scene.world.add_rectangle((20, 20), name="ground")
    scene.parts.append(
        Part(
            np.array([[-10, -10, 0], [10, -10, 0], [10, 10, 0], [-10, 10, 0.0]]),
            np.array([[0, 1, 2], [0, 2, 3]]),
            ("plane", (10, 10)),
            pose(0, 0, 0),
        )
    )
    for index in range(40):
        radius = random.uniform(0.15, 0.45)
        at = pose(*random.uniform(-3, 3, 2), radius)
        scene.world.add_sphere(radius, at, name=f"ball{index}")
        scene.parts.append(Part(*sphere(radius, 20, 11), ("sphere", (radius,)), at))
    scene.poses = around((0, 0, 0.3), 4.0, 1.5)
    return scene


def humanoid() -> Scene:
    """A stand-in of a humanoid: 31 bodies of meshes over a height field. No shapes: meshes for everybody."""
    random = np.random.default_rng(4)
    scene = Scene("humanoid of 31 meshes over terrain", [])
    size, cells = 8.0, 64
    rows = np.linspace(-size / 2, size / 2, cells + 1)
    x, y = np.meshgrid(rows, rows[::-1])
    heights = (0.12 * np.sin(2.1 * x) * np.cos(1.7 * y) + 0.03 * random.normal(size=x.shape)).astype(np.float32)
    scene.world.add_height_field(heights, (size, size), name="terrain")
    vertices = np.stack([x.ravel(), y.ravel(), heights.ravel()], axis=1)
    faces = []
    for row in range(cells):
        for column in range(cells):
            a = row * (cells + 1) + column
            # Cut as Belvedere cuts its cells.
            faces += [(a, a + cells + 1, a + 1), (a + 1, a + cells + 1, a + cells + 2)]
    scene.parts.append(Part(vertices, np.array(faces), None, pose(0, 0, 0)))
    limbs = [((0, 0, 0.95), 0.14, 2.0), ((0, 0, 1.15), 0.15, 2.0), ((0, 0, 1.5), 0.11, 1.2)]
    for side in (-1, 1):
        limbs += [((0, side * 0.09, 0.85 - 0.11 * step), 0.07, 1.8) for step in range(7)]
        limbs += [((0.05 * step, side * (0.2 + 0.01 * step), 1.25 - 0.09 * step), 0.05, 1.8) for step in range(7)]
    for index, (at, radius, stretch) in enumerate(limbs):
        points, triangles = sphere(radius, 48, 26)
        points = points * (1 + 0.02 * random.normal(size=(len(points), 1))) * (1, 1, stretch * 0.6)
        where = pose(*at)
        scene.world.add_mesh(points, triangles, where, name=f"limb{index}")
        scene.parts.append(Part(points, triangles, None, where))
    scene.poses = around((0, 0, 0.8), 2.5, 0.4)
    return scene


def room() -> Scene:
    """A room of boxes."""
    random = np.random.default_rng(5)
    scene = Scene("room of 30 boxes", [])
    boxes = [((6, 5, 0.1), (0, 0, -0.05)), ((6, 5, 0.1), (0, 0, 2.55))]
    boxes += [((0.1, 5, 2.5), (side * 3.0, 0, 1.25)) for side in (-1, 1)]
    boxes += [((6, 0.1, 2.5), (0, side * 2.5, 1.25)) for side in (-1, 1)]
    for _ in range(24):
        size = random.uniform(0.2, 0.9, 3)
        boxes.append((tuple(size), (*random.uniform((-2.5, -2), (2.5, 2)), size[2] / 2)))
    for index, (size, at) in enumerate(boxes):
        scene.world.add_box(size, pose(*at), name=f"box{index}")
        scene.parts.append(Part(*box(size), ("box", tuple(edge / 2 for edge in size)), pose(*at)))
    scene.poses = around((0, 0, 1.0), 1.2, 0.6)
    return scene


def warehouse() -> Scene:
    """One mesh of 100,000 triangles: shelves of boxes and drums."""
    random = np.random.default_rng(6)
    points, triangles, first = [], [], 0
    for row in range(10):
        for place in range(25):
            for level in range(4):
                at = np.array([row * 3.0 - 13.5, place * 1.2 - 14.4, 0.5 + level])
                made = box(tuple(random.uniform(0.5, 0.9, 3))) if (row + place + level) % 2 else sphere(0.4, 14, 14)
                points.append(made[0] + at)
                triangles.append(made[1] + first)
                first += len(made[0])
    ground = box((40, 40, 0.1))
    points.append(ground[0])
    triangles.append(ground[1] + first)
    vertices, faces = np.concatenate(points), np.concatenate(triangles)
    scene = Scene(f"warehouse of {len(faces):,} triangles", [Part(vertices, faces, None, pose(0, 0, 0))])
    scene.world.add_mesh(vertices, faces, name="warehouse")
    scene.poses = around((0, 0, 1.0), 6.0, 1.5)
    return scene


def rays_of(scene: Scene, width: int, height: int) -> list[np.ndarray]:
    """Rays (height·width, 6) of each pose; their directions are 1 long along the optical axis: t is the depth."""
    focal = width / (2 * math.tan(FOV / 2))
    columns, rows = np.meshgrid(np.arange(width) - (width - 1) / 2, np.arange(height) - (height - 1) / 2)
    local = np.stack([np.ones_like(columns), -columns / focal, -rows / focal], axis=2).reshape(-1, 3)
    rays = []
    for at in scene.poses:
        directions = local @ rotation(at[3:]).T
        origins = np.broadcast_to(at[:3], directions.shape)
        rays.append(np.ascontiguousarray(np.concatenate([origins, directions], axis=1), dtype=np.float32))
    return rays


#: Takes a number of frames; the first frame's depth, if it is one that can be compared.
Take = Callable[[int], np.ndarray | None]


def belvedere(scene: Scene, width: int, height: int, threads: int, channels: tuple[str, ...]) -> Take:
    camera = bv.DepthCamera(width, height, fov=FOV)
    shape = (len(scene.poses), height, width)
    out = {"depth": np.empty(shape, np.float32)}
    if "rgb" in channels:
        out["rgb"] = np.empty((*shape, 3), np.uint8)

    def take(count: int) -> np.ndarray:
        for _ in range(0, count, len(scene.poses)):
            camera.render(scene.world, scene.poses, out=out, threads=threads)
        return out["depth"][0]

    return take


def open3d(scene: Scene, width: int, height: int, threads: int, channels: tuple[str, ...]) -> Take:
    import open3d as o3d

    ray_scene = o3d.t.geometry.RaycastingScene(nthreads=threads)
    vertices, faces = scene.soup()
    ray_scene.add_triangles(o3d.core.Tensor(vertices), o3d.core.Tensor(faces))
    # Rays are made beforehand: what is timed is what the tree does.
    rays = [o3d.core.Tensor(one.reshape(height, width, 6)) for one in rays_of(scene, width, height)]

    def take(count: int) -> np.ndarray:
        for index in range(count):
            hits = ray_scene.cast_rays(rays[index % len(rays)], nthreads=threads)
        return ray_scene.cast_rays(rays[0], nthreads=threads)["t_hit"].numpy() if count else hits

    return take


def embreex(scene: Scene, width: int, height: int, threads: int, channels: tuple[str, ...]) -> Take:
    if threads != 1:
        raise NotImplementedError("one thread alone")
    from embreex import rtcore_scene
    from embreex.mesh_construction import TriangleMesh

    vertices, faces = scene.soup()
    embree = rtcore_scene.EmbreeScene()
    TriangleMesh(embree, vertices, faces.astype(np.int32))
    rays = [
        (np.ascontiguousarray(one[:, :3]), np.ascontiguousarray(one[:, 3:]))
        for one in rays_of(scene, width, height)
    ]

    def take(count: int) -> np.ndarray:
        for index in range(count):
            embree.run(*rays[index % len(rays)], query="DISTANCE")
        return np.asarray(embree.run(*rays[0], query="DISTANCE")).reshape(height, width)

    return take


def mujoco_model(scene: Scene, width: int, height: int):
    import mujoco

    spec = mujoco.MjSpec()
    spec.visual.global_.offwidth, spec.visual.global_.offheight = width, height
    spec.visual.global_.fovy = math.degrees(2 * math.atan(math.tan(FOV / 2) * height / width))
    spec.visual.quality.offsamples = 0
    spec.visual.map.znear, spec.visual.map.zfar = 0.01, 50.0
    for index, part in enumerate(scene.parts):
        body = spec.worldbody.add_body(pos=part.pose[:3], quat=np.roll(part.pose[3:], 1))
        geom = body.add_geom(contype=0, conaffinity=0)
        if part.shape is None:
            spec.add_mesh(
                name=f"mesh{index}", uservert=part.vertices.ravel().tolist(), userface=part.faces.ravel().tolist()
            )
            geom.type, geom.meshname = mujoco.mjtGeom.mjGEOM_MESH, f"mesh{index}"
        else:
            kind, size = part.shape
            geom.type = {
                "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
                "box": mujoco.mjtGeom.mjGEOM_BOX,
                "plane": mujoco.mjtGeom.mjGEOM_PLANE,
            }[kind]
            geom.size = [*size, 0.1, 0.1][:3]
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return mujoco, model, data


def mj_multi_ray(scene: Scene, width: int, height: int, threads: int, channels: tuple[str, ...]) -> Take:
    if threads != 1:
        raise NotImplementedError("one thread alone")
    mujoco, model, data = mujoco_model(scene, width, height)
    rays = rays_of(scene, width, height)
    count = width * height
    ids, distances = np.zeros(count, np.int32), np.zeros(count)
    units = [
        np.ascontiguousarray(one[:, 3:] / np.linalg.norm(one[:, 3:], axis=1, keepdims=True), dtype=np.float64)
        for one in rays
    ]
    lengths = np.linalg.norm(rays[0][:, 3:], axis=1)

    def cast(index: int) -> None:
        at = scene.poses[index % len(rays)][:3]
        mujoco.mj_multiRay(
            model, data, at, units[index % len(rays)].ravel(), None, 1, -1, ids, distances, None, count, 100.0
        )

    def take(frames: int) -> np.ndarray:
        for index in range(frames):
            cast(index)
        cast(0)
        return np.where(distances < 0, np.inf, distances / lengths).reshape(height, width)

    return take


def mujoco_renderer(scene: Scene, width: int, height: int, threads: int, channels: tuple[str, ...]) -> Take:
    if threads != 1:
        raise NotImplementedError("LP_NUM_THREADS=1")
    mujoco, model, data = mujoco_model(scene, width, height)
    renderer = mujoco.Renderer(model, height, width)
    camera = mujoco.MjvCamera()

    def draw(index: int, depth: bool) -> np.ndarray:
        at = scene.poses[index % len(scene.poses)]
        forward = rotation(at[3:])[:, 0]
        camera.lookat, camera.distance = at[:3] + forward, 1.0
        camera.azimuth, camera.elevation = (
            math.degrees(math.atan2(forward[1], forward[0])),
            math.degrees(math.asin(forward[2])),
        )
        renderer.update_scene(data, camera)
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = 0
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = 0
        (renderer.enable_depth_rendering if depth else renderer.disable_depth_rendering)()
        return renderer.render()

    def take(count: int) -> np.ndarray:
        for index in range(count):
            depth = draw(index, True)
            if "rgb" in channels:
                draw(index, False)
        return draw(0, True) if count else depth

    return take


def pybullet(scene: Scene, width: int, height: int, threads: int, channels: tuple[str, ...]) -> Take:
    if threads != 1:
        raise NotImplementedError("one thread alone")
    import pybullet as p

    client = p.connect(p.DIRECT)
    for part in scene.parts:
        shape = p.createVisualShape(
            p.GEOM_MESH,
            vertices=part.vertices.tolist(),
            indices=part.faces.ravel().tolist(),
            physicsClientId=client,
        )
        p.createMultiBody(0, -1, shape, part.pose[:3].tolist(), part.pose[3:].tolist(), physicsClientId=client)
    near, far = 0.02, 100.0
    fovy = math.degrees(2 * math.atan(math.tan(FOV / 2) * height / width))
    projection = p.computeProjectionMatrixFOV(fovy, width / height, near, far)
    views = []
    for at in scene.poses:
        axes = rotation(at[3:])
        views.append(p.computeViewMatrix(at[:3].tolist(), (at[:3] + axes[:, 0]).tolist(), axes[:, 2].tolist()))

    def draw(index: int) -> np.ndarray:
        got = p.getCameraImage(
            width,
            height,
            views[index % len(views)],
            projection,
            shadow=0,
            renderer=p.ER_TINY_RENDERER,
            physicsClientId=client,
        )
        return np.asarray(got[3]).reshape(height, width)

    def take(count: int) -> np.ndarray:
        for index in range(count):
            draw(index)
        z = draw(0)
        return far * near / (far - (far - near) * z)

    return take


def pyrender(scene: Scene, width: int, height: int, threads: int, channels: tuple[str, ...]) -> Take:
    if threads != 1:
        raise NotImplementedError("LP_NUM_THREADS=1")
    import pyrender as pr
    import trimesh

    drawn = pr.Scene(ambient_light=(0.4, 0.4, 0.4))
    for part in scene.parts:
        at = np.eye(4)
        at[:3, :3], at[:3, 3] = rotation(part.pose[3:]), part.pose[:3]
        drawn.add(pr.Mesh.from_trimesh(trimesh.Trimesh(part.vertices, part.faces, process=False)), pose=at)
    node = drawn.add(pr.PerspectiveCamera(2 * math.atan(math.tan(FOV / 2) * height / width), znear=0.02, zfar=100))
    renderer = pr.OffscreenRenderer(width, height)
    flags = 0 if "rgb" in channels else pr.RenderFlags.DEPTH_ONLY
    # Looks along −z, y is up.
    turn = np.array([[0, 0, -1.0], [-1, 0, 0], [0, 1, 0]])

    def draw(index: int) -> np.ndarray:
        pose_of = np.eye(4)
        at = scene.poses[index % len(scene.poses)]
        pose_of[:3, :3], pose_of[:3, 3] = rotation(at[3:]) @ turn, at[:3]
        drawn.set_pose(node, pose_of)
        got = renderer.render(drawn, flags)
        return got if flags else got[1]

    def take(count: int) -> np.ndarray:
        for index in range(count):
            draw(index)
        depth = draw(0)
        return np.where(depth == 0, np.inf, depth)

    return take


PEERS = {
    "belvedere": belvedere,
    "open3d": open3d,
    "embreex": embreex,
    "mj_multiRay": mj_multi_ray,
    "mujoco.Renderer": mujoco_renderer,
    "pybullet": pybullet,
    "pyrender": pyrender,
}


def rate(take: Take, seconds: float) -> tuple[float, int]:
    """Frames a second, and how many were taken."""
    count, start = 32, time.perf_counter()
    take(count)
    first = time.perf_counter() - start
    count = max(1, min(100_000, int(count * seconds / max(first, 1e-9))))
    count = -(-count // 32) * 32 if count > 32 else count
    start = time.perf_counter()
    take(count)
    # A frame more is taken to be looked at; Belvedere takes whole batches.
    return count / (time.perf_counter() - start), count


def agreement(ours: np.ndarray, theirs: np.ndarray | None) -> str:
    """The share of pixels whose depths differ by less than 2 cm."""
    if theirs is None or theirs.shape != ours.shape:
        return "-"
    near = np.isclose(np.where(ours > 30, 99, ours), np.where(theirs > 30, 99, theirs), atol=0.02)
    return f"{near.mean():.0%}"


def compare(
    scene: Scene,
    size: tuple[int, int],
    channels: tuple[str, ...],
    threads: int,
    seconds: float,
    missing: dict[str, str],
) -> None:
    takes: dict[str, Take] = {}
    for name, make in PEERS.items():
        if name in missing or ("rgb" in channels and name in ("open3d", "embreex", "mj_multiRay")):
            continue
        try:
            takes[name] = make(scene, *size, threads, channels)
            takes[name](1)
        except NotImplementedError:
            takes.pop(name, None)
        except Exception as error:  # whatever a peer's installation lacks
            takes.pop(name, None)
            missing[name] = f"{type(error).__name__}: {str(error).splitlines()[0][:100] if str(error) else ''}"
    rates: dict[str, list[float]] = {name: [] for name in takes}
    for _ in range(3):
        for name, take in takes.items():
            rates[name].append(rate(take, seconds / 3)[0])
    ours = takes["belvedere"](1)
    base = statistics.median(rates["belvedere"])
    what = "RGB-D" if "rgb" in channels else "depth"
    for name, take in takes.items():
        own = statistics.median(rates[name])
        ratio = "" if name == "belvedere" else f"{base / own:10.1f}x"
        same = "" if name == "belvedere" else agreement(ours, take(1))
        print(
            f"| {scene.name} | {what} {size[0]}x{size[1]} | {threads} | {name} | {own:,.0f} | {ratio} | {same} |",
            flush=True,
        )


def overhead(scene: Scene, seconds: float) -> None:
    """What a call costs besides its frames: frames of 256 poses beside those of 4,096, one thread, 64x64."""
    camera = bv.DepthCamera(64, 64, fov=FOV)

    def frames_a_second(count: int) -> float:
        poses = np.resize(scene.poses, (count, 7))
        out = {"depth": np.empty((count, 64, 64), np.float32)}
        taken, start = 0, time.perf_counter()
        while time.perf_counter() - start < seconds:
            camera.render(scene.world, poses, out=out, threads=1)
            taken += count
        return taken / (time.perf_counter() - start)

    for count in (1, 16, 256):
        ratios = [frames_a_second(count) / frames_a_second(8192) for _ in range(3)]
        print(
            f"| calls of {count} frames beside calls of 8,192 | depth 64x64 | 1 | overhead | {1 - statistics.median(ratios):.1%} | | |"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=1.0, help="for each figure")
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--scene", default="", help="part of a scene's name")
    arguments = parser.parse_args()
    missing: dict[str, str] = {}
    scenes = [make() for make in (balls, humanoid, room, warehouse)]
    print(
        "| scene | frame | threads | who | frames/s | belvedere is faster | same depth |\n|---|---|---|---|---|---|---|"
    )
    for scene in scenes:
        if arguments.scene not in scene.name:
            continue
        for threads in (int(number) for number in arguments.threads.split(",")):
            for size, channels in (
                ((64, 64), ("depth",)),
                ((128, 128), ("depth",)),
                ((640, 480), ("depth",)),
                ((128, 128), ("depth", "rgb")),
            ):
                compare(scene, size, channels, threads, arguments.seconds, missing)
    overhead(scenes[0], arguments.seconds)
    print(f"\n{', '.join(f'{scene.name}: {scene.triangles:,} triangles' for scene in scenes)}")
    for name, why in missing.items():
        print(f"left out: {name} ({why})")


if __name__ == "__main__":
    main()
