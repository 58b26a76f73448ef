"""Evenly spaced particles on implicit surfaces f(x, y, z) = 0.

>>> import marching_particles as mp
>>> sample = mp.sample("x^2 + y^2 + z^2 = 1", count=500)
>>> sample.points.shape[1], sample.report["components"]
(3, 1)
"""

from ._core import __version__
from ._errors import CannotFollow, EmptySurface, FieldError, FormulaError
from ._fields import (
    Field,
    Model,
    difference,
    field,
    fit_points,
    intersection,
    offset,
    piecewise,
    smooth_union,
    union,
)
from ._image import Image
from ._remesh import TriangleMesh, remesh
from ._report import MeshChange, ModelReport, Report
from ._sample import Mesh, Sample, SampleWarning, sample

__all__ = [
    "CannotFollow",
    "EmptySurface",
    "Field",
    "FieldError",
    "FormulaError",
    "Image",
    "Mesh",
    "MeshChange",
    "Model",
    "ModelReport",
    "Report",
    "Sample",
    "SampleWarning",
    "TriangleMesh",
    "__version__",
    "difference",
    "field",
    "fit_points",
    "intersection",
    "offset",
    "piecewise",
    "remesh",
    "sample",
    "smooth_union",
    "union",
]
