"""What can be sampled: formulas, functions, surfaces through points, and solids of any two."""

from __future__ import annotations

import inspect
import json
import os
from collections.abc import Mapping
from functools import partial

import numpy as np

from . import _core
from ._errors import FieldError


def numbers(name, value, shape, what):
    """``value`` as a contiguous float64 array of a shape, in which None stands for any length."""
    try:
        array = np.asarray(value)
    except ValueError as error:  # Rows of different lengths.
        raise ValueError(f"{name} must be {what}: {error}") from None
    if array.dtype.kind not in "biuf":
        raise TypeError(f"{name} must be {what}, and not of the type {array.dtype}")
    fits = array.ndim == len(shape) and all(n in (None, m) for n, m in zip(shape, array.shape))
    if not fits:
        raise ValueError(f"{name} must be {what}, and not of the shape {array.shape}")
    array = np.asarray(array, dtype=np.float64, order="C")
    bad = np.argwhere(~np.isfinite(array))
    if len(bad):
        place = "".join(f"[{i}]" for i in bad[0])
        raise ValueError(f"{name}{place} is {array[tuple(bad[0])]}: {name} must be finite")
    return array


def corners(lowest, highest):
    """The corners of a box as tuples."""
    return tuple(lowest), tuple(highest)


class Field:
    """A field that can be sampled, or combined with another one: from :func:`field`,
    :func:`union` and the like.

    It does not change, so that copies are the field itself. It is pickled as what it was made of,
    and made anew from it: its functions must be such as can be pickled, which those are that a
    module defines by ``def``.

    Attributes:
        bounds: The box of its surface, ``((x0, y0, z0), (x1, y1, z1))``, where that is known; else
            None.
    """

    def __init__(self, field, made):
        self._field = field
        # What makes the field again.
        self._made = made
        self.bounds = None if field.bounds is None else corners(*field.bounds)

    def __reduce__(self):
        return self._made, ()

    def __copy__(self):
        return self

    def __deepcopy__(self, memo):
        return self


class Model(Field):
    """A surface through points, from :func:`fit_points`.

    Attributes:
        bounds: The box of the points with a margin, ``((x0, y0, z0), (x1, y1, z1))``.
        report: Numbers of points and centres, residuals as shares of the diagonal of the box,
            and where the normals came from.
        warnings: Sentences on what was done to the points, or may be wrong with them.
    """

    def __init__(self, field, report, made):
        super().__init__(field, made)
        self.report = report
        self.warnings = report["warnings"]

    def __repr__(self):
        return f"<Model of {self.report['points']:,} points>"


def fit_points(points, normals=None, *, centres=200, beyond_points="cut"):
    """Fits a surface to points.

    A sum of radial functions about some of the points is fitted to all of them; noise is smoothed
    as cross-validation tells.

    Args:
        points: Array (n, 3), in any unit of length; or a mesh of trimesh or PyVista, or the path of
            a file of points or of a mesh: PLY, OBJ, STL, OFF, GLB, 3MF, PCD, XYZ, PTS or CSV. A
            mesh gives its vertices and normals.
        normals: Array (n, 3) of outward normals of any length; without it they are estimated.
        centres: Number of radial functions, 100 to 800. The time grows with its cube.
        beyond_points: ``"cut"``: the surface ends at the border of the points, and bridges gaps of
            a few of their spacings; ``"kept"``: it continues beyond them. As an operand of
            :func:`union` and the like it always continues.

    Returns:
        A :class:`Model`, to be given to :func:`sample`.

    Raises:
        ValueError: If the arrays have another shape, or no surface can be fitted to the points.
        OSError: If the file cannot be read.
    """
    if beyond_points not in ("cut", "kept"):
        raise ValueError(f'beyond_points is "cut" or "kept", and not {beyond_points!r}')
    centres, is_cut = integer("centres", centres, *_core.CENTRES), beyond_points == "cut"
    if isinstance(points, (str, os.PathLike)):
        if normals is not None:
            raise TypeError("normals belong to an array of points: a file has its own")
        path = os.fspath(points)
        with open(path, "rb") as file:
            content = file.read()
        return _fitted("file", os.path.basename(path), content, centres, is_cut)
    if not isinstance(points, np.ndarray):
        points, normals = _of_mesh(points, normals)
    points = numbers("points", points, (None, 3), "an array of n points, of the shape (n, 3)")
    if normals is not None:
        what = "an array of a normal for each point, of the shape of points"
        normals = numbers("normals", normals, points.shape, what)
    return _fitted("points", points, normals, centres, is_cut)


def _fitted(name, *given):
    field, report = getattr(_core.Field, name)(*given)
    # The arrays are the caller's, who may change them.
    kept = [value.copy() if isinstance(value, np.ndarray) else value for value in given]
    return Model(field, json.loads(report), partial(_fitted, name, *kept))


def _of_mesh(mesh, normals):
    """The vertices of a mesh of trimesh or PyVista, and their normals; else what is given."""
    if hasattr(mesh, "vertices") and hasattr(mesh, "vertex_normals"):
        return np.asarray(mesh.vertices), np.asarray(mesh.vertex_normals) if normals is None else normals
    if hasattr(mesh, "points") and hasattr(mesh, "point_normals"):
        has_faces = getattr(mesh, "n_cells", 0) > getattr(mesh, "n_verts", 0)
        if normals is None and has_faces:
            normals = np.asarray(mesh.point_normals)
        return np.asarray(mesh.points), normals
    return mesh, normals


def integer(name, value, least, most):
    """``value`` as an int of a range."""
    try:
        number = value.__index__()
    except AttributeError:
        raise TypeError(f"{name} must be a whole number, and not {value!r}") from None
    if not least <= number <= most:
        raise ValueError(f"{name} is {number:,}, but must lie between {least:,} and {most:,}")
    return number


def _checked(function, argument, tail):
    """The function, with its result as a float64 array of the right shape."""

    def call(points):
        count = len(points)
        result = function(points)
        array = np.asarray(result)
        wanted = (count, *tail)
        if array.dtype.kind not in "biuf":
            raise FieldError(
                f"{argument} returned {type(result).__name__} of the type {array.dtype}: "
                f"it must return an array of numbers, of the shape {wanted}"
            )
        if array.shape != wanted:
            hint = " (p[:, 0] is x of all points p, p[0] is the first of them)"
            raise FieldError(
                f"{argument} returned an array of the shape {array.shape} for {count} points: "
                f"it must be {wanted}{hint if array.shape in ((), (3,)) else ''}"
            )
        return np.asarray(array, dtype=np.float64, order="C")

    return call


def field_of(field, params=None, gradient=None, name="field"):
    """The core's field of what a function of the package was given by this name."""
    if gradient is not None and not callable(gradient):
        raise TypeError(f"gradient must be a function, and not {type(gradient).__name__}")
    if isinstance(field, str):
        if gradient is not None:
            raise TypeError("gradient belongs to a function: a formula has its own")
        if os.path.isfile(field):
            raise ValueError(f"{field} is a file: give it to fit_points, Image or remesh")
        return _core.Field.formula(field, _parameters(params))
    if params is not None:
        raise TypeError("params belongs to a formula: give a function its values by a closure")
    if isinstance(field, Field):
        if gradient is not None:
            raise TypeError("gradient belongs to a function: give it to field()")
        return field._field
    if callable(field):
        _check_parameters(field, name)
        slope = None if gradient is None else _checked(gradient, "gradient", (3,))
        return _core.Field.function(_checked(field, name, ()), slope)
    if isinstance(field, np.ndarray):
        maker = "Image makes a field of voxels" if field.ndim == 3 else "fit_points makes a field of points"
        hint = f": {maker}"
    else:
        hint = ": remesh samples a mesh" if hasattr(field, "faces") else ""
    raise TypeError(
        f"{name} must be a formula (str), a function, a Model or another Field, and not "
        f"{type(field).__name__}{hint}"
    )


def _check_parameters(function, name):
    """Refuses a function of three numbers."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):  # Some functions of C have none.
        return
    positional = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    needed = [p for p in parameters if p.kind in positional and p.default is p.empty]
    if len(needed) > 1:
        names = ", ".join(p.name for p in needed)
        raise TypeError(
            f"{name} is a function of ({names}): it must be one of an array p (n, 3) of points, "
            "with p[:, 0] in place of x"
        )


def _parameters(params):
    if params is None:
        return []
    if not isinstance(params, Mapping):
        raise TypeError(f"params must be a dict of names and numbers, and not {params!r}")
    return [
        (name, float(numbers(f"params[{name!r}]", value, (), "a number")))
        for name, value in params.items()
    ]


def field(field, *, params=None, gradient=None):
    """A field with its parameters or its gradient, to be combined with another one.

    Args:
        field: A formula, the name of a surface of the gallery, a function or a :class:`Model`, as
            :func:`sample` takes it.
        params: Values of the parameters of a formula, by name; others are 1, or those of the
            surface of the gallery.
        gradient: The gradient of a function, as :func:`sample` takes it.

    Returns:
        A :class:`Field`.
    """
    return _field(field, dict(params) if isinstance(params, Mapping) else params, gradient)


def _field(given, params, gradient):
    return Field(field_of(given, params, gradient), partial(_field, given, params, gradient))


def piecewise(label, pieces):
    """A field put together of smooth functions, its pieces, by one that tells which of them gives
    f where.

    The surface has an edge where it passes from one piece to another: particles lie on it, and the
    mesh is closed along it, to the digits of the numbers. A piece is called also a few particles
    beyond its part, and should be smooth there, too. Where the values of two pieces differ at their
    border, the surface ends. Of a function by itself the edges are found in its values, which takes
    more calls and misses what is small.

    Args:
        label: A function that takes an array of points (n, 3), and returns an array (n,) of whole
            numbers: the index of the piece at each point.
        pieces: A list of functions that take an array of points, and return an array (n,) of
            values.

    Returns:
        A :class:`Field`.

    Raises:
        TypeError: If an argument is of a wrong type.
        FieldError: While sampling, if a label is not the index of a piece.

    Example:
        >>> import numpy as np, marching_particles as mp
        >>> pieces = [lambda p: np.linalg.norm(p, axis=1) - 1, lambda p: p[:, 2] - 0.5]
        >>> cut_ball = mp.piecewise(lambda p: pieces[1](p) > pieces[0](p), pieces)
        >>> mp.sample(cut_ball, count=2_000).report["creases"]
        1
    """
    if not callable(label):
        raise TypeError(f"label must be a function, and not {type(label).__name__}")
    _check_parameters(label, "label")
    pieces = list(pieces)
    if not pieces:
        raise ValueError("pieces is empty: give a list of functions")
    for k, piece in enumerate(pieces):
        if not callable(piece):
            raise TypeError(f"pieces[{k}] must be a function, and not {type(piece).__name__}")
        _check_parameters(piece, f"pieces[{k}]")
    values = _checked(label, "label", ())

    def labels(points):
        found = values(points)
        bad = np.flatnonzero(~np.isin(found, np.arange(len(pieces))))
        if len(bad):
            place, value = ", ".join(f"{x:.6g}" for x in points[bad[0]]), found[bad[0]]
            raise FieldError(
                f"label returned {value:g} at ({place}): it must return the index of a piece, from "
                f"0 to {len(pieces) - 1}"
            )
        return found.astype(np.int64)

    functions = [_checked(piece, f"pieces[{k}]", ()) for k, piece in enumerate(pieces)]
    return Field(_core.Field.piecewise(labels, functions), partial(piecewise, label, pieces))


def union(*solids):
    """The union of solids: min(a, b, ...), which is negative where one of them is.

    Where the surfaces meet at an angle, particles lie on the edge and the mesh is closed along it.
    Edges are looked for in cells of a 128th of the box: a smaller loop may be missed, and there is
    no proof that every component was found. Of two formulas write one with ``min``, ``max`` and
    ``-``, which has both.

    Args:
        solids: Two or more, or a list of them: formulas, functions, a :class:`Model` or another
            :class:`Field`. Each should have a gradient where it is zero, as a distance has.

    Returns:
        A :class:`Field`, whose box is known where those of all are.

    Raises:
        FormulaError: If a formula cannot be read.
        TypeError: If an argument is of a wrong type.
    """
    return _joined("union", solids)


def intersection(*solids):
    """The intersection of solids: max(a, b, ...), which is negative where all are.

    See :func:`union`. Its box is that of the first one that has one.
    """
    return _joined("intersection", solids)


def _joined(name, solids):
    if len(solids) == 1 and isinstance(solids[0], (list, tuple)):
        solids = solids[0]
    if len(solids) < 2:
        raise TypeError(f"{name} takes two solids or more, and not {len(solids)}")
    fields = [field_of(solid, name=f"solid {k + 1}") for k, solid in enumerate(solids)]
    joined = fields[0]
    for field in fields[1:]:
        joined = getattr(joined, name)(field)
    return Field(joined, partial(_joined, name, tuple(solids)))


def difference(a, b):
    """The difference of two solids: max(a, -b), which is negative where a is and b is not.

    See :func:`union`. Its box is that of ``a``.
    """
    return Field(field_of(a, name="a").difference(field_of(b, name="b")), partial(difference, a, b))


def smooth_union(a, b, width):
    """The union of two solids, rounded where the fields differ by less than the width.

    It is ``smin(a, b, width)`` of formulas. The width is a length where a and b are distances. A
    solid with edges is blended as if it were smooth: the mesh may be open along those that remain.
    See :func:`union`.

    Raises:
        ValueError: If the width is negative or not finite.
    """
    width = float(numbers("width", width, (), "a number"))
    if width < 0:
        raise ValueError(f"width is {width}, but must not be negative")
    joined = field_of(a, name="a").smooth_union(field_of(b, name="b"), width)
    return Field(joined, partial(smooth_union, a, b, width))


def offset(a, distance):
    """The field a - distance: where a is the distance from a solid, this solid is larger by
    ``distance``, or smaller by a negative one.

    Raises:
        ValueError: If the distance is not finite.
    """
    distance = float(numbers("distance", distance, (), "a number"))
    return Field(field_of(a, name="a").offset(distance), partial(offset, a, distance))
