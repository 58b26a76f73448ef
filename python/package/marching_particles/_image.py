"""Three-dimensional images as fields."""

import json
import os
import sys
from functools import partial

import numpy as np

from . import _core
from ._fields import Field, numbers

_TYPES = {"float16": "float32", "bool": "uint8", "longdouble": "float64"}


class Image(Field):
    """The surface in a three-dimensional image, to be given to :func:`sample`.

    It is the surface on which a cubic spline through all voxels has the value ``iso``, or the
    smoothed boundary of a label. Brighter voxels are inside.

    >>> import numpy as np
    >>> import marching_particles as mp
    >>> i, j, k = np.ogrid[:32, :32, :32]
    >>> ball = 10 - np.sqrt((i - 15.5) ** 2 + (j - 15.5) ** 2 + (k - 15.5) ** 2)
    >>> mp.sample(mp.Image(ball, iso=0, spacing=0.5), count=500).report["components"]
    1

    Args:
        array: Array of three axes, whose value ``array[i, j, k]`` lies at the point to which the
            affine map brings (i, j, k); whole numbers or floats. Or an image of nibabel, SimpleITK
            or xarray, which knows where it lies; or the path of a file: NIfTI, NRRD, NumPy,
            MetaImage, Gaussian cube or TIFF. To be pickled the array is kept, so do not change it,
            and of a file its path.
        spacing: Distances between voxels along the axes, or one for all of them.
        origin: The point of ``array[0, 0, 0]``.
        affine: Array (3, 4) or (4, 4) that maps (i, j, k, 1) to a point, in place of spacing and
            origin.
        iso: Value of the voxels on the surface; by default Otsu's, which separates dark from bright
            ones best.
        label: Whole number whose voxels are inside, in place of ``iso``.
        smooth: Width of a Gaussian in voxels: against noise, by default from 0.7 to 2 or 0, by the
            noise that is measured and the rounding of whole numbers; over the distances from a
            label by default the root mean square of the distances between voxels, 1 for cubes.
        inside: ``"bright"`` or ``"dark"``: which voxels are inside.
        border: ``"open"`` or ``"closed"``: whether a surface that the border of the image cuts ends
            there with a rim, or is closed half a voxel beyond the outermost centres.

    Attributes:
        bounds: The box of the surface, ``((x0, y0, z0), (x1, y1, z1))``.
        iso: The value on the surface.
        smooth: Width of the Gaussian in voxels, 0 without one.
        noise: Standard deviation of the noise, in the values of the voxels.
        range: Smallest and largest value.
        notes: Sentences on what was decided.

    Raises:
        TypeError: If the array is none of numbers.
        ValueError: If the array has no three axes, is constant or not finite, or has no surface of
            this value; or if a file is damaged, or none of these.
        OSError: If the file cannot be read.
    """

    def __init__(
        self,
        array,
        *,
        spacing=None,
        origin=None,
        affine=None,
        iso=None,
        label=None,
        smooth=None,
        inside="bright",
        border="open",
    ):
        if inside not in ("bright", "dark"):
            raise ValueError(f'inside is "bright" or "dark", and not {inside!r}')
        if border not in ("open", "closed"):
            raise ValueError(f'border is "open" or "closed", and not {border!r}')
        if iso is not None and label is not None:
            raise TypeError("give an iso value or a label, and not both")
        choice = (
            None if iso is None else float(iso),
            None if label is None else float(label),
            None if smooth is None else float(smooth),
            inside == "dark",
            border == "closed",
        )
        if isinstance(array, (str, os.PathLike)):
            if any(value is not None for value in (spacing, origin, affine)):
                raise TypeError("a file says where its voxels lie: leave out spacing, origin and affine")
            array = os.path.abspath(array)
            with open(array, "rb"):  # A file that is missing is named.
                field, known = _core.Field.image_file(array, *choice)
            what = os.path.basename(array)
        else:
            voxels, own = _voxels(array)
            rows = _rows(spacing, origin, affine, own)
            order = "F" if voxels.flags.f_contiguous else "C"
            flat = voxels.ravel(order=order).view(np.uint8)
            layout = (voxels.dtype.name, voxels.shape, order == "C", rows.tolist())
            field, known = _core.Field.image(flat, *layout, *choice)
            what = f"{' × '.join(map(str, voxels.shape))} voxels"
        how = {"spacing": spacing, "origin": origin, "affine": affine, "iso": iso, "label": label}
        how.update(smooth=smooth, inside=inside, border=border)
        super().__init__(field, partial(Image, array, **how))
        known = json.loads(known)
        self.iso = known["iso"]
        self.smooth = known["smooth"]
        self.noise = known["noise"]
        self.range = tuple(known["range"])
        self.notes = known["notes"]
        self._what = what

    def __repr__(self):
        return f"<Image of {self._what} at {self.iso:g}>"


def _voxels(image):
    """The array of an image, and its affine map where it knows one."""
    own = None
    if hasattr(image, "dataobj") and hasattr(image, "affine"):  # nibabel
        array, own = np.asanyarray(image.dataobj), np.asarray(image.affine, dtype=np.float64)
    elif hasattr(image, "GetSpacing") and hasattr(image, "GetDirection"):  # SimpleITK
        module = sys.modules[type(image).__module__.split(".")[0]]
        array = np.transpose(module.GetArrayViewFromImage(image))
        own = np.eye(4)
        own[:3, :3] = np.reshape(image.GetDirection(), (3, 3)) * np.asarray(image.GetSpacing())
        own[:3, 3] = image.GetOrigin()
    elif hasattr(image, "dims") and hasattr(image, "coords"):  # xarray
        array, own = np.asarray(image.values), _of_coordinates(image)
    else:
        array = np.asanyarray(image)
    if array.dtype.kind not in "biuf":
        raise TypeError(f"the voxels are of the type {array.dtype}: give whole numbers or floats")
    if array.ndim == 4:
        array = array[..., 0]
    if array.ndim != 3:
        raise ValueError(f"the array has the shape {array.shape}: an image has three axes")
    name = array.dtype.name
    return array.astype(np.dtype(_TYPES.get(name, name)), copy=False), own


def _of_coordinates(image):
    """The affine map of an array of xarray, by its coordinates of even steps."""
    own = np.eye(4)
    names = [str(name).lower() for name in image.dims[:3]]
    is_named = sorted(names) == ["x", "y", "z"]
    for axis, name in enumerate(image.dims[:3]):
        row = "xyz".index(names[axis]) if is_named else axis
        own[:3, axis] = 0
        step, first = 1.0, 0.0
        if name in image.coords and image.sizes[name] > 1:
            places = np.asarray(image.coords[name].values, dtype=np.float64)
            steps = np.diff(places)
            step, first = float(steps.mean()), float(places[0])
            if np.ptp(steps) > 1e-3 * abs(step):
                raise ValueError(f"the coordinates along {name} are not evenly spaced: interpolate first")
        own[row, axis] = step
        own[row, 3] = first
    return own


def _rows(spacing, origin, affine, own):
    """The first three rows of the affine map."""
    if affine is not None:
        if spacing is not None or origin is not None:
            raise TypeError("affine takes the place of spacing and origin: give one or the other")
        affine = np.asarray(affine, dtype=np.float64)
        if affine.shape not in ((3, 4), (4, 4)):
            raise ValueError(f"affine has the shape {affine.shape}: it must be (3, 4) or (4, 4)")
        return affine[:3]
    rows = (np.eye(4) if own is None else own)[:3].copy()
    if spacing is not None:
        lengths = np.linalg.norm(rows[:, :3], axis=0)
        rows[:, :3] *= numbers("spacing", np.broadcast_to(spacing, (3,)), (3,), "three distances") / lengths
    if origin is not None:
        rows[:, 3] = numbers("origin", origin, (3,), "a point, three numbers")
    return rows
