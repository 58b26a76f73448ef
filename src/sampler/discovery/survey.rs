//! A first look at the field over the box: where the surface is (a first point on every component that a regular grid
//! can see), how large it is, and how finely single precision resolves it.

use crate::field::Field;
use crate::math::{Bounds, sort_numbers};
use crate::sampler::discovery::completeness::Search;
use crate::sampler::projection::{BATCH, Descent, Projector, Tolerance, tolerance};
use glam::{DVec3, Vec3};

/// Grid cells along the longest side of the box. 32³ evaluations are a few per cent of a run with 50,000 particles.
const CELLS: f64 = 32.0;
/// The same where nothing but the grid tells where the surface is: a sphere whose radius is
/// 1.4 % of the box's longest side is not missed.
const DENSE_CELLS: f64 = 64.0;
/// Most evaluations of the Newton projection of a candidate.
const MAX_STEPS: u32 = 12;
/// Candidates at which the resolution is measured.
const RESOLUTION_SAMPLES: usize = 48;
/// Distance to either side at which a touching is told from a crossing, as a share of the grid's spacing: far beyond the
/// tolerance of the points, far below what the grid can tell apart.
const TOUCH_PROBE: f32 = 0.02;
/// Distance, in tolerances of the survey, at which a zero is told from a pole.
const POLE_PROBE: f32 = 4.0;

/// Area that a place stands for where f does not change its sign.
const NO_CROSSING: f32 = -1.0;

/// What a survey found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Survey {
    /// What the field was multiplied by, so that its gradient can be squared in single precision.
    pub(crate) factor: f32,
    /// Points of the surface, spread over it, in grid order.
    pub(crate) position: Vec<Vec3>,
    /// Unit normals there.
    pub(crate) normal: Vec<Vec3>,
    /// Area that each point stands for; together they are about `area`. 0 for points that no crossing of the grid gave.
    pub(crate) weight: Vec<f32>,
    /// Estimated area inside the box.
    pub(crate) area: f64,
    /// Median |∇f| over those points.
    pub(crate) gradient_scale: f32,
    /// Distance that rounding can move the computed surface by.
    pub(crate) resolution: f32,
    /// Largest distance of a point from the surface.
    residual: f32,
    /// Whether f mostly touches zero without changing its sign.
    pub(crate) touches: bool,
    /// Verdict where there is no point.
    pub(crate) absence: Absence,
    /// Whether its points were found by other means.
    pub(crate) is_adopted: bool,
}

/// Why a survey found no surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Absence {
    /// It found one.
    #[default]
    None,
    /// f has the same value everywhere.
    Constant,
    /// f has no value anywhere.
    Undefined,
    /// Interval arithmetic proves that f has no zero in the box.
    Proven,
    /// The grid shows a change of sign, but no point where f comes to zero with a gradient.
    NoZero,
    /// The grid shows none; too fine a feature could have been missed.
    NotSeen,
}

/// One layer of grid nodes.
struct Layer {
    value: Vec<f32>,
    gradient: Vec<Vec3>,
}

/// The nodes of a dense grid, evaluated only where the surface can be.
///
/// The box is cut into blocks of [`COARSEST`] grid cells to an edge, and those that may hold the surface are halved until
/// they are grid cells. Of the others only the sign of f is told.
struct Dense {
    value: Vec<f32>,
    gradient: Vec<Vec3>,
    /// Whether the node is a corner of a grid cell that may hold the surface.
    is_near: Vec<bool>,
}

/// Grid cells along the edge of the first blocks of a dense grid: a power of two.
const COARSEST: usize = 4;
/// A block may hold the surface if at one of its corners |f| is no more than the largest |∇f| at them times so many
/// diagonals. No point of a block is farther than half a diagonal from all corners; between them |∇f| may be somewhat larger.
const REACH: f32 = 0.7;

impl Dense {
    fn new(
        field: &mut dyn Field,
        projector: &mut Projector,
        [nx, ny, nz]: [usize; 3],
        step: DVec3,
        node: impl Fn(usize, usize, usize) -> Vec3,
    ) -> Self {
        let index = |[i, j, k]: [usize; 3]| (k * ny + j) * nx + i;
        // The eight places at the corners of a cube.
        let eight = |[i, j, k]: [usize; 3], width: usize| {
            (0..8).map(move |c| [i + width * (c & 1), j + width * (c >> 1 & 1), k + width * (c >> 2)])
        };
        let nodes = nx * ny * nz;
        let mut dense = Self {
            value: vec![f32::NAN; nodes],
            gradient: vec![Vec3::ZERO; nodes],
            is_near: vec![false; nodes],
        };
        let mut is_known = vec![false; nodes];
        let mut wanted = Vec::new();
        let mut points = Vec::with_capacity(BATCH);
        let along = |n: usize| (0..n - 1).step_by(COARSEST);
        let mut blocks: Vec<[usize; 3]> =
            along(nz).flat_map(|k| along(ny).flat_map(move |j| along(nx).map(move |i| [i, j, k]))).collect();
        let mut width = COARSEST;
        loop {
            for corner in blocks.iter().flat_map(|&block| eight(block, width)) {
                if !core::mem::replace(&mut is_known[index(corner)], true) {
                    wanted.push(corner);
                }
                dense.is_near[index(corner)] = width == 1;
            }
            for chunk in wanted.chunks(BATCH) {
                points.clear();
                points.extend(chunk.iter().map(|&[i, j, k]| node(i, j, k)));
                let (value, gradient) = projector.evaluate_batch(field, &points);
                for ((&corner, &value), &gradient) in chunk.iter().zip(value).zip(gradient) {
                    (dense.value[index(corner)], dense.gradient[index(corner)]) = (value, gradient);
                }
            }
            wanted.clear();
            if width == 1 {
                return dense;
            }
            let reach = REACH * width as f32 * step.length() as f32;
            let mut halves = Vec::new();
            for block in blocks {
                let corners = || eight(block, width).map(index);
                let least = corners().fold(f32::INFINITY, |least, n| least.min(dense.value[n].abs()));
                let slope = corners().fold(0.0_f32, |most, n| most.max(dense.gradient[n].length()));
                let first = dense.value[index(block)];
                let differs = |n: usize| dense.value[n].is_nan() || (dense.value[n] <= 0.0) != (first <= 0.0);
                if least <= reach * slope || corners().any(differs) {
                    halves.extend(eight(block, width / 2));
                    continue;
                }
                let [i, j, k] = block;
                for row in (k..=k + width).flat_map(|k| (j..=j + width).map(move |j| [i, j, k])) {
                    for value in &mut dense.value[index(row)..=index(row) + width] {
                        // Any value of that sign.
                        *value = if value.is_nan() { first } else { *value };
                    }
                }
            }
            (blocks, width) = (halves, width / 2);
        }
    }
}

/// Surveys `field` over `bounds`, on a finer grid if it `is_dense`.
///
/// Two kinds of places are tried: grid edges whose ends differ in sign, and nodes whose first-order distance |f|/|∇f|
/// is below the spacing (surfaces that f touches without changing sign, and sheets thinner than a cell). Every place is
/// moved onto the surface by Newton's method and kept if it arrives nearby, which no pole does.
///
/// The area follows from the edges by Cauchy's formula: an edge along an axis crosses the surface once in s² of
/// projected area, so each crossing stands for s²/(|n_x| + |n_y| + |n_z|) of true area.
pub(crate) fn survey(
    field: &mut dyn Field,
    bounds: &Bounds,
    is_dense: bool,
    projector: &mut Projector,
) -> Survey {
    let size = bounds.hi() - bounds.lo();
    let spacing = size.max_element() / if is_dense { DENSE_CELLS } else { CELLS };
    // Whole blocks.
    let block = if is_dense { COARSEST as f64 } else { 1.0 };
    let cells = block * (size / (block * spacing)).ceil();
    let step = size / cells;
    let [nx, ny, nz] = cells.to_array().map(|c| c as usize + 1);
    let node = |i: usize, j: usize, k: usize| {
        (bounds.lo() + step * DVec3::new(i as f64, j as f64, k as f64)).as_vec3()
    };
    let mut out = Survey::default();
    let mut start: Vec<Vec3> = Vec::new();
    // Area that each place stands for; [`NO_CROSSING`] where f keeps its sign.
    let mut areas: Vec<f32> = Vec::new();
    let mut layers =
        [0, 1].map(|_| Layer { value: vec![f32::NAN; nx * ny], gradient: vec![Vec3::ZERO; nx * ny] });
    let (mut least, mut greatest, mut defined) = (f32::INFINITY, f32::NEG_INFINITY, 0_usize);
    let mut points = Vec::with_capacity(BATCH);
    let dense = is_dense.then(|| Dense::new(field, projector, [nx, ny, nz], step, node));
    for k in 0..=nz {
        // The layer above; the last round only closes the layer below.
        let (below, above) = layers.split_at_mut(1);
        let (lower, upper) = (&mut below[0], &mut above[0]);
        if let Some(dense) = dense.as_ref().filter(|_| k < nz) {
            let layer = k * nx * ny..(k + 1) * nx * ny;
            upper.value.copy_from_slice(&dense.value[layer.clone()]);
            upper.gradient.copy_from_slice(&dense.gradient[layer]);
        } else if k < nz {
            for first in (0..nx * ny).step_by(BATCH) {
                let last = (first + BATCH).min(nx * ny);
                points.clear();
                points.extend((first..last).map(|m| node(m % nx, m / nx, k)));
                let (value, gradient) = projector.evaluate_batch(field, &points);
                upper.value[first..last].copy_from_slice(value);
                upper.gradient[first..last].copy_from_slice(gradient);
            }
        }
        if k < nz {
            for &v in upper.value.iter().filter(|v| v.is_finite()) {
                least = least.min(v);
                greatest = greatest.max(v);
                defined += 1;
            }
        }
        if k > 0 {
            let z = k - 1;
            for j in 0..ny {
                for i in 0..nx {
                    let m = j * nx + i;
                    if dense.as_ref().is_some_and(|dense| !dense.is_near[z * nx * ny + m]) {
                        continue;
                    }
                    let here = (node(i, j, z), lower.value[m], lower.gradient[m]);
                    if !here.1.is_finite() {
                        continue;
                    }
                    let mut crossings = 0;
                    let mut ends = [None; 3];
                    if i + 1 < nx {
                        ends[0] = Some((node(i + 1, j, z), lower.value[m + 1], lower.gradient[m + 1]));
                    }
                    if j + 1 < ny {
                        ends[1] = Some((node(i, j + 1, z), lower.value[m + nx], lower.gradient[m + nx]));
                    }
                    if k < nz {
                        ends[2] = Some((node(i, j, k), upper.value[m], upper.gradient[m]));
                    }
                    for (axis, end) in ends.iter().enumerate() {
                        let Some(end) = end else { continue };
                        if !end.1.is_finite() || (here.1 <= 0.0) == (end.1 <= 0.0) {
                            continue;
                        }
                        let t = here.1 / (here.1 - end.1);
                        start.push(here.0 + (end.0 - here.0) * t);
                        crossings += 1;
                        let n = (here.2 + (end.2 - here.2) * t).normalize_or_zero().abs().as_dvec3();
                        let weight = n.x + n.y + n.z;
                        // Projected cell face perpendicular to the axis.
                        let face = step[(axis + 1) % 3] * step[(axis + 2) % 3];
                        let area = if weight > 0.0 { face / weight } else { 0.0 };
                        out.area += area;
                        areas.push(area as f32);
                    }
                    let slope = here.2.length();
                    if crossings == 0 && slope > 0.0 && here.1.abs() <= slope * spacing as f32 {
                        start.push(here.0 - here.2 * (here.1 / (slope * slope)));
                        areas.push(NO_CROSSING);
                    }
                }
            }
        }
        layers.swap(0, 1);
    }
    project(field, bounds, projector, &mut start, &areas, spacing as f32, &mut out);
    if out.position.is_empty() {
        out.area = 0.0;
        out.absence = if defined == 0 {
            Absence::Undefined
        } else if least == greatest {
            Absence::Constant
        } else if areas.iter().any(|&area| area != NO_CROSSING) {
            Absence::NoZero
        } else {
            Absence::NotSeen
        };
    }
    out
}

/// Moves the places in `start` onto the surface and keeps those that arrive inside the box. `areas` holds the area that
/// each stands for, or [`NO_CROSSING`].
fn project(
    field: &mut dyn Field,
    bounds: &Bounds,
    projector: &mut Projector,
    start: &mut [Vec3],
    areas: &[f32],
    spacing: f32,
    out: &mut Survey,
) {
    // The gradient at the surface: where f changes its sign, unless it nowhere does. Where f is small beside its gradient
    // without a change of sign, both may be of any size.
    let crosses = |area: f32| area != NO_CROSSING;
    let by_crossings = areas.iter().any(|&area| crosses(area));
    let mut slopes = Vec::new();
    for (chunk, areas) in start.chunks(BATCH).zip(areas.chunks(BATCH)) {
        let (_, gradient) = projector.evaluate_batch(field, chunk);
        let counted = gradient.iter().zip(areas).filter(|(_, area)| crosses(**area) || !by_crossings);
        slopes.extend(counted.map(|(g, _)| g.length()).filter(|g| g.is_finite() && *g > 0.0));
    }
    sort_numbers(&mut slopes);
    out.gradient_scale = slopes.get(slopes.len() / 2).copied().unwrap_or(0.0);
    let reach = bounds.min.iter().chain(&bounds.max).fold(0.0_f64, |m, c| m.max(c.abs())) as f32;
    // Two units in the last place of the largest coordinate; positions themselves are rounded to half of one.
    let ulps = 2.0 * f32::EPSILON * reach;
    let coarse =
        Tolerance { residual: (1e-4 * spacing).max(ulps), ..tolerance(0.0, 0.0, out.gradient_scale) };
    let mut normal = [Vec3::ZERO; BATCH];
    let mut ok = [false; BATCH];
    for (chunk, areas) in start.chunks_mut(BATCH).zip(areas.chunks(BATCH)) {
        projector.land_along_gradient(
            field,
            chunk,
            &mut normal,
            &mut ok,
            coarse.min_gradient,
            &mut Descent { residual: coarse.residual, reach: 2.0 * spacing, trust: 0.0 },
            MAX_STEPS,
        );
        for i in 0..chunk.len() {
            if ok[i] && bounds.contains(chunk[i]) {
                out.position.push(chunk[i]);
                out.normal.push(normal[i]);
                out.weight.push(if crosses(areas[i]) { areas[i] } else { 0.0 });
            }
        }
    }
    out.residual = coarse.residual;
    out.resolution = ulps.max(rounding(field, projector, &out.position));
    out.touches = touches(field, projector, out, TOUCH_PROBE * spacing);
}

impl Survey {
    /// What counts as being on the surface before there is a radius.
    pub(crate) fn tolerance(&self) -> Tolerance {
        tolerance(0.0, self.residual.max(self.resolution), self.gradient_scale)
    }

    /// Takes over what another search has `found` where this one has found nothing, or its proof that there is nothing.
    pub(crate) fn adopt(
        &mut self,
        field: &mut dyn Field,
        found: impl Iterator<Item = (Vec3, Vec3)>,
        bounds: &Bounds,
        search: Search,
    ) {
        self.is_adopted = true;
        let mut slopes = Vec::new();
        for (position, normal) in found {
            let jet = field.jet(position.as_dvec3());
            slopes.push(jet.gradient.length() as f32);
            // A sphere that bends as the surface does here has the area 4π/κ².
            let size = jet.gradient.length_squared()
                / jet.hessian.apply(normal.any_orthonormal_vector().as_dvec3()).length_squared();
            let sphere = 4.0 * core::f64::consts::PI * size;
            let most = bounds.diagonal() * bounds.diagonal();
            // Found from above and from below.
            self.area += if sphere < most { 0.5 * sphere } else { 0.0 };
            self.position.push(position);
            self.normal.push(normal);
            self.weight.push(0.0);
        }
        sort_numbers(&mut slopes);
        self.gradient_scale = slopes.get(slopes.len() / 2).copied().unwrap_or(self.gradient_scale);
        if !self.position.is_empty() {
            self.absence = Absence::None;
        } else if search == Search::Proven && matches!(self.absence, Absence::NoZero | Absence::NotSeen) {
            self.absence = Absence::Proven;
        }
    }

    /// Whether f comes to zero at survey point `i` and not to a pole, where |f|/|∇f| vanishes too: |f| grows away from a
    /// zero and falls away from a pole.
    pub(crate) fn is_zero(&self, field: &mut dyn Field, projector: &mut Projector, i: usize) -> bool {
        let (p, n) = (self.position[i], self.normal[i]);
        let step = POLE_PROBE * self.residual.max(self.resolution);
        let (value, _) = projector.evaluate_batch(field, &[p, p + n * step, p - n * step]);
        // NaN, where f ends, is no larger.
        value[1].abs() > value[0].abs() || value[2].abs() > value[0].abs()
    }
}

/// Whether f has the same sign on both sides of most of a selection of the points, at `distance`.
fn touches(field: &mut dyn Field, projector: &mut Projector, survey: &Survey, distance: f32) -> bool {
    let stride = survey.position.len().div_ceil(RESOLUTION_SAMPLES).max(1);
    let (mut same, mut seen) = (0, 0);
    for (&p, &n) in survey.position.iter().zip(&survey.normal).step_by(stride) {
        let (value, _) = projector.evaluate_batch(field, &[p + n * distance, p - n * distance]);
        same += usize::from(value[0] * value[1] > 0.0);
        seen += 1;
    }
    2 * same > seen
}

/// Upper quartile of the distance between the surface in single and in double precision, doubled.
fn rounding(field: &mut dyn Field, projector: &mut Projector, points: &[Vec3]) -> f32 {
    let stride = points.len().div_ceil(RESOLUTION_SAMPLES).max(1);
    let mut distance: Vec<f32> = points
        .iter()
        .step_by(stride)
        .filter_map(|&p| {
            let (value, gradient) = projector.evaluate(field, p);
            let exact = field.jet(p.as_dvec3());
            let d = ((f64::from(value) - exact.value).abs() / f64::from(gradient.length())) as f32;
            d.is_finite().then_some(d)
        })
        .collect();
    sort_numbers(&mut distance);
    2.0 * distance.get(distance.len() * 3 / 4).copied().unwrap_or(0.0)
}

#[cfg(all(test, feature = "points"))]
mod tests {
    use super::*;
    use crate::field::model::MODELS;
    use crate::field::rbf::RbfField;
    use crate::pointcloud::models;

    #[test]
    fn a_dense_grid_tells_the_sign_at_every_node_and_the_value_near_the_surface() {
        for model in MODELS {
            let fit = models::begin(model).finish().expect("a model is solved for");
            let mut field = RbfField::new(fit.data).expect("a field");
            let n = [65, 49, 57];
            let step = (fit.bounds.hi() - fit.bounds.lo()) / DVec3::new(64.0, 48.0, 56.0);
            let node = |i: usize, j: usize, k: usize| {
                (fit.bounds.lo() + step * DVec3::new(i as f64, j as f64, k as f64)).as_vec3()
            };
            let dense = Dense::new(&mut field, &mut Projector::new(), n, step, node);
            let mut all = Vec::new();
            for k in 0..n[2] {
                for j in 0..n[1] {
                    all.extend((0..n[0]).map(|i| node(i, j, k)));
                }
            }
            let mut value = vec![0.0; all.len()];
            field.values(&all, &mut value);
            let near = dense.is_near.iter().filter(|near| **near).count();
            assert!(near * 2 < all.len(), "{}: {near} of {} nodes are near", model.id, all.len());
            for (m, &exact) in value.iter().enumerate() {
                let told = dense.value[m];
                assert_eq!(told <= 0.0, exact <= 0.0, "{}: {told} for {exact} at {}", model.id, all[m]);
                assert!(!dense.is_near[m] || told == exact, "{}: {told} for {exact} at {}", model.id, all[m]);
            }
        }
    }
}
