"""Compares two lists of link poses, as `link_poses` of libsdformat and Belvedere's example print them, to 1e-9.

    python3 tests/sdformat/compare.py THEIRS OURS LEAST

At least LEAST links must be there, so that two empty lists are no agreement. A file that one of them refuses, the other
one refuses too, or warns about."""

import math
import sys

MOST = 1e-9


def read(path):
    """The poses of the links of each file, and what was said about files."""
    files, said = {}, {}
    for line in open(path):
        words = line.split()
        if words[0] == "FILE":
            links = files.setdefault(words[1], {})
        elif words[0] in ("REFUSED", "WARNED"):
            said[list(files)[-1]] = line.strip()
        else:
            assert words[0] not in links, f"{path}: {words[0]} twice"
            links[words[0]] = [float(word) for word in words[1:]]
    return files, said


def difference(theirs, ours):
    """The distance in metres, and the angle between both rotations in radians."""
    # The vector part of conj(theirs) * ours is the sine of half the angle, which is exact for small angles.
    (x, y, z, w), (a, b, c, d) = theirs[3:], ours[3:]
    vector = [w * a - x * d - y * c + z * b, w * b - y * d - z * a + x * c, w * c - z * d - x * b + y * a]
    return math.dist(theirs[:3], ours[:3]), 2 * math.asin(min(1, math.hypot(*vector)))


(theirs, they_said), (ours, we_said) = read(sys.argv[1]), read(sys.argv[2])
faults, links, refused, most = [], 0, 0, [0.0, 0.0]
if theirs.keys() != ours.keys():
    faults.append(f"different files: {theirs.keys() ^ ours.keys()}")
for file in sorted(theirs.keys() & ours.keys()):
    they, we = they_said.get(file, ""), we_said.get(file, "")
    if "REFUSED" in they + we:
        refused += 1
        if not they or not we:
            faults.append(f"{file}: {f'libsdformat: {they}' if they else f'only here: {we}'}")
        continue
    if theirs[file].keys() != ours[file].keys():
        faults.append(f"{file}: only one of both has the links {sorted(theirs[file].keys() ^ ours[file].keys())}")
    for link in theirs[file].keys() & ours[file].keys():
        links += 1
        found = difference(theirs[file][link], ours[file][link])
        most = [max(pair) for pair in zip(most, found)]
        if max(found) > MOST:
            faults.append(f"{file}: {link} is {found} away: {theirs[file][link]}, ours {ours[file][link]}")
print(
    f"{links} links in {len(theirs)} files; {refused} refused; the largest differences: {most[0]:.1e} m, {most[1]:.1e} rad"
)
if links < int(sys.argv[3]):
    faults.append(f"only {links} links")
if faults:
    sys.exit("\n".join(faults[:20]))
