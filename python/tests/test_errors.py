"""Bad input: each error says what is wrong, where, and what to do."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import trimesh

import marching_particles as mp

BOX = ((-1.5, -1.5, -1.5), (1.5, 1.5, 1.5))
SPHERE = "x^2 + y^2 + z^2 = 1"


def sphere(points):
    return np.linalg.norm(points, axis=1) - 1


def test_a_formula_with_a_mistake_names_its_place_in_characters():
    with pytest.raises(mp.FormulaError) as caught:
        mp.sample("x² + sqr(y) = 1")
    error = caught.value
    assert error.formula[slice(*error.span)] == "sqr(y)" and error.choices == ["y^2", "sqrt(y)"]
    lines = str(error).splitlines()
    assert lines[1:] == ["  x² + sqr(y) = 1", "       ^^^^^^", "try: y^2 or sqrt(y)"]
    assert isinstance(error, ValueError)


def test_a_misspelt_function_has_a_suggestion():
    with pytest.raises(mp.FormulaError) as caught:
        mp.sample("x^2 + hipot(y, z) = 1")
    error = caught.value
    assert error.formula[slice(*error.span)] == "hipot" and error.suggestion == "hypot"


def test_what_is_a_file_or_an_array_of_points_is_said_where_to_give(tmp_path):
    path = tmp_path / "scan.xyz"
    path.write_text("0 0 0\n")
    with pytest.raises(ValueError, match="is a file: give it to fit_points, Image or remesh"):
        mp.sample(str(path))
    with pytest.raises(TypeError, match="and not ndarray: fit_points makes a field of points"):
        mp.sample(np.zeros((9, 3)))
    with pytest.raises(TypeError, match="and not ndarray: Image makes a field of voxels"):
        mp.sample(np.zeros((9, 9, 9)))
    with pytest.raises(TypeError, match="and not Trimesh: remesh samples a mesh"):
        mp.sample(trimesh.creation.box())


def test_an_unknown_parameter_is_named():
    with pytest.raises(mp.FormulaError, match="`b`") as caught:
        mp.sample("x^2 + y^2 + z^2 = a", params={"b": 2})
    # It has no place in the formula.
    assert caught.value.span is None and str(caught.value) == caught.value.message


@pytest.mark.parametrize(
    ("arguments", "kind", "says"),
    [
        ({"count": -5}, ValueError, "count is -5, but must lie between 1 and 4,000,000"),
        ({"count": 0}, ValueError, "between 1 and"),
        ({"count": 10**9}, ValueError, "between 1 and 4,000,000"),
        ({"count": 2.5}, TypeError, "count must be a whole number, and not 2.5"),
        ({"count": 10, "radius": 0.1}, ValueError, "count and radius exclude each other"),
        ({"radius": 0}, ValueError, "radius is 0.0, but must be positive"),
        ({"radius": float("nan")}, ValueError, "radius is nan"),
        ({"radius": 100.0, "bounds": BOX}, ValueError, "radius is 100, but must lie between"),
        ({"spacing": "wide"}, mp.FormulaError, "has no parameter `wide`: a spacing is made of"),
        ({"spacing": [1]}, ValueError, "spacing must be a number"),
        ({"spacing": "0.1 x"}, ValueError, "on the surface, but must be above 0"),
        ({"spacing": lambda p: p}, mp.FieldError, "spacing returned an array of the shape"),
        ({"values": {"H": "k_3"}}, mp.FormulaError, "A particle has no `k_3`"),
        ({"values": {"radius": "1"}}, ValueError, "`radius` cannot be the name of values"),
        ({"values": {"v": 3}}, TypeError, r"values\['v'\] must be a formula"),
        ({"values": ["H"]}, TypeError, "values must be a dict"),
        ({"radius": "wide"}, ValueError, "a share of the diagonal of the box such as"),
        ({"radius": "nan%"}, ValueError, "and not 'nan%'"),
        ({"radius": "50%"}, ValueError, "radius_share is 0.5, but must lie between"),
        ({"spacing": 0.1, "adaptive": True}, ValueError, "spacing has no effect with adaptive=True"),
        ({"method": "fast"}, ValueError, "method is 'fast', but must be one of 'front', 'refined'"),
        ({"seed": -1}, ValueError, "seed is -1"),
        ({"bounds": ((0, 0, 0), (1, np.nan, 1))}, ValueError, r"bounds\[1\]\[1\] is nan"),
        ({"bounds": ((0, 0), (1, 1))}, ValueError, r"not of the shape \(2, 2\)"),
        ({"bounds": ((0, 0, 0), (1, 1))}, ValueError, "bounds must be the lower and the"),
        ({"bounds": ((0, 2, 0), (1, 1, 1))}, ValueError, "along y the lower is not below"),
        ({"bounds": (("a",) * 3, ("b",) * 3)}, TypeError, "not of the type"),
        ({"grading": 0.3}, ValueError, "grading has no effect without adaptive=True"),
        ({"periodic": True}, ValueError, "periodic has no effect without closed=True"),
        ({"adaptive": True, "curvature_scale": 0.1}, ValueError, 'without law="max_curvature" or'),
        ({"law": "best", "adaptive": True}, ValueError, "law is 'best', but must be one of"),
        ({"relax": 2000}, ValueError, "relax is 2,000, but must lie between 0 and 1,000"),
        ({"match_tolerance": 2}, ValueError, "must lie between 0.5 and 0.9"),
        ({"thickness": -1}, ValueError, "thickness is -1, but must lie between 0"),
        ({"thickness": "0.1 +"}, mp.FormulaError, "Thickness: Something is missing"),
        ({"params": {"a": "b"}}, TypeError, r"params\['a'\] must be a number"),
        ({"params": [1]}, TypeError, "params must be a dict"),
        ({"gradient": sphere}, TypeError, "a formula has its own"),
        ({"progress": 3}, TypeError, "progress must be a function"),
    ],
)
def test_arguments(arguments, kind, says):
    with pytest.raises(kind, match=says):
        mp.sample(SPHERE, **arguments)


def test_a_field_of_another_type():
    with pytest.raises(TypeError, match=r"field must be a formula \(str\), .* and not int"):
        mp.sample(3)
    with pytest.raises(TypeError, match="params belongs to a formula"):
        mp.sample(sphere, params={"a": 1})
    with pytest.raises(TypeError, match=r"a function of \(x, y, z\): .* p\[:, 0\] in place of x"):
        mp.sample(lambda x, y, z: x)
    with pytest.raises(ValueError, match="closed is for a formula by itself"):
        mp.sample(sphere, closed=True, bounds=BOX)


@pytest.mark.parametrize(
    ("function", "says"),
    [
        (lambda points: 0.0, r"shape \(\) for \d+ points: it must be \(\d+,\)"),
        (lambda p: p[0], r"p\[:, 0\] is x of all points p"),
        (lambda points: sphere(points)[:-1], r"array of the shape \(\d+,\) for \d+ points"),
        (lambda points: points, r"shape \(\d+, 3\)"),
        (lambda points: None, "field returned NoneType of the type object"),
        (lambda points: sphere(points) + 0j, "complex128: it must return an array of numbers"),
        (lambda points: ["a"] * len(points), "field returned list"),
    ],
)
def test_a_function_that_returns_something_else(function, says):
    with pytest.raises(mp.FieldError, match=says):
        mp.sample(function, bounds=BOX)


def test_a_gradient_of_another_shape():
    with pytest.raises(mp.FieldError, match=r"gradient returned an array of the shape \(\d+,\)"):
        mp.sample(sphere, bounds=BOX, gradient=sphere)


@pytest.mark.parametrize("bounds", [BOX, None])
def test_a_function_that_is_nan_everywhere(bounds):
    with pytest.raises(mp.EmptySurface, match="value|undefined|defined"):
        mp.sample(lambda points: np.full(len(points), np.nan), bounds=bounds)


def test_a_surface_without_a_point():
    with pytest.raises(mp.EmptySurface):
        mp.sample("x^2 + y^2 + z^2 = -1")
    with pytest.raises(mp.EmptySurface, match=r"pass bounds=\(\(x0"):
        mp.sample(lambda points: sphere(points) + 2)


class Own(Exception):
    pass


@pytest.mark.parametrize("after", [0, 1, 20, 200])
def test_an_exception_of_a_function_comes_through_unchanged(after):
    raised, calls = Own("mine"), []

    def value(points):
        calls.append(len(points))
        if len(calls) > after:
            raise raised
        return sphere(points)

    with pytest.raises(Own) as caught:
        mp.sample(value, count=2000, bounds=BOX)
    assert caught.value is raised and len(calls) == after + 1
    assert any(entry.name == "value" for entry in caught.traceback)


def test_an_exception_of_progress_ends_the_run():
    shares = []

    def stop(share):
        shares.append(share)
        raise Own

    with pytest.raises(Own):
        mp.sample(SPHERE, count=50_000, progress=stop)
    assert len(shares) == 1


@pytest.fixture
def interrupts():
    """Python's own handler of SIGINT: a shell has programs in the background ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.skipif(os.name == "nt", reason="Windows has no SIGINT to send to oneself")
@pytest.mark.usefixtures("interrupts")
@pytest.mark.parametrize("field", [SPHERE, sphere])
def test_ctrl_c_ends_a_run(field):
    timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        mp.sample(field, count=3_000_000, bounds=BOX)
    # The whole run takes minutes.
    assert time.monotonic() - begin < 10


@pytest.mark.parametrize(
    ("points", "normals", "says"),
    [
        (np.zeros((10, 2)), None, r"points must be an array of n points, of the shape \(n, 3\)"),
        (np.zeros((0, 3)), None, "point"),
        (np.zeros((50, 3)), None, "all points are at the same place"),
        (np.full((50, 3), np.inf), None, r"points\[0\]\[0\] is inf"),
        (np.eye(3), np.eye(3)[:2], "normals must be an array of a normal for each point"),
    ],
)
def test_points_that_lead_to_no_surface(points, normals, says):
    with pytest.raises(ValueError, match=says):
        mp.fit_points(points, normals)


def test_a_number_of_centres_out_of_range():
    with pytest.raises(ValueError, match="centres is 3, but must lie between 100 and 800"):
        mp.fit_points(np.eye(3), centres=3)


def test_files(tmp_path):
    ball = mp.sample(SPHERE, count=100)
    with pytest.raises(ValueError, match="glb, 3mf, stl, obj"):
        ball.save(tmp_path / "ball.jpg")
    with pytest.raises(FileNotFoundError, match="there is no folder .*nowhere"):
        ball.save(tmp_path / "nowhere" / "ball.ply")


def test_the_package_is_imported_without_libraries_for_meshes():
    code = "import sys, marching_particles; assert not {'trimesh', 'pyvista'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)
