#!/usr/bin/env python3
"""Log the images, depth images and scans of a simulator for Rerun until the simulator ends: log_to_rerun.py run.rrd.

pip install rerun-sdk
"""

import select
import sys

import numpy as np
import rerun as rr

from belvedere import Frame, Kind, Node


def log(topic: str, frame: Frame) -> None:
    """Log a frame under its topic, at the pose of its sensor and in simulated time."""
    rr.set_time("simulation", duration=np.timedelta64(frame.stamp_ns, "ns"))
    rr.log(topic, rr.Transform3D(translation=frame.position, quaternion=frame.orientation))
    if frame.kind == Kind.LASER_SCAN:
        scan, ranges = frame.scan_geometry, frame.array[0]
        angles = scan.angle_min + np.arange(len(ranges)) * scan.angle_increment
        met = (ranges >= scan.range_min) & (ranges <= scan.range_max)
        rays = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=-1)
        rr.log(topic, rr.Points3D(ranges[met, None] * rays[met]))
        return
    lens = frame.intrinsics
    matrix = [[lens.fx, 0, lens.cx], [0, lens.fy, lens.cy], [0, 0, 1]]
    # Poses are those of the sensor's axes: x forward, y left, z up.
    size = {"width": frame.width, "height": frame.height}
    rr.log(topic, rr.Pinhole(image_from_camera=matrix, camera_xyz=rr.ViewCoordinates.FLU, **size))
    is_depth = frame.kind == Kind.DEPTH_IMAGE
    rr.log(topic, rr.DepthImage(frame.array, meter=1.0) if is_depth else rr.Image(frame.array))


rr.init("belvedere")
rr.save(sys.argv[1])
with Node("rerun") as node:
    kinds = [str(kind.name).lower() for kind in (Kind.IMAGE, Kind.DEPTH_IMAGE, Kind.LASER_SCAN)]
    followed = [node.subscribe(stream.topic) for stream in node.streams() if stream.kind in kinds]
    print(f"{len(followed)} streams", flush=True)
    began = ended = False
    while not ended:
        # Checked first, so that the last frames of a publisher that ends are still taken below.
        ended = began and not any(stream.publishers for stream in followed)
        for stream in followed:
            while frame := stream.take():
                log(stream.topic, frame)
                began = True
        select.select(followed, [], [], 1.0)
