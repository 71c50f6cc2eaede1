"""Compares pictures of belvedere.mujoco with those of MuJoCo's own renderer, on models of packages.

    MUJOCO_GL=egl python tests/mujoco/renderer.py                        # gymnasium's models, as in CI
    MUJOCO_GL=egl python tests/mujoco/renderer.py --all                  # also dm_control, gymnasium-robotics, robosuite
    MUJOCO_GL=egl python tests/mujoco/renderer.py --picture docs/mujoco.webp

Each model is in a random state. OpenGL draws curved geoms as triangles, of which there are many here, and computes the
light at their corners. Sites and other decoration are hidden, and so are reflections and haze, which docs/mujoco.md lists
as differences. Then

- geoms are the same, or lie in the same place, but at outlines,
- on flat shapes, half of the depths agree to 5 in a million; 99.9 % of all to 0.2 %,
- mean colours of blocks of 8 × 8 pixels agree, on geoms and in the sky: in gymnasium's models, in one whose textures get
  more light than they can show, and in one whose shapes and whose sky show a cube of random colours. Other models have
  planes at whose corners there is no highlight, so their colours are only printed.
"""

from __future__ import annotations

import argparse
import importlib.util
import itertools
import logging
import os
import pathlib
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

os.environ.setdefault("MUJOCO_GL", "egl")

import mujoco
import numpy as np

import belvedere.mujoco as bvm

WIDTH, HEIGHT = 320, 240
BLOCK = 8
#: The models of CI, in gymnasium.
MODELS = (
    "ant", "half_cheetah", "hopper", "humanoid", "humanoidstandup", "inverted_double_pendulum", "inverted_pendulum",
    "point", "pusher_v5", "reacher", "swimmer", "walker2d_v5",
)  # fmt: skip
#: The models of other packages.
OTHERS = {
    "dm_control": ("suite/*.xml", "locomotion/walkers/assets/*.xml", "third_party/*/*.xml"),
    "gymnasium_robotics": (
        "envs/assets/fetch/*.xml",
        "envs/assets/hand/*.xml",
        "envs/assets/adroit_hand/adroit_*.xml",
        "envs/assets/kitchen_franka/kitchen_assets/kitchen_env_model.xml",
    ),
    "mjlab": ("asset_zoo/robots/*/xmls/*.xml",),
    "robosuite": ("models/assets/robots/*/robot.xml", "models/assets/arenas/*.xml"),
}
#: Geoms that are drawn with their true surface.
FLAT = tuple(int(getattr(mujoco.mjtGeom, f"mjGEOM_{kind}")) for kind in ("PLANE", "BOX", "MESH", "HFIELD"))
#: Most of the pixels whose geom differs, and of those that are not at an outline.
MOST_OTHERS, MOST_INSIDE = 5e-3, 1e-4
#: Most of the relative difference of depths: the median on flat shapes, and that of 99.9 % of all.
MOST_MEDIAN, MOST_DEPTH = 5e-6, 2e-3
#: Most of the mean difference of colours, of 255, in blocks.
MOST_COLOUR = 1.5
#: Textures of a plane and of a mesh, this one in sRGB, with highlights, emitted light, and more light from lamps than 1:
#: of those without shadows together, and of the one with shadows.
BRIGHT = """
<mujoco model="bright textures">
  <visual>
    <headlight ambient="0.3 0.3 0.3" diffuse="0.4 0.4 0.4" specular="0.5 0.5 0.5"/>
    <map znear="0.01"/>
  </visual>
  <statistic center="0 0 0" extent="4"/>
  <asset>
    <texture name="tiles" type="2d" builtin="checker" rgb1="0.1 0.2 0.3" rgb2="0.4 0.5 0.4" width="64" height="64"/>
    <texture name="blend" type="2d" builtin="gradient" rgb1="0.8 0.6 0.3" rgb2="0.3 0.4 0.7"
             width="64" height="64" colorspace="sRGB"/>
    <material name="tiles" texture="tiles" texrepeat="3 3" specular="0.6" shininess="0.1" emission="0.1"/>
    <material name="blend" texture="blend" rgba="0.9 0.8 0.7 1" specular="0.6" shininess="0.1" emission="0.3"/>
    <mesh name="wedge" vertex="-1 -1 0  1 -1 0  1 1 0  -1 1 0  -1 1 1  1 1 1" face="0 1 5  0 5 4  1 2 5  0 4 3  2 3 4  2 4 5"
          texcoord="0 0  1 0  1 0.8  0 0.8  0 1  1 1" inertia="shell" smoothnormal="false"/>
  </asset>
  <worldbody>
    <light directional="true" pos="0 0 4" dir="0.2 0.3 -1" diffuse="0.3 0.3 0.3" specular="0.4 0.4 0.4" castshadow="false"/>
    <light directional="true" pos="0 0 4" dir="-0.3 0.1 -1" diffuse="1 0.9 0.8" specular="0.5 0.5 0.5"/>
    <geom type="plane" size="4 4 1" material="tiles"/>
    <geom type="mesh" mesh="wedge" pos="0 0.5 0.01" material="blend"/>
    <geom type="sphere" size="0.4" pos="-1.5 -0.5 0.4"/>
    <camera name="down" pos="0 0 6" fovy="50"/>
    <camera name="aslant" pos="-1 -5 3" xyaxes="1 -0.2 0 0.1 0.5 0.86" fovy="50"/>
  </worldbody>
</mujoco>
"""
#: Cube textures on shapes of all kinds, of their size and of a metre, and as the sky. Their colours are random.
CUBES = """
<mujoco model="cube textures">
  <visual><headlight ambient="0.6 0.6 0.6" diffuse="0.3 0.3 0.3" specular="0 0 0"/></visual>
  <statistic center="0 0 0" extent="6"/>
  <asset>
    <texture name="sky" type="skybox" builtin="flat" width="4" height="24"/>
    <texture name="cube" type="cube" builtin="flat" width="4" height="24"/>
    <material name="fitting" texture="cube" specular="0"/>
    <material name="uniform" texture="cube" texuniform="true" specular="0"/>
    <mesh name="wedge" vertex="-1 -1 0  1 -1 0  1 1 0  -1 1 0  -1 1 1  1 1 1" face="0 1 5  0 5 4  1 2 5  0 4 3  2 3 4  2 4 5"
          inertia="shell" smoothnormal="false"/>
    <hfield name="hills" nrow="3" ncol="3" size="1 1.5 1 0.3" elevation="0 1 0 1 2 1 0 1 0"/>
  </asset>
  <default>
    <default class="uniform"><geom material="uniform"/></default>
    <default class="fitting"><geom material="fitting"/></default>
  </default>
  <worldbody>
    <geom class="fitting" type="box" size="0.5 1 0.8" pos="-3 -2 0" euler="10 20 30"/>
    <geom class="fitting" type="sphere" size="0.9" pos="-1 -2 0" euler="10 20 30"/>
    <geom class="fitting" type="capsule" size="0.5 0.7" pos="1 -2 0" euler="40 20 30"/>
    <geom class="fitting" type="cylinder" size="0.6 0.9" pos="3 -2 0" euler="50 20 30"/>
    <geom class="fitting" type="ellipsoid" size="0.9 0.5 0.7" pos="-3 2 0" euler="10 20 30"/>
    <geom class="fitting" type="mesh" mesh="wedge" pos="-1 2 0"/>
    <geom class="fitting" type="hfield" hfield="hills" pos="1 2 0"/>
    <geom class="fitting" type="plane" size="0.7 1.1 1" pos="3 2 0.5"/>
    <geom class="uniform" type="box" size="0.5 0.3 0.8" pos="-3 -5 0" euler="10 20 30"/>
    <geom class="uniform" type="capsule" size="0.5 0.7" pos="-1 -5 0" euler="40 20 30"/>
    <geom class="uniform" type="ellipsoid" size="0.9 0.5 0.7" pos="1 -5 0" euler="10 20 30"/>
    <geom class="uniform" type="mesh" mesh="wedge" pos="3 -5 0"/>
    <geom class="uniform" type="plane" size="0.7 1.1 1" pos="3 5 0.5"/>
    <camera name="front" pos="0 -10 3" xyaxes="1 0 0 0 0.2 1" fovy="60"/>
    <camera name="below" pos="1 9 -6" xyaxes="-1 0.1 0 0 0.7 1" fovy="90"/>
  </worldbody>
</mujoco>
"""
#: Images on meshes and height fields without texture coordinates, of their size and of two metres.
IMAGES = """
<mujoco model="images without coordinates">
  <visual><headlight ambient="0.6 0.6 0.6" diffuse="0.3 0.3 0.3" specular="0 0 0"/></visual>
  <statistic center="0 0 0" extent="4"/>
  <asset>
    <texture name="image" type="2d" builtin="flat" width="8" height="16"/>
    <material name="fitting" texture="image" texrepeat="1.5 0.7" specular="0"/>
    <material name="uniform" texture="image" texrepeat="1.5 0.7" texuniform="true" specular="0"/>
    <mesh name="wedge" vertex="-1 -1 0  1 -1 0  1 0.8 0  -1 1 0  -1 1 1  1 0.9 1" inertia="shell" smoothnormal="false"
          face="0 1 5  0 5 4  1 2 5  0 4 3  2 3 4  2 4 5"/>
    <hfield name="hills" nrow="3" ncol="3" size="1 1.5 1 0.3" elevation="0 1 0 1 2 1 0 1 0"/>
  </asset>
  <worldbody>
    <geom type="mesh" mesh="wedge" material="fitting" pos="-1.2 1.5 0" euler="10 20 30"/>
    <geom type="mesh" mesh="wedge" material="uniform" pos="-1.2 -1.5 0" euler="10 20 30"/>
    <geom type="hfield" hfield="hills" material="fitting" pos="1.2 1.5 0"/>
    <geom type="hfield" hfield="hills" material="uniform" pos="1.2 -1.5 0"/>
    <camera name="above" pos="0 -3 5" xyaxes="1 0 0 0 0.86 0.5" fovy="60"/>
  </worldbody>
</mujoco>
"""


@dataclass(frozen=True)
class Differences:
    """How the pictures of a camera differ."""

    others: float
    inside: float
    median: float
    depth: float
    colour: float
    blocks: float
    sky: float

    def __str__(self) -> str:
        return (
            f"geoms {self.others:.3%}, inside {self.inside:.3%}; depths {self.median:.1e}, {self.depth:.1e}; "
            f"colours {self.colour:.1f}, in blocks {self.blocks:.1f}, in the sky {self.sky:.1f}"
        )

    def faults(self, most_colour: float) -> list[str]:
        bounds = {
            "others": MOST_OTHERS,
            "inside": MOST_INSIDE,
            "median": MOST_MEDIAN,
            "depth": MOST_DEPTH,
            "blocks": most_colour,
            "sky": most_colour,
        }
        return [
            f"{name} {getattr(self, name):.2g} > {most:g}"
            for name, most in bounds.items()
            if getattr(self, name) > most
        ]


def paths(is_all: bool) -> list[pathlib.Path]:
    root = folder("gymnasium")
    assert root is not None, "pip install 'gymnasium[mujoco]'"
    found = [root / "envs/mujoco/assets" / f"{name}.xml" for name in MODELS]
    for package, patterns in OTHERS.items() if is_all else ():
        root = folder(package)
        if root is None:
            print(f"{package} is not installed")
            continue
        found += [path for pattern in patterns for path in sorted(root.glob(pattern))]
    return found


def folder(package: str) -> pathlib.Path | None:
    spec = importlib.util.find_spec(package)
    return None if spec is None or spec.origin is None else pathlib.Path(spec.origin).parent


def state_of(model: mujoco.MjModel) -> mujoco.MjData:
    """Return a random state near the model's first one."""
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_integratePos(model, data.qpos, np.random.default_rng(1).normal(0.0, 0.1, model.nv), 1.0)
    mujoco.mj_forward(model, data)
    return data


def plain() -> mujoco.MjvOption:
    """Return the option that shows geoms alone."""
    option = mujoco.MjvOption()
    for kind in ("site", "tendon", "flex", "skin", "joint", "actuator"):
        getattr(option, f"{kind}group")[:] = 0
    option.flags[mujoco.mjtVisFlag.mjVIS_RANGEFINDER] = 0
    return option


class Pair:
    """Both renderers of a model."""

    def __init__(self, model: mujoco.MjModel) -> None:
        quality = model.vis.quality
        quality.numslices, quality.numstacks, quality.numquads = 128, 128, 32
        quality.offsamples, quality.shadowsize = 0, 2048
        model.vis.global_.offwidth = max(WIDTH, model.vis.global_.offwidth)
        model.vis.global_.offheight = max(HEIGHT, model.vis.global_.offheight)
        self.model, self.data = model, state_of(model)
        self.judge, self.scene = mujoco.Renderer(model, HEIGHT, WIDTH), bvm.Scene(model)

    def close(self) -> None:
        self.judge.close()

    def theirs(self, camera: int, hidden: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return MuJoCo's colours, depths and geoms."""
        judge, pictures = self.judge, []
        judge.update_scene(self.data, camera, plain())
        for name in hidden:
            judge.scene.flags[getattr(mujoco.mjtRndFlag, f"mjRND_{name}")] = 0
        for enable in (
            judge.disable_depth_rendering,
            judge.enable_depth_rendering,
            judge.enable_segmentation_rendering,
        ):
            enable()
            pictures.append(judge.render())
        judge.disable_segmentation_rendering()
        colours, depths, ids = pictures
        return colours, depths, np.where(ids[..., 1] == mujoco.mjtObj.mjOBJ_GEOM, ids[..., 0], -1)

    def ours(self, camera: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        frame = self.scene.camera(camera, WIDTH, HEIGHT).render(self.data, channels=("rgb", "depth", "geom"))
        return frame["rgb"], frame["depth"], frame["geom"]

    def backs(self) -> list[int]:
        """Return the planes whose back is towards the camera of MuJoCo's last picture."""
        eye = np.mean([view.pos for view in self.judge.scene.camera], axis=0)
        planes = np.flatnonzero(self.model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE)
        ahead = eye - self.data.geom_xpos[planes]
        normals = self.data.geom_xmat[planes].reshape(-1, 3, 3)[:, :, 2]
        return planes[(ahead * normals).sum(axis=1) < 0.0].tolist()

    def compare(self, camera: int) -> Differences:
        colours, depths, geoms = self.theirs(camera, ("REFLECTION", "HAZE"))
        own_colours, own_depths, own_geoms = self.ours(camera)
        # MuJoCo shows the backs of planes, transparent; and of two surfaces in one place, either may be seen.
        is_tie = np.abs(own_depths - depths) <= 1e-5 * depths
        other = (geoms != own_geoms) & ~np.isin(geoms, self.backs()) & ~is_tie
        inside = other & ~outline(geoms) & ~outline(own_geoms)
        same = (geoms == own_geoms) & (geoms >= 0)
        relative = np.abs(own_depths[same] / depths[same] - 1.0) if same.any() else np.zeros(1)
        is_flat = np.isin(self.model.geom_type[geoms[same]], FLAT) if same.any() else np.zeros(1, bool)
        difference = np.abs(own_colours.astype(int) - colours)[same]
        return Differences(
            other.mean(),
            inside.mean(),
            float(np.median(relative[is_flat])) if is_flat.any() else 0.0,
            float(np.quantile(relative, 0.999)),
            float(difference.mean()) if same.any() else 0.0,
            *(
                float(np.abs(blocks(own_colours, shown) - blocks(colours, shown)).mean())
                for shown in (same, (geoms < 0) & (own_geoms < 0))
            ),
        )


def outline(geoms: np.ndarray) -> np.ndarray:
    """Return the pixels that have a neighbour of another geom."""
    edge = np.zeros(geoms.shape, bool)
    padded = np.pad(geoms, 1, mode="edge")
    for row in range(3):
        for column in range(3):
            edge |= padded[row : row + geoms.shape[0], column : column + geoms.shape[1]] != geoms
    return edge


def blocks(colours: np.ndarray, shown: np.ndarray) -> np.ndarray:
    """Return mean colours of blocks, which differences of the filters of textures do not change."""
    kept = colours * shown[..., None].astype(np.float64)
    return kept.reshape(HEIGHT // BLOCK, BLOCK, WIDTH // BLOCK, BLOCK, 3).mean(axis=(1, 3))


def coloured(file: str) -> mujoco.MjModel:
    """Return a model whose textures have random colours."""
    model = mujoco.MjModel.from_xml_string(file)
    model.tex_data[:] = np.random.default_rng(1).integers(0, 256, model.tex_data.shape)
    return model


def cameras_of(model: mujoco.MjModel) -> list[int]:
    return [-1, *[camera for camera in range(model.ncam) if not model.cam_projection[camera]]]


def models(chosen: list[pathlib.Path]) -> Iterator[tuple[str, mujoco.MjModel, float]]:
    """Return the names of models, the models, and their largest difference of colours."""
    for path in chosen:
        name = f"{path.parent.name}/{path.name}"
        try:
            model = mujoco.MjModel.from_xml_path(str(path))
        except ValueError as why:
            # Parts that other files include are not models.
            print(f"{name}: MuJoCo cannot load it: {str(why).splitlines()[0]}")
            continue
        yield name, model, MOST_COLOUR if path in paths(False) else float("inf")


def compare(chosen: Iterable[tuple[str, mujoco.MjModel, float]]) -> int:
    """Print the differences of each model, and return the number of faults."""
    faults, count = 0, 0
    for name, model, most_colour in chosen:
        pair = Pair(model)
        count += 1
        for camera in cameras_of(model)[:3]:
            found = pair.compare(camera)
            wrong = found.faults(most_colour)
            faults += len(wrong)
            print(f"{name}, camera {camera}: {found}{''.join(f'  FAULT: {one}' for one in wrong)}", flush=True)
        pair.close()
    print(f"{count} models, {faults} faults")
    return faults


def draw(file: str) -> None:
    """Write pictures of some models: MuJoCo's above, Belvedere's below."""
    from PIL import Image

    rows = [[], []]
    for name, camera in (("humanoid", 0), ("ant", 0), ("pusher_v5", -1), ("walker2d_v5", 0)):
        root = folder("gymnasium")
        assert root is not None
        pair = Pair(mujoco.MjModel.from_xml_path(str(root / "envs/mujoco/assets" / f"{name}.xml")))
        rows[0].append(pair.theirs(camera, ())[0])
        rows[1].append(pair.scene.camera(camera, WIDTH, HEIGHT, smooth=True).render(pair.data)["rgb"])
        pair.close()
    Image.fromarray(np.concatenate([np.concatenate(row, axis=1) for row in rows])).save(file, quality=80)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--all", action="store_true", help="models of other installed packages, too")
    parser.add_argument("--picture", help="write a picture instead")
    parser.add_argument("models", nargs="*", type=pathlib.Path, help="files to compare instead")
    asked = parser.parse_args()
    logging.getLogger("belvedere").setLevel(logging.ERROR)
    if asked.picture:
        draw(asked.picture)
        return
    own = [
        ("bright textures", mujoco.MjModel.from_xml_string(BRIGHT), MOST_COLOUR),
        ("cube textures", coloured(CUBES), MOST_COLOUR),
        ("images without coordinates", coloured(IMAGES), MOST_COLOUR),
    ]
    chosen = asked.models or paths(asked.all)
    if compare(itertools.chain([] if asked.models else own, models(chosen))):
        sys.exit(1)


if __name__ == "__main__":
    main()
