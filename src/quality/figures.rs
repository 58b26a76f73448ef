//! The record of all figures.

use crate::math::SQRT_3;
use serde::Serialize;

/// A figure that is not defined, or not yet measured.
const NONE: f64 = f64::NAN;

/// The figures of a set of particles, one number per property; NaN (null in JSON) where undefined.
/// Lengths are over `ideal_spacing` unless said otherwise. JSON has all figures side by side.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Figures {
    /// Spacing of a perfect hexagonal lattice of as many points on the same area, √(2A/(√3 N)), in
    /// the field's units.
    pub ideal_spacing: f64,
    /// Area, as given or of the triangles found, in the field's units.
    pub area: f64,
    /// Points that differ from an earlier one by no more than rounding; dropped before the
    /// triangulation.
    pub duplicates: usize,
    /// Points with a non-finite coordinate; left out of everything.
    pub not_finite: usize,
    /// Points within 4 ideal spacings of the border of a clipped surface, left out of the per-point
    /// figures.
    pub boundary_excluded: usize,
    /// Errors of the points and of their normals.
    #[serde(flatten)]
    pub accuracy: Accuracy,
    /// Distances of the points from their nearest ones.
    #[serde(flatten)]
    pub spacing: Spacing,
    /// Holes between the points.
    #[serde(flatten)]
    pub coverage: Coverage,
    /// Valences of the points, and their six-fold order.
    #[serde(flatten)]
    pub order: Order,
    /// Lengths of the edges between natural neighbours.
    #[serde(flatten)]
    pub edges: Edges,
    /// Triangles of natural neighbours, and the topology that they show.
    #[serde(flatten)]
    pub connectivity: Connectivity,
    /// Angles of the triangles.
    #[serde(flatten)]
    pub angles: Angles,
}

impl Default for Figures {
    fn default() -> Self {
        Self {
            ideal_spacing: NONE,
            area: NONE,
            duplicates: 0,
            not_finite: 0,
            boundary_excluded: 0,
            accuracy: Accuracy {
                error_max: NONE,
                error_mean: NONE,
                undefined: 0,
                normal_error_mean: NONE,
                normal_error_max: NONE,
            },
            spacing: Spacing {
                nearest_min: NONE,
                nearest_mean: NONE,
                spacing_variation: NONE,
                nearest_ratio: NONE,
                rho: NONE,
                nearest_percentile_1: NONE,
                crowded: None,
            },
            coverage: Coverage {
                cover: NONE,
                cover_local: NONE,
                quantization_error: NONE,
                uncovered: NONE,
                wide_holes: None,
            },
            order: Order {
                six_neighbours: NONE,
                five_or_seven_neighbours: NONE,
                valence_deviation: NONE,
                open: 0,
                bond_order: NONE,
            },
            edges: Edges { edge_variation: NONE, size_variation: NONE, overlap_min: NONE },
            connectivity: Connectivity { triangle_share: NONE, agree: NONE, euler: 0, components: 0 },
            angles: Angles {
                smallest_angle: NONE,
                mean_smallest_angle: NONE,
                triangles_below_30: NONE,
                triangles_above_90: NONE,
                angles_below_30: NONE,
                angles_above_90: NONE,
            },
        }
    }
}

/// Errors of the points and of their normals, measured against the surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Accuracy {
    /// Largest first-order distance |f|/|∇f| to the surface.
    pub error_max: f64,
    /// Mean first-order distance to the surface.
    pub error_mean: f64,
    /// Points whose residual is undefined; left out of `error_max` and `error_mean`.
    pub undefined: usize,
    /// Mean angle between the given normals (either sign) and ∇f, in degrees.
    pub normal_error_mean: f64,
    /// Largest angle between the given normals (either sign) and ∇f, in degrees.
    pub normal_error_max: f64,
}

/// Distances of the points from their nearest ones.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Spacing {
    /// Smallest nearest-neighbour distance.
    pub nearest_min: f64,
    /// Mean nearest-neighbour distance.
    pub nearest_mean: f64,
    /// Standard deviation of the nearest-neighbour distance over its mean.
    pub spacing_variation: f64,
    /// Smallest over mean nearest-neighbour distance.
    pub nearest_ratio: f64,
    /// Normalised Poisson-disk radius: `nearest_min` under its usual name.
    pub rho: f64,
    /// First percentile of the nearest-neighbour distance.
    pub nearest_percentile_1: f64,
    /// Pairs of points closer than 0.75: over `ideal_spacing`, as `nearest_min`, or, if wanted
    /// radii are known, of natural neighbours over the sum of theirs, as `overlap_min`. A duplicate
    /// is a pair with the point that it equals. None if there are no distances.
    pub crowded: Option<usize>,
}

/// Holes between the points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Coverage {
    /// Radius of the largest hole over `ideal_spacing`/√3, the radius in the perfect lattice: 1 is
    /// ideal.
    pub cover: f64,
    /// Largest ratio of a hole's radius to that of a hexagonal lattice with the wanted radius
    /// there, the mean of the wanted radii of the points around the hole. One factor scales all
    /// wanted radii so that their cells have the surface's area. 1 is ideal. With equal radii this
    /// is `cover`.
    pub cover_local: f64,
    /// Mean squared distance from the surface to the nearest point, over that in the perfect
    /// lattice: 1 is ideal.
    pub quantization_error: f64,
    /// Share of the surface that no disc of a point around it covers, if the discs are known: 1 -
    /// π/(2√3) = 0.093 in a lattice whose discs touch.
    pub uncovered: f64,
    /// Holes wider than 1.4, as `cover` or, if wanted radii are known, as `cover_local`: empty
    /// discs whose middle lies in no wider one. None if `cover` is undefined.
    pub wide_holes: Option<usize>,
}

/// Valences of the points, and their six-fold order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Order {
    /// Fraction of the points with exactly six natural neighbours.
    pub six_neighbours: f64,
    /// Fraction of the points with five or seven natural neighbours.
    pub five_or_seven_neighbours: f64,
    /// Standard deviation of the valence.
    pub valence_deviation: f64,
    /// Number of points whose cell is not proven complete among their 200 nearest points.
    pub open: usize,
    /// Mean over the points of |mean over natural neighbours of exp(6iθ)|: 1 for a lattice.
    pub bond_order: f64,
}

/// Lengths of the edges between natural neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Edges {
    /// Standard deviation over mean of the length of mutual natural-neighbour edges.
    pub edge_variation: f64,
    /// Standard deviation over mean of edge length over the sum of the wanted radii.
    pub size_variation: f64,
    /// Smallest distance of natural neighbours over the sum of their wanted radii: 1 where
    /// particles just touch, 0 for duplicates.
    pub overlap_min: f64,
}

/// Triangles of natural neighbours, and the topology that they show.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Connectivity {
    /// Kept triangles over 2N − 2χ: 1 for a closed manifold. On a clipped surface, the share of the
    /// sectors around points away from the border that a kept triangle fills.
    pub triangle_share: f64,
    /// Fraction of the triangles (away from the border) that belong to the natural-neighbour stars
    /// of all three corners.
    pub agree: f64,
    /// Euler number of the kept triangles, on which at least two of their three corners agree.
    pub euler: i64,
    /// Number of components of the surface, by natural neighbours: components of the kept
    /// triangles, and groups of points far from all of them.
    pub components: usize,
}

/// Angles of the triangles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Angles {
    /// Smallest angle of any triangle, in degrees.
    pub smallest_angle: f64,
    /// Mean over the triangles of their smallest angle, in degrees.
    pub mean_smallest_angle: f64,
    /// Fraction of the triangles with an angle below 30°.
    pub triangles_below_30: f64,
    /// Fraction of the triangles with an angle above 90°.
    pub triangles_above_90: f64,
    /// Fraction of all angles below 30°.
    pub angles_below_30: f64,
    /// Fraction of all angles above 90°.
    pub angles_above_90: f64,
}

/// Returns the spacing of a perfect hexagonal lattice of `count` points on this `area`:
/// √(2A/(√3 N)).
pub(super) fn hexagonal_spacing(area: f64, count: usize) -> f64 {
    (2.0 * area / (SQRT_3 * count as f64)).sqrt()
}
