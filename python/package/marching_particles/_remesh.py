"""Triangle meshes, sampled anew with their edges."""

import json
import os
from functools import partial

import numpy as np

from . import _core
from ._fields import Field, numbers
from ._sample import sample


class TriangleMesh(Field):
    """The surface of a triangle mesh, for :func:`sample`, :func:`difference` and the like.

    A closed mesh with sharp edges keeps them: f is made of a smooth function for each patch between
    edges. Of a scan, a smooth shape or a mesh with holes f is the distance on a grid, smoothed a
    little; holes are closed. The surface of an open mesh, such as a leaf, a terrain or half a
    sphere, ends at its border. Before that, vertices at the same place are merged, faces without
    area and doubled ones dropped, and faces turned to agree.

    Args:
        mesh: The path of a file, STL, OBJ, PLY, OFF, GLB or 3MF; a mesh of trimesh or PyVista; or a pair
            ``(vertices, faces)`` of arrays (n, 3) and (m, 3), in any unit of length, with faces
            counter-clockwise seen from outside.
        edges: ``"auto"``; the angle between faces from which on an edge stays sharp, in degrees, 1
            to 180; or None, to round all edges.
        borders: Whether the surface ends at the borders of the mesh, or holes are closed. By default
            it ends there if the mesh is an open surface; a solid has its holes closed.
        smooth: Width of a Gaussian in cells of the grid of a scan, 0 to 10: the mesh is taken for
            one if it is given. By default it is chosen by the noise.
        lines: Lines along which edges are kept whatever their angle: arrays (k, 3) of k points
            each. For pairs of vertices give ``vertices[pairs]``, of the shape (n, 2, 3).

    Attributes:
        bounds: The box of the surface, ``((x0, y0, z0), (x1, y1, z1))``.
        kind: ``"part"``, with edges, or ``"scan"``.
        repairs: Sentences on what was mended.
        border_edges: Number of edges with one face, at borders.
        border_loops: Number of closed curves that the borders consist of.
        notes: Sentences on what of a file was left out.

    Raises:
        TypeError: If the mesh is none of these.
        ValueError: If it has no area, is folded flat, or its edges or borders cannot be kept.
        OSError: If the file cannot be read.
    """

    def __init__(self, mesh, *, edges="auto", borders=None, smooth=None, lines=()):
        if edges is None:
            edges = "none"
        elif edges != "auto":
            edges = repr(float(numbers("edges", edges, (), '"auto", an angle or None')))
        if borders not in (None, True, False):
            raise TypeError(f"borders must be True, False or None, and not {borders!r}")
        smooth = None if smooth is None else float(numbers("smooth", smooth, (), "a number"))
        segments = [np.empty((0, 6))]
        for line in lines:
            line = numbers("lines", line, (None, 3), "arrays of points, of the shape (k, 3)")
            segments.append(np.hstack([line[:-1], line[1:]]))
        choice = (np.ascontiguousarray(np.vstack(segments)), edges, borders, smooth)
        if isinstance(mesh, (str, os.PathLike)):
            path = os.fspath(mesh)
            with open(path, "rb") as file:
                content = file.read()
            self._take("mesh_file", os.path.basename(path), content, *choice)
        else:
            arrays = map(np.array, _arrays(mesh))
            self._take("mesh", *arrays, _colours(mesh), *choice)

    def _take(self, name, *given):
        field, self._mesh, known = getattr(_core.Field, name)(*given)
        super().__init__(field, partial(_taken, name, *given))
        known = json.loads(known)
        self.kind = known["kind"]
        self.repairs = known["repairs"]
        self.border_edges = known["border_edges"]
        self.border_loops = known["border_loops"]
        self.notes = known["notes"]

    def __repr__(self):
        return f"<TriangleMesh, a {self.kind}>"

    def compare(self, mesh):
        """How far another mesh is from this one, as it was mended.

        Args:
            mesh: A :class:`Mesh` of a sample, or what :class:`TriangleMesh` takes but a path.

        Returns:
            A dict: ``to_new`` and ``to_old``, the distances of points of this mesh from the other
            one and back, each with ``mean``, ``most`` (99 % are below) and ``largest``;
            ``volume`` and ``area`` of both; ``edges``, the largest distance of the sharp edges
            from the other mesh, or None; and ``diagonal``, that of the box of this mesh. Lengths
            are in its units.
        """
        points, faces = _arrays(mesh)
        return json.loads(self._mesh.compare(points, faces.astype(np.int32)))


def _taken(name, *given):
    mesh = TriangleMesh.__new__(TriangleMesh)
    mesh._take(name, *given)
    return mesh


def remesh(mesh, *, edges="auto", borders=None, smooth=None, lines=(), **options):
    """Samples the surface of a triangle mesh anew, with even triangles.

    >>> import numpy as np
    >>> import marching_particles as mp
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> sample = mp.remesh((corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]), count=1000)
    >>> sample.report["creases"], bool(sample.change["to_new"]["largest"] < 1e-6)
    (6, True)

    Args:
        mesh: What :class:`TriangleMesh` takes, or one of these.
        edges: See :class:`TriangleMesh`.
        borders: See :class:`TriangleMesh`.
        smooth: See :class:`TriangleMesh`.
        lines: See :class:`TriangleMesh`.
        options: The arguments of :func:`sample`, such as ``count``, ``spacing`` or ``adaptive``.
            ``method="refined"`` makes the triangles more even.

    Returns:
        A :class:`Sample`, whose :meth:`Sample.mesh` is the new mesh, and whose ``change`` says how
        far it is from the old one: see :meth:`TriangleMesh.compare`. If the old mesh has colours at
        its vertices, ``red``, ``green`` and ``blue`` are among the values, from 0 to 1.

    Raises:
        The errors of :class:`TriangleMesh` and of :func:`sample`.
    """
    if not isinstance(mesh, TriangleMesh):
        mesh = TriangleMesh(mesh, edges=edges, borders=borders, smooth=smooth, lines=lines)
    elif edges != "auto" or borders is not None or smooth is not None or len(lines):
        raise TypeError("edges, borders, smooth and lines belong to TriangleMesh: give them to it")
    result = sample(mesh, **options)
    result.change = mesh.compare(result.mesh())
    return result


def _colours(mesh):
    """The colours of the vertices of a mesh of trimesh or PyVista, from 0 to 1; None if it has none."""
    colours = None
    if getattr(getattr(mesh, "visual", None), "kind", None) == "vertex":  # trimesh
        colours = mesh.visual.vertex_colors
    elif hasattr(mesh, "point_data"):  # PyVista, as it names those of a file
        colours = next((mesh.point_data[name] for name in ("RGB", "RGBA") if name in mesh.point_data), None)
    if colours is None:
        return None
    colours = np.asarray(colours)
    most = 255 if colours.dtype.kind in "iu" else 1
    return np.ascontiguousarray(colours[:, :3] / most, dtype=np.float32)


def _arrays(mesh):
    """The vertices and the faces of a mesh."""
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):  # trimesh
        vertices, faces = mesh.vertices, mesh.faces
    elif hasattr(mesh, "points") and hasattr(mesh, "faces"):
        vertices, faces = mesh.points, mesh.faces
        if hasattr(mesh, "triangulate"):  # PyVista, whose faces begin with their number of corners
            mesh = mesh.triangulate()
            vertices, faces = mesh.points, np.reshape(mesh.faces, (-1, 4))[:, 1:]
    elif isinstance(mesh, (tuple, list)) and len(mesh) == 2:
        vertices, faces = mesh
    else:
        raise TypeError(
            "mesh must be a path, a mesh of trimesh or PyVista or a pair (vertices, faces), and not "
            f"{type(mesh).__name__}"
        )
    vertices = numbers("vertices", vertices, (None, 3), "an array of n points, of the shape (n, 3)")
    faces = np.asarray(faces)
    if faces.ndim != 2 or faces.shape[1] != 3 or faces.dtype.kind not in "iu":
        raise ValueError(
            "faces must be an array of whole numbers of the shape (m, 3), and not of the type "
            f"{faces.dtype} and the shape {faces.shape}"
        )
    if faces.size and not 0 <= faces.min() <= faces.max() < len(vertices):
        raise ValueError(f"faces has indices beyond the {len(vertices)} vertices")
    return vertices, np.ascontiguousarray(faces, dtype=np.uint32)
