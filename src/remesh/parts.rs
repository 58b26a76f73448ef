//! The field of a mesh with edges: each patch has a smooth function, and at an edge f is the larger
//! or the smaller of two.

use super::MeshSolid;
use super::patch_function::{PatchFunction, Slope};
use super::patches::Patches;
use super::rule::Rule;
use super::tree::Tree;
use crate::field::{Evaluator, Facts, Field, Frame, Jet, Pieces, Piecewise, Within, edges};
use crate::math::{Bounds, Sym3};
use crate::slices::{Work, pause};
use core::fmt::{self, Debug, Formatter};
use glam::{DVec3, Vec3};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Largest distance of a plane's vertices from the plane, divided by the diagonal: the precision of
/// a file with single-precision numbers.
const FLAT: f64 = 1e-6;

/// Data that all evaluators of a mesh share.
struct Shared {
    /// All coordinates here are relative to this point.
    origin: DVec3,
    tree: Arc<Tree>,
    patches: Patches,
    functions: Vec<PatchFunction>,
    /// The creases as segments, and whether each is an edge of the surface.
    segments: Vec<[DVec3; 2]>,
    is_of_surface: Vec<bool>,
    /// Number of faces that are not walls.
    faces: usize,
    creases: Tree,
    bounds: Bounds,
    /// Largest height of the smooth surface above the faces.
    bulge: f64,
}

/// The field ±f − shift of a mesh with edges.
#[derive(Clone)]
pub(super) struct PartsField {
    shared: Arc<Shared>,
    /// Whether an open surface continues beyond its border, along its tangents.
    is_continued: bool,
    is_negative: bool,
    shift: f64,
}

impl Debug for PartsField {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("PartsField").field("patches", &self.shared.functions.len()).finish_non_exhaustive()
    }
}

impl Shared {
    /// The patch whose function gives f at `p`: `patch`, which holds the nearest point `q` of the
    /// mesh, unless a crease or a corner near `q` chooses another.
    fn taken(&self, q: DVec3, patch: u32, is_continued: bool, p: DVec3) -> u32 {
        let Patches { creases, corners, near, .. } = &self.patches;
        let is_own = |k: u32| {
            let patches = creases[k as usize].patches;
            patches.contains(&patch)
                && !(is_continued && patches.iter().any(|&own| self.patches.is_wall(own)))
        };
        let Some(found) = self.creases.nearest_of(q, near * near, is_own) else { return patch };
        let crease = creases[found.triangle as usize];
        let mut value = |patch: u32| self.functions[patch as usize].at(p).value;
        for (end, place) in crease.ends.into_iter().zip(self.segments[found.triangle as usize]) {
            let Ok(at) = corners.binary_search_by_key(&end, |corner| corner.vertex) else { continue };
            let corner = &corners[at];
            match &corner.rule {
                Some(rule) if q.distance_squared(place) <= corner.near * corner.near => {
                    return rule.taken(&mut value).0;
                }
                // Nearest to the corner itself f has the sign of the mesh and vanishes nowhere.
                None if q == place => {
                    let is_outside = corner.normal.dot(p - place) > 0.0;
                    let patches = corner.patches.iter().copied().map(Rule::Patch);
                    return Rule::of(is_outside, patches.collect()).taken(&mut value).0;
                }
                _ => {}
            }
        }
        let rule = Rule::of(crease.is_convex, crease.patches.map(Rule::Patch).to_vec());
        rule.taken(&mut value).0
    }

    fn label(&self, p: DVec3, is_continued: bool) -> u32 {
        let faces = if is_continued { self.faces } else { usize::MAX };
        let nearest = self.tree.nearest_of(p, f64::INFINITY, |face| (face as usize) < faces);
        let Some(nearest) = nearest else { return 0 };
        self.taken(nearest.point, self.patches.of_face[nearest.triangle as usize], is_continued, p)
    }

    /// Cells along the creases.
    fn cells(&self, bounds: &Bounds, width: f64) -> Vec<Bounds> {
        /// Points along a crease in each cell.
        const STEPS: f64 = 3.0;
        /// Most points along one edge of the mesh.
        const MOST: f64 = 10_000.0;
        let mut seen = BTreeSet::new();
        let own = self.segments.iter().zip(&self.is_of_surface).filter(|own| *own.1);
        for ([a, b], _) in own {
            let steps = libm::ceil(STEPS * a.distance(*b) / width).clamp(1.0, MOST);
            for k in 0..=steps as u32 {
                let at = (a.lerp(*b, f64::from(k) / steps) - bounds.lo()) / width;
                seen.insert(at.floor().to_array().map(|x| x as i64));
            }
        }
        let cell = |at: [i64; 3]| {
            let first = bounds.lo() + width * DVec3::from_array(at.map(|x| x as f64));
            Bounds::new(first, first + width)
        };
        seen.into_iter().map(cell).filter(|cell| !cell.is_apart_from(bounds)).collect()
    }
}

impl PartsField {
    /// The field of a mesh with these patches, of which those of the faces from number `walls` on
    /// are walls.
    pub(super) async fn new(solid: &MeshSolid, patches: Patches, walls: usize) -> Self {
        let (mesh, edges) = (&*solid.mesh, &*solid.edges);
        let own = mesh.faces()[..walls].iter().flat_map(|face| mesh.corners(face));
        let bounds = Bounds::around(own);
        let diagonal = bounds.diagonal();
        let mut faces: Vec<Vec<u32>> = vec![Vec::new(); patches.count];
        for (face, &patch) in (0..).zip(&patches.of_face) {
            faces[patch as usize].push(face);
        }
        let of_face = &patches.of_face;
        let mut functions = Vec::with_capacity(faces.len());
        for (patch, faces) in (0..).zip(&faces) {
            let is_inner =
                |edge: usize| edges.sides(edge).iter().all(|side| of_face[side.face as usize] == patch);
            let is_flat = &patches.is_flat;
            functions.push(PatchFunction::new(
                mesh,
                edges,
                faces,
                is_inner,
                is_flat,
                diagonal,
                FLAT * diagonal,
            ));
            pause().await;
        }
        let place = |vertex: u32| mesh.vertices()[vertex as usize];
        let segments: Vec<[DVec3; 2]> = patches.creases.iter().map(|crease| crease.ends.map(place)).collect();
        let corners: Vec<[DVec3; 3]> = segments.iter().map(|&[a, b]| [a, b, b]).collect();
        let is_of_surface = patches.creases.iter().map(|crease| patches.is_of_surface(crease)).collect();
        let shared = Shared {
            origin: solid.origin,
            tree: Arc::clone(&solid.tree),
            segments,
            is_of_surface,
            faces: walls,
            creases: Tree::new(&corners),
            bounds,
            bulge: functions.iter().map(PatchFunction::bulge).fold(0.0, f64::max),
            patches,
            functions,
        };
        Self { shared: Arc::new(shared), is_continued: false, is_negative: false, shift: 0.0 }
    }

    /// The edges of the surface.
    pub(super) fn segments(&self) -> impl Iterator<Item = [DVec3; 2]> {
        let own = self.shared.segments.iter().zip(&self.shared.is_of_surface);
        own.filter(|own| *own.1).map(|own| *own.0)
    }

    /// This field, continued beyond the border of an open surface; none for a closed one.
    pub(super) fn continued(&self) -> Option<Self> {
        let is_open = self.shared.faces < self.shared.patches.of_face.len();
        (is_open && !self.is_continued).then(|| Self { is_continued: true, ..self.clone() })
    }

    fn has_pieces(&self) -> bool {
        !self.shared.patches.creases.is_empty()
    }

    fn label(&self, p: DVec3) -> u32 {
        self.shared.label(p, self.is_continued)
    }

    /// f and its derivatives, or those of one patch's function, at a point relative to the origin
    /// of the mesh.
    fn slope(&self, label: Option<u32>, p: DVec3) -> Slope {
        if !p.is_finite() {
            return Slope { value: f64::NAN, gradient: DVec3::NAN, hessian: Sym3::splat(f64::NAN) };
        }
        let label = label.unwrap_or_else(|| self.label(p));
        let own = self.shared.functions[label as usize].at(p);
        let sign = if self.is_negative { -1.0 } else { 1.0 };
        Slope {
            value: sign * own.value - self.shift,
            gradient: sign * own.gradient,
            hessian: own.hessian.map(|entry| sign * entry),
        }
    }

    /// How far the surface may lie from the faces.
    fn room(&self) -> f64 {
        self.shared.bulge + 2.0 * self.shift.abs()
    }

    fn edge_cells(&self, bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let origin = self.shared.origin;
        // The edges of an offset surface are not those of the mesh.
        if self.shift != 0.0 {
            let write = |points: &[DVec3], labels: &mut [u32]| {
                labels.iter_mut().zip(points).for_each(|(label, &p)| *label = self.label(p - origin));
            };
            return edges::edge_cells_between(self, &write, bounds, width);
        }
        let cells = self.shared.cells(&bounds.relative_to(origin), width);
        cells.iter().map(|cell| cell.relative_to(-origin)).collect()
    }
}

impl Field for PartsField {
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        let Slope { value, gradient, .. } = self.slope(None, p - self.shared.origin);
        (value, gradient)
    }

    fn jet(&self, p: DVec3) -> Jet {
        let Slope { value, gradient, hessian } = self.slope(None, p - self.shared.origin);
        Jet { value, gradient, hessian }
    }

    fn evaluator(&self, frame: Frame) -> Box<dyn Evaluator + '_> {
        Box::new(PartsEvaluator { field: self, frame, label: None, piece: None })
    }

    fn facts(&self) -> Facts {
        let bounds = self.shared.bounds.relative_to(-self.shared.origin).enlarged(self.room());
        Facts { within: Some(Within { bounds, is_cut: false }), ..Facts::default() }
    }

    fn piecewise(&self) -> Option<&dyn Piecewise> {
        self.has_pieces().then_some(self)
    }

    fn is_smooth(&self) -> bool {
        !self.has_pieces()
    }
}

impl Piecewise for PartsField {
    fn pieces_in<'a>(
        &'a self,
        bounds: &Bounds,
        width: f64,
        _: u32,
    ) -> Work<'a, (Vec<Bounds>, Arc<dyn Piecewise>)> {
        let bounds = *bounds;
        Box::pin(async move {
            pause().await;
            (self.edge_cells(&bounds, width), Arc::new(self.clone()) as Arc<dyn Piecewise>)
        })
    }

    fn with_pieces_of(&self, _: &dyn Piecewise) -> Arc<dyn Piecewise> {
        Arc::new(self.clone())
    }

    fn turned(&self, is_negative: bool, shift: f64) -> Arc<dyn Field> {
        let own = if is_negative { -self.shift } else { self.shift };
        Arc::new(Self {
            shared: Arc::clone(&self.shared),
            is_continued: self.is_continued,
            is_negative: self.is_negative ^ is_negative,
            shift: own + shift,
        })
    }
}

/// The evaluator of f, or of one patch's function.
struct PartsEvaluator<'a> {
    field: &'a PartsField,
    frame: Frame,
    label: Option<u32>,
    /// The evaluator of one patch, made on first use.
    piece: Option<Box<Self>>,
}

impl PartsEvaluator<'_> {
    /// A point of the frame, relative to the origin of the mesh.
    fn place(&self, p: DVec3) -> DVec3 {
        p + (self.frame.origin - self.field.shared.origin)
    }

    fn exact(&self, p: DVec3) -> Jet {
        let Slope { value, gradient, hessian } = self.field.slope(self.label, self.place(p));
        Jet { value, gradient, hessian }
    }
}

impl Evaluator for PartsEvaluator<'_> {
    fn frame(&self) -> Frame {
        self.frame
    }

    fn another(&self) -> Box<dyn Evaluator + '_> {
        Box::new(PartsEvaluator { field: self.field, frame: self.frame, label: self.label, piece: None })
    }

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        for (p, value) in points.iter().zip(value) {
            *value = self.frame.value(self.exact(p.as_dvec3()).value);
        }
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        for ((p, value), gradient) in points.iter().zip(value).zip(gradient) {
            let jet = self.exact(p.as_dvec3());
            (*value, *gradient) = self.frame.gradient((jet.value, jet.gradient));
        }
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        for (((p, value), gradient), hessian) in points.iter().zip(value).zip(gradient).zip(hessian) {
            (*value, *gradient, *hessian) = self.frame.hessian(&self.exact(p.as_dvec3()));
        }
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        let jet = self.exact(p);
        self.frame.exact((jet.value, jet.gradient))
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        self.frame.jet(self.exact(p))
    }

    fn pieces(&mut self) -> Option<&mut dyn Pieces> {
        if self.field.has_pieces() { Some(self) } else { None }
    }
}

impl Pieces for PartsEvaluator<'_> {
    fn label(&mut self, p: DVec3) -> u32 {
        self.field.label(self.place(p))
    }

    fn labels_in(&mut self, bounds: &Bounds) -> Option<Vec<u32>> {
        let around = bounds.enlarged(0.25 * bounds.size().max_element() + self.field.room());
        let (shared, is_continued) = (&self.field.shared, self.field.is_continued);
        let mut found = Vec::new();
        shared.tree.in_box(&around.relative_to(shared.origin - self.frame.origin), |face| {
            let patch = shared.patches.of_face[face as usize];
            if is_continued && shared.patches.is_wall(patch) {
                return;
            }
            if let Err(place) = found.binary_search(&patch) {
                found.insert(place, patch);
            }
        });
        Some(found)
    }

    fn has_limits(&mut self) -> bool {
        !self.field.is_continued && !self.field.shared.patches.is_wall.is_empty()
    }

    fn is_limit(&mut self, label: u32) -> bool {
        !self.field.is_continued && self.field.shared.patches.is_wall(label)
    }

    fn piece(&mut self, label: u32) -> &mut dyn Evaluator {
        let (field, frame) = (self.field, self.frame);
        let own = self
            .piece
            .get_or_insert_with(|| Box::new(PartsEvaluator { field, frame, label: None, piece: None }));
        own.label = Some(label);
        &mut **own
    }

    fn edge_cells(&mut self, bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let cells = self.field.edge_cells(&self.frame.outward(bounds), width);
        cells.iter().map(|cell| cell.relative_to(self.frame.origin)).collect()
    }
}
