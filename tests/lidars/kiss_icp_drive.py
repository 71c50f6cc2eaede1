"""Compares the odometry of KISS-ICP, from clouds of a robot that drives and turns, with its poses; see .ci/kiss_icp."""

import sys

import numpy as np
from kiss_icp.config import load_config
from kiss_icp.kiss_icp import KissICP

# The position of the lidar on the robot.
MOUNT = np.array([0.0, 0.0, 0.9])
# A third of the accuracy of 3 cm in the manual of the VLP-16.
SIGMA = 0.01


def frames(path: str):
    """Steps (time, place, quaternion) and points (time, place) of each frame."""
    numbers, at = np.fromfile(path, "<f8"), 0
    while at < len(numbers):
        steps, points = numbers[at : at + 2].astype(int)
        at += 2
        yield numbers[at : at + 8 * steps].reshape(-1, 8), numbers[at + 8 * steps : at + 8 * steps + 4 * points].reshape(-1, 4)
        at += 8 * steps + 4 * points


def rotated(turn: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Rotates each position by its quaternion."""
    axis, along = turn[:, :3], turn[:, 3:]
    return place + 2 * np.cross(axis, np.cross(axis, place) + along * place)


def matrix(step: np.ndarray) -> np.ndarray:
    """The pose of the lidar at a step."""
    pose = np.eye(4)
    pose[:3, :3] = rotated(np.tile(step[4:], (3, 1)), np.eye(3)).T
    pose[:3, 3] = step[1:4] + pose[:3, :3] @ MOUNT
    return pose


def deskewed(steps: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Transforms each point to the world by the pose at its time, interpolated between steps."""
    after = np.clip(np.searchsorted(steps[:, 0], points[:, 0]), 1, len(steps) - 1)
    before = after - 1
    share = ((points[:, 0] - steps[before, 0]) / (steps[after, 0] - steps[before, 0]))[:, None]
    turn = steps[before, 4:] * (1 - share) + steps[after, 4:] * share
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    place = steps[before, 1:4] * (1 - share) + steps[after, 1:4] * share
    return place + rotated(turn, points[:, 1:] + MOUNT)


def exact(path: str) -> None:
    """Checks that, without noise, points of the walls are on the walls."""
    before, most, stamped, count = None, 0.0, 0.0, 0
    for steps, points in frames(path):
        if before is not None:
            steps = np.vstack([before[-2:], steps])
            for places, is_own in ((deskewed(steps, points), True), (points[:, 1:] @ matrix(steps[-1])[:3, :3].T + matrix(steps[-1])[:3, 3], False)):
                # Crates are farther inside; the ground is below.
                off = np.minimum(np.abs(np.abs(places[:, 0]) - 15.0), np.abs(np.abs(places[:, 1]) - 10.0))
                own = deskewed(steps, points)
                wall = (own[:, 2] > 0.1) & ((np.abs(own[:, 0]) > 14.5) | (np.abs(own[:, 1]) > 9.5))
                if is_own:
                    most, count = max(most, off[wall].max()), count + wall.sum()
                else:
                    stamped = max(stamped, off[wall].max())
        before = steps
    print(f"own deskew: {count} points are off the walls by {most * 1e3:.4f} mm at most, without it by {stamped:.2f} m")
    assert count > 100_000 and most < 1e-4 and stamped > 0.3


def errors(path: str, deskew: bool) -> tuple[np.ndarray, float]:
    """The errors of the steps from scan to scan in metres, and the root mean square error of all positions."""
    config = load_config(None)
    config.data.max_range, config.data.min_range, config.data.deskew = 100.0, 1.0, deskew
    config.mapping.voxel_size = 0.5
    odometry = KissICP(config)
    found, truth = [], []
    for steps, points in frames(path):
        odometry.register_frame(points[:, 1:], points[:, 0])
        found.append(odometry.last_pose)
        truth.append(matrix(steps[-1]))
    inverse = np.linalg.inv
    off = [inverse(inverse(t[0]) @ t[1]) @ (inverse(f[0]) @ f[1]) for t, f in zip(zip(truth, truth[1:]), zip(found, found[1:]))]
    places = [(inverse(truth[0]) @ t)[:3, 3] - (inverse(found[0]) @ f)[:3, 3] for t, f in zip(truth, found)]
    # The first scans have no initial speed.
    return np.array([np.linalg.norm(step[:3, 3]) for step in off[5:]]), np.sqrt(np.mean(np.sum(np.square(places), axis=1)))


def main(noisy: str, clean: str) -> None:
    exact(clean)
    worst = {}
    for deskew in (True, False):
        steps, place = errors(noisy, deskew)
        worst[deskew] = np.median(steps), place
        print(f"deskew {'on ' if deskew else 'off'}: a scan is off by {np.median(steps) * 1e3:.2f} mm (median; rms {np.sqrt(np.mean(steps**2)) * 1e3:.2f}), "
              f"the way by {place * 1e3:.1f} mm (rms) after {len(steps) + 6} scans")
    ratio = worst[False][0] / worst[True][0], worst[False][1] / worst[True][1]
    print(f"without deskew scans are {ratio[0]:.2f} times as far off, the way {ratio[1]:.2f} times")
    assert worst[True][0] < SIGMA and ratio[1] > 2.0, "odometry"


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
