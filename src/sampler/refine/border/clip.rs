//! Clips a coarse mesh that reaches beyond the box.
//!
//! Every edge that crosses a face of the box is split where the surface, the face and, for an edge of the border, the face on which
//! it runs meet. Faces of the mesh with a vertex beyond the box are then dropped. Since no edge crosses any more, what is left is a
//! manifold with every border vertex on the box. Its short edges, which the cuts have made, are collapsed.

use super::super::layer::{Ground, Layer};
use super::super::refusal::Refusal;
use super::super::walls::Planes;
use super::land_on;
use crate::math::{Bounds, key, unkey};
use crate::mesh::half_edge::{HalfEdges, NONE, next, previous};
use glam::Vec3;

/// Spacings by which the coarse front grows beyond the box: what is near its ragged edge is cut away.
const BEYOND: f64 = 3.0;
/// Edges at the border shorter than this share of the spacing are collapsed. Half of it would leave an edge cut in two.
const SHORT: f32 = 0.6;
/// Rounds of that, and of flips afterwards.
const ROUNDS: u32 = 4;
/// Twice the area of a triangle that is flat for certain, as a share of the spacing squared.
const FLAT: f32 = 0.05;
/// Where the front cannot grow beyond the box it ends before it, by no more than this share of the spacing.
const OPEN_END: f32 = 1.3;

/// The box to which a coarse front grows whose particles have this radius.
pub(crate) fn grown(bounds: &Bounds, radius: f64) -> Bounds {
    let margin = BEYOND * 2.0 * radius;
    Bounds { min: bounds.min.map(|x| x - margin), max: bounds.max.map(|x| x + margin) }
}

/// Cuts away what lies beyond the box.
///
/// # Errors
///
/// Where the surface ends inside the box, or its border could not be laid on the faces.
pub(in super::super) fn clip(layer: &mut Layer, ground: &mut Ground, spacing: f32) -> Result<(), Refusal> {
    if !layer.walls.is_near() {
        return open_end(layer).map_or(Ok(()), |v| Err(border(layer, v)));
    }
    if !layer.walls.lo.cmplt(layer.walls.hi).all() {
        return Err(Refusal::Cut { at: layer.walls.lo.into() });
    }
    let mut is_cut = false;
    for plane in 0..Planes::ALL {
        if (0..layer.position.len() as u32).any(|v| layer.mesh.has_vertex(v) && is_beyond(layer, v, plane)) {
            is_cut = true;
            cut(layer, ground, spacing, plane)?;
            drop_beyond(layer, plane)?;
        }
    }
    if let Some(v) = open_end(layer) {
        is_cut = true;
        close_open_ends(layer, ground, spacing, v)?;
    }
    for (p, &planes) in layer.position.iter_mut().zip(&layer.walls.planes) {
        *p = layer.walls.pinned(p.clamp(layer.walls.lo, layer.walls.hi), planes);
    }
    if is_cut {
        tidy(layer, spacing);
    }
    let is_off = |&h: &u32| {
        let [a, b] = [layer.mesh.origin(h), layer.mesh.target(h)].map(|v| layer.walls.planes(v));
        layer.mesh.twin(h) == NONE && a.common(b).is_inner()
    };
    match layer.mesh.edges().find(is_off) {
        Some(h) => Err(Refusal::Cut { at: layer.position[layer.mesh.origin(h) as usize].into() }),
        None => Ok(()),
    }
}

fn border(layer: &Layer, v: u32) -> Refusal {
    Refusal::Border { at: layer.position[v as usize].into() }
}

fn is_beyond(layer: &Layer, v: u32, plane: usize) -> bool {
    let is_on = !layer.walls.planes(v).common(Planes::of(plane)).is_inner();
    !is_on && layer.walls.depth(layer.position[v as usize], plane) < -layer.walls.slack
}

/// Splits the edges that cross a face.
fn cut(layer: &mut Layer, ground: &mut Ground, spacing: f32, plane: usize) -> Result<(), Refusal> {
    let mut h = 0;
    // A split adds half-edges at the end, which may cross too; but every split makes one edge fewer that does.
    while (h as usize) < layer.mesh.half_edge_slots() {
        let (a, b) = (layer.mesh.origin(h), layer.mesh.target(h));
        let is_on = |v: u32| !layer.walls.planes(v).common(Planes::of(plane)).is_inner();
        let is_crossing = is_beyond(layer, a, plane) != is_beyond(layer, b, plane) && !is_on(a) && !is_on(b);
        if is_crossing {
            let common = layer.planes_between(a, b);
            let [p, q] = [a, b].map(|v| layer.position[v as usize]);
            let [d, e] = [p, q].map(|p| layer.walls.depth(p, plane));
            let start = p + (q - p) * (d / (d - e)).clamp(0.0, 1.0);
            let planes = common.joined(Planes::of(plane));
            split(layer, ground, h, (start, planes), spacing)?;
        }
        h += 1;
    }
    Ok(())
}

/// Splits an edge by a particle on some faces, near a place.
fn split(
    layer: &mut Layer,
    ground: &mut Ground,
    h: u32,
    (start, planes): (Vec3, Planes),
    reach: f32,
) -> Result<(), Refusal> {
    // The box may be left along the face: what is beyond its other faces is cut later, and need not lie on the surface.
    let place = layer.walls.pinned(start, planes);
    let clear = (layer.walls.lo - place).max(place - layer.walls.hi).max_element();
    let (position, normal) = match super::slide(ground, planes.free(), place, reach) {
        Some(landing) => landing,
        None if clear > reach => (place, layer.normal[layer.mesh.origin(h) as usize]),
        None => return Err(Refusal::Cut { at: place.into() }),
    };
    let v = layer.mesh.split(h);
    layer.put(v, position, normal, planes);
    Ok(())
}

/// Drops the faces of the mesh with a vertex beyond a face of the box.
fn drop_beyond(layer: &mut Layer, plane: usize) -> Result<(), Refusal> {
    let kept: Vec<[u32; 3]> = layer
        .mesh
        .triangles()
        .filter(|corners| !corners.iter().any(|&v| is_beyond(layer, v, plane)))
        .collect();
    let at = layer.position.first().copied().unwrap_or_default().into();
    layer.mesh = HalfEdges::from_triangles(layer.position.len(), &kept).map_err(|_| Refusal::Cut { at })?;
    if kept.is_empty() { Err(Refusal::Cut { at }) } else { Ok(()) }
}

/// A border vertex on no face of the box.
fn open_end(layer: &Layer) -> Option<u32> {
    (0..layer.position.len() as u32).find(|&v| layer.mesh.is_border(v) && layer.walls.planes(v).is_inner())
}

/// Moves border vertices on no face to the nearest one: a field that ends at the box has no surface beyond, and the front ends
/// before it.
fn close_open_ends(layer: &mut Layer, ground: &mut Ground, spacing: f32, first: u32) -> Result<(), Refusal> {
    for v in first..layer.position.len() as u32 {
        if !layer.mesh.is_border(v) || !layer.walls.planes(v).is_inner() {
            continue;
        }
        let p = layer.position[v as usize];
        let depth = |plane: &usize| layer.walls.depth(p, *plane);
        let nearest = (0..Planes::ALL).min_by(|a, b| depth(a).total_cmp(&depth(b))).unwrap_or(0);
        let planes = Planes::of(nearest);
        let is_near = depth(&nearest) <= OPEN_END * spacing;
        let landing =
            if is_near { land_on(&layer.walls, ground, planes, p, OPEN_END * spacing) } else { None };
        let Some((position, normal)) = landing else { return Err(border(layer, v)) };
        layer.put(v, position, normal, planes);
    }
    // Between two faces the border has a corner.
    for h in 0..layer.mesh.half_edge_slots() as u32 {
        if !layer.mesh.has_half_edge(h) || layer.mesh.twin(h) != NONE {
            continue;
        }
        let (a, b) = (layer.mesh.origin(h), layer.mesh.target(h));
        let (m, n) = (layer.walls.planes(a), layer.walls.planes(b));
        if m.common(n).is_inner() {
            let start = (layer.position[a as usize] + layer.position[b as usize]) * 0.5;
            split(layer, ground, h, (start, m.joined(n)), 2.0 * spacing)?;
        }
    }
    Ok(())
}

/// Collapses the short edges at the border, and flips edges to those of Delaunay.
fn tidy(layer: &mut Layer, spacing: f32) {
    for _ in 0..ROUNDS {
        let is_at_border = |h: &u32| {
            let [a, b] = [layer.mesh.origin(*h), layer.mesh.target(*h)];
            layer.mesh.is_border(a) || layer.mesh.is_border(b)
        };
        let mut short: Vec<u64> = layer
            .mesh
            .edges()
            .filter(is_at_border)
            .filter(|&h| layer.length(h) < SHORT * spacing)
            .map(|h| key(layer.length(h), h))
            .collect();
        short.sort_unstable();
        let mut has_changed = false;
        for (_, h) in short.into_iter().map(unkey) {
            if layer.mesh.has_half_edge(h) && layer.length(h) < SHORT * spacing {
                let twin = layer.mesh.twin(h);
                has_changed |= collapse(layer, h, spacing) || twin != NONE && collapse(layer, twin, spacing);
            }
        }
        layer.flip(0..layer.mesh.half_edge_slots() as u32);
        if !has_changed {
            break;
        }
    }
}

/// Collapses an edge, where that is allowed and makes no flat triangle; whether it did.
pub(super) fn collapse(layer: &mut Layer, h: u32, spacing: f32) -> bool {
    if !layer.can_merge(h) {
        return false;
    }
    let (a, b) = (layer.mesh.origin(h), layer.mesh.target(h));
    let least = least_area(layer, a).min(least_area(layer, b)).min(FLAT * spacing * spacing);
    let (place, planes) = layer.merged(a, b);
    // On a curve the middle would have to be projected.
    let place = if planes == layer.walls.planes(b) { layer.position[b as usize] } else { place };
    let before = (layer.position[b as usize], layer.normal[b as usize], layer.walls.planes(b));
    layer.mesh.begin();
    layer.mesh.collapse(h);
    layer.position[b as usize] = place;
    if planes != before.2 {
        layer.normal[b as usize] = layer.normal[a as usize];
    }
    layer.walls.set(b, planes);
    if least_area(layer, b) >= least && !layer.has_face_along_border(b) {
        layer.mesh.keep();
        return true;
    }
    layer.mesh.undo();
    layer.put(b, before.0, before.1, before.2);
    false
}

/// Twice the least area of the triangles at a vertex, seen along its normal.
fn least_area(layer: &Layer, v: u32) -> f32 {
    let area = |h: u32| {
        let corners = [h, next(h), previous(h)].map(|h| layer.mesh.origin(h));
        layer.area_vector(corners).dot(layer.normal[v as usize])
    };
    layer.mesh.around(v).map(area).fold(f32::INFINITY, f32::min)
}
