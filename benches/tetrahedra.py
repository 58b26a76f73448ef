"""Fills every OBJ mesh of a folder with tetrahedra by TetGen and compares the volumes.

pip install tetgen
cargo bench -p benches --bench solids --profile dev -- target/solids > docs/tables/solids.md
python benches/tetrahedra.py target/solids
"""

import pathlib
import sys

import numpy as np
import tetgen


def read(path):
    """The corners of a mesh, each once, and its triangles."""
    rows = [line.split() for line in path.read_text().splitlines()]
    corners = np.array([row[1:4] for row in rows if row[:1] == ["v"]], float)
    faces = np.array([[c.split("/")[0] for c in row[1:4]] for row in rows if row[:1] == ["f"]], int)
    # A particle on a crease is one corner for each of its normals.
    corners, place = np.unique(corners, axis=0, return_inverse=True)
    return corners, place.reshape(-1)[faces - 1].astype(np.int32)


def volume(a, b, c, d):
    return np.abs(np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a))).sum() / 6


failed = 0
paths = sorted(pathlib.Path(sys.argv[1]).glob("*.obj"))
for path in paths:
    corners, faces = read(path)
    a, b, c = (corners[faces[:, k]] for k in range(3))
    enclosed = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    try:
        nodes, cells, *_ = tetgen.TetGen(corners, faces).tetrahedralize(quality=False, nobisect=True, quiet=True)
        off = volume(*(nodes[cells[:, k]] for k in range(4))) / enclosed - 1
        verdict = None if abs(off) < 1e-6 else f"the volume is off by {off:.1e}"
    except RuntimeError as error:
        verdict = str(error)
    if verdict:
        failed += 1
        print(f"{path.name}: {verdict}")
print(f"{len(paths) - failed} of {len(paths)} meshes are filled")
sys.exit(failed > 0 or not paths)
