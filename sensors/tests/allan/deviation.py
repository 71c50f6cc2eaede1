"""Allan deviations of an inertial unit at rest by PyPI's allantools: python deviation.py path/to/imu

The result must be the parameters of the preset: the density of white noise at 1 s with its slope of -1/2, and over all
times the closed form of white noise and a Gauss-Markov bias together.
"""

import subprocess
import sys

import allantools
import numpy as np

TOLERANCE = 0.03
RATE, SECONDS = 100.0, 20_000.0
PRESETS = {
    # Gyro and accelerometer: noise density, density that drives the bias, its correlation time, quantisation step.
    "adis16448": [
        (3.394e-4, 3.879e-5, 1000.0, np.radians(0.04)),
        (4e-3, 6e-3, 300.0, 0.833e-3 * 9.80665),
    ],
}
TIMES = np.array([0.1, 0.2, 0.5, 1, 2, 5, 10, 30, 100, 300])


def closed_form(times, density, drive, tau, step):
    """Returns the deviation of white noise including quantisation, and of the drifting bias."""
    white = (density**2 + step**2 / 12 / RATE) / times
    x = times / tau
    bias = (drive * tau) ** 2 / times * (1 - (3 - 4 * np.exp(-x) + np.exp(-2 * x)) / (2 * x))
    return np.sqrt(white + bias)


def deviation(axes):
    """Returns the deviations of all axes together, and their relative uncertainty."""
    variances, windows = 0, 0
    for axis in axes.T:
        times, found, _, _ = allantools.oadev(axis, rate=RATE, data_type="freq", taus=TIMES)
        assert np.allclose(times, TIMES), times
        variances = variances + found**2 / axes.shape[1]
        windows += SECONDS / TIMES
    return np.sqrt(variances), 1 / np.sqrt(windows)


def main():
    worst = 0
    for name, triads in PRESETS.items():
        said = subprocess.run([sys.argv[1], name, str(RATE), str(SECONDS)], capture_output=True, check=True).stdout
        reads = np.frombuffer(said).reshape(-1, 6)
        for triad, (kind, figures) in enumerate(zip(("gyro", "accelerometer"), triads)):
            axes = reads[:, 3 * triad : 3 * triad + 3]
            found, spread = deviation(axes)
            expected = closed_form(TIMES, *figures)
            for time, value, right, sigma in zip(TIMES, found, expected, spread):
                print(f"{name} {kind:13} {time:6.1f} s  {value:.4e}  {right:.4e}  {value / right - 1:+.2%}")
                # For longer times, the record has too few windows for this tolerance.
                allowed = max(TOLERANCE, 3 * sigma)
                assert abs(value / right - 1) < allowed, (kind, time)
                if allowed == TOLERANCE:
                    worst = max(worst, abs(value / right - 1))
            density = figures[0]
            if kind == "gyro":
                assert abs(found[TIMES == 1][0] / density - 1) < TOLERANCE, (found, density)
                slope = np.polyfit(np.log(TIMES[:4]), np.log(found[:4]), 1)[0]
                print(f"{name} {kind:13} density {found[TIMES == 1][0]:.4e} of {density:.4e}, slope {slope:.3f}")
                assert abs(slope + 0.5) < 0.02, slope
    print(
        f"Allan deviations agree: the largest error is {worst:.2%}, for times at which a record of {SECONDS:.0f} s"
        " resolves 3 %"
    )


main()
