"""Belvedere beside what a user would pick instead: the same scenes, poses and outputs, one run, ratios.

    python benches/python/compare.py [--seconds 1.0] [--rounds 5] [--threads 1,2] [--scene WORD]

Peers that are not installed are named and left out: open3d (or open3d-cpu), embreex with trimesh, mujoco, pybullet,
pyrender. So are the scenes whose shapes are another package's: mjlab has the Unitree G1, dm_control a humanoid of
capsules; MuJoCo reads both.

Everybody takes turns, round after round. A rate is the median of the rounds, a ratio the median of their ratios, with
the least and the greatest. Of one thread it is processor time that counts, of more it is wall time.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import importlib.util
import math
import multiprocessing
import os
import pathlib
import statistics
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

# Before anything starts threads.
os.environ.setdefault("MUJOCO_GL", "egl")
os.environ.setdefault("PYOPENGL_PLATFORM", "egl")
os.environ.setdefault("LP_NUM_THREADS", "1")

import numpy as np

import belvedere as bv

#: Rays of a call, of those who take rays: enough that what a call costs does not show.
RAYS_OF_A_CALL = 2**19
#: Frames whose depths are compared.
LOOKS = (0, 9, 18, 27)


@dataclass
class Part:
    """Triangles of a body, and what else it is for peers that have shapes of their own."""

    vertices: np.ndarray
    faces: np.ndarray
    #: Its kind and its size, as MuJoCo writes them: radius and half a length, half edges. None for a mesh.
    shape: tuple[str, tuple[float, ...]] | None
    pose: np.ndarray


@dataclass
class Scene:
    """What all of them see, and from where."""

    name: str
    parts: list[Part]
    poses: np.ndarray = field(default_factory=lambda: np.zeros((0, 7)))
    #: Of the cameras, horizontally, in radians.
    fov: float = 1.2
    #: Belvedere's own, of shapes where there are shapes.
    world: bv.World = field(default_factory=bv.World)

    def __post_init__(self) -> None:
        self.world.add_light("directional", direction=(0.4, 0.2, -1), shadows=False)

    def add(self, part: Part) -> None:
        """Add a body, also to Belvedere's world: a shape if it is one."""
        self.parts.append(part)
        match part.shape:
            case ("sphere", (radius,)):
                self.world.add_sphere(radius, part.pose)
            case ("capsule", (radius, half)):
                self.world.add_capsule(radius, 2 * half, part.pose)
            case ("box", half):
                self.world.add_box(tuple(2 * edge for edge in half), part.pose)
            case None:
                self.world.add_mesh(part.vertices, part.faces, part.pose)

    def of_meshes(self) -> Scene:
        """The same without shapes, as those see it who know triangles alone."""
        scene = Scene(self.name, self.parts, self.poses, self.fov)
        for part in self.parts:
            scene.world.add_mesh(part.vertices, part.faces, part.pose)
        return scene

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


def capsule(radius: float, half: float) -> tuple[np.ndarray, np.ndarray]:
    """A capsule of triangles: a ball, cut through and drawn apart."""
    vertices, faces = sphere(radius, 20, 11)
    vertices[:, 2] += np.copysign(half, vertices[:, 2])
    return vertices, faces


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
    ahead = target - eye
    # Halves of the turn about z, and of that about y, which goes down.
    yaw = math.atan2(ahead[1], ahead[0]) / 2
    pitch = math.atan2(-ahead[2], math.hypot(ahead[0], ahead[1])) / 2
    x, y = -math.sin(pitch) * math.sin(yaw), math.sin(pitch) * math.cos(yaw)
    return np.array([*eye, x, y, math.cos(pitch) * math.sin(yaw), math.cos(pitch) * math.cos(yaw)])


def around(target: tuple[float, float, float], radius: float, height: float, count: int = 32) -> np.ndarray:
    # Who takes but a few of them has gone round as well.
    angles = 2 * math.pi * (np.arange(count) * (math.sqrt(5) - 1) / 2 % 1)
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
    for _ in range(40):
        radius = random.uniform(0.15, 0.45)
        at = pose(*random.uniform(-3, 3, 2), radius)
        scene.add(Part(*sphere(radius, 20, 11), ("sphere", (radius,)), at))
    scene.poses = around((0, 0, 0.3), 4.0, 1.5)
    return scene


def terrain(name: str, random: np.random.Generator) -> Scene:
    """A height field, for somebody to stand on.

    Peers have it as a mesh, cut as Belvedere cuts its cells; MuJoCo's rays would take five times as long on a field.
    """
    scene = Scene(name, [])
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
            faces += [(a, a + cells + 1, a + 1), (a + 1, a + cells + 1, a + cells + 2)]
    scene.parts.append(Part(vertices, np.array(faces), None, pose(0, 0, 0)))
    scene.poses = around((0, 0, 0.8), 2.5, 0.4)
    return scene


def limbs() -> list[tuple[tuple[float, float, float], float, float]]:
    """A figure of 31 limbs: where they are, how thick, and how many times as long."""
    made = [((0, 0, 0.95), 0.14, 1.2), ((0, 0, 1.15), 0.15, 1.2), ((0, 0, 1.5), 0.11, 0.72)]
    for side in (-1, 1):
        made += [((0, side * 0.09, 0.85 - 0.11 * step), 0.07, 1.08) for step in range(7)]
        made += [((0.05 * step, side * (0.2 + 0.01 * step), 1.25 - 0.09 * step), 0.05, 1.08) for step in range(7)]
    return made


def mesh_figure() -> Scene:
    """A stand-in of a humanoid that needs no package. No shapes: meshes for everybody."""
    random = np.random.default_rng(4)
    scene = terrain("figure of 31 meshes over terrain", random)
    for at, radius, stretch in limbs():
        points, triangles = sphere(radius, 48, 26)
        points = points * (1 + 0.02 * random.normal(size=(len(points), 1))) * (1, 1, stretch)
        scene.add(Part(points, triangles, None, pose(*at)))
    return scene


def capsule_figure() -> Scene:
    """The same of capsules."""
    scene = terrain("figure of 31 capsules over terrain", np.random.default_rng(4))
    for at, radius, stretch in limbs():
        size = (0.8 * radius, 0.5 * radius * stretch)
        scene.add(Part(*capsule(*size), ("capsule", size), pose(*at)))
    return scene


def robot(package: str, file: str, group: int) -> Iterator[Part]:
    """The bodies of a robot in a package, as MuJoCo reads it, in its first pose."""
    import mujoco

    found = importlib.util.find_spec(package)
    if found is None or found.origin is None:
        raise ModuleNotFoundError(f"No module named {package!r}")
    model = mujoco.MjModel.from_xml_path(str(pathlib.Path(found.origin).parent / file))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for index in np.flatnonzero(model.geom_group == group):
        turn = np.zeros(4)
        mujoco.mju_mat2Quat(turn, data.geom_xmat[index])
        at = np.concatenate([data.geom_xpos[index], np.roll(turn, -1)])
        size = model.geom_size[index].tolist()
        match mujoco.mjtGeom(model.geom_type[index]):
            case mujoco.mjtGeom.mjGEOM_SPHERE:
                yield Part(*sphere(size[0], 20, 11), ("sphere", (size[0],)), at)
            case mujoco.mjtGeom.mjGEOM_CAPSULE:
                yield Part(*capsule(*size[:2]), ("capsule", tuple(size[:2])), at)
            case mujoco.mjtGeom.mjGEOM_MESH:
                mesh = model.geom_dataid[index]
                first, face = model.mesh_vertadr[mesh], model.mesh_faceadr[mesh]
                vertices = model.mesh_vert[first : first + model.mesh_vertnum[mesh]].astype(np.float64)
                yield Part(vertices, model.mesh_face[face : face + model.mesh_facenum[mesh]].copy(), None, at)


def unitree_g1() -> Scene:
    """31 bodies, what is visual of them 35 meshes of 393,270 triangles.

    Seen as the model's own camera sees it, the one of MuJoCo Warp's benchmark: 2.1 m away, at 45 degrees.
    """
    scene = terrain("Unitree G1 over terrain", np.random.default_rng(4))
    for part in robot("mjlab", "asset_zoo/robots/unitree_g1/xmls/g1.xml", 2):
        scene.add(part)
    scene.poses, scene.fov = around((0, 0, 0.72), 2.07, 0.42), math.pi / 4
    return scene


def suite_humanoid() -> Scene:
    """16 capsules and 3 balls; the figure of MuJoCo Warp's benchmark."""
    scene = terrain("dm_control's humanoid over terrain", np.random.default_rng(4))
    for part in robot("dm_control", "suite/humanoid.xml", 0):
        scene.add(part)
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
    for size, at in boxes:
        scene.add(Part(*box(size), ("box", tuple(edge / 2 for edge in size)), pose(*at)))
    scene.poses = around((0, 0, 1.0), 1.2, 0.6)
    return scene


def warehouse() -> Scene:
    """One mesh: shelves of boxes and drums, from the aisles between them."""
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
    scene = Scene(f"warehouse of {len(faces):,} triangles", [])
    scene.add(Part(vertices, faces, None, pose(0, 0, 0)))
    eyes = [np.array([index % 5 * 3.0 - 6, random.uniform(-12, 12), 1.6]) for index in range(32)]
    ways = [np.array([math.cos(angle), math.sin(angle), -0.1]) for angle in random.uniform(0, 2 * math.pi, 32)]
    scene.poses = np.stack([look_at(eye, eye + way) for eye, way in zip(eyes, ways, strict=True)])
    return scene


def rays_of(scene: Scene, width: int, height: int) -> list[np.ndarray]:
    """Rays (height·width, 6) of each pose; their directions are 1 long along the optical axis: t is the depth."""
    focal = width / (2 * math.tan(scene.fov / 2))
    columns, rows = np.meshgrid(np.arange(width) - (width - 1) / 2, np.arange(height) - (height - 1) / 2)
    local = np.stack([np.ones_like(columns), -columns / focal, -rows / focal], axis=2).reshape(-1, 3)
    rays = []
    for at in scene.poses:
        directions = local @ rotation(at[3:]).T
        origins = np.broadcast_to(at[:3], directions.shape)
        rays.append(np.ascontiguousarray(np.concatenate([origins, directions], axis=1), dtype=np.float32))
    return rays


@dataclass
class Peer:
    """Somebody who takes frames of a scene."""

    #: Takes a call's frames, of the poses from this number on.
    take: Callable[[int], object]
    #: The depth of the frame at a pose.
    depth: Callable[[int], np.ndarray]
    #: Frames of a call.
    batch: int = 1
    #: Gives back what it holds.
    close: Callable[[], object] = lambda: None


def belvedere(scene: Scene, width: int, height: int, threads: int, channels: tuple[str, ...]) -> Peer:
    camera = bv.DepthCamera(width, height, fov=scene.fov)
    shape = (len(scene.poses), height, width)
    out = {"depth": np.empty(shape, np.float32)}
    if "rgb" in channels:
        out["rgb"] = np.empty((*shape, 3), np.uint8)

    def take(_: int) -> None:
        camera.render(scene.world, scene.poses, out=out, threads=threads)

    def depth(index: int) -> np.ndarray:
        return camera.render(scene.world, scene.poses[index], threads=threads)["depth"]

    return Peer(take, depth, len(scene.poses))


def belvedere_meshes(scene: Scene, width: int, height: int, threads: int, channels: tuple[str, ...]) -> Peer:
    """Belvedere, made to see the triangles that peers see."""
    if all(part.shape is None for part in scene.parts):
        raise NotImplementedError("there are no shapes")
    return belvedere(scene.of_meshes(), width, height, threads, channels)


def batches_of_rays(scene: Scene, width: int, height: int) -> list[np.ndarray]:
    """The rays of calls, one after the other, made beforehand: what is timed is what the tree does."""
    rays = rays_of(scene, width, height)
    frames = 1
    while frames < len(rays) and 2 * frames * width * height <= RAYS_OF_A_CALL:
        frames *= 2
    return [np.concatenate(rays[first : first + frames]) for first in range(0, len(rays), frames)]


def open3d(scene: Scene, width: int, height: int, threads: int, channels: tuple[str, ...]) -> Peer:
    import open3d as o3d

    ray_scene = o3d.t.geometry.RaycastingScene(nthreads=threads)
    vertices, faces = scene.soup()
    ray_scene.add_triangles(o3d.core.Tensor(vertices), o3d.core.Tensor(faces))
    rays = [o3d.core.Tensor(batch) for batch in batches_of_rays(scene, width, height)]
    batch = len(scene.poses) // len(rays)

    def take(index: int):
        return ray_scene.cast_rays(rays[index // batch % len(rays)], nthreads=threads)

    def depth(index: int) -> np.ndarray:
        return take(index)["t_hit"].numpy().reshape(batch, height, width)[index % batch]

    return Peer(take, depth, batch)


def embreex(scene: Scene, width: int, height: int, threads: int, channels: tuple[str, ...]) -> Peer:
    if threads != 1:
        raise NotImplementedError("one thread alone")
    from embreex import rtcore_scene
    from embreex.mesh_construction import TriangleMesh

    vertices, faces = scene.soup()
    embree = rtcore_scene.EmbreeScene()
    TriangleMesh(embree, vertices, faces.astype(np.int32))
    rays = [
        (np.ascontiguousarray(batch[:, :3]), np.ascontiguousarray(batch[:, 3:]))
        for batch in batches_of_rays(scene, width, height)
    ]
    batch = len(scene.poses) // len(rays)

    def take(index: int):
        return embree.run(*rays[index // batch % len(rays)], query="DISTANCE")

    def depth(index: int) -> np.ndarray:
        return np.asarray(take(index)).reshape(batch, height, width)[index % batch]

    return Peer(take, depth, batch)


def mujoco_model(scene: Scene, width: int, height: int):
    import mujoco

    spec = mujoco.MjSpec()
    spec.visual.global_.offwidth, spec.visual.global_.offheight = width, height
    spec.visual.global_.fovy = math.degrees(2 * math.atan(math.tan(scene.fov / 2) * height / width))
    spec.visual.quality.offsamples = 0
    spec.visual.map.znear, spec.visual.map.zfar = 0.01, 50.0
    for index, part in enumerate(scene.parts):
        body = spec.worldbody.add_body(pos=part.pose[:3], quat=np.roll(part.pose[3:], 1))
        geom = body.add_geom(contype=0, conaffinity=0)
        if part.shape is None:
            spec.add_mesh(
                name=f"mesh{index}",
                uservert=part.vertices.ravel().tolist(),
                userface=part.faces.ravel().tolist(),
                inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
            )
            geom.type, geom.meshname = mujoco.mjtGeom.mjGEOM_MESH, f"mesh{index}"
        else:
            kind, size = part.shape
            geom.type = {
                "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
                "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
                "box": mujoco.mjtGeom.mjGEOM_BOX,
                "plane": mujoco.mjtGeom.mjGEOM_PLANE,
            }[kind]
            geom.size = [*size, 0.1, 0.1][:3]
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return mujoco, model, data


def mj_multi_ray(scene: Scene, width: int, height: int, threads: int, channels: tuple[str, ...]) -> Peer:
    if threads != 1:
        raise NotImplementedError("one thread alone")
    mujoco, model, data = mujoco_model(scene, width, height)
    rays = rays_of(scene, width, height)
    count = width * height
    ids, distances = np.zeros(count, np.int32), np.zeros(count)
    units = [
        np.ascontiguousarray(
            one[:, 3:] / np.linalg.norm(one[:, 3:], axis=1, keepdims=True), dtype=np.float64
        ).ravel()
        for one in rays
    ]
    lengths = np.linalg.norm(rays[0][:, 3:], axis=1)

    def take(index: int) -> None:
        at = index % len(rays)
        mujoco.mj_multiRay(
            model, data, scene.poses[at, :3], units[at], None, 1, -1, ids, distances, None, count, 100.0
        )

    def depth(index: int) -> np.ndarray:
        take(index)
        return np.where(distances < 0, np.inf, distances / lengths).reshape(height, width)

    return Peer(take, depth)


def mujoco_renderer(scene: Scene, width: int, height: int, threads: int, channels: tuple[str, ...]) -> Peer:
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

    def take(index: int) -> None:
        draw(index, True)
        if "rgb" in channels:
            draw(index, False)

    def depth(index: int) -> np.ndarray:
        return draw(index, True)

    return Peer(take, depth, close=renderer.close)


def pybullet(scene: Scene, width: int, height: int, threads: int, channels: tuple[str, ...]) -> Peer:
    if threads != 1:
        raise NotImplementedError("one thread alone")
    import pybullet as p

    client = p.connect(p.DIRECT)
    for part in scene.parts:
        vertices, at = part.vertices.tolist(), (part.pose[:3].tolist(), part.pose[3:].tolist())
        # It takes no more indices at once.
        for first in range(0, len(part.faces), 2**17):
            faces = part.faces[first : first + 2**17].ravel().tolist()
            shape = p.createVisualShape(p.GEOM_MESH, vertices=vertices, indices=faces, physicsClientId=client)
            p.createMultiBody(0, -1, shape, *at, physicsClientId=client)
    near, far = 0.02, 100.0
    fovy = math.degrees(2 * math.atan(math.tan(scene.fov / 2) * height / width))
    projection = list(p.computeProjectionMatrixFOV(fovy, width / height, near, far))
    # It draws what a pixel's corner sees; half a pixel on is the middle, which everybody else sees.
    projection[8] += 1 / width
    projection[9] += 1 / height
    views = []
    for at in scene.poses:
        axes = rotation(at[3:])
        views.append(p.computeViewMatrix(at[:3].tolist(), (at[:3] + axes[:, 0]).tolist(), axes[:, 2].tolist()))

    def take(index: int):
        return p.getCameraImage(
            width,
            height,
            views[index % len(views)],
            projection,
            shadow=0,
            renderer=p.ER_TINY_RENDERER,
            physicsClientId=client,
        )

    def depth(index: int) -> np.ndarray:
        z = np.asarray(take(index)[3]).reshape(height, width)
        return far * near / (far - (far - near) * z)

    return Peer(take, depth, close=lambda: p.disconnect(client))


def pyrender(scene: Scene, width: int, height: int, threads: int, channels: tuple[str, ...]) -> Peer:
    if threads != 1:
        raise NotImplementedError("LP_NUM_THREADS=1")
    import OpenGL.EGL
    import pyrender as pr
    import trimesh

    # A renderer that goes would end the display, and MuJoCo draws on the same.
    OpenGL.EGL.eglTerminate = lambda display: True
    drawn = pr.Scene(ambient_light=(0.4, 0.4, 0.4))
    drawn.add(pr.DirectionalLight(intensity=3.0))
    for part in scene.parts:
        at = np.eye(4)
        at[:3, :3], at[:3, 3] = rotation(part.pose[3:]), part.pose[:3]
        drawn.add(pr.Mesh.from_trimesh(trimesh.Trimesh(part.vertices, part.faces, process=False)), pose=at)
    focal = width / (2 * math.tan(scene.fov / 2))
    # The depth of a pixel is that of the first of its four samples, which is not in the middle.
    center = (width / 2 - 1 / 8, height / 2 + 3 / 8)
    node = drawn.add(pr.IntrinsicsCamera(focal, focal, *center, znear=0.02, zfar=100))
    renderer = pr.OffscreenRenderer(width, height)
    flags = pr.RenderFlags.NONE if "rgb" in channels else pr.RenderFlags.DEPTH_ONLY
    # Looks along −z, y is up.
    turn = np.array([[0, 0, -1.0], [-1, 0, 0], [0, 1, 0]])

    def take(index: int) -> np.ndarray:
        pose_of = np.eye(4)
        at = scene.poses[index % len(scene.poses)]
        pose_of[:3, :3], pose_of[:3, 3] = rotation(at[3:]) @ turn, at[:3]
        drawn.set_pose(node, pose_of)
        got = renderer.render(drawn, flags)
        return got if flags else got[1]

    def depth(index: int) -> np.ndarray:
        got = take(index)
        return np.where(got == 0, np.inf, got)

    return Peer(take, depth, close=renderer.delete)


PEERS = {
    "belvedere": belvedere,
    "belvedere, meshes": belvedere_meshes,
    "open3d": open3d,
    "embreex": embreex,
    "mj_multiRay": mj_multi_ray,
    "mujoco.Renderer": mujoco_renderer,
    "pybullet": pybullet,
    "pyrender": pyrender,
}


#: Who has shapes, as Belvedere has them.
WITH_SHAPES = ("belvedere, meshes", "mj_multiRay", "mujoco.Renderer")


def rate(peer: Peer, first: int, seconds: float, clock: Callable[[], float]) -> tuple[float, int]:
    """Frames a second, and the number of the next one."""
    index, start = first, clock()
    while (past := clock() - start) < seconds:
        peer.take(index)
        index += peer.batch
    return (index - first) / past, index


def agreement(ours: Peer, theirs: Peer) -> float:
    """The share of pixels whose depths differ by less than 2 cm."""
    shares = []
    for index in LOOKS:
        one, other = (np.asarray(peer.depth(index), np.float64) for peer in (ours, theirs))
        shares.append(
            np.isclose(np.where(one > 30, 99, one), np.where(other > 30, 99, other), rtol=1e-5, atol=0.02)
        )
    return float(np.mean(shares))


def compare(
    scene: Scene,
    size: tuple[int, int],
    channels: tuple[str, ...],
    threads: int,
    arguments: argparse.Namespace,
    missing: dict[str, str],
) -> str:
    """Prints a row for each peer; returns one of all: Belvedere's rate, and how many times faster it is than each."""
    peers: dict[str, Peer] = {}
    for name, make in PEERS.items():
        if "rgb" in channels and name in ("open3d", "embreex", "mj_multiRay"):
            continue
        try:
            peer = make(scene, *size, threads, channels)
            peer.take(0)
            peers[name] = peer
        except NotImplementedError:
            pass
        except Exception as error:  # whatever a peer's installation lacks
            missing[name if isinstance(error, ImportError) else f"{name}, {scene.name}"] = why(error)
    clock = time.process_time if threads == 1 else time.perf_counter
    rates: dict[str, list[float]] = {name: [] for name in peers}
    turns = dict.fromkeys(peers, 0)
    for _ in range(arguments.rounds):
        for name, peer in peers.items():
            each, turns[name] = rate(peer, turns[name], arguments.seconds / arguments.rounds, clock)
            rates[name].append(each)
    what = "RGB-D" if "rgb" in channels else "depth"
    summary = dict.fromkeys(PEERS, "")
    for name, peer in peers.items():
        row = [scene.name, f"{what} {size[0]}x{size[1]}", str(threads), name]
        row.append(f"{statistics.median(rates[name]):,.{0 if rates[name][0] >= 100 else 1}f}")
        summary[name] = row[-1]
        if name == "belvedere":
            row += ["", ""]
        else:
            ratios = sorted(ours / theirs for ours, theirs in zip(rates["belvedere"], rates[name], strict=True))
            row += [f"{statistics.median(ratios):.1f} ({ratios[0]:.1f} to {ratios[-1]:.1f})"]
            if name != "belvedere, meshes":
                middle = statistics.median(ratios)
                summary[name] = f"{middle:.{1 if middle < 10 else 0}f}×"
            same = "belvedere" if name in WITH_SHAPES else "belvedere, meshes"
            row += [f"{agreement(peers.get(same, peers['belvedere']), peer):.1%}"]
        print(f"| {' | '.join(row)} |", flush=True)
    for peer in peers.values():
        peer.close()
    return f"| {scene.name} | {what} {size[0]} × {size[1]} | {' | '.join(summary.values())} |"


def why(error: Exception) -> str:
    return f"{type(error).__name__}: {str(error).splitlines()[0][:100] if str(error) else ''}"


class Unwanted:
    """Belvedere's native sensor, asked for frames of which none is wanted: what a call costs besides them remains."""

    def __init__(self, native: object) -> None:
        self.native = native

    def render(self, world, now, after, before, each, *rest) -> None:
        self.native.render(world, now, after, before, (*each[:2], [False] * len(each[0]), None), *rest)


def overhead(scene: Scene, arguments: argparse.Namespace) -> None:
    """What a call costs besides its frames, one thread, 64x64.

    Two ways. Calls whose frames are not wanted do all but take them. And of a + b·N, fitted to what calls of N frames
    cost, a is what a call costs even of no frame; what Python does for each frame is in b there.
    """
    counts = (1, 16, 256, 8192)
    out = {"depth": np.empty((max(counts), 64, 64), np.float32)}
    full, empty = bv.DepthCamera(64, 64, fov=scene.fov), bv.DepthCamera(64, 64, fov=scene.fov)
    empty._native = Unwanted(empty._native)
    poses = np.resize(scene.poses, (max(counts), 7))

    def cost(camera: bv.DepthCamera, count: int) -> float:
        """Of a call, in microseconds. All calls together take all poses, however few frames a call has."""
        calls = 0
        arrays = {"depth": out["depth"][:count]}
        start = time.process_time()
        while (past := time.process_time() - start) < arguments.seconds / arguments.rounds:
            for first in range(0, max(count, len(scene.poses)), count):
                camera.render(scene.world, poses[first : first + count], out=arrays, threads=1)
                calls += 1
        return past / calls * 1e6

    rounds: list[tuple[np.ndarray, np.ndarray]] = []
    for _ in range(max(5, arguments.rounds)):
        both = np.array([[cost(camera, count) for camera in (full, empty)] for count in counts])
        rounds.append((both[:, 0], both[:, 1]))
    fits = np.array([fit(np.array(counts, float), costs) for costs, _ in rounds])
    print(
        "\n| frames of a call | call, µs | without its frames, µs | share | a / (a + b·N) |\n|---|---|---|---|---|"
    )
    for row, count in enumerate(counts):
        shares = [besides[row] / costs[row] for costs, besides in rounds]
        fitted = fits[:, 0] / (fits[:, 0] + fits[:, 1] * count)
        costs, besides = np.median([[one[row] for one in both] for both in rounds], axis=0)
        print(f"| {count:,} | {costs:,.1f} | {besides:,.1f} | {spread(shares, '.2%')} | {spread(fitted, '.2%')} |")
    a, b = (spread(values, ".1f") for values in fits.T)
    print(f"a = {a} µs a call, b = {b} µs a frame; medians, least to greatest")


def fit(counts: np.ndarray, costs: np.ndarray) -> np.ndarray:
    """a and b of a + b·N: least squares of what differs in proportion, so that small calls count as well."""
    return np.linalg.lstsq(np.stack([1 / costs, counts / costs], axis=1), np.ones(len(costs)), rcond=None)[0]


def spread(values: list[float] | np.ndarray, form: str) -> str:
    return f"{statistics.median(values):{form}} ({min(values):{form}} to {max(values):{form}})"


def resident() -> int:
    """Bytes of this process that are in memory."""
    return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def growth(count: int, answer: multiprocessing.Queue) -> None:
    """Answers by how much this process grew by a batch, and what it has of it still after a frame of each world."""
    scene, camera = balls(), bv.DepthCamera(8, 8, fov=1.2)
    bv.Batch(scene.world, 1).render(camera, scene.poses[0], threads=1)
    out = {"depth": np.ones((count, 8, 8), np.float32)}
    before = resident()
    batch = bv.Batch(scene.world, count)
    made = resident() - before
    batch.render(camera, scene.poses[0], out, threads=1)
    answer.put((made, resident() - before))


def memory() -> None:
    """What a world in a batch takes besides what all share: of its arrays, and of a process that is new."""
    start, counts = multiprocessing.get_context("spawn"), (1_000, 11_000)
    grown = []
    for count in counts:
        answer = start.Queue()
        process = start.Process(target=growth, args=(count, answer))
        process.start()
        grown.append(answer.get(timeout=60))
        process.join()
    made, after = ((more - less) / (counts[1] - counts[0]) / 1024 for less, more in zip(*grown, strict=True))
    one = bv.Batch(balls().world, 1)
    print(
        f"\na world of {len(one.bodies)} bodies in a batch: its arrays {one.memory / 1024:.2f} KB; resident, between "
        f"{counts[0]:,} and {counts[1]:,} worlds, {made:.2f} KB each, {after:.2f} KB when a frame of each was taken"
    )


FRAMES = (
    ((64, 64), ("depth",)),
    ((128, 128), ("depth",)),
    ((640, 480), ("depth",)),
    ((64, 64), ("depth", "rgb")),
    ((128, 128), ("depth", "rgb")),
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=1.0, help="for each figure, over all rounds")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--scene", default="", help="part of a scene's name")
    arguments = parser.parse_args()
    missing: dict[str, str] = {}
    with contextlib.suppress(ImportError):
        importlib.import_module("pybullet")  # it prints a line
    scenes = []
    for make in (balls, unitree_g1, mesh_figure, suite_humanoid, capsule_figure, room, warehouse):
        try:
            scenes.append(make())
        except ImportError as error:
            missing[f"scene {make.__name__}"] = why(error)
    print(
        "| scene | frame | threads | who | frames/s | belvedere is faster, times | same depth |\n"
        "|---|---|---|---|---:|---:|---:|"
    )
    summaries: dict[int, list[str]] = defaultdict(list)
    for scene in scenes:
        if arguments.scene not in scene.name:
            continue
        for threads in (int(number) for number in arguments.threads.split(",")):
            for size, channels in FRAMES:
                summaries[threads] += [compare(scene, size, channels, threads, arguments, missing)]
    for threads, rows in summaries.items():
        print(f"\nthreads={threads}: Belvedere's frames a second, and how many times as fast as the others it is\n")
        print(f"| scene | frame | {' | '.join(PEERS)} |\n|---|---|{'---:|' * len(PEERS)}")
        print("\n".join(rows))
    overhead(scenes[0], arguments)
    memory()
    print()
    for scene in scenes:
        print(f"{scene.name}: {len(scene.parts)} bodies, {scene.triangles:,} triangles")
    for name, reason in missing.items():
        print(f"left out: {name} ({reason})")


if __name__ == "__main__":
    main()
