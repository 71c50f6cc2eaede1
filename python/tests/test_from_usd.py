"""Stages of OpenUSD as worlds. The stages are made by usd-core, and its own transforms and cameras judge."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np
import pytest
from scenes import colour_seen, rays_through, transform

import belvedere as bv

if TYPE_CHECKING:
    from pathlib import Path


pytest.importorskip("pxr.Usd")
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade
from usd_stages import RINGS, bind, first_hits, material, mesh, place, shader, stage, triangles_of


@pytest.mark.parametrize(("up", "metres"), [("Z", 1.0), ("Y", 0.01)])
def test_rays_hit_the_meshes_of_a_stage(up: str, metres: float) -> None:
    made = stage(up, metres)
    scale = 1.0 / metres
    size = 2.5 * scale
    mesh(made, "/wedge", matrix=transform(1, scale, size))
    group = UsdGeom.Xform.Define(made, "/group")
    place(group, transform(2, (1.0, 2.0, 0.5), size))
    mesh(made, "/group/sheared", matrix=transform(3, scale, size))
    mirrored = mesh(made, "/group/mirrored", matrix=transform(4, (-scale, scale, scale), size))
    mirrored.CreateOrientationAttr("leftHanded")
    UsdGeom.Xform.Define(made, "/prototype")
    mesh(made, "/prototype/wedge", matrix=transform(5, scale))
    for number in range(4):
        instance = made.DefinePrim(f"/instance_{number}", "Xform")
        instance.GetReferences().AddInternalReference("/prototype")
        instance.SetInstanceable(True)
        place(instance, transform(20 + number, (1, 1, (-1) ** number), size))
    world = bv.World.from_usd(made)
    expected = triangles_of(made)
    assert world.bodies == list(expected)
    assert world.notes == []
    # Ours is z up and in metres.
    turn = np.eye(3) if up == "Z" else np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    triangles = np.concatenate(list(expected.values())) @ turn.T * metres
    owners = np.repeat(np.arange(len(expected)), [len(part) for part in expected.values()])
    origins, directions = rays_through(4.0, 10_000)
    distance, numbers = first_hits(triangles, origins, directions)
    hits = world.cast(origins, directions)
    seen = np.isfinite(distance)
    assert seen.sum() > 1500
    assert (np.isfinite(hits["distance"]) != seen).sum() <= 2
    both = seen & np.isfinite(hits["distance"])
    assert (np.abs(hits["distance"][both] - distance[both]) > 2e-5).sum() <= 2
    assert (world.instance_bodies[hits["instance"][both]] == owners[numbers[both]]).mean() > 0.999


def test_the_outside_of_meshes_is_that_of_usd() -> None:
    made = stage()
    mesh(made, "/plain")
    other = mesh(made, "/left", rings=[ring[::-1] for ring in RINGS], matrix=transform(1, 1.0, 0.0))
    other.CreateOrientationAttr("leftHanded")
    other.GetPrim().GetAttribute("xformOp:transform").Set(Gf.Matrix4d(1).SetTranslate((5, 0, 0)))
    world = bv.World.from_usd(made)
    for x in (0.3, 5.3):
        hit = world.cast([x, 1.0, -3.0], [[0.0, 0.0, 1.0]])
        assert hit["distance"][0] == pytest.approx(3.0)
        assert hit["normal"][0].tolist() == [0, 0, -1]


def test_polygons_that_are_not_convex_and_holes() -> None:
    arrow = [[0, 0, 0], [3, -2, 0], [2, 0, 0], [3, 2, 0]]
    for start in range(4):
        made = stage()
        ring = np.roll(np.arange(4), start).tolist()
        square = [4, 5, 6, 7]
        points = [*arrow, [5, 0, 0], [6, 0, 0], [6, 1, 0], [5, 1, 0]]
        mesh(made, "/arrow", points, [ring, square]).CreateHoleIndicesAttr([1])
        world = bv.World.from_usd(made)
        assert world.notes == []
        below = world.cast(
            [[1.0, 0.0, 5.0], [2.7, 1.5, 5.0], [2.7, 0.0, 5.0], [5.5, 0.5, 5.0]], [[0.0, 0.0, -1.0]] * 4
        )
        assert np.isfinite(below["distance"]).tolist() == [True, True, False, False]


def test_instances_share_their_triangles() -> None:
    random = np.random.default_rng(0)
    points, rings = random.random((20_000, 3)), np.arange(19_998).reshape(-1, 3).tolist()

    def memory(count: int, kind: str) -> int:
        made = stage()
        UsdGeom.Xform.Define(made, "/library/thing")
        mesh(made, "/library/thing/mesh", points, rings)
        if kind == "points":
            instancer = UsdGeom.PointInstancer.Define(made, "/many")
            instancer.CreatePrototypesRel().SetTargets(["/library/thing"])
            instancer.CreateProtoIndicesAttr([0] * count)
            instancer.CreatePositionsAttr([Gf.Vec3f(3 * number, 0, 0) for number in range(count)])
            made.GetPrimAtPath("/library").SetActive(True)
            UsdGeom.Imageable(made.GetPrimAtPath("/library")).MakeVisible()
        else:
            for number in range(count):
                instance = made.DefinePrim(f"/instance_{number}", "Xform")
                instance.GetReferences().AddInternalReference("/library/thing")
                instance.SetInstanceable(True)
                place(instance, transform(number))
        world = bv.World.from_usd(made)
        assert len(world.bodies) == count + 1
        return world.memory

    for kind in ("points", "references"):
        few, many = memory(1, kind), memory(60, kind)
        assert few > 600_000
        # Instances of references have the mesh of their prototype, beside that of the library itself.
        assert many < 2 * few + 60 * 1000, kind


def test_point_instancers() -> None:
    made = stage()
    place(UsdGeom.Xform.Define(made, "/up"), np.array([[1.0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 10], [0, 0, 0, 1]]))
    instancer = UsdGeom.PointInstancer.Define(made, "/up/many")
    ball = UsdGeom.Sphere.Define(made, "/up/many/prototypes/ball")
    ball.CreateRadiusAttr(0.5)
    place(ball, np.array([[1.0, 0, 0, 0], [0, 1, 0, 0.25], [0, 0, 1, 0], [0, 0, 0, 1]]))
    mesh(made, "/up/many/prototypes/wedge")
    instancer.CreatePrototypesRel().SetTargets(["/up/many/prototypes/ball", "/up/many/prototypes/wedge"])
    indices = instancer.CreateProtoIndicesAttr([0, 1, 0, 0])
    instancer.CreatePositionsAttr([Gf.Vec3f(3 * number, 0, 0) for number in range(4)])
    instancer.CreateScalesAttr([Gf.Vec3f(1, 1, 1)] * 2 + [Gf.Vec3f(2, 2, 2)] * 2)
    instancer.CreateInvisibleIdsAttr([3])
    world = bv.World.from_usd(made)
    assert world.bodies == ["/up/many/ball_0", "/up/many/wedge_1", "/up/many/ball_2"]
    assert world.notes == []
    assert world.pose("/up/many/ball_0")[:3].tolist() == [0, 0.25, 10]
    assert world.pose("/up/many/ball_2")[:3].tolist() == [6, 0.5, 10], "the place of the prototype is scaled, too"
    hit = world.cast([6, 0.5, 20], [[0.0, 0.0, -1.0]])
    assert hit["distance"][0] == pytest.approx(9.0)
    indices.Set([0, 1, 0, 7])
    assert bv.World.from_usd(made).notes == ["/up/many has 4 instances with 0 places, and is left out"]


def test_solids_have_the_sizes_of_usd() -> None:
    made = stage()
    kinds = {"Cube": {"size": 1.0}, "Sphere": {"radius": 0.7}, "Cylinder": {}, "Capsule": {}, "Cone": {}}
    for number, (kind, sizes) in enumerate(kinds.items()):
        for axis in "XYZ" if kind not in ("Cube", "Sphere") else "Z":
            shape = made.DefinePrim(f"/{kind}_{axis}", kind)
            for key, value in sizes.items():
                shape.GetAttribute(key).Set(value)
            if not sizes:
                shape.GetAttribute("radius").Set(0.3)
                shape.GetAttribute("height").Set(1.4)
                shape.GetAttribute("axis").Set(axis)
            place(UsdGeom.Xformable(shape), transform(number, 1.0, 0.0))
            place_x = [10.0 * number, {"X": 0.0, "Y": 10.0, "Z": 20.0}[axis], 0.0]
            shape.GetAttribute("xformOp:transform").Set(Gf.Matrix4d(1).SetTranslate(place_x))
    world = bv.World.from_usd(made)
    assert world.notes == []
    boxes = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_])
    for body in world.bodies:
        bound = boxes.ComputeWorldBound(made.GetPrimAtPath(body)).ComputeAlignedRange()
        low, high = np.array(bound.GetMin()), np.array(bound.GetMax())
        middle = (low + high) / 2.0
        for axis in range(3):
            way = np.eye(3)[axis]
            distance = world.cast(middle - 5 * way, [way.tolist()])["distance"][0]
            # Rays through the middle: a cone is as wide as half of its radius there.
            reach = 5.0 - distance
            half = (high - low)[axis] / 2.0
            is_side = body.startswith("/Cone") and axis != "XYZ".index(body[-1])
            assert reach == pytest.approx(half / 2.0 if is_side else half, abs=1e-4), (body, axis)
    # The apex is at the positive end.
    tip = world.cast([40.0 + 0.65, 0.0, 5.0], [[0.0, 0.0, -1.0]])["distance"][0]
    assert tip == pytest.approx(5.0 - 0.3 * 0.05 / 1.4, abs=1e-4)


SQUARE = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]


def encoded(linear: float) -> int:
    """Return the value of linear light in an image, by the curve of sRGB."""
    return round(255 * (12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055))


def test_display_colours() -> None:
    made = stage()
    constant = mesh(made, "/constant", SQUARE, [[0, 1, 2, 3]])
    constant.CreateDisplayColorAttr([(0.2, 0.0, 1.0)])
    seen = colour_seen(bv.World.from_usd(made), (0, 0, 2.0))[32, 32]
    assert seen.tolist() == [encoded(0.2), 0, 255]
    made = stage()
    uniform = mesh(made, "/uniform", [*SQUARE, [0, 0, 0]], [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    colours = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.5, 0.5, 0)]
    uniform.CreateDisplayColorPrimvar("uniform").Set(colours)
    seen = colour_seen(bv.World.from_usd(made), (0, 0, 2.0))
    for at, colour in zip(((32, 50), (14, 32), (32, 14), (50, 32)), colours, strict=True):
        assert seen[at].tolist() == [encoded(part) for part in colour]
    for interpolation, count in (("vertex", 4), ("faceVarying", 4)):
        made = stage()
        varying = mesh(made, "/varying", SQUARE, [[0, 1, 2, 3]])
        values = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)]
        varying.CreateDisplayColorPrimvar(interpolation).Set(values[:count])
        seen = colour_seen(bv.World.from_usd(made), (0, 0, 2.3)).astype(int)
        near = {(6, 57): values[1], (57, 57): values[0], (6, 6): values[2], (57, 6): values[3]}
        for at, colour in near.items():
            assert np.abs(seen[at] - np.array(colour) * 255).max() < 40, (interpolation, at)
    # Half of the black behind is seen through the surface.
    made = stage()
    clear = mesh(made, "/clear", SQUARE, [[0, 1, 2, 3]])
    clear.CreateDisplayOpacityAttr([0.5])
    clear.CreateDisplayColorAttr([(1, 0, 0)])
    np.testing.assert_allclose(colour_seen(bv.World.from_usd(made), (0, 0, 2.0))[32, 32], [128, 0, 0], atol=1)
    # A colour of a group is inherited, also by instances.
    made = stage()
    group = UsdGeom.Xform.Define(made, "/library")
    mesh(made, "/library/mesh", SQUARE, [[0, 1, 2, 3]])
    UsdGeom.Imageable(group).MakeInvisible()
    for number, colour in enumerate([(1, 0, 0), (0, 1, 0)]):
        instance = made.DefinePrim(f"/instance_{number}", "Xform")
        instance.GetReferences().AddInternalReference("/library")
        instance.SetInstanceable(True)
        UsdGeom.Imageable(instance).GetVisibilityAttr().Set("inherited")
        UsdGeom.PrimvarsAPI(instance).CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray).Set([colour])
        UsdGeom.XformCommonAPI(instance).SetTranslate((5.0 * number, 0, 0))
    world = bv.World.from_usd(made)
    assert world.bodies == ["/instance_0/mesh", "/instance_1/mesh"]
    assert colour_seen(world, (0, 0, 2.0))[32, 32].tolist() == [255, 0, 0]
    assert colour_seen(world, (5, 0, 2.0))[32, 32].tolist() == [0, 255, 0]


def test_materials_and_subsets() -> None:
    made = stage()
    red = material(made, "/red", diffuseColor=(1.0, 0.0, 0.0), roughness=0.3, metallic=0.0)
    glowing = material(made, "/glowing", diffuseColor=(0.0, 0.0, 0.0), emissiveColor=(0.0, 0.5, 0.0), opacity=1.0)
    panel = mesh(made, "/panel", [*SQUARE, [0, -1, 0], [0, 1, 0]], [[0, 4, 5, 3], [4, 1, 2, 5]])
    bind(panel, red)
    half = UsdGeom.Subset.Define(made, "/panel/half")
    half.CreateElementTypeAttr("face")
    half.CreateFamilyNameAttr("materialBind")
    half.CreateIndicesAttr([1])
    bind(half, glowing)
    world = bv.World.from_usd(made)
    assert world.bodies == ["/panel/half", "/panel"]
    seen = colour_seen(world, (0, 0, 2.0))
    np.testing.assert_allclose(seen[50, 32], [255, 0, 0], atol=2)  # −x
    np.testing.assert_allclose(seen[14, 32], [0, encoded(0.5), 0], atol=2)  # +x
    ball = UsdGeom.Sphere.Define(made, "/ball")
    bind(ball, glowing)
    place(ball, transform(1, 1.0, 0.0))
    assert colour_seen(bv.World.from_usd(made), (0, 0, 5.0))[32, 32].tolist() == [0, encoded(0.5), 0]


@pytest.mark.parametrize("package", ["", "usdz"])
def test_a_texture_of_a_file(tmp_path: Path, package: str) -> None:
    image = pytest.importorskip("PIL.Image")
    picture = np.zeros((64, 64, 3), np.uint8)
    picture[:32, :32] = [255, 0, 0]  # at the upper left: s small, t large
    picture[32:, 32:] = [0, 0, 255]
    image.fromarray(picture).save(tmp_path / "tiles.png")
    made = Usd.Stage.CreateNew(str(tmp_path / "scene.usda"))
    UsdGeom.SetStageUpAxis(made, "Z")
    UsdGeom.SetStageMetersPerUnit(made, 1.0)
    square = mesh(made, "/square", SQUARE, [[0, 1, 2, 3]])
    coordinates = UsdGeom.PrimvarsAPI(square).CreatePrimvar(
        "map", Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying"
    )
    coordinates.Set([(0, 0), (1, 0), (1, 1), (0, 1)])
    reader = shader(made, "/look/reader", "UsdPrimvarReader_float2", varname="map")
    turned = shader(
        made,
        "/look/turned",
        "UsdTransform2d",
        rotation=90.0,
        **{"in": reader.CreateOutput("result", Sdf.ValueTypeNames.Float2)},
    )
    output = turned.CreateOutput("result", Sdf.ValueTypeNames.Float2)
    texture = shader(
        made,
        "/look/texture",
        "UsdUVTexture",
        file=Sdf.AssetPath("./tiles.png"),
        st=output,
        wrapS="repeat",
        wrapT="repeat",
    )
    rgb = texture.CreateOutput("rgb", Sdf.ValueTypeNames.Float3)
    bind(square, material(made, "/look", diffuseColor=rgb, roughness=1.0))
    made.GetRootLayer().Save()
    path = tmp_path / "scene.usda"
    if package:
        from pxr import UsdUtils

        path = tmp_path / "scene.usdz"
        assert UsdUtils.CreateNewUsdzPackage(str(tmp_path / "scene.usda"), str(path))
    world = bv.World.from_usd(path)
    assert world.notes == []
    seen = colour_seen(world, (0, 0, 2.5))
    # Coordinates turned by 90°: (s, t) becomes (−t, s), which repeats as (1 − t, s). Red is where s > 1/2 and t > 1/2.
    np.testing.assert_allclose(seen[20, 20], [255, 0, 0], atol=3)  # +x, +y
    np.testing.assert_allclose(seen[45, 45], [0, 0, 255], atol=3)  # −x, −y
    np.testing.assert_allclose(seen[45, 20], [0, 0, 0], atol=3)
    (tmp_path / "tiles.png").unlink()
    if not package:
        notes = bv.World.from_usd(path).notes
        assert any(note.startswith("there is no texture ") and note.endswith("tiles.png") for note in notes)


def test_cameras_see_what_those_of_usd_see() -> None:
    made = stage("Y", 0.01)
    for number in range(12):
        mesh(made, f"/wedge_{number}", matrix=transform(number, 40.0, 150.0))
    camera = UsdGeom.Camera.Define(made, "/rig/eye")
    camera.CreateHorizontalApertureAttr(30.0)
    camera.CreateVerticalApertureAttr(20.0)
    camera.CreateHorizontalApertureOffsetAttr(3.0)
    camera.CreateVerticalApertureOffsetAttr(-2.0)
    camera.CreateFocalLengthAttr(24.0)
    camera.CreateClippingRangeAttr((1.0, 2000.0))
    look = transform(3, 1.0, 0.0)
    look[:3, 3] = look[:3, 2] * 500
    place(camera, look)
    flat = UsdGeom.Camera.Define(made, "/flat")
    flat.CreateProjectionAttr("orthographic")
    world = bv.World.from_usd(made)
    assert world.notes == ["orthographic cameras are left out"]
    assert list(world.cameras) == ["/rig/eye"]
    placed = world.cameras["/rig/eye"]
    sensor = placed.camera(90)
    assert sensor.frame_shape == (60, 90)
    depth = sensor.render(world, placed.pose, channels=("depth",))["depth"]
    # usd-core's projection of each hit is the pixel that sees it.
    frustum = camera.GetCamera(Usd.TimeCode.Default()).frustum
    project = np.array(frustum.ComputeViewMatrix() * frustum.ComputeProjectionMatrix())
    rows, columns = np.nonzero(np.isfinite(depth))
    assert len(rows) > 400
    left, right, below, above = placed.frustum
    x = left + (columns + 0.5) / 90 * (right - left)
    y = above - (rows + 0.5) / 60 * (above - below)
    z = depth[rows, columns] / 0.01
    own = np.stack([x * z, y * z, -z], axis=-1)
    matrix = np.array(UsdGeom.XformCache().GetLocalToWorldTransform(camera.GetPrim()))
    there = own @ matrix[:3, :3] + matrix[3, :3]
    clip = np.c_[there, np.ones(len(there))] @ project
    ndc = clip[:, :2] / clip[:, 3:]
    np.testing.assert_allclose((ndc[:, 0] + 1) / 2 * 90, columns + 0.5, atol=1e-3)
    np.testing.assert_allclose((1 - ndc[:, 1]) / 2 * 60, rows + 0.5, atol=1e-3)
    # The hits are on the wedges, which the sensor's pose and lens must have found, too.
    turn = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    eye = turn @ matrix[3, :3] * 0.01
    ways = there @ turn.T * 0.01 - eye
    distances = world.cast(eye, ways, faces="front")["distance"]
    assert (np.abs(distances - 1.0) < 1e-3).mean() > 0.995


def test_what_is_left_out_is_named(caplog: pytest.LogCaptureFixture) -> None:
    made = stage()
    smooth = mesh(made, "/smooth")
    smooth.GetSubdivisionSchemeAttr().Set("catmullClark")
    smooth.CreateDoubleSidedAttr(True)
    UsdGeom.BasisCurves.Define(made, "/curve")
    UsdLux.SphereLight.Define(made, "/lamp")
    mesh(made, "/guide").CreatePurposeAttr("guide")
    UsdGeom.Imageable(mesh(made, "/hidden")).MakeInvisible()
    UsdGeom.Mesh.Define(made, "/nothing").CreateSubdivisionSchemeAttr("none")
    odd = UsdShade.Material.Define(made, "/odd")
    node = UsdShade.Shader.Define(made, "/odd/node")
    node.CreateIdAttr("ND_standard_surface_surfaceshader")
    odd.CreateSurfaceOutput().ConnectToSource(node.ConnectableAPI(), "surface")
    bind(mesh(made, "/strange"), odd)
    with caplog.at_level(logging.WARNING, "belvedere"):
        world = bv.World.from_usd(made)
    assert world.bodies == ["/smooth", "/strange"]
    assert set(world.notes) == {
        "meshes with a subdivision scheme are shown without subdivision",
        "the insides of double-sided surfaces are not seen by cameras",
        "prims of the type BasisCurves are left out",
        "lights of the type SphereLight are left out; World.add_light adds some",
        "meshes without triangles or without an extent are left out",
        "materials of the type ND_standard_surface_surfaceshader are not shown, only the primvar displayColor of "
        "their shapes",
    }
    assert [record.getMessage() for record in caplog.records] == world.notes


def test_values_at_a_time() -> None:
    made = stage()
    ball = UsdGeom.Sphere.Define(made, "/ball")
    move = UsdGeom.Xformable(ball).AddTranslateOp()
    move.Set((1, 0, 0), 1.0)
    move.Set((3, 0, 0), 3.0)
    assert bv.World.from_usd(made).pose("/ball")[0] == 1.0
    assert bv.World.from_usd(made, time=2.0).pose("/ball")[0] == 2.0


def test_bad_input_is_one_clear_error(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"stage: a pxr.Usd.Stage or a path is expected, not int"):
        bv.World.from_usd(3)
    with pytest.raises(ValueError, match=r"stage: '.*none.usda' cannot be opened"):
        bv.World.from_usd(tmp_path / "none.usda")
    (tmp_path / "bad.usda").write_text("#usda 1.0\ndef Xform {")
    with pytest.raises(ValueError, match=r"stage: '.*bad.usda' cannot be opened"):
        bv.World.from_usd(tmp_path / "bad.usda")
    made = stage()
    mesh(made, "/mesh").GetFaceVertexIndicesAttr().Set([0, 1, 99] * 5)
    with pytest.raises(ValueError, match="mesh '/mesh': faceVertexCounts sum to 18, and there are 15 indices"):
        bv.World.from_usd(made)
    mesh(made, "/mesh", rings=[[0, 1, 99]])
    with pytest.raises(ValueError, match="mesh '/mesh': faceVertexIndices are from 0 to 5, not 99"):
        bv.World.from_usd(made)
    with pytest.raises(ValueError, match="time: a number is expected"):
        bv.World.from_usd(stage(), time=float("nan"))
