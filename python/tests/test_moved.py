"""Particles that follow a moving surface."""

import pickle

import numpy as np
import pytest

import marching_particles as mp

BOX = ((-2, -2, -2), (2, 2, 2))


def ball(radius):
    return lambda p: np.linalg.norm(p, axis=1) - radius


def test_particles_follow_a_formula_whose_parameter_changes_and_keep_their_numbers(tmp_path):
    first = last = mp.sample("x^2 + y^2 + z^2 = a", params={"a": 1}, count=1000, values={"h": "z + a"})
    count, points = len(first), first.points
    assert np.array_equal(first.identities, np.arange(count))
    for a in (1.03, 1.06, 1.09):
        last = last.moved(params={"a": a})
        np.testing.assert_allclose((last.points**2).sum(axis=1), a, atol=1e-4)
        np.testing.assert_allclose(last.values["h"], last.points[:, 2] + a, atol=1e-5)
    kept = np.isin(last.identities, np.arange(count)).sum()
    assert kept > 0.95 * count and len(last.mesh().faces) == 2 * len(last) - 4
    # A particle goes along the gradient, outward.
    assert last.identities[7] == 7
    direction = last.points[7] / np.linalg.norm(last.points[7])
    assert direction @ points[7] > 0.999
    assert np.array_equal(first.points, points)
    last.save(tmp_path / "ball.ply")
    header = (tmp_path / "ball.ply").read_bytes()[:2000]
    assert b"uint identity" in header and b"formula" not in header


@pytest.mark.parametrize("bounds", [BOX, None])
def test_particles_follow_functions_and_other_formulas(bounds):
    sample = mp.sample(ball(1), count=500, bounds=bounds)
    box = sample.bounds
    for field, radius in ((ball(1.02), 1.02), (ball(1.04), 1.04), ("x^2 + y^2 + z^2 = 1.1", 1.1**0.5)):
        sample = sample.moved(field)
        np.testing.assert_allclose(np.linalg.norm(sample.points, axis=1), radius, atol=1e-4)
        assert sample.bounds == box or isinstance(field, str)


def test_a_sample_that_cannot_follow_stays_and_can_take_a_smaller_step():
    sample = mp.sample("x^2 + y^2 + z^2 = a", params={"a": 1}, count=500)
    for arguments, error, says in (
        ({"params": {"a": 4}}, mp.CannotFollow, "moved too far"),
        ({"field": "max(abs(x), abs(y), abs(z)) = 1"}, mp.CannotFollow, "creases"),
        ({"params": {"b": 1}}, mp.FormulaError, "no parameter `b`"),
        ({"gradient": ball(1)}, TypeError, "gradient belongs to a function"),
        ({}, TypeError, "give the field"),
        ({"params": {"a": 1.01}, "progress": 3}, TypeError, "progress must be a function"),
    ):
        with pytest.raises(error, match=says):
            sample.moved(**arguments)
    moved = sample.moved(params={"a": 1.02})
    with pytest.raises(ValueError, match="have moved on"):
        sample.moved(params={"a": 1.01})
    again = pickle.loads(pickle.dumps(moved))
    assert np.array_equal(again.identities, moved.identities)
    with pytest.raises(TypeError, match="without its field.*Move it before"):
        again.moved(params={"a": 1.01})
    function = mp.sample(ball(1), count=300, bounds=BOX)
    with pytest.raises(TypeError, match="params belongs to a formula"):
        function.moved(params={"a": 1})


def test_an_unpickled_sample_of_a_formula_moves_as_the_sample_does():
    sample = mp.sample("x^2 + y^2 + z^2 = a", params={"a": 1}, count=500)
    again = pickle.loads(pickle.dumps(sample))
    ours, theirs = (own.moved(params={"a": 1.02}).points for own in (sample, again))
    assert np.array_equal(ours, theirs)
