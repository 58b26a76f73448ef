"""Evenly spaced particles on implicit surfaces f(x, y, z) = 0.

>>> import marching_particles as mp
>>> sample = mp.sample("x^2 + y^2 + z^2 = 1", count=500)
>>> sample.points.shape[1], sample.report["components"]
(3, 1)
"""

from ._core import __version__
from ._errors import EmptySurface, FieldError, FormulaError
from ._fields import Model, fit_points
from ._sample import Mesh, Sample, Warning, sample

__all__ = [
    "EmptySurface",
    "FieldError",
    "FormulaError",
    "Mesh",
    "Model",
    "Sample",
    "Warning",
    "__version__",
    "fit_points",
    "sample",
]
