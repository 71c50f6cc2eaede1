"""Meshes of Open3D as worlds. Its wheel is large, so most tests use objects with the same attributes.

With Open3D installed, its own rays judge: ``.ci/open3d``.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scenes import colour_seen, rays_through

import belvedere as bv

SQUARE = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
UVS = (SQUARE[:, :2] * 0.5 + 0.5)[FACES]


def plain(**attributes: Any) -> SimpleNamespace:
    """Return what a ``geometry.TriangleMesh`` has."""
    empty = np.zeros((0, 3))
    given: dict[str, Any] = {"vertices": SQUARE, "triangles": FACES, "vertex_colors": empty, "textures": []}
    given |= {
        "vertex_normals": empty,
        "triangle_uvs": np.zeros((0, 2)),
        "triangle_material_ids": np.zeros(0, np.int32),
    }
    return SimpleNamespace(**(given | attributes))


class Tensor:
    """What an ``open3d.core.Tensor`` has."""

    def __init__(self, values: Any) -> None:
        self._values = np.asarray(values)

    def numpy(self) -> Any:
        """Return the values."""
        return self._values


def tensor(vertex: dict[str, Any], triangle: dict[str, Any], material: Any = None) -> SimpleNamespace:
    """Return what a ``t.geometry.TriangleMesh`` has."""
    vertex = {key: Tensor(value) for key, value in ({"positions": SQUARE} | vertex).items()}
    triangle = {key: Tensor(value) for key, value in ({"indices": FACES} | triangle).items()}
    made = SimpleNamespace(vertex=vertex, triangle=triangle, material=material)
    made.cpu = lambda: made
    return made


def record(**attributes: Any) -> SimpleNamespace:
    """Return what a ``visualization.rendering.MaterialRecord`` has."""
    given = {"base_color": [1.0] * 4, "base_roughness": 1.0, "base_metallic": 0.0, "emissive_color": [0.0] * 4}
    return SimpleNamespace(**(given | {"albedo_img": None, "normal_img": None} | attributes))


def tiles() -> np.ndarray[Any, np.dtype[np.uint8]]:
    """Return an image: red at the upper left, blue at the lower right."""
    picture = np.zeros((64, 64, 3), np.uint8)
    picture[:32, :32], picture[32:, 32:] = [255, 0, 0], [0, 0, 255]
    return picture


def has_upright_tiles(world: bv.World) -> bool:
    seen = colour_seen(world, (0, 0, 2.5))
    # +x is up in the picture, and +y to the left: −x +y, +x −y, +x +y.
    return [seen[at].tolist() for at in ((45, 20), (20, 45), (20, 20))] == [[255, 0, 0], [0, 0, 255], [0, 0, 0]]


def test_textures_are_upright() -> None:
    # The first row of a texture of a plain mesh is at v = 0.
    mesh = plain(
        triangle_uvs=UVS.reshape(-1, 2), textures=[tiles()[::-1]], triangle_material_ids=np.zeros(2, np.int32)
    )
    assert has_upright_tiles(bv.World.from_open3d(mesh))
    shown = SimpleNamespace(as_tensor=lambda: Tensor(tiles()))
    look = SimpleNamespace(
        vector_properties={"base_color": np.ones(4)},
        scalar_properties={"roughness": 1.0, "metallic": 0.0},
        texture_maps={"albedo": shown},
        is_valid=lambda: True,
    )
    assert has_upright_tiles(bv.World.from_open3d(tensor({}, {"texture_uvs": UVS}, look)))
    model = SimpleNamespace(
        meshes=[SimpleNamespace(mesh=plain(triangle_uvs=UVS.reshape(-1, 2)), mesh_name="part", material_idx=0)],
        materials=[record(albedo_img=tiles())],
    )
    world = bv.World.from_open3d([{"name": "model", "geometry": model}])
    assert has_upright_tiles(world)
    assert world.bodies == ["model/part"]


@pytest.mark.parametrize("colours", [{}, {"vertex_colors": np.eye(4, 3)}])
def test_normals_of_vertices_are_those_of_the_body(colours: Any) -> None:
    slope = np.array([[0.0, 0.6, 0.8], [0.0, -0.6, 0.8], [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]])
    tensors = {"colors" if key == "vertex_colors" else key: value for key, value in colours.items()}
    for flat, smooth in (
        (plain(**colours), plain(vertex_normals=slope, **colours)),
        (tensor(tensors, {}), tensor(tensors | {"normals": slope}, {})),
    ):
        pictures = []
        for geometry in (flat, smooth):
            world = bv.World.from_open3d(geometry)
            world.add_light("directional", direction=(0, 0, -1), color=(1, 1, 1), shadows=False)
            from_above = np.array([[0, 0, 1.0, 0], [0, 1, 0, 0], [-1, 0, 0, 3], [0, 0, 0, 1]])
            pictures.append(bv.Camera(60, 60, 1.0).render(world, from_above)["rgb"].astype(int))
        # All normals lie 37 degrees aside, and the mean of opposite ones points straight up.
        assert pictures[0].max() >= pictures[1].max()
        assert (pictures[0] - pictures[1]).max() > 10


def test_colours() -> None:
    colors = np.array([[1.0, 0, 0]] * 4)
    for mesh in (plain(vertex_colors=colors), tensor({"colors": colors}, {}), tensor({}, {"colors": colors[:2]})):
        assert colour_seen(bv.World.from_open3d(mesh), (0, 0, 2))[30, 33].tolist() == [255, 0, 0]
    two = tensor({}, {"colors": np.array([[255, 0, 0], [0, 255, 0]], np.uint8)})
    seen = colour_seen(bv.World.from_open3d(two), (0, 0, 2.5))
    assert seen[20, 45].tolist() == [255, 0, 0]  # +x, −y
    assert seen[45, 20].tolist() == [0, 255, 0]
    halved = {"name": "red", "geometry": plain(vertex_colors=colors), "material": record(base_color=[0.5, 1, 1, 1])}
    np.testing.assert_allclose(colour_seen(bv.World.from_open3d(halved), (0, 0, 2))[30, 33], [128, 0, 0], atol=1)


def test_a_body_for_each_material() -> None:
    textures = [np.full((2, 2, 3), value, np.uint8) for value in (50, 200)]
    mesh = plain(
        triangle_uvs=UVS.reshape(-1, 2), textures=textures, triangle_material_ids=np.array([1, 0], np.int32)
    )
    world = bv.World.from_open3d([mesh, plain(vertices=SQUARE + np.array([0, 0, 1]))])
    assert world.bodies == ["mesh_0/0", "mesh_0/1", "mesh_1"]
    seen = colour_seen(world, (0, 0, 0.9))
    assert {int(seen[10, 60, 0]), int(seen[60, 10, 0])} == {50, 200}
    # y is up: the first sheet is upright, at y = 0 in our axes.
    upright = bv.World.from_open3d(mesh, up="y").cast([0.2, -3, 0], [[0.0, 1.0, 0.0]])
    assert upright["distance"][0] == 3.0


def test_what_is_left_out_is_named() -> None:
    cloud = type("PointCloud", (), {"__module__": "open3d.cuda.pybind.geometry"})()
    bump = {"geometry": plain(), "material": record(normal_img=tiles(), albedo_img=tiles())}
    world = bv.World.from_open3d([cloud, bump, plain(triangles=np.zeros((0, 3), np.int32))])
    assert world.notes == [
        "geometries of the type PointCloud are left out",
        "normal maps are not shown",
        "textures of meshes without texture coordinates are left out",
        "meshes without triangles or without an extent are left out",
    ]
    assert world.bodies == ["mesh_1"]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (3, "geometries: 'mesh_0' is a int; a mesh of Open3D is expected"),
        ("a.obj", "geometries: 'mesh_0' is a str"),
        ([{"name": "a"}], "geometries: number 0 is a dictionary without 'geometry'"),
        (plain(vertices=SQUARE * np.nan), "mesh 'mesh_0': vertices"),
    ],
)
def test_bad_input_is_one_clear_error(given: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        bv.World.from_open3d(given)


def test_rays_hit_what_those_of_open3d_hit(open3d: Any) -> None:
    random = np.random.default_rng(0)
    meshes = []
    for make in ("create_torus", "create_sphere", "create_box", "create_cone"):
        mesh = getattr(open3d.geometry.TriangleMesh, make)()
        mesh.rotate(open3d.geometry.get_rotation_matrix_from_xyz(random.normal(size=3)))
        meshes.append(mesh.translate(random.uniform(-3, 3, 3)))
    tensors = [open3d.t.geometry.TriangleMesh.from_legacy(mesh) for mesh in meshes]
    judge = open3d.t.geometry.RaycastingScene()
    for mesh in tensors:
        judge.add_triangles(mesh)
    origins, directions = rays_through(4.0, 10_000)
    rays = np.concatenate([origins, directions], axis=1).astype(np.float32)
    answers = judge.cast_rays(open3d.core.Tensor(rays))
    distance, number = answers["t_hit"].numpy(), answers["geometry_ids"].numpy()
    for given in (meshes, tensors, [{"name": str(n), "geometry": mesh} for n, mesh in enumerate(meshes)]):
        world = bv.World.from_open3d(given)
        hits = world.cast(origins, directions)
        seen = np.isfinite(distance)
        assert seen.sum() > 1500
        assert (np.isfinite(hits["distance"]) != seen).sum() <= 2
        both = seen & np.isfinite(hits["distance"])
        assert (np.abs(hits["distance"][both] - distance[both]) > 5e-5).sum() <= 2
        assert (world.instance_bodies[hits["instance"][both]] == number[both]).mean() > 0.999
        same = hits["normal"][both] @ np.ones(3) - answers["primitive_normals"].numpy()[both] @ np.ones(3)
        assert (np.abs(same) < 1e-3).mean() > 0.999


def test_files_that_open3d_reads(open3d: Any, tmp_path: Any) -> None:
    image = pytest.importorskip("PIL.Image")
    image.fromarray(tiles()).save(tmp_path / "tiles.png")
    (tmp_path / "a.mtl").write_text("newmtl m\nKd 1 1 1\nmap_Kd tiles.png\n")
    lines = [f"v {x} {y} {z}" for x, y, z in SQUARE] + [f"vt {x / 2 + 0.5} {y / 2 + 0.5}" for x, y, _ in SQUARE]
    (tmp_path / "a.obj").write_text(
        "\n".join(["mtllib a.mtl", *lines, "usemtl m", "f 1/1 2/2 3/3", "f 1/1 3/3 4/4"])
    )
    path = str(tmp_path / "a.obj")
    for read in (open3d.io.read_triangle_mesh, open3d.t.io.read_triangle_mesh, open3d.io.read_triangle_model):
        given = read(path, True) if read is open3d.io.read_triangle_mesh else read(path)
        assert has_upright_tiles(bv.World.from_open3d(given)), read
