"""Reads a topic with Cyclone DDS and prints what came, as JSON: cyclone.py KIND RELIABILITY SAMPLES SECONDS."""

import json
import statistics
import struct
import sys
import time
from dataclasses import dataclass

from cyclonedds._clayer import ddspy_take
from cyclonedds.core import InstanceState, Policy, Qos, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import int32, sequence, uint8, uint32
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class Image(IdlStruct, typename="sensor_msgs::msg::dds_::Image_"):
    header: Header
    height: uint32
    width: uint32
    encoding: str
    is_bigendian: uint8
    step: uint32
    data: sequence[uint8]


@dataclass
class PointField(IdlStruct, typename="sensor_msgs::msg::dds_::PointField_"):
    name: str
    offset: uint32
    datatype: uint8
    count: uint32


@dataclass
class PointCloud2(IdlStruct, typename="sensor_msgs::msg::dds_::PointCloud2_"):
    header: Header
    height: uint32
    width: uint32
    fields: sequence[PointField]
    is_bigendian: bool
    point_step: uint32
    row_step: uint32
    data: sequence[uint8]
    is_dense: bool


TOPICS = {"image": ("rt/camera/image_raw", Image), "cloud": ("rt/points", PointCloud2)}


def main():
    kind, reliability, samples, seconds = sys.argv[1], sys.argv[2], int(sys.argv[3]), float(sys.argv[4])
    name, message = TOPICS[kind]
    reliable = Policy.Reliability.Reliable(duration(milliseconds=100))
    qos = Qos(reliable if reliability == "reliable" else Policy.Reliability.BestEffort, Policy.History.KeepLast(5))
    participant = DomainParticipant()
    reader = DataReader(participant, Topic(participant, name, message, qos=qos), qos=qos)
    everything = SampleState.Any | ViewState.Any | InstanceState.Any
    waiter = WaitSet(participant)
    waiter.attach(ReadCondition(reader, everything))
    latencies = []
    wrong, used = 0, 0.0
    end = time.monotonic() + seconds
    while time.monotonic() < end and len(latencies) < samples:
        waiter.wait(duration(milliseconds=100))
        # The bytes alone: a list of a picture's pixels takes Python longer than the time until the next one.
        taken = ddspy_take(reader._ref, everything, 10)
        now = time.time_ns()
        for data, info in [] if isinstance(taken, int) else taken:
            if info.valid_data:
                seconds_part, nanoseconds = struct.unpack_from("<iI", data, 4)
                latencies.append((now - seconds_part * 10**9 - nanoseconds) / 1e6)
                wrong += len(data) < {"image": 3, "cloud": 16}[kind] * 640 * 480 or data[1000] != 7
        if not latencies:
            used = time.process_time()
    report = {
        "came": len(latencies),
        "wrong": wrong,
        "median": statistics.median(latencies) if latencies else None,
        "largest": max(latencies, default=None),
        "processor": (time.process_time() - used) * 1e3 / max(len(latencies), 1),
    }
    print(json.dumps(report), flush=True)


main()
