//! The coarse front: how coarse it may be, and whether it is good enough.

use super::LEAST_PARTICLES;
use super::border;
use super::layer::{Ground, Layer};
use super::refusal::Refusal;
use super::walls::Walls;
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
/// Largest product of coarse spacing and curvature: 0.89 has worked wherever it was tried, 1.45 once, 1.54 nowhere.
const MAX_BEND: f64 = 0.9;
/// Largest product of coarse spacing and curvature for a front that is refined once only. There is no finer front to choose, and
/// the checks that follow judge whether it is good enough. With 2.3 it was on the chmutov, the rabbit and the figure with sack and
/// hat, with 3.0 on the Clebsch cubic.
const MAX_BEND_ONCE: f64 = 3.2;

/// A coarse front must be joined to triangles in so many rounds of filling holes at most, this share of them beyond dispute, and no
/// larger share of its particles left out. Where it is worse, the surface is not resolved.
const MAX_ROUNDS: u32 = 2;
const LEAST_AGREED: f64 = 0.9;
const MAX_LEFT_OUT: f64 = 0.002;
/// At most this share of edges has normals at its ends whose dot product is below [`SHARP`], 60° apart. The gyroid, which bends in
/// two directions everywhere, has 4 % where [`MAX_BEND`] is met just so. It may be more where the front is refined once only and
/// there is no finer one: with 4,000 particles 90 % of those on the gyroid then have six neighbours, instead of 69 %.
const MAX_SHARP: f64 = 0.06;
const MAX_SHARP_ONCE: f64 = 0.15;
const SHARP: f32 = 0.5;
/// At most this share of a coarse front lies on the border, where there is a finer one: a strip of a few rows between two borders
/// has no room for a lattice. Schwarz's D surface with 0.38 had a hole of 1.5, with 0.21 one of 1.28; a plane across the box has
/// 0.23.
const MAX_BORDER: f64 = 0.3;

/// Largest curvature at each of some points of the surface; infinite where there is none.
pub(crate) fn largest_curvatures(field: &mut dyn Field, points: &[Vec3]) -> Vec<f64> {
    let mut curvature = vec![Curvature::default(); points.len()];
    curvatures(field, points, &mut curvature);
    let largest = |c: &Curvature| if c.is_defined() { f64::from(c.max_abs()) } else { f64::INFINITY };
    curvature.iter().map(largest).collect()
}

/// How often a front can be refined that has `count` particles in the end, where the spacing times the largest curvature is
/// `bend`; `None` if not once. Sizes that differ take a front with four times as many particles, in which there is room for them: on the
/// ellipsoid that gains 0.5° of the mean angle and costs 0.4 % of the particles with six neighbours. A front at full resolution is no
/// choice: on the decocube with 20,000 particles surgery on it leaves pairs at 0.42 of the ideal distance.
pub(crate) fn halvings(bend: f64, count: f64, is_graded: bool) -> Option<u32> {
    let particles = |halvings: u32| count / f64::from(1_u32 << (2 * halvings));
    let is_large = |halvings: u32| particles(halvings) >= f64::from(LEAST_PARTICLES);
    let is_coarse = |&halvings: &u32| bend * f64::from(1_u32 << halvings) <= MAX_BEND && is_large(halvings);
    let once = || (2.0 * bend <= MAX_BEND_ONCE && is_large(1)).then_some(1);
    let halvings = (1..=MAX_LEVELS).rev().find(is_coarse).or_else(once)?;
    Some(if is_graded { (halvings - 1).max(1) } else { halvings })
}

/// The particles of a front joined to a surface, if that can be had beyond doubt, and clipped by the box. Particles in no triangle
/// are left out. The front is to be refined so many times.
pub(super) fn join(
    ground: &mut Ground,
    particles: &Particles,
    bounds: &Bounds,
    halvings: u32,
) -> Result<Layer, Refusal> {
    let radius = particles.radius.first().copied().unwrap_or(0.0);
    let spacing = 2.0 * radius;
    let grown = border::grown(bounds, f64::from(radius));
    let options = Options { bounds: Some(&grown), ..Options::default() };
    let joined = triangulate(&particles.position, &particles.normal, &options);
    judge_triangles(&joined, particles, bounds)?;
    let mesh =
        HalfEdges::from_triangles(particles.len(), &joined.triangles).map_err(|_| doubtful(particles, 0))?;
    judge_size(&mesh, particles, bounds, halvings)?;
    let mut layer = Layer {
        mesh,
        position: particles.position.clone(),
        normal: particles.normal.clone(),
        slots: particles.slots.clone(),
        size: Vec::new(),
        walls: Walls::new(bounds, &particles.position, spacing),
    };
    border::clip(&mut layer, ground, spacing)?;
    judge_bend(&layer, if halvings > 1 { MAX_SHARP } else { MAX_SHARP_ONCE })?;
    if halvings > 1 {
        judge_border(&layer)?;
    }
    Ok(layer)
}

/// Judges the triangles in the box: beyond it they are cut away.
fn judge_triangles(joined: &Triangulation, particles: &Particles, bounds: &Bounds) -> Result<(), Refusal> {
    let triangles = joined.triangles.len() as f64;
    let is_inside = |&v: &u32| bounds.contains(particles.position[v as usize]);
    let left_out = || joined.left_out.iter().copied().filter(is_inside);
    if let Some(v) = joined.unfilled.iter().flatten().copied().find(is_inside) {
        return Err(doubtful(particles, v));
    }
    // The only particle of a component, say.
    let is_seed = |&v: &u32| particles.parent[v as usize] == Particles::NO_PARENT;
    if let Some(v) = left_out().find(is_seed) {
        return Err(doubtful(particles, v));
    }
    if joined.rounds > MAX_ROUNDS
        || (joined.agreed as f64) < LEAST_AGREED * triangles
        || left_out().count() as f64 > MAX_LEFT_OUT * particles.len() as f64
        || joined.triangles.is_empty()
    {
        return Err(doubtful(particles, left_out().next().unwrap_or(0)));
    }
    Ok(())
}

fn doubtful(particles: &Particles, v: u32) -> Refusal {
    Refusal::Doubtful { at: particles.position.get(v as usize).copied().unwrap_or_default().into() }
}

/// Judges the number of particles of each component that reaches into the box.
fn judge_size(
    mesh: &HalfEdges,
    particles: &Particles,
    bounds: &Bounds,
    halvings: u32,
) -> Result<(), Refusal> {
    // At full resolution there are no more to be had.
    let least = if halvings > 0 { LEAST_PARTICLES } else { 0 };
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
            return Err(Refusal::Small { at: particles.position[root as usize].into() });
        }
    }
    Ok(())
}

fn judge_bend(layer: &Layer, max_sharp: f64) -> Result<(), Refusal> {
    let mesh = &layer.mesh;
    let (mut edges, mut sharp) = (0_usize, 0_usize);
    let mut sharpest = (SHARP, Vec3::ZERO);
    for h in mesh.edges() {
        let [a, b] = [mesh.origin(h), mesh.target(h)].map(|v| layer.normal[v as usize]);
        edges += 1;
        sharp += usize::from(a.dot(b) < SHARP);
        if a.dot(b) < sharpest.0 {
            sharpest = (a.dot(b), layer.position[mesh.origin(h) as usize]);
        }
    }
    if sharp as f64 > max_sharp * edges as f64 {
        Err(Refusal::Sharp { at: sharpest.1.into() })
    } else {
        Ok(())
    }
}

/// Judges how much of a clipped front lies on its border.
fn judge_border(layer: &Layer) -> Result<(), Refusal> {
    if !layer.has_border() {
        return Ok(());
    }
    let vertices = || (0..layer.position.len() as u32).filter(|&v| layer.mesh.has_vertex(v));
    let border = || vertices().filter(|&v| layer.mesh.is_border(v));
    match border().next() {
        Some(v) if border().count() as f64 > MAX_BORDER * vertices().count() as f64 => {
            Err(Refusal::Narrow { at: layer.position[v as usize].into() })
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An octahedron whose normals point up, but for some that lie down so far that their dot product with that is `along`.
    fn octahedron(lying: &[usize], along: f32) -> Layer {
        let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        let corners = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        let mut normal = vec![Vec3::Z; corners.len()];
        lying.iter().for_each(|&v| normal[v] = Vec3::new((1.0 - along * along).sqrt(), 0.0, along));
        let mesh = HalfEdges::from_triangles(corners.len(), &faces).expect("an octahedron is a surface");
        Layer { mesh, position: corners.to_vec(), normal, ..Layer::default() }
    }

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
            agreed: 900,
            rounds: 2,
            left_out: vec![1, 2],
            unfilled: vec![vec![990, 991]],
            ..Triangulation::default()
        };
        assert_eq!(judge_triangles(&good, &particles, &bounds), Ok(()));
        let beyond = Triangulation { left_out: (988..1000).collect(), ..good.clone() };
        assert_eq!(judge_triangles(&beyond, &particles, &bounds), Ok(()));
        let doubtful_at = |v: usize| Err(Refusal::Doubtful { at: particles.position[v].into() });
        for (bad, place) in [
            (Triangulation { rounds: 3, ..good.clone() }, 1),
            (Triangulation { agreed: 899, ..good.clone() }, 1),
            (Triangulation { left_out: vec![5, 6, 7], ..good.clone() }, 5),
            (Triangulation { triangles: Vec::new(), agreed: 0, ..good.clone() }, 1),
            (Triangulation { unfilled: vec![vec![990, 991], vec![995, 30]], ..good.clone() }, 30),
            (Triangulation { left_out: vec![0], ..good.clone() }, 0),
        ] {
            assert_eq!(judge_triangles(&bad, &particles, &bounds), doubtful_at(place), "{bad:?}");
        }
    }

    #[test]
    fn a_front_is_refused_where_too_many_edges_are_sharp_and_the_sharpest_is_named() {
        // Of the twelve edges four end at a vertex.
        let third = 4.0 / 12.0;
        let flat = octahedron(&[], 0.0);
        assert!(judge_bend(&flat, 0.0).is_ok());
        for vertex in 0..6 {
            let bent = octahedron(&[vertex], 0.49);
            assert!(judge_bend(&bent, 1.01 * third).is_ok(), "{vertex}");
            let Err(Refusal::Sharp { at }) = judge_bend(&bent, 0.99 * third) else {
                panic!("vertex {vertex} is not found sharp");
            };
            assert_ne!(
                Vec3::from(at.0),
                -bent.position[vertex],
                "opposite vertices have no edge between them"
            );
            assert!(judge_bend(&octahedron(&[vertex], 0.51), 0.0).is_ok(), "{vertex}");
        }
        // Where both ends lie down, the edge between them is flat.
        assert!(judge_bend(&octahedron(&[0, 2], 0.0), 6.01 / 12.0).is_ok());
        assert!(judge_bend(&octahedron(&[0, 2], 0.0), 5.99 / 12.0).is_err());
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
            (1.61, 56_000.0, None),
            (f64::INFINITY, 56_000.0, None),
            (f64::NAN, 56_000.0, None),
            (0.033, 719.0, None),
            (0.033, 179.0, None),
        ] {
            assert_eq!(halvings(bend, count, false), expected, "bend {bend}, count {count}");
            let finer = expected.map(|halvings: u32| (halvings - 1).max(1));
            assert_eq!(halvings(bend, count, true), finer, "bend {bend}, count {count}, sizes that differ");
        }
    }
}
