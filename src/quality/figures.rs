//! The figures themselves.

use super::border::Border;
use super::cover::{Gaps, Holes, Places};
use super::fans::unroll;
use super::sizes::{Wanted, length, mutual};
use super::triangles::{area_vector, topology};
use super::{Options, Prepared, Scene, components, probe};
use crate::field::Field;
use crate::math::{Bounds, SQRT_3, tangent_frame};
use crate::pieces::{piece, ranges};
use crate::spatial::tree::{key, unkey};
use glam::{DVec2, DVec3, Vec3};
use serde::Serialize;

/// Most random places for `quant`: the error falls with their root, the time grows with their number.
const MOST_SAMPLES: usize = 262_144;
/// Mean squared distance to the nearest point of a hexagonal lattice, over its area per point: 5 / (18 √3).
const HEXAGONAL_QUANT: f64 = 5.0 / (18.0 * SQRT_3);
/// Points, triangles or places looked at in one piece of work.
const PIECE: usize = 256;
/// Triangles are larger than this many d_hex only where holes are.
const WIDE: f64 = 2.0;

/// One number per property; NaN (null in JSON) where undefined. Lengths are over d_hex unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Spacing of a perfect hexagonal lattice of as many points on the same area, √(2A/(√3 N)), in the field's units.
    pub d_hex: f64,
    /// Area, as given or of the triangles found, in the field's units.
    pub area: f64,
    /// Largest first-order distance |f|/|∇f| to the surface.
    pub err_max: f64,
    /// Mean first-order distance to the surface.
    pub err_mean: f64,
    /// Points whose residual is undefined (∇f = 0 or f undefined); left out of `err_max` and `err_mean`.
    pub undefined: usize,
    /// Smallest nearest-neighbour distance.
    pub nn_min: f64,
    /// Mean nearest-neighbour distance.
    pub nn_mean: f64,
    /// Standard deviation of the nearest-neighbour distance over its mean.
    pub nn_cv: f64,
    /// Smallest over mean nearest-neighbour distance.
    pub nn_ratio: f64,
    /// Normalised Poisson-disk radius: `nn_min` under its usual name.
    pub rho: f64,
    /// First percentile of the nearest-neighbour distance.
    pub rho_1: f64,
    /// Radius of the largest hole over d_hex/√3, that of the perfect lattice: 1 is ideal.
    pub cover: f64,
    /// Mean squared distance from the surface to the nearest point over that of the perfect lattice: 1 is ideal.
    pub quant: f64,
    /// Fraction of the points with exactly six natural neighbours.
    pub six: f64,
    /// Fraction of the points with five or seven natural neighbours.
    pub five_seven: f64,
    /// Standard deviation of the valence.
    pub val_sd: f64,
    /// Number of points whose cell is not proven complete among their 200 nearest points.
    pub open: usize,
    /// Mean over the points of |mean over natural neighbours of exp(6iθ)|: 1 for a lattice.
    pub psi6: f64,
    /// Kept triangles over 2N − 2χ: 1 for a closed manifold. On a clipped surface, the share of the sectors around
    /// points away from the border that a kept triangle fills.
    pub tri_ok: f64,
    /// Fraction of the triangles found (away from the border) that all three corners agree on.
    pub agree: f64,
    /// Euler number of the kept triangles, quarrels settled (see [`super::triangles`]).
    pub euler: i64,
    /// Connected pieces of the surface by the natural neighbours: those of the same triangles, and points far from all of them.
    pub components: usize,
    /// Smallest angle of any triangle, in degrees.
    pub ang_min: f64,
    /// Mean over the triangles of their smallest angle, in degrees.
    pub ang_min_mean: f64,
    /// Fraction of the triangles with an angle below 30°.
    pub lt30: f64,
    /// Fraction of the triangles with an angle above 90°.
    pub gt90: f64,
    /// Fraction of all angles below 30°.
    pub a_lt30: f64,
    /// Fraction of all angles above 90°.
    pub a_gt90: f64,
    /// Standard deviation over mean of the length of mutual natural-neighbour edges.
    pub edge_cv: f64,
    /// Standard deviation over mean of edge length over the sum of the wanted radii.
    pub size_cv: f64,
    /// Largest hole relative to the ideal one where it is: over the holes of a hexagonal lattice of the wanted radii there
    /// (the mean of those of the points around the hole), all scaled by one factor so that the cells have the area. 1 is
    /// ideal, and where all radii are equal this is `cover`.
    pub cover_local: f64,
    /// Smallest distance of natural neighbours over the sum of their wanted radii, in which a duplicate has 0. 1 where
    /// particles just touch.
    pub overlap_min: f64,
    /// Points closer than 1e-6 to an earlier one; dropped before the triangulation.
    pub dup: usize,
    /// Points with a non-finite coordinate; left out of everything.
    pub not_finite: usize,
    /// Mean angle between the given normals (either sign) and ∇f, in degrees.
    pub nrm_mean: f64,
    /// Largest angle between the given normals (either sign) and ∇f, in degrees.
    pub nrm_max: f64,
    /// Points within 4 d_hex of the border of a clipped surface, left out of the per-point figures.
    pub boundary_excluded: usize,
}

impl Default for Figures {
    /// Nothing measured.
    fn default() -> Self {
        let undefined = f64::NAN;
        Self {
            d_hex: undefined,
            area: undefined,
            err_max: undefined,
            err_mean: undefined,
            undefined: 0,
            nn_min: undefined,
            nn_mean: undefined,
            nn_cv: undefined,
            nn_ratio: undefined,
            rho: undefined,
            rho_1: undefined,
            cover: undefined,
            quant: undefined,
            six: undefined,
            five_seven: undefined,
            val_sd: undefined,
            open: 0,
            psi6: undefined,
            tri_ok: undefined,
            agree: undefined,
            euler: 0,
            components: 0,
            ang_min: undefined,
            ang_min_mean: undefined,
            lt30: undefined,
            gt90: undefined,
            a_lt30: undefined,
            a_gt90: undefined,
            edge_cv: undefined,
            size_cv: undefined,
            cover_local: undefined,
            overlap_min: undefined,
            dup: 0,
            not_finite: 0,
            nrm_mean: undefined,
            nrm_max: undefined,
            boundary_excluded: 0,
        }
    }
}

/// Counts of nearest-neighbour distances over d_hex, in equal bins; values outside fall into the outermost bins.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Histogram {
    /// Lower end of the first bin.
    pub min: f64,
    /// Upper end of the last bin.
    pub max: f64,
    /// Counts.
    pub bins: Vec<u32>,
}

impl Histogram {
    /// A fixed range, so that two runs can be laid over each other: the perfect lattice has 1.
    const RANGE: (f64, f64) = (0.0, 1.2);
    /// Bins of 0.01.
    const BINS: usize = 120;

    pub(super) fn new(nearest: &[f32], d_hex: f64) -> Self {
        let (min, max) = Self::RANGE;
        let mut bins = vec![0; Self::BINS];
        for &distance in nearest {
            let place = (f64::from(distance) / d_hex - min) / (max - min) * Self::BINS as f64;
            if !place.is_nan() {
                bins[(place as usize).min(Self::BINS - 1)] += 1;
            }
        }
        Self { min, max, bins }
    }
}

/// Mean and spread of numbers that arrive one by one (Welford's update).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Moments {
    pub(super) fn add(&mut self, value: f64) {
        self.count += 1.0;
        let step = value - self.mean;
        self.mean += step / self.count;
        self.squares += step * (value - self.mean);
    }

    pub(super) fn mean(&self) -> f64 {
        if self.count > 0.0 { self.mean } else { f64::NAN }
    }

    /// Of the population; NaN for none.
    fn deviation(&self) -> f64 {
        (self.squares / self.count).sqrt()
    }

    pub(super) fn variation(&self) -> f64 {
        self.deviation() / self.mean()
    }
}

/// Share of `count` in `all`; NaN of nothing.
fn share(count: usize, all: usize) -> f64 {
    count as f64 / all as f64
}

pub(super) fn d_hex(area: f64, count: usize) -> f64 {
    (2.0 * area / (SQRT_3 * count as f64)).sqrt()
}

/// Area of the triangles.
pub(super) fn area(scene: &Scene, mesh: &[[u32; 3]]) -> f64 {
    mesh.iter().map(|&triangle| 0.5 * area_vector(&scene.tree.position, triangle).length()).sum()
}

/// The figures, and the connected piece of each point.
pub(super) async fn figures(
    prepared: &Prepared,
    field: &mut dyn Field,
    bounds: Option<&Bounds>,
    options: &Options<'_>,
) -> (Figures, Vec<u32>) {
    let Prepared { scene, triangles, mesh, duplicates, not_finite, .. } = prepared;
    let mut figures = Figures { dup: *duplicates, not_finite: *not_finite, ..Figures::default() };
    let n = scene.tree.len();
    if n == 0 {
        return (figures, Vec::new());
    }
    figures.area = options.area.unwrap_or_else(|| area(scene, mesh));
    figures.d_hex = d_hex(figures.area, n + duplicates);
    piece().await;
    residuals(scene, &mut figures);
    (figures.nrm_mean, figures.nrm_max) = scene.tilt.figures();

    let border = match bounds {
        Some(bounds) => Some(Border::new(field, bounds, &scene.tree, figures.d_hex).await),
        None => None,
    };
    let mut inner = vec![true; n];
    if let Some(border) = &border {
        for range in ranges(n, PIECE) {
            range.for_each(|i| inner[i] = !border.is_near(scene.tree.position[i]));
            piece().await;
        }
    }
    figures.boundary_excluded = inner.iter().filter(|&&inner| !inner).count();
    piece().await;
    spacing(scene, &inner, &mut figures);
    piece().await;

    let wanted = Wanted::new(scene, &inner, field, options.sizes, figures.area).await;
    let mut order = Order::default();
    let mut edge = Moments::default();
    let mut sized = Sized::default();
    for range in ranges(n, PIECE) {
        for i in range.filter(|&i| inner[i]) {
            order.add(scene, i);
            mutual(scene, &inner, i).for_each(|j| edge.add(length(scene, i, j)));
            wanted.iter().for_each(|wanted| sized.add(wanted, scene, &inner, i));
        }
        piece().await;
    }
    order.figures(&mut figures);
    figures.edge_cv = edge.variation();
    if wanted.is_some() {
        figures.size_cv = sized.edge.variation();
        figures.overlap_min = if *duplicates > 0 { 0.0 } else { sized.least };
    }

    let away = |triangle: &&[u32; 3]| triangle.iter().all(|&i| inner[i as usize]);
    let mut shapes = Shapes::default();
    let mut corners = 0;
    for list in [&triangles.unanimous, &triangles.majority] {
        for chunk in list.chunks(PIECE) {
            chunk.iter().filter(away).for_each(|&triangle| shapes.add(scene, triangle));
            corners += chunk.iter().flatten().filter(|&&i| inner[i as usize]).count();
            piece().await;
        }
    }
    shapes.figures(&mut figures);
    figures.euler = topology(n, mesh);
    piece().await;
    let (component, count) = components::label(scene, mesh).await;
    figures.components = count;
    let unanimous = triangles.unanimous.iter().filter(away).count();
    figures.agree = share(unanimous, shapes.count + triangles.single.iter().filter(away).count());
    figures.tri_ok = if figures.boundary_excluded == 0 {
        triangles.kept().count() as f64 / (2 * n as i64 - 2 * options.euler.unwrap_or(figures.euler)) as f64
    } else {
        // Share of the sectors between consecutive neighbours of inner points that a kept triangle fills.
        share(corners, (0..n).filter(|&i| inner[i]).map(|i| scene.fans.valence(i)).sum())
    };
    if !mesh.is_empty() {
        let (border, wanted) = (border.as_ref(), wanted.as_ref());
        let places = Places { tree: &scene.tree, mesh, border, wanted, wide: (WIDE * figures.d_hex) as f32 };
        let samples = n.max(options.samples).min(MOST_SAMPLES);
        let mut gaps = Gaps::default();
        gaps.add_places(field, &places, samples, options.seed).await;
        gaps.add_corners(field, &places).await;
        let missed = match bounds {
            Some(bounds) => missed(&places, field, bounds, options.seed, gaps.holes()).await,
            None => Missed::default(),
        };
        let holes = gaps.holes().or(missed.holes);
        figures.cover = holes.widest / (figures.d_hex / SQRT_3);
        if wanted.is_some() {
            figures.cover_local = holes.relative;
        }
        let mean_sq = gaps.mean_sq() * (1.0 - missed.share) + missed.sum_sq;
        figures.quant = mean_sq / (HEXAGONAL_QUANT * figures.area / (n + duplicates) as f64);
    }
    (figures, component)
}

/// Places of the surface farther from every particle than any place that the triangles span.
#[derive(Clone, Copy, Debug, Default)]
struct Missed {
    /// Share of the area.
    share: f64,
    /// Sum of the squared distances of such places to the nearest particle, over the number of all places.
    sum_sq: f64,
    holes: Holes,
}

async fn missed(
    places: &Places<'_>,
    field: &mut dyn Field,
    bounds: &Bounds,
    seed: u64,
    spanned: Holes,
) -> Missed {
    let mut missed = Missed::default();
    let (mut all, mut far) = (0.0, 0.0);
    for chunk in probe::crossings(field, bounds, seed).await.chunks(PIECE) {
        for &p in chunk.iter().filter(|&&p| places.counts(p)) {
            all += 1.0;
            let (gap_sq, index) = places.tree.nearest(p, u32::MAX, f32::INFINITY);
            if index == u32::MAX {
                continue;
            }
            let gap = f64::from(gap_sq).sqrt();
            let relative = gap / f64::from(places.ideal(&[index]));
            // A hundredth more for the rounding of the places.
            if gap > 1.01 * spanned.widest {
                far += 1.0;
                missed.sum_sq += gap * gap;
                missed.holes.widest = missed.holes.widest.max(gap);
            }
            if relative > 1.01 * spanned.relative {
                missed.holes.relative = missed.holes.relative.max(relative);
            }
        }
        piece().await;
    }
    if all > 0.0 {
        missed.share = far / all;
        missed.sum_sq /= all;
    }
    missed
}

fn residuals(scene: &Scene, figures: &mut Figures) {
    let mut err = Moments::default();
    let mut largest = f64::NAN;
    for &residual in &scene.residual {
        if residual.is_finite() {
            err.add(residual);
            largest = largest.max(residual);
        } else {
            figures.undefined += 1;
        }
    }
    figures.err_mean = err.mean() / figures.d_hex;
    figures.err_max = largest / figures.d_hex;
}

fn spacing(scene: &Scene, inner: &[bool], figures: &mut Figures) {
    // As sortable keys. A dropped duplicate is a point too, at distance 0 from the one it equals.
    let mut sorted: Vec<u64> = (0..inner.len())
        .filter(|&i| inner[i])
        .map(|i| scene.nearest(i))
        .filter(|d| d.is_finite())
        .chain(core::iter::repeat_n(0.0, figures.dup))
        .map(|d| key(d, 0))
        .collect();
    if sorted.is_empty() {
        return;
    }
    sorted.sort_unstable();
    let distance = |k: usize| f64::from(unkey(sorted[k]).0);
    let mut moments = Moments::default();
    (0..sorted.len()).for_each(|k| moments.add(distance(k)));
    figures.nn_min = distance(0) / figures.d_hex;
    figures.rho = figures.nn_min;
    figures.nn_mean = moments.mean() / figures.d_hex;
    figures.nn_cv = moments.variation();
    figures.nn_ratio = distance(0) / moments.mean();
    // The first percentile, linear between two distances.
    let place = 0.01 * (sorted.len() - 1) as f64;
    let (below, above) = (distance(place as usize), distance((place as usize + 1).min(sorted.len() - 1)));
    figures.rho_1 = (below + (above - below) * place.fract()) / figures.d_hex;
}

/// Neighbours and their directions.
#[derive(Default)]
struct Order {
    count: usize,
    open: usize,
    six: usize,
    five_seven: usize,
    valence: Moments,
    psi6: Moments,
}

impl Order {
    fn add(&mut self, scene: &Scene, i: usize) {
        self.count += 1;
        if !scene.fans.closed[i] {
            self.open += 1;
            return;
        }
        let neighbours = scene.fans.valence(i);
        self.valence.add(neighbours as f64);
        self.six += usize::from(neighbours == 6);
        self.five_seven += usize::from(neighbours == 5 || neighbours == 7);
        let (u, v) = tangent_frame(scene.normal[i]);
        let (u, v) = (u.as_dvec3(), v.as_dvec3());
        let p = scene.tree.position[i].as_dvec3();
        let mut sum = DVec2::ZERO;
        for j in scene.fans.of(i) {
            if let Some(q) = unroll(scene.tree.position[j].as_dvec3() - p, u, v) {
                // exp(iθ) to its sixth power, by products.
                let unit = q / q.length();
                let square = unit.rotate(unit);
                sum += square.rotate(square).rotate(square);
            }
        }
        self.psi6.add(sum.length() / neighbours as f64);
    }

    fn figures(&self, figures: &mut Figures) {
        figures.open = self.open;
        figures.six = share(self.six, self.count);
        figures.five_seven = share(self.five_seven, self.count);
        figures.val_sd = self.valence.deviation();
        figures.psi6 = self.psi6.mean();
    }
}

/// Edges in units of the wanted radii.
struct Sized {
    edge: Moments,
    least: f64,
}

impl Default for Sized {
    fn default() -> Self {
        Self { edge: Moments::default(), least: f64::NAN }
    }
}

impl Sized {
    fn add(&mut self, wanted: &Wanted, scene: &Scene, inner: &[bool], i: usize) {
        mutual(scene, inner, i)
            .map(|j| wanted.ratio(scene, i, j))
            .filter(|ratio| ratio.is_finite())
            .for_each(|ratio| self.edge.add(ratio));
        self.least = scene.fans.of(i).map(|j| wanted.ratio(scene, i, j)).fold(self.least, f64::min);
    }
}

/// Angles of triangles.
#[derive(Default)]
struct Shapes {
    count: usize,
    smallest: Moments,
    least: Option<f64>,
    lt30: usize,
    gt90: usize,
    a_lt30: usize,
    a_gt90: usize,
}

impl Shapes {
    fn add(&mut self, scene: &Scene, triangle: [u32; 3]) {
        let corner = triangle.map(|i| scene.tree.position[i as usize].as_dvec3());
        let twice_area = area_vector(&scene.tree.position, triangle).length();
        // At each corner the sides' product gives |a||b| cos; |a||b| sin is twice the area.
        let cosines: [f64; 3] =
            core::array::from_fn(|k| (corner[(k + 1) % 3] - corner[k]).dot(corner[(k + 2) % 3] - corner[k]));
        // With one sine, the smallest angle has the largest cosine; below 30° when tan < 1/√3.
        let sharp = cosines.iter().filter(|&&c| twice_area * SQRT_3 < c).count();
        let blunt = cosines.iter().filter(|&&c| c < 0.0).count();
        self.count += 1;
        self.a_lt30 += sharp;
        self.a_gt90 += blunt;
        self.lt30 += usize::from(sharp > 0);
        self.gt90 += usize::from(blunt > 0);
        let largest_cosine = cosines[0].max(cosines[1]).max(cosines[2]);
        let angle = libm::atan2(twice_area, largest_cosine).to_degrees();
        self.smallest.add(angle);
        self.least = Some(self.least.unwrap_or(angle).min(angle));
    }

    fn figures(&self, figures: &mut Figures) {
        figures.ang_min = self.least.unwrap_or(f64::NAN);
        figures.ang_min_mean = self.smallest.mean();
        figures.lt30 = share(self.lt30, self.count);
        figures.gt90 = share(self.gt90, self.count);
        figures.a_lt30 = share(self.a_lt30, 3 * self.count);
        figures.a_gt90 = share(self.a_gt90, 3 * self.count);
    }
}

/// Angles between given normals and the gradient.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tilt {
    angle: Moments,
    largest: f64,
}

impl Tilt {
    /// Adds a pair, if both are vectors with a direction.
    pub(super) fn add(&mut self, normal: Vec3, gradient: DVec3) {
        let normal = normal.as_dvec3();
        let (across, along) = (normal.cross(gradient).length(), normal.dot(gradient).abs());
        if across + along > 0.0 && across.is_finite() && along.is_finite() {
            let degrees = libm::atan2(across, along).to_degrees();
            self.angle.add(degrees);
            self.largest = self.largest.max(degrees);
        }
    }

    /// Mean and largest angle in degrees; NaN for none.
    pub(super) fn figures(&self) -> (f64, f64) {
        let mean = self.angle.mean();
        (mean, if mean.is_nan() { mean } else { self.largest })
    }
}
