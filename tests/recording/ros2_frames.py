"""Compares messages of ROS 2 with the frames that they were made of, by the wire format's numpy types."""

import importlib.util
import math
from pathlib import Path

import numpy as np

_spec = importlib.util.spec_from_file_location(
    "layout", Path(__file__).parents[2] / "python/src/belvedere/_layout.py"
)
layout = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(layout)
Kind, Encoding = layout.Kind, layout.Encoding

#: The names of pixels that have another one in ROS.
PIXELS = {
    Encoding.F32C1: "32FC1",
    Encoding.U16C1: "16UC1",
    Encoding.F32C2: "32FC2",
    Encoding.F32C3: "32FC3",
    Encoding.I32C1: "32SC1",
}
#: Name, offset and datatype of the fields of clouds.
XYZ = [("x", 0, 7), ("y", 4, 7), ("z", 8, 7)]
POINTS = {
    Encoding.XYZRGB_F32: [*XYZ, ("rgb", 16, 7)],
    Encoding.XYZIRT_F32: [*XYZ, ("intensity", 12, 7), ("ring", 16, 4), ("time", 18, 7)],
    Encoding.XYZIR_F32: [*XYZ, ("intensity", 12, 7), ("ring", 16, 4)],
    Encoding.OUSTER_POINT: [
        *XYZ,
        ("intensity", 16, 7),
        ("t", 20, 6),
        ("reflectivity", 24, 4),
        ("ring", 26, 4),
        ("ambient", 28, 4),
        ("range", 32, 6),
    ],
    Encoding.LIVOX_POINT: [*XYZ, ("intensity", 12, 7), ("tag", 16, 2), ("line", 17, 2), ("timestamp", 18, 8)],
}


def same(found, wanted) -> bool:
    """Returns true if two lists of numbers or texts are equal to the bit; NaN equals NaN."""
    found, wanted = list(found), list(wanted)
    return len(found) == len(wanted) and all(
        a == b and math.copysign(1, a) == math.copysign(1, b)
        if isinstance(b, (float, np.floating)) and not math.isnan(b)
        else a != a
        if isinstance(b, (float, np.floating))
        else a == b
        for a, b in zip(found, wanted)
    )


def xyz(vector) -> list[float]:
    return [vector.x, vector.y, vector.z]


def xyzw(quaternion) -> list[float]:
    return [*xyz(quaternion), quaternion.w]


def text(value: bytes) -> str:
    return value.decode()


def ns(stamp) -> int:
    return stamp.sec * 10**9 + stamp.nanosec


class Frame:
    """A frame as it was in shared memory."""

    def __init__(self, header: bytes, payload: bytes) -> None:
        self.header = np.frombuffer(header, layout.HEADER)[0]
        self.kind, self.encoding = Kind(self.header["kind"]), Encoding(self.header["encoding"])
        self.payload = payload
        self.stamp = int(self.header["stamp_ns"])
        self.frame_id = text(self.header["frame_id"])
        self.width, self.height = int(self.header["width"]), int(self.header["height"])
        self.stride = int(self.header["elem_stride"])
        if self.encoding == Encoding.STRUCT:
            # A kind of one struct has one row, an array has one for each struct.
            rows = np.frombuffer(payload, layout.STRUCTS[self.kind])
            self.structs, self.one = rows, rows[0] if len(rows) else None

    def geometry(self) -> np.void:
        return np.frombuffer(bytes(self.header["block"]), layout.SCAN_GEOMETRY)[0]


def check_image(message, frame: Frame) -> None:
    assert (message.height, message.width) == (frame.height, frame.width)
    assert message.encoding == PIXELS.get(frame.encoding, frame.encoding.name.lower())
    assert message.is_bigendian == 0 and message.step == frame.width * frame.stride
    assert bytes(message.data) == frame.payload


def check_camera(message, frame: Frame) -> None:
    own = frame.one
    assert (message.height, message.width) == (own["height"], own["width"])
    assert message.distortion_model == text(own["distortion_model"])
    assert same(message.d, own["d"][: own["d_len"]])
    for name in "krp":
        assert same(getattr(message, name), own[name].flat), name
    assert (message.binning_x, message.binning_y) == (0, 0)
    roi = message.roi
    assert [roi.x_offset, roi.y_offset, roi.height, roi.width, roi.do_rectify] == [0, 0, 0, 0, False]


def check_scan(message, frame: Frame) -> None:
    geometry = frame.geometry()
    first, step = geometry["angle_min"], geometry["angle_increment"]
    wanted = [first, first + step * (frame.width - 1), step, geometry["time_increment"], geometry["scan_time"]]
    names = ["angle_min", "angle_max", "angle_increment", "time_increment", "scan_time"]
    assert same([getattr(message, name) for name in names], np.float32(wanted))
    assert same([message.range_min, message.range_max], [geometry["range_min"], geometry["range_max"]])
    numbers = np.frombuffer(frame.payload, "<f4")
    assert same(message.ranges, numbers[: frame.width])
    assert same(message.intensities, numbers[frame.width :])
    if frame.header["flags"] & layout.HAS_INTENSITIES:
        assert len(message.intensities) == frame.width


def check_cloud(message, frame: Frame) -> None:
    assert (message.height, message.width) == (frame.height, frame.width)
    assert not message.is_bigendian and message.row_step == message.width * message.point_step
    assert len(message.data) == message.height * message.row_step
    fields = [(field.name, field.offset, field.datatype) for field in message.fields]
    assert all(field.count == 1 for field in message.fields)
    if frame.kind == Kind.POINT_CLOUD:
        assert fields == POINTS[frame.encoding] and message.point_step == frame.stride
        assert bytes(message.data) == frame.payload
        return
    # A scan of several layers.
    with_intensities = bool(frame.header["flags"] & layout.HAS_INTENSITIES)
    names, at = ["x", "y", "z", *["intensity"] * with_intensities], 12 + 4 * with_intensities
    points = np.frombuffer(
        bytes(message.data),
        np.dtype([(name, "<f4") for name in names] + [("ring", "<u2"), ("time", "<f4")]),
    ).reshape(frame.height, frame.width)
    own = [(name, 4 * index, 7) for index, name in enumerate(names)]
    assert fields == [*own, ("ring", at, 4), ("time", at + 2, 7)]
    geometry = frame.geometry()
    planes = np.frombuffer(frame.payload, "<f4").reshape(-1, frame.height, frame.width)
    ranges = np.where(np.isfinite(planes[0]), planes[0], np.nan).astype(float)
    layer, ray = np.mgrid[: frame.height, : frame.width]
    turn = geometry["angle_min"] + ray * geometry["angle_increment"]
    rise = geometry["vertical_angle_min"] + layer * geometry["vertical_angle_increment"]
    for name, unit in [
        ("x", np.cos(rise) * np.cos(turn)),
        ("y", np.cos(rise) * np.sin(turn)),
        ("z", np.sin(rise)),
    ]:
        np.testing.assert_allclose(points[name], ranges * unit, rtol=1e-6, atol=1e-6, equal_nan=True)
    np.testing.assert_array_equal(points["ring"], layer)
    np.testing.assert_array_equal(points["time"], (ray * geometry["time_increment"]).astype("<f4"))
    if with_intensities:
        np.testing.assert_array_equal(points["intensity"], planes[1])
    assert message.is_dense == bool(np.isfinite(ranges).all())


def check_odometry(message, frame: Frame) -> None:
    own, pose, twist = frame.one, message.pose, message.twist
    assert message.child_frame_id == text(own["child_frame_id"])
    assert same(xyz(pose.pose.position), own["position"])
    assert same(xyzw(pose.pose.orientation), own["orientation"])
    assert same(pose.covariance, own["pose_covariance"].flat)
    assert same(xyz(twist.twist.linear), own["linear"]) and same(xyz(twist.twist.angular), own["angular"])
    assert same(twist.covariance, own["twist_covariance"].flat)


def check_transforms(message, frame: Frame) -> None:
    assert len(message.transforms) == len(frame.structs)
    for each, own in zip(message.transforms, frame.structs):
        assert (each.header.frame_id, each.child_frame_id) == (text(own["parent"]), text(own["child"]))
        assert ns(each.header.stamp) == frame.stamp
        assert same(xyz(each.transform.translation), own["translation"])
        assert same(xyzw(each.transform.rotation), own["rotation"])


def check_joints(message, frame: Frame) -> None:
    assert list(message.name) == [text(name) for name in frame.structs["name"]]
    for name in ["position", "velocity", "effort"]:
        assert same(getattr(message, name), frame.structs[name]), name


def check_imu(message, frame: Frame) -> None:
    own = frame.one
    assert same(xyzw(message.orientation), own["orientation"])
    for name in ["angular_velocity", "linear_acceleration"]:
        assert same(xyz(getattr(message, name)), own[name]), name
    for name in ["orientation", "angular_velocity", "linear_acceleration"]:
        assert same(getattr(message, f"{name}_covariance"), own[f"{name}_covariance"].flat), name


def check_range(message, frame: Frame) -> None:
    for name in ["radiation_type", "field_of_view", "min_range", "max_range", "range"]:
        assert same([getattr(message, name)], [frame.one[name]]), name
    assert message.variance == 0


def check_fix(message, frame: Frame) -> None:
    own = frame.one
    for name in ["latitude", "longitude", "altitude"]:
        assert same([getattr(message, name)], [own[name]]), name
    assert same(message.position_covariance, own["position_covariance"].flat)
    assert message.position_covariance_type == (2 if own["position_covariance"].any() else 0)
    assert (message.status.status, message.status.service) == (0, 1)


def check_field(message, frame: Frame) -> None:
    assert same(xyz(message.magnetic_field), frame.one["magnetic_field"])
    assert same(message.magnetic_field_covariance, frame.one["covariance"].flat)


def check_pressure(message, frame: Frame) -> None:
    assert same([message.fluid_pressure, message.variance], frame.one.tolist())


def check_wrench(message, frame: Frame) -> None:
    for name in ["force", "torque"]:
        assert same(xyz(getattr(message.wrench, name)), frame.one[name]), name


def check_contacts(message, frame: Frame) -> None:
    assert sum(len(state.depths) for state in message.states) == len(frame.structs)
    own = iter(frame.structs)
    for state in message.states:
        total = {"force": np.zeros(3), "torque": np.zeros(3)}
        for place, normal, depth, wrench in zip(
            state.contact_positions, state.contact_normals, state.depths, state.wrenches, strict=True
        ):
            point = next(own)
            names = text(point["collision1"]), text(point["collision2"])
            assert (state.collision1_name, state.collision2_name) == names
            assert same([*xyz(place), *xyz(normal), depth], [*point["position"], *point["normal"], point["depth"]])
            for name in total:
                assert same(xyz(getattr(wrench, name)), point[name]), name
                total[name] += point[name]
        for name, sum_ in total.items():
            assert same(xyz(getattr(state.total_wrench, name)), sum_), name


def check_states(message, frame: Frame) -> None:
    assert list(message.name) == [text(name) for name in frame.structs["name"]]
    for pose, twist, own in zip(message.pose, message.twist, frame.structs, strict=True):
        assert same(xyz(pose.position), own["position"]) and same(xyzw(pose.orientation), own["orientation"])
        assert same(xyz(twist.linear), own["linear"]) and same(xyz(twist.angular), own["angular"])


def check_core(message, frame: Frame) -> None:
    own = frame.one
    for name in own.dtype.names:
        assert same(np.atleast_1d(getattr(message, name)).tolist(), np.atleast_1d(own[name]).tolist()), name


def check_clock(message, frame: Frame) -> None:
    assert ns(message.clock) == frame.one["now_ns"]


def check_altimeter(message, frame: Frame) -> None:
    assert same(xyz(message.point), [0, 0, frame.one["vertical_position"]])


def check_vector(message, frame: Frame) -> None:
    assert same(xyz(message.vector), frame.one["vector"])


def check_pose(message, frame: Frame) -> None:
    pose = message.pose
    assert same(xyz(pose.position), frame.one["position"]) and same(xyzw(pose.orientation), frame.one["orientation"])


def check_boxes(message, frame: Frame) -> None:
    for each, own in zip(message.detections, frame.structs, strict=True):
        assert each.header == message.header and each.id == str(own["instance"])
        (result,) = each.results
        assert (result.hypothesis.class_id, result.hypothesis.score) == (str(own["label"]), 1.0)
        pose = result.pose.pose
        assert same(xyz(pose.position), own["position"]) and same(xyzw(pose.orientation), own["orientation"])
        assert not np.any(result.pose.covariance)
        # Pixels have their centres at integers, and both rows or columns belong to the box.
        low, high = own["min"].astype(float), own["max"].astype(float)
        box = each.bbox
        assert same([box.center.position.x, box.center.position.y, box.center.theta], [*(low + high) / 2, 0.0])
        assert same([box.size_x, box.size_y], high - low + 1)


CHECKS = {
    Kind.IMAGE: check_image,
    Kind.DEPTH_IMAGE: check_image,
    Kind.CAMERA_INFO: check_camera,
    Kind.POINT_CLOUD: check_cloud,
    Kind.ODOMETRY: check_odometry,
    Kind.TRANSFORMS: check_transforms,
    Kind.STATIC_TRANSFORMS: check_transforms,
    Kind.JOINT_STATES: check_joints,
    Kind.CLOCK: check_clock,
    Kind.IMU: check_imu,
    Kind.RANGE: check_range,
    Kind.NAV_SAT_FIX: check_fix,
    Kind.MAGNETIC_FIELD: check_field,
    Kind.FLUID_PRESSURE: check_pressure,
    Kind.ALTIMETER: check_altimeter,
    Kind.VECTOR3: check_vector,
    Kind.WRENCH: check_wrench,
    Kind.CONTACTS: check_contacts,
    Kind.MODEL_STATES: check_states,
    Kind.CORE_SENSORS: check_core,
    Kind.BOUNDING_BOXES: check_boxes,
    Kind.POSE: check_pose,
}


def check_frame(message, frame: Frame) -> set[str]:
    """Compares a message with its frame; returns what special numbers it has."""
    if frame.kind == Kind.LASER_SCAN:
        check = check_scan if frame.height == 1 else check_cloud
    else:
        check = CHECKS[frame.kind]
    check(message, frame)
    if hasattr(message, "header"):
        assert ns(message.header.stamp) == frame.stamp
        # tf2 refuses a leading slash.
        assert message.header.frame_id == frame.frame_id.removeprefix("/")
    if frame.kind in (Kind.LASER_SCAN, Kind.RANGE) or frame.encoding == Encoding.F32C1:
        kind = {Kind.LASER_SCAN: "ranges", Kind.RANGE: "range"}.get(frame.kind, "depth")
        numbers = np.float32([frame.one["range"]]) if kind == "range" else np.frombuffer(frame.payload, "<f4")
        return {
            f"{kind} {name}"
            for name, found in [
                ("nan", np.isnan(numbers)),
                ("inf", np.isposinf(numbers)),
                ("-inf", np.isneginf(numbers)),
            ]
            if found.any()
        }
    return set()
