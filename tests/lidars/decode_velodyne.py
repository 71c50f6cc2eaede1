"""Packets in a pcap file, decoded by velodyne-decoder, against the cloud of the same run; see .ci/packets."""

import sys

import numpy as np
import velodyne_decoder as vd

MODELS = {"vlp16": (vd.Model.VLP16, 16, 55.296e-6, 753.5), "hdl32e": (vd.Model.HDL32E, 32, 46.08e-6, 1808.4)}


def told_once(found: np.ndarray) -> np.ndarray:
    """Where there is but one return, both blocks have it; those are dropped from the second."""
    found = found[np.argsort(found[:, 4], kind="stable")]
    again = np.zeros(len(found), bool)
    again[1:] = (np.diff(found[:, 4]) == 0) & (found[1:, 6] == found[:-1, 6]) & (found[1:, :4] == found[:-1, :4]).all(axis=1)
    return found[~again]


def main(name: str, returns: int, pcap: str, cloud: str, seconds: float) -> None:
    model, lasers, column_s, packets_s = MODELS[name]
    config = vd.Config(model=model, min_range=0.0, max_range=250.0)
    found = []
    for stamp, points in vd.read_pcap(pcap, config):
        rows = np.array(points, dtype=np.float64)
        rows[:, 4] += stamp.device
        found.append(rows)
    found = np.concatenate(found)
    # x y z intensity time column ring return_type
    truth = np.fromfile(cloud, "<f8").reshape(-1, 6)

    # Packets: whole ones of all firings from time 0 on.
    size = np.fromfile(pcap, np.uint8).size
    assert (size - 24) % 1264 == 0, "the file has a packet that is not of 1206 bytes"
    packets = (size - 24) // 1264
    print(f"{name}, {returns} returns: {packets} packets in {seconds} s, {packets / seconds:.1f} a second; {len(found)} points")
    assert abs(packets / seconds - packets_s * returns) < returns * (1.0 / seconds + 0.1)

    # Those of the cloud that are in whole packets. The head began to fire a turn of 0.1 s before time 0; packets begin with
    # the first column after it.
    begin = np.ceil(0.1 / column_s) * column_s - 0.1
    end = begin + packets * 384 / lasers / returns * column_s
    truth = truth[(truth[:, 0] > begin - 0.5e-6) & (truth[:, 0] < end - 0.5e-6)]
    if returns == 2:
        found = told_once(found)
        pairs = np.diff(np.sort(truth[:, 0])) == 0
        assert pairs.sum() > 100, f"{pairs.sum()} firings with two returns"
        print(f"  {pairs.sum()} firings have two returns")
    assert len(truth) == len(found), f"{len(truth)} points in the cloud, {len(found)} in the packets"
    found = found[np.argsort(found[:, 4], kind="stable")]
    by_time = truth[np.argsort(truth[:, 0], kind="stable")]
    time = found[:, 4] - by_time[:, 0]
    print(f"  times off by {np.abs(time).max() * 1e6:.3f} us")
    assert np.abs(time).max() < 0.6e-6
    assert (found[:, 6] == by_time[:, 4]).all(), "rings"
    ranges = np.linalg.norm(found[:, :3], axis=1), np.linalg.norm(by_time[:, 1:4], axis=1)
    # Intensities of the cloud are not rounded.
    intensity = np.abs(found[:, 3] - by_time[:, 5]).max()
    distance = np.abs(ranges[0] - ranges[1]).max()
    azimuth = [np.degrees(np.arctan2(-rows[0], rows[1])) for rows in ((found[:, 1], found[:, 0]), (by_time[:, 2], by_time[:, 1]))]
    off = np.abs((azimuth[0] - azimuth[1] + 180) % 360 - 180)
    height = np.abs(found[:, 2] - by_time[:, 3])
    print(f"  ranges off by {distance * 1e3:.4f} mm, azimuths by {off.max():.4f} deg, heights by {height.max() * 1e3:.3f} mm, intensities by {intensity:.3f}")
    # Ranges of the cloud are whole steps of 2 mm already. A step of azimuths is 0.01 deg, and the decoder rounds that of each
    # firing once more.
    assert distance < 1e-4 and height.max() < 1e-4 and off.max() < 0.011 and intensity < 0.501


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), sys.argv[3], sys.argv[4], float(sys.argv[5]))
