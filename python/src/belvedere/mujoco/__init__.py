"""Sensors for MuJoCo: cameras, depth cameras and lidars in its models, on any CPU and without OpenGL.

The extra ``mujoco`` installs the package ``mujoco``. A :class:`Scene` has the shapes, materials, lamps and cameras of a
model; its sensors render states: ``MjData``, arrays of ``qpos``, or arrays of poses.

>>> import mujoco, numpy
>>> import belvedere.mujoco as bvm
>>> model = mujoco.MjModel.from_xml_string('''
... <mujoco><worldbody><geom type="plane" size="0 0 1"/>
...   <body pos="0 0 2"><freejoint/><geom name="ball" size="0.5"/></body>
...   <camera name="down" pos="0 0 5"/></worldbody></mujoco>''')
>>> scene = bvm.Scene(model)
>>> heights = numpy.tile([0, 0, 2, 1, 0, 0, 0], (3, 1)) + numpy.outer([0, 0.5, 1], [0, 0, 1, 0, 0, 0, 0])
>>> camera = scene.camera("down", 65, 65)
>>> camera.render(heights, channels=("depth",))["depth"][:, 32, 32].round(3).tolist()
[2.5, 2.0, 1.5]
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from belvedere.mujoco._cameras import SceneCamera
from belvedere.mujoco._lidars import SceneLidar
from belvedere.mujoco._renderer import Renderer
from belvedere.mujoco._scene import Scene

if TYPE_CHECKING:
    from belvedere.mujoco._pixels import PixelObservation

__all__ = ["PixelObservation", "Renderer", "Scene", "SceneCamera", "SceneLidar"]


def __getattr__(name: str) -> Any:
    """Import what needs gymnasium when it is used."""
    if name == "PixelObservation":
        from belvedere.mujoco._pixels import PixelObservation

        return PixelObservation
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
