"""Triangle meshes sampled anew, by this program and by others that can be installed from PyPI.

python3 -m venv target/peers
target/peers/bin/pip install numpy scipy trimesh pyvista pyacvd pymeshlab gpytoolbox
cargo build --release --package marching-particles-cli
target/peers/bin/python benches/remesh.py 5000

Every program gets the same mesh and about as many vertices. Distances are PyMeshLab's, from 100,000
points of each mesh to the other one, over the diagonal. *Edges* is the largest distance of a point
on an edge of 30° or more of the old mesh from an edge of 20° or more of the new one. Seconds are
those of one run without reading and writing.
"""

import pathlib
import subprocess
import sys
import tempfile
import time

import gpytoolbox
import numpy as np
import pyacvd
import pymeshlab
import pyvista
import trimesh
from pyvista import examples
from scipy.spatial import cKDTree

PROGRAM = pathlib.Path(__file__).parent.parent / "target" / "release" / "marching-particles"


def between(outer, inner, height):
    """The solid between two closed curves of equally many points, from z = 0 to the height."""
    n = len(outer)
    rings = [np.column_stack([ring, np.full(n, z)]) for z in (0, height) for ring in (inner, outer)]
    i, k = np.arange(n), (np.arange(n) + 1) % n
    a, b, c, d = (ring * n + i for ring in range(4))
    e, f, g, h = (ring * n + k for ring in range(4))
    sides = [(c, d, h), (c, h, g), (a, f, b), (a, e, f), (b, f, h), (b, h, d), (a, g, e), (a, c, g)]
    return trimesh.Trimesh(np.vstack(rings), np.vstack([np.column_stack(side) for side in sides]))


def circle(n, radius=1.0):
    at = 2 * np.pi * np.arange(n) / n
    return radius * np.column_stack([np.cos(at), np.sin(at)])


def drilled():
    ring = circle(64)
    return between(ring / np.abs(ring).max(axis=1)[:, None], 0.4 * ring, 1.0)


def nut():
    ring = circle(96)
    sides = np.pi / 6 + np.pi / 3 * np.arange(6)
    width = (ring @ np.array([np.cos(sides), np.sin(sides)])).max(axis=1)
    return between(ring / width[:, None], 0.55 * ring, 0.8)


def gear():
    teeth, at = 16, 2 * np.pi * np.arange(128) / 128
    outer = np.where((np.arange(128) // 4) % 2 == 0, 1.0, 0.82)
    ring = np.column_stack([np.cos(at), np.sin(at)])
    assert teeth * 8 == len(ring)
    return between(outer[:, None] * ring, 0.3 * ring, 0.4)


def bracket():
    arc = np.pi / 2 * np.arange(9) / 8
    fillet = np.column_stack([0.8 - 0.3 * np.sin(arc), 0.8 - 0.3 * np.cos(arc)])
    outline = np.vstack([[[0, 0], [2, 0], [2, 0.5]], fillet, [[0.5, 2], [0, 2]]])
    n = len(outline)
    fan = np.array([[0, i, i + 1] for i in range(1, n - 1)])
    i, k = np.arange(n), (np.arange(n) + 1) % n
    sides = np.vstack([np.column_stack([i, k, n + k]), np.column_stack([i, n + k, n + i])])
    points = np.vstack([np.column_stack([outline, np.full(n, z)]) for z in (0, 1.0)])
    return trimesh.Trimesh(points, np.vstack([sides, fan[:, ::-1], fan + n]))


def walls():
    inner = trimesh.creation.box((1.9, 1.4, 0.9))
    inner.invert()
    return trimesh.util.concatenate([trimesh.creation.box((2, 1.5, 1)), inner])


def asteroid(noise):
    ball = trimesh.creation.icosphere(6)
    random = np.random.default_rng(7)
    ways = random.normal(size=(12, 3))
    height = sum(np.cos(3 * ball.vertices @ way) for way in ways) / 60
    ball.vertices *= (1 + height + noise * random.normal(size=len(height)))[:, None]
    return ball


def of(dataset):
    surface = dataset.extract_surface(algorithm="dataset_surface").triangulate().clean()
    return trimesh.Trimesh(surface.points, surface.faces.reshape(-1, 4)[:, 1:], process=True)


def flipped():
    block, random = drilled(), np.random.default_rng(3)
    faces = block.faces.copy()
    some = random.random(len(faces)) < 0.05
    faces[some] = faces[some][:, ::-1]
    return trimesh.Trimesh(block.vertices, np.vstack([faces, faces[::20]]), process=False)


SHAPES = {
    "Drilled block": drilled,
    "Bracket with a fillet": bracket,
    "Hexagonal nut": nut,
    "Gear": gear,
    "Thin-walled box": walls,
    "Asteroid, 81,920 faces": lambda: asteroid(0.0),
    "Asteroid with noise": lambda: asteroid(0.002),
    "PyVista's nut": lambda: of(examples.load_nut()),
    "PyVista's ant": lambda: of(examples.load_ant()),
    "Block, 5 % flipped and doubled": flipped,
}


def ours(mesh, count):
    with tempfile.TemporaryDirectory() as folder:
        old, new = (str(pathlib.Path(folder) / name) for name in ("old.ply", "new.ply"))
        mesh.export(old)
        command = [PROGRAM, "sample", "--mesh-in", old, "--count", str(count), "--method", "refined"]
        command += ["--mesh", new, "--report", "none", "--json", "--quiet"]
        start = time.perf_counter()
        subprocess.run(command, check=True, capture_output=True, text=True)
        seconds = time.perf_counter() - start
        made = trimesh.load(new, process=True)
        return made.vertices, made.faces, seconds


def timed(remesh):
    def run(mesh, count):
        start = time.perf_counter()
        points, faces = remesh(mesh, count)
        return points, faces, time.perf_counter() - start

    return run


def edge_for(mesh, count):
    """The edge of equilateral triangles with so many vertices: two triangles a vertex."""
    return float(np.sqrt(4 / np.sqrt(3) * mesh.area / (2 * count)))


def acvd(mesh, count):
    clusters = pyacvd.Clustering(pyvista.wrap(mesh))
    while len(clusters.mesh.points) < 10 * count:
        clusters.subdivide(1)
    clusters.cluster(count)
    made = clusters.create_mesh()
    return made.points, made.faces.reshape(-1, 4)[:, 1:]


def meshlab(mesh, count):
    work = pymeshlab.MeshSet()
    work.add_mesh(pymeshlab.Mesh(mesh.vertices, mesh.faces))
    length = pymeshlab.PureValue(edge_for(mesh, count))
    work.meshing_isotropic_explicit_remeshing(targetlen=length, iterations=10)
    made = work.current_mesh()
    return made.vertex_matrix(), made.face_matrix()


def botsch(mesh, count):
    length = edge_for(mesh, count)
    points, faces = mesh.vertices.astype(float), mesh.faces.astype(int)
    return gpytoolbox.remesh_botsch(
        points, faces, 10, length, True, detect_feature_edges=True, feature_dihedral_threshold=30.0
    )[:2]


PROGRAMS = {
    "this program": ours,
    "pyacvd 0.4": timed(acvd),
    "PyMeshLab, isotropic": timed(meshlab),
    "gpytoolbox, Botsch": timed(botsch),
}


STEPS = np.linspace(0, 1, 33)[:, None, None]


def sharp(mesh, angle):
    """The edges whose faces meet at this angle or more, in degrees, as pairs of points."""
    is_sharp = mesh.face_adjacency_angles > np.radians(angle)
    return mesh.vertices[mesh.face_adjacency_edges[is_sharp]]


def along(ends):
    return (ends[:, 0] + STEPS * (ends[:, 1] - ends[:, 0])).reshape(-1, 3)


def off(points, ends):
    """Distances of points from the nearest of these edges, found by points along them."""
    near = cKDTree(along(ends)).query(points, k=8)[1] % len(ends)
    first, way = ends[near, 0], ends[near, 1] - ends[near, 0]
    share = ((points[:, None] - first) * way).sum(axis=2) / (way**2).sum(axis=2)
    feet = first + np.clip(share, 0, 1)[..., None] * way
    return np.linalg.norm(points[:, None] - feet, axis=2).min(axis=1)


def far(old, new):
    """The largest distance of points of each mesh from the other one, and the mean."""
    work = pymeshlab.MeshSet()
    for mesh in (old, new):
        work.add_mesh(pymeshlab.Mesh(mesh.vertices, mesh.faces))
    points = {"samplenum": 100_000, "samplevert": False, "sampleface": True}
    both = [work.get_hausdorff_distance(sampledmesh=k, targetmesh=1 - k, **points) for k in (0, 1)]
    return max(one["max"] for one in both), max(one["mean"] for one in both)


def row(old, points, faces):
    new = trimesh.Trimesh(points, faces, process=False)
    size = np.linalg.norm(np.ptp(old.vertices, axis=0))
    most, mean = (distance / size for distance in far(old, new))
    wanted, found = sharp(old, 30), sharp(new, 20)
    lost = off(along(wanted), found).max() / size if len(wanted) and len(found) else np.nan
    degrees = np.degrees(new.face_angles)
    six = np.mean(np.bincount(np.asarray(new.edges_unique).ravel())[np.unique(new.faces)] == 6)
    return [
        len(np.unique(new.faces)),
        "yes" if new.is_watertight else "no",
        f"{mean:.1e}",
        f"{most:.1e}",
        "" if np.isnan(lost) else f"{lost:.1e}",
        f"{100 * six:.1f} %",
        f"{degrees.min(axis=1).mean():.1f}°",
        f"{degrees.min():.1f}°",
    ]


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 5000
    head = ["", "", "Vertices", "Closed", "Mean", "Largest", "Edges", "Six", "Mean smallest", "Smallest"]
    print("| " + " | ".join([*head, "Seconds"]) + " |")
    print("|---|---|" + "---:|" * 9)
    for shape, make in SHAPES.items():
        mesh = make()
        for program, remesh in PROGRAMS.items():
            try:
                points, faces, seconds = remesh(mesh, count)
                cells = [*row(mesh, points, faces), f"{seconds:.1f}"]
            except Exception as error:  # another program may refuse a mesh
                cells = [f"refused: {type(error).__name__}", *[""] * 8]
            print("| " + " | ".join(map(str, [shape, program, *cells])) + " |", flush=True)
            shape = ""


main()
