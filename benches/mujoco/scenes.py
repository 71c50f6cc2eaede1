"""The models that are rendered, with a camera and a lidar in each."""

from __future__ import annotations

import importlib.util
import math
import pathlib

import mujoco
import numpy as np


def triangles(rings: list[tuple[float, float]], around: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the surface of revolution through rings of (radius, height), from the top down."""
    angles = np.linspace(0.0, 2.0 * math.pi, around, endpoint=False)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    vertices = [np.column_stack([circle * radius, np.full(around, height)]) for radius, height in rings]
    faces = []
    for ring in range(len(rings) - 1):
        for corner in range(around):
            a, b = ring * around + corner, ring * around + (corner + 1) % around
            if rings[ring][0] > 0.0:
                faces.append((a, a + around, b))
            if rings[ring + 1][0] > 0.0:
                faces.append((b, a + around, b + around))
    return np.concatenate(vertices), np.array(faces)


def sphere(radius: float, half: float = 0.0, around: int = 20) -> tuple[np.ndarray, np.ndarray]:
    """Return a ball, whose halves are moved apart for a capsule."""
    turns = np.linspace(0.0, math.pi, around // 2 + 2)
    rings = [(radius * math.sin(turn), radius * math.cos(turn)) for turn in turns]
    rings[0], rings[-1] = (0.0, radius), (0.0, -radius)
    return triangles([(r, z + math.copysign(half, z)) for r, z in rings], around)


def box(size: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a box by its half edges."""
    vertices = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * size[:3]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return vertices, np.array([face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))])


def surface(model: mujoco.MjModel, geom: int, around: int = 20) -> tuple[np.ndarray, np.ndarray]:
    """Return a geom as triangles, for libraries that have only those; curved ones with as many corners around."""
    size = model.geom_size[geom]
    match mujoco.mjtGeom(model.geom_type[geom]):
        case mujoco.mjtGeom.mjGEOM_PLANE:
            reach = [edge if edge > 0.0 else 50.0 for edge in size[:2]]
            return np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * [*reach, 1.0], np.array(
                [[0, 1, 2], [0, 2, 3]]
            )
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            return sphere(size[0], 0.0, around)
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            return sphere(size[0], size[1], around)
        case mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            vertices, faces = sphere(1.0, 0.0, around)
            return vertices * size, faces
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            return triangles([(0.0, size[1]), (size[0], size[1]), (size[0], -size[1]), (0.0, -size[1])], around)
        case mujoco.mjtGeom.mjGEOM_BOX:
            return box(size)
        case mujoco.mjtGeom.mjGEOM_MESH:
            mesh = model.geom_dataid[geom]
            first, face = model.mesh_vertadr[mesh], model.mesh_faceadr[mesh]
            return (
                model.mesh_vert[first : first + model.mesh_vertnum[mesh]].astype(np.float64),
                model.mesh_face[face : face + model.mesh_facenum[mesh]].copy(),
            )
    raise NotImplementedError(f"geom {geom} has a type without triangles")


def finish(
    spec: mujoco.MjSpec, eye: tuple[float, float, float], target: tuple[float, float, float], lidar
) -> mujoco.MjModel:
    """Add the camera, the site of the lidar and one lamp, and compile."""
    ahead = np.subtract(target, eye).astype(np.float64)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    up = np.cross(right, ahead)
    quat, axes = np.zeros(4), np.stack([right, up, -ahead], axis=1)
    mujoco.mju_mat2Quat(quat, (axes / np.linalg.norm(axes, axis=0)).ravel())
    spec.worldbody.add_camera(name="bench_eye", pos=eye, quat=quat, fovy=60.0)
    spec.worldbody.add_site(name="bench_lidar", pos=lidar, size=[0.01, 0.01, 0.01])
    if not spec.lights:
        spec.worldbody.add_light(type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, pos=[0, 0, 5], dir=[0.3, 0.2, -1.0])
    # The other libraries have no shadows, or other ones.
    for light in spec.lights:
        light.castshadow = False
    spec.visual.global_.offwidth, spec.visual.global_.offheight = 640, 480
    spec.visual.quality.offsamples = 0
    return spec.compile()


def balls() -> mujoco.MjModel:
    """40 balls on a plane."""
    random = np.random.default_rng(3)
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[10, 10, 1])
    for _ in range(40):
        radius = random.uniform(0.15, 0.45)
        body = spec.worldbody.add_body(pos=[*random.uniform(-3, 3, 2), radius])
        body.add_freejoint()
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[radius, 0, 0])
    return finish(spec, (4.0, 0.5, 1.8), (0.0, 0.0, 0.3), (0.0, 0.0, 0.5))


def house() -> mujoco.MjModel:
    """A house of twelve rooms with furniture as one mesh of 100,000 triangles."""
    random = np.random.default_rng(6)
    parts = [(box(np.array([8.1, 6.1, 0.05])), (0, 0, height)) for height in (-0.05, 2.65)]
    for x in range(5):
        for room in range(3):
            at = 4.0 * room - 4.0
            # A wall with a door in the middle.
            parts += [
                (box(np.array([0.05, 0.75, 1.3])), (4.0 * x - 8.0, at + side * 1.25, 1.3)) for side in (-1, 1)
            ]
    for y in range(4):
        for room in range(4):
            at = 4.0 * room - 6.0
            parts += [
                (box(np.array([0.75, 0.05, 1.3])), (at + side * 1.25, 4.0 * y - 6.0, 1.3)) for side in (-1, 1)
            ]
    while sum(len(faces) for (_, faces), _ in parts) < 100_000 - 400:
        middle = np.array([4.0 * random.integers(4) - 6.0, 4.0 * random.integers(3) - 4.0])
        where = middle + random.uniform(0.5, 1.6, 2) * random.choice([-1, 1], 2)
        height = random.uniform(0.3, 1.0)
        parts.append((box(np.array([*random.uniform(0.1, 0.3, 2), height / 2])), (*where, height / 2)))
        radius = random.uniform(0.08, 0.2)
        parts.append((sphere(radius), (*where, height + radius)))
    vertices, faces, first = [], [], 0
    for (points, corners), at in parts:
        vertices.append(points + at)
        faces.append(corners + first)
        first += len(points)
    spec = mujoco.MjSpec()
    spec.add_mesh(
        name="house",
        uservert=np.concatenate(vertices).ravel().tolist(),
        userface=np.concatenate(faces).ravel().tolist(),
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
    )
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="house", contype=0, conaffinity=0)
    return finish(spec, (-3.9, -3.9, 1.5), (-2.0, 1.0, 0.8), (-2.5, -2.5, 1.0))


def of_package(package: str, file: str, floor: bool, eye, target, lidar) -> mujoco.MjModel:
    """Return a model of an installed package.

    Raises:
        ModuleNotFoundError: it is not installed.

    """
    found = importlib.util.find_spec(package)
    if found is None or found.origin is None:
        raise ModuleNotFoundError(f"No module named {package!r}")
    spec = mujoco.MjSpec.from_file(str(pathlib.Path(found.origin).parent / file))
    if floor:
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[5, 5, 1])
    return finish(spec, eye, target, lidar)


def humanoid() -> mujoco.MjModel:
    """The humanoid of dm_control."""
    return of_package("dm_control", "suite/humanoid.xml", False, (2.5, 0.5, 1.6), (0, 0, 1.0), (1.0, 1.0, 0.8))


def g1() -> mujoco.MjModel:
    """The Unitree G1 of mjlab on a plane."""
    file = "asset_zoo/robots/unitree_g1/xmls/g1.xml"
    return of_package("mjlab", file, True, (2.0, 0.4, 1.1), (0, 0, 0.7), (1.0, 1.0, 0.6))


def panda() -> mujoco.MjModel:
    """The Franka Panda of robosuite on a plane."""
    file = "models/assets/robots/panda/robot.xml"
    return of_package("robosuite", file, True, (1.6, 0.4, 0.9), (0.2, 0, 0.4), (0.8, 0.8, 0.5))


SCENES = {"40 balls": balls, "humanoid": humanoid, "Unitree G1": g1, "Panda": panda, "house": house}
