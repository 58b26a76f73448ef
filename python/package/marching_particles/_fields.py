"""What can be sampled: formulas, functions, and surfaces through points."""

from __future__ import annotations

import json
from collections.abc import Mapping

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


class Model:
    """A surface through points, from :func:`fit_points`.

    Attributes:
        bounds: The box of the points with a margin, ``((x0, y0, z0), (x1, y1, z1))``.
        report: Numbers of points and centres, residuals as shares of the diagonal of the box,
            and where the normals came from.
        warnings: Sentences on what was done to the points, or may be wrong with them.
    """

    def __init__(self, field, report):
        self._field = field
        self.report = report
        self.warnings = report["warnings"]
        self.bounds = field.bounds

    def __repr__(self):
        return f"<Model of {self.report['points']:,} points>"


def fit_points(points, normals=None, *, centres=200):
    """Fits a surface to points.

    A sum of radial functions about some of the points is fitted to all of them; noise is smoothed
    as cross-validation tells.

    Args:
        points: Array (n, 3), in any unit of length.
        normals: Array (n, 3) of outward normals of any length; without it they are estimated.
        centres: Number of radial functions, 100 to 800. The time grows with its cube.

    Returns:
        A :class:`Model`, to be given to :func:`sample`.

    Raises:
        ValueError: If the arrays have another shape, or no surface can be fitted to the points.
    """
    points = numbers("points", points, (None, 3), "an array of n points, of the shape (n, 3)")
    if normals is not None:
        what = "an array of a normal for each point, of the shape of points"
        normals = numbers("normals", normals, points.shape, what)
    field, report = _core.Field.points(points, normals, integer("centres", centres, *_core.CENTRES))
    return Model(field, json.loads(report))


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
            raise FieldError(
                f"{argument} returned an array of the shape {array.shape} for {count} points: "
                f"it must be {wanted}"
            )
        return np.asarray(array, dtype=np.float64, order="C")

    return call


def field_of(field, params, gradient):
    """The core's field of what :func:`sample` was given."""
    if gradient is not None and not callable(gradient):
        raise TypeError(f"gradient must be a function, and not {type(gradient).__name__}")
    if isinstance(field, str):
        if gradient is not None:
            raise TypeError("gradient belongs to a function: a formula has its own")
        return _core.Field.formula(field, _parameters(params))
    if params is not None:
        raise TypeError("params belongs to a formula: give a function its values by a closure")
    if isinstance(field, Model):
        if gradient is not None:
            raise TypeError("gradient belongs to a function: a model has its own")
        return field._field
    if callable(field):
        slope = None if gradient is None else _checked(gradient, "gradient", (3,))
        return _core.Field.function(_checked(field, "field", ()), slope)
    raise TypeError(
        f"field must be a formula (str), a function or a Model, and not {type(field).__name__}"
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
