"""Compares packets of a pcap file, decoded by velodyne-decoder, with the cloud of the same run; see .ci/packets."""

import sys

import numpy as np
import velodyne_decoder as vd

# Each column ends with a pause that is longer than this.
MARGIN_S = 2e-6
# The time from eight lasers of a VLS-128 to the next eight.
SLOT_S = 2.665e-6
# Model, lasers, seconds from a column to the next, columns per packet with one return and with two, tolerance of
# azimuths in degrees. A step of an azimuth is 0.01, and the decoder rounds that of each firing once more. It computes
# the speed of the head from the azimuths of one packet or two, which are closer together the fewer columns there are.
MODELS = {
    "vlp16": (vd.Model.VLP16, 16, 55.296e-6, (24, 12), (0.011, 0.013)),
    "hdl32e": (vd.Model.HDL32E, 32, 46.08e-6, (12, 6), (0.011, 0.013)),
    "vls128": (vd.Model.AlphaPrime, 128, 53.3e-6, (3, 1), (0.025, 0.031)),
}


def by_time(rows: np.ndarray, time: int, ring: int) -> np.ndarray:
    """Sorts by time and ring; two returns of a firing stay in their order."""
    return rows[np.lexsort((rows[:, ring], rows[:, time]))]


def without_repeats(found: np.ndarray) -> np.ndarray:
    """Drops repeated points: if a firing has only one return, both blocks contain it."""
    again = np.zeros(len(found), bool)
    again[1:] = (found[1:, [0, 1, 2, 3, 4, 6]] == found[:-1, [0, 1, 2, 3, 4, 6]]).all(axis=1)
    return found[~again]


def first_packet(pcap: str, returns: int) -> int:
    """The number of points of the first packet, where two equal returns of a firing are one point."""
    blocks = np.fromfile(pcap, np.uint8, 1200, offset=24 + 16 + 42).reshape(12, 100)[:, 4:].reshape(12, 32, 3)
    distances = blocks[:, :, 0] + 256 * blocks[:, :, 1].astype(int)
    there = distances > 0
    if returns == 2:
        there[1::2] &= distances[1::2] != distances[::2]
    return int(there.sum())


def main(name: str, returns: int, pcap: str, cloud: str, seconds: float) -> None:
    model, lasers, column_s, columns, bounds = MODELS[name]
    columns, bound = columns[returns - 1], bounds[returns - 1]
    packets_s = 1.0 / column_s / columns
    config = vd.Config(model=model, min_range=0.0, max_range=250.0)
    found = []
    for stamp, points in vd.read_pcap(pcap, config):
        rows = np.array(points, dtype=np.float64)
        rows[:, 4] += stamp.device
        found.append(rows)
    found = np.concatenate(found)
    # x y z intensity time column ring return_type
    truth = np.fromfile(cloud, "<f8").reshape(-1, 6)

    # Whole packets of all firings from time 0 on.
    size = np.fromfile(pcap, np.uint8).size
    assert (size - 24) % 1264 == 0, "the file has a packet that is not of 1206 bytes"
    packets = (size - 24) // 1264
    print(f"{name}, {returns} returns: {packets} packets in {seconds} s, {packets / seconds:.1f} a second; {len(found)} points")
    assert abs(packets - packets_s * seconds) < 2

    # The points of the cloud that are in whole packets. The head began to fire a turn of 0.1 s before time 0; packets
    # begin with the first column after time 0.
    begin = np.ceil(0.1 / column_s) * column_s - 0.1
    end = begin + packets * columns * column_s
    if name == "vls128":
        # The decoder uses the head's speed and times from the previous packet.
        begin += columns * column_s
        found = found[first_packet(pcap, returns) :]
        # In the manual, the pause after the first half of a column is one slot, in the decoder two. (It turns the head
        # by 0.01 deg in that time.)
        found[(found[:, 4] - begin + MARGIN_S) % column_s > 8.5 * SLOT_S, 4] -= SLOT_S
    truth = truth[(truth[:, 0] > begin - MARGIN_S) & (truth[:, 0] < end - MARGIN_S)]
    found, truth = by_time(found, 4, 6), by_time(truth, 0, 4)
    if returns == 2:
        found = without_repeats(found)
        pairs = ((np.diff(truth[:, 0]) == 0) & (np.diff(truth[:, 4]) == 0)).sum()
        assert pairs > 100, f"{pairs} firings with two returns"
        print(f"  {pairs} firings have two returns")
    assert len(truth) == len(found), f"{len(truth)} points in the cloud, {len(found)} in the packets"
    time = found[:, 4] - truth[:, 0]
    print(f"  times off by {np.abs(time).max() * 1e6:.3f} us")
    assert np.abs(time).max() < 0.6e-6
    assert (found[:, 6] == truth[:, 4]).all(), "rings"
    # Intensities of the cloud are not rounded.
    intensity = np.abs(found[:, 3] - truth[:, 5]).max()
    ranges = np.linalg.norm(found[:, :3], axis=1), np.linalg.norm(truth[:, 1:4], axis=1)
    distance = np.abs(ranges[0] - ranges[1]).max()
    azimuth = [np.degrees(np.arctan2(-rows[0], rows[1])) for rows in ((found[:, 1], found[:, 0]), (truth[:, 2], truth[:, 1]))]
    off = np.abs((azimuth[0] - azimuth[1] + 180) % 360 - 180)
    height = np.abs(found[:, 2] - truth[:, 3])
    print(f"  ranges off by {distance * 1e3:.4f} mm, azimuths by {off.max():.4f} deg, heights by {height.max() * 1e3:.3f} mm, intensities by {intensity:.3f}")
    # Ranges of the cloud are already whole steps.
    assert distance < 1e-4 and height.max() < 1e-4 and off.max() < bound and intensity < 0.501


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), sys.argv[3], sys.argv[4], float(sys.argv[5]))
