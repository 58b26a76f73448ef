"""Reports as types: the members of ``Sample.report``, ``Model.report`` and ``Sample.change``.

They are those of the library's ``Report``, ``ModelInfo`` and ``MeshChange``, which document each.
"""

from __future__ import annotations

from typing import Literal, TypedDict, Union


_StopReason = Literal[
    "complete", "cancelled", "cap", "no_surface", "constant", "undefined", "one_particle"
]


class ReportWarning(TypedDict):
    code: str
    severity: Literal["note", "caution", "fault"]
    message: str


class FateCounts(TypedDict):
    added: int
    matched: int
    not_converged: int
    outside: int
    undefined: int
    capped: int


class Unsampled(TypedDict):
    position: tuple[float, float, float]
    reach: float
    goes_on: bool


class Sampled(TypedDict):
    above: Union[float, None]
    missing: Union[int, None]
    without: list[Unsampled]


class Figures(TypedDict):
    ideal_spacing: Union[float, None]
    area: Union[float, None]
    duplicates: int
    not_finite: int
    boundary_excluded: int
    error_max: Union[float, None]
    error_mean: Union[float, None]
    undefined: int
    normal_error_mean: Union[float, None]
    normal_error_max: Union[float, None]
    nearest_min: Union[float, None]
    nearest_mean: Union[float, None]
    spacing_variation: Union[float, None]
    nearest_ratio: Union[float, None]
    rho: Union[float, None]
    nearest_percentile_1: Union[float, None]
    crowded: Union[int, None]
    cover: Union[float, None]
    cover_local: Union[float, None]
    quantization_error: Union[float, None]
    uncovered: Union[float, None]
    wide_holes: Union[int, None]
    six_neighbours: Union[float, None]
    five_or_seven_neighbours: Union[float, None]
    valence_deviation: Union[float, None]
    open: int
    bond_order: Union[float, None]
    edge_variation: Union[float, None]
    size_variation: Union[float, None]
    overlap_min: Union[float, None]
    triangle_share: Union[float, None]
    agree: Union[float, None]
    euler: int
    components: int
    smallest_angle: Union[float, None]
    mean_smallest_angle: Union[float, None]
    triangles_below_30: Union[float, None]
    triangles_above_90: Union[float, None]
    angles_below_30: Union[float, None]
    angles_above_90: Union[float, None]


class Histogram(TypedDict):
    min: float
    max: float
    bins: list[int]


class Pair(TypedDict):
    particles: tuple[int, int]
    ratio: float


class Hole(TypedDict):
    position: tuple[float, float, float]
    radius: float
    ratio: float


class Places(TypedDict):
    pairs: list[Pair]
    holes: list[Hole]


class _Calls(TypedDict, total=False):
    # Only for functions.
    calls: int


class Report(_Calls):
    count: int
    volume: Union[float, None]
    inside: Union[Literal["f < 0", "f > 0", "f < 0, f > 0"], None]
    smallest_angle: Union[float, None]
    pairs: Union[int, None]
    border: int
    cut: Union[Literal["endless", "fixed", "outgrown"], None]
    stop_reason: Union[_StopReason, None]
    warnings: list[ReportWarning]
    digest: str
    radius: float
    radius_min: float
    radius_max: float
    levels: int
    level_counts: list[int]
    components_seeded: int
    gaps_filled: int
    fates: FateCounts
    evaluations: int
    evaluations_per_particle: float
    refined_levels: Union[int, None]
    energy: Union[list[float], None]
    components: Union[int, None]
    search: Literal["proven", "searched"]
    sampled: Sampled
    undecided_cells: Union[int, None]
    singular_points: Union[int, None]
    creases: Union[int, None]
    corners: Union[int, None]
    edges_found: Union[str, None]
    seams: Union[int, None]
    quality: Union[Figures, None]
    quality_before: Union[Figures, None]
    nearest_histogram: Histogram
    places: Places


class GivenTopology(TypedDict):
    components: int
    euler: int
    borders: int


class GivenMesh(TypedDict):
    area: float
    topology: Union[GivenTopology, None]


class ModelReport(TypedDict):
    name: str
    credit: str
    points: int
    centres: int
    condition: float
    residual_mean: float
    residual_95: float
    residual_max: float
    farthest: tuple[float, float, float]
    mesh: Union[GivenMesh, None]
    beyond_share: float
    normals: Literal["given", "from_mesh", "estimated"]
    warnings: list[str]


class MeshDistances(TypedDict):
    mean: float
    most: float
    largest: float


class MeshChange(TypedDict):
    diagonal: float
    to_new: MeshDistances
    to_old: MeshDistances
    volume: tuple[float, float]
    area: tuple[float, float]
    edges: Union[float, None]
