"""Belvedere's sensor frames in shared memory, as numpy arrays, without a copy.

>>> import belvedere
>>> with belvedere.Node("viewer") as node:                          # doctest: +SKIP
...     for frame in node.subscribe("camera/rgb/image_raw").frames(timeout=5.0):
...         print(frame.stamp_ns, frame.array.shape, frame.array.mean())
"""

from belvedere._errors import (
    BadFrameError,
    BridgeError,
    FrameInUseError,
    IncompatibleError,
    InvalidNameError,
    LimitError,
    ReleasedError,
    StreamTimeoutError,
)
from belvedere._frame import Frame
from belvedere._node import Node, StreamInfo
from belvedere._subscriber import Subscriber
from belvedere._synchronizer import Synchronizer
from belvedere._velocity import VelocityPublisher
from belvedere.wire import Encoding, Intrinsics, Kind, ScanGeometry

__all__ = [
    "BadFrameError",
    "BridgeError",
    "Encoding",
    "Frame",
    "FrameInUseError",
    "IncompatibleError",
    "Intrinsics",
    "InvalidNameError",
    "Kind",
    "LimitError",
    "Node",
    "ReleasedError",
    "ScanGeometry",
    "StreamInfo",
    "StreamTimeoutError",
    "Subscriber",
    "Synchronizer",
    "VelocityPublisher",
]
