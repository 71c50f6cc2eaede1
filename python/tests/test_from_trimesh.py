"""Scenes of trimesh as worlds: its own rays judge ours."""

from __future__ import annotations

import builtins
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scenes import colour_seen, rays_through, transform

import belvedere as bv

if TYPE_CHECKING:
    from pathlib import Path

trimesh = pytest.importorskip("trimesh")
Image = pytest.importorskip("PIL.Image")


def scene_with_instances() -> Any:
    """Return a scene of two geometries; one is turned, scaled, mirrored and sheared."""
    scene = trimesh.Scene()
    ball = trimesh.creation.icosphere(subdivisions=1, radius=0.9)
    # Not symmetric, so that a mirrored instance is not the same.
    ball.vertices[:4] *= 1.4
    scene.add_geometry(ball, node_name="first", geom_name="ball", transform=transform(1))
    for number, scale in enumerate([1.0, 0.5, (1.0, 1.0, -1.0), (1.5, 1.0, 0.6), (-1.0, -0.7, -1.0)]):
        scene.graph.update(
            frame_to=f"instance {number}", matrix=transform(10 + number, scale), geometry="ball", frame_from="world"
        )
    sheared = transform(20) @ np.diag([1.0, 2.0, 0.5, 1.0]) @ transform(21, size=0.0)
    scene.graph.update(frame_to="sheared", matrix=sheared, geometry="ball", frame_from="world")
    mirrored = sheared @ np.diag([1.0, -1.0, 1.0, 1.0])
    mirrored[:3, 3] += 1.0
    scene.graph.update(frame_to="mirrored", matrix=mirrored, geometry="ball", frame_from="instance 1")
    scene.add_geometry(trimesh.creation.box((1, 2, 0.5)), node_name="crate", transform=transform(30))
    return scene


def test_rays_hit_what_those_of_trimesh_hit() -> None:
    pytest.importorskip("rtree")
    scene = scene_with_instances()
    world = bv.World.from_trimesh(scene)
    assert world.notes == []
    assert world.bodies == list(scene.graph.nodes_geometry)
    origins, directions = rays_through(4.0, 10_000)
    whole = scene.to_mesh()
    judge = trimesh.ray.ray_triangle.RayMeshIntersector(whole)
    places, rays, triangles = judge.intersects_location(origins, directions, multiple_hits=False)
    expected = np.full(len(origins), np.inf)
    expected[rays] = np.linalg.norm(places - origins[rays], axis=1)
    hits = world.cast(origins, directions)
    seen = np.isfinite(expected)
    assert seen.sum() > 3000
    # A ray within 1e-5 m of an edge may meet either side of it.
    assert (np.isfinite(hits["distance"]) != seen).sum() <= 2
    both = seen & np.isfinite(hits["distance"])
    wrong = np.abs(hits["distance"][both] - expected[both]) > 2e-5
    assert wrong.sum() <= 2
    normals = np.zeros((len(origins), 3))
    normals[rays] = whole.face_normals[triangles]
    agree = (hits["normal"][both] * normals[both]).sum(axis=1)
    assert (agree > 0.999).mean() > 0.999, "the outside of each triangle is where trimesh has it"
    # The label of each hit is the node whose geometry is there.
    bodies = [world.bodies[body] for body in world.instance_bodies[hits["instance"][both][:300]]]
    for body, place in zip(bodies, (origins + directions * expected[:, None])[both][:300], strict=True):
        matrix, name = scene.graph[body]
        own = trimesh.transform_points([place], np.linalg.inv(matrix))
        assert trimesh.proximity.closest_point_naive(scene.geometry[name], own)[1][0] < 1e-4


def test_instances_share_their_triangles_and_their_texture() -> None:
    ball = trimesh.creation.icosphere(subdivisions=4)
    picture = Image.fromarray(np.random.default_rng(0).integers(0, 255, (512, 512, 3), np.uint8))
    uvs = ball.vertices[:, :2] * 0.5 + 0.5
    ball.visual = trimesh.visual.TextureVisuals(uv=uvs, image=picture)
    memory = []
    for count in (1, 100):
        scene = trimesh.Scene()
        scene.add_geometry(ball, node_name="0", geom_name="ball")
        for number in range(1, count):
            scene.graph.update(frame_to=str(number), matrix=transform(number), geometry="ball", frame_from="world")
        memory.append(bv.World.from_trimesh(scene).memory)
    assert memory[0] > 1_000_000
    assert memory[1] < memory[0] + 100 * 1000
    two = trimesh.Scene({"a": ball, "b": ball.copy()})
    two.geometry["b"].vertices *= 2.0
    assert bv.World.from_trimesh(two).memory < memory[0] * 1.6, "other triangles with the same texture share it"


def sheet(**visual: Any) -> Any:
    """Return a square of two metres with four triangles around its middle."""
    vertices = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [0, 0, 0]]
    faces = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
    return trimesh.Trimesh(vertices, faces, process=False, **visual)


def test_colours_of_faces_and_vertices() -> None:
    colors = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255], [200, 200, 40]], np.uint8)
    picture = colour_seen(bv.World.from_trimesh(sheet(face_colors=colors)), (0, 0, 2.0))
    # +x is up in the picture, and +y to the left: the faces are at −y, +x, +y, −x.
    for place, color in zip(((32, 50), (14, 32), (32, 14), (50, 32)), colors, strict=True):
        assert picture[place].tolist() == color.tolist()
    corners = np.array([[0, 0, 0], [200, 0, 0], [200, 100, 0], [0, 100, 0], [100, 50, 0]], np.uint8)
    picture = colour_seen(bv.World.from_trimesh(sheet(vertex_colors=corners)), (0, 0, 2.5)).astype(int)
    shown = np.argwhere(picture.any(axis=-1))
    step = 2.0 * np.tan(0.45) * 2.5 / 64
    for row, column in shown:
        x, y = (31.5 - row) * step, (31.5 - column) * step
        if max(abs(x), abs(y)) < 0.97:
            expected = [100 + 100 * x, 50 + 50 * y, 0]
            assert np.abs(picture[row, column] - expected).max() <= 1.0, (row, column)
    assert len(shown) > 1000
    alone = bv.World.from_trimesh(sheet(face_colors=[10, 20, 30, 255]))
    assert colour_seen(alone, (0, 0, 2.0))[32, 30].tolist() == [10, 20, 30]
    mixed = np.array([[255, 0, 0, 255]] * 2 + [[255, 0, 0, 55]] * 2, np.uint8)
    assert bv.World.from_trimesh(sheet(face_colors=mixed)).notes == [
        "the transparency of single vertices and faces is shown by its mean"
    ]


def test_a_texture_lies_as_trimesh_says() -> None:
    picture = np.zeros((4, 4, 3), np.uint8)
    picture[:2, :2] = [255, 0, 0]  # at the upper left of the image: u small, v large
    picture[2:, 2:] = [0, 0, 255]
    mesh = sheet()
    image = Image.fromarray(np.repeat(np.repeat(picture, 16, 0), 16, 1))
    mesh.visual = trimesh.visual.TextureVisuals(uv=mesh.vertices[:, :2] * 0.5 + 0.5, image=image)
    seen = colour_seen(bv.World.from_trimesh(mesh), (0, 0, 2.5))
    assert seen[45, 20].tolist() == [255, 0, 0]  # at −x and +y
    assert seen[20, 45].tolist() == [0, 0, 255]
    assert seen[20, 20].tolist() == [0, 0, 0]


def test_a_file_of_gltf_with_materials(tmp_path: Path) -> None:
    mesh = sheet()
    rough = trimesh.visual.material.PBRMaterial(
        baseColorFactor=[55, 0, 255, 255], roughnessFactor=0.4, metallicFactor=0.0, doubleSided=True,
        normalTexture=Image.new("RGB", (2, 2)), emissiveFactor=[0.0, 0.2, 0.0],
    )  # fmt: skip
    mesh.visual = trimesh.visual.TextureVisuals(uv=mesh.vertices[:, :2], material=rough)
    scene = trimesh.Scene()
    # y is up: the sheet is turned so that it is level in our axes.
    lying = trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0])
    scene.add_geometry(mesh, node_name="sheet", transform=lying)
    scene.export(tmp_path / "sheet.glb")
    world = bv.World.from_trimesh(tmp_path / "sheet.glb", up="y")
    assert world.bodies == ["sheet"]
    assert world.notes == [
        "normal maps of materials are not shown",
        "the insides of double-sided surfaces are not seen by cameras",
    ]
    # Factors of glTF are linear light: 55/255 is 127/255 in sRGB, and the sum with the green light is seen.
    green = round(255 * (1.055 * 0.2 ** (1 / 2.4) - 0.055))
    np.testing.assert_allclose(colour_seen(world, (0, 0, 2.0))[32, 30], [128, green, 255], atol=2)


def test_units_axes_and_the_camera() -> None:
    box = trimesh.creation.box((100, 200, 400))
    scene = trimesh.Scene()
    scene.add_geometry(box, node_name="box", transform=trimesh.transformations.translation_matrix([0, 1000, 0]))
    scene.units = "millimeters"
    hit = bv.World.from_trimesh(scene).cast([0, 0, 0], [[0.0, 1.0, 0.0]])
    assert hit["distance"][0] == pytest.approx(0.9)
    hit = bv.World.from_trimesh(scene, up="y").cast([0, 0, 0], [[0.0, 0.0, 1.0]])
    assert hit["distance"][0] == pytest.approx(0.9), "y is up"
    scene.camera = trimesh.scene.Camera("eye", resolution=(60, 40), fov=(60, 40))
    scene.camera_transform = transform(4)
    scene.lights = [trimesh.scene.lighting.PointLight()]
    world = bv.World.from_trimesh(scene, up="y")
    assert world.notes == ["the scene's lights are left out; World.add_light adds some"]
    placed = world.cameras["eye"]
    camera = placed.camera()
    assert camera.frame_shape == (40, 60)
    ranges = camera.render(world, placed.pose, channels=("range",))["range"]
    # The rays of trimesh's camera, in metres and with z up.
    origins, vectors, pixels = scene.camera_rays()
    turn = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    hits = world.cast(origins @ turn.T / 1000.0, vectors @ turn.T)["distance"]
    expected = np.full((40, 60), np.inf)
    expected[pixels[:, 1], pixels[:, 0]] = hits
    same = np.isclose(ranges, expected, rtol=1e-3) | (np.isinf(ranges) & np.isinf(expected))
    assert same.mean() > 0.99


def test_what_is_left_out_is_named() -> None:
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.PointCloud(np.zeros((3, 3))), node_name="points")
    scene.add_geometry(trimesh.Trimesh(), node_name="nothing")
    scene.add_geometry(trimesh.creation.box(), node_name="flat", transform=np.diag([1.0, 1.0, 0.0, 1.0]))
    scene.add_geometry(trimesh.creation.box(), node_name="box")
    world = bv.World.from_trimesh(scene)
    assert world.bodies == ["box"]
    assert "geometries of the type PointCloud are left out" in world.notes
    assert any(note.startswith("meshes without triangles or without an extent") for note in world.notes)
    assert world.cameras == {}


@pytest.mark.parametrize(
    ("given", "arguments", "words"),
    [
        (3, {}, "scene: a Scene or Trimesh of trimesh, or a path, is expected, not int"),
        ("nothing.glb", {}, "scene: trimesh cannot read 'nothing.glb'"),
        (trimesh.Scene(), {"up": "x"}, "up: z or y is expected, not 'x'"),
        (trimesh.Trimesh([[0, 0, np.nan], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], process=False), {}, "mesh 'mesh"),
    ],
)
def test_bad_input_is_one_clear_error(given: Any, arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        bv.World.from_trimesh(given, **arguments)


@pytest.mark.parametrize(
    ("call", "package"),
    [
        (lambda: bv.World.from_trimesh("a.stl"), "trimesh"),
        (lambda: bv.World.from_usd("a.usda"), "usd-core"),
    ],
)
def test_a_missing_package_is_named(call: Any, package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.import_module", lambda name: builtins.__import__("nothing_of_this_name"))
    with pytest.raises(ImportError, match=f"needs the package {package}, .*: pip install {package}"):
        call()
