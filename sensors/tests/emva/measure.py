"""Measures a rendered camera by EMVA 1288's reference implementation: python measure.py path/to/emva

Flat fields and dark frames at a series of exposure times go through the whole camera. The reference implementation
(PyPI emva1288, release 4.0 of the standard) must find the parameters that were set.
"""

import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from emva1288.process.data import Data1288
from emva1288.process.loader import LoadImageData
from emva1288.process.parser import ParseEmvaDescriptorFile
from emva1288.process.results import Results1288
from scipy.stats import norm

TOLERANCE = 0.01
SIZE = 512, 384
SET = {
    "dn_per_electron": 0.4,
    "full_well_e": 10_000.0,
    "dark_current_e_per_s": 1000.0,
    "read_noise_e": 6.0,
    "dsnu_e": 4.0,
    "prnu": 0.01,
    "black_level_dn": 64.0,
    "quantum_efficiency": 0.6,
    "bits": 12,
}
COLOUR = 0.5
# The number of photons that fill the well, and a series of exposures from 0 to beyond that.
FULL = SET["full_well_e"] / SET["quantum_efficiency"]
SERIES = np.concatenate([[0.005, 0.01, 0.02, 0.03], np.linspace(0.05, 0.9, 25), np.linspace(0.91, 1.08, 18)])
# The number of pictures for the spatial values, in the middle of the range.
STACK = 32


def render(program, directory):
    """Writes pictures and their descriptor file; returns the exposure times and photons of the series."""
    asked = []
    words = " ".join(f"{name}={value}" for name, value in SET.items())
    head = f"width={SIZE[0]} height={SIZE[1]} {words}"
    said = subprocess.run([program, directory], input=head, capture_output=True, text=True, check=True).stdout
    photons_per_s = float(said.split()[0]) * COLOUR
    times = np.round(SERIES * FULL / photons_per_s * 1e9)  # whole nanoseconds

    lines = ["v 4.0", f"n {SET['bits']} {SIZE[0]} {SIZE[1]}"]

    def series(heading, time_ns, colour, count):
        lines.append(heading)
        for _ in range(count):
            lines.append(f"i {len(asked)}.u16")
            asked.append(f"{time_ns * 1e-9!r} {colour} {len(asked)}")

    photons = times * 1e-9 * photons_per_s
    for time_ns, count in zip(times.tolist(), photons.tolist()):
        series(f"b {time_ns!r} {count!r}", time_ns, COLOUR, 2)
        series(f"d {time_ns!r}", time_ns, 0, 2)
    middle = np.argmin(np.abs(SERIES - 0.5))
    series(f"b {times[middle]!s} {photons[middle]!s}", float(times[middle]), COLOUR, STACK)
    series(f"d {times[middle]!s}", float(times[middle]), 0, STACK)
    text = "\n".join([head, *asked]) + "\n"
    subprocess.run([program, directory], input=text, capture_output=True, text=True, check=True)
    (pathlib.Path(directory) / "descriptor.txt").write_text("\n".join(lines) + "\n")
    return times, photons


def load(path):
    return np.fromfile(path, "<u2").reshape(SIZE[1], SIZE[0])


def saturation(times, photons):
    """Returns the standard's saturation capacity by quadrature: the signal of light at the peak of the variance.

    A full well cuts off the upper end of the counts, so that their variance falls before their mean does. Read noise is
    added after the well and is not cut off.
    """
    response = np.linspace(-4.5, 4.5, 91)
    weight = norm.pdf(response) / norm.pdf(response).sum()
    variances = []
    for time_ns, count in zip(times, photons):
        dark = SET["dark_current_e_per_s"] * time_ns * 1e-9
        total = 0.0
        for z, share in zip(response, weight):
            mean = count * SET["quantum_efficiency"] * (1 + SET["prnu"] * z) + dark
            spread = np.sqrt(mean)
            x = (mean + spread * np.linspace(-7, 7, 1401)) if mean > 0 else np.zeros(1401)
            p = norm.pdf(np.linspace(-7, 7, 1401))
            p /= p.sum()
            held = np.minimum(x, SET["full_well_e"])
            total += share * ((p * held**2).sum() - (p * held).sum() ** 2 + SET["read_noise_e"] ** 2)
        variances.append(total)
    return photons[int(np.argmax(variances))] * SET["quantum_efficiency"]


def main():
    with tempfile.TemporaryDirectory() as directory:
        times, photons = render(sys.argv[1], directory)
        info = ParseEmvaDescriptorFile(f"{directory}/descriptor.txt", loglevel=30)
        images = LoadImageData(info.images, fload=load, loglevel=30)
        data = Data1288(images.data, loglevel=30).data
    results = Results1288(data, loglevel=30)
    plateau = (data["temporal"]["u_y"][-1] - SET["black_level_dn"]) / SET["dn_per_electron"]
    rows = [
        ("K, DN/e", results.K, SET["dn_per_electron"]),
        ("quantum efficiency", results.QE / 100, SET["quantum_efficiency"]),
        ("read noise, e", results.sigma_d, SET["read_noise_e"]),
        ("dark current by the mean, e/s", results.u_I_mean, SET["dark_current_e_per_s"]),
        ("dark current by the variance, e/s", results.u_I_var, SET["dark_current_e_per_s"]),
        ("DSNU, e", results.DSNU1288, SET["dsnu_e"]),
        ("PRNU", results.PRNU1288 / 100, SET["prnu"]),
        ("full well, e", plateau, SET["full_well_e"]),
        ("saturation capacity, e", results.u_e_sat, saturation(times, photons)),
        ("linearity, 1 - largest error", 1 - max(abs(results.LE_min), abs(results.LE_max)) / 100, 1.0),
    ]
    failed = False
    for name, found, expected in rows:
        off = found / expected - 1
        failed |= not abs(off) <= TOLERANCE
        print(f"{name:34} set {expected:10.5g}  found {found:10.5g}  {off:+.3%}")
    # Rows and columns have no patterns of their own: their variance is less than a hundredth of that of the pixels.
    for name, part, whole in [
        ("DSNU of columns and rows", results.s_2_y_col_dark + results.s_2_y_row_dark, results.s_2_y_dark),
        ("PRNU of columns and rows", results.s_2_y_col + results.s_2_y_row, results.s_2_y),
    ]:
        failed |= not abs(part) <= TOLERANCE * whole
        print(f"{name:34} {part / whole:+.3%} of the variance")
    sys.exit("differs from what was set" if failed else 0)


main()
