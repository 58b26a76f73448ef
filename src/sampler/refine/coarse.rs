//! The coarse front: how coarse it may be, and whether it is good enough.

use super::border;
use super::net::{Ground, Net};
use super::refusal::Refusal;
use super::walls::Walls;
use super::{LEAST_PARTICLES, SurfaceFacts};
use crate::differential::{Curvature, curvatures};
use crate::field::Evaluator;
use crate::math::{Bounds, Forest, NONE};
use crate::mesh::half_edge::HalfEdges;
use crate::mesh::triangulation::{Triangulation, triangulate};
use crate::particles::Particles;
use crate::sampler::constraint::CreaseLadder;
use core::slice;
use glam::Vec3;

/// Match tolerance of a coarse front. Where grains meet it places fewer particles than the paper's
/// front, whose relaxation cannot remove one. With the paper's 0.7 a particle may be two spacings
/// from the tip of a narrow cone.
pub(crate) const MATCH_TOLERANCE: f64 = 0.8;

/// Radius of a coarse front over the radius for its share of the particles: it places fewer where
/// its grains meet. The first level makes up for the difference. Larger: fewer particles have six
/// neighbours; smaller: the closest pairs on solids are nearer.
pub(crate) const FRONT_RADIUS: f64 = 0.95;

/// Largest number of halvings: with it 240 particles become a million.
const MAX_LEVELS: u32 = 6;
/// Largest product of coarse spacing and curvature. Smaller: fewer particles of a closed surface
/// have six neighbours. Larger: a small ball next to a large one gets too few particles, because so
/// few do not show its area.
const MAX_BEND: f64 = 0.9;
/// Largest product of spacing and curvature for a front that is refined once, or healed at full
/// resolution: beyond it an edge spans half a turn. Smaller: fewer particles of a strongly bent
/// surface have six neighbours.
const MAX_BEND_LEAST: f64 = 3.2;

/// Largest curvature at each of some points of the surface; infinite where it is undefined.
pub(crate) fn largest_curvatures(field: &mut dyn Evaluator, points: &[Vec3]) -> Vec<f64> {
    let mut curvature = vec![Curvature::default(); points.len()];
    curvatures(field, points, &mut curvature);
    for (&p, own) in points.iter().zip(&mut curvature).filter(|(_, own)| !own.is_defined()) {
        // Where the branches of f meet smoothly on its surface f has no gradient.
        let branch = field.label(p.as_dvec3());
        if let Some(pieces) = field.pieces() {
            curvatures(pieces.piece(branch), &[p], slice::from_mut(own));
        }
    }
    let largest = |c: &Curvature| if c.is_defined() { f64::from(c.max_abs()) } else { f64::INFINITY };
    curvature.iter().map(largest).collect()
}

/// How often a front can be refined that has `count` particles in the end, with `bend` the spacing
/// times the largest curvature; 0 if it can only be ordered at full resolution, and `None` if not
/// even that.
pub(crate) fn halvings(bend: f64, count: f64) -> Option<u32> {
    let particles = |halvings: u32| count / f64::from(1_u32 << (2 * halvings));
    let is_large = |halvings: &u32| particles(*halvings) >= f64::from(LEAST_PARTICLES);
    let bends_up_to = |most: f64| move |&halvings: &u32| bend * f64::from(1_u32 << halvings) <= most;
    let coarsest = (1..=MAX_LEVELS).rev().filter(is_large).find(bends_up_to(MAX_BEND));
    // With fewer particles the front has as many defects as a mesh that is healed.
    coarsest.or_else(|| [1, 0].into_iter().filter(|_| is_large(&1)).find(bends_up_to(MAX_BEND_LEAST)))
}

/// The triangles between the particles of a front, by rows, if they are beyond doubt.
pub(super) fn triangles(particles: &Particles, bounds: &Bounds) -> Result<Vec<[u32; 3]>, Refusal> {
    let radius = particles.radius.iter().copied().fold(0.0, f32::max);
    let grown = border::grown(bounds, f64::from(radius));
    let joined = triangulate(particles, Some(&grown));
    judge_triangles(&joined, particles, bounds)?;
    Ok(joined.into_corners())
}

/// A part of a front that is refined by itself: a component of the surface, or a patch of it.
pub(super) struct FrontPart<'a> {
    /// The particles; if the surface has creases the particles on them come first, with their
    /// numbers in `twins`.
    pub(super) particles: &'a Particles,
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) patch: Option<u32>,
}

/// The surface between the particles of a part of a front, clipped by the box. Particles in no
/// triangle are left out.
pub(super) fn join(ground: &mut Ground, part: &FrontPart, surface: &SurfaceFacts) -> Result<Net, Refusal> {
    let &FrontPart { particles, triangles, .. } = part;
    let &SurfaceFacts { ref bounds, ladder, .. } = surface;
    let spacing = 2.0 * particles.radius.first().copied().unwrap_or(0.0);
    let mut triangles = triangles.to_vec();
    let rows = split_fans(&mut triangles, particles);
    let mesh = HalfEdges::from_triangles(rows.len(), &triangles).ok_or_else(|| doubtful(particles, 0))?;
    let mut net = Net {
        mesh,
        position: rows.iter().map(|&row| particles.local[row as usize]).collect(),
        normal: rows.iter().map(|&row| particles.normal[row as usize]).collect(),
        slots: rows.iter().map(|&row| particles.slots[row as usize]).collect(),
        walls: Walls::new(bounds, &particles.local, spacing),
        ..Net::default()
    };
    if let Some(ladder) = ladder {
        let number = |&row: &u32| particles.twins.get(row as usize).copied().unwrap_or(NONE);
        net.hold_creases(ladder, rows.iter().map(number).collect());
    }
    border::clip(&mut net, ground, spacing)?;
    if let Some(ladder) = ladder {
        judge_creases(&net, ladder)?;
    }
    Ok(net)
}

/// Gives a particle on a crease a vertex for each fan of triangles around it: where a patch touches
/// itself there are several. Returns the row of each vertex; the first vertices are their own rows.
fn split_fans(triangles: &mut [[u32; 3]], particles: &Particles) -> Vec<u32> {
    let mut rows: Vec<u32> = (0..particles.len() as u32).collect();
    let on_creases = particles.twins.len();
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); on_creases];
    for (k, triangle) in triangles.iter().enumerate() {
        for &v in triangle.iter().filter(|&&v| (v as usize) < on_creases) {
            around[v as usize].push(k);
        }
    }
    for (v, own) in (0..).zip(&around) {
        let mut fans = Forest::new(own.len());
        for (i, &k) in (0..).zip(own) {
            for (j, &l) in (0..i).zip(own) {
                if triangles[k].iter().any(|w| *w != v && triangles[l].contains(w)) {
                    fans.join(i, j);
                }
            }
        }
        // The first fan keeps the vertex.
        for root in 1..own.len() as u32 {
            if fans.find(root) != root {
                continue;
            }
            let copy = rows.len() as u32;
            rows.push(v);
            for (_, &k) in (0..).zip(own).filter(|&(i, _)| fans.find(i) == root) {
                triangles[k].iter_mut().filter(|w| **w == v).for_each(|w| *w = copy);
            }
        }
    }
    rows
}

/// Checks the border of a patch: it must consist of creases, or lie at the box.
fn judge_creases(net: &Net, ladder: &CreaseLadder) -> Result<(), Refusal> {
    let is_open = |&h: &u32| {
        let [a, b] = [net.mesh.origin(h), net.mesh.target(h)];
        net.mesh.twin(h) == NONE
            && net.common_planes(a, b).is_crease()
            && net.middle_on_crease(ladder, a, b).is_none()
    };
    match net.mesh.edges().find(is_open) {
        Some(h) => Err(Refusal::Doubtful { at: net.position[net.mesh.origin(h) as usize].into() }),
        None => Ok(()),
    }
}

/// Checks the triangles in the box; those beyond are cut away.
fn judge_triangles(joined: &Triangulation, particles: &Particles, bounds: &Bounds) -> Result<(), Refusal> {
    let is_inside = |&v: &u32| bounds.contains(particles.local[v as usize]);
    let mut left_out = joined.left_out.iter().copied().filter(is_inside);
    if let Some(v) = joined.unfilled.iter().flatten().copied().find(is_inside) {
        return Err(doubtful(particles, v));
    }
    // For example the only particle of a small component, which would be lost.
    let is_seed = |&v: &u32| particles.parent[v as usize] == Particles::NO_PARENT;
    if let Some(v) = left_out.find(is_seed) {
        return Err(doubtful(particles, v));
    }
    if joined.triangles.is_empty() { Err(doubtful(particles, 0)) } else { Ok(()) }
}

pub(super) fn doubtful(particles: &Particles, v: u32) -> Refusal {
    Refusal::Doubtful { at: particles.local.get(v as usize).copied().unwrap_or_default().into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_doubtful_mesh_of_the_front_is_refused() {
        let bounds = Bounds::cube(1.0);
        let mut particles = Particles::default();
        for k in 0..1000 {
            // The last ones are beyond the box.
            let place = Vec3::new(if k < 990 { 0.5 } else { 1.5 }, 0.0, 0.001 * k as f32);
            let parent = if k == 0 { Particles::NO_PARENT } else { 0 };
            particles.push(place, Vec3::Z, 0.1, parent, 0, crate::particles::Slots::default());
        }
        let good = Triangulation {
            triangles: vec![[0, 1, 2]; 1000],
            left_out: vec![1, 2],
            unfilled: vec![vec![990, 991]],
            ..Triangulation::default()
        };
        assert_eq!(judge_triangles(&good, &particles, &bounds), Ok(()));
        let beyond = Triangulation { left_out: (988..1000).collect(), ..good.clone() };
        assert_eq!(judge_triangles(&beyond, &particles, &bounds), Ok(()));
        let doubtful_at = |v: usize| Err(Refusal::Doubtful { at: particles.local[v].into() });
        for (bad, place) in [
            (Triangulation { triangles: Vec::new(), ..good.clone() }, 0),
            (Triangulation { unfilled: vec![vec![990, 991], vec![995, 30]], ..good.clone() }, 30),
            (Triangulation { left_out: vec![0], ..good.clone() }, 0),
        ] {
            assert_eq!(judge_triangles(&bad, &particles, &bounds), doubtful_at(place), "{bad:?}");
        }
    }

    #[test]
    fn a_front_is_as_coarse_as_curvature_and_count_allow() {
        // The bend of the spacing on the ellipsoid with 56,000 particles is 0.033.
        for (bend, count, expected) in [
            (0.033, 56_000.0, Some(4)),
            (0.033, 1e7, Some(4)),
            (0.001, 56_000.0, Some(4)),
            (1e-4, 1e9, Some(6)),
            (0.3, 56_000.0, Some(1)),
            (0.5, 56_000.0, Some(1)),
            (1.59, 56_000.0, Some(1)),
            (1.61, 56_000.0, Some(0)),
            (3.21, 56_000.0, None),
            (f64::INFINITY, 56_000.0, None),
            (f64::NAN, 56_000.0, None),
            (0.033, 719.0, None),
            (0.033, 179.0, None),
        ] {
            assert_eq!(halvings(bend, count), expected, "bend {bend}, count {count}");
        }
    }
}
