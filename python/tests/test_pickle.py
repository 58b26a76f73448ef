"""Copies of fields and samples, and what pickles of them hold."""

import copy
import pickle

import numpy as np
import pytest

import marching_particles as mp

BOX = ((-2, -2, -2), (2, 2, 2))


def puck(p):
    return np.maximum(np.hypot(p[:, 0], p[:, 1]) - 1, np.abs(p[:, 2]) - 0.5)


def shift(p):
    return p[:, 2] - 0.25


def is_above(p):
    return shift(p) > puck(p)


def grid_of_ball():
    i, j, k = np.ogrid[:24, :24, :24]
    return 8 - np.sqrt((i - 11.5) ** 2 + (j - 11.5) ** 2 + (k - 11.5) ** 2)


def points_of_ball():
    z = 1 - (2 * np.arange(400) + 1) / 400
    angle, radius = 2.399963 * np.arange(400), np.sqrt(1 - z * z)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])


TETRAHEDRON = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])

FIELDS = {
    "formula": lambda: mp.field("x^2 + y^2 + z^2 = a", params={"a": 1.5}),
    "function": lambda: mp.field(puck),
    "pieces": lambda: mp.piecewise(is_above, [puck, shift]),
    "union": lambda: mp.union([puck, "x^2 + y^2 + z^2 - 0.9", mp.offset(puck, 0.1)]),
    "difference": lambda: mp.difference("x^2 + y^2 + z^2 - 1", mp.smooth_union(puck, shift, 0.1)),
    "points": lambda: mp.fit_points(points_of_ball()),
    "image": lambda: mp.Image(grid_of_ball(), iso=0, spacing=0.1, origin=(-1, -1, -1)),
    "mesh": lambda: mp.TriangleMesh((TETRAHEDRON, FACES)),
}


@pytest.mark.parametrize("kind", FIELDS)
def test_a_field_that_was_pickled_has_the_same_particles(kind):
    field = FIELDS[kind]()
    again = pickle.loads(pickle.dumps(field))
    assert type(again) is type(field) and again.bounds == field.bounds
    bounds = BOX if field.bounds is None else None
    ours, theirs = (mp.sample(one, count=300, bounds=bounds).points for one in (field, again))
    assert np.array_equal(ours, theirs)


def test_a_field_of_a_file_is_pickled_with_its_content(tmp_path):
    path = tmp_path / "ball.xyz"
    np.savetxt(path, points_of_ball())
    pickled = pickle.dumps(mp.fit_points(path))
    path.unlink()
    assert pickle.loads(pickled).report["points"] == 400


def test_a_field_of_a_lambda_says_that_it_cannot_be_pickled():
    with pytest.raises((AttributeError, pickle.PicklingError), match="lambda"):
        pickle.dumps(mp.field(lambda p: p[:, 0]))


def test_copies_of_a_field_are_the_field():
    field = mp.field(puck)
    assert copy.copy(field) is field and copy.deepcopy([field])[0] is field


def test_a_sample_is_pickled_with_all_that_it_holds(tmp_path):
    params = {"a": 1.0}
    sample = mp.sample(
        "max(abs(x), abs(y), abs(z)) = a", params=params, count=400, values={"h": "z + a"}
    )
    params["a"] = 2.0
    again = pickle.loads(pickle.dumps(pickle.loads(pickle.dumps(sample))))
    for name in ("points", "normals", "radii", "levels", "faces"):
        assert np.array_equal(getattr(again, name), getattr(sample, name))
    assert np.array_equal(again.values["h"], sample.values["h"])
    for ours, theirs in zip(again.mesh(), sample.mesh()):
        assert np.array_equal(ours, theirs)
    assert (again.report, again.warnings, again.bounds) == (
        sample.report,
        sample.warnings,
        sample.bounds,
    )
    assert again.mesh_warnings == sample.mesh_warnings and len(again) == len(sample)
    for name in ("cube.ply", "cube.glb", "cube.csv"):
        sample.save(tmp_path / name)
        again.save(tmp_path / f"again-{name}")
        assert (tmp_path / name).read_bytes() == (tmp_path / f"again-{name}").read_bytes()


def test_a_sample_whose_field_cannot_be_pickled_is_pickled_but_cannot_be_saved(tmp_path):
    sample = mp.sample(lambda p: np.linalg.norm(p, axis=1) - 1, count=300, bounds=BOX)
    again = pickle.loads(pickle.dumps(sample))
    assert np.array_equal(again.points, sample.points) and len(again.mesh().faces) > 500
    with pytest.raises(TypeError, match="without its field.*lambda.*Save it before"):
        again.save(tmp_path / "ball.ply")


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy])
def test_copies_of_a_sample_can_be_saved(copied, tmp_path):
    sample = mp.sample(lambda p: np.linalg.norm(p, axis=1) - 1, count=300, bounds=BOX)
    before = sample.points.copy()
    other = copied(sample)
    other.save(tmp_path / "ball.ply")
    other.points[0] = 7
    assert np.array_equal(sample.points, before) == (copied is copy.deepcopy)
    assert repr(other) == repr(sample)
