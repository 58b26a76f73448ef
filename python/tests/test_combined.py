"""Solids of any two fields."""

import numpy as np
import pytest

import marching_particles as mp

BOX = ((-2, -2, -2), (2, 2, 2))
BLOCK = "max(abs(x) - 1, abs(y) - 1, abs(z) - 0.5)"


def ball(points):
    return np.linalg.norm(points, axis=1) - 1


def rod(points):
    return np.linalg.norm(points[:, :2], axis=1) - 0.4


def moved(x):
    return lambda points: ball(points - np.array([x, 0, 0]))


def euler(sample):
    """The Euler number of the mesh, which must be closed."""
    mesh = sample.mesh()
    edges = np.sort(np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]]))
    edges, uses = np.unique(edges, axis=0, return_counts=True)
    assert (uses == 2).all()
    return len(mesh.points) - len(edges) + len(mesh.faces)


def test_two_functions_meet_in_an_edge():
    both = mp.sample(mp.union(moved(-0.5), moved(0.5)), count=2000, bounds=BOX)
    assert both.report["creases"] == 1 and euler(both) == 2
    lens = mp.sample(mp.intersection(moved(-0.5), moved(0.5)), count=1000, bounds=BOX)
    assert lens.report["creases"] == 1 and abs(lens.points[:, 0]).max() < 0.51


def test_the_edges_of_a_function_are_found():
    def ball_in_a_box_less_three_tubes(p):
        ball = np.linalg.norm(p, axis=1) - 1
        box = np.max(np.abs(p), axis=1) - 0.75
        tubes = [np.hypot(p[:, a], p[:, b]) - 0.5 for a, b in [(0, 1), (1, 2), (0, 2)]]
        return np.maximum(np.maximum(ball, box), -np.minimum.reduce(tubes))

    part = mp.sample(ball_in_a_box_less_three_tubes, count=4_000)
    assert (part.report["creases"], part.report["corners"], euler(part)) == (24, 8, -8)


def test_a_function_says_which_piece_gives_it_where():
    sides = [lambda p, a=a, s=s: s * p[:, a] - 0.8 for a in range(3) for s in (1, -1)]
    pieces = [*sides, lambda p: 0.7 - np.linalg.norm(p - 0.8, axis=1)]

    def label(p):
        return np.argmax([piece(p) for piece in pieces], axis=0)

    part = mp.sample(mp.piecewise(label, pieces), count=4_000)
    assert (part.report["creases"], part.report["corners"], euler(part)) == (15, 10, 2)
    values = np.array([piece(part.points) for piece in pieces])
    assert np.abs(values.max(axis=0)).max() < 1e-5
    # Particles on an edge are zeros of both of its pieces.
    edges = len(part.points) - len(part.mesh().points)
    assert (np.sort(np.abs(values), axis=0)[1] < 1e-5).sum() >= edges > 100


def test_labels_that_are_no_index_of_a_piece_are_refused():
    for wrong, shown in [(2, "2"), (0.5, "0.5"), (np.nan, "nan")]:
        field = mp.piecewise(lambda p, wrong=wrong: np.full(len(p), wrong), [ball, rod])
        with pytest.raises(mp.FieldError, match=f"label returned {shown} at .* from 0 to 1"):
            mp.sample(field, count=500, bounds=BOX)
    with pytest.raises(TypeError, match=r"pieces\[1\] must be a function"):
        mp.piecewise(ball, [ball, "z"])
    with pytest.raises(ValueError, match="pieces is empty"):
        mp.piecewise(ball, [])


def test_a_function_is_taken_from_a_formula():
    drilled = mp.sample(mp.difference(BLOCK, rod), count=3000, bounds=BOX)
    assert euler(drilled) == 0


def test_results_are_combined_again():
    field = mp.difference(mp.difference(BLOCK, rod), mp.offset(moved(1), -0.6))
    assert field.bounds is None
    sample = mp.sample(field, count=3000, bounds=BOX)
    assert euler(sample) == 0
    assert np.linalg.norm(sample.points - np.array([1, 0, 0]), axis=1).min() > 0.4 - 1e-4


def test_a_smooth_union_has_no_edge_and_bulges():
    sharp, smooth = (mp.smooth_union(moved(-0.8), moved(0.8), width) for width in (0, 0.4))
    waist = []
    for field in (sharp, smooth):
        sample = mp.sample(field, count=3000, bounds=BOX)
        assert euler(sample) == 2
        waist.append(np.linalg.norm(sample.points[abs(sample.points[:, 0]) < 0.1], axis=1).min())
    assert waist[1] > waist[0] + 0.05


def test_an_offset_of_a_distance_is_a_larger_solid():
    sample = mp.sample(mp.offset(ball, 0.25), count=500, bounds=BOX)
    np.testing.assert_allclose(np.linalg.norm(sample.points, axis=1), 1.25, atol=1e-4)


def test_a_formula_has_its_parameters_and_a_function_its_gradient():
    calls = []

    def gradient(points):
        calls.append(len(points))
        return points / np.maximum(ball(points) + 1, 1e-9)[:, None]

    a = mp.field("x^2 + y^2 + z^2 = a", params={"a": 0.25})
    b = mp.field(moved(0), gradient=gradient)
    sample = mp.sample(mp.intersection(a, b), count=300, bounds=BOX)
    np.testing.assert_allclose(np.linalg.norm(sample.points, axis=1), 0.5, atol=1e-4)
    assert calls


@pytest.fixture(scope="module")
def model():
    random = np.random.default_rng(0)
    points = random.normal(size=(1000, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return mp.fit_points(points, points, centres=100)


def test_a_model_is_cut_in_its_own_box(model):
    half = mp.intersection(model, "z")
    assert half.bounds == model.bounds
    sample = mp.sample(half, count=1000)
    assert sample.points[:, 2].max() < 1e-4 and euler(sample) == 2


def test_the_box_of_a_combination_holds_its_surface(model):
    lo, hi = np.array(model.bounds)
    assert mp.intersection("z", model).bounds == mp.difference(model, ball).bounds == model.bounds
    assert mp.union(model, ball).bounds is None and mp.difference(ball, model).bounds is None
    np.testing.assert_allclose(mp.offset(model, 0.5).bounds, (lo - 0.5, hi + 0.5))
    np.testing.assert_allclose(mp.offset(model, -0.5).bounds, (lo, hi))
    np.testing.assert_allclose(mp.smooth_union(model, model, 0.6).bounds, (lo - 0.1, hi + 0.1))


def test_what_a_function_raises_comes_through():
    with pytest.raises(ZeroDivisionError):
        mp.sample(mp.union(BLOCK, lambda points: 1 / 0), bounds=BOX)
    with pytest.raises(mp.FieldError, match=r"solid 2 returned an array of the shape"):
        mp.sample(mp.union(BLOCK, lambda points: points), bounds=BOX)


@pytest.mark.parametrize(
    ("make", "kind", "says"),
    [
        (lambda: mp.union(1, BLOCK), TypeError, r"solid 1 must be a formula \(str\), .* and not int"),
        (lambda: mp.union(BLOCK, None), TypeError, "solid 2 must be a formula .* and not NoneType"),
        (lambda: mp.intersection(BLOCK, np.eye(3)), TypeError, "solid 2 must be .* and not ndarray"),
        (lambda: mp.difference("x +", BLOCK), mp.FormulaError, "missing"),
        (lambda: mp.union(BLOCK), TypeError, "two solids or more, and not 1"),
        (lambda: mp.smooth_union(BLOCK, ball, "wide"), TypeError, "width must be a number"),
        (lambda: mp.smooth_union(BLOCK, ball, -1), ValueError, "width is -1.0, but must not be"),
        (lambda: mp.smooth_union(BLOCK, ball, np.nan), ValueError, "width is nan"),
        (lambda: mp.offset(ball, [1, 2]), ValueError, r"distance must be a number, and not of"),
        (lambda: mp.offset(ball, np.inf), ValueError, "distance is inf"),
        (lambda: mp.field(BLOCK, gradient=ball), TypeError, "a formula has its own"),
        (lambda: mp.field(ball, params={"a": 1}), TypeError, "params belongs to a formula"),
        (
            lambda: mp.sample(mp.field(ball), gradient=ball),
            TypeError,
            r"gradient belongs to a function: give it to field\(\)",
        ),
        (lambda: mp.sample(mp.field("a x"), params={"a": 1}), TypeError, "params belongs to a formula"),
    ],
)
def test_arguments(make, kind, says):
    with pytest.raises(kind, match=says):
        make()
