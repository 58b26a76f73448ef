//! Figures relative to a wanted radius of each point.

use super::figures::Moments;
use super::{Scene, Sizes};
use crate::differential::exact_curvature;
use crate::field::Field;
use crate::math::SQRT_3;
use crate::pieces::{piece, ranges};
use glam::Vec3;

/// Area of a point's cell in a hexagonal lattice of radius 1: 2√3.
const CELL_AREA: f64 = 2.0 * SQRT_3;
/// Radius of a hole in that lattice.
const HOLE: f64 = 2.0 / SQRT_3;

/// Points whose radii are found in one piece of work.
const PIECE: usize = 64;

/// The wanted radii, in tree order; NaN where there is none.
pub(super) struct Wanted {
    radius: Vec<f64>,
    /// Radius of an ideal hole over the wanted radius: that of hexagonal cells that together have the surface's area.
    hole: f64,
}

/// Pairs of natural neighbours that both see each other and that both pass `inner`, each once.
pub(super) fn mutual<'a>(scene: &'a Scene, inner: &'a [bool], i: usize) -> impl Iterator<Item = usize> + 'a {
    scene.fans.of(i).filter(move |&j| j > i && inner[i] && inner[j] && scene.fans.adjacent(j, i))
}

/// Distance of two points, in tree order.
pub(super) fn length(scene: &Scene, i: usize, j: usize) -> f64 {
    (scene.tree.position[i].as_dvec3() - scene.tree.position[j].as_dvec3()).length()
}

impl Wanted {
    /// The radii that `sizes` names, for points on a surface of this `area`.
    pub(super) async fn new(
        scene: &Scene,
        inner: &[bool],
        field: &mut dyn Field,
        sizes: Sizes<'_>,
        area: f64,
    ) -> Option<Self> {
        let n = scene.tree.len();
        let radius: Vec<f64> = match sizes {
            Sizes::None => return None,
            Sizes::Given(given) => {
                let of = |&i: &u32| given.get(i as usize).map_or(f64::NAN, |&r| f64::from(r));
                scene.tree.origin.iter().map(of).collect()
            }
            Sizes::Local => {
                let mut own = vec![Moments::default(); n];
                for range in ranges(n, PIECE) {
                    for i in range {
                        for j in mutual(scene, inner, i) {
                            let half = 0.5 * length(scene, i, j);
                            own[i].add(half);
                            own[j].add(half);
                        }
                    }
                    piece().await;
                }
                own.iter().map(Moments::mean).collect()
            }
            Sizes::Curvature { lowest, highest } => {
                let mut of = |p: &Vec3| {
                    let curvature = exact_curvature(&field.jet(p.as_dvec3())).max_abs();
                    1.0 / curvature.max(lowest).min(highest)
                };
                let mut radius = Vec::with_capacity(n);
                for chunk in scene.tree.position.chunks(PIECE) {
                    radius.extend(chunk.iter().map(&mut of));
                    piece().await;
                }
                radius
            }
        };
        let cells: f64 = radius.iter().filter(|r| r.is_finite()).map(|r| CELL_AREA * r * r).sum();
        Some(Self { radius, hole: HOLE * (area / cells).sqrt() })
    }

    /// Distance of two points over the sum of their radii.
    pub(super) fn ratio(&self, scene: &Scene, i: usize, j: usize) -> f64 {
        length(scene, i, j) / (self.radius[i] + self.radius[j])
    }

    /// Radius of an ideal hole between some points; NaN if one of them has no radius.
    pub(super) fn hole_between(&self, points: &[u32]) -> f32 {
        let sum: f64 = points.iter().map(|&i| self.radius[i as usize]).sum();
        (self.hole * sum / points.len() as f64) as f32
    }
}
