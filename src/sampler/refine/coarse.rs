//! The coarse front: how coarse it may be, and whether it is good enough.

use super::border;
use super::frame::Frame;
use super::layer::{Ground, Layer};
use super::refusal::Refusal;
use crate::differential::{Curvature, curvatures};
use crate::field::Field;
use crate::math::Bounds;
use crate::mesh::build::{Options, Triangulation, triangulate};
use crate::mesh::half_edge::HalfEdges;
use crate::particles::Particles;
use glam::Vec3;

/// Match tolerance of a coarse front. It places fewer particles where grains meet than the paper's front does, whose relaxation
/// cannot remove one.
pub(crate) const MATCH_TOLERANCE: f64 = 0.8;

/// Radius of a coarse front over that of its share of the particles: with this match tolerance it places 6 to 14 % fewer than the
/// front of the paper. What it is off by is made up for at the first level.
pub(crate) const FRONT_RADIUS: f64 = 0.95;

/// Most levels: a million particles come from 240.
const MAX_LEVELS: u32 = 6;
/// Fewest particles of a component of the coarse front, by which its shape can be told.
const LEAST_PARTICLES: u32 = 180;
/// Largest product of coarse spacing and curvature: 0.89 has worked wherever it was tried, 1.45 once, 1.54 nowhere.
const MAX_BEND: f64 = 0.9;

/// A coarse front must be joined to triangles in so many rounds of filling holes at most, this share of them beyond dispute, and no
/// larger share of its particles left out. Where it is worse, the surface is not resolved.
const MAX_ROUNDS: u32 = 2;
const LEAST_AGREED: f64 = 0.9;
const MAX_LEFT_OUT: f64 = 0.002;
/// At most this share of edges has normals at its ends whose dot product is below [`SHARP`], 60° apart. The gyroid, which bends in two
/// directions everywhere, has 4 % where [`MAX_BEND`] is met just so, and is refined well.
const MAX_SHARP: f64 = 0.06;
const SHARP: f32 = 0.5;

/// Largest curvature at each of some points of the surface; infinite where there is none.
pub(crate) fn largest_curvatures(field: &mut dyn Field, points: &[Vec3]) -> Vec<f64> {
    let mut curvature = vec![Curvature::default(); points.len()];
    curvatures(field, points, &mut curvature);
    let largest = |c: &Curvature| if c.is_defined() { f64::from(c.max_abs()) } else { f64::INFINITY };
    curvature.iter().map(largest).collect()
}

/// How often a front can be refined that has `count` particles in the end, where the spacing times the largest curvature is
/// `bend`; `None` if not once. Sizes that differ take a front with four times as many particles, in which there is room for them: on the
/// ellipsoid that gains 0.5° of the mean angle and costs 0.4 % of the particles with six neighbours. Surgery on a front at full resolution does not pay: on the decocube with 20,000 particles it leaves
/// pairs at 0.42 of the ideal distance.
pub(crate) fn levels(bend: f64, count: f64, is_graded: bool) -> Option<u32> {
    let particles = |levels: u32| count / f64::from(1_u32 << (2 * levels));
    let is_coarse = |levels: &u32| {
        bend * f64::from(1_u32 << levels) <= MAX_BEND && particles(*levels) >= f64::from(LEAST_PARTICLES)
    };
    let levels = (1..=MAX_LEVELS).rev().find(is_coarse)?;
    Some(if is_graded { (levels - 1).max(1) } else { levels })
}

/// The particles of a front joined to a surface, if that can be had beyond doubt, and clipped by the box. Particles in no triangle are
/// left out. The front is to be refined so many times.
pub(super) fn join(
    ground: &mut Ground,
    particles: &Particles,
    bounds: &Bounds,
    levels: u32,
) -> Result<Layer, Refusal> {
    let radius = particles.radius.first().copied().unwrap_or(0.0);
    let spacing = 2.0 * radius;
    let grown = border::grown(bounds, f64::from(radius));
    let options = Options { bounds: Some(&grown), ..Options::default() };
    let joined = triangulate(&particles.position, &particles.normal, &options);
    judge_triangles(&joined, particles, bounds)?;
    let mesh =
        HalfEdges::from_triangles(particles.len(), &joined.triangles).map_err(|_| Refusal::Doubtful)?;
    judge_size(&mesh, particles, bounds, levels)?;
    let mut layer = Layer {
        mesh,
        position: particles.position.clone(),
        normal: particles.normal.clone(),
        slots: particles.slots.clone(),
        size: Vec::new(),
        frame: Frame::new(bounds, &particles.position, spacing),
    };
    border::clip(&mut layer, ground, spacing)?;
    judge_bend(&layer)?;
    Ok(layer)
}

/// Judges the triangles in the box: beyond it they are cut away.
fn judge_triangles(joined: &Triangulation, particles: &Particles, bounds: &Bounds) -> Result<(), Refusal> {
    let triangles = joined.triangles.len() as f64;
    let is_inside = |&v: &u32| bounds.contains(particles.position[v as usize]);
    let left_out = joined.left_out.iter().filter(|v| is_inside(v));
    // The only particle of a component, say.
    let is_seed = |&i: &u32| particles.parent[i as usize] == Particles::NO_PARENT;
    if joined.rounds > MAX_ROUNDS
        || (joined.agreed as f64) < LEAST_AGREED * triangles
        || left_out.clone().count() as f64 > MAX_LEFT_OUT * particles.len() as f64
        || left_out.copied().any(|v| is_seed(&v))
        || joined.unfilled.iter().any(|hole| hole.iter().any(is_inside))
        || joined.triangles.is_empty()
    {
        return Err(Refusal::Doubtful);
    }
    Ok(())
}

/// Judges the number of particles of each component that reaches into the box.
fn judge_size(mesh: &HalfEdges, particles: &Particles, bounds: &Bounds, levels: u32) -> Result<(), Refusal> {
    // At full resolution there are no more to be had.
    let least = if levels > 0 { LEAST_PARTICLES } else { 0 };
    let mut is_met = vec![false; particles.len()];
    for root in 0..particles.len() as u32 {
        if is_met[root as usize] || !mesh.has_vertex(root) {
            continue;
        }
        is_met[root as usize] = true;
        let (mut open, mut count, mut is_inside) = (vec![root], 0, false);
        while let Some(v) = open.pop() {
            count += 1;
            is_inside |= bounds.contains(particles.position[v as usize]);
            for other in mesh.neighbours(v) {
                if !core::mem::replace(&mut is_met[other as usize], true) {
                    open.push(other);
                }
            }
        }
        if is_inside && count < least {
            return Err(Refusal::Small);
        }
    }
    Ok(())
}

fn judge_bend(layer: &Layer) -> Result<(), Refusal> {
    let mesh = &layer.mesh;
    let (mut edges, mut sharp) = (0_usize, 0_usize);
    for h in mesh.edges() {
        let [a, b] = [mesh.origin(h), mesh.target(h)].map(|v| layer.normal[v as usize]);
        edges += 1;
        sharp += usize::from(a.dot(b) < SHARP);
    }
    if sharp as f64 > MAX_SHARP * edges as f64 { Err(Refusal::Sharp) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::levels;

    #[test]
    fn a_front_is_as_coarse_as_curvature_and_count_allow() {
        // The bend of the spacing on the ellipsoid with 56,000 particles is 0.033.
        for (bend, count, expected) in [
            (0.033, 56_000.0, Some(4)),
            (0.033, 1e7, Some(4)),
            (0.001, 56_000.0, Some(4)),
            (1e-4, 1e9, Some(6)),
            (0.3, 56_000.0, Some(1)),
            (2.0, 56_000.0, None),
            (f64::INFINITY, 56_000.0, None),
            (f64::NAN, 56_000.0, None),
            (0.033, 719.0, None),
            (0.033, 179.0, None),
        ] {
            assert_eq!(levels(bend, count, false), expected, "bend {bend}, count {count}");
            let finer = expected.map(|levels: u32| (levels - 1).max(1));
            assert_eq!(levels(bend, count, true), finer, "bend {bend}, count {count}, sizes that differ");
        }
    }
}
