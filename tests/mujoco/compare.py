"""Compares the motion of small mechanisms with MuJoCo's.

    python tests/mujoco/compare.py target/debug/examples/link_poses

Places agree to 1 mm where links rest, and to 1 % of the way along paths; periods agree to 1 %. Rotations along paths agree
to 10 mrad and 1 %, because MuJoCo's contacts are soft: its boxes tilt by half of that when they slide."""

import math
import pathlib
import subprocess
import sys
import tempfile

import mujoco
import numpy as np
from mechanisms import all_of_them

EVERY = 0.01
MJCF = """<mujoco><compiler angle="radian" eulerseq="XYZ"/><option timestep="0.0002" integrator="implicitfast" gravity="0 0 -9.8"
 cone="elliptic" impratio="100" tolerance="1e-12" iterations="200"/><default><geom condim="3" solref="0.002 1"/>
 <joint solreffriction="0.001 1"/></default><worldbody>{}</worldbody></mujoco>"""


def ours(program, mechanism, folder):
    """The poses of each link, in rows of x y z qx qy qz qw."""
    path = pathlib.Path(folder) / "m.world"
    path.write_text(
        "<sdf version='1.11'><world name='w'><gravity>0 0 -9.8</gravity><physics type='ode'>"
        f"<max_step_size>0.001</max_step_size></physics>{mechanism.sdf}</world></sdf>"
    )
    command = [program, "--run", str(mechanism.seconds), path]
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    found = {}
    for line in printed.splitlines():
        name, *numbers = line.split()
        if "::" in name:
            found.setdefault(name, []).append([float(number) for number in numbers])
    return {name: np.array(rows) for name, rows in found.items()}


def theirs(mechanism):
    model = mujoco.MjModel.from_xml_string(MJCF.format(mechanism.mjcf))
    data = mujoco.MjData(model)
    found = {link: [] for link in mechanism.links}
    for frame in range(1, round(mechanism.seconds / EVERY) + 1):
        while data.time < frame * EVERY - model.opt.timestep / 2:
            mujoco.mj_step(model, data)
        mujoco.mj_kinematics(model, data)
        for link in mechanism.links:
            w, x, y, z = data.body(link).xquat
            found[link].append([*data.body(link).xpos, x, y, z, w])
    return {link: np.array(rows) for link, rows in found.items()}


def period(values):
    """The mean time between two passages upwards through the mean of the extremes."""
    values = values - (values.max() + values.min()) / 2
    up = np.flatnonzero((values[:-1] < 0) & (values[1:] >= 0))
    assert len(up) >= 2, "no period"
    times = (up - values[up] / (values[up + 1] - values[up])) * EVERY
    return (times[-1] - times[0]) / (len(times) - 1)


def angle(rows, axis):
    return np.unwrap(2 * np.arctan2(rows[:, 3 + axis], rows[:, 6]))


def turned(a, b):
    """The angle between the rotations of two rows."""
    return 2 * math.acos(min(1, abs(float(np.dot(a[3:], b[3:])))))


def judge(mechanism, theirs, ours):
    """What differs, as a share of what is allowed, with a text."""
    match mechanism.judge:
        case "period" | "angle":
            of = (lambda rows: rows[:, mechanism.axis]) if mechanism.judge == "period" else (lambda rows: angle(rows, mechanism.axis))
            a, b = period(of(theirs)), period(of(ours))
            return abs(b / a - 1) / 0.01, f"period {a:.4f} s, ours {b:.4f} s"
        case "rest":
            a, b = theirs[-1], ours[-1]
            away, turn = math.dist(a[:3], b[:3]), turned(a, b)
            moved = np.abs(ours[-20:, :3] - b[:3]).max()
            return max(away / 1e-3, turn / 2e-3, moved / 1e-3), f"{away * 1e3:.2f} mm and {turn * 1e3:.2f} mrad apart; ends at {b[:3].round(4)}"
        case "path":
            way = np.abs(theirs[:, :3] - theirs[0, :3]).max()
            apart = np.linalg.norm(theirs[:, :3] - ours[:, :3], axis=1).max()
            turn = max(turned(a, b) for a, b in zip(theirs, ours))
            most = max(turned(a, theirs[0]) for a in theirs)
            return max(apart / (0.001 + 0.01 * way), turn / (0.01 + 0.01 * most)), (
                f"{apart * 1e3:.2f} mm apart on {way:.3f} m, {turn * 1e3:.2f} mrad on {most:.3f} rad"
            )


failed = []
with tempfile.TemporaryDirectory() as folder:
    mechanisms = list(all_of_them())
    for mechanism in mechanisms:
        found = ours(sys.argv[1], mechanism, folder)
        expected = theirs(mechanism)
        for link in mechanism.links:
            share, text = judge(mechanism, expected[link], found[link])
            print(f"{'ok ' if share <= 1 else 'BAD'} {mechanism.name}, {link}: {text}", flush=True)
            if share > 1:
                failed.append(mechanism.name)
assert len(mechanisms) >= 20, len(mechanisms)
if failed:
    sys.exit(f"not as in MuJoCo: {', '.join(failed)}")
