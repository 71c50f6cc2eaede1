"""Compares mesh files as Belvedere reads them with trimesh: bounds, area, triangles, and rays.

    python3 tests/meshes/compare.py MESH_RAYS

MESH_RAYS is the example of that name."""

import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np
import trimesh
from write import CASES

RAYS = 10_000
# The largest difference between distances, relative to the size of the mesh.
MOST = 1e-5
# trimesh does not read fans and normalized coordinates of glTF, nor binary PLY with triangles and quads, and fills the
# notches of concave faces.
ONLY_BY_HAND = {"gltf_all", "glb_all", "ply_little", "ply_big", "obj_prism"}


def rays(random, low, high):
    """From around the mesh, to points inside its bounds."""
    centre, size = (low + high) / 2, np.linalg.norm(high - low)
    away = random.normal(size=(RAYS, 3))
    origins = centre + away / np.linalg.norm(away, axis=1)[:, None] * size * random.uniform(0.2, 1.5, (RAYS, 1))
    directions = random.uniform(low, high, (RAYS, 3)) - origins
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return origins.astype("<f4"), directions.astype("<f4")


def by_trimesh(triangles, origins, directions):
    """The distance to the first hit of each ray, infinite without one."""
    mesh = trimesh.Trimesh(**trimesh.triangles.to_kwargs(triangles), process=False)
    distance = np.full(RAYS, np.inf)
    engine = trimesh.ray.ray_triangle.RayMeshIntersector(mesh)
    _, ray, places = engine.intersects_id(origins, directions, multiple_hits=True, return_locations=True)
    np.minimum.at(distance, ray, np.linalg.norm(places - origins[ray], axis=1))
    return distance


def check(name, file, triangles, origins, directions, line, ours):
    """Returns what is wrong with a file."""
    if line.startswith("REFUSED"):
        return [line]
    found = np.array(line.split(), dtype=float)
    low, high = triangles.reshape(-1, 3).min(axis=0), triangles.reshape(-1, 3).max(axis=0)
    size, area = np.linalg.norm(high - low), trimesh.triangles.area(triangles).sum()
    wrong = []
    if abs(found[:6] - [*low, *high]).max() > MOST * size:
        wrong.append(f"bounds {found[:6]}, not {low} {high}")
    if abs(found[6] - area) > MOST * area:
        wrong.append(f"area {found[6]}, not {area}")
    if found[7] != len(triangles):
        wrong.append(f"{found[7]:.0f} triangles, not {len(triangles)}")
    if name not in ONLY_BY_HAND:
        read = trimesh.load(file, force="mesh", process=False)
        unit = {"dae_inches": 0.0254}.get(name, 1)
        if abs(read.bounds * unit - [low, high]).max() > MOST * size or abs(read.area * unit**2 - area) > MOST * area:
            wrong.append(f"trimesh itself reads bounds {read.bounds} and area {read.area}, not {low} {high} {area}")
    theirs = by_trimesh(triangles, origins.astype(float), directions.astype(float))
    # Directions are unit vectors rounded to f32.
    ours = ours * np.linalg.norm(directions.astype(float), axis=1)
    hits = np.isfinite(theirs)
    if (hits != np.isfinite(ours)).any():
        ray = np.flatnonzero(hits != np.isfinite(ours))
        wrong.append(f"{len(ray)} rays hit only one: ray {ray[0]}: {theirs[ray[0]]}, ours {ours[ray[0]]}")
    both = hits & np.isfinite(ours)
    off = abs(theirs[both] - ours[both]).max(initial=0) / size
    if off > MOST or both.sum() < RAYS / 20:
        wrong.append(f"distances differ by {off:.1e} of the size; {both.sum()} hits")
    print(f"{name}: {len(triangles)} triangles, {both.sum()} hits, largest difference {off:.1e}")
    return wrong


def main():
    seed = os.environ.get("BELVEDERE_SEED", "1")
    if seed == "new":
        seed = time.time_ns() % 10**9
        print(f"BELVEDERE_SEED={seed}")
    random = np.random.default_rng(int(seed))
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        made = []
        for name, make in CASES.items():
            content, ending, triangles = make(random)
            triangles = np.asarray(triangles, dtype=float)
            file = pathlib.Path(folder, f"{name}.{ending}")
            file.write_bytes(content.encode() if isinstance(content, str) else content)
            corners = triangles.reshape(-1, 3)
            origins, directions = rays(random, corners.min(axis=0), corners.max(axis=0))
            file.with_suffix(".rays").write_bytes(np.hstack([origins, directions]).tobytes())
            made.append((name, file, triangles, origins, directions))
        arguments = [str(path) for _, file, *_ in made for path in (file, file.with_suffix(".rays"))]
        said = subprocess.run([sys.argv[1], *arguments], stdout=subprocess.PIPE, text=True, check=False)
        for case, line in zip(made, said.stdout.splitlines(), strict=True):
            out = case[1].with_suffix(".rays.out")
            ours = np.fromfile(out, dtype="<f4").astype(float) if out.exists() else None
            faults += [f"{case[0]}: {wrong}" for wrong in check(*case, line, ours)]
    if faults:
        sys.exit("\n".join(faults))


main()
