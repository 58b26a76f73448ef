//! Clips a coarse mesh that reaches beyond the box.
//!
//! Every edge that crosses a plane of the box is split where the surface and the plane meet, and,
//! for an edge of the border, also the plane along which it runs. Faces of the mesh with a vertex
//! beyond the box are then dropped. Since no edge crosses any more, the rest is a manifold with
//! every border vertex on the box. The short edges made by the cuts are collapsed.

use super::super::net::{Ground, Net};
use super::super::refusal::Refusal;
use super::super::walls::{Planes, Site};
use super::land_on;
use crate::math::{Bounds, Forest, NONE};
use crate::mesh::half_edge::{HalfEdges, next, previous};
use glam::Vec3;

/// Spacings by which the coarse front grows beyond the box: its ragged edge is cut away. With less
/// than one spacing more surfaces are refused.
const BEYOND: f64 = 3.0;
/// Twice the area of a triangle that is flat for certain, as a share of the spacing squared. With 0
/// some surfaces are refined fewer times.
const FLAT: f32 = 0.05;
/// A front that cannot grow beyond the box ends at most this share of the spacing before it.
/// Smaller: fewer fields that end at the box are refined.
const OPEN_END: f32 = 1.3;
/// Particles nearer to each other than this share of the spacing are at one place: where the
/// surface passes that near a corner of the box, the corner is taken for a point of it. Larger: the
/// corner may be farther from the surface than other refined particles.
const ONE_PLACE: f32 = 1e-3;
/// Halvings of an edge between its crossing with a plane and that of the surface, at most: they end
/// where single precision does.
const HALVINGS: u32 = 24;

/// The box in which a coarse front of particles with this radius grows.
pub(crate) fn grown(bounds: &Bounds, radius: f64) -> Bounds {
    let margin = BEYOND * 2.0 * radius;
    Bounds { min: bounds.min.map(|x| x - margin), max: bounds.max.map(|x| x + margin) }
}

/// Cuts away the part beyond the box.
///
/// # Errors
///
/// A place where the surface ends inside the box, or where its border could not be laid on the
/// planes.
pub(in super::super) fn clip(net: &mut Net, ground: &mut Ground, spacing: f32) -> Result<(), Refusal> {
    if !net.walls.is_near() {
        return open_end(net).map_or(Ok(()), |v| Err(border(net, v)));
    }
    if !net.walls.lo.cmplt(net.walls.hi).all() {
        return Err(Refusal::Cut { at: net.walls.lo.into() });
    }
    let mut is_cut = false;
    for plane in 0..Planes::ALL {
        if (0..net.position.len() as u32).any(|v| net.mesh.has_vertex(v) && is_beyond(net, v, plane)) {
            is_cut = true;
            cut(net, ground, spacing, plane)?;
            drop_beyond(net, plane)?;
        }
    }
    if let Some(v) = open_end(net) {
        is_cut = true;
        close_open_ends(net, ground, spacing, v)?;
    }
    for (p, &planes) in net.position.iter_mut().zip(&net.walls.planes) {
        *p = net.walls.pinned(p.clamp(net.walls.lo, net.walls.hi), planes);
    }
    if is_cut {
        drop_points(net, spacing)?;
        join_corners(net, spacing);
        tidy(net, spacing);
    }
    let is_off = |&h: &u32| {
        let [a, b] = [net.mesh.origin(h), net.mesh.target(h)].map(|v| net.walls.planes(v));
        net.mesh.twin(h) == NONE && a.common(b).is_inner()
    };
    match net.mesh.edges().find(is_off) {
        Some(h) => Err(Refusal::Cut { at: net.position[net.mesh.origin(h) as usize].into() }),
        None => Ok(()),
    }
}

fn border(net: &Net, v: u32) -> Refusal {
    Refusal::Border { at: net.position[v as usize].into() }
}

fn is_beyond(net: &Net, v: u32, plane: usize) -> bool {
    let is_on = !net.walls.planes(v).common(Planes::of(plane)).is_inner();
    !is_on && net.walls.depth(net.position[v as usize], plane) < -net.walls.slack
}

/// Splits the edges that cross a plane.
fn cut(net: &mut Net, ground: &mut Ground, spacing: f32, plane: usize) -> Result<(), Refusal> {
    let mut h = 0;
    // A split adds half-edges at the end, which may cross too; but every split makes one edge fewer
    // that does.
    while (h as usize) < net.mesh.half_edge_slots() {
        let (a, b) = (net.mesh.origin(h), net.mesh.target(h));
        let is_on = |v: u32| !net.walls.planes(v).common(Planes::of(plane)).is_inner();
        let is_crossing = is_beyond(net, a, plane) != is_beyond(net, b, plane) && !is_on(a) && !is_on(b);
        if is_crossing {
            let site = crossing(net, ground, spacing, [a, b], plane)?;
            split(net, h, site);
        }
        h += 1;
    }
    Ok(())
}

/// The place where the surface over an edge crosses a plane.
///
/// It is looked for from the point in which the edge crosses the plane. Where the surface is almost
/// parallel to the plane, the way along the plane may be long. Then the edge is halved by a point
/// of the surface, as often as necessary, with its ends on both sides of the plane.
fn crossing(
    net: &Net,
    ground: &mut Ground,
    spacing: f32,
    [a, b]: [u32; 2],
    plane: usize,
) -> Result<Site, Refusal> {
    let common = net.planes_between(a, b);
    let planes = common.joined(Planes::of(plane));
    let [mut p, mut q] = [a, b].map(|v| net.position[v as usize]);
    let mut reach = spacing * net.size_between(a, b);
    let across = |p: Vec3, q: Vec3| {
        let [d, e] = [p, q].map(|p| net.walls.depth(p, plane));
        net.walls.pinned(p + (q - p) * (d / (d - e)).clamp(0.0, 1.0), planes)
    };
    let first = across(p, q);
    let clear = (net.walls.lo - first).max(first - net.walls.hi).max_element();
    for _ in 0..HALVINGS {
        if let Some(site) = super::slide(ground, planes, across(p, q), reach) {
            return Ok(site);
        }
        if clear > reach {
            // The part beyond other planes is cut later, and need not lie on the surface.
            return Ok(Site::smooth(first, net.normal[a as usize], planes));
        }
        let Some(middle) = super::slide(ground, common, (p + q) * 0.5, reach) else { break };
        let is_out = net.walls.depth(middle.position, plane) < -net.walls.slack;
        *(if is_out == is_beyond(net, a, plane) { &mut p } else { &mut q }) = middle.position;
        reach *= 0.5;
    }
    Err(Refusal::Cut { at: first.into() })
}

/// Splits an edge by a particle at a site.
fn split(net: &mut Net, h: u32, site: Site) {
    let size = net.size_between(net.mesh.origin(h), net.mesh.target(h));
    let v = net.mesh.split(h);
    net.put_new(v, site, size);
}

/// Drops the faces of the mesh with a vertex beyond a face of the box.
fn drop_beyond(net: &mut Net, plane: usize) -> Result<(), Refusal> {
    keep(net, |net, corners| !corners.iter().any(|&v| is_beyond(net, v, plane)))
}

/// Drops the pieces of the mesh that are no larger than a point: the surface touches the box there
/// from outside, at a corner or along a face.
fn drop_points(net: &mut Net, spacing: f32) -> Result<(), Refusal> {
    let mut pieces = Forest::new(net.position.len());
    for [a, b, c] in net.mesh.triangles() {
        pieces.join(a, b);
        pieces.join(a, c);
    }
    // Whether any particle of a piece is away from the first one.
    let mut is_wide = vec![false; net.position.len()];
    for v in 0..net.position.len() as u32 {
        let first = pieces.find(v) as usize;
        is_wide[first] |= net.position[v as usize].distance(net.position[first]) > ONE_PLACE * spacing;
    }
    if net.mesh.triangles().all(|[a, ..]| is_wide[pieces.find(a) as usize]) {
        return Ok(());
    }
    keep(net, |_, [a, ..]| is_wide[pieces.find(*a) as usize])
}

/// Keeps some faces of the mesh, and drops the others.
fn keep(net: &mut Net, mut is_kept: impl FnMut(&Net, &[u32; 3]) -> bool) -> Result<(), Refusal> {
    let kept: Vec<[u32; 3]> = net.mesh.triangles().filter(|corners| is_kept(net, corners)).collect();
    let at = net.position.first().copied().unwrap_or_default().into();
    net.mesh = HalfEdges::from_triangles(net.position.len(), &kept).ok_or(Refusal::Cut { at })?;
    if kept.is_empty() { Err(Refusal::Cut { at }) } else { Ok(()) }
}

/// A border vertex on no plane of the box.
fn open_end(net: &Net) -> Option<u32> {
    (0..net.position.len() as u32).find(|&v| net.mesh.is_border(v) && net.walls.planes(v).is_inner())
}

/// Moves border vertices on no plane to the nearest one: a field that ends at the box has no
/// surface beyond, and the front ends before it.
fn close_open_ends(net: &mut Net, ground: &mut Ground, spacing: f32, first: u32) -> Result<(), Refusal> {
    for v in first..net.position.len() as u32 {
        if !net.mesh.is_border(v) || !net.walls.planes(v).is_inner() {
            continue;
        }
        let p = net.position[v as usize];
        let depth = |plane: &usize| net.walls.depth(p, *plane);
        let nearest = (0..Planes::ALL).min_by(|a, b| depth(a).total_cmp(&depth(b))).unwrap_or(0);
        let planes = Planes::of(nearest);
        let reach = OPEN_END * spacing * net.size_of(v);
        let is_near = depth(&nearest) <= reach;
        let landing = if is_near { land_on(&net.walls, ground, planes, p, reach) } else { None };
        let Some(site) = landing else { return Err(border(net, v)) };
        net.put(v, site);
    }
    // Between two planes the border has a corner.
    for h in 0..net.mesh.half_edge_slots() as u32 {
        if !net.mesh.has_half_edge(h) || net.mesh.twin(h) != NONE {
            continue;
        }
        let (a, b) = (net.mesh.origin(h), net.mesh.target(h));
        let (m, n) = (net.walls.planes(a), net.walls.planes(b));
        if m.common(n).is_inner() {
            let planes = m.joined(n);
            let start = net.walls.pinned((net.position[a as usize] + net.position[b as usize]) * 0.5, planes);
            let reach = 2.0 * spacing * net.size_between(a, b);
            let corner = super::slide(ground, planes, start, reach);
            split(net, h, corner.ok_or(Refusal::Cut { at: start.into() })?);
        }
    }
    Ok(())
}

/// Joins particles on two planes each that are at one place. Where the surface passes through a
/// corner of the box, each of its edges has been cut there.
fn join_corners(net: &mut Net, spacing: f32) {
    for h in 0..net.mesh.half_edge_slots() as u32 {
        if !net.mesh.has_half_edge(h) || net.mesh.twin(h) != NONE {
            continue;
        }
        let (a, b) = (net.mesh.origin(h), net.mesh.target(h));
        let [first, second] = [a, b].map(|v| net.site(v));
        let are_corners = first.planes.of_box().is_corner() && second.planes.of_box().is_corner();
        let is_one_place = first.position.distance(second.position) <= ONE_PLACE * spacing;
        let are_free = !first.planes.is_crease() && !second.planes.is_crease();
        if are_corners && is_one_place && are_free && net.mesh.can_collapse(h) {
            let planes = first.planes.joined(second.planes);
            net.mesh.begin();
            net.mesh.collapse(h);
            net.mesh.keep();
            net.put(b, Site { position: net.walls.pinned(second.position, planes), planes, ..second });
        }
    }
}

/// Collapses the short edges at the border, and makes edges Delaunay by flips. Every round but the
/// last removes a particle.
fn tidy(net: &mut Net, spacing: f32) {
    loop {
        let has_changed = net.thin(spacing);
        net.flip(0..net.mesh.half_edge_slots() as u32);
        if !has_changed {
            break;
        }
    }
}

/// Collapses an edge if that is allowed and makes no flat triangle; returns whether it did.
pub(super) fn collapse(net: &mut Net, h: u32, spacing: f32) -> bool {
    if !net.can_merge(h) {
        return false;
    }
    let (a, b) = (net.mesh.origin(h), net.mesh.target(h));
    let least = least_area(net, a).min(least_area(net, b)).min(FLAT * spacing * spacing);
    let (before, merged) = (net.site(b), net.more_bound(a, b));
    net.mesh.begin();
    net.mesh.collapse(h);
    net.put(b, merged);
    if least_area(net, b) >= least && !net.has_face_along_border(b) {
        net.mesh.keep();
        return true;
    }
    net.mesh.undo();
    net.put(b, before);
    false
}

/// Twice the least area of the triangles at a vertex, seen along its normal.
fn least_area(net: &Net, v: u32) -> f32 {
    let area = |h: u32| {
        let corners = [h, next(h), previous(h)].map(|h| net.mesh.origin(h));
        net.area_vector(corners).dot(net.normal[v as usize])
    };
    net.mesh.around(v).map(area).fold(f32::INFINITY, f32::min)
}
