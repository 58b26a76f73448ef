//! The points to be measured, with their normals and stars.

use super::accuracy::{NormalAngles, angle_between, first_order_height, height_along};
use super::creases::CreaseRows;
use super::sheets::ByField;
use crate::field::Evaluator;
use crate::field::crossing::is_passed;
use crate::math::{Bounds, NONE};
use crate::mesh::stars::{Sheets, StarPoints, Stars};
use crate::mesh::triangulation::{self, Middle};
use crate::particles::Particles;
use crate::slices::{self, HEAVY, MEDIUM};
use crate::spatial::tree::Tree;
use core::ops::Range;
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// The points to be measured, with their normals, residuals and stars. All columns are in tree
/// order.
pub(super) struct MeasuredPoints {
    pub(super) tree: Arc<Tree>,
    /// Unit normals: ∇f/|∇f|, or the given normal if that is undefined.
    pub(super) normal: Vec<Vec3>,
    /// First-order distances from the surface, see
    /// [`Measurements::residual`](super::Measurements::residual).
    pub(super) residual: Vec<f64>,
    /// Angles between the given normals and ∇f.
    pub(super) normal_angles: NormalAngles,
    pub(super) stars: Stars,
    /// Distance to the nearest point of another particle, on any sheet and patch.
    nearest: Vec<f32>,
    pub(super) creases: CreaseRows,
    /// The sheets of the patches; none on a surface without creases.
    pub(super) sheets: Option<Arc<Sheets>>,
    /// Whether a duplicate of the point was dropped: its nearest distance is then 0.
    has_duplicate: Vec<bool>,
}

/// The field gives a point its residual and its normal. The angle is the error of the given normal.
struct Deviation {
    /// Unit normal: ∇f/|∇f|, or the given one if that is undefined.
    normal: Vec3,
    /// First-order distance from the surface.
    residual: f64,
    /// Angle between the given normal and ∇f.
    angle: Option<f64>,
}

/// The deviations of the points of a range, in tree order.
fn deviations(
    field: &mut dyn Evaluator,
    tree: &Tree,
    creases: &CreaseRows,
    given: &[Vec3],
    range: Range<usize>,
) -> Vec<Deviation> {
    let (position, origin) = (&tree.position[range.clone()], &tree.origin[range.clone()]);
    let (mut value, mut gradient) = ([0.0; HEAVY], [DVec3::ZERO; HEAVY]);
    creases.exact_gradients(field, range.clone(), position, &mut value, &mut gradient);
    let columns = range.zip(origin).zip(value).zip(gradient);
    let deviation = |(((k, &i), value), gradient): (((usize, &u32), f64), DVec3)| {
        let slope = gradient.length();
        let given = given.get(i as usize).copied().unwrap_or(Vec3::ZERO);
        if creases.is_tip(k) {
            return Deviation { normal: given, residual: 0.0, angle: None };
        }
        let unit = Some((gradient / slope).as_vec3()).filter(|unit| unit.is_finite());
        let mut height = first_order_height(value, slope);
        if !height.is_finite() {
            height = height_along(creases.on(field, k), tree.position[k].as_dvec3(), given, value);
        }
        Deviation {
            normal: unit.or_else(|| given.try_normalize()).unwrap_or(Vec3::Z),
            residual: height.abs(),
            angle: angle_between(given, gradient),
        }
    };
    columns.map(deviation).collect()
}

impl MeasuredPoints {
    /// The points that are not dropped; `known` are the sheets of all points, if given.
    pub(super) async fn new(
        position: &[Vec3],
        given: &[Vec3],
        field: &mut dyn Evaluator,
        has_duplicate: &[bool],
        drop: &[bool],
        rows: Option<&Particles>,
        known: Option<&Arc<Sheets>>,
    ) -> Self {
        let known = known.filter(|sheets| sheets.hold(position.len()) && !drop.contains(&true));
        let tree = match known.and_then(|sheets| sheets.only()) {
            Some(sheet) => Arc::clone(&sheet.tree),
            None => {
                let kept = position.iter().copied().zip(0..).filter(|&(_, i)| !drop[i as usize]);
                Arc::new(Tree::in_slices(kept.collect()).await)
            }
        };
        let creases = CreaseRows::new(&tree, rows);
        let mut normal = Vec::with_capacity(tree.len());
        let mut residual = Vec::with_capacity(tree.len());
        let mut normal_angles = NormalAngles::default();
        let evaluator: &dyn Evaluator = field;
        let parts = slices::map(
            tree.len(),
            HEAVY,
            || evaluator.another(),
            |field, range| deviations(&mut **field, &tree, &creases, given, range),
        );
        for Deviation { normal: own, residual: distance, angle } in parts.await.into_iter().flatten() {
            normal.push(own);
            residual.push(distance);
            angle.into_iter().for_each(|angle| normal_angles.add(angle));
        }
        let judge = &ByField::new(field);
        let mut sheets = None;
        let stars = match (known.and_then(|sheets| sheets.only()), rows.filter(|_| !creases.is_empty())) {
            (Some(sheet), _) => sheet.stars.completed(&sheet.points(), |_| false, judge).await,
            (None, None) => {
                let points = StarPoints { tree: &tree, normal: &normal, tips: &[], patch: None };
                Stars::new(&points, judge).await.completed(&points, |_| false, judge).await
            }
            (None, Some(rows)) => {
                let of_all = match known {
                    Some(sheets) => Arc::clone(sheets),
                    None => Arc::new(Sheets::new(&creases.placed(&tree, &normal, rows), judge).await),
                };
                Stars::gathered(sheets.insert(of_all), &tree, rows.twins.len(), judge).await
            }
        };
        let nearest = slices::map(
            tree.len(),
            MEDIUM,
            || (),
            |(), range| range.map(|i| creases.nearest_within(&tree, i, stars.nearest[i])).collect::<Vec<_>>(),
        );
        let nearest = nearest.await.concat();
        let has_duplicate = tree.origin.iter().map(|&i| has_duplicate[i as usize]).collect();
        Self { tree, normal, residual, normal_angles, stars, nearest, creases, sheets, has_duplicate }
    }

    /// The triangles over the points, each patch up to its creases.
    pub(super) async fn mesh(
        &self,
        field: &mut dyn Evaluator,
        rows: &Particles,
        bounds: Option<&Bounds>,
    ) -> Vec<[u32; 3]> {
        let Some(sheets) = &self.sheets else { return Vec::new() };
        let placed = self.creases.placed(&self.tree, &self.normal, rows);
        let has_surface = |Middle { place, up, reach }: Middle| is_passed(field, place, up, reach);
        let mesh = triangulation::join(&placed, sheets, bounds).await.judged(&placed, has_surface).await;
        let mut place = vec![NONE; placed.len()];
        (0..).zip(&self.tree.origin).for_each(|(k, &row)| place[row as usize] = k);
        mesh.into_corners().into_iter().map(|triangle| triangle.map(|row| place[row as usize])).collect()
    }

    /// Returns the number of particles.
    pub(super) fn count(&self) -> usize {
        self.tree.len() - self.creases.further()
    }

    /// Returns the distance from point `i` to the nearest other point that was not dropped, of any
    /// sheet.
    pub(super) fn nearest_kept(&self, i: usize) -> f32 {
        self.nearest[i]
    }

    /// Returns the distance from point `i` to the nearest other point, of any sheet.
    pub(super) fn nearest(&self, i: usize) -> f32 {
        if self.has_duplicate[i] { 0.0 } else { self.nearest[i] }
    }

    /// Returns the distance of two points.
    pub(super) fn distance(&self, i: usize, j: usize) -> f64 {
        (self.tree.position[i].as_dvec3() - self.tree.position[j].as_dvec3()).length()
    }

    /// Returns the points `j` > `i` that are natural neighbours of `i` on the surface as `i` is of
    /// them, if both are `inner`.
    pub(super) fn mutual<'a>(&'a self, inner: &'a [bool], i: usize) -> impl Iterator<Item = usize> + 'a {
        self.stars.of(i).filter(move |&j| {
            j > i && inner[i] && inner[j] && self.stars.adjacent(j, i) && self.creases.are_joined(i, j)
        })
    }
}
