import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, NamedTuple, Union

import numpy as np
import numpy.typing as npt
import pyvista
import trimesh

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
class EmptySurface(ValueError): ...

class Warning(NamedTuple):
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
    def report(self) -> dict[str, Any]: ...
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
    def faces(self) -> npt.NDArray[np.int32]: ...
    @property
    def report(self) -> dict[str, Any]: ...
    @property
    def warnings(self) -> list[Warning]: ...
    @property
    def mesh_warnings(self) -> list[Warning]: ...
    @property
    def bounds(self) -> tuple[_Corner, _Corner]: ...
    def weld(self) -> Mesh: ...
    def save(self, path: Union[str, os.PathLike[str]]) -> None: ...
    def to_trimesh(self) -> trimesh.Trimesh: ...
    def to_pyvista(self) -> pyvista.PolyData: ...

_Surface = Union[str, _Function, Field]

def sample(
    field: _Surface,
    *,
    count: Union[int, None] = None,
    radius: Union[float, str, None] = None,
    spacing: Union[float, None] = None,
    bounds: Union[Sequence[Sequence[float]], npt.NDArray[Any], None] = None,
    params: Union[Mapping[str, float], None] = None,
    gradient: Union[_Function, None] = None,
    adaptive: bool = False,
    method: Literal["front", "refined"] = "front",
    seed: int = 0,
    measure: bool = True,
    progress: Union[Callable[[float], object], None] = None,
) -> Sample: ...
def field(
    field: _Surface,
    *,
    params: Union[Mapping[str, float], None] = None,
    gradient: Union[_Function, None] = None,
) -> Field: ...
def union(a: _Surface, b: _Surface) -> Field: ...
def intersection(a: _Surface, b: _Surface) -> Field: ...
def difference(a: _Surface, b: _Surface) -> Field: ...
def smooth_union(a: _Surface, b: _Surface, width: float) -> Field: ...
def offset(a: _Surface, distance: float) -> Field: ...
def fit_points(
    points: npt.ArrayLike,
    normals: Union[npt.ArrayLike, None] = None,
    *,
    centres: int = 200,
    beyond_points: Literal["cut", "kept"] = "cut",
) -> Model: ...
