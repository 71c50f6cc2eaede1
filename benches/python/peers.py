"""The libraries that render the frames: Belvedere, and those that a user might choose instead."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scenes import Scene, rotation

import belvedere as bv

#: The number of rays per call, for libraries that cast rays: so many that the overhead of a call is negligible.
RAYS_OF_A_CALL = 2**19


def rays_of(scene: Scene, width: int, height: int) -> list[np.ndarray]:
    """Return the rays (height·width, 6) of each pose. Directions have z = 1 in optical axes, so t is the depth."""
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
    """A library that renders frames of a scene."""

    #: Renders the frames of a call, for the poses from this number on.
    take: Callable[[int], object]
    #: Returns the depth of the frame at a pose.
    depth: Callable[[int], np.ndarray]
    #: The number of frames per call.
    batch: int = 1
    #: Frees all resources.
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
    """Belvedere on the triangles that the peers get."""
    if all(part.shape is None for part in scene.parts):
        raise NotImplementedError("there are no shapes")
    return belvedere(scene.of_meshes(), width, height, threads, channels)


def batches_of_rays(scene: Scene, width: int, height: int) -> list[np.ndarray]:
    """The rays of consecutive calls, made beforehand, so that only the traversal of the tree is timed."""
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
        # It accepts no more indices at once.
        for first in range(0, len(part.faces), 2**17):
            faces = part.faces[first : first + 2**17].ravel().tolist()
            shape = p.createVisualShape(p.GEOM_MESH, vertices=vertices, indices=faces, physicsClientId=client)
            p.createMultiBody(0, -1, shape, *at, physicsClientId=client)
    near, far = 0.02, 100.0
    fovy = math.degrees(2 * math.atan(math.tan(scene.fov / 2) * height / width))
    projection = list(p.computeProjectionMatrixFOV(fovy, width / height, near, far))
    # It samples the corner of a pixel. Shifted by half a pixel, it samples the middle, like the others.
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

    # Deleting a renderer would end the display, which MuJoCo uses too.
    OpenGL.EGL.eglTerminate = lambda display: True
    drawn = pr.Scene(ambient_light=(0.4, 0.4, 0.4))
    drawn.add(pr.DirectionalLight(intensity=3.0))
    for part in scene.parts:
        at = np.eye(4)
        at[:3, :3], at[:3, 3] = rotation(part.pose[3:]), part.pose[:3]
        drawn.add(pr.Mesh.from_trimesh(trimesh.Trimesh(part.vertices, part.faces, process=False)), pose=at)
    focal = width / (2 * math.tan(scene.fov / 2))
    # The depth of a pixel is that of its first of four samples, which is not in the middle.
    center = (width / 2 - 1 / 8, height / 2 + 3 / 8)
    node = drawn.add(pr.IntrinsicsCamera(focal, focal, *center, znear=0.02, zfar=100))
    renderer = pr.OffscreenRenderer(width, height)
    flags = pr.RenderFlags.NONE if "rgb" in channels else pr.RenderFlags.DEPTH_ONLY
    # The camera looks along −z, and y is up.
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


#: The libraries that have shapes, like Belvedere.
WITH_SHAPES = ("belvedere, meshes", "mj_multiRay", "mujoco.Renderer")
