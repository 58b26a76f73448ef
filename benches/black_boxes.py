"""Judges the meshes of black boxes by their functions.

cargo bench -p benches --bench black_boxes --profile dev -- target/black-boxes
python benches/black_boxes.py target/black-boxes
"""

import pathlib
import sys

import numpy as np

SIDE = 180


def read(path):
    """The corners of a mesh, each once, and its triangles."""
    rows = [line.split() for line in path.read_text().splitlines()]
    corners = np.array([row[1:4] for row in rows if row[:1] == ["v"]], float)
    faces = np.array([[c.split("/")[0] for c in row[1:4]] for row in rows if row[:1] == ["f"]], int)
    # A particle on a crease is one corner for each of its normals.
    corners, place = np.unique(corners, axis=0, return_inverse=True)
    return corners, place.reshape(-1)[faces - 1]


def euler_of_cells(inside):
    """The Euler number of the surface of the union of cubes around the nodes that are inside."""
    a = np.pad(inside.reshape(SIDE, SIDE, SIDE), 1).astype(bool)
    number = -int(a.sum())
    for axes in [(0,), (1,), (2,), (0, 1), (0, 2), (1, 2), (0, 1, 2)]:
        # Faces, edges and corners of the cubes: those of any cube beside them.
        b = a
        for axis in axes:
            b = b | np.roll(b, 1, axis)
        number += (-1) ** (3 - len(axes)) * int(b.sum())
    return 2 * number


wrong, paths = 0, sorted(pathlib.Path(sys.argv[1]).glob("*.obj"))
for path in paths:
    corners, faces = read(path)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    size = len(corners)
    there, back = edges[:, 0] * size + edges[:, 1], edges[:, 1] * size + edges[:, 0]
    # Each edge once in each direction.
    open_edges = len(np.setxor1d(there, back)) + len(there) - len(np.unique(there))
    euler = len(np.unique(faces)) - len(np.unique(np.minimum(there, back))) + len(faces)
    a, b, c = (corners[faces[:, k]] for k in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    exact = float(path.with_suffix(".volume").read_text())
    of_cells = euler_of_cells(np.frombuffer(path.with_suffix(".nodes").read_bytes(), np.uint8))
    faults = []
    if open_edges:
        faults.append(f"{open_edges} open edges")
    if euler != of_cells:
        faults.append(f"Euler number {euler}, of the function {of_cells}")
    if abs(volume / exact - 1) > 3e-3:
        faults.append(f"volume {volume:.4f}, of the function {exact:.4f} ({100 * (volume / exact - 1):+.2f} %)")
    wrong += bool(faults)
    print(f"{path.stem}: {'; '.join(faults) or 'right'}")
print(f"{len(paths) - wrong} of {len(paths)} are right")
sys.exit(wrong > 0 or not paths)
