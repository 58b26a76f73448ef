//! Quality of a set of particles: residual, spacing, holes, order and triangles, with one
//! definition for each figure.
//!
//! The figures depend on the points and the field alone, not on the sampler that made the points,
//! so that any two samplers can be compared. Lengths are in units of d_hex = √(2A / (√3 N)), the
//! spacing of a perfect hexagonal lattice of N points on the area A, unless stated otherwise.
//!
//! *Natural neighbours* are defined in the tangent plane. The points of the same sheet are rotated
//! into the tangent plane of a point, at their true distances, and its natural neighbours are those
//! whose Voronoi cells share an edge with its own: its star, from which the
//! [mesh](crate::mesh::triangulation) is made, too. Two points are on the same sheet if their
//! normals are within 90° and the line between them leaves one tangent plane about as it arrives at
//! the other, which separates sheets that face the same way; if such sheets are close, the field
//! between the points decides.
//!
//! A mesh fills the places where stars disagree. The figures do not: their triangles are those that
//! stars see, so that no filled place makes a surface look closed. The report of a run joins its
//! particles to a mesh where these triangles leave the surface open; if the mesh closes it, and the
//! field leads along its edges, components and Euler number are those of the mesh.
//!
//! On a surface with creases the neighbours of a particle are those on its own patch, and the
//! triangles are those of the mesh, which end at the creases. A particle on a crease has no full
//! ring of neighbours and is left out of the figures of order; for distances, holes, angles and the
//! topology it counts once.
//!
//! The whole report costs a few microseconds for each particle. It is deterministic, with the same
//! bits natively and in WebAssembly if the values of f have the same bits.

mod accuracy;
mod border;
mod components;
mod creases;
mod energy;
pub mod figures;
mod gaps;
mod holes;
mod moments;
mod options;
mod order;
mod places;
mod points;
mod prepared;
mod probe;
mod projection;
pub(crate) mod sheets;
mod sizes;
mod spacing;
mod triangles;

pub(crate) use crate::field::formula::CHANNELS;
pub use figures::Figures;
#[doc(hidden)]
pub use options::MeasureOptions;
pub use places::{CROWDED, Hole, Pair, Places, WIDE};
pub use spacing::Histogram;

use crate::field::{Evaluator, Field, Frame};
use crate::math::{Bounds, NONE, SQRT_3};
use crate::mesh::facing::{Inside, facing};
use crate::mesh::stars::Sheets;
use crate::slices::{self, MEDIUM, pause};
use crate::topology::{Topology, separate_fans};
use accuracy::{first_order_height, height_along};
use border::Border;
use figures::hexagonal_spacing;
use glam::Vec3;
use holes::Cover;
use moments::{Moments, share};
use order::ValenceTally;
use places::Pairs;
use points::MeasuredPoints;
use prepared::Prepared;
use sizes::WantedRadii;
use std::sync::Arc;
use triangles::TriangleAngles;

/// Smallest number of random samples for `quantization_error`, which are at least as many as the
/// particles: stratified, so many give it to about 0.1 %.
const LEAST_SAMPLES: usize = 65_536;
/// Largest number of random samples for `quantization_error`. Over a disc the standard deviation of
/// the squared distance is 0.58 of its mean, so the error of so many samples is 0.1 %.
const MOST_SAMPLES: usize = 262_144;
/// Mean squared distance to the nearest point of a hexagonal lattice, over its area per point: 5 /
/// (18 √3).
const HEXAGONAL_QUANT: f64 = 5.0 / (18.0 * SQRT_3);

/// The figures of a set of particles, and columns with values for each particle, in the order
/// given.
#[derive(Clone, Debug, Default)]
pub struct Measurements {
    /// The figures.
    pub figures: Figures,
    /// Number of natural neighbours; 0 for a duplicate or a non-finite position. At the border of a
    /// clipped surface the Voronoi cell is open, and the neighbours that were found are counted.
    pub valence: Vec<u8>,
    /// Distance to the nearest other particle, of any sheet, in the field's units; infinite for a
    /// lone one, NaN for a non-finite position.
    pub nearest: Vec<f32>,
    /// First-order distance to the surface |f|/|∇f|, in the field's units; if f has no gradient,
    /// |f| over its slope to the steeper side along the normal. NaN if that is undefined, too.
    pub residual: Vec<f32>,
    /// Energy of the particle with its natural neighbours, over that of six at the ideal distance;
    /// NaN for a duplicate or a non-finite position.
    pub energy: Vec<f32>,
    /// Connected component of the surface, by the natural neighbours: 0 is the one with most
    /// particles. A duplicate is on the component of the particle that it equals; a non-finite
    /// position has [`Self::NO_COMPONENT`].
    pub component: Vec<u32>,
    /// Histogram of `nearest` over the ideal distances.
    pub histogram: Histogram,
    /// The crowded pairs and the wide holes.
    pub places: Places,
    /// Columns that a program has [added](crate::Sample::add_value).
    pub values: Vec<NamedValues>,
    /// The opening that the triangles of natural neighbours leave in the surface; none if it is
    /// closed.
    pub(crate) opening: Option<Opening>,
    /// Sign of f inside the parts of the surface that the triangles of natural neighbours close;
    /// none if they close none.
    pub(crate) inside: Option<Inside>,
}

/// Numbers at the rows of the particles, with a name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NamedValues {
    /// The name: a letter, then letters, digits and _.
    pub name: String,
    /// The formula that gave them, if it was one.
    pub formula: Option<String>,
    /// A number for each row; NaN if undefined.
    pub values: Vec<f32>,
}

impl Measurements {
    /// Component of a point that is left out.
    pub const NO_COMPONENT: u32 = NONE;
}

/// Places away from the border of a clipped surface where the triangles of natural neighbours leave
/// it open.
#[derive(Clone, Debug)]
pub(crate) struct Opening {
    /// Number of edges that belong to one triangle alone.
    pub(crate) edges: usize,
    /// Number of points in no triangle.
    pub(crate) points: usize,
    /// Positions of the open edges and of the points in no triangle, at least one.
    pub(crate) places: Vec<Vec3>,
}

/// Measures the particles at `position` with outward unit normals `normal` on the surface of
/// `field`.
///
/// `bounds` is the box that was sampled. Particles within 4 d_hex of the border, where the surface
/// continues beyond the box, are left out of every figure but the residual, the normals, the area
/// and the topology. Random lines through the box find what the particles have missed, for `cover`
/// and `quantization_error`. Without `bounds` only the triangles are sampled. The given normals are
/// used where the gradient is undefined, and are also compared with it; the slice may be shorter
/// than `position`.
///
/// The cost is linear, about 2 µs for each particle natively on a formula. No input causes a panic:
/// what is undefined (the spacing of one particle, angles without triangles) is NaN, and non-finite
/// positions are counted and left out.
#[must_use]
#[doc(hidden)]
pub fn measure(
    position: &[Vec3],
    normal: &[Vec3],
    field: &dyn Field,
    bounds: Option<&Bounds>,
    options: &MeasureOptions,
) -> Measurements {
    let frame = Frame::default().scaled_to(&field, position.iter().copied());
    let surroundings = Surroundings { bounds, sheets: None };
    slices::in_pool(|| {
        let field = &mut *field.evaluator(frame);
        slices::complete(in_slices(position, normal, field, surroundings, options, &mut None))
    })
}

/// Where the points of a measurement lie, if known.
#[derive(Clone, Copy, Default)]
pub(crate) struct Surroundings<'a> {
    /// The box that was sampled.
    pub(crate) bounds: Option<&'a Bounds>,
    /// The sheets of all points, by their indices.
    pub(crate) sheets: Option<&'a Arc<Sheets>>,
}

/// Number of slices that measurements of one surface are expected to take, for each of these
/// numbers of points.
pub(crate) fn expected_slices(points: impl Iterator<Item = usize>) -> u64 {
    /// Slices for each point: of two passes that take [`HEAVY`](slices::HEAVY) points at once, and
    /// of some twenty that take [`MEDIUM`] points or triangles.
    const EACH: f64 = 0.17;
    let of = |points: usize| (EACH * points as f64) as u64 + holes::slices(samples_for(points));
    probe::SLICES + points.map(of).sum::<u64>()
}

/// Number of random samples on the triangles of `points` points.
fn samples_for(points: usize) -> usize {
    points.clamp(LEAST_SAMPLES, MOST_SAMPLES)
}

/// [`measure`] in slices of work. A few of them take all particles at once, some 20 ns each.
/// `crossings` are random samples of the surface in the box, which are found if absent: all
/// measurements of one surface share them.
pub(crate) async fn in_slices(
    position: &[Vec3],
    normal: &[Vec3],
    field: &mut dyn Evaluator,
    Surroundings { bounds, sheets }: Surroundings<'_>,
    options: &MeasureOptions<'_>,
    crossings: &mut Option<Vec<Vec3>>,
) -> Measurements {
    let prepared = Prepared::new(position, normal, field, bounds, options, sheets).await;
    let DistinctFigures { mut figures, component, energy, mut pairs, holes, opening, inside } =
        figures_of(&prepared, field, bounds, options, crossings).await;
    let Prepared { points, drop, .. } = &prepared;
    let n = position.len();
    let mut report = Measurements {
        valence: vec![0; n],
        nearest: (0..n).map(|i| if drop[i] && position[i].is_finite() { 0.0 } else { f32::NAN }).collect(),
        residual: vec![f32::NAN; n],
        energy: vec![f32::NAN; n],
        component: vec![Measurements::NO_COMPONENT; n],
        opening,
        inside,
        ..Measurements::default()
    };
    for (k, &i) in points.tree.origin.iter().enumerate() {
        let i = i as usize;
        report.valence[i] = points.stars.valence(k).min(255) as u8;
        report.nearest[i] = points.nearest(k);
        report.residual[i] = points.residual[k] as f32;
        report.energy[i] = energy[k];
        report.component[i] = component[k];
    }
    for i in (0..n).filter(|&i| drop[i] && position[i].is_finite()) {
        let field = field.on(options.rows.and_then(|rows| rows.patch_of(i)));
        let place = position[i].as_dvec3();
        let jet = field.jet(place);
        let mut height = first_order_height(jet.value, jet.gradient.length());
        if !height.is_finite() {
            height = height_along(field, place, normal.get(i).copied().unwrap_or_default(), jet.value);
        }
        report.residual[i] = height.abs() as f32;
        let (_, equal) = points.tree.nearest(position[i], NONE, f32::INFINITY);
        report.component[i] = component.get(equal as usize).copied().unwrap_or(Measurements::NO_COMPONENT);
        if let Some(&twin) = points.tree.origin.get(equal as usize) {
            pairs.add(0.0, twin, i as u32);
        }
    }
    figures.spacing.crowded = (!points.tree.position.is_empty()).then_some(pairs.crowded);
    report.figures = figures;
    report.places = Places { pairs: pairs.reported(), holes };
    let is_first = |i: usize| options.rows.is_none_or(|rows| rows.first_row(i) == i);
    let nearest = report.nearest.iter().enumerate().filter(|&(i, _)| is_first(i));
    report.histogram = Histogram::new(nearest.map(|(i, &distance)| (i, distance)), |i| match options.radii {
        Some(radii) => radii.get(i).map_or(f64::NAN, |&radius| 2.0 * f64::from(radius)),
        None => figures.ideal_spacing,
    });
    report
}

/// The measurements of the distinct points, in tree order.
#[derive(Default)]
struct DistinctFigures {
    figures: Figures,
    /// Connected component of each point.
    component: Vec<u32>,
    /// Energy of each point.
    energy: Vec<f32>,
    pairs: Pairs,
    holes: Vec<Hole>,
    opening: Option<Opening>,
    inside: Option<Inside>,
}

/// Measures the points; duplicates have yet to be added to `crowded`.
async fn figures_of(
    prepared: &Prepared,
    field: &mut dyn Evaluator,
    bounds: Option<&Bounds>,
    options: &MeasureOptions<'_>,
    crossings: &mut Option<Vec<Vec3>>,
) -> DistinctFigures {
    let Prepared { points, mesh, duplicates, not_finite, .. } = prepared;
    let mut figures = Figures { duplicates: *duplicates, not_finite: *not_finite, ..Figures::default() };
    let mut measured = DistinctFigures::default();
    let n = points.tree.len();
    if n == 0 {
        return DistinctFigures { figures, ..measured };
    }
    figures.area = prepared.area;
    figures.ideal_spacing = hexagonal_spacing(figures.area, points.count() + duplicates);
    pause().await;
    figures.accuracy = accuracy::measure(&points.residual, &points.normal_angles, figures.ideal_spacing);

    let border = match bounds {
        Some(bounds) => Some(Border::new(field, bounds, &points.tree, figures.ideal_spacing).await),
        None => None,
    };
    let inner = points_away_from(border.as_ref(), points).await;
    figures.boundary_excluded = (0..n).filter(|&i| !inner[i] && points.creases.is_first(i)).count();
    pause().await;
    let once: Vec<bool> = (0..n).map(|i| inner[i] && points.creases.is_first(i)).collect();
    figures.spacing = spacing::measure(points, &once, *duplicates, figures.ideal_spacing);
    pause().await;
    let wanted = options.radii.map(|radii| WantedRadii::new(points, radii, figures.area));
    pause().await;
    measured.pairs = measure_neighbourhoods(points, &inner, wanted.as_ref(), &mut figures).await;
    measured.energy = energy::of_points(points, wanted.as_ref(), figures.ideal_spacing).await;
    measure_triangles(prepared, [&inner, &once], &mut figures, &mut measured).await;
    if !mesh.is_empty() {
        let (border, wanted) = (border.as_ref(), wanted.as_ref());
        let lattice = (figures.ideal_spacing / SQRT_3) as f32;
        let cover = Cover {
            tree: &points.tree,
            creases: &points.creases,
            mesh,
            mesh_area: prepared.mesh_area,
            border,
            wanted,
            discs: options.rows.map_or(&[], |rows| &rows.radius),
            lattice,
        };
        if let Some(bounds) = bounds
            && crossings.is_none()
        {
            *crossings = Some(probe::crossings(field, bounds).await);
        }
        let crossings = crossings.as_deref().unwrap_or_default();
        measured.holes = measure_holes(&cover, field, crossings, &mut figures).await;
    }
    DistinctFigures { figures, ..measured }
}

/// Returns, for each point, whether it is away from the border.
async fn points_away_from(border: Option<&Border>, points: &MeasuredPoints) -> Vec<bool> {
    let n = points.tree.len();
    let Some(border) = border else { return vec![true; n] };
    let parts = slices::map(
        n,
        MEDIUM,
        || (),
        |(), range| range.map(|i| !border.is_near(points.tree.position[i])).collect::<Vec<bool>>(),
    );
    parts.await.concat()
}

/// Measures valences, bond order and edges of the `inner` points, and returns their pairs.
async fn measure_neighbourhoods(
    points: &MeasuredPoints,
    inner: &[bool],
    wanted: Option<&WantedRadii>,
    figures: &mut Figures,
) -> Pairs {
    let parts = slices::map(
        points.tree.len(),
        MEDIUM,
        || (),
        |(), range| {
            let mut order = ValenceTally::default();
            let (mut edge, mut size) = (Moments::default(), Moments::default());
            for i in range.filter(|&i| inner[i]) {
                // On a crease a particle has neighbours on one side only.
                if !points.creases.holds(i) {
                    order.add(points, i);
                }
                for j in points.mutual(inner, i).filter(|&j| points.creases.is_first_pair(i, j)) {
                    edge.add(points.distance(i, j));
                    let ratio = wanted.map_or(f64::NAN, |wanted| wanted.ratio(points, i, j));
                    if ratio.is_finite() {
                        size.add(ratio);
                    }
                }
            }
            (order, edge, size)
        },
    );
    let mut order = ValenceTally::default();
    let (mut edge, mut size) = (Moments::default(), Moments::default());
    for part in parts.await {
        order.join(&part.0);
        edge.join(&part.1);
        size.join(&part.2);
    }
    let mut pairs = Pairs::default();
    figures.order = order.figures();
    figures.edges.edge_variation = edge.variation();
    if let Some(wanted) = wanted {
        figures.edges.size_variation = size.variation();
        let least = wanted.add_pairs(points, inner, &mut pairs).await;
        figures.edges.overlap_min = if figures.duplicates > 0 { 0.0 } else { least };
    } else {
        spacing::add_pairs(points, inner, figures.ideal_spacing, &mut pairs).await;
    }
    pairs
}

/// Measures angles, agreement and topology of the triangles: of `inner` points and of those that
/// also represent their particle (`once`). Also finds the connected component of each point, the
/// opening of the triangles, and what is inside them.
async fn measure_triangles(
    prepared: &Prepared,
    [inner, once]: [&[bool]; 2],
    figures: &mut Figures,
    measured: &mut DistinctFigures,
) {
    let Prepared { points, spacing, triangles, mesh, .. } = prepared;
    let n = points.tree.len();
    let away = |triangle: &&[u32; 3]| triangle.iter().all(|&i| inner[i as usize]);
    let is_whole = |i: usize| inner[i] && !points.creases.holds(i);
    let mut angles = TriangleAngles::default();
    let mut corners = 0;
    for list in [&triangles.unanimous, &triangles.majority] {
        let parts = slices::map(
            list.len(),
            MEDIUM,
            || (),
            |(), range| {
                let mut angles = TriangleAngles::default();
                let own = &list[range];
                own.iter().filter(away).for_each(|&triangle| angles.add(&points.tree.position, triangle));
                (angles, own.iter().flatten().filter(|&&i| is_whole(i as usize)).count())
            },
        );
        for (own, whole) in parts.await {
            angles.join(&own);
            corners += whole;
        }
    }
    figures.angles = angles.figures();
    let first = |i: u32| points.creases.first(i as usize) as u32;
    let mut welded: Vec<[u32; 3]> = mesh.iter().map(|triangle| triangle.map(first)).collect();
    let mut topology = Topology::in_slices(&welded, n).await;
    if !points.creases.is_empty() && !topology.pinched_vertices.is_empty() {
        separate_fans(&mut welded, mesh, &topology.pinched_vertices);
        topology = Topology::in_slices(&welded, n).await;
    }
    figures.connectivity.euler = topology.euler();
    let is_whole_around: Vec<bool> = (0..n).map(|i| once[i] && !points.creases.is_rim(i)).collect();
    measured.opening = opening(&topology, &welded, &is_whole_around, &points.tree.position);
    pause().await;
    measured.inside = facing(&points.tree.position, &welded, &topology).await.inside;
    (measured.component, figures.connectivity.components) =
        components::label(points, spacing, mesh, &welded).await;
    let unanimous = triangles.unanimous.iter().filter(away).count();
    figures.connectivity.agree =
        share(unanimous, angles.count + triangles.single.iter().filter(away).count());
    figures.connectivity.triangle_share = if figures.boundary_excluded == 0 && !points.creases.has_rim() {
        triangles.kept().count() as f64 / (2 * points.count() as i64 - 2 * figures.connectivity.euler) as f64
    } else {
        // This is the share of the sectors between consecutive neighbours of inner points that a
        // triangle fills.
        share(corners, (0..n).filter(|&i| is_whole(i)).map(|i| points.stars.valence(i)).sum())
    };
}

/// The opening that the triangles leave between `inner` points, if there is one.
fn opening(topology: &Topology, mesh: &[[u32; 3]], inner: &[bool], position: &[Vec3]) -> Option<Opening> {
    let mut is_bare = inner.to_vec();
    mesh.iter().flatten().for_each(|&i| is_bare[i as usize] = false);
    let is_inner = |i: &u32| inner[*i as usize];
    let open = || topology.lone_edges.iter().filter(|edge| edge.iter().all(is_inner));
    let bare = || (0..inner.len()).filter(|&i| is_bare[i]);
    let places: Vec<Vec3> = open().map(|&[i, _]| i as usize).chain(bare()).map(|i| position[i]).collect();
    let (edges, points) = (open().count(), bare().count());
    (!places.is_empty()).then_some(Opening { edges, points, places })
}

/// Measures the holes. Returns the wide ones.
async fn measure_holes(
    cover: &Cover<'_>,
    field: &mut dyn Evaluator,
    crossings: &[Vec3],
    figures: &mut Figures,
) -> Vec<Hole> {
    let n = cover.tree.len() - cover.creases.further();
    let holes = holes::measure(field, cover, samples_for(n), crossings).await;
    figures.coverage.cover = holes.widest / (figures.ideal_spacing / SQRT_3);
    if cover.wanted.is_some() {
        figures.coverage.cover_local = holes.relative;
    }
    figures.coverage.quantization_error =
        holes.mean_sq / (HEXAGONAL_QUANT * figures.area / (n + figures.duplicates) as f64);
    if !cover.discs.is_empty() {
        figures.coverage.uncovered = holes.bare;
    }
    let (wide, reported) = places::distinct(holes.found).await;
    figures.coverage.wide_holes = Some(wide);
    reported
}
