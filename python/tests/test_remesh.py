"""Triangle meshes, sampled anew."""

import pickle

import marching_particles as mp
import numpy as np
import pytest
import trimesh


def test_box_keeps_its_edges(tmp_path):
    box = trimesh.creation.box((1, 2, 3))
    path = tmp_path / "box.stl"
    box.export(path)
    for given in (box, path, (box.vertices, box.faces)):
        sample = mp.remesh(given, count=2000)
        new = sample.to_trimesh()
        assert new.is_watertight and new.euler_number == 2
        assert new.volume == pytest.approx(6, rel=1e-6)
        assert sample.report["creases"] == 12
        assert sample.change["edges"] < 1e-6 and sample.change["volume"] == pytest.approx([6, 6])
        beyond = np.abs(new.vertices) - np.array([0.5, 1, 1.5])
        assert np.abs(beyond.max(axis=1)).max() < 1e-6, "each vertex lies on a face"


def test_scene_of_a_glb_is_read_as_its_nodes_place_it(tmp_path):
    scene = trimesh.Scene()
    turn = trimesh.transformations.rotation_matrix(0.7, (1, 2, 3))
    move = trimesh.transformations.translation_matrix((4, 5, 6))
    scene.add_geometry(trimesh.creation.box((1, 2, 3)), transform=move @ turn)
    mirror = np.diag([-2.0, 2.0, 2.0, 1.0])
    scene.add_geometry(trimesh.creation.box((1, 1, 1)), transform=mirror)
    path = tmp_path / "scene.glb"
    scene.export(path)
    sample = mp.remesh(path, count=4000)
    # The y axis of glTF points up, and z does here.
    expected = scene.to_geometry().apply_transform([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    new = sample.to_trimesh()
    assert new.is_watertight and new.body_count == 2
    assert new.volume == pytest.approx(14, rel=1e-6)
    assert new.bounds == pytest.approx(expected.bounds, abs=1e-5)


def test_spacing_is_that_of_the_neighbours():
    sample = mp.remesh(trimesh.creation.box((1, 1, 1)), spacing=0.05)
    new = sample.to_trimesh()
    assert np.median(new.edges_unique_length) == pytest.approx(0.05, rel=0.1)


def test_smooth_mesh_is_a_scan():
    ball = trimesh.creation.icosphere(4)
    model = mp.TriangleMesh(ball)
    assert model.kind == "scan" and model.repairs == []
    new = mp.remesh(model, count=3000).to_trimesh()
    assert new.is_watertight and new.euler_number == 2
    assert np.abs(np.linalg.norm(new.vertices, axis=1) - 1).max() < 5e-3


def test_open_surface_ends_at_its_border():
    n, m = 64, 20
    turn, rise = np.meshgrid(2 * np.pi * np.arange(n) / n, np.linspace(0, np.pi / 2, m + 1))
    ball = np.stack([np.cos(turn) * np.cos(rise), np.sin(turn) * np.cos(rise), np.sin(rise)], axis=-1)
    at = np.arange(n * m)
    beside = at // n * n + (at + 1) % n
    faces = np.vstack([np.column_stack([at, beside, beside + n]), np.column_stack([at, beside + n, at + n])])
    model = mp.TriangleMesh((ball.reshape(-1, 3), faces))
    assert (model.kind, model.border_edges, model.border_loops) == ("part", n, 1)
    new = mp.remesh(model, count=4000, method="refined").to_trimesh()
    border = new.vertices[np.unique(new.edges[trimesh.grouping.group_rows(new.edges_sorted, 1)])]
    assert new.euler_number == 1 and np.abs(border[:, 2]).max() < 1e-4
    assert np.abs(np.linalg.norm(new.vertices, axis=1) - 1).max() < 1e-3
    assert new.area == pytest.approx(2 * np.pi, rel=1e-3)


def test_mesh_is_an_operand():
    box = mp.TriangleMesh(trimesh.creation.box((2, 2, 1)))
    drilled = mp.difference(box, "x^2 + y^2 - 0.25")
    new = mp.sample(drilled, count=3000, method="refined").to_trimesh()
    assert new.is_watertight and new.euler_number == 0
    assert new.volume == pytest.approx(4 - np.pi / 4, rel=2e-3)


def test_what_cannot_be_sampled_is_refused():
    flat = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
    with pytest.raises(ValueError, match="folded flat"):
        mp.remesh((flat, [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]), count=500)
    with pytest.raises(TypeError, match="borders must be True, False or None"):
        mp.TriangleMesh((flat, [[0, 1, 2]]), borders="keep")
    with pytest.raises(ValueError, match="beyond the 3 vertices"):
        mp.remesh(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]]), count=500)
    with pytest.raises(TypeError, match="a mesh of trimesh or PyVista"):
        mp.remesh(7, count=500)


def test_colours_of_the_old_mesh_are_values_at_the_new_particles():
    box = trimesh.creation.box((1, 1, 1))
    box.visual.vertex_colors = np.rint(255 * (box.vertices + 0.5)).astype(np.uint8)
    sample = mp.remesh(box, count=500, values={"height": "z"})
    colour = np.column_stack([sample.values[name] for name in ("red", "green", "blue")])
    assert np.abs(colour - (sample.points + 0.5)).max() < 1e-5
    assert np.allclose(sample.values["height"], sample.points[:, 2])
    again = pickle.loads(pickle.dumps(sample))
    assert np.array_equal(again.values["red"], sample.values["red"])
    assert not mp.remesh((box.vertices, box.faces), count=500).values


def test_edges_along_lines_are_kept():
    prism = trimesh.creation.cylinder(radius=1, height=2, sections=24)
    angles = np.arctan2(prism.vertices[:, 1], prism.vertices[:, 0])
    is_on = [(np.abs(angles - angle) < 0.01) & (np.hypot(*prism.vertices.T[:2]) > 0.9) for angle in (0, np.pi / 2)]
    lines = [prism.vertices[own] for own in is_on]
    assert all(line.shape == (2, 3) for line in lines)
    plain, marked = (mp.remesh(prism, count=1500, lines=given) for given in ((), lines))
    assert (plain.report["creases"], marked.report["creases"]) == (2, 6)
    with pytest.raises(ValueError, match="lines"):
        mp.remesh(prism, lines=[[1, 2, 3]])
