"""Belvedere's sensor frames in shared memory, as numpy arrays, without a copy.

>>> import belvedere
>>> with belvedere.Node("viewer") as node:                          # doctest: +SKIP
...     for frame in node.subscribe("camera/rgb/image_raw").frames(timeout=5.0):
...         print(frame.stamp_ns, frame.array.shape, frame.array.mean())
"""

from belvedere._commands import (
    CommandPublisher,
    MotorPowerPublisher,
    ResetOdometryPublisher,
    VelocityPublisher,
)
from belvedere._control import SimulationControl
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
from belvedere._node import Node, StreamInfo
from belvedere._subscriber import Subscriber
from belvedere._synchronizer import Synchronizer
from belvedere.wire import DistortionModel, Encoding, Intrinsics, Kind, ScanGeometry

__all__ = [
    "BadFrameError",
    "BridgeError",
    "CommandPublisher",
    "DistortionModel",
    "Encoding",
    "Frame",
    "FrameInUseError",
    "IncompatibleError",
    "Intrinsics",
    "InvalidNameError",
    "Kind",
    "LimitError",
    "MotorPowerPublisher",
    "Node",
    "RefusedError",
    "ReleasedError",
    "ResetOdometryPublisher",
    "ScanGeometry",
    "SimulationControl",
    "StreamInfo",
    "StreamTimeoutError",
    "Subscriber",
    "Synchronizer",
    "VelocityPublisher",
]
