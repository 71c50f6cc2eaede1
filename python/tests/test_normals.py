"""Normals of vertices: meshes look round, and are measured as triangles."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import belvedere as bv

#: Half a tube of radius 1 along z, open towards -x, of six faces.
_TURNS = np.linspace(-np.pi / 2, np.pi / 2, 7)
_ROUND = np.array([[-np.cos(turn), np.sin(turn), 0.0] for turn in _TURNS])
_UP = np.array([0.0, 0.0, 1.0])
CORNERS = np.concatenate([_ROUND - _UP, _ROUND + _UP])
NORMALS = np.concatenate([_ROUND, _ROUND])
FACES = np.array([face for i in range(6) for face in ([i, i + 7, i + 1], [i + 1, i + 7, i + 8])])
CAMERA = bv.Camera(200, 40, 0.6)
#: From -x, along x.
HERE = np.array([[1.0, 0, 0, -5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def lit(**normals: Any) -> bv.World:
    world = bv.World()
    world.set_environment(ambient=(0, 0, 0), background=(0, 0, 0))
    world.add_mesh(CORNERS, FACES, color=(1, 1, 1), **normals)
    world.add_light("directional", direction=(1, 0, 0), color=(1, 1, 1), shadows=False)
    return world


def test_a_tube_of_six_faces_is_lit_as_a_round_one() -> None:
    row = {}
    for name, world in {"round": lit(normals=3.0 * NORMALS), "flat": lit()}.items():
        frame = CAMERA.render(world, HERE, channels=("rgb", "depth", "normal"))
        row[name] = frame["rgb"][20, :, 0].astype(int)
        row[f"{name} truth"] = np.concatenate([frame["depth"][..., None], frame["normal"]], axis=-1)
    seen = row["flat"] > 0
    assert seen.sum() > 100
    # Faces have few brightnesses, a round tube has one at each pixel.
    assert len(np.unique(row["flat"][seen])) < 5
    assert np.abs(np.diff(row["round"][seen][8:-8])).max() <= 8
    np.testing.assert_array_equal(row["round truth"], row["flat truth"])


@pytest.mark.parametrize(
    ("normals", "words"),
    [
        (NORMALS[1:], r"normals: shape \(13, 3\); \(14, 3\), one a vertex, is expected"),
        (NORMALS[:, :2], "normals: shape"),
        (
            np.where(np.arange(14)[:, None] == 3, 0.0, NORMALS),
            "normals: the normal of vertex 3 is not finite, or is 0",
        ),
        (np.full((14, 3), np.nan), "normals"),
        ("up", "normals"),
    ],
)
def test_bad_normals_are_refused(normals: Any, words: str) -> None:
    world = bv.World()
    with pytest.raises(ValueError, match=words):
        world.add_mesh(CORNERS, FACES, normals=normals)
    assert world.bodies == []


def test_trimesh_gives_the_normals_that_a_mesh_holds() -> None:
    trimesh = pytest.importorskip("trimesh")

    def seen(**normals: Any) -> Any:
        world = bv.World.from_trimesh(trimesh.Trimesh(CORNERS, FACES, process=False, **normals))
        world.add_light("directional", direction=(1, 0, 0), color=(1, 1, 1), shadows=False)
        return CAMERA.render(world, HERE)["rgb"]

    assert len(np.unique(seen()[20])) < 8
    assert len(np.unique(seen(vertex_normals=NORMALS)[20])) > 20


def test_mujoco_gives_the_normals_of_its_meshes() -> None:
    mujoco = pytest.importorskip("mujoco")
    geoms = pytest.importorskip("belvedere.mujoco._geoms")
    vertices = " ".join(str(value) for value in CORNERS.round(6).reshape(-1))
    faces = " ".join(str(value) for value in FACES.reshape(-1))
    xml = (
        f'<mujoco><asset><mesh name="tube" vertex="{vertices}" face="{faces}" inertia="shell"/></asset>'
        '<worldbody><geom type="mesh" mesh="tube"/></worldbody></mujoco>'
    )
    model = mujoco.MjModel.from_xml_string(xml)
    places, numbers, uvs, normals = geoms.mesh(model, 0)
    assert uvs is None
    assert places.shape == normals.shape
    np.testing.assert_array_equal(places[numbers], model.mesh_vert[model.mesh_face])
    np.testing.assert_array_equal(normals[numbers], model.mesh_normal[model.mesh_facenormal])


@pytest.mark.parametrize("interpolation", ["vertex", "faceVarying"])
def test_usd_gives_the_normals_of_meshes_without_subdivision(interpolation: str) -> None:
    usd, geom = pytest.importorskip("pxr.Usd"), pytest.importorskip("pxr.UsdGeom")

    def colours(scheme: str) -> int:
        stage = usd.Stage.CreateInMemory()
        geom.SetStageUpAxis(stage, "Z")
        geom.SetStageMetersPerUnit(stage, 1.0)
        mesh = geom.Mesh.Define(stage, "/tube")
        mesh.CreatePointsAttr(CORNERS.tolist())
        mesh.CreateFaceVertexCountsAttr([3] * len(FACES))
        mesh.CreateFaceVertexIndicesAttr(FACES.reshape(-1).tolist())
        mesh.CreateSubdivisionSchemeAttr(scheme)
        mesh.CreateNormalsAttr((NORMALS if interpolation == "vertex" else NORMALS[FACES.reshape(-1)]).tolist())
        mesh.SetNormalsInterpolation(interpolation)
        world = bv.World.from_usd(stage)
        world.add_light("directional", direction=(1, 0, 0), color=(1, 1, 1), shadows=False)
        return len(np.unique(CAMERA.render(world, HERE)["rgb"][20]))

    assert colours("none") > 20
    assert colours("catmullClark") < 8
