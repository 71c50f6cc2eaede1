"""The scenes and the poses of the camera, which are the same for all libraries."""

from __future__ import annotations

import importlib.util
import math
import pathlib
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

import belvedere as bv


@dataclass
class Part:
    """Triangles of a body, and its shape for peers that have shapes."""

    vertices: np.ndarray
    faces: np.ndarray
    #: Kind and size as in MuJoCo: radius and half length, or half edges. None for a mesh.
    shape: tuple[str, tuple[float, ...]] | None
    pose: np.ndarray


@dataclass
class Scene:
    """A scene with the poses from which it is rendered."""

    name: str
    parts: list[Part]
    poses: np.ndarray = field(default_factory=lambda: np.zeros((0, 7)))
    #: The horizontal field of view of the cameras in radians.
    fov: float = 1.2
    #: Belvedere's world, with shapes for bodies that have them.
    world: bv.World = field(default_factory=bv.World)

    def __post_init__(self) -> None:
        self.world.add_light("directional", direction=(0.4, 0.2, -1), shadows=False)

    def add(self, part: Part) -> None:
        """Add a body, also to Belvedere's world, as a shape if it has one."""
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
        """Return the same scene without shapes, as for libraries that have only triangles."""
        scene = Scene(self.name, self.parts, self.poses, self.fov)
        for part in self.parts:
            scene.world.add_mesh(part.vertices, part.faces, part.pose)
        return scene

    @property
    def triangles(self) -> int:
        return sum(len(part.faces) for part in self.parts)

    def soup(self) -> tuple[np.ndarray, np.ndarray]:
        """Return all triangles in the world."""
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
    """Return a ball of triangles."""
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
    """Return a capsule of triangles: a ball whose halves are moved apart."""
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
    """Return the pose of a sensor: +x points to the target, z up."""
    ahead = target - eye
    # Half of the rotation about z, and of that about y, which points down.
    yaw = math.atan2(ahead[1], ahead[0]) / 2
    pitch = math.atan2(-ahead[2], math.hypot(ahead[0], ahead[1])) / 2
    x, y = -math.sin(pitch) * math.sin(yaw), math.sin(pitch) * math.cos(yaw)
    return np.array([*eye, x, y, math.cos(pitch) * math.sin(yaw), math.cos(pitch) * math.cos(yaw)])


def around(target: tuple[float, float, float], radius: float, height: float, count: int = 32) -> np.ndarray:
    # Even the first few poses are spread around the target.
    angles = 2 * math.pi * (np.arange(count) * (math.sqrt(5) - 1) / 2 % 1)
    at = np.array(target)
    return np.stack([look_at(at + [radius * math.cos(a), radius * math.sin(a), height], at) for a in angles])


def balls() -> Scene:
    """40 balls on a plane."""
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
    """Return a height field as the ground.

    Peers get it as a mesh with the same triangles as in Belvedere; MuJoCo's rays would take five times as long on a field.
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
    """Return the 31 limbs of a figure: positions, radii, and ratios of length."""
    made = [((0, 0, 0.95), 0.14, 1.2), ((0, 0, 1.15), 0.15, 1.2), ((0, 0, 1.5), 0.11, 0.72)]
    for side in (-1, 1):
        made += [((0, side * 0.09, 0.85 - 0.11 * step), 0.07, 1.08) for step in range(7)]
        made += [((0.05 * step, side * (0.2 + 0.01 * step), 1.25 - 0.09 * step), 0.05, 1.08) for step in range(7)]
    return made


def mesh_figure() -> Scene:
    """Return a substitute for a humanoid that needs no package. All libraries get meshes."""
    random = np.random.default_rng(4)
    scene = terrain("figure of 31 meshes over terrain", random)
    for at, radius, stretch in limbs():
        points, triangles = sphere(radius, 48, 26)
        points = points * (1 + 0.02 * random.normal(size=(len(points), 1))) * (1, 1, stretch)
        scene.add(Part(points, triangles, None, pose(*at)))
    return scene


def capsule_figure() -> Scene:
    """Return the same figure of capsules."""
    scene = terrain("figure of 31 capsules over terrain", np.random.default_rng(4))
    for at, radius, stretch in limbs():
        size = (0.8 * radius, 0.5 * radius * stretch)
        scene.add(Part(*capsule(*size), ("capsule", size), pose(*at)))
    return scene


def robot(package: str, file: str, group: int) -> Iterator[Part]:
    """Return the bodies of a robot in a package, as MuJoCo reads them, in the initial pose."""
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
    """Return 31 bodies, whose visual shapes are 35 meshes of 393,270 triangles.

    The view is that of the model's own camera, which MuJoCo Warp's benchmark uses: 2.1 m away, 45 degrees wide.
    """
    scene = terrain("Unitree G1 over terrain", np.random.default_rng(4))
    for part in robot("mjlab", "asset_zoo/robots/unitree_g1/xmls/g1.xml", 2):
        scene.add(part)
    scene.poses, scene.fov = around((0, 0, 0.72), 2.07, 0.42), math.pi / 4
    return scene


def suite_humanoid() -> Scene:
    """Return 16 capsules and 3 balls, as in MuJoCo Warp's benchmark."""
    scene = terrain("dm_control's humanoid over terrain", np.random.default_rng(4))
    for part in robot("dm_control", "suite/humanoid.xml", 0):
        scene.add(part)
    return scene


def room() -> Scene:
    """Return a room of boxes."""
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
    """Return one mesh of shelves with boxes and drums, seen from the aisles."""
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


#: The functions that create the scenes. They raise ImportError if a package is not installed.
SCENES = (balls, unitree_g1, mesh_figure, suite_humanoid, capsule_figure, room, warehouse)
