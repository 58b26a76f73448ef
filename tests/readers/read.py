"""Reads the files of the command line with the programs that people read them with, and checks what arrives.

Usage: python read.py TOOL FOLDER

TOOL is the command line, which writes the files of CASES into FOLDER. Each reader then opens them in a process of its own, because one
that ends with a crash must not take the others along. It must find as many vertices as the tool says, a mesh that is closed where the
surface is, its Euler number, and a positive volume. A table of readers and formats is printed; any fault ends with exit code 1.
"""

import json
import subprocess
import sys
from pathlib import Path

# Name, arguments, and what the mesh is: its Euler number and its volume, None where it is open.
CASES = [
    ("ball", ["--formula", "x^2 + y^2 + z^2 = 1"], 2, 4.1888),
    ("cube", ["--formula", "max(abs(x), abs(y), abs(z)) - 1"], 2, 8.0),
    ("drilled", ["--formula", "max(abs(x) - 1, abs(y) - 1, abs(z) - 0.5, 0.36 - x^2 - y^2)"], 0, 2.8690),
    ("cylinder", ["--formula", "max(x^2 + y^2 - 1, abs(z) - 1)"], 2, 6.2832),
    ("two-boxes", ["--formula", "min(max(abs(x), abs(y), abs(z)) - 1, max(abs(x - 3), abs(y), abs(z)) - 0.5)"], 4, 9.0),
    ("density", ["--formula", "1 - x^2 - y^2 - z^2"], 2, 4.1888),
    ("hollow", ["--formula", "max(x^2 + y^2 + z^2 - 1, 0.25 - x^2 - y^2 - z^2)"], 4, 3.6652),
    ("hollow-density", ["--formula", "min(1 - x^2 - y^2 - z^2, x^2 + y^2 + z^2 - 0.25)"], 4, 3.6652),
    ("density-cube", ["--formula", "1 - max(abs(x), abs(y), abs(z))"], 2, 8.0),
    ("pole", ["--formula", "(x^2+y^2+z^2-1)*((x-5)^2+y^2+z^2-1)/(x-2.5)"], 4, 8.3776),
    ("far", ["--formula", "(x-5000)^2 + (y+2000)^2 + z^2 = 1", "--box", "4998.5,-2001.5,-1.5,5001.5,-1998.5,1.5"], 2, 4.1888),
    ("cell", ["--surface", "gyroid", "--closed", "--periodic"], None, 124.025),
    ("cut", ["--formula", "sin(x)cos(y) + sin(y)cos(z) + sin(z)cos(x)", "--box", "3"], None, None),
    ("open-density", ["--formula", "1 - x^2 - y^2 - z^2", "--box", "-2,-2,-2,2,2,0.5"], 1, None),
]
COUNT = "2000"
# Faults that are printed.
MOST_FAULTS = 60
# Begins the lines that a reader's process writes for this one.
MARK = "read: "

MESHES = ["ply", "obj", "stl", "glb", "3mf"]
# Files by their endings, with the options of the run that writes them.
WAYS = {
    "": MESHES,
    "-split": ["ply", "obj", "glb"],
    "-columns": ["ply"],
}

# Endings that a reader opens. It need not know the others.
READERS = {
    "pymeshlab": ["ply", "obj", "stl", "-columns.ply", "-split.ply", "-split.obj", "points.ply"],
    "trimesh": ["ply", "obj", "stl", "glb", "3mf", "-columns.ply", "-split.ply", "-split.obj", "-split.glb", "points.ply"],
    "open3d": ["ply", "obj", "stl", "glb", "-columns.ply", "-split.ply", "-split.obj", "points.ply", "points.xyz"],
    "libigl": ["ply", "obj", "stl", "-split.ply", "-split.obj"],
    "meshio": ["ply", "obj", "stl", "-columns.ply", "-split.ply", "points.ply"],
    "pygltflib": ["glb", "-split.glb"],
    "pandas": ["points.csv"],
    "numpy": ["points.xyz", "points.npy"],
}


def make(tool, folder):
    """Writes the files of every case, and returns what the tool says of each."""
    told = {}
    for name, arguments, euler, volume in CASES:
        for way, endings in WAYS.items():
            files = [argument for ending in endings for argument in ("--mesh", str(folder / f"{name}{way}.{ending}"))]
            if way:
                files += ["--vertices", way[1:]]
            else:
                files += [a for ending in ("ply", "csv", "xyz", "npy") for a in ("--out", str(folder / f"{name}.points.{ending}"))]
            command = [tool, "sample", *arguments, "--count", COUNT, "--json", *files]
            run = subprocess.run(command, capture_output=True, text=True)
            if run.returncode != 0:
                raise SystemExit(f"{command}\n{run.stderr}")
            told[name] = json.loads(run.stdout)
        mesh = told[name]["mesh"]
        fault = None
        if euler is not None and mesh["euler"] != euler:
            fault = f"Euler number {mesh['euler']} instead of {euler}"
        elif (mesh["volume"] is None) != (volume is None):
            fault = f"volume {mesh['volume']} instead of {volume}"
        elif volume is not None and abs(mesh["volume"] / volume - 1) > 0.02:
            fault = f"volume {mesh['volume']} instead of {volume}"
        if fault:
            raise SystemExit(f"{name}: {fault}")
    return told


def main(tool, folder):
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.iterdir():
        old.unlink()
    told = make(tool, folder)
    (folder / "told.json").write_text(json.dumps({name: summary(run) for name, run in told.items()}))
    table, faults = {}, []
    for reader, endings in READERS.items():
        for ending in endings:
            names = [f"{name}{ending}" if ending[0] == "-" else f"{name}.{ending}" for name, *_ in CASES]
            faulty = read_all(reader, folder, names)
            table[reader, ending] = "ok" if not faulty else f"{len(faulty)} of {len(names)}"
            faults += [f"{reader}, {name}: {fault}" for name, fault in faulty]
    endings = [e for e in dict.fromkeys(e for all_of in READERS.values() for e in all_of)]
    width = max(len(e) for e in endings) + 2
    print(" " * 11 + "".join(e.rjust(width) for e in endings))
    for reader in READERS:
        print(reader.ljust(11) + "".join(table.get((reader, e), "-").rjust(width) for e in endings))
    print("\n".join(faults[:MOST_FAULTS]))
    print(f"{len(CASES)} surfaces; {len(faults)} faults")
    return 1 if faults else 0


def summary(run):
    """What a reader is held to."""
    mesh = run["mesh"]
    keys = ("triangles", "euler", "volume", "borders", "holes", "left_out")
    return {"count": run["count"], "creases": run["creases"] or 0, **{key: mesh[key] for key in keys}}


def read_all(reader, folder, names):
    """Reads files in a process of its own, which begins again after one that it crashes on. Returns the faults."""
    faults, rest = [], list(names)
    while rest:
        command = [sys.executable, __file__, "--read", reader, str(folder), *rest]
        run = subprocess.run(command, capture_output=True, text=True, cwd=folder)
        lines = [line.removeprefix(MARK) for line in run.stdout.split("\n") if line.startswith(MARK)]
        done = [json.loads(line) for line in lines]
        faults += [(name, fault) for name, fault in done if fault]
        rest = rest[len(done):]
        if rest:
            said = run.stderr.strip().splitlines()
            faults.append((rest.pop(0), f"crashed ({run.returncode}): {said[-1] if said else ''}"))
    return faults


# What follows runs in the process of a reader.


def read(reader, folder, names):
    told = json.loads((folder / "told.json").read_text())
    open_file = globals()[f"open_{reader}"]
    for name in names:
        case = told[name.split(".")[0].removesuffix("-split").removesuffix("-columns")]
        try:
            fault = check(name, case, open_file(str(folder / name)))
        except (Exception, SystemExit) as error:  # Whatever a reader raises is a fault of the file.
            fault = f"{type(error).__name__}: {error}"
        print(MARK + json.dumps([name, fault]), flush=True)


def check(name, case, found):
    """Says what is wrong with what a reader has found in a file: a table of points, or points, triangles and its own verdict."""
    import numpy

    if ".points." in name:
        table = numpy.asarray(found)
        # A particle on an edge has a row for each side.
        rows = len(table)
        if rows < case["count"] or (rows > case["count"] and case["creases"] == 0):
            return f"{rows} rows of {case['count']} particles"
        return None if numpy.isfinite(table[:, :3].astype(float)).all() else "coordinates that are no numbers"
    points, triangles, is_closed = found
    points, triangles = numpy.asarray(points, float), numpy.asarray(triangles).astype(int)
    if len(triangles) != case["triangles"]:
        return f"{len(triangles)} triangles instead of {case['triangles']}"
    is_split = "-split" in name or "-columns" in name
    if name.endswith(".stl") or is_split:
        # STL has no vertices of its own, and whoever asks for split ones joins them by their places.
        points, index = numpy.unique(points, axis=0, return_inverse=True)
        triangles = index.reshape(-1)[triangles]
        is_closed = None
    vertices = len(numpy.unique(triangles))
    if not is_split and not name.endswith(".stl") and len(points) != vertices:
        return f"{len(points)} vertices, of which {vertices} are in triangles"
    if vertices != case["count"] - case["left_out"]:
        return f"{vertices} vertices of {case['count']} particles"
    edges = numpy.sort(numpy.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    edges, uses = numpy.unique(edges, axis=0, return_counts=True)
    euler = vertices - len(edges) + len(triangles)
    if euler != case["euler"]:
        return f"Euler number {euler} instead of {case['euler']}"
    should_be_closed = case["volume"] is not None
    if (uses == 2).all() != should_be_closed:
        return f"{(uses != 2).sum()} edges without two triangles"
    if is_closed is not None and bool(is_closed) != should_be_closed:
        return f"the reader finds it {'closed' if is_closed else 'open'}"
    if should_be_closed:
        corners = (points - points.mean(axis=0))[triangles]
        volume = numpy.einsum("ij,ij->i", corners[:, 0], numpy.cross(corners[:, 1], corners[:, 2])).sum() / 6
        if abs(volume / case["volume"] - 1) > 1e-3:
            return f"volume {volume} instead of {case['volume']}"
    return None


def open_pymeshlab(path):
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(path)
    mesh = meshes.current_mesh()
    if ".points." in path:
        return mesh.vertex_matrix()
    points, triangles = mesh.vertex_matrix(), mesh.face_matrix()
    measures = meshes.get_topological_measures()
    is_closed = measures["boundary_edges"] == 0 and measures["is_mesh_two_manifold"]
    return points, triangles, is_closed


def open_trimesh(path):
    import trimesh

    if ".points." in path:
        return trimesh.load(path).vertices
    # As it is in the file: nothing is joined but what STL leaves open.
    mesh = trimesh.load(path, force="mesh", process=path.endswith(".stl"))
    return mesh.vertices, mesh.faces, mesh.is_watertight


def open_open3d(path):
    import numpy
    import open3d

    open3d.utility.set_verbosity_level(open3d.utility.VerbosityLevel.Error)
    if ".points." in path:
        cloud = open3d.io.read_point_cloud(path)
        return numpy.asarray(cloud.points)
    mesh = open3d.io.read_triangle_mesh(path)
    return numpy.asarray(mesh.vertices), numpy.asarray(mesh.triangles), mesh.is_watertight()


def open_libigl(path):
    import igl

    points, triangles = igl.read_triangle_mesh(path)
    return points, triangles, None


def open_meshio(path):
    import meshio

    mesh = meshio.read(path)
    if ".points." in path:
        return mesh.points
    return mesh.points, mesh.cells_dict["triangle"], None


def open_pygltflib(path):
    import numpy
    import pygltflib

    scene = pygltflib.GLTF2().load(path)
    blob = scene.binary_blob()
    (primitive,) = scene.meshes[0].primitives

    def column(accessor, kind, width):
        accessor = scene.accessors[accessor]
        view = scene.bufferViews[accessor.bufferView]
        return numpy.frombuffer(blob, kind, accessor.count * width, view.byteOffset).reshape(-1, width)

    normals = column(primitive.attributes.NORMAL, "<f4", 3)
    points = column(primitive.attributes.POSITION, "<f4", 3)
    triangles = column(primitive.indices, "<u4", 1).reshape(-1, 3)
    assert numpy.allclose(numpy.linalg.norm(normals, axis=1), 1, atol=1e-4), "normals that are no unit vectors"
    # Normals are on the side to which the triangles face.
    a, b, c = points[triangles[:, 0]], points[triangles[:, 1]], points[triangles[:, 2]]
    facing = numpy.einsum("ij,ij->i", numpy.cross(b - a, c - a), normals[triangles].sum(axis=1))
    assert (facing > 0).all(), f"{(facing <= 0).sum()} triangles face against their normals"
    return points, triangles, None


def open_pandas(path):
    import pandas

    table = pandas.read_csv(path)
    assert list(table.columns[:6]) == ["x", "y", "z", "nx", "ny", "nz"], list(table.columns)
    assert all(kind.kind in "fiu" for kind in table.dtypes), table.dtypes
    return table.to_numpy()


def open_numpy(path):
    import numpy

    return numpy.load(path) if path.endswith(".npy") else numpy.loadtxt(path)


if __name__ == "__main__":
    if sys.argv[1] == "--read":
        read(sys.argv[2], Path(sys.argv[3]), sys.argv[4:])
    else:
        sys.exit(main(sys.argv[1], Path(sys.argv[2]).resolve()))
