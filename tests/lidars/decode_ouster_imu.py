"""Compares IMU packets of an Ouster, decoded by ouster-sdk, with the messages of the same run; see .ci/packets."""

import sys
from pathlib import Path

import numpy as np
from ouster.sdk.core import ImuPacket, PacketFormat, SensorInfo
from ouster.sdk.pcap import PcapPacketSource


def main(profile: str, pcap: str, readings: str) -> None:
    info = SensorInfo(Path(pcap).with_suffix(".json").read_text())
    layout = PacketFormat(info)
    assert profile in str(info.format.udp_profile_imu), info.format.udp_profile_imu
    # Time in ns, specific force in m/s², angular rate in rad/s.
    truth = np.fromfile(readings, "<f8").reshape(-1, 7)

    packets = [packet for _, packet in PcapPacketSource(pcap, sensor_info=[info])]
    size, each = Path(pcap).stat().st_size, 16 + 42 + layout.imu_packet_size
    assert (size - 24) % each == 0, "the file has a packet of another size"
    assert packets and all(isinstance(packet, ImuPacket) for packet in packets), f"{len(packets)} packets"
    assert len(packets) == (size - 24) // each, f"{len(packets)} packets are taken"

    legacy = profile == "LEGACY"
    times = np.concatenate([[packet.sys_ts()] if legacy else packet.timestamp() for packet in packets])
    if legacy:
        assert all(packet.sys_ts() == packet.accel_ts() == packet.gyro_ts() for packet in packets)
    else:
        assert all(packet.crc() == packet.calculate_crc() for packet in packets)
        ids = np.concatenate([packet.measurement_id() for packet in packets])
        frames = np.repeat([packet.frame_id() for packet in packets], 8)
        assert (ids + 64 * frames == np.arange(len(ids))).all()
    force = np.concatenate([np.reshape(packet.accel(), (-1, 3)) for packet in packets])
    turn = np.concatenate([np.reshape(packet.gyro(), (-1, 3)) for packet in packets])
    # The run may continue by a sample, and the last packet may not be full.
    count = min(len(times), len(truth))
    assert count >= len(truth) - 8, f"{len(times)} samples of {len(truth)}"
    assert (times[:count] == np.rint(truth[:count, 0]).astype(np.uint64)).all()
    found, truth = np.hstack([force, turn])[:count], truth[:count, 1:]
    # Packets have single precision, and the decoder converts their units in it: each rounds by 2⁻²⁴ of the value.
    off = np.abs(found - truth)
    assert (off <= 2**-23 * np.abs(truth) + 1e-12).all(), (off / np.abs(truth)).max(axis=0)
    off = [off[:, :3].max(), off[:, 3:].max()]
    print(f"imu {profile}: {len(packets)} packets, {count} samples; off by at most {off[0]:.1e} m/s², {off[1]:.1e} rad/s, 0 ns")


if __name__ == "__main__":
    main(*sys.argv[1:])
