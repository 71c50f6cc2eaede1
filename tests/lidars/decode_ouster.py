"""Compares packets of an Ouster, decoded by ouster-sdk, with the cloud of the same run; see .ci/packets."""

import sys
from pathlib import Path

import numpy as np
from ouster.sdk.core import FrameBatcher, LidarFrame, LidarPacket, PacketFormat, SensorInfo, XYZLut, destagger
from ouster.sdk.pcap import PcapPacketSource


def main(name: str, pcap: str, cloud: str, columns: int, rate: int) -> None:
    info = SensorInfo(Path(pcap).with_suffix(".json").read_text())
    layout = PacketFormat(info)
    rows = layout.pixels_per_column
    shape = (info.format.columns_per_frame, info.format.fps, str(info.config.lidar_mode))
    assert shape == (columns, rate, f"{columns}x{rate}"), shape
    # Images of Ouster's driver: time in s, x, y, z, ring, range in mm, reflectivity. The first frame began before time
    # 0. With two returns there are two images per frame.
    fields = [("RANGE", "REFLECTIVITY"), ("RANGE2", "REFLECTIVITY2")]
    fields = fields if "DUAL" in str(info.format.udp_profile_lidar) else fields[:1]
    truth = np.fromfile(cloud, "<f8").reshape(-1, len(fields), rows, columns, 7)[1:]

    packets = [packet for _, packet in PcapPacketSource(pcap, sensor_info=[info])]
    size, each = Path(pcap).stat().st_size, 16 + 42 + layout.lidar_packet_size
    sent = (size - 24) // each
    assert (size - 24) % each == 0, "the file has a packet of another size"
    refused = [packet for packet in packets if not isinstance(packet, LidarPacket)]
    assert len(packets) == sent and not refused, f"{sent} sent, {len(packets)} taken, {len(refused)} of them as something else"
    assert sent == len(truth) * columns // 16, f"{sent} packets of {len(truth)} frames"
    if layout.packet_footer_size:
        # This removes the checksum from the packet and computes it again.
        assert all(layout.crc(packet.buf) == layout.calculate_crc(packet.buf) for packet in packets)

    frames, batcher, frame = [], FrameBatcher(info), LidarFrame(info)
    for packet in packets:
        if batcher.batch(packet, frame):
            frames.append(frame)
            frame = LidarFrame(info)
    assert len(frames) == len(truth) and all(frame.complete() for frame in frames), f"{len(frames)} frames are whole"

    step = 8 if "RNG15" in str(info.format.udp_profile_lidar) else 1
    place = XYZLut(info, False)
    off = {"time": 0.0, "range": 0, "place": 0.0}
    hits = np.zeros(len(fields))
    for number, (frame, images) in enumerate(zip(frames, truth)):
        assert (frame.measurement_id == np.arange(columns)).all()
        assert (frame.frame_id & 0xFFFF) == number + 1
        # The image has the time of each pixel at the pixel; staggered again, these are the times of the columns.
        times = destagger(info, np.tile(frame.timestamp, (rows, 1)).astype(np.int64))
        for index, (image, (range_field, reflectivity_field)) in enumerate(zip(images, fields)):
            ranges = destagger(info, frame.field(range_field)).astype(np.int64)
            off["time"] = max(off["time"], np.abs(times - np.rint(image[:, :, 0] * 1e9)).max())
            hit = ~np.isnan(image[:, :, 1])
            hits[index] += hit.mean() / len(frames)
            assert ((ranges > 0) == hit).all() and (image[:, :, 4] == np.arange(rows)[:, None]).all()
            off["range"] = max(off["range"], np.abs(ranges - image[:, :, 5])[hit].max())
            points = destagger(info, place(frame.field(range_field)))
            off["place"] = max(off["place"], np.linalg.norm(points - image[:, :, 1:4], axis=2)[hit].max())
            reflectivity = destagger(info, frame.field(reflectivity_field))
            assert (reflectivity[hit] == image[:, :, 6][hit]).all()
    assert hits[0] > 0.3 and (hits > 1e-3).all(), hits
    print(f"{name} {columns}x{rate} {info.format.udp_profile_lidar}: {sent} packets, 0 refused, {len(frames)} frames")
    print(f"  {', '.join(f'{share:.1%}' for share in hits)} of the pixels have returns")
    print(f"  times off by {off['time']:.0f} ns, ranges by {off['range']} mm of {step}, places by {off['place'] * 1e3:.3f} mm")
    # Ranges of the cloud are those of packets with a resolution of 1 mm. Its points were computed from millimetres
    # measured from the beams' origins; ranges are measured from the axis, so they are rounded once more.
    coarser = 0 if step == 1 else step / 2
    assert off["time"] == 0 and off["range"] <= coarser and off["place"] < (0.55 + coarser) * 1e-3


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4]), int(sys.argv[5]))
