import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal, NamedTuple, SupportsFloat, SupportsIndex, Union

import numpy as np
import numpy.typing as npt

from ._report import MeshChange as MeshChange
from ._report import ModelReport as ModelReport
from ._report import Report as Report

__version__: str

_Corner = tuple[float, float, float]
_Function = Callable[[npt.NDArray[np.float64]], npt.ArrayLike]

class FormulaError(ValueError):
    message: str
    formula: str
    span: Union[tuple[int, int], None]
    suggestion: Union[str, None]
    choices: list[str]

class FieldError(ValueError): ...
class CannotFollow(ValueError): ...
class EmptySurface(ValueError): ...

class SampleWarning(NamedTuple):
    code: str
    severity: Literal["note", "caution", "fault"]
    message: str

class Mesh(NamedTuple):
    points: npt.NDArray[np.float64]
    normals: npt.NDArray[np.float32]
    faces: npt.NDArray[np.int32]
    rows: npt.NDArray[np.int32]

class Field:
    @property
    def bounds(self) -> Union[tuple[_Corner, _Corner], None]: ...

class Model(Field):
    @property
    def bounds(self) -> tuple[_Corner, _Corner]: ...
    @property
    def report(self) -> ModelReport: ...
    @property
    def warnings(self) -> list[str]: ...

class Image(Field):
    def __init__(
        self,
        array: Any,
        *,
        spacing: Union[float, Sequence[float], None] = None,
        origin: Union[Sequence[float], None] = None,
        affine: Union[npt.ArrayLike, None] = None,
        iso: Union[float, None] = None,
        label: Union[int, None] = None,
        smooth: Union[float, None] = None,
        inside: Literal["bright", "dark"] = "bright",
        border: Literal["open", "closed"] = "open",
    ) -> None: ...
    @property
    def bounds(self) -> tuple[_Corner, _Corner]: ...
    @property
    def iso(self) -> float: ...
    @property
    def smooth(self) -> float: ...
    @property
    def noise(self) -> float: ...
    @property
    def range(self) -> tuple[float, float]: ...
    @property
    def notes(self) -> list[str]: ...

class TriangleMesh(Field):
    def __init__(
        self,
        mesh: Any,
        *,
        edges: Union[Literal["auto"], float, None] = "auto",
        borders: Union[bool, None] = None,
        smooth: Union[float, None] = None,
        lines: Iterable[npt.ArrayLike] = (),
    ) -> None: ...
    @property
    def bounds(self) -> tuple[_Corner, _Corner]: ...
    @property
    def kind(self) -> Literal["part", "scan", "union"]: ...
    @property
    def repairs(self) -> list[str]: ...
    @property
    def border_edges(self) -> int: ...
    @property
    def border_loops(self) -> int: ...
    @property
    def notes(self) -> list[str]: ...
    def compare(self, mesh: Any) -> MeshChange: ...

def remesh(
    mesh: Any,
    *,
    edges: Union[Literal["auto"], float, None] = "auto",
    borders: Union[bool, None] = None,
    smooth: Union[float, None] = None,
    lines: Iterable[npt.ArrayLike] = (),
    count: Union[SupportsIndex, None] = None,
    spacing: Union[SupportsFloat, str, _Function, Field, None] = None,
    radius: Union[_Size, None] = None,
    bounds: Union[Sequence[Sequence[float]], npt.NDArray[Any], None] = None,
    adaptive: bool = False,
    law: Union[Literal["chord_error", "max_curvature", "sum_of_curvatures"], None] = None,
    chord_error: Union[_Size, None] = None,
    curvature_scale: Union[SupportsFloat, None] = None,
    radius_min: Union[_Size, None] = None,
    radius_max: Union[_Size, None] = None,
    grading: Union[SupportsFloat, None] = None,
    method: Literal["front", "refined"] = "front",
    pattern: Union[Literal["hexagonal", "blue", "random"], None] = None,
    exactly: bool = False,
    relax: Union[SupportsIndex, None] = None,
    match_tolerance: Union[SupportsFloat, None] = None,
    gaps: Union[Literal["fill", "leave"], None] = None,
    seed: SupportsIndex = 0,
    max_particles: Union[SupportsIndex, None] = None,
    values: Union[Mapping[str, Union[str, _Function, Field]], None] = None,
    measure: bool = True,
    progress: Union[Callable[[float], object], None] = None,
) -> Sample: ...

class Sample:
    def __len__(self) -> int: ...
    @property
    def points(self) -> npt.NDArray[np.float64]: ...
    @property
    def normals(self) -> npt.NDArray[np.float32]: ...
    @property
    def radii(self) -> npt.NDArray[np.float32]: ...
    @property
    def levels(self) -> npt.NDArray[np.int32]: ...
    @property
    def identities(self) -> npt.NDArray[np.int32]: ...
    @property
    def values(self) -> dict[str, npt.NDArray[np.float32]]: ...
    @property
    def faces(self) -> npt.NDArray[np.int32]: ...
    @property
    def report(self) -> Report: ...
    @property
    def warnings(self) -> list[SampleWarning]: ...
    @property
    def mesh_warnings(self) -> list[SampleWarning]: ...
    @property
    def bounds(self) -> tuple[_Corner, _Corner]: ...
    @property
    def change(self) -> Union[MeshChange, None]: ...
    def mesh(self) -> Mesh: ...
    def moved(
        self,
        field: Union[_Surface, None] = None,
        *,
        params: Union[Mapping[str, float], None] = None,
        gradient: Union[_Function, None] = None,
        progress: Union[Callable[[float], object], None] = None,
    ) -> Sample: ...
    def _repr_png_(self) -> bytes: ...
    def save(self, path: Union[str, os.PathLike[str]], *, mesh: bool = False) -> None: ...
    # The libraries of these are optional, and some have no types.
    def to_trimesh(self) -> Any: ...
    def to_pyvista(self) -> Any: ...
    def to_meshio(self) -> Any: ...

_Surface = Union[str, _Function, Field]

# A length, or a share of the diagonal of the box such as "1%".
_Size = Union[SupportsFloat, str]

def sample(
    field: _Surface,
    *,
    count: Union[SupportsIndex, None] = None,
    spacing: Union[SupportsFloat, str, _Function, Field, None] = None,
    radius: Union[_Size, None] = None,
    bounds: Union[Sequence[Sequence[float]], npt.NDArray[Any], None] = None,
    params: Union[Mapping[str, float], None] = None,
    gradient: Union[_Function, None] = None,
    adaptive: bool = False,
    law: Union[Literal["chord_error", "max_curvature", "sum_of_curvatures"], None] = None,
    chord_error: Union[_Size, None] = None,
    curvature_scale: Union[SupportsFloat, None] = None,
    radius_min: Union[_Size, None] = None,
    radius_max: Union[_Size, None] = None,
    grading: Union[SupportsFloat, None] = None,
    closed: bool = False,
    periodic: bool = False,
    thickness: Union[SupportsFloat, str, None] = None,
    method: Literal["front", "refined"] = "front",
    pattern: Union[Literal["hexagonal", "blue", "random"], None] = None,
    exactly: bool = False,
    relax: Union[SupportsIndex, None] = None,
    match_tolerance: Union[SupportsFloat, None] = None,
    gaps: Union[Literal["fill", "leave"], None] = None,
    seed: SupportsIndex = 0,
    max_particles: Union[SupportsIndex, None] = None,
    values: Union[Mapping[str, Union[str, _Function, Field]], None] = None,
    measure: bool = True,
    progress: Union[Callable[[float], object], None] = None,
) -> Sample: ...
def field(
    field: _Surface,
    *,
    params: Union[Mapping[str, float], None] = None,
    gradient: Union[_Function, None] = None,
) -> Field: ...
def piecewise(label: _Function, pieces: Sequence[_Function]) -> Field: ...
def union(*solids: Union[_Surface, Sequence[_Surface]]) -> Field: ...
def intersection(*solids: Union[_Surface, Sequence[_Surface]]) -> Field: ...
def difference(a: _Surface, b: _Surface) -> Field: ...
def smooth_union(a: _Surface, b: _Surface, width: float) -> Field: ...
def offset(a: _Surface, distance: float) -> Field: ...
def fit_points(
    # An array, the path of a file, or a mesh of trimesh or PyVista.
    points: Any,
    normals: Union[npt.ArrayLike, None] = None,
    *,
    centres: int = 200,
    beyond_points: Literal["cut", "kept"] = "cut",
) -> Model: ...
