//! Whether a clipped mesh has every part of the surface that the box leaves.

use super::super::layer::Layer;
use super::super::refusal::Refusal;
use crate::math::unkey;
use crate::mesh::half_edge::{next, previous};
use crate::spatial::tree::Tree;
use glam::Vec3;

/// Vertices near a point whose triangles are looked at.
const NEAR: usize = 4;
/// Largest distance of a point of the surface from the mesh, in spacings: at the largest curvature that a coarse front may have,
/// the surface rises over a triangle by a quarter of that, and where it meets the box at an acute angle its border runs off by
/// more.
const FARTHEST: f32 = 0.5;

/// Checks that each of some points of the surface in the box is near a triangle of one of the layers. Where no layer is near the
/// box, nothing is checked.
///
/// # Errors
///
/// Which point is not.
pub(in super::super) fn judge_cover<'a>(
    layers: impl Iterator<Item = &'a Layer>,
    points: &[Vec3],
    spacing: f32,
) -> Result<(), Refusal> {
    let layers: Vec<&Layer> = layers.collect();
    let Some(walls) = layers.iter().map(|layer| &layer.walls).find(|walls| walls.is_near()) else {
        return Ok(());
    };
    // Each vertex with its layer.
    let vertices: Vec<(&Layer, u32)> = layers
        .iter()
        .flat_map(|&layer| (0..layer.position.len() as u32).map(move |v| (layer, v)))
        .filter(|&(layer, v)| layer.mesh.has_vertex(v))
        .collect();
    let tree = Tree::of(vertices.iter().map(|&(layer, v)| layer.position[v as usize]).zip(0..).collect());
    let reach_sq = (FARTHEST * spacing) * (FARTHEST * spacing);
    let mut keys = Vec::new();
    for &p in points.iter().filter(|&&p| walls.contains(p)) {
        tree.nearest_many(p, NEAR, |_| true, &mut keys);
        let is_near = keys.iter().any(|&key| {
            let (layer, v) = vertices[tree.origin[unkey(key).1 as usize] as usize];
            layer.mesh.around(v).any(|h| {
                let corners =
                    [h, next(h), previous(h)].map(|h| layer.position[layer.mesh.origin(h) as usize]);
                distance_sq(p, corners) <= reach_sq
            })
        });
        if !is_near {
            return Err(Refusal::Missed { at: p.into() });
        }
    }
    Ok(())
}

/// Squared distance of a point from a triangle.
fn distance_sq(p: Vec3, [a, b, c]: [Vec3; 3]) -> f32 {
    let normal = (b - a).cross(c - a);
    let sides = [(a, b), (b, c), (c, a)];
    let is_above = sides.iter().all(|&(a, b)| (b - a).cross(p - a).dot(normal) >= 0.0);
    if is_above {
        let rise = (p - a).dot(normal);
        return rise * rise / normal.length_squared();
    }
    let to_side = |&(a, b): &(Vec3, Vec3)| {
        let along = b - a;
        let share = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        p.distance_squared(a + along * share)
    };
    sides.iter().map(to_side).fold(f32::INFINITY, f32::min)
}
