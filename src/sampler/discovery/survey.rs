//! The survey of the field on a regular grid over the box. It finds a first point on every
//! component that the grid resolves, and estimates the area of the surface and how finely single
//! precision resolves it.

use crate::field::Evaluator;
use crate::field::descent::Descent;
use crate::math::{Bounds, median, newton, sort_by_key, sort_numbers};
use crate::particles::OrientedPoint;
use crate::sampler::discovery::completeness::Search;
use crate::sampler::discovery::dips::{Bottom, Crossing, Dip, End};
use crate::sampler::discovery::grid::{Dense, Grid, GridLayer};
use crate::sampler::discovery::nearness::{Nearness, STEPS, UNRESOLVED, nearest};
use crate::sampler::probe::{BATCH, Probe};
use crate::sampler::projection::{ResidualLimits, Tolerance, tolerance};
use glam::{DVec3, Vec3};
use rand_core::Rng;

/// Largest number of evaluations of f on an edge to find two crossings. Fewer: more sheets near
/// each other are missed.
const LOOKS: usize = 3;
/// Distance at which the size of f distinguishes a zero from a pole, in tolerances of the survey.
/// At one tolerance rounding may decide.
const POLE_PROBE: f32 = 4.0;

/// The result of a survey.
#[derive(Clone, Debug, Default)]
pub(crate) struct Survey {
    /// Points of the surface, spread over it, in grid order.
    pub(crate) position: Vec<Vec3>,
    /// Unit normals at these points.
    pub(crate) normal: Vec<Vec3>,
    /// Area that each point stands for. The sum is about `area`. 0 for points that no crossing of
    /// the grid gave.
    pub(crate) weight: Vec<f32>,
    /// Estimated area inside the box.
    pub(crate) area: f64,
    /// Median |∇f| over the points of the survey.
    pub(crate) gradient_scale: f32,
    /// Distance by which rounding can move the computed surface.
    pub(crate) resolution: f32,
    /// Least distance along the normal, from a point of the surface, of another sheet with a third
    /// one beyond; infinite if none was found.
    pub(crate) crowding: f32,
    /// The nearest pair of sheets, if some are so near that a particle's usual tolerance could put
    /// it on the wrong one.
    pub(crate) nearness: Option<Nearness>,
    /// Largest distance of a point from the surface.
    residual: f32,
    /// Whether f mostly touches zero without changing its sign.
    pub(crate) touches: bool,
    /// A place where f vanishes only on a curve or at an isolated point, if one was found.
    pub(crate) bare: Option<DVec3>,
    /// A value that f has on a surface around such a place, where there is nothing else.
    pub(crate) level: f64,
    /// Whether points were left out because they lie beyond the limits of the surface.
    is_limited: bool,
    /// Share of the nodes of the grid at which f is defined.
    pub(crate) defined: f64,
    /// The values of f in ascending order, if it takes only a few.
    pub(crate) steps: Vec<f64>,
    /// Why the survey has no points, if it has none.
    pub(crate) absence: Absence,
    /// Whether the points come from another search.
    pub(crate) is_adopted: bool,
}

/// Why the survey found no surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Absence {
    /// The survey found a surface.
    #[default]
    None,
    /// f has the same value everywhere.
    Constant,
    /// f is undefined everywhere.
    Undefined,
    /// f is too large for double precision wherever it is defined.
    TooLarge,
    /// Interval arithmetic proves that f has no zero in the box.
    Proven,
    /// The grid shows a change of sign, but no point where f comes to zero with a gradient.
    NoZero,
    /// The grid shows no change of sign. A feature finer than the grid may have been missed.
    NotSeen,
    /// f vanishes only on curves and at isolated points.
    Bare,
    /// No part of the surface is within its limits.
    Limited,
    /// f takes only a few values, and jumps between them.
    Steps,
}

/// Candidates for points of the surface, and the range of the values on the grid.
struct Candidates {
    place: Vec<Vec3>,
    /// Area that each candidate stands for; none where f keeps its sign.
    areas: Vec<Option<f32>>,
    /// Whether f need not change its sign at a candidate: it is zero at a node, or keeps its sign.
    is_unsure: Vec<bool>,
    /// Sum of the areas.
    area: f64,
    least: f32,
    greatest: f32,
    /// Nodes at which f is defined.
    defined: usize,
    /// Nodes examined, and those of them at which f is flat.
    seen: usize,
    flat: usize,
    /// Edges that the surface may cross twice, until they are examined.
    dips: Vec<Dip>,
}

impl Candidates {
    fn new() -> Self {
        let (least, greatest) = (f32::INFINITY, f32::NEG_INFINITY);
        Self {
            place: Vec::new(),
            areas: Vec::new(),
            is_unsure: Vec::new(),
            area: 0.0,
            least,
            greatest,
            defined: 0,
            seen: 0,
            flat: 0,
            dips: Vec::new(),
        }
    }

    fn note_values(&mut self, values: &[f32]) {
        for &v in values.iter().filter(|v| v.is_finite()) {
            self.least = self.least.min(v);
            self.greatest = self.greatest.max(v);
            self.defined += 1;
        }
    }

    /// Examines layer number `z`, which is `lower`, and its edges along the axes. `upper` is the
    /// layer above; the last layer has none.
    fn look_at(
        &mut self,
        grid: &Grid,
        dense: Option<&Dense>,
        z: usize,
        lower: &GridLayer,
        upper: Option<&GridLayer>,
    ) {
        let [nx, ny, _] = grid.nodes;
        for j in 0..ny {
            for i in 0..nx {
                if dense.is_some_and(|dense| !dense.is_near[z * nx * ny + j * nx + i]) {
                    continue;
                }
                let here = lower.at(grid, [i, j, z]);
                if !here.value.is_finite() {
                    continue;
                }
                self.seen += 1;
                self.flat += usize::from(here.gradient == Vec3::ZERO);
                let mut crossings = 0;
                let ends = [
                    (i + 1 < nx).then(|| lower.at(grid, [i + 1, j, z])),
                    (j + 1 < ny).then(|| lower.at(grid, [i, j + 1, z])),
                    upper.map(|upper| upper.at(grid, [i, j, z + 1])),
                ];
                for (axis, end) in ends.into_iter().enumerate() {
                    let Some(end) = end else { continue };
                    if end.value.is_finite() && (here.value <= 0.0) != (end.value <= 0.0) {
                        self.cross_between(grid, axis, here, end);
                        crossings += 1;
                    } else {
                        self.dips.extend(Dip::along(axis, [here, end]));
                    }
                }
                let slope = here.gradient.length();
                if crossings == 0 && slope > 0.0 && here.value.abs() <= slope * grid.spacing as f32 {
                    self.place.push(here.place - here.gradient * (here.value / (slope * slope)));
                    self.areas.push(None);
                    self.is_unsure.push(true);
                }
            }
        }
    }

    /// Adds the place on an edge, whose ends differ in sign, where f vanishes if it is linear.
    fn cross_between(&mut self, grid: &Grid, axis: usize, here: End, end: End) {
        let t = here.value / (here.value - end.value);
        let gradient = here.gradient + (end.gradient - here.gradient) * t;
        let is_unsure = here.value == 0.0 || end.value == 0.0;
        self.cross(grid, axis, here.place + (end.place - here.place) * t, gradient, is_unsure);
    }

    /// Adds a place where an edge along an axis meets the surface.
    fn cross(&mut self, grid: &Grid, axis: usize, place: Vec3, gradient: Vec3, is_unsure: bool) {
        self.place.push(place);
        self.is_unsure.push(is_unsure);
        let n = gradient.normalize_or_zero().abs().as_dvec3();
        let weight = n.x + n.y + n.z;
        // Projected cell face perpendicular to the axis.
        let face = grid.step[(axis + 1) % 3] * grid.step[(axis + 2) % 3];
        let area = if weight > 0.0 { face / weight } else { 0.0 };
        self.area += area;
        self.areas.push(Some(area as f32));
    }

    /// Examines the edges that the surface may cross twice, and adds the places where it does.
    fn look_into_dips(&mut self, probe: &mut Probe, grid: &Grid) {
        for _ in 0..LOOKS {
            let dips = core::mem::take(&mut self.dips);
            for chunk in dips.chunks(BATCH) {
                let bottoms: Vec<Vec3> = chunk.iter().map(Dip::bottom).collect();
                let (value, gradient) = probe.gradients(&bottoms);
                for ((dip, &value), &gradient) in chunk.iter().zip(value).zip(gradient) {
                    match dip.look(value, gradient) {
                        Bottom::Crossed(places) => {
                            for Crossing { place, gradient } in places {
                                self.cross(grid, dip.axis, place, gradient, true);
                            }
                        }
                        Bottom::SameSign(part) => self.dips.extend(part),
                    }
                }
            }
        }
        self.dips.clear();
    }

    /// The reason why no candidate has led to a point of the surface.
    fn absence(&self) -> Absence {
        if self.defined == 0 {
            Absence::Undefined
        } else if self.least == self.greatest {
            Absence::Constant
        } else if (self.least < 0.0 && self.greatest > 0.0)
            || self.areas.iter().zip(&self.is_unsure).any(|(area, is_unsure)| area.is_some() && !is_unsure)
        {
            Absence::NoZero
        } else {
            Absence::NotSeen
        }
    }
}

/// Distance between the nodes of the grid of a survey that is not dense.
pub(crate) fn spacing(bounds: &Bounds) -> f64 {
    Grid::over(bounds, None).spacing
}

/// Surveys `field` over `bounds`, on a grid of `dense` cells if that number is given.
///
/// Three kinds of candidates are tried: grid edges whose ends differ in sign, edges between whose
/// ends f has the other sign (two sheets within a cell), and nodes whose first-order distance
/// |f|/|∇f| is below the spacing (surfaces that f touches without changing sign, and sheets that no
/// edge crosses). Every candidate is moved onto the surface by Newton's method and kept if it
/// converges nearby, which it does at no pole.
///
/// The area follows from the edges by Cauchy's formula: an edge along an axis crosses the surface
/// once in s² of projected area, so each crossing stands for s²/(|n_x| + |n_y| + |n_z|) of true
/// area.
pub(crate) fn survey(probe: &mut Probe, bounds: &Bounds, dense: Option<u32>) -> Survey {
    let grid = Grid::over(bounds, dense);
    let dense = dense.map(|_| Dense::new(probe, &grid));
    let mut found = Candidates::new();
    let [mut lower, mut upper] = [0, 1].map(|_| GridLayer::new(&grid));
    let layers = grid.nodes[2];
    for k in 0..=layers {
        // The layer above; the last round only closes the layer below.
        if k < layers {
            upper.fill(probe, &grid, dense.as_ref(), k);
            found.note_values(&upper.value);
        }
        if k > 0 {
            found.look_at(&grid, dense.as_ref(), k - 1, &lower, (k < layers).then_some(&upper));
            found.look_into_dips(probe, &grid);
        }
        core::mem::swap(&mut lower, &mut upper);
    }
    let mut out = Survey { area: found.area, ..Survey::default() };
    out.defined = found.defined as f64 / (grid.nodes[0] * grid.nodes[1] * layers) as f64;
    if 2 * found.flat >= found.seen
        && let Some(steps) = steps(probe.field, bounds)
    {
        return Survey { area: 0.0, steps, absence: Absence::Steps, resolution: ulps(bounds), ..out };
    }
    let spacing = grid.spacing as f32;
    out.gradient_scale = gradient_scale(probe, &found.place, &found.areas);
    let Candidates { place, areas, is_unsure, .. } = &mut found;
    project(probe, bounds, Starts { place, areas, is_unsure, branch: None }, spacing, &mut out);
    if out.position.is_empty() && out.bare.is_none() {
        project_on_branches(probe, bounds, &found, spacing, &mut out);
    }
    if out.position.is_empty() && out.bare.is_none() {
        out.bare = bare_among(probe, found.place.iter().map(|place| place.as_dvec3()), spacing.into());
    }
    measure_precision(probe, bounds, spacing, &mut out);
    if out.position.is_empty() {
        out.area = 0.0;
        out.absence = match out.bare {
            Some(_) => Absence::Bare,
            None if out.is_limited => Absence::Limited,
            None => found.absence(),
        };
        if matches!(out.absence, Absence::NoZero | Absence::NotSeen)
            && let Some(steps) = steps(probe.field, bounds)
        {
            (out.steps, out.absence) = (steps, Absence::Steps);
        }
    }
    out
}

/// The values of a field, in ascending order, if it takes a few only and jumps between them.
fn steps(field: &mut dyn Evaluator, bounds: &Bounds) -> Option<Vec<f64>> {
    /// Points along a side of the grid on which the values are listed. Larger: fewer values of
    /// small regions are missed.
    const SIDE: usize = 16;
    /// Largest number of values that are few. A function of one coordinate takes one for each of
    /// its sixteen.
    const MOST: usize = 64;
    /// Paths between two points along which f is evaluated, to distinguish jumps from steep slopes.
    const WAYS: usize = 16;
    /// Values that f may take only at a jump, as sign does at 0. On a slope each step gives one.
    const MOST_AT_A_JUMP: usize = 2;
    let points: Vec<DVec3> = bounds.spread(SIDE).collect();
    // Adding 0 makes −0 equal to 0.
    let mut value_at = |p: DVec3| field.value_and_gradient(p).0 + 0.0;
    let mut values: Vec<f64> = Vec::new();
    let mut ways: Vec<[(DVec3, f64); 2]> = Vec::new();
    let mut before = None;
    for p in points {
        let value = value_at(p);
        if !value.is_finite() {
            continue;
        }
        if let Err(at) = values.binary_search_by(|known| known.total_cmp(&value)) {
            values.insert(at, value);
            if values.len() > MOST {
                return None;
            }
        }
        let here = (p, value);
        ways.extend(before.replace(here).filter(|(_, other)| *other != value).map(|other| [other, here]));
    }
    if values.len() < 2 {
        return None;
    }
    for [mut a, mut b] in selection(&ways, WAYS).copied() {
        let known = values.len();
        loop {
            let middle = 0.5 * (a.0 + b.0);
            if middle == a.0 || middle == b.0 {
                break;
            }
            let value = value_at(middle);
            if value == a.1 {
                a.0 = middle;
                continue;
            } else if !value.is_finite() {
                break;
            }
            if let Err(at) = values.binary_search_by(|known| known.total_cmp(&value)) {
                values.insert(at, value);
                if values.len() > known + MOST_AT_A_JUMP {
                    return None;
                }
            }
            b = (middle, value);
        }
    }
    let frame = field.frame();
    let given = |value: f64| value / f64::from(frame.scale) * frame.double.unwrap_or(1.0);
    Some(values.into_iter().map(given).collect())
}

/// Candidates to move onto the surface.
struct Starts<'a> {
    place: &'a mut [Vec3],
    /// Area that each stands for, if it is at a crossing.
    areas: &'a [Option<f32>],
    is_unsure: &'a [bool],
    /// The branch onto whose surface they are moved, where it gives f; none for f itself.
    branch: Option<u32>,
}

/// Moves the candidates onto the surface and keeps those that converge inside the box, except zeros
/// on a curve or at an isolated point.
fn project(probe: &mut Probe, bounds: &Bounds, starts: Starts, spacing: f32, out: &mut Survey) {
    let Starts { place: start, areas, is_unsure, branch } = starts;
    out.residual = ResidualLimits::UNLIMITED.residual(spacing).max(ulps(bounds));
    let limits = Descent { residual: out.residual, reach: 2.0 * spacing, trust: 0.0 };
    let mut own = probe.on(branch);
    let mut landed = own.land_all(start, out.tolerance().min_gradient, limits, newton::STEPS);
    if branch.is_some() {
        for (landed, &place) in landed.iter_mut().zip(&*start) {
            *landed = landed.filter(|&normal| own.is_on_patch(place, normal, spacing, branch));
        }
    }
    if probe.field.has_limits() {
        for (k, landed) in landed.iter_mut().enumerate() {
            if landed.is_some() && probe.field.is_beyond_limits(start[k].as_dvec3()) {
                out.area -= f64::from(areas[k].unwrap_or(0.0));
                out.is_limited = true;
                *landed = None;
            }
        }
    }
    // In a function with edges, solids may share a face. There f touches zero from below: that is
    // no surface of their union.
    let is_black_box = probe.field.bounded().is_none() && probe.field.pieces().is_some();
    let (touching, inner) =
        touching(probe, start, &landed, |k| is_black_box || is_unsure[k], LARGEST * spacing);
    if is_black_box && inner.len() < landed.iter().flatten().count() {
        for &k in &inner {
            out.area -= f64::from(areas[k].unwrap_or(0.0));
            landed[k] = None;
        }
    }
    let touching: Vec<usize> =
        touching.into_iter().filter(|&k| is_unsure[k] && landed[k].is_some()).collect();
    let mut is_bare = |k: usize| probe.is_bare_zero(start[k].as_dvec3(), bare_size(spacing.into()));
    if selection(&touching, SAMPLES).any(|&k| is_bare(k)) {
        let bare: Vec<Vec3> = touching.iter().filter(|&&k| is_bare(k)).map(|&k| start[k]).collect();
        out.bare = out.bare.or(bare.first().map(|place| place.as_dvec3()));
        // From some places Newton's method ends less near to the zero.
        let is_near =
            |place: Vec3| bare.iter().any(|other| other.distance_squared(place) <= spacing * spacing);
        for k in touching.into_iter().filter(|&k| is_near(start[k])) {
            out.area -= f64::from(areas[k].unwrap_or(0.0));
            landed[k] = None;
        }
    }
    for ((&position, area), normal) in start.iter().zip(areas).zip(landed) {
        if let Some(normal) = normal
            && bounds.contains(position)
        {
            out.push(OrientedPoint { position, normal }, area.unwrap_or(0.0));
        }
    }
}

/// Moves the candidates onto the surface by the branches that give f there, if there are several.
/// In the distance to a box, √(max(u, 0)² + …) + min(max(u, …), 0), the root has no gradient where
/// it vanishes, which includes the surface.
fn project_on_branches(
    probe: &mut Probe,
    bounds: &Bounds,
    found: &Candidates,
    spacing: f32,
    out: &mut Survey,
) {
    let places = found.place.iter().zip(&found.areas).zip(&found.is_unsure);
    let mut candidates: Vec<_> = places
        .map(|((&place, &area), &is_unsure)| (probe.field.label(place.as_dvec3()), place, area, is_unsure))
        .collect();
    sort_by_key(&mut candidates, |&(branch, ..)| branch.into());
    if candidates.first().map(|first| first.0) == candidates.last().map(|last| last.0) {
        return;
    }
    for own in candidates.chunk_by(|a, b| a.0 == b.0) {
        let mut place: Vec<Vec3> = own.iter().map(|&(_, place, ..)| place).collect();
        let areas: Vec<Option<f32>> = own.iter().map(|&(_, _, area, _)| area).collect();
        let is_unsure: Vec<bool> = own.iter().map(|&(.., is_unsure)| is_unsure).collect();
        out.gradient_scale =
            out.gradient_scale.max(gradient_scale(&mut probe.on(Some(own[0].0)), &place, &areas));
        let starts =
            Starts { place: &mut place, areas: &areas, is_unsure: &is_unsure, branch: Some(own[0].0) };
        project(probe, bounds, starts, spacing, out);
    }
}

/// The landed points, with these normals, that have the same sign of f on both sides, and those
/// among them where that sign is negative. Only points for which `is_asked` holds are examined.
fn touching(
    probe: &mut Probe,
    points: &[Vec3],
    landed: &[Option<Vec3>],
    is_asked: impl Fn(usize) -> bool,
    distance: f32,
) -> (Vec<usize>, Vec<usize>) {
    let (mut touching, mut inner) = (Vec::new(), Vec::new());
    let mut sides = [0.0; BATCH];
    let asked: Vec<(usize, Vec3)> = (landed.iter().enumerate())
        .filter_map(|(k, normal)| normal.filter(|_| is_asked(k)).map(|normal| (k, normal)))
        .collect();
    for chunk in asked.chunks(BATCH / 2) {
        let beside: Vec<Vec3> = (chunk.iter())
            .flat_map(|&(k, normal)| [normal, -normal].map(|normal| points[k] + normal * distance))
            .collect();
        probe.field.values(&beside, &mut sides);
        for (&(k, _), [ahead, behind]) in chunk.iter().zip(sides.as_chunks::<2>().0) {
            if ahead * behind >= 0.0 {
                touching.push(k);
            }
            if ahead.max(*behind) < 0.0 {
                inner.push(k);
            }
        }
    }
    (touching, inner)
}

/// The first of a selection of points at which f vanishes only on a curve or at an isolated point.
pub(crate) fn bare_among(
    probe: &mut Probe,
    points: impl Iterator<Item = DVec3>,
    spacing: f64,
) -> Option<DVec3> {
    let points: Vec<DVec3> = points.collect();
    selection(&points, SAMPLES).find(|&&p| probe.is_bare_zero(p, bare_size(spacing))).copied()
}

/// Distance at which f is examined around a zero that may be on no surface, for a grid of this
/// spacing.
pub(crate) fn bare_size(spacing: f64) -> f64 {
    f64::from(LARGEST) * spacing
}

/// The median |∇f| at the candidates where f changes its sign, or at all candidates if it never
/// does. Where f is small compared with its gradient without a change of sign, both may be of any
/// size.
fn gradient_scale(probe: &mut Probe, start: &[Vec3], areas: &[Option<f32>]) -> f32 {
    let by_crossings = areas.iter().any(Option::is_some);
    let mut slopes = Vec::new();
    for (chunk, areas) in start.chunks(BATCH).zip(areas.chunks(BATCH)) {
        let (_, gradient) = probe.gradients(chunk);
        let counted = gradient.iter().zip(areas).filter(|(_, area)| area.is_some() || !by_crossings);
        slopes.extend(counted.map(|(g, _)| g.length()).filter(|g| g.is_finite() && *g > 0.0));
    }
    median(slopes).unwrap_or(0.0)
}

impl Survey {
    /// Adds a point that stands for an area.
    fn push(&mut self, OrientedPoint { position, normal }: OrientedPoint, area: f32) {
        self.position.push(position);
        self.normal.push(normal);
        self.weight.push(area);
    }

    /// Limits for the residual of particles on this surface.
    pub(crate) fn residual_limits(&self) -> ResidualLimits {
        /// Share of the crowding, which is one to two times the distance of the nearest other
        /// sheet: a particle stays within a fifth of the way there.
        const SHARE: f32 = 0.1;
        let gap = self.nearness.map_or(f32::INFINITY, |near| near.gap as f32);
        ResidualLimits { finest: self.resolution, coarsest: SHARE * self.crowding.min(gap) }
    }

    /// Sheets nearer to each other than this are not distinguished.
    pub(crate) fn least_gap(&self, is_adaptive: bool) -> f64 {
        UNRESOLVED[usize::from(is_adaptive)] * f64::from(self.resolution)
    }

    /// Tolerance for points of the surface before there is a radius.
    pub(crate) fn tolerance(&self) -> Tolerance {
        let residual = self.residual.max(self.resolution);
        Tolerance { residual, ..tolerance(0.0, ResidualLimits::UNLIMITED, self.gradient_scale) }
    }

    /// Takes over the points that another search has `found`, if the survey has none, or its proof
    /// that there are none.
    pub(crate) fn adopt(
        &mut self,
        field: &mut dyn Evaluator,
        found: impl Iterator<Item = (Vec3, Vec3)>,
        bounds: &Bounds,
        search: Search,
    ) {
        self.is_adopted = true;
        let mut slopes = Vec::new();
        for (position, normal) in found {
            let jet = field.jet(position.as_dvec3());
            // By f as a whole, which may have no gradient where its branches have one.
            slopes.extend(Some(jet.gradient.length() as f32).filter(|slope| slope.is_finite()));
            // A sphere of the same curvature has the area 4π/κ².
            let size = jet.gradient.length_squared()
                / jet.hessian.apply(normal.any_orthonormal_vector().as_dvec3()).length_squared();
            let sphere = 4.0 * core::f64::consts::PI * size;
            let most = bounds.diagonal() * bounds.diagonal();
            // The search finds two points on each sphere, the highest and the lowest.
            self.area += if sphere < most { 0.5 * sphere } else { 0.0 };
            self.push(OrientedPoint { position, normal }, 0.0);
        }
        self.gradient_scale = median(slopes).unwrap_or(self.gradient_scale);
        if !self.position.is_empty() {
            self.absence = Absence::None;
        } else if search == Search::Proven && matches!(self.absence, Absence::NoZero | Absence::NotSeen) {
            self.absence = Absence::Proven;
        }
    }

    /// The point of this index, and the normal there.
    pub(crate) fn point(&self, i: usize) -> Option<OrientedPoint> {
        Some(OrientedPoint { position: *self.position.get(i)?, normal: self.normal[i] })
    }

    /// A point at which a random line through the box meets the surface; none if many lines miss
    /// it. It is uniformly distributed on the surface (L. A. Santaló, "Integral Geometry and
    /// Geometric Probability", §14.3, 1976), and moves little when the surface does, unlike a point
    /// of the survey.
    pub(crate) fn on_random_line(
        &self,
        probe: &mut Probe,
        bounds: &Bounds,
        random: &mut impl Rng,
    ) -> Option<OrientedPoint> {
        /// Lines tried. In a box that fits the surface a third of them meet it.
        const LINES: u32 = 64;
        /// Least cosine of the angle between line and normal: 60°. Where a line grazes the surface,
        /// the point moves more than that. Smaller: holes are wider.
        const LEAST_COSINE: f32 = 0.5;
        let Tolerance { residual, min_gradient, .. } = self.tolerance();
        // One more step from there.
        let limits = Descent { trust: residual, ..Descent::default() };
        for _ in 0..LINES {
            let mut share = || f64::from(random.next_u32()) / 4_294_967_296.0;
            let [a, b] =
                [(); 2].map(|()| bounds.lo() + bounds.size() * DVec3::new(share(), share(), share()));
            // On the line through both, as far beyond each as they are apart.
            let place = |k: usize| a.lerp(b, 3.0 * k as f64 / (BATCH - 1) as f64 - 1.0).as_vec3();
            let places: [Vec3; BATCH] = core::array::from_fn(place);
            let along = (b - a).as_vec3().normalize_or_zero();
            let mut values = [0.0; BATCH];
            values.copy_from_slice(probe.gradients(&places).0);
            for (p, f) in places.windows(2).zip(values.windows(2)) {
                if !(f[0].is_finite() && f[1].is_finite()) || (f[0] <= 0.0) == (f[1] <= 0.0) {
                    continue;
                }
                let mut place = [p[0].lerp(p[1], f[0] / (f[0] - f[1]))];
                let landed = probe.land_all(&mut place, min_gradient, limits, newton::STEPS);
                if let (&[Some(normal)], [position]) = (&landed[..], place)
                    && bounds.contains(position)
                    && normal.dot(along).abs() >= LEAST_COSINE
                {
                    return Some(OrientedPoint { position, normal });
                }
            }
        }
        None
    }

    /// Whether f has a zero at a point of the survey and not a pole, where |f|/|∇f| vanishes too:
    /// |f| grows away from a zero and falls away from a pole.
    pub(crate) fn is_zero(&self, probe: &mut Probe, point: OrientedPoint) -> bool {
        let OrientedPoint { position: p, normal: n } = point;
        let step = POLE_PROBE * self.residual.max(self.resolution);
        let (value, _) = probe.gradients(&[p, p + n * step, p - n * step]);
        // NaN, where f ends, is no larger.
        value[1].abs() > value[0].abs() || value[2].abs() > value[0].abs()
    }
}

/// Largest distance at which f is evaluated on either side of a point, as a share of the grid's
/// spacing; it is halved from there.
const LARGEST: f32 = 0.125;
/// Number of points for a median or a quartile, which then rests on 12 of them.
pub(super) const FEW: usize = 48;
/// Number of points or particles to examine, spread over all: a share among them equals the share
/// among all to 3 %.
pub(crate) const SAMPLES: usize = 256;
/// Distance, in resolutions, below which rounding may decide the sign of f: the least distance at
/// which sheets are distinguished.
const NOISE: f32 = UNRESOLVED[0] as f32;

/// At most `most` of some values, spread over all of them.
fn selection<T>(all: &[T], most: usize) -> impl Iterator<Item = &T> {
    all.iter().step_by(all.len().div_ceil(most).max(1))
}

/// Two units in the last place of the largest coordinate in a box; positions themselves are rounded
/// to half of one.
pub(super) fn ulps(bounds: &Bounds) -> f32 {
    let reach = bounds.min.iter().chain(&bounds.max).fold(0.0_f64, |m, c| m.max(c.abs())) as f32;
    2.0 * f32::EPSILON * reach
}

/// Finds out how near to the surface particles have to be, considering rounding and sheets near
/// each other, and whether f only touches zero.
fn measure_precision(probe: &mut Probe, bounds: &Bounds, spacing: f32, out: &mut Survey) {
    out.resolution = ulps(bounds).max(rounding(probe, &out.position));
    // A field without bounds is one through points, whose sheets are as far from each other as the
    // points. It bends at each.
    out.crowding = f32::INFINITY;
    let mut is_facing_another = false;
    if probe.field.bounded().is_some() {
        is_facing_another = look_for_near_sheets(probe.field, out, spacing);
        if out.nearness.is_some() {
            land_anew(probe, out);
        }
        out.crowding = crowding(probe, out, spacing);
    }
    out.touches = !is_facing_another && touches(probe, out, LARGEST * spacing);
}

/// Searches in double precision for near sheets at a selection of the points. Returns whether more
/// than half of these have one.
fn look_for_near_sheets(field: &mut dyn Evaluator, out: &mut Survey, spacing: f32) -> bool {
    /// Largest distance, in grid spacings, at which the tolerance of particles depends on another
    /// sheet: a hundred times that to which the survey's points land.
    const MOST: f32 = 0.01;
    let points: Vec<DVec3> = selection(&out.position, SAMPLES).map(|p| p.as_dvec3()).collect();
    let (found, count) = nearest(field, points.iter().copied(), f64::from(MOST * spacing));
    out.nearness = found;
    if let Some(Nearness { slope, .. }) = out.nearness {
        // On the sheets themselves f is far less steep than outside of all of them.
        out.gradient_scale = out.gradient_scale.min(slope as f32);
    }
    2 * count > points.len()
}

/// Moves the points to where near sheets are distinguished, and drops those that find none.
fn land_anew(probe: &mut Probe, out: &mut Survey) {
    let residual = out.residual_limits().residual(f32::INFINITY);
    out.residual = residual.min(out.residual);
    let least = out.tolerance().min_gradient;
    let limits = Descent { residual: out.residual, ..Descent::default() };
    let mut points = core::mem::take(&mut out.position);
    let landed = probe.land_all(&mut points, least, limits, STEPS);
    let weights = core::mem::take(&mut out.weight);
    out.normal.clear();
    for ((position, weight), normal) in points.into_iter().zip(weights).zip(landed) {
        if let Some(normal) = normal {
            out.push(OrientedPoint { position, normal }, weight);
        }
    }
}

/// Whether f has the same sign on both sides of most of a selection of the points, at `distance`
/// and nearer: farther away there may be another sheet.
fn touches(probe: &mut Probe, survey: &Survey, distance: f32) -> bool {
    let (mut same, mut seen) = (0, 0);
    let normals = selection(&survey.normal, FEW);
    for (&p, &n) in selection(&survey.position, FEW).zip(normals) {
        let mut is_same_at = |d: f32| {
            let (value, _) = probe.gradients(&[p + n * d, p - n * d]);
            value[0] * value[1] > 0.0
        };
        let mut d = distance;
        let mut is_same = is_same_at(d);
        // Nearer than some resolutions, rounding decides the sign.
        while is_same && 0.5 * d > NOISE * survey.resolution {
            d *= 0.5;
            is_same = is_same_at(d);
        }
        same += usize::from(is_same);
        seen += 1;
    }
    2 * same > seen
}

/// Searches for [`Survey::crowding`] at a selection of the points: for the sign that f has beyond
/// another sheet. The normals distinguish the two sides of a plate; so f must have that sign on
/// both sides, or its own again beyond.
fn crowding(probe: &mut Probe, survey: &Survey, spacing: f32) -> f32 {
    /// Distances, each half of the one before, down to 10⁻⁵ of the grid's spacing. One of them lies
    /// between any two sheets if one is twice as far as the other.
    const DISTANCES: usize = 14;
    let distances: [f32; DISTANCES] = core::array::from_fn(|k| LARGEST * spacing / (1_u32 << k) as f32);
    let mut least = f32::INFINITY;
    let mut points: Vec<Vec3> = selection(&survey.position, SAMPLES).copied().collect();
    // The points may be as far from their sheets as the sheets are from each other. A point that
    // cannot come nearer shows nothing.
    let limits = Descent { residual: 2.0 * survey.resolution, reach: survey.residual, trust: 0.0 };
    let landed = probe.land_all(&mut points, survey.tolerance().min_gradient, limits, newton::STEPS);
    for (p, normal) in points.into_iter().zip(landed) {
        let Some(n) = normal else { continue };
        let mut nearest = [f32::INFINITY; 2];
        let mut is_between = false;
        for (side, nearest) in [1.0, -1.0].into_iter().zip(&mut nearest) {
            let (value, _) = probe.gradients(&distances.map(|d| p + n * (side * d)));
            let mut comes_back = false;
            // From far to near; nearer than some resolutions, rounding decides the sign.
            for (&d, &value) in distances.iter().zip(value).filter(|(d, _)| **d > NOISE * survey.resolution) {
                let is_beyond = value * side < 0.0;
                *nearest = if is_beyond { d } else { *nearest };
                is_between |= is_beyond && comes_back;
                comes_back |= value * side > 0.0;
            }
        }
        let [ahead, behind] = nearest;
        if is_between || ahead.max(behind) < f32::INFINITY {
            least = least.min(ahead.min(behind));
        }
    }
    least
}

/// Upper quartile of the distance between the surface in single and in double precision, doubled.
fn rounding(probe: &mut Probe, points: &[Vec3]) -> f32 {
    let mut distance: Vec<f32> = selection(points, FEW)
        .filter_map(|&p| {
            let (value, gradient) = probe.gradient(p);
            let exact = probe.field.jet(p.as_dvec3());
            let d = ((f64::from(value) - exact.value).abs() / f64::from(gradient.length())) as f32;
            d.is_finite().then_some(d)
        })
        .collect();
    sort_numbers(&mut distance);
    2.0 * distance.get(distance.len() * 3 / 4).copied().unwrap_or(0.0)
}
