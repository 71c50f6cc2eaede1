"""The libraries that render the models. Each function returns a call that renders the frames of a case, and the depths
or ranges of the first frame, to compare them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np
from scenes import surface

import belvedere.mujoco as bvm


@dataclass(frozen=True)
class Case:
    """What is rendered in one call."""

    name: str
    #: Pixels across and down; or beams and lines of a lidar.
    size: tuple[int, int]
    #: The number of frames per call.
    frames: int
    colours: bool = False
    #: The angles of the first and the last beam, and of the lowest and the highest line; None for a camera.
    angles: tuple[float, float, float, float] | None = None


CASES = (
    Case("depth 64 × 64, 32 worlds", (64, 64), 32),
    Case("RGB-D 64 × 64, 32 worlds", (64, 64), 32, colours=True),
    Case("depth 64 × 64, 1 world", (64, 64), 1),
    Case("RGB-D 64 × 64, 1 world", (64, 64), 1, colours=True),
    Case("depth 640 × 480", (640, 480), 1),
    Case("RGB-D 640 × 480", (640, 480), 1, colours=True),
    Case("VLP-16, 16 × 1800 beams", (1800, 16), 1, angles=(-math.pi, math.pi * 899 / 900, -0.2618, 0.2618)),
    Case("TIM571, 811 beams", (811, 1), 1, angles=(-2.356, 2.356, 0.0, 0.0)),
)


@dataclass(frozen=True)
class Peer:
    """A library that is ready to render a case."""

    take: Callable[[], object]
    distances: Callable[[], np.ndarray]
    close: Callable[[], object] = lambda: None


def rays_of(case: Case, model: mujoco.MjModel, data: mujoco.MjData) -> tuple[np.ndarray, np.ndarray]:
    """Return the origin and the directions (N, 3) in the world: of length 1 for a lidar, of depth 1 for a camera."""
    across, down = case.size
    if case.angles is None:
        step = 2.0 * math.tan(math.radians(30.0)) / down
        x, y = (np.arange(across) + 0.5 - across / 2) * step, (down / 2 - np.arange(down) - 0.5) * step
        local = np.stack(np.broadcast_arrays(x[None], y[:, None], -1.0), axis=-1).reshape(-1, 3)
        camera = model.camera("bench_eye").id
        origin, turn = data.cam_xpos[camera], data.cam_xmat[camera]
    else:
        azimuth, elevation = (
            np.linspace(*case.angles[:2], across)[None],
            np.linspace(*case.angles[2:], down)[:, None],
        )
        parts = np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)
        local = np.stack(np.broadcast_arrays(*parts), axis=-1).reshape(-1, 3)
        site = model.site("bench_lidar").id
        origin, turn = data.site_xpos[site], data.site_xmat[site]
    return origin.copy(), local @ turn.reshape(3, 3).T


def belvedere(case: Case, model: mujoco.MjModel, data: mujoco.MjData) -> Peer:
    scene = bvm.Scene(model)
    names = ("geom_xpos", "geom_xmat", "cam_xpos", "cam_xmat", "site_xpos", "site_xmat")
    states = data if case.frames == 1 else {name: np.stack([getattr(data, name)] * case.frames) for name in names}
    if case.angles is not None:
        lidar = scene.lidar(
            "bench_lidar", beams=case.size[0], lines=case.size[1], angles=case.angles[:2], elevations=case.angles[2:],
            most=1000.0, sees="visual",
        )  # fmt: skip
        return Peer(lambda: lidar.render(data, threads=1), lambda: lidar.render(data)["range"].ravel())
    camera = scene.camera("bench_eye", *case.size)
    channels = ("rgb", "depth") if case.colours else ("depth",)
    return Peer(
        lambda: camera.render(states, channels=channels, threads=1),
        lambda: camera.render(data, channels=("depth",))["depth"].ravel(),
    )


def warp(case: Case, model: mujoco.MjModel, data: mujoco.MjData) -> Peer:
    """MuJoCo Warp on the processor. Its tree over the geoms is fitted to the states in each call, as they may move."""
    import mujoco_warp as mjw
    import warp as wp

    with wp.ScopedDevice("cpu"):
        worlds = case.frames
        m, d = mjw.put_model(model), mjw.put_data(model, data, nworld=worlds)
        common = {"nworld": worlds, "use_shadows": False, "render_seg": False, "cam_active": ["bench_eye"]}
        size = case.size if case.angles is None else (8, 8)
        context = mjw.create_render_context(
            model, cam_res=size, render_rgb=case.colours, render_depth=True, **common
        )
        if case.angles is None:
            depth = wp.zeros((worlds, size[1], size[0]), dtype=float)

            def take() -> None:
                mjw.refit_bvh(m, d, context)
                mjw.render(m, d, context)

            def distances() -> np.ndarray:
                take()
                mjw.get_depth(context, 0, 1000.0, depth)
                found = depth.numpy()[0].ravel() * 1000.0
                return np.where(found <= 0.0, np.inf, found)

            return Peer(take, distances)
        origin, rays = rays_of(case, model, data)
        count = len(rays)
        pnt, vec = wp.array(np.tile(origin, (1, count, 1)), dtype=wp.vec3), wp.array(rays[None], dtype=wp.vec3)
        group = mjw._src.types.vec6(1, 1, 1, 0, 0, 0)
        none = wp.full(count, -1, dtype=int)
        dist, geom = wp.zeros((1, count), dtype=float), wp.zeros((1, count), dtype=int)
        normal = wp.zeros((1, count), dtype=wp.vec3)

        def cast() -> None:
            mjw.refit_bvh(m, d, context)
            mjw.rays(m, d, pnt, vec, group, True, none, dist, geom, normal, context)

        def ranges() -> np.ndarray:
            cast()
            return np.where(dist.numpy()[0] < 0.0, np.inf, dist.numpy()[0])

        return Peer(cast, ranges)


def newton(case: Case, model: mujoco.MjModel, data: mujoco.MjData) -> Peer:
    """Newton on the processor, without refitting its tree. Its camera also casts the rays of lidars."""
    import newton as nt
    import warp as wp
    from newton.sensors import SensorCamera

    with wp.ScopedDevice("cpu"):
        builder = nt.ModelBuilder()
        for geom in bvm.Scene(model).geoms:
            turn = np.zeros(4)
            mujoco.mju_mat2Quat(turn, data.geom_xmat[geom])
            at = wp.transform(wp.vec3(*data.geom_xpos[geom]), wp.quat(*np.roll(turn, -1)))
            size = model.geom_size[geom].tolist()
            match mujoco.mjtGeom(model.geom_type[geom]):
                case mujoco.mjtGeom.mjGEOM_PLANE:
                    edges = [2.0 * edge for edge in size[:2]]
                    builder.add_shape_plane(None, xform=at, width=edges[0], length=edges[1], body=-1)
                case mujoco.mjtGeom.mjGEOM_SPHERE:
                    builder.add_shape_sphere(-1, xform=at, radius=size[0])
                case mujoco.mjtGeom.mjGEOM_CAPSULE:
                    builder.add_shape_capsule(-1, xform=at, radius=size[0], half_height=size[1])
                case mujoco.mjtGeom.mjGEOM_BOX:
                    builder.add_shape_box(-1, xform=at, hx=size[0], hy=size[1], hz=size[2])
                case mujoco.mjtGeom.mjGEOM_CYLINDER:
                    builder.add_shape_cylinder(-1, xform=at, radius=size[0], half_height=size[1])
                case _:
                    vertices, faces = surface(model, geom)
                    mesh = nt.Mesh(
                        vertices.astype(np.float32), faces.ravel().astype(np.int32), compute_inertia=False
                    )
                    builder.add_shape_mesh(-1, xform=at, mesh=mesh)
        built = builder.finalize(device="cpu")
        state, camera = built.state(), SensorCamera(built)
        camera.create_default_light()
        across, down = case.size
        origin, directions = rays_of(case, model, data)
        lengths = np.linalg.norm(directions, axis=1)
        rays = np.zeros((down, across, 1, 2, 3), np.float32)
        rays[:, :, 0, 1] = (directions / lengths[:, None]).reshape(down, across, 3)
        bundle = wp.array(rays, dtype=wp.vec3)
        places = wp.array([wp.transform(wp.vec3(*origin), wp.quat_identity())] * case.frames, dtype=wp.transformf)
        images = {"depth_image": camera.allocate_image_depth(case.frames, across, down)}
        if case.colours:
            images["color_image"] = camera.allocate_image_color(case.frames, across, down)

        world = wp.zeros(case.frames, dtype=wp.int32)

        def take() -> None:
            camera.update(state, places, bundle, world_indices=world, **images)

        def distances() -> np.ndarray:
            take()
            found = images["depth_image"].numpy()[0].ravel()
            return np.where(found <= 0.0, np.inf, found / lengths)

        return Peer(take, distances)


def renderer(case: Case, model: mujoco.MjModel, data: mujoco.MjData) -> Peer:
    """MuJoCo's own renderer on Mesa's llvmpipe with one thread, without shadows and reflections."""
    if case.angles is not None:
        raise NotImplementedError("a camera alone")
    own = mujoco.Renderer(model, case.size[1], case.size[0])
    option = mujoco.MjvOption()
    option.sitegroup[:] = 0

    def draw(depth: bool) -> np.ndarray:
        own.update_scene(data, "bench_eye", option)
        own.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = 0
        own.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = 0
        (own.enable_depth_rendering if depth else own.disable_depth_rendering)()
        return own.render()

    def take() -> None:
        for _ in range(case.frames):
            draw(True)
            if case.colours:
                draw(False)

    far = model.vis.map.zfar * model.stat.extent

    def distances() -> np.ndarray:
        depth = draw(True).ravel()
        return np.where(depth > 0.999 * far, np.inf, depth)

    return Peer(take, distances, own.close)


def multi_ray(case: Case, model: mujoco.MjModel, data: mujoco.MjData) -> Peer:
    if case.colours:
        raise NotImplementedError("rays have no colours")
    origin, directions = rays_of(case, model, data)
    count = len(directions)
    lengths = np.linalg.norm(directions, axis=1)
    units = (directions / lengths[:, None]).ravel()
    geoms, found = np.zeros(count, np.int32), np.zeros(count)
    groups = np.array([1, 1, 1, 0, 0, 0], np.uint8)

    def take() -> None:
        for _ in range(case.frames):
            mujoco.mj_multiRay(model, data, origin, units, groups, True, -1, geoms, found, None, count, 1e9)

    def distances() -> np.ndarray:
        take()
        return np.where(geoms < 0, np.inf, found / lengths)

    return Peer(take, distances)


def open3d(case: Case, model: mujoco.MjModel, data: mujoco.MjData) -> Peer:
    """Open3D's rays on the triangles of this state; its one tree is not built again.

    Its distances are those of finer triangles than its times: at the rims of balls, a ray is several centimetres longer
    to 20 corners than to the ball, or misses.
    """
    if case.colours:
        raise NotImplementedError("rays have no colours")
    import open3d as o3d

    def scene_of(around: int) -> o3d.t.geometry.RaycastingScene:
        scene = o3d.t.geometry.RaycastingScene(nthreads=1)
        for geom in bvm.Scene(model).geoms:
            vertices, faces = surface(model, geom, around)
            vertices = vertices @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
            corners, numbers = (
                o3d.core.Tensor(vertices.astype(np.float32)),
                o3d.core.Tensor(faces.astype(np.uint32)),
            )
            scene.add_triangles(corners, numbers)
        return scene

    scene = scene_of(20)
    origin, directions = rays_of(case, model, data)
    rays = np.concatenate([np.broadcast_to(origin, directions.shape), directions], axis=1).astype(np.float32)
    bundle = o3d.core.Tensor(np.tile(rays, (case.frames, 1)))

    return Peer(
        lambda: scene.cast_rays(bundle, nthreads=1),
        lambda: scene_of(160).cast_rays(bundle, nthreads=1)["t_hit"].numpy()[: len(rays)],
    )


PEERS = {
    "belvedere": belvedere,
    "MuJoCo Warp": warp,
    "Newton": newton,
    "mujoco.Renderer": renderer,
    "mj_multiRay": multi_ray,
    "Open3D": open3d,
}
