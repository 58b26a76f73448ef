"""What a sample is, for each kind of field."""

import ast
import doctest
import inspect
import json
import re
import threading
import time
import typing
from pathlib import Path

import numpy as np
import pytest
import trimesh

import marching_particles as mp

BOX = ((-1.5, -1.5, -1.5), (1.5, 1.5, 1.5))


def sphere(points):
    return np.linalg.norm(points, axis=1) - 1


def edges_twice(faces):
    """Whether every edge of the faces has two of them, one in each direction."""
    edges = {tuple(edge) for face in faces for edge in zip(face, np.roll(face, -1))}
    return len(edges) == 3 * len(faces) and all((b, a) in edges for a, b in edges)


def test_the_example_of_the_package_holds():
    assert doctest.testmod(mp).failed == 0 and doctest.testmod(mp).attempted == 3


@pytest.mark.parametrize("page", ["README.md", "../README.md"])
def test_the_examples_of_the_pages_run(page, tmp_path, monkeypatch):
    text = (Path(__file__).parents[1] / page).read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    assert blocks
    monkeypatch.chdir(tmp_path)
    points = np.random.default_rng(0).normal(size=(500, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    names = {"points": points, "normals": points}
    for block in blocks:
        exec(block, names)
    assert list(tmp_path.glob("*.glb"))


def test_the_name_of_a_gallery_surface_is_that_surface_with_its_box_and_its_parameters(tmp_path):
    torus = mp.sample("torus", count=800)
    assert torus.bounds == ((-1.65, -1.65, -0.55), (1.65, 1.65, 0.55))
    x, y, z = torus.points.T
    np.testing.assert_allclose(np.hypot(np.hypot(x, y) - 1, z), 0.4, atol=1e-4)
    torus.save(tmp_path / "torus.ply")
    assert b'"surface":"torus"' in (tmp_path / "torus.ply").read_bytes()[:1000]
    thin = mp.sample("torus", params={"r": 0.2}, bounds=BOX, count=500)
    assert thin.bounds == BOX and abs(thin.points[:, 2]).max() < 0.2001
    with pytest.raises(mp.FormulaError, match="no parameter `q`"):
        mp.sample("torus", params={"q": 1})
    # As an operand it brings its box.
    assert mp.union("torus", "ellipsoid").bounds[0] == (-1.65, -1.65, -0.85)


def test_a_formula_gives_particles_on_its_surface_in_arrays_of_the_promised_types():
    sample = mp.sample("x^2 + y^2 + z^2 = a", params={"a": 4}, count=1000, seed=3)
    n = len(sample)
    assert abs(n - 1000) <= 30
    assert sample.points.shape == (n, 3) and sample.points.dtype == np.float64
    assert sample.normals.shape == (n, 3) and sample.normals.dtype == np.float32
    assert sample.radii.shape == (n,) and sample.radii.dtype == np.float32
    assert sample.levels.shape == (n,) and sample.levels.dtype == np.int32
    assert sample.faces.shape == (2 * n - 4, 3) and sample.faces.dtype == np.int32
    np.testing.assert_allclose(np.linalg.norm(sample.points, axis=1), 2, atol=1e-4)
    np.testing.assert_allclose(sample.normals, sample.points / 2, atol=1e-4)
    assert edges_twice(sample.faces)
    assert sample.report["components"] == 1 and sample.warnings == []
    assert sample.points is sample.points


def test_the_same_arguments_give_the_same_particles_and_another_seed_others():
    one, same, other = (mp.sample("x^2+y^2+z^2=1", count=300, seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.points, same.points)
    assert one.report["digest"] == same.report["digest"] != other.report["digest"]


def test_the_spacing_is_twice_the_radius():
    radius = mp.sample("x^2+y^2+z^2=1", radius=0.1)
    spacing = mp.sample("x^2+y^2+z^2=1", spacing=0.2)
    np.testing.assert_array_equal(radius.points, spacing.points)
    np.testing.assert_allclose(radius.radii, 0.1, rtol=1e-6)


def test_a_spacing_by_a_formula_or_a_function():
    ball = "x^2 + y^2 + z^2 = a^2"
    formula = mp.sample(ball, params={"a": 2}, spacing="0.1 a + 0.05 z")
    function = mp.sample(ball, params={"a": 2}, spacing=lambda p: 0.2 + 0.05 * p[:, 2])
    for sample in (formula, function):
        wanted = 0.1 + 0.025 * sample.points[:, 2]
        np.testing.assert_allclose(sample.radii, wanted, rtol=1e-3)
    counted = mp.sample(ball, params={"a": 2}, count=2000, spacing="1 + 0.25 z")
    assert abs(len(counted) - 2000) <= 60
    ratio = counted.radii / (1 + 0.25 * counted.points[:, 2])
    assert ratio.max() / ratio.min() < 1.01


def test_what_a_spacing_raises_comes_through():
    def fails(points):
        raise ZeroDivisionError("no spacing")

    with pytest.raises(ZeroDivisionError, match="no spacing"):
        mp.sample("x^2+y^2+z^2=1", spacing=fails)


def test_values_are_columns(tmp_path):
    columns = {"H": "(k_1 + k_2)/2", "height": lambda p: p[:, 2], "area": "area", "b": "b x"}
    with pytest.raises(ValueError, match="`Area`"):
        mp.sample("x^2+y^2+z^2=4", count=500, values={"area": "1", "Area": "2"})
    sample = mp.sample("x^2+y^2+z^2=4 + 0b", params={"b": 3}, count=500, values=columns)
    np.testing.assert_allclose(sample.values["H"], 0.5, rtol=1e-3)
    np.testing.assert_allclose(sample.values["height"], sample.points[:, 2], atol=1e-6)
    np.testing.assert_allclose(sample.values["area"].sum(), 16 * np.pi, rtol=0.02)
    np.testing.assert_allclose(sample.values["b"], 3 * sample.points[:, 0], rtol=1e-5)
    sample.save(tmp_path / "ball.npy")
    assert np.load(tmp_path / "ball.npy").shape == (len(sample), 10)


def test_a_radius_may_be_a_share_of_the_diagonal():
    ball = mp.sample("x^2+y^2+z^2=1", radius="2 %", bounds=BOX)
    np.testing.assert_allclose(ball.radii, 0.02 * 3 * 3**0.5, rtol=1e-6)
    usual = mp.sample("x^2+y^2+z^2=1", bounds=BOX, measure=False)
    same = mp.sample("x^2+y^2+z^2=1", radius="0.6%", bounds=BOX, measure=False)
    np.testing.assert_array_equal(usual.points, same.points)


CASES = json.loads((Path(__file__).parents[2] / "tests/golden/code.json").read_text("utf-8"))
PRINTED = [case for case in CASES if case["programs"]["python"].startswith("import ")]


@pytest.mark.parametrize("case", PRINTED, ids=lambda case: " ".join(case["arguments"]))
def test_a_program_that_the_command_line_prints_makes_the_same_particles(case):
    names = {}
    exec(case["programs"]["python"], names)
    assert names["particles"].report["digest"] == case["digest"]


def test_adaptive_radii_follow_the_curvature():
    sample = mp.sample("x^2/9 + y^2 + z^2 = 1", count=2000, adaptive=True)
    assert sample.radii.max() > 1.5 * sample.radii.min()


def test_a_function_is_called_with_points_and_its_gradient_saves_calls():
    shapes, calls = set(), [0, 0]

    def counted(k):
        def value(points):
            shapes.add((points.dtype, points.ndim, points.shape[1], points.flags.c_contiguous))
            calls[k] += len(points)
            return sphere(points)

        return value

    by_differences = mp.sample(counted(0), count=500, bounds=BOX)
    given = mp.sample(
        counted(1),
        count=500,
        bounds=BOX,
        gradient=lambda points: points / np.maximum(sphere(points) + 1, 1e-9)[:, None],
    )
    assert shapes == {(np.dtype(np.float64), 2, 3, True)}
    for sample in (by_differences, given):
        np.testing.assert_allclose(np.linalg.norm(sample.points, axis=1), 1, atol=1e-4)
    assert calls[1] < calls[0] / 2


def test_a_function_may_keep_its_points_and_return_lists_integers_and_single_precision():
    kept, copies = [], []

    def value(points):
        kept.append(points)
        copies.append(points.copy())
        return (sphere(points) * 2**20).astype(np.int64).tolist()

    mp.sample(value, count=100, bounds=BOX)
    assert all(np.array_equal(*pair) for pair in zip(kept, copies))
    single = mp.sample(lambda p: sphere(p).astype(np.float32), count=100, bounds=BOX, measure=False)
    assert abs(len(single) - 100) <= 3


def test_nan_is_where_a_function_has_no_value():
    def upper_half(points):
        return np.where(points[:, 2] > 0, sphere(points), np.nan)

    sample = mp.sample(upper_half, count=500, bounds=BOX)
    assert sample.points[:, 2].min() > -1e-6


def test_a_model_goes_through_its_points():
    random = np.random.default_rng(0)
    points = random.normal(size=(2000, 3))
    points *= (np.array([3, 2, 2]) / np.linalg.norm(points, axis=1, keepdims=True))
    model = mp.fit_points(points, points / np.array([9, 4, 4]), centres=100)
    assert model.report["points"] == 2000 and model.report["normals"] == "given"
    assert np.all(np.array(model.bounds[0]) < -np.array([3, 2, 2]) + 0.1)
    sample = mp.sample(model, count=500)
    on_ellipsoid = np.sum((sample.points / np.array([3, 2, 2])) ** 2, axis=1)
    np.testing.assert_allclose(on_ellipsoid, 1, atol=0.02)
    assert mp.fit_points(points, centres=100).report["normals"] == "estimated"


def test_an_edge_has_rows_on_both_sides_and_is_welded():
    cube = mp.sample("max(|x|, |y|, |z|) = 1", count=1000)
    mesh = cube.mesh()
    assert len(cube.points) > len(mesh.points) == len(cube)
    assert edges_twice(mesh.faces) and not edges_twice(cube.faces)
    assert len(mesh.points) - 3 * len(mesh.faces) // 2 + len(mesh.faces) == 2
    np.testing.assert_array_equal(cube.points[mesh.rows], mesh.points)
    # Each face has the normal of its rows, and faces outward.
    a, b, c = (cube.points[cube.faces[:, k]] for k in range(3))
    facing = np.einsum("ij,ij->i", np.cross(b - a, c - a), cube.normals[cube.faces[:, 0]])
    assert (facing > 0).all()


def test_without_measuring_there_are_no_figures():
    measured, quick = (mp.sample("x^2+y^2+z^2=1", count=300, measure=m) for m in (True, False))
    assert measured.report["quality"]["six_neighbours"] > 0.5
    assert quick.report["quality"] is None
    np.testing.assert_array_equal(measured.points, quick.points)


def test_the_refined_method_gives_more_particles_six_neighbours():
    def six(method):
        return mp.sample("x^2+y^2/2+z^2=1", count=2000, method=method).report["quality"]["six_neighbours"]

    assert six("refined") > six("front")


def test_progress_rises_to_one():
    shares = []
    mp.sample("x^2+y^2+z^2=1", count=20_000, progress=shares.append)
    assert shares == sorted(shares) and len(shares) > 3 and shares[-1] == 1


def test_files_are_what_their_extensions_say(tmp_path):
    sample = mp.sample("x^2+y^2+z^2=1", count=200)
    sample.save(tmp_path / "ball.glb")
    sample.save(str(tmp_path / "ball.npy"))
    assert (tmp_path / "ball.glb").read_bytes()[:4] == b"glTF"
    np.testing.assert_array_equal(np.load(tmp_path / "ball.npy")[:, 3:], sample.normals)


def test_meshes_of_other_libraries():
    sample = mp.sample("max(|x|, |y|, |z|) = 1", count=500)
    trimesh = pytest.importorskip("trimesh")
    mesh = sample.to_trimesh()
    assert isinstance(mesh, trimesh.Trimesh)
    assert mesh.is_watertight and mesh.is_winding_consistent and abs(mesh.volume - 8) < 0.2


def test_a_mesh_of_pyvista():
    pyvista = pytest.importorskip("pyvista")
    data = mp.sample("max(|x|, |y|, |z|) = 1", count=500).to_pyvista()
    assert isinstance(data, pyvista.PolyData) and data.is_manifold
    assert data.point_data["radius"].shape == (data.n_points,)


def test_other_threads_go_on_while_a_formula_is_sampled():
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.monotonic()
    mp.sample("x^2+y^2+z^2=1", count=30_000)
    end = time.monotonic()
    done.set()
    thread.join()
    during = [t for t in ticks if begin < t < end]
    # Without the GIL for the whole run there would be no tick in it but at its ends.
    assert len(during) > 20 and max(np.diff(during)) < 0.5 * (end - begin)


def test_the_stub_has_the_signatures_of_the_package():
    stub = ast.parse((Path(mp.__file__).parent / "__init__.pyi").read_text())
    names = {node.name: node for node in stub.body if hasattr(node, "name")}
    # The types of reports have a module of their own.
    others = {"__version__", "Report", "ModelReport", "MeshChange"}
    assert set(mp.__all__) - others == set(names)
    for name in ("sample", "field", "fit_points"):
        arguments = names[name].args
        defaults = zip(arguments.kwonlyargs, arguments.kw_defaults)
        given = {argument.arg: ast.literal_eval(default) for argument, default in defaults}
        signature = inspect.signature(getattr(mp, name)).parameters.values()
        assert given == {p.name: p.default for p in signature if p.kind is p.KEYWORD_ONLY}
    for kind in ("Sample", "Field", "Model", "Mesh", "SampleWarning"):
        body = names[kind].body
        stated = {getattr(node, "name", None) or node.target.id for node in body}
        real = getattr(mp, kind)
        # Notebooks call what begins with `_repr_`.
        known = {name for name in vars(real) if name.startswith("_repr_") or not name.startswith("_")}
        known |= {"__len__"}
        # Those of a field are set when it is made.
        set_later = {"Field": {"bounds"}, "Model": {"bounds", "report", "warnings"}}
        fields = set(set_later.get(kind, ()))
        fields |= set(getattr(real, "_fields", ()))
        assert stated | {"__len__"} == known | fields


def test_the_package_is_marked_as_typed():
    assert (Path(mp.__file__).parent / "py.typed").exists()


def shape_of(kind, value, path="report"):
    """Checks a value of JSON against a type, down to its last member."""
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is typing.Union:
        if value is None:
            assert type(None) in arguments, path
            return
        (kind,) = (one for one in arguments if one is not type(None))
        shape_of(kind, value, path)
    elif origin is typing.Literal:
        assert value in arguments, (path, value)
    elif origin in (list, tuple):
        assert isinstance(value, list), path
        for k, item in enumerate(value):
            shape_of(arguments[0], item, f"{path}[{k}]")
    elif typing.is_typeddict(kind) if hasattr(typing, "is_typeddict") else hasattr(kind, "__total__"):
        members = typing.get_type_hints(kind)
        assert set(value) | {"calls"} == set(members) | {"calls"}, path
        for name, item in value.items():
            shape_of(members[name], item, f"{path}.{name}")
    else:
        assert isinstance(value, (int, float) if kind is float else kind), (path, value)


@pytest.mark.parametrize(
    ("field", "options"),
    [
        ("x^2 + y^2 + z^2 = 1", {}),
        ("x^2/9 + y^2 + z^2 = 1", {"adaptive": True, "count": 500}),
        ("max(abs(x), abs(y), abs(z)) = 1", {"method": "refined", "count": 800}),
        ("x^2 + y^2 = 1", {"count": 400}),
        (sphere, {"bounds": BOX, "count": 300}),
        ("x^2 + y^2 + z^2 = 1", {"measure": False, "count": 300}),
    ],
)
def test_the_report_has_the_members_of_its_type(field, options):
    shape_of(mp.Report, mp.sample(field, **options).report)


def test_the_reports_of_points_and_meshes_have_the_members_of_their_types():
    box = trimesh.creation.box((1, 2, 3))
    for points in (box.subdivide().subdivide(), box.sample(300)):
        shape_of(mp.ModelReport, mp.fit_points(points, centres=100).report)
    shape_of(mp.MeshChange, mp.remesh(box, count=500).change)


def test_every_setting_of_the_core_is_an_argument():
    from marching_particles._options import SETTINGS

    # The box is given by bounds, and points say where their surface ends.
    elsewhere = {"box", "beyond_points"}
    arguments = set(inspect.signature(mp.sample).parameters)
    assert {setting["argument"] for setting in SETTINGS} - elsewhere <= arguments


def test_a_shell_that_its_box_closes_is_a_solid():
    box = ((-3, -3, -3), (3, 3, 3))
    gyroid = "sin(x)cos(y) + sin(y)cos(z) + sin(z)cos(x)"
    solid = mp.sample(gyroid, count=2000, bounds=box, closed=True, thickness="0.4 + 0.02z")
    mesh = solid.mesh()
    assert edges_twice(mesh.faces) and np.abs(mesh.points).max() < 3 + 1e-6
    assert trimesh.Trimesh(mesh.points, mesh.faces, process=False).volume > 10


def test_solids_are_joined_from_a_list():
    balls = [
        lambda points, x=x: np.linalg.norm(points - [x, 0, 0], axis=1) - 1 for x in (0.0, 1.5, 3.0)
    ]
    box = ((-1.5, -1.5, -1.5), (4.5, 1.5, 1.5))
    row = mp.sample(mp.union(balls), count=3000, bounds=box)
    assert row.report["components"] == 1 and row.report["creases"] == 2
    np.testing.assert_array_equal(
        row.points, mp.sample(mp.union(*balls), count=3000, bounds=box).points
    )


def test_a_file_says_what_it_was_made_from(tmp_path):
    ball = mp.sample("x^2 + y^2 + z^2 = a", params={"a": 2}, count=300)
    for name, where in [("a.ply", "a.ply"), ("a.csv", "a.csv.json"), ("a.glb", "a.glb")]:
        ball.save(tmp_path / name)
        content = (tmp_path / where).read_bytes()
        assert b"marching_particles" in content and ball.report["digest"].encode() in content
    # Nobody can write a function down.
    mp.sample(sphere, bounds=BOX, count=300).save(tmp_path / "b.ply")
    assert b"marching_particles" not in (tmp_path / "b.ply").read_bytes()


def test_ply_is_of_points_or_of_the_mesh(tmp_path):
    ball = mp.sample("x^2 + y^2 + z^2 = 1", count=300)
    ball.save(tmp_path / "points.ply")
    ball.save(tmp_path / "mesh.ply", mesh=True)
    assert isinstance(trimesh.load(tmp_path / "points.ply"), trimesh.PointCloud)
    assert trimesh.load(tmp_path / "mesh.ply").is_watertight


def test_a_mesh_and_a_path_are_taken_for_points(tmp_path):
    sphere = trimesh.creation.icosphere(subdivisions=3)
    sphere.export(tmp_path / "ball.obj")
    for given in (sphere, tmp_path / "ball.obj", str(tmp_path / "ball.obj")):
        sample = mp.sample(mp.fit_points(given), count=400)
        assert abs(np.linalg.norm(sample.points, axis=1) - 1).max() < 0.02


def test_gaps_that_the_mesh_closes_are_none():
    tubes = "(x^2 + y^2 + z^2 - 2)^3 + 2000(x^2y^2 + x^2z^2 + y^2z^2) = 10"
    sample = mp.sample(tubes, count=5_000)
    assert sample.report["components"] == 1
    assert "open" not in [warning.code for warning in sample.warnings]


def test_an_open_surface_with_f_above_0_inside_faces_outward():
    # Its rim is a cusp, along which the mesh stays open.
    sample = mp.sample("y^2*(1 - (x^2 + z^2)) - (x^2 + z^2 + 2*y - 1)^2 = 0", count=8_000)
    mesh = trimesh.Trimesh(*sample.mesh()[::2], process=False)
    assert not mesh.is_watertight and mesh.volume > 0
    assert [warning.code for warning in sample.warnings].count("larger_inside") == 1


def test_a_spacing_is_a_share_of_the_diagonal_too():
    share, half = mp.sample("x^2 + y^2 + z^2 = 1", spacing="4%"), mp.sample("x^2 + y^2 + z^2 = 1", radius="2%")
    assert np.array_equal(share.points, half.points)
    with pytest.raises(ValueError, match="spacing must be a length, or a share"):
        mp.sample("x^2 + y^2 + z^2 = 1", spacing="z %")
