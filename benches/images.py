"""Meshes of three-dimensional images, by this program and by what else can be installed from PyPI.

python3 -m venv target/images
target/images/bin/pip install numpy scipy scikit-image pyvista pyacvd
cargo build --release --package marching-particles-cli
target/images/bin/python benches/images.py 64 128

The images are computed from functions, to which the meshes are compared: grey values with an edge
that a scanner has blurred by 0.8 voxels, the same with noise of 6 % of the contrast, and maps of
labels; of 64³ and 128³ voxels, and of voxels 1 × 1 × 3. Errors are in voxels, the largest of all
vertices; normals are those that a program gives, as the root of the mean square of the angle to the
gradient. Vertices on a border are left out of the valences. A program that takes a number of points
is asked for 5,000 or 20,000. Seconds are those of a processor, from the voxels to the mesh, without
the import of modules; ours are those of the whole program, with its files and its proof.
"""

import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np

PROGRAM = pathlib.Path(__file__).parent.parent / "target" / "release" / "marching-particles"
CONTRAST, NOISE = 900.0, 0.06


def sphere(x, y, z):
    return np.sqrt(x**2 + y**2 + z**2) - 0.375


def torus(x, y, z):
    return np.hypot(np.hypot(x, y) - 0.28, z) - 0.125


def neck(x, y, z):
    """Two balls whose smooth union has a neck of a tenth of the image."""
    a, b = (np.sqrt((x - c) ** 2 + y**2 + z**2) - 0.19 for c in (-0.205, 0.205))
    blend = np.maximum(0.0, 0.12 - np.abs(a - b)) / 0.12
    return np.minimum(a, b) - 0.03 * blend**2


def gyroid(x, y, z):
    a, b, c = (2 * np.pi * 2.2 * t for t in (x, y, z))
    waves = np.sin(a) * np.cos(b) + np.sin(b) * np.cos(c) + np.sin(c) * np.cos(a)
    return waves / (2 * np.pi * 2.2 * 1.2)


SHAPES = {"Sphere": (sphere, 2), "Torus": (torus, 0), "Neck": (neck, 2), "Gyroid": (gyroid, None)}


class Case:
    """An image of a function: voxels, the distances between them, and the distance from the surface."""

    def __init__(self, name, kind, side, spacing=(1.0, 1.0, 1.0)):
        self.name, self.kind, self.side, self.spacing = name, kind, side, np.array(spacing)
        self.function, self.euler = SHAPES[name]
        size = np.rint(side / self.spacing).astype(int)
        axes = [np.arange(n) * step for n, step in zip(size, spacing)]
        # The middle lies between voxels, and not halfway.
        self.middle = np.array([0.5 * (axis[-1] + 0.37) for axis in axes])
        distance = self.distance(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3))[0]
        distance = distance.reshape(size)
        if kind == "labels":
            self.voxels, self.iso = (distance < 0).astype(np.uint8), 0.5
        else:
            values = CONTRAST / (1 + np.exp(2 * np.clip(distance, -50, 50)))
            noise = np.random.default_rng(1).normal(size=size) * CONTRAST * NOISE
            values += noise if kind == "noise" else 0
            self.voxels, self.iso = np.rint(values).astype(np.int16), CONTRAST / 2
        # The gyroid has three times the area of the others.
        self.count = 5_000 if side <= 64 and name != "Gyroid" else 20_000

    def distance(self, points):
        """Distance from the surface to first order, in the smallest spacing, and unit gradients."""

        def f(p):
            return self.side * self.function(*((p - self.middle) / self.side).T)

        step = 1e-4
        slopes = np.stack([(f(points + step * e) - f(points - step * e)) / (2 * step) for e in np.eye(3)], axis=-1)
        length = np.maximum(np.linalg.norm(slopes, axis=1), 1e-9)
        return f(points) / length, slopes / length[:, None]

    def inside(self, points):
        """Points that are not at the border of the image."""
        last = (np.array(self.voxels.shape) - 1) * self.spacing
        return np.all((points > 0.01) & (points < last - 0.01), axis=1)


def ours(case):
    with tempfile.TemporaryDirectory() as folder:
        image, mesh = (str(pathlib.Path(folder) / name) for name in ("image.npy", "mesh.ply"))
        # The first axis changes fastest, as that of --voxel-size does.
        np.save(image, np.asfortranarray(case.voxels))
        command = [PROGRAM, "sample", "--image", image, "--count", str(case.count), "--mesh", mesh]
        command += ["--voxel-size", "x".join(map(str, case.spacing)), "--method", "refined"]
        command += ["--label", "1"] if case.kind == "labels" else ["--iso", str(case.iso)]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        told = subprocess.run([*command, "--report", "none", "--quiet"], capture_output=True, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if told.returncode not in (0, 4):
            sys.exit(told.stderr)
        seconds = after.ru_utime - before.ru_utime
        points, normals, faces = read_ply(mesh)
    return points, faces, normals, seconds


def read_ply(path):
    """Vertices, normals and triangles of our own PLY files, whose numbers are in little-endian order."""
    data = pathlib.Path(path).read_bytes()
    head, body = data.split(b"end_header\n", 1)
    types = {"float": "<f4", "double": "<f8", "int": "<i4", "uint": "<u4", "uchar": "u1", "ushort": "<u2"}
    counts, fields, now = {}, {}, ""
    for line in head.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            now, counts[words[1]] = words[1], int(words[2])
            fields[now] = []
        elif words[0] == "property" and words[1] == "list":
            fields[now] += [("n", types[words[2]]), ("corners", types[words[3]], 3)]
        elif words[0] == "property":
            fields[now].append((words[2], types[words[1]]))
    vertices = np.frombuffer(body, np.dtype(fields["vertex"]), counts["vertex"])
    faces = np.frombuffer(body, np.dtype(fields["face"]), counts["face"], vertices.nbytes)["corners"]
    return (*(np.stack([vertices[n] for n in names], axis=-1).astype(float) for names in ("xyz", ("nx", "ny", "nz"))), faces)


def grid_of(case):
    import pyvista

    grid = pyvista.ImageData(dimensions=case.voxels.shape, spacing=tuple(case.spacing))
    grid["values"] = case.voxels.ravel(order="F").astype(np.float32)
    return grid


def flying_edges(case):
    grid = grid_of(case)
    start = time.process_time()
    mesh = grid.contour([case.iso], scalars="values", method="flying_edges")
    mesh = mesh.smooth_taubin(n_iter=20, pass_band=0.1, boundary_smoothing=True)
    mesh = mesh.compute_normals(cell_normals=False, split_vertices=False, consistent_normals=False)
    seconds = time.process_time() - start
    return np.asarray(mesh.points, float), mesh.regular_faces, np.asarray(mesh.point_data["Normals"]), seconds


def acvd(case):
    import pyacvd
    import pyvista
    from skimage.measure import marching_cubes

    start = time.process_time()
    points, faces, *_ = marching_cubes(case.voxels.astype(np.float32), case.iso, spacing=tuple(case.spacing))
    clustering = pyacvd.Clustering(pyvista.PolyData.from_regular_faces(points, faces))
    # Its clusters are made of the vertices of a finer mesh.
    clustering.subdivide(2)
    clustering.cluster(case.count)
    mesh = clustering.create_mesh().compute_normals(cell_normals=False, split_vertices=False, consistent_normals=False)
    seconds = time.process_time() - start
    return np.asarray(mesh.points, float), mesh.regular_faces, np.asarray(mesh.point_data["Normals"]), seconds


PROGRAMS = {"refined": ours, "flying edges, windowed sinc": flying_edges, "marching cubes, pyacvd": acvd}


def figures(case, points, faces, normals):
    """Largest error, angle of the normals, Euler number, share of six, smallest and largest angle."""
    used = np.unique(faces)
    inner = used[case.inside(points[used])]
    distance, gradient = case.distance(points[inner])
    # The sides of a mesh may be turned in and out: both are counted as right.
    turn = np.degrees(np.arccos(np.clip(np.abs((gradient * normals[inner]).sum(axis=1)), 0, 1)))
    sides = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, shares = np.unique(sides, axis=0, return_counts=True)
    border = np.unique(edges[shares == 1])
    valence = np.bincount(edges.ravel(), minlength=len(points))[np.setdiff1d(used, border)]
    along = [points[faces[:, (k + 1) % 3]] - points[faces[:, k]] for k in range(3)]
    along = [side / np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-30) for side in along]
    angles = np.degrees(np.arccos(np.clip([-(along[k] * along[k - 1]).sum(axis=1) for k in range(3)], -1, 1)))
    euler = len(used) - len(edges) + len(faces)
    return np.abs(distance).max(), np.sqrt((turn**2).mean()), euler, (valence == 6).mean(), angles.min(), angles.max()


def main():
    sides = [int(side) for side in sys.argv[1:]] or [64, 128]
    cases = [Case(name, kind, side) for kind in ("grey", "labels") for side in sides for name in SHAPES]
    cases += [Case(name, kind, 96, (1.0, 1.0, 3.0)) for kind in ("grey", "labels") for name in ("Sphere", "Torus")]
    cases += [Case(name, "noise", 64) for name in ("Sphere", "Torus", "Neck")]
    print("| | Points | Error | Normals | Euler number | Six | Angles | Seconds |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    for case in cases:
        size = "×".join(map(str, case.voxels.shape))
        for name, run in PROGRAMS.items():
            points, faces, normals, seconds = run(case)
            error, turn, euler, six, least, most = figures(case, points, faces, normals)
            right = "" if case.euler is None else f" ({case.euler})"
            print(
                f"| {case.name}, {case.kind}, {size}: {name} | {len(points):,} | {error:.3f} | {turn:.1f}° "
                f"| {euler}{right} | {six:.1%} | {least:.0f}°–{most:.0f}° | {seconds:.1f} |",
                flush=True,
            )


main()
