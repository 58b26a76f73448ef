"""Three-dimensional images as fields."""

import pickle
from types import SimpleNamespace

import marching_particles as mp
import numpy as np
import pytest


def ball(shape=(30, 28, 26), middle=(14.2, 13.1, 12.4), radius=9.0):
    indices = np.indices(shape).reshape(3, -1).T
    return (radius - np.linalg.norm(indices - middle, axis=1)).reshape(shape)


def distances(sample, middle):
    return np.linalg.norm(sample.points - middle, axis=1)


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("dtype", ["<f4", ">f8", "float16", "int16"])
def test_array_is_indexed_by_x_y_and_z(order, dtype):
    voxels = np.asarray(100 * ball(), dtype=dtype, order=order)
    sample = mp.sample(mp.Image(voxels, iso=0, smooth=0), count=500)
    assert np.abs(distances(sample, (14.2, 13.1, 12.4)) - 9).max() < 0.05
    assert sample.report["components"] == 1


def test_affine_places_the_image():
    affine = np.array([[0, -0.5, 0, 3], [0.5, 0, 0, -2], [0, 0, 0.5, 7], [0, 0, 0, 1]])
    middle = affine[:3] @ [14.2, 13.1, 12.4, 1]
    image = mp.Image(ball(), affine=affine, iso=0, smooth=0)
    assert np.abs(distances(mp.sample(image, count=500), middle) - 4.5).max() < 0.03
    same = mp.Image(SimpleNamespace(dataobj=ball(), affine=affine), iso=0, smooth=0)
    assert np.allclose(same.bounds, image.bounds)
    spaced = mp.Image(ball(), spacing=(0.5, 0.5, 0.5), origin=(1, 2, 3), iso=0, smooth=0)
    assert np.abs(distances(mp.sample(spaced, count=500), [8.1, 8.55, 9.2]) - 4.5).max() < 0.03


@pytest.mark.parametrize("order", ["C", "F"])
def test_spacings_are_along_the_axes_of_the_array(order):
    i, j, k = np.indices((30, 24, 9))
    voxels = 8 - np.sqrt((i - 14.2) ** 2 + (j - 11.3) ** 2 + (3 * (k - 4.1)) ** 2)
    voxels = np.asarray(voxels, order=order)
    image = mp.Image(voxels, spacing=(1, 1, 3), iso=0, smooth=0)
    assert np.abs(distances(mp.sample(image, count=500), (14.2, 11.3, 12.3)) - 8).max() < 0.2
    voxels[3, 2, 1] = np.nan
    with pytest.raises(ValueError, match=r"\(3, 2, 1\)"):
        mp.Image(voxels, spacing=(1, 1, 3))


def test_a_surface_that_the_border_cuts_can_be_closed():
    rod = 7 - np.linalg.norm(np.indices((30, 28, 16))[:2] - np.reshape((14.2, 13.1), (2, 1, 1, 1)), axis=0)
    opened = mp.sample(mp.Image(rod, iso=0, smooth=0), count=800)
    closed = mp.sample(mp.Image(rod, iso=0, smooth=0, border="closed"), count=800)
    assert [own.report["quality"]["euler"] for own in (opened, closed)] == [0, 2]
    assert abs(opened.points[:, 2].max() - 15) < 1e-3
    assert abs(closed.points[:, 2].max() - 15.5) < 0.1


def test_coordinates_of_xarray_place_the_image():
    shape = (26, 28, 30)
    places = {"z": 10 + 2 * np.arange(26), "y": -np.arange(28.0), "x": np.arange(30) / 2}
    coords = {name: SimpleNamespace(values=place) for name, place in places.items()}
    array = SimpleNamespace(
        values=ball().transpose(), dims=("z", "y", "x"), coords=coords, sizes=dict(zip("zyx", shape))
    )
    low, high = mp.Image(array, iso=0, smooth=0).bounds
    middle = np.add(low, high) / 2
    assert np.abs(middle - [7.1, -13.1, 10 + 2 * 12.4]).max() < 1


def test_labels_and_iso_are_chosen():
    labels = (ball() > 0) * 3
    image = mp.Image(labels, label=3)
    assert image.smooth == 1
    sample = mp.sample(image, count=500)
    assert np.abs(distances(sample, (14.2, 13.1, 12.4)) - 9).max() < 0.7
    values = 1000 / (1 + np.exp(-ball()))
    # Otsu's value by every cut between two values; that of the image lies in a bin, of 256.
    ordered = np.sort(values, axis=None)
    below = np.arange(1, ordered.size)
    sums = np.cumsum(ordered)
    apart = sums[:-1] / below - (sums[-1] - sums[:-1]) / (ordered.size - below)
    cut = np.argmax(below * (ordered.size - below) * apart**2)
    assert abs(mp.Image(values).iso - ordered[cut : cut + 2].mean()) < 1000 / 256
    with pytest.raises(ValueError, match="those of the image are 0, 3"):
        mp.Image(labels, label=2)


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: mp.Image(np.zeros((4, 4))), ValueError, "three axes"),
        (lambda: mp.Image(np.zeros((4, 4, 4))), ValueError, "have the value 0"),
        (lambda: mp.Image(np.full((4, 4, 4), "a")), TypeError, "type"),
        (lambda: mp.Image(np.full((4, 4, 4), np.nan)), ValueError, "not finite"),
        (lambda: mp.Image(ball(), iso=99), ValueError, "outside"),
        (lambda: mp.Image(ball(), iso=1, label=1), TypeError, "not both"),
        (lambda: mp.Image(ball(), affine=np.zeros((3, 4))), ValueError, "plane"),
        (lambda: mp.Image(ball(), affine=np.eye(2)), ValueError, "shape"),
        (lambda: mp.Image(ball(), inside="left"), ValueError, "bright"),
        (lambda: mp.Image(ball(), border="shut"), ValueError, "closed"),
    ],
)
def test_wrong_images_are_refused(make, error, words):
    with pytest.raises(error, match=words):
        make()


def test_a_file_is_read_by_its_path(tmp_path):
    path = tmp_path / "ball.npy"
    np.save(path, ball())
    image = mp.Image(path, iso=0, smooth=0)
    assert repr(image) == "<Image of ball.npy at 0>"
    again = pickle.loads(pickle.dumps(image))
    of_array = mp.Image(ball(), iso=0, smooth=0)
    points = [mp.sample(one, count=300).points for one in (image, again, of_array)]
    assert np.array_equal(points[0], points[1]) and np.array_equal(points[0], points[2])
    with pytest.raises(TypeError, match="a file says where its voxels lie"):
        mp.Image(path, spacing=2)
    with pytest.raises(FileNotFoundError, match="none.nii"):
        mp.Image(tmp_path / "none.nii")
    (tmp_path / "notes.txt").write_text("no image")
    with pytest.raises(ValueError):
        mp.Image(tmp_path / "notes.txt")
