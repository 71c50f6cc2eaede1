"""Textures, highlights and lamps of models of MuJoCo."""

from __future__ import annotations

import struct
import zlib

import numpy as np
import pytest
from numpy.typing import NDArray

mujoco = pytest.importorskip("mujoco")
bvm = pytest.importorskip("belvedere.mujoco")


def test_colours_are_those_of_materials_and_lamps() -> None:
    model = mujoco.MjModel.from_xml_string("""
        <mujoco>
          <visual><headlight ambient="0.2 0.2 0.2" diffuse="0 0 0" specular="0 0 0"/></visual>
          <asset>
            <texture name="halves" type="2d" builtin="checker" width="64" height="64" rgb1="1 0 0" rgb2="0 1 0"/>
            <material name="halves" texture="halves" texrepeat="1 1" specular="0"/>
            <material name="glowing" rgba="0.5 0.25 0 1" emission="1" specular="0"/>
          </asset>
          <worldbody>
            <geom type="plane" size="1 1 1" material="halves"/>
            <geom type="box" size="0.5 0.5 0.5" pos="3 0 0" material="glowing"/>
            <camera name="down" pos="0 0 3" fovy="30"/>
            <camera name="at_box" pos="3 0 3" fovy="30"/>
          </worldbody>
        </mujoco>""")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    scene = bvm.Scene(model)
    assert scene.notes == []
    tiles = scene.camera("down", 64, 64).render(data)["rgb"]
    # A checker of MuJoCo has its first colour at the first pixel; half a texture away from the middle of the plane.
    corners = [tiles[row, column].tolist() for row, column in ((20, 20), (20, 44), (44, 20), (44, 44))]
    assert sorted(map(tuple, corners)) == [(0, 51, 0), (0, 51, 0), (51, 0, 0), (51, 0, 0)]
    assert corners[0] == corners[3]
    box = scene.camera("at_box", 64, 64).render(data)["rgb"][32, 32]
    assert box.tolist() == [153, 77, 0]


def picture_of(size: str, material: str, camera: str) -> NDArray[np.uint8]:
    """A picture, from above, of a plane with a texture of 64 × 64 whose red is 4 × column and green 4 × row."""
    model = mujoco.MjModel.from_xml_string(f"""
        <mujoco>
          <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
          <asset>
            <texture name="t" type="2d" builtin="checker" width="64" height="64"/>
            <material name="m" texture="t" specular="0" {material}/>
          </asset>
          <worldbody><geom type="plane" size="{size}" material="m"/><camera name="c" {camera}/></worldbody>
        </mujoco>""")
    texels = np.zeros((64, 64, 3), np.uint8)
    texels[..., 0], texels[..., 1] = 4 * np.arange(64), 4 * np.arange(64)[:, None]
    model.tex_data[:] = texels.ravel()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return bvm.Scene(model).camera("c", 64, 64).render(data)["rgb"]


@pytest.mark.parametrize(
    ("size", "material", "phase"),
    [
        # The middle is this fraction of the texture from its left and its upper edge, in MuJoCo's own pictures.
        ("0.4 0.7 1", 'texrepeat="1 1" texuniform="true"', (0.2, 0.35)),
        ("2 1.5 1", 'texrepeat="0.7 1.3" texuniform="true"', (0.7, 0.975)),
        ("2 1.5 1", 'texrepeat="0.7 1.3"', (0.35, 0.65)),
        ("0 0 1", 'texrepeat="0.5 0.3"', (0.5, 0.5)),
    ],
)
def test_textures_of_planes_lie_where_mujoco_has_them(size: str, material: str, phase: tuple[float, float]) -> None:
    middle = picture_of(size, material, 'pos="0 0 1" fovy="10"')[32, 32]
    np.testing.assert_allclose(middle[:2] / 256.0, phase, atol=0.025)


def test_a_spotlight_has_the_falloff_of_mujoco() -> None:
    for exponent in (1, 10):
        cutoff = 90 if exponent == 1 else 80
        model = mujoco.MjModel.from_xml_string(f"""
            <mujoco>
              <visual><headlight active="0"/></visual>
              <asset><material name="dull" rgba="1 1 1 1" specular="0"/></asset>
              <worldbody>
                <geom type="plane" size="3 3 1" material="dull"/>
                <light pos="0 0 1" dir="0 0 -1" diffuse="0.8 0.8 0.8" specular="0 0 0" ambient="0 0 0"
                       castshadow="false" exponent="{exponent}" cutoff="{cutoff}"/>
                <camera name="down" pos="0 0 2" fovy="60"/>
              </worldbody>
            </mujoco>""")
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        scene = bvm.Scene(model)
        assert not any("edge" in note for note in scene.notes)
        row = scene.camera("down", 65, 65).render(data)["rgb"][32, :, 0] / 255.0
        away = (np.arange(65) - 32) * 2.0 * np.tan(np.radians(30)) / 65 * 2.0
        cosine = 1.0 / np.hypot(1.0, away)
        np.testing.assert_allclose(row, 0.8 * cosine * cosine**exponent, atol=0.01)


@pytest.mark.parametrize("mode", ["targetbody", "targetbodycom"])
@pytest.mark.parametrize("form", ["spot", "directional"])
def test_a_lamp_that_follows_a_body_looks_at_it(mode: str, form: str) -> None:
    def seen(light: str) -> NDArray[np.uint8]:
        model = mujoco.MjModel.from_xml_string(f"""
            <mujoco>
              <visual><headlight active="0"/></visual>
              <worldbody>
                <geom type="plane" size="3 3 1"/>
                <light pos="-1 0 1" type="{form}" cutoff="90" exponent="20" {light}/>
                <body name="ball" pos="1 0 0"><geom type="sphere" size="0.1"/></body>
                <camera name="down" pos="0 0 4" fovy="50"/>
              </worldbody>
            </mujoco>""")
        # Without directions of lamps, they keep those of the first pose.
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        state = {name: getattr(data, name)[None] for name in ("geom_xpos", "geom_xmat", "cam_xpos", "cam_xmat")}
        return bvm.Scene(model).camera("down", 64, 64).render(state)["rgb"]

    following = seen(f'mode="{mode}" target="ball"')
    assert (following == seen('dir="2 0 -1"')).all()
    assert (following != seen('dir="0 0 -1"')).any()


def test_highlights_have_the_colour_of_the_texture() -> None:
    model = mujoco.MjModel.from_xml_string("""
        <mujoco>
          <visual><headlight ambient="0 0 0" diffuse="0 0 0" specular="0.8 0.8 0.8"/></visual>
          <asset>
            <texture name="t" type="2d" builtin="flat" rgb1="0.5 0.25 0" width="8" height="8"/>
            <material name="m" texture="t" specular="1" shininess="0.2"/>
          </asset>
          <worldbody><geom type="plane" size="1 1 1" material="m"/><camera name="down" pos="0 0 2"/></worldbody>
        </mujoco>""")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    middle = bvm.Scene(model).camera("down", 9, 9).render(data)["rgb"][4, 4].astype(int)
    np.testing.assert_allclose(middle, [0.8 * 255 * 0.5, 0.8 * 255 * 0.25, 0], atol=3)


def test_light_is_limited_before_it_is_multiplied_by_a_texture() -> None:
    model = mujoco.MjModel.from_xml_string("""
        <mujoco>
          <visual><headlight ambient="0.5 0.2 0" diffuse="0 0 0" specular="0.9 0.9 0.9"/></visual>
          <asset>
            <texture name="t" type="2d" builtin="flat" rgb1="0.4 0.4 0.4" width="8" height="8"/>
            <material name="m" texture="t" specular="1" shininess="0.2" emission="0.1"/>
          </asset>
          <worldbody>
            <light directional="true" dir="0 0 -1" diffuse="0.5 0.2 0" specular="0 0 0" castshadow="false"/>
            <light directional="true" dir="0 0 -1" diffuse="1.5 0.2 0" specular="0 0 0"/>
            <geom type="plane" size="1 1 1" material="m"/>
            <camera name="down" pos="0 0 2"/>
          </worldbody>
        </mujoco>""")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    middle = bvm.Scene(model).camera("down", 9, 9).render(data)["rgb"][4, 4].astype(int)
    # MuJoCo adds the light of a lamp with shadows after both were limited and multiplied.
    light = [min(0.1 + 0.5 + 0.5 + 0.9, 1.0) + 1.0, min(0.1 + 0.2 + 0.2 + 0.9, 1.0) + 0.2, min(0.1 + 0.9, 1.0)]
    np.testing.assert_allclose(middle, np.array(light) * 0.4 * 255, atol=2)


def test_black_tiles_have_no_highlight() -> None:
    model = mujoco.MjModel.from_xml_string("""
        <mujoco>
          <visual><headlight ambient="0.1 0.1 0.1" diffuse="0.1 0.1 0.1" specular="0.8 0.8 0.8"/></visual>
          <asset>
            <texture name="t" type="2d" builtin="checker" rgb1="0 0 0" rgb2="1 1 1" width="64" height="64"/>
            <material name="m" texture="t" specular="1" shininess="0.01" emission="0.1"/>
          </asset>
          <worldbody><geom type="plane" size="1 1 1" material="m"/><camera name="down" pos="0 0 2"/></worldbody>
        </mujoco>""")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    tiles = bvm.Scene(model).camera("down", 65, 65).render(data)["rgb"]
    corners = [tiles[row, column].tolist() for row, column in ((24, 24), (40, 24), (24, 40), (40, 40))]
    black, white = sorted(corners)[:2], sorted(corners)[2:]
    assert black == [[0, 0, 0]] * 2
    assert min(min(white)) > 220


def test_textures_of_srgb_are_shown_by_their_linear_values() -> None:
    def middle(colorspace: str) -> list[int]:
        model = mujoco.MjModel.from_xml_string(f"""
            <mujoco>
              <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
              <asset>
                <texture name="t" type="2d" builtin="flat" rgb1="0.8 0.5 0.02" width="8" height="8" {colorspace}/>
                <material name="m" texture="t" specular="0"/>
              </asset>
              <worldbody><geom type="plane" size="1 1 1" material="m"/><camera name="down" pos="0 0 2"/></worldbody>
            </mujoco>""")
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        return bvm.Scene(model).camera("down", 9, 9).render(data)["rgb"][4, 4].tolist()

    assert middle("") == middle('colorspace="linear"') == [204, 127, 5]
    # Those of MuJoCo's pictures.
    assert middle('colorspace="sRGB"') == [154, 54, 0]


def test_highlights_of_shininess_0_are_everywhere() -> None:
    model = mujoco.MjModel.from_xml_string("""
        <mujoco>
          <visual><headlight ambient="0 0 0" diffuse="0 0 0" specular="0.5 0.5 0.5"/></visual>
          <asset><material name="m" rgba="1 0 0 1" specular="0.8" shininess="0"/></asset>
          <worldbody><geom type="plane" size="5 5 1" material="m"/><camera name="down" pos="0 0 2" fovy="90"/></worldbody>
        </mujoco>""")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    picture = bvm.Scene(model).camera("down", 32, 32).render(data)["rgb"]
    # That of MuJoCo's pictures, too.
    assert np.unique(picture).tolist() == [102]


#: The colours of the faces of a cube, right, left, up, down, front and back.
FACES = np.array([[200, 0, 0], [100, 0, 0], [0, 200, 0], [0, 100, 0], [0, 0, 200], [0, 0, 100]], np.uint8)
#: Cameras that look along the axes.
AXES = {
    "+x": "0 -1 0 0 0 1",
    "-x": "0 1 0 0 0 1",
    "+y": "1 0 0 0 0 1",
    "-y": "-1 0 0 0 0 1",
    "+z": "1 0 0 0 -1 0",
    "-z": "1 0 0 0 1 0",
}


def seen_along_axes(assets: str, geoms: str, away: float, texels: NDArray[np.uint8]) -> dict[str, list[int]]:
    """The colours that cameras see in their middle, which look along the axes, towards the origin from this far away."""
    cameras = ""
    for way, axes in AXES.items():
        place = [0.0, 0.0, 0.0]
        place["xyz".index(way[1])] = -away if way[0] == "+" else away
        cameras += f'<camera name="{way}" pos="{place[0]} {place[1]} {place[2]}" xyaxes="{axes}" fovy="5"/>'
    model = mujoco.MjModel.from_xml_string(f"""
        <mujoco>
          <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
          <asset>{assets}</asset>
          <worldbody>{geoms}{cameras}</worldbody>
        </mujoco>""")
    model.tex_data[:] = texels.ravel()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    scene = bvm.Scene(model)
    assert scene.notes == []
    return {way: scene.camera(way, 9, 9).render(data)["rgb"][4, 4].tolist() for way in AXES}


def test_the_sky_is_that_of_mujoco() -> None:
    texels = np.broadcast_to(FACES[:, None, None], (6, 4, 4, 3))
    sky = '<texture name="sky" type="skybox" builtin="flat" width="4" height="24"/>'
    seen = seen_along_axes(sky, "", 1.0, texels)
    # In MuJoCo's own pictures, +y shows the back and −y the front.
    assert seen == dict(zip(("+x", "-x", "+z", "-z", "-y", "+y"), FACES.tolist(), strict=True))
    # Without a sky, there is nothing.
    assert set(map(tuple, seen_along_axes("", "", 1.0, np.zeros(0, np.uint8)).values())) == {(0, 0, 0)}


@pytest.mark.parametrize("uniform", ["true", "false"])
@pytest.mark.parametrize(
    "geom",
    ['type="box" size="0.3 0.4 0.5"', 'type="ellipsoid" size="0.3 0.4 0.5"', 'type="capsule" size="0.3 0.4"'],
)
def test_cube_textures_of_geoms_are_those_of_mujoco(geom: str, uniform: str) -> None:
    texels = np.broadcast_to(FACES[:, None, None], (6, 4, 4, 3))
    assets = f"""<texture name="t" type="cube" builtin="flat" width="4" height="24"/>
        <material name="m" texture="t" texuniform="{uniform}" specular="0" rgba="1 1 1 1"/>"""
    # The same geom twice shares the texture.
    geoms = f'<geom material="m" {geom}/><geom material="m" {geom} pos="50 50 50"/>'
    seen = seen_along_axes(assets, geoms, 3.0, texels)
    # What a camera sees that looks along +x is the face at −x.
    assert seen == dict(zip(("-x", "+x", "-y", "+y", "-z", "+z"), FACES.tolist(), strict=True))


def test_a_cube_texture_of_one_image_is_on_all_sides() -> None:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header, rows = struct.pack(">IIBBBBB", 4, 4, 8, 2, 0, 0, 0), (b"\0" + bytes((30, 60, 90)) * 4) * 4
    parts = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    model = mujoco.MjModel.from_xml_string(
        """<mujoco>
          <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
          <asset>
            <texture name="t" type="cube" file="t.png"/><texture name="sky" type="skybox" file="t.png"/>
            <material name="m" texture="t" specular="0"/>
          </asset>
          <worldbody><geom size="0.4" material="m"/><camera name="c" pos="0 0 2"/></worldbody>
        </mujoco>""",
        {"t.png": b"\x89PNG\r\n\x1a\n" + parts},
    )
    assert model.tex_height.tolist() == [4, 4]
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    picture = bvm.Scene(model).camera("c", 32, 32).render(data)["rgb"]
    assert np.unique(picture.reshape(-1, 3), axis=0).tolist() == [[30, 60, 90]]


@pytest.mark.parametrize("uniform", ["true", "false"])
def test_images_lie_flat_on_meshes_without_coordinates(uniform: str) -> None:
    def seen(texcoord: str) -> NDArray[np.uint8]:
        model = mujoco.MjModel.from_xml_string(f"""
            <mujoco>
              <asset>
                <texture name="tiles" type="2d" builtin="checker" rgb1="1 0 0" rgb2="0 0 1" width="8" height="8"/>
                <material name="tiled" texture="tiles" texrepeat="3 2" texuniform="{uniform}" rgba="1 0.9 1 1"/>
                <mesh name="wedge" vertex="-1 -0.5 0  1 -0.6 0.1  0.9 0.5 0  -1 0.7 0.2  0 0 1"
                      face="0 1 4  1 2 4  2 3 4  3 0 4  0 2 1  0 3 2" {texcoord}/>
              </asset>
              <worldbody>
                <geom type="mesh" mesh="wedge" material="tiled" euler="20 10 30"/>
                <camera name="eye" pos="0 -3 2" xyaxes="1 0 0 0 0.6 0.8"/>
              </worldbody>
            </mujoco>""")
        if texcoord:
            # Those of an image that is as large as the geom, or two metres, and is repeated from its middle.
            halves = np.ones(2) if uniform == "true" else model.geom_size[0, :2]
            middle = 0.5 * model.mesh_vert[:, :2] / halves * (1.0, -1.0)
            model.mesh_texcoord[:] = middle + 0.5 / model.mat_texrepeat[0]
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        scene = bvm.Scene(model)
        assert scene.notes == []
        return scene.camera("eye", 64, 48).render(data)["rgb"]

    own, given = seen(""), seen('texcoord="0 0  0 0  0 0  0 0  0 0"')
    assert len(np.unique(own.reshape(-1, 3), axis=0)) > 20
    # Texture coordinates are rounded in another way, which matters at the edge of a tile.
    assert (np.abs(own.astype(int) - given).max(axis=-1) > 2).mean() < 0.01


def test_an_image_on_a_flat_height_field_is_that_of_a_plane() -> None:
    def seen(geom: str) -> NDArray[np.uint8]:
        model = mujoco.MjModel.from_xml_string(f"""
            <mujoco>
              <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
              <asset>
                <texture name="blend" type="2d" builtin="gradient" rgb1="1 0 0" rgb2="0 0 1" width="8" height="8"/>
                <material name="painted" texture="blend" specular="0"/>
                <hfield name="flat" nrow="3" ncol="3" size="1 1.5 1 0.3"/>
              </asset>
              <worldbody>
                <geom material="painted" {geom}/>
                <camera name="down" pos="0 0 2" xyaxes="1 0.2 0 -0.2 1 0"/>
              </worldbody>
            </mujoco>""")
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        return bvm.Scene(model).camera("down", 48, 48).render(data)["rgb"]

    hills, plane = seen('type="hfield" hfield="flat"'), seen('type="plane" size="1 1.5 1"')
    assert np.ptp(plane[24, 24].astype(int) - plane[20, 4]) > 0
    np.testing.assert_allclose(hills.astype(int), plane, atol=1)


@pytest.mark.parametrize(
    "geom",
    [
        'type="box" size="0.4 0.4 0.1"',
        'type="sphere" size="0.4"',
        'type="capsule" size="0.3 0.3"',
        'type="cylinder" size="0.3 0.3"',
        'type="ellipsoid" size="0.3 0.4 0.5"',
        'type="mesh" mesh="wedge"',
        'type="plane" size="0.5 0.5 0.1"',
    ],
)
def test_both_sides_of_a_transparent_shape_count(geom: str) -> None:
    model = mujoco.MjModel.from_xml_string(f"""
        <mujoco>
          <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
          <asset><mesh name="wedge" vertex="-1 -1 0  1 -1 0  1 1 0  -1 1 0  0 0 0.5  0 0 -0.5"/></asset>
          <worldbody>
            <geom type="plane" size="4 4 1" rgba="0 0 1 1"/>
            <geom {geom} pos="0.02 0.05 1" rgba="1 0 0 0.2"/>
            <camera name="down" pos="0 0 4" fovy="10"/>
          </worldbody>
        </mujoco>""")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    middle = bvm.Scene(model).camera("down", 9, 9).render(data)["rgb"][4, 4] / 255.0
    # What MuJoCo's pictures have in the middle of these shapes.
    opacity = 0.2 if "plane" in geom else 1.0 - 0.8**2
    np.testing.assert_allclose(middle, (opacity, 0.0, 1.0 - opacity), atol=0.005)
