"""Sampling, and its result."""

from __future__ import annotations

import copy
import json
import os
import pickle
from collections.abc import Mapping
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

from . import _core
from ._fields import Field, _parameters, corners, field_of, numbers
from ._options import settings_of
from ._picture import png

class SampleWarning(NamedTuple):
    """What the user of a sample should know.

    Attributes:
        code: A name by which a program tells warnings apart.
        severity: ``"note"`` (nothing needs to be done), ``"caution"`` (the result may be
            incomplete, or less even than it could be) or ``"fault"`` (a part of the surface is
            missing or wrong).
        message: The sentence.
    """

    code: str
    severity: str
    message: str


class Mesh(NamedTuple):
    """Triangles with one vertex for each particle: closed where the surface is.

    Attributes:
        points: Array (n, 3), float64.
        normals: Array (n, 3), float32, of unit length and outward. On a sharp edge they are means
            of those of its sides.
        faces: Array (m, 3), int32, counter-clockwise seen from outside.
        rows: Array (n,), int32: the row of the sample that each vertex is.
    """

    points: np.ndarray
    normals: np.ndarray
    faces: np.ndarray
    rows: np.ndarray


# What of a sample is pickled beside its mesh.
_KEPT = (
    "points",
    "normals",
    "radii",
    "levels",
    "identities",
    "values",
    "faces",
    "report",
    "warnings",
    "mesh_warnings",
    "bounds",
    "change",
)


class Sample:
    """The particles of a run.

    The arrays have a row for each particle. A particle on a sharp edge, or on a smooth join that
    continues one, has a row for each side, with the normal of that side; :meth:`mesh` has it once.
    The arrays are made when they are first asked for, and kept.

    A sample is pickled with all its arrays, its mesh and its report. To :meth:`save` one that was
    unpickled, it is sampled anew, which takes a field that can be pickled: see :class:`Field`.
    """

    #: The distance of the mesh from the one given to :func:`remesh`, a dict; else None.
    change = None

    def __init__(self, make, progress):
        # What samples the field; of a sample that was unpickled as bytes, or why it is not known.
        self._make = make
        self._core = make(progress=_checked_progress(progress))
        # The mesh of one that was unpickled.
        self._mesh = None

    def _repr_png_(self):
        """The picture that notebooks show."""
        return png(self.points, self.normals, self.radii)

    def __getstate__(self):
        make = self._make
        if callable(make):
            try:
                make = pickle.dumps(make)
            except Exception as error:  # Functions that cannot be pickled raise errors of many types.
                make = str(error)
        return {**{name: getattr(self, name) for name in _KEPT}, "_make": make, "_mesh": self.mesh()}

    def __setstate__(self, state):
        self.__dict__.update(state, _core=None)

    def __copy__(self):
        return self._copied(lambda value: value)

    def __deepcopy__(self, memo):
        return self._copied(lambda value: copy.deepcopy(value, memo))

    def _copied(self, copied):
        other = Sample.__new__(Sample)
        # The core's sample and what makes it do not change.
        own = {name: self.__dict__[name] for name in ("_core", "_make")}
        others = {name: value for name, value in self.__dict__.items() if name not in own}
        other.__dict__.update(own, **{name: copied(value) for name, value in others.items()})
        return other

    def _sampled(self, what):
        """The core's sample, which one that was unpickled makes anew, to be ``what``."""
        if self._core is None:
            if isinstance(self._make, str):
                raise TypeError(
                    f"this sample was pickled without its field, so that it cannot be {what}: "
                    f"{self._make}. {'Save' if what == 'saved' else 'Move'} it before it is pickled"
                )
            self._core = pickle.loads(self._make)()
        return self._core

    def __len__(self):
        """Number of particles."""
        return self.report["count"]

    def __repr__(self):
        return f"<Sample of {len(self):,} particles>"

    @cached_property
    def points(self):
        """Positions, array (n, 3), float64, in the coordinates of the field."""
        return self._core.points()

    @cached_property
    def normals(self):
        """Unit normals along the gradient, array (n, 3), float32: outward where f < 0 inside."""
        return self._core.normals()

    @cached_property
    def radii(self):
        """Repulsion radii, array (n,), float32: neighbours sit about two radii apart."""
        return self._core.radii()

    @cached_property
    def levels(self):
        """Generation levels, array (n,), int32: 0 for the first particle of a front."""
        return self._core.levels()

    @cached_property
    def identities(self):
        """The number of each particle, array (n,), int32. It keeps its number in all samples that
        :meth:`moved` makes, of which those that are born later have larger ones."""
        return self._core.identities()

    @cached_property
    def values(self):
        """The columns that ``values`` has asked for, a dict of arrays (n,), float32."""
        return dict(self._core.values())

    @cached_property
    def faces(self):
        """Triangles over the rows of ``points``, array (m, 3), int32, counter-clockwise seen from
        outside. With ``points`` and ``normals`` they shade sharp edges sharply, since across one
        they share no row: :meth:`mesh` joins them."""
        return self._core.faces()

    @cached_property
    def report(self):
        """The report on the run, as a dict: count, radii, proof, quality and more. A measure that
        has no value is None."""
        return json.loads(self._core.report())

    @cached_property
    def warnings(self):
        """What may be wrong with the particles, a list of :class:`SampleWarning`."""
        return [SampleWarning(*warning) for warning in self._core.warnings()]

    @cached_property
    def mesh_warnings(self):
        """What may be wrong with the mesh, a list of :class:`SampleWarning`: holes, particles in no
        triangle."""
        return [SampleWarning(*warning) for warning in self._core.mesh_warnings()]

    @cached_property
    def bounds(self):
        """The box that was sampled, ``((x0, y0, z0), (x1, y1, z1))``."""
        return corners(*self._core.bounds())

    def moved(self, field=None, *, params=None, gradient=None, progress=None):
        """The particles after they have followed their surface to another one, which has moved only
        a little: a frame of a motion.

        They move to it and keep their numbers, :attr:`identities`; where it grows or shrinks, some
        are born or die. They leave this sample, whose arrays stay, and only the new one can be moved
        on. The box grows with a formula whose ``params`` change; else it stays. The same sequence of
        surfaces gives the same particles. Files of a sample that has moved do not say how it was
        made.

        >>> import marching_particles as mp
        >>> ball = mp.sample("x^2 + y^2 + z^2 = a", params={"a": 1}, count=500)
        >>> for a in (1.02, 1.04):
        ...     ball = ball.moved(params={"a": a})
        >>> bool(abs((ball.points**2).sum(axis=1) - 1.04).max() < 1e-4)
        True

        Args:
            field: The other field, as :func:`sample` takes it; without it the formula of this
                sample, with other ``params``.
            params: Values of the parameters of the formula, by name. Without ``field`` others keep
                theirs.
            gradient: The gradient of a function ``field``, as :func:`sample` takes it.
            progress: A function that is called with the share of the work done, 0 to 1.

        Returns:
            A :class:`Sample`, with the other options of this one.

        Raises:
            CannotFollow: If the surface has moved too far, or has sharp edges, or the particles are
                blue noise or random: this sample is then as before. Take smaller steps, or sample
                the other surface.
            ValueError: If the particles of this sample have moved to another one.
            FormulaError: If the formula cannot be read, or has no such parameter.
            TypeError: If an argument is of a wrong type.
        """
        if field is not None:
            core_field, values = field_of(field, params, gradient), []
        elif gradient is not None:
            raise TypeError("gradient belongs to a function: give it with its field")
        elif params is None:
            raise TypeError("give the field to which the particles move, or other params")
        else:
            core_field, values = None, _parameters(params)
        other = Sample.__new__(Sample)
        other._core = self._sampled("moved").moved(core_field, values, _checked_progress(progress))
        other._make = "its particles have come from other surfaces"
        other._mesh = None
        return other

    def mesh(self):
        """The :class:`Mesh` with one vertex for each particle."""
        return Mesh(*(self._core.mesh() if self._mesh is None else map(np.copy, self._mesh)))

    def save(self, path, *, mesh=False):
        """Writes a file: the mesh as ``.glb``, ``.3mf``, ``.stl`` or ``.obj``, the particles as
        ``.ply``, ``.csv``, ``.npy`` or ``.xyz``.

        A file of a formula says what it was made from: ``marching-particles sample --like`` makes
        it again. A CSV file has that beside it, in a file whose name goes on with ``.json``.

        Args:
            path: The file, whose extension is its format. What is there is replaced.
            mesh: Whether ``.ply`` is of the mesh.

        Raises:
            ValueError: If the extension is none of these.
            OSError: If the file cannot be written.
        """
        self._sampled("saved").save(os.fspath(path), bool(mesh))

    def to_trimesh(self):
        """The mesh as a ``trimesh.Trimesh``, with vertex normals."""
        import trimesh

        mesh = self.mesh()
        return trimesh.Trimesh(mesh.points, mesh.faces, vertex_normals=mesh.normals, process=False)

    def to_pyvista(self):
        """The mesh as a ``pyvista.PolyData``, with the point data ``Normals``, ``radius``
        and ``level``, and the values that were asked for."""
        import pyvista

        mesh = self.mesh()
        faces = np.column_stack([np.full(len(mesh.faces), 3, dtype=mesh.faces.dtype), mesh.faces])
        data = pyvista.PolyData(mesh.points, faces.ravel())
        data.point_data["Normals"] = mesh.normals
        data.point_data["radius"] = self.radii[mesh.rows]
        data.point_data["level"] = self.levels[mesh.rows]
        for name, values in self.values.items():
            data.point_data[name] = values[mesh.rows]
        return data

    def to_meshio(self):
        """The mesh as a ``meshio.Mesh`` of triangles, with the point data ``normals``, ``radius``
        and ``level``."""
        import meshio

        mesh = self.mesh()
        columns = {"radius": self.radii[mesh.rows], "level": self.levels[mesh.rows]}
        return meshio.Mesh(
            mesh.points, [("triangle", mesh.faces)], point_data={"normals": mesh.normals, **columns}
        )


def _checked_progress(progress):
    if progress is not None and not callable(progress):
        raise TypeError(f"progress must be a function, and not {type(progress).__name__}")
    return progress


def sample(
    field,
    *,
    count=None,
    spacing=None,
    radius=None,
    bounds=None,
    params=None,
    gradient=None,
    adaptive=False,
    law=None,
    chord_error=None,
    curvature_scale=None,
    radius_min=None,
    radius_max=None,
    grading=None,
    closed=False,
    periodic=False,
    thickness=None,
    method="front",
    pattern=None,
    exactly=False,
    relax=None,
    match_tolerance=None,
    gaps=None,
    seed=0,
    max_particles=None,
    values=None,
    measure=True,
    progress=None,
):
    """Samples the surface f = 0 with evenly spaced particles.

    The same arguments give the same particles, on every machine. Lengths are in the units of the
    field's coordinates. Ctrl-C ends a run.

    Args:
        field: A formula such as ``"x^2 + y^2 + z^2 = a"``; a function of a float64 array (n, 3) of
            points that returns n values, NaN where it has none; a :class:`Model` from
            :func:`fit_points`; or a :class:`Field` from :func:`union` and the like. f < 0 inside.
            What a function raises comes through unchanged. A text such as ``"torus"`` that is the
            name of a surface of the gallery, which ``marching-particles surfaces`` lists, is that
            surface, with its box and its parameters.
        count: Number of particles, met to within 3 %; 1 to 4,000,000.
        spacing: Distance between neighbours, twice the radius: a length; a share of the diagonal of
            the box such as ``"1%"``; a formula of x, y, z and ``params`` such as
            ``"0.02 + 0.1 hypot(x, y)"``; or a function of points, as for ``field``. It must be
            above 0 on the surface. Sizes change along the surface by ``grading`` at most; a warning
            says where particles are closer than a formula or function asks for this reason. With
            ``count`` a formula or function gives only the proportions, and with ``adaptive`` the
            smaller size is taken.
        radius: Repulsion radius, half the distance between neighbours: a length, or a share of the
            diagonal of the box such as ``"1%"``. Without count, spacing and radius it is 0.6 %.
        bounds: The box, ``((x0, y0, z0), (x1, y1, z1))``. Without it a model has its own, and
            another box is fitted to the surface. For functions, and what is made of them, the fit
            has only their signs on grids: give the box where you know it.
        params: Values of the parameters of a formula, by name; others are 1, or those of the
            surface of the gallery.
        gradient: A function of the points that returns the gradients of the function ``field``, (n,
            3). Without it they are found by differences, with several times as many calls.
        adaptive: Whether the radius follows the curvature. The size is then that of ``count``, or
            one that keeps close to the surface.
        law: How the radius follows from the curvature: ``"chord_error"`` (default),
            ``"max_curvature"`` or ``"sum_of_curvatures"``.
        chord_error: Largest gap between the surface and a triangle of neighbours: a length, or a
            share of the diagonal of the box; ``"0.0045%"`` by default.
        curvature_scale: Radius of a particle over the radius of curvature of the surface there, for
            the other two laws; 0.015 by default.
        radius_min: Radius of the smallest particles, at least: a length, or a share of the diagonal
            of the box; ``"0.1%"`` by default.
        radius_max: Radius of the largest particles, at most, in the same way; ``"3%"`` by default.
        grading: How fast the radius may change along the surface: a slope L, 0.01 to 0.5, 0.2 by
            default. The radii of neighbours differ by a factor of at most (1 + L)/(1 - L).
        closed: Whether the faces of the box close what they cut: the solid f <= 0 in the box. For
            formulas.
        periodic: Whether opposite faces of the box of ``closed`` have the same particles.
        thickness: Thickness of a shell around the surface, which is sampled instead: a length, or a
            formula of x, y, z and the parameters. For formulas.
        method: ``"front"``, or ``"refined"``: slower, with more particles that have six neighbours.
        pattern: ``"hexagonal"``, as fronts grow; ``"blue"``: blue noise, a Poisson-disk pattern
            without rows, no pair nearer than two radii and no hole wider; ``"random"``:
            independent points, even by area. The last two are not relaxed, and have exactly the
            wanted ``count``.
        exactly: Whether a front has exactly ``count`` particles, and not only to within 3 %.
        relax: Number of relaxation steps after the front; 10 by default.
        match_tolerance: Distance, in units of two radii, within which a child is matched with an
            existing particle instead of being added: 0.5 to 0.9, 0.7 by default.
        gaps: ``"fill"`` (default): where fronts meet, gaps that are wide enough get a particle;
            ``"leave"``: they do not.
        seed: A whole number, 0 to 2**64 - 1, that chooses the point where the front begins.
        max_particles: Number of particles at which the run stops; 4,400,000 by default.
        values: More columns, by name: formulas of x, y, z, the normal n_x, n_y, n_z, the principal
            curvatures k_1 >= k_2, the direction d_x, d_y, d_z of k_1, radius, level, area (the
            share of the surface), edge (the distance to the nearest sharp edge or rim) and
            ``params``, such as ``{"H": "(k_1 + k_2)/2"}``; or functions of points. They are
            :attr:`Sample.values`, and files have them: PLY, CSV, NPY and GLB.
        measure: Whether the particles are measured. It may take longer than the sampling; without
            it the report has no quality figures.
        progress: A function that is called with the share of the work done, 0 to 1.

    Returns:
        A :class:`Sample`.

    Raises:
        FormulaError: If the formula cannot be read, or has no such parameter.
        FieldError: If a function returns something else than numbers of the right shape.
        EmptySurface: If no particle could be placed.
        ValueError: If an argument is out of its range, or has no effect beside the others.
        TypeError: If an argument is of a wrong type.
        MemoryError: If there is not enough memory for the particles.
    """
    is_formula = isinstance(spacing, str) and not spacing.rstrip().endswith("%")
    is_varying = is_formula or callable(spacing) or isinstance(spacing, Field)
    if is_varying and radius is not None:
        raise ValueError("spacing and radius exclude each other: give one of them")
    options = settings_of(
        {
            "count": count,
            "spacing": None if is_varying else spacing,
            "radius": radius,
            "adaptive": adaptive,
            "law": law,
            "chord_error": chord_error,
            "curvature_scale": curvature_scale,
            "radius_min": radius_min,
            "radius_max": radius_max,
            "grading": grading,
            "closed": closed,
            "periodic": periodic,
            "thickness": thickness,
            "method": method,
            "pattern": pattern,
            "exactly": exactly,
            "relax": relax,
            "match_tolerance": match_tolerance,
            "gaps": gaps,
            "seed": seed,
            "max_particles": max_particles,
        }
    )
    if bounds is not None:
        what = "the lower and the upper corner of a box, ((x0, y0, z0), (x1, y1, z1))"
        bounds = numbers("bounds", bounds, (2, 3), what)
        if not (bounds[0] < bounds[1]).all():
            axis = "xyz"[int(np.argmin(bounds[0] < bounds[1]))]
            fault = f"along {axis} the lower is not below the upper"
            raise ValueError(f"bounds must be {what}: {fault}")
        bounds = tuple(bounds[0].tolist()), tuple(bounds[1].tolist())
    solid = {"closed": closed, "periodic": periodic, "thickness": thickness}
    return Sample(
        partial(
            _run,
            field,
            dict(params) if isinstance(params, Mapping) else params,
            gradient,
            options=options,
            of_formula=next((name for name, value in solid.items() if value), None),
            spacing=spacing if is_varying else None,
            bounds=bounds,
            values=dict(values) if isinstance(values, Mapping) else values,
            measure=bool(measure),
        ),
        progress,
    )


def _run(
    field, params, gradient, *, options, of_formula, spacing, bounds, values, measure, progress=None
):
    """The core's sample of what :func:`sample` has checked. A solid is ``of_formula``, an argument."""
    core_field = field_of(field, params, gradient)
    if of_formula is not None and not core_field.is_formula:
        raise ValueError(f"{of_formula} is for a formula by itself")
    return _core.sample(
        core_field,
        options,
        spacing=None if spacing is None else _function("spacing", spacing, core_field, params),
        bounds=bounds,
        values=_columns(values, core_field, params),
        measure=measure,
        progress=progress,
    )


def _function(name, function, core_field, params):
    """A function of place, as the core takes it: a formula, with the values of its parameters, or
    the core's field of a function."""
    if isinstance(function, str):
        # It has the parameters of the sampled formula.
        if core_field.is_formula:
            return function
        given = _parameters(params) if params is not None else []
        used = [f"{own} = {value!r}; " for own, value in given if own in function]
        return "".join(used) + function
    return field_of(function, name=name)


def _columns(values, core_field, params):
    if values is None:
        return []
    if not isinstance(values, Mapping):
        raise TypeError(f"values must be a dict of names and formulas or functions, and not {values!r}")
    return [
        (name, _function(f"values[{name!r}]", value, core_field, params))
        for name, value in values.items()
    ]
