"""Calibrates our cameras with OpenCV and undoes their distortion: python calibrate.py path/to/render_board

A checkerboard is rendered through known lenses at many poses. Its corners are found in the pictures, and the result of
OpenCV's calibration is compared with the lens. Then a distorted picture is rectified as ROS's image_proc does it, and
compared with the same view through a pinhole.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np

SIZE = 640, 480
# The number of rays per pixel, across and down.
SAMPLES = 4
INNER = 9, 6
SIDE = 0.03  # m
VIEWS = 30
FOCAL_LENGTH = 1e-3  # as a part of it
PRINCIPAL_POINT = 0.3  # px
CURVE = 0.2  # px
LEAST_PSNR = 35.0  # dB
MARGIN = 3.0  # dB better than a quarter of a pixel beside
ZERO = np.zeros(3)

CORNERS = np.zeros((INNER[0] * INNER[1], 3))
CORNERS[:, :2] = np.mgrid[: INNER[0], : INNER[1]].T.reshape(-1, 2) * SIDE


def render(program, lens, poses, board=(INNER[0] + 1, INNER[1] + 1, SIDE)):
    """Returns pictures of the board at poses, each given as x y z and a rotation vector."""
    with tempfile.TemporaryDirectory() as directory:
        setup = " ".join(map(repr, [*SIZE, SAMPLES, *board]))
        lines = [" ".join(map(str, lens)), setup, *(" ".join(map(repr, pose.tolist())) for pose in poses)]
        subprocess.run([program, directory], input="\n".join(lines) + "\n", text=True, check=True)
        return [cv2.imread(str(Path(directory, f"{index}.pgm")), cv2.IMREAD_GRAYSCALE) for index in range(len(poses))]


def camera_matrix(fx, fy, cx, cy):
    return np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]])


class Plane:
    """Returns the result of cv2.calibrateCamera."""

    model = "brown_conrady"
    farthest_degrees = 60

    def __init__(self, flags=0):
        self.flags = flags

    def project(self, points, matrix, coefficients):
        return cv2.projectPoints(points.reshape(-1, 1, 3), ZERO, ZERO, matrix, coefficients)[0].reshape(-1, 2)

    def rays(self, pixels, matrix, coefficients):
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 100, 1e-10)
        found = cv2.undistortPoints(pixels.reshape(-1, 1, 2), matrix, coefficients, criteria=criteria)
        return np.concatenate([found.reshape(-1, 2), np.ones((len(pixels), 1))], axis=1)

    def calibrate(self, corners):
        objects = [CORNERS.astype(np.float32)] * len(corners)
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 200, 1e-12)
        error, matrix, coefficients, *_ = cv2.calibrateCamera(
            objects, corners, SIZE, None, None, flags=self.flags, criteria=criteria
        )
        return error, matrix, coefficients.ravel()


class Fisheye:
    """Returns the result of cv2.fisheye.calibrate."""

    model = "kannala_brandt"
    farthest_degrees = 78

    def project(self, points, matrix, coefficients):
        return cv2.fisheye.projectPoints(points.reshape(-1, 1, 3), ZERO, ZERO, matrix, coefficients)[0].reshape(-1, 2)

    def rays(self, pixels, matrix, coefficients):
        """Computes rays by Newton's method, because undistortPoints is limited to 90°."""
        on_plane = (pixels - matrix[[0, 1], 2]) / matrix[[0, 1], [0, 1]]
        radius = np.linalg.norm(on_plane, axis=1)
        angle = radius.copy()
        for _ in range(30):
            powers = np.array([angle ** (2 * power) for power in range(5)])
            ones = np.concatenate([[1.0], coefficients])
            value = angle * (ones @ powers)
            slope = (ones * [1, 3, 5, 7, 9]) @ powers
            angle -= (value - radius) / slope
        sine = np.sin(angle) / np.maximum(radius, 1e-12)
        return np.concatenate([on_plane * sine[:, None], np.cos(angle)[:, None]], axis=1)

    def calibrate(self, corners):
        objects = [CORNERS.reshape(1, -1, 3)] * len(corners)
        # In OpenCV 5, these flags are in the module cv2.
        names = cv2 if hasattr(cv2, "CALIB_RECOMPUTE_EXTRINSIC") else cv2.fisheye
        flags = names.CALIB_RECOMPUTE_EXTRINSIC | names.CALIB_FIX_SKEW
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 200, 1e-12)
        corners = [found.reshape(1, -1, 2).astype(float) for found in corners]
        error, matrix, coefficients, *_ = cv2.fisheye.calibrate(
            objects, corners, SIZE, None, None, flags=flags, criteria=criteria
        )
        return error, matrix, coefficients.ravel()


# Name, OpenCV's model, fx fy cx cy, coefficients, nearest and farthest board in m.
LENSES = [
    ("plumb_bob", Plane(), [512.4, 509.8, 324.7, 236.1], [-0.31, 0.12, 8e-4, -6e-4, -0.02], [0.2, 0.55]),
    (
        "rational",
        Plane(cv2.CALIB_RATIONAL_MODEL),
        [401.3, 402.6, 317.2, 243.8],
        [0.32, 0.06, 4e-4, -3e-4, 0.004, 0.55, 0.14, 0.01],
        [0.17, 0.45],
    ),
    ("fisheye", Fisheye(), [229.6, 230.9, 316.4, 241.7], [0.032, -0.012, 0.004, -0.0008], [0.1, 0.25]),
]


def look_to(ray):
    """Returns the rotation matrix from the optical axis to a ray."""
    axis = np.cross([0, 0, 1.0], ray)
    sine = np.linalg.norm(axis)
    return cv2.Rodrigues(axis / max(sine, 1e-12) * np.arctan2(sine, ray[2]))[0]


def poses_for(camera, matrix, coefficients, distances):
    """Returns poses of slanted boards all over the picture, with all corners inside it."""
    random = np.random.default_rng(7)
    poses = []
    # Where boards should be, as fractions of half the picture: many at the sides and corners, where distortion is
    # largest.
    places = [(x, y) for x in (-0.9, -0.45, 0, 0.45, 0.9) for y in (-0.85, 0, 0.85)]
    places += [(x, y) for x in (-0.98, 0.98) for y in (-0.98, 0.98)] * 2
    middle = CORNERS.mean(axis=0)
    while len(poses) < VIEWS:
        place = np.array(places[len(poses) % len(places)]) + random.uniform(-0.05, 0.05, 2)
        # Nearly upright if it should reach into a corner.
        most = np.array([0.55, 0.55, 0.3] if abs(place).min() < 0.92 else [0.4, 0.4, 0.02])
        turn = cv2.Rodrigues(random.uniform(-most, most))[0]
        distance = random.uniform(*distances)
        # Moved towards the middle until all of it is visible.
        for towards in np.linspace(1, 0, 50):
            pixel = (np.array(SIZE) - 1) / 2 * (1 + place * towards)
            ray = camera.rays(pixel[None], matrix, coefficients)[0]
            rotation = look_to(ray) @ turn
            position = ray / np.linalg.norm(ray) * distance - rotation @ middle
            points = CORNERS @ rotation.T + position
            angles = np.degrees(np.arctan2(np.linalg.norm(points[:, :2], axis=1), points[:, 2]))
            if angles.max() > camera.farthest_degrees:
                continue
            pixels = camera.project(points, matrix, coefficients)
            if pixels.min() > 9 and (pixels < np.array(SIZE) - 10).all():
                poses.append(np.concatenate([position, cv2.Rodrigues(rotation)[0].ravel()]))
                break
    return poses


def find(picture):
    """Returns the corners of the board, or None if it is not recognised."""
    flags = cv2.CALIB_CB_ACCURACY | cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_NORMALIZE_IMAGE
    found, corners = cv2.findChessboardCornersSB(picture, INNER, flags=flags)
    if not found:
        found, corners = cv2.findChessboardCorners(picture, INNER)
    if not found:
        return None
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 100, 1e-4)
    # Smaller than the smallest square.
    grid = corners.reshape(INNER[1], INNER[0], 2)
    steps = [np.linalg.norm(np.diff(grid, axis=axis), axis=2).min() for axis in (0, 1)]
    window = int(np.clip(min(steps) * 0.35, 2, 10))
    return cv2.cornerSubPix(picture, corners.reshape(-1, 1, 2), (window, window), (-1, -1), criteria).reshape(-1, 1, 2)


def calibrate(program, name, camera, intrinsics, coefficients, distances):
    """Returns descriptions of the failures."""
    matrix, true = camera_matrix(*intrinsics), np.array(coefficients)
    poses = poses_for(camera, matrix, true, distances)
    pictures = render(program, [camera.model, *intrinsics, 0.0, *coefficients], poses)
    views, shifts = [], []
    for picture, pose in zip(pictures, poses):
        corners = find(picture)
        if corners is None:
            continue
        points = CORNERS @ cv2.Rodrigues(pose[3:])[0].T + pose[:3]
        expected = camera.project(points, matrix, true)
        # The board looks the same when it is rotated by half a turn.
        if np.linalg.norm(corners[0, 0] - expected[0]) > np.linalg.norm(corners[-1, 0] - expected[0]):
            corners = corners[::-1].copy()
        views.append(corners.astype(np.float32))
        shifts.append(corners.reshape(-1, 2) - expected)
    shifts = np.concatenate(shifts)
    off = np.linalg.norm(shifts, axis=1)
    error, found, estimated = camera.calibrate(views)
    focal = np.abs(found[[0, 1], [0, 1]] / matrix[[0, 1], [0, 1]] - 1)
    principal = np.abs(found[[0, 1], 2] - matrix[[0, 1], 2])

    # The displacement of the picture's border pixels by each lens, and the positions at which each shows these rays.
    columns, rows = np.arange(0.0, SIZE[0], 8), np.arange(0.0, SIZE[1], 8)
    border = np.array(
        [(x, y) for x in columns for y in (0.0, SIZE[1] - 1.0)] + [(x, y) for y in rows for x in (0.0, SIZE[0] - 1.0)]
    )
    rays = camera.rays(border, matrix, true)
    degrees = np.degrees(np.arctan2(np.linalg.norm(rays[:, :2], axis=1), rays[:, 2]))
    rays, degrees = rays[degrees < camera.farthest_degrees], degrees[degrees < camera.farthest_degrees]

    def moved(matrix, coefficients):
        # The ideal position is that of a pinhole, and for a fisheye that without coefficients.
        return camera.project(rays, matrix, coefficients) - camera.project(rays, matrix, np.zeros(4))

    true_shift, shift = moved(matrix, true), moved(matrix, estimated)
    curve = np.linalg.norm(shift - true_shift, axis=1).max()
    where = camera.project(rays, found, estimated) - camera.project(rays, matrix, true)
    whole = np.linalg.norm(where, axis=1).max()
    print(
        f"  {name:9} {len(views)} of {len(poses)} views; corners {np.sqrt((off**2).mean()):.3f} px (largest"
        f" {off.max():.2f}, mean {shifts[:, 0].mean():+.3f} {shifts[:, 1].mean():+.3f}), reprojection {error:.3f} px; fx, fy {focal[0]:.1e} {focal[1]:.1e}; cx, cy"
        f" {principal[0]:.3f} {principal[1]:.3f} px; at the border, up to {degrees.max():.0f}°: the shift of"
        f" up to {np.linalg.norm(true_shift, axis=1).max():.1f} px within {curve:.3f} px, pixels within {whole:.3f} px"
    )
    failures = []
    if len(views) < 15:
        failures.append(f"{name}: the board is found in {len(views)} of {len(poses)} views")
    if not focal.max() < FOCAL_LENGTH:
        failures.append(f"{name}: focal lengths {focal} off")
    if not principal.max() < PRINCIPAL_POINT:
        failures.append(f"{name}: principal point {principal} px off")
    if not curve < CURVE:
        failures.append(f"{name}: the distortion is {curve} px off at the border")
    return failures


def psnr(picture, expected, valid):
    return 10 * np.log10(255**2 / ((picture.astype(float) - expected) ** 2)[valid].mean())


def blurred(picture):
    return cv2.GaussianBlur(picture.astype(np.float32), (0, 0), 1.0)


def rectify(program, name, camera, intrinsics, coefficients):
    """Returns descriptions of the failures."""
    matrix, true = camera_matrix(*intrinsics), np.array(coefficients)
    # The rectified camera has a narrower view, so that most of its pixels are inside the distorted picture.
    straight = matrix if isinstance(camera, Plane) else camera_matrix(260.0, 260.0, 319.5, 239.5)
    # Large squares, because interpolating an edge twice blurs it more than rendering it.
    board = 4, 4, 0.16
    pose = np.array([-0.2, -0.17, 0.42, 0.35, -0.25, 0.1])
    [distorted] = render(program, [camera.model, *intrinsics, 0.0, *coefficients], [pose], board)
    ideal = ["pinhole", *straight[[0, 1, 0, 1], [0, 1, 2, 2]], 0.0]
    [expected] = render(program, ideal, [pose], board)
    maps = cv2.initUndistortRectifyMap if isinstance(camera, Plane) else cv2.fisheye.initUndistortRectifyMap
    map_x, map_y = maps(matrix, true, np.eye(3), straight, SIZE, cv2.CV_32FC1)
    valid = (map_x >= 1) & (map_x <= SIZE[0] - 2) & (map_y >= 1) & (map_y <= SIZE[1] - 2)
    shift = np.hypot(map_x - np.arange(SIZE[0]), map_y - np.arange(SIZE[1])[:, None])[valid].max()
    figures = {}
    for method, flag in [("linear", cv2.INTER_LINEAR), ("cubic", cv2.INTER_CUBIC)]:
        rectified = cv2.remap(distorted, map_x, map_y, flag)
        figures[method] = psnr(rectified, expected, valid)
        # Blurring imitates a lens that is not quite sharp; what remains are displaced edges.
        figures[f"{method}, both blurred by 1 px"] = psnr(blurred(rectified), blurred(expected), valid)
    # A displacement of a quarter of a pixel, for comparison.
    beside = cv2.remap(distorted, map_x + 0.25, map_y, cv2.INTER_LINEAR)
    apart = psnr(blurred(beside), blurred(expected), valid)
    said = ", ".join(f"{method} {figure:.1f} dB" for method, figure in figures.items())
    print(
        f"  {name:9} {valid.mean():.0%} of the pixels, moved by up to {shift:.0f} px: PSNR {said}; displaced by a"
        f" quarter of a pixel {apart:.1f} dB"
    )
    # The PSNR of the sharp pictures is only printed: interpolated edges of one pixel's width limit it to 33 to 37 dB,
    # bilinear or cubic, wherever the edges are. The blurred pictures show whether the edges are in the right place.
    held = figures["linear, both blurred by 1 px"]
    failures = []
    if not held >= LEAST_PSNR:
        failures.append(f"{name}: the rectified picture has a PSNR of {held} dB against the pinhole's")
    if not held >= apart + MARGIN:
        failures.append(f"{name}: {held} dB in place, and {apart} dB displaced by a quarter of a pixel")
    return failures


def main(program):
    failures = []
    print(f"OpenCV {cv2.__version__}: calibrated from pictures of a board")
    for lens in LENSES:
        failures += calibrate(program, *lens)
    print("Rectified, against a pinhole")
    for *lens, _ in LENSES:
        failures += rectify(program, *lens)
    sys.exit("\n".join(failures) or 0)


main(sys.argv[1])
