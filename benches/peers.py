"""Even triangles over three surfaces, by this program and by what else can be installed from PyPI.

python3 -m venv target/peers
target/peers/bin/pip install numpy scipy scikit-image pyvista pyacvd trimesh
cargo build --release --package marching-particles-cli
target/peers/bin/python benches/peers.py 20000

Every program gets the same f and about as many points. Seconds are those of this process, once, on
one core where the program has a choice: from the function to points and triangles, without the
import of modules and without the report. Lengths are in the spacing of a hexagonal lattice of as
many points on the same area.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

PROGRAM = pathlib.Path(__file__).parent.parent / "target" / "release" / "marching-particles"
SURFACES = {
    "Ellipsoid": ("x^2 + y^2/0.49 + z^2/0.25 = 1", 1.25, lambda x, y, z: x**2 + y**2 / 0.49 + z**2 / 0.25 - 1),
    "Torus": (
        "(hypot(x, y) - 1)^2 + z^2 = 0.16",
        1.6,
        lambda x, y, z: (np.hypot(x, y) - 1) ** 2 + z**2 - 0.16,
    ),
    "Tanglecube": (
        "x^4 + y^4 + z^4 - 5(x^2 + y^2 + z^2) + 11.8 = 0",
        2.6,
        lambda x, y, z: x**4 + y**4 + z**4 - 5 * (x**2 + y**2 + z**2) + 11.8,
    ),
}


def ours(method):
    def run(formula, half, function, count):
        with tempfile.TemporaryDirectory() as folder:
            path = str(pathlib.Path(folder) / "mesh.ply")
            command = [PROGRAM, "sample", "--formula", formula, "--box", str(half), "--count", str(count)]
            command += ["--method", method, "--mesh", path, "--report", "none", "--json", "--quiet"]
            told = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
            spent = {k: v for k, v in told["seconds"].items() if k not in ("writing", "quality")}
            import trimesh

            mesh = trimesh.load(path, process=False)
            return np.asarray(mesh.vertices), np.asarray(mesh.faces), sum(spent.values())

    return run


def cells_for(function, half, count):
    """Cells along a side of the grid on which marching cubes has so many vertices."""

    def vertices(cells):
        return len(marched(function, half, cells)[0])

    return round(64 * (count / vertices(64)) ** 0.5)


def marched(function, half, cells):
    from skimage.measure import marching_cubes

    at = np.linspace(-half, half, cells + 1)
    values = function(*np.meshgrid(at, at, at, indexing="ij", sparse=True))
    points, faces, *_ = marching_cubes(values, 0.0, spacing=[2 * half / cells] * 3)
    return points - half, faces


def scikit_image(formula, half, function, count):
    cells = cells_for(function, half, count)
    start = time.process_time()
    points, faces = marched(function, half, cells)
    return points, faces, time.process_time() - start


def acvd(formula, half, function, count):
    import pyacvd
    import pyvista

    # Its clusters are made of the vertices of a finer mesh.
    cells = cells_for(function, half, 10 * count)
    start = time.process_time()
    points, faces = marched(function, half, cells)
    mesh = pyvista.PolyData.from_regular_faces(points, faces)
    clustering = pyacvd.Clustering(mesh)
    clustering.cluster(count)
    mesh = clustering.create_mesh()
    return np.asarray(mesh.points), mesh.regular_faces, time.process_time() - start


def even(formula, half, function, count):
    import trimesh

    cells = cells_for(function, half, count)
    start = time.process_time()
    mesh = trimesh.Trimesh(*marched(function, half, cells), process=False)
    points, _ = trimesh.sample.sample_surface_even(mesh, count, seed=0)
    return np.asarray(points), None, time.process_time() - start


PROGRAMS = {
    "refined": ours("refined"),
    "front": ours("front"),
    "scikit-image": scikit_image,
    "scikit-image, pyacvd": acvd,
    "scikit-image, trimesh `sample_surface_even`": even,
}


def nearest(points):
    from scipy.spatial import cKDTree

    return cKDTree(points).query(points, k=2)[0][:, 1]


def figures(points, faces, area):
    """Share of valence six, mean and least smallest angle, closest pair, variation of the spacing."""
    spacing = np.sqrt(2 * area / (np.sqrt(3) * len(points)))
    distance = nearest(points) / spacing
    row = [distance.min(), distance.std() / distance.mean()]
    if faces is None:
        return [None, None, None, *row]
    sides = [points[faces[:, (k + 1) % 3]] - points[faces[:, k]] for k in range(3)]
    sides = [side / np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-30) for side in sides]
    cosines = [-(sides[k] * sides[k - 1]).sum(axis=1) for k in range(3)]
    smallest = np.degrees(np.arccos(np.clip(np.max(cosines, axis=0), -1, 1)))
    valence = np.bincount(faces.ravel(), minlength=len(points))
    return [(valence == 6).mean(), smallest.mean(), smallest.min(), *row]


def area_of(points, faces):
    a, b, c = (points[faces[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 20_000
    print("| | Points | Six | Mean smallest angle | Smallest angle | Closest pair | Spacing varies by | Seconds |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    for surface, (formula, half, function) in SURFACES.items():
        area = area_of(*marched(function, half, 160))
        for name, run in PROGRAMS.items():
            points, faces, seconds = run(formula, half, function, count)
            six, mean, least, closest, varies = figures(points, faces, area)
            cells = ["–"] * 3 if faces is None else [f"{six:.1%}", f"{mean:.1f}°", f"{least:.1f}°"]
            cells = [*cells, f"{closest:.2f}", f"{varies:.1%}", f"{seconds:.2f}"]
            print(f"| {surface}, {name} | {len(points):,} | {' | '.join(cells)} |", flush=True)


main()
