"""Belvedere: robot sensors by exact ray casting on the CPU, as numpy arrays.

Sensors in this process: worlds, cameras, depth cameras, lidars, batches of frames.

>>> import numpy, belvedere
>>> camera = belvedere.DepthCamera(64, 48, fov=1.05)
>>> world = belvedere.World()
>>> world.add_sphere(0.5, (2, 0, 0))
0
>>> float(camera.render(world, [[0, 0, 0, 0, 0, 0, 1]])["depth"][0, 24, 32].round(3))
1.5

Frames of a running simulator in shared memory, without a copy:

>>> with belvedere.Node("viewer") as node:                          # doctest: +SKIP
...     for frame in node.subscribe("camera/rgb/image_raw").frames(timeout=5.0):
...         print(frame.stamp_ns, frame.array.shape, frame.array.mean())
"""

from belvedere._batch import Batch
from belvedere._commands import (
    CommandPublisher,
    MotorPowerPublisher,
    ResetOdometryPublisher,
    VelocityPublisher,
)
from belvedere._control import SimulationControl, SimulationDescription
from belvedere._errors import (
    BadFrameError,
    BridgeError,
    FrameInUseError,
    IncompatibleError,
    InvalidNameError,
    LimitError,
    RefusedError,
    ReleasedError,
    StreamTimeoutError,
)
from belvedere._frame import Frame
from belvedere._frames import Frames
from belvedere._lens import Lens
from belvedere._node import Node, StreamInfo
from belvedere._placed_camera import PlacedCamera
from belvedere._scanner import Scanner
from belvedere._sensors import Camera, DepthCamera, Lidar, Sensor
from belvedere._simulation import Simulation
from belvedere._subscriber import Subscriber
from belvedere._synchronizer import Synchronizer
from belvedere._world import World
from belvedere.wire import DistortionModel, Encoding, Intrinsics, Kind, ScanGeometry

__all__ = [
    "BadFrameError",
    "Batch",
    "BridgeError",
    "Camera",
    "CommandPublisher",
    "DepthCamera",
    "DistortionModel",
    "Encoding",
    "Frame",
    "FrameInUseError",
    "Frames",
    "IncompatibleError",
    "Intrinsics",
    "InvalidNameError",
    "Kind",
    "Lens",
    "Lidar",
    "LimitError",
    "MotorPowerPublisher",
    "Node",
    "PlacedCamera",
    "RefusedError",
    "ReleasedError",
    "ResetOdometryPublisher",
    "ScanGeometry",
    "Scanner",
    "Sensor",
    "Simulation",
    "SimulationControl",
    "SimulationDescription",
    "StreamInfo",
    "StreamTimeoutError",
    "Subscriber",
    "Synchronizer",
    "VelocityPublisher",
    "World",
]
