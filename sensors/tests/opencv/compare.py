"""Compares the lens models with OpenCV's: python compare.py path/to/project_points

For each lens, both project 100,000 random points of its domain. Then a grid of pixels is unprojected to rays by us and
projected to pixels by OpenCV. OpenCV also projects points behind its camera, and folds back points beyond the rim of a
lens, so the comparison is limited to our domain.
"""

import subprocess
import sys

import cv2
import numpy as np

POINTS = 100_000
LARGEST_DIFFERENCE = 1e-3  # px
SIZE = 800, 600
ZERO = np.zeros(3)


def ours(program, lens, rows):
    """Returns the output of project_points, with NaN for `none`."""
    text = "\n".join([" ".join(map(repr, lens)).replace("'", ""), *(" ".join(map(repr, row)) for row in rows.tolist())])
    said = subprocess.run([program], input=text + "\n", capture_output=True, text=True, check=True).stdout
    lines = said.splitlines()
    assert len(lines) == len(rows), f"{len(lines)} lines of output for {len(rows)} of input"
    none = [float("nan")] * (5 - rows.shape[1])
    return np.array([none if line == "none" else [float(word) for word in line.split()] for line in lines])


def camera_matrix(intrinsics):
    fx, fy, cx, cy, skew = intrinsics
    return np.array([[fx, skew, cx], [0, fy, cy], [0, 0, 1.0]])


def brown_conrady(intrinsics, parameters, points):
    assert intrinsics[4] == 0, "cv2.projectPoints has no skew"
    return cv2.projectPoints(points, ZERO, ZERO, camera_matrix(intrinsics), np.array(parameters))[0]


def kannala_brandt(intrinsics, parameters, points):
    matrix, alpha = camera_matrix([*intrinsics[:4], 0.0]), intrinsics[4] / intrinsics[0]
    points = points.reshape(-1, 1, 3)
    return cv2.fisheye.projectPoints(points, ZERO, ZERO, matrix, np.array(parameters), alpha=alpha)[0]


def mei(intrinsics, parameters, points):
    points = points.reshape(-1, 1, 3)
    xi, distortion = parameters[0], np.array(parameters[1:])
    return cv2.omnidir.projectPoints(points, ZERO, ZERO, camera_matrix(intrinsics), xi, distortion)[0]


WEBCAM = [618.2, 617.4, 401.7, 298.9, 0.0]
WIDE = [260.0, 262.5, 395.2, 303.1, 0.0]
FISHEYE = [240.0, 241.0, 398.0, 302.0, 1.5]

# Name, OpenCV's function, our name, intrinsic parameters, parameters of the model, largest angle of the points.
LENSES = [
    ("pinhole", brown_conrady, "pinhole", WEBCAM, [], 80),
    ("4 coefficients", brown_conrady, "brown_conrady", WEBCAM, [0.1, -0.25, 8e-4, -3e-4], 45),
    ("5, barrel", brown_conrady, "brown_conrady", WEBCAM, [-0.41, 0.19, -1.2e-3, 9e-4, -0.04], 54),
    ("5, pincushion", brown_conrady, "brown_conrady", WIDE, [0.2, 0.05, 1e-3, 1e-3, 0.01], 65),
    ("5, decentred", brown_conrady, "brown_conrady", WEBCAM, [-0.05, 0.01, 0.03, -0.02, 0.0], 50),
    ("8 coefficients", brown_conrady, "brown_conrady", WEBCAM, [0.49, -2.71, 4e-4, -2e-4, 1.51, 0.37, -2.53, 1.44], 55),
    ("8, wide", brown_conrady, "brown_conrady", WIDE, [5.2, 2.4, 3e-5, -1e-4, 0.1, 5.6, 4.1, 0.7], 65),
    (
        "12 coefficients",
        brown_conrady,
        "brown_conrady",
        WIDE,
        [0.1, 0.02, 5e-4, -1e-3, 0.0, 0.3, 0.04, 0.0, 4e-3, -1e-3, -3e-3, 8e-4],
        65,
    ),
    (
        "14 coefficients",
        brown_conrady,
        "brown_conrady",
        WEBCAM,
        [-0.2, 0.1, 1e-3, 2e-3, 0.0, 0.02, 0.0, 0.0, 1e-3, 0.0, -1e-3, 0.0, 0.12, -0.08],
        50,
    ),
    ("14, strong tilt", brown_conrady, "brown_conrady", WIDE, [0.05, *[0.0] * 11, -0.5, 0.4], 50),
    ("fisheye, k = 0", kannala_brandt, "kannala_brandt", FISHEYE, [0.0] * 4, 89.9),
    ("fisheye", kannala_brandt, "kannala_brandt", FISHEYE, [0.03, -0.01, 4e-3, -8e-4], 89.9),
    ("fisheye, rim at 63°", kannala_brandt, "kannala_brandt", FISHEYE, [-0.2, 0.0, -0.02, 0.0], 62),
    ("omnidir, ξ = 0.9", mei, "mei", FISHEYE, [0.9, -0.05, 0.01, 4e-4, -3e-4], 110),
    ("omnidir, ξ = 1", mei, "mei", FISHEYE, [1.0, -0.01, 0.001, 1e-4, 1e-4], 130),
    ("omnidir, mirror", mei, "mei", FISHEYE, [1.6, -0.1, 0.02, 1e-3, 1e-3], 120),
]


def main(program):
    random = np.random.default_rng(1)
    columns, rows = np.meshgrid(np.arange(0.0, SIZE[0], 4), np.arange(0.0, SIZE[1], 4))
    pixels = np.stack([columns.ravel(), rows.ravel()], axis=1)
    failures = []
    print(f"OpenCV {cv2.__version__}: largest differences in px")
    for name, theirs, model, intrinsics, parameters, degrees in LENSES:
        # Evenly distributed over the cap of the sphere, at 0.1 to 100 m.
        z = random.uniform(np.cos(np.radians(degrees)), 1.0, POINTS)
        turn, across = random.uniform(0, 2 * np.pi, POINTS), np.sqrt(1 - z * z)
        points = np.stack([across * np.cos(turn), across * np.sin(turn), z], axis=1)
        points *= 10 ** random.uniform(-1, 2, (POINTS, 1))

        lens = [model, *intrinsics, *parameters]
        mine = ours(program, lens, points)
        seen = ~np.isnan(mine[:, 0])
        projected = np.abs(mine - theirs(intrinsics, parameters, points).reshape(-1, 2))[seen].max()

        rays = ours(program, lens, pixels)
        back = ~np.isnan(rays[:, 0])
        # fisheye.projectPoints does not support points behind the camera.
        if theirs is kannala_brandt:
            back &= rays[:, 2] > 1e-3
        unprojected = np.abs(theirs(intrinsics, parameters, rays[back]).reshape(-1, 2) - pixels[back]).max()

        print(
            f"  {name:20} {seen.sum():6} points {projected:8.1e}   {back.sum():5} of {len(pixels)} pixels"
            f" {unprojected:8.1e}"
        )
        if not max(projected, unprojected) < LARGEST_DIFFERENCE:
            failures.append(f"{name} differs by {max(projected, unprojected)} px")
        if seen.sum() < 0.99 * POINTS or back.sum() < 0.2 * len(pixels):
            failures.append(f"{name} sees {seen.sum()} points and {back.sum()} pixels")
    sys.exit("\n".join(failures) or 0)


main(sys.argv[1])
