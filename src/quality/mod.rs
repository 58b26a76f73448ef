//! How good a set of particles is: residual, spacing, holes, order and triangles, one definition per figure.
//!
//! The figures depend on the points and the field alone, never on who made the points, so that any two samplers can
//! be compared. Lengths are in units of d_hex = √(2A / (√3 N)), the spacing of a perfect hexagonal lattice of N
//! points on the area A, unless said otherwise.
//!
//! Natural neighbours: the points of the same sheet (normals within 90°, and the line between two points leaves one tangent
//! plane about as it arrives at the other: sheets that face the same way are told apart) are unrolled to the tangent plane of a point,
//! keeping their true distance; its neighbours are those of its Voronoi cell there. That cell is clipped by the
//! nearest points until no farther one can matter. This gives the same neighbours as the convex hull of the inverted
//! points q/|q|², without a hull.
//!
//! The whole report costs a few microseconds per particle. It is deterministic, with the same bits natively and in
//! WebAssembly when the field is.

mod border;
mod cell;
mod components;
mod cover;
mod fans;
mod figures;
mod nearby;
mod probe;
mod sizes;
mod triangles;

pub use figures::{Figures, Histogram};

use crate::field::Field;
use crate::field::scaled::{Scaled, comfortable_factor};
use crate::math::Bounds;
use crate::pieces::{self, piece};
use crate::spatial::tree::Tree;
use fans::Fans;
use figures::Tilt;
use glam::{DVec3, Vec3};
use triangles::Triangles;

/// Points closer than this many d_hex to an earlier one are duplicates of it.
const DUPLICATE: f64 = 1e-6;
/// Points at which the field is evaluated together, in one piece of work.
const BATCH: usize = 64;

/// The wanted radius of each particle, for [`Figures::size_cv`], [`Figures::cover_local`] and [`Figures::overlap_min`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Sizes<'a> {
    /// No wanted size: those figures are NaN.
    #[default]
    None,
    /// One radius per particle; particles without one (a slice that is too short) are left out.
    Given(&'a [f32]),
    /// Half the mean length of the particle's own edges: small when the sizes change smoothly.
    Local,
    /// 1 / clamp(max |principal curvature|, lowest, highest), from the field.
    Curvature {
        /// Lowest curvature.
        lowest: f64,
        /// Highest curvature.
        highest: f64,
    },
}

/// What is known beside the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options<'a> {
    /// Exact area of the surface (inside the box); by default the area of the triangles found.
    pub area: Option<f64>,
    /// Euler number of the surface, for [`Figures::tri_ok`]; by default that of the triangles found.
    pub euler: Option<i64>,
    /// Wanted radii.
    pub sizes: Sizes<'a>,
    /// Fewest random places for [`Figures::quant`]; there is at least one per particle, and at most 262,144.
    pub samples: usize,
    /// Seed of the random places.
    pub seed: u64,
}

impl Default for Options<'_> {
    fn default() -> Self {
        // 65,536 stratified places give `quant` to about 0.1 %.
        Self { area: None, euler: None, sizes: Sizes::None, samples: 65_536, seed: 0 }
    }
}

/// Figures of a set of particles, and what is known of each particle, in the order given.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// The figures.
    pub figures: Figures,
    /// Number of natural neighbours; 0 for a duplicate or a non-finite position. At the border of a clipped surface the
    /// cell is open, and the neighbours found are counted.
    pub valence: Vec<u8>,
    /// Distance to the nearest other particle, of any sheet, in the field's units; infinite for a lone one, NaN for a
    /// non-finite position.
    pub nearest: Vec<f32>,
    /// First-order distance to the surface |f|/|∇f|, in the field's units; NaN where that is undefined.
    pub residual: Vec<f32>,
    /// Connected piece of the surface, by the natural neighbours: 0 is the one with most particles. A duplicate is on the
    /// piece of the particle it equals; `u32::MAX` for a non-finite position.
    pub component: Vec<u32>,
    /// Counts of `nearest` / d_hex.
    pub histogram: Histogram,
}

/// Everything the figures are made from; arrays are in tree order.
struct Scene {
    tree: Tree,
    /// Unit normals: ∇f/|∇f|, or the given normal where that is undefined.
    normal: Vec<Vec3>,
    residual: Vec<f64>,
    /// Angles between the given normals and ∇f.
    tilt: Tilt,
    fans: Fans,
    /// Squared distance to the nearest point is 0 because a duplicate was dropped.
    twin: Vec<bool>,
}

impl Scene {
    async fn new(
        position: &[Vec3],
        given: &[Vec3],
        field: &mut dyn Field,
        twin: &[bool],
        drop: &[bool],
    ) -> Self {
        let kept = position.iter().copied().zip(0..).filter(|&(_, i)| !drop[i as usize]).collect();
        let tree = Tree::in_pieces(kept).await;
        let mut normal = Vec::with_capacity(tree.len());
        let mut residual = Vec::with_capacity(tree.len());
        let mut tilt = Tilt::default();
        for (position, origin) in tree.position.chunks(BATCH).zip(tree.origin.chunks(BATCH)) {
            let (mut value, mut gradient) = ([0.0; BATCH], [DVec3::ZERO; BATCH]);
            field.exact_gradients(position, &mut value, &mut gradient);
            for ((&i, value), &gradient) in origin.iter().zip(value).zip(&gradient) {
                let slope = gradient.length();
                let given = given.get(i as usize).copied().unwrap_or(Vec3::ZERO);
                tilt.add(given, gradient);
                let unit = Some((gradient / slope).as_vec3()).filter(|unit| unit.is_finite());
                normal.push(unit.or_else(|| given.try_normalize()).unwrap_or(Vec3::Z));
                residual.push(distance(value, slope));
            }
            piece().await;
        }
        let fans = Fans::new(&tree, &normal).await;
        let twin = tree.origin.iter().map(|&i| twin[i as usize]).collect();
        Self { tree, normal, residual, tilt, fans, twin }
    }

    fn nearest(&self, i: usize) -> f32 {
        if self.twin[i] { 0.0 } else { self.fans.nearest[i] }
    }
}

/// First-order distance from the surface.
fn distance(value: f64, slope: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.abs() / slope }
}

/// Measures the particles at `position` with outward unit normals `normal` on the surface of `field`.
///
/// `bounds` is the box that was sampled. Particles within 4 d_hex of where the surface continues beyond it are left
/// out of every figure but the residual, the normals, the area and the topology; and random lines through it find what the
/// particles missed, for `cover` and `quant`. Without it, only what the triangles span is looked at. Normals are used where the
/// gradient is undefined, and are themselves measured against it; the slice may be shorter than `position`.
///
/// Cost: linear, about 2 µs per particle natively on a formula. Any input is met without a panic; what is undefined (spacing of
/// one particle, angles without triangles) is NaN, and non-finite positions are counted and left out.
#[must_use]
pub fn measure(
    position: &[Vec3],
    normal: &[Vec3],
    field: &mut dyn Field,
    bounds: Option<&Bounds>,
    options: &Options,
) -> Report {
    pieces::complete(in_pieces(position, normal, field, bounds, options))
}

/// [`measure`], a piece at a time. A few pieces look at all particles, for some 20 ns each.
pub(crate) async fn in_pieces(
    position: &[Vec3],
    normal: &[Vec3],
    field: &mut dyn Field,
    bounds: Option<&Bounds>,
    options: &Options<'_>,
) -> Report {
    let factor = comfortable_factor(field, position.iter().copied());
    let field = &mut Scaled::new(field, factor);
    let prepared = Prepared::new(position, normal, field, options.area).await;
    let (figures, component) = figures::figures(&prepared, field, bounds, options).await;
    let Prepared { scene, drop, .. } = &prepared;
    let n = position.len();
    let mut report = Report {
        figures,
        valence: vec![0; n],
        nearest: (0..n).map(|i| if drop[i] && position[i].is_finite() { 0.0 } else { f32::NAN }).collect(),
        residual: vec![f32::NAN; n],
        component: vec![components::NO_LABEL; n],
        histogram: Histogram::default(),
    };
    for (k, &i) in scene.tree.origin.iter().enumerate() {
        let i = i as usize;
        report.valence[i] = scene.fans.valence(k).min(255) as u8;
        report.nearest[i] = scene.nearest(k);
        report.residual[i] = scene.residual[k] as f32;
        report.component[i] = component[k];
    }
    for i in (0..n).filter(|&i| drop[i] && position[i].is_finite()) {
        let jet = field.jet(position[i].as_dvec3());
        report.residual[i] = distance(jet.value, jet.gradient.length()) as f32;
        let (_, equal) = scene.tree.nearest(position[i], u32::MAX, f32::INFINITY);
        report.component[i] = component.get(equal as usize).copied().unwrap_or(components::NO_LABEL);
    }
    report.histogram = Histogram::new(&report.nearest, figures.d_hex);
    report
}

/// The triangles of the particles, as triples of indices: those of natural neighbours that at least two of their three
/// corners agree on, with quarrels about nearly cocircular points settled so that every directed edge belongs to one
/// triangle at most; counter-clockwise seen from outside. Input and cost as in [`measure`], of which this is part.
#[must_use]
pub fn triangles(position: &[Vec3], normal: &[Vec3], field: &mut dyn Field) -> Vec<[u32; 3]> {
    let factor = comfortable_factor(field, position.iter().copied());
    let field = &mut Scaled::new(field, factor);
    let Prepared { scene, mesh, .. } = pieces::complete(Prepared::new(position, normal, field, None));
    let origin = &scene.tree.origin;
    mesh.iter().map(|triangle| triangle.map(|i| origin[i as usize])).collect()
}

/// The points, without duplicates and non-finite positions, and their triangles.
struct Prepared {
    scene: Scene,
    triangles: Triangles,
    mesh: Vec<[u32; 3]>,
    duplicates: usize,
    not_finite: usize,
    /// Points left out, by the index given.
    drop: Vec<bool>,
}

impl Prepared {
    async fn new(position: &[Vec3], normal: &[Vec3], field: &mut dyn Field, area: Option<f64>) -> Self {
        let mut drop: Vec<bool> = position.iter().map(|p| !p.is_finite()).collect();
        let not_finite = drop.iter().filter(|&&dropped| dropped).count();
        let mut twin = vec![false; position.len()];
        // Equal points first: they would all be nearest neighbours of one another.
        drop_equal(position, &mut drop, &mut twin);
        piece().await;
        loop {
            let scene = Scene::new(position, normal, field, &twin, &drop).await;
            let triangles = Triangles::new(&scene.fans).await;
            let mesh = triangles.settled(&scene.tree.position);
            piece().await;
            let area = area.unwrap_or_else(|| figures::area(&scene, &mesh));
            let d_hex = figures::d_hex(area, position.len() - not_finite);
            piece().await;
            if !drop_close(&scene, (DUPLICATE * d_hex) as f32, &mut drop) {
                let duplicates = position.len() - not_finite - scene.tree.len();
                return Self { scene, triangles, mesh, duplicates, not_finite, drop };
            }
        }
    }
}

/// Marks every finite point equal to an earlier one in `drop`, and the earlier one in `twin`.
fn drop_equal(position: &[Vec3], drop: &mut [bool], twin: &mut [bool]) {
    // Open addressing, at most half full; a slot holds an index + 1.
    let mut slots = vec![0_u32; (2 * position.len()).next_power_of_two()];
    let mask = slots.len() - 1;
    for (i, p) in position.iter().enumerate() {
        if drop[i] {
            continue;
        }
        let mut hash = 0_u64;
        for c in p.to_array() {
            // Adding 0 turns −0 into 0.
            hash = (hash ^ u64::from((c + 0.0).to_bits())).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            hash ^= hash >> 29;
        }
        let mut slot = hash as usize & mask;
        loop {
            match slots[slot] {
                0 => {
                    slots[slot] = i as u32 + 1;
                    break;
                }
                earlier if position[earlier as usize - 1] == *p => {
                    drop[i] = true;
                    twin[earlier as usize - 1] = true;
                    break;
                }
                _ => slot = (slot + 1) & mask,
            }
        }
    }
}

/// Marks every point closer than `limit` to an earlier one in `drop`; whether there was any.
fn drop_close(scene: &Scene, limit: f32, drop: &mut [bool]) -> bool {
    let tree = &scene.tree;
    let mut near = Vec::new();
    let mut any = false;
    for i in 0..tree.len() {
        if scene.fans.nearest[i] < limit {
            near.clear();
            tree.within_box(tree.position[i] - limit, tree.position[i] + limit, &mut near);
            if near.iter().any(|&j| {
                tree.origin[j as usize] < tree.origin[i]
                    && (tree.position[j as usize] - tree.position[i]).length() < limit
            }) {
                drop[tree.origin[i] as usize] = true;
                any = true;
            }
        }
    }
    any
}
