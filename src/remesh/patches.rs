//! The smooth patches of a mesh, and the edges and corners at which they meet.

use super::MeshSolid;
use super::edges::{Edges, ends_of};
use super::rule::Rule;
use crate::math::NONE;
use glam::DVec3;

/// Share of the length of an edge within which both of its patches may give f. The smooth patches
/// leave the faces by the height of an arc over its chord, which at 30° is a fifteenth of it.
const NEAR: f64 = 0.5;
/// Most length of that, over the diagonal: the functions of patches go that far beyond them.
const MOST_NEAR: f64 = 0.06;
/// Smallest angle between two planes that meet in an edge, though it is less than that of edges:
/// rounding and repairs of a plane bend it by less.
const BENT: f64 = 0.02;

/// An edge of the mesh at which two patches meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crease {
    pub(super) ends: [u32; 2],
    pub(super) patches: [u32; 2],
    pub(super) is_convex: bool,
    /// The distance within which both patches may give f.
    pub(super) near: f64,
}

/// A vertex at which creases meet.
#[derive(Clone, Debug)]
pub(super) struct Corner {
    pub(super) vertex: u32,
    pub(super) near: f64,
    pub(super) rule: Rule,
}

/// The patches of a mesh.
#[derive(Debug, Default)]
pub(super) struct Patches {
    /// The patch of each face.
    pub(super) of_face: Vec<u32>,
    pub(super) count: usize,
    pub(super) creases: Vec<Crease>,
    pub(super) corners: Vec<Corner>,
    /// Sharp edges with the same patch on both sides: ends of edges that fade out, which are
    /// rounded.
    pub(super) faded: usize,
    /// All sharp edges.
    pub(super) sharp: usize,
}

impl Patches {
    /// The patches between edges whose faces meet at `angle` or more, in radians. The mesh is
    /// closed.
    pub(super) fn new(solid: &MeshSolid, angle: f64) -> Self {
        let (mesh, edges) = (&*solid.mesh, &*solid.edges);
        let normals: Vec<DVec3> = mesh.area_vectors().map(DVec3::normalize_or_zero).collect();
        let mut is_sharp = sharp_edges(edges, &normals, angle);
        add_lone_bends(edges, &normals, &mut is_sharp);
        let of_face = flood(normals.len(), edges, &is_sharp);
        let count = of_face.iter().max().map_or(0, |&last| last as usize + 1);
        let most = MOST_NEAR * mesh.bounds().diagonal();
        let mut found = Self { of_face, count, ..Self::default() };
        for edge in (0..edges.len()).filter(|&edge| is_sharp[edge]) {
            let [here, there] = edges.sides(edge) else { continue };
            found.sharp += 1;
            let patches = [here, there].map(|side| found.of_face[side.face as usize]);
            if patches[0] == patches[1] {
                found.faded += 1;
                continue;
            }
            let ends = edges.ends(edge);
            let [a, b] = ends.map(|end| mesh.vertices()[end as usize]);
            let other = mesh.faces()[there.face as usize][(there.side as usize + 2) % 3];
            let rise = normals[here.face as usize].dot(mesh.vertices()[other as usize] - a);
            let near = (NEAR * a.distance(b)).min(most);
            found.creases.push(Crease { ends, patches, is_convex: rise < 0.0, near });
        }
        found.corners = found.find_corners(solid, &normals);
        found
    }

    /// Whether these are the patches of a part with edges: nearly all sharp edges part two patches,
    /// and the patches are few. The sharp edges of a noisy scan begin and end anywhere.
    pub(super) fn are_of_part(&self) -> bool {
        /// Largest share of the sharp edges that fade out.
        const FADED: f64 = 0.1;
        /// Most patches.
        const MOST: usize = 2_000;
        self.sharp > 0 && self.faded as f64 <= FADED * self.sharp as f64 && self.count <= MOST
    }

    /// The vertices at which three or more creases meet, each with the rule by which the patches
    /// there make f. Where the rule of a vertex is not found, the nearest crease decides alone.
    fn find_corners(&self, solid: &MeshSolid, normals: &[DVec3]) -> Vec<Corner> {
        let (mesh, edges) = (&*solid.mesh, &*solid.edges);
        let mut at_vertex: Vec<(u32, u32)> =
            (0..).zip(&self.creases).flat_map(|(k, crease)| crease.ends.map(|end| (end, k))).collect();
        at_vertex.sort_unstable();
        // A face at each vertex, from which one can walk round it.
        let mut face_at = vec![NONE; mesh.vertices().len()];
        for (face, corners) in (0..).zip(mesh.faces()) {
            corners.iter().for_each(|&corner| face_at[corner as usize] = face);
        }
        let mut corners = Vec::new();
        for own in at_vertex.chunk_by(|a, b| a.0 == b.0).filter(|own| own.len() > 2) {
            let vertex = own[0].0;
            let Some(ring) = ring(mesh.faces(), edges, vertex, face_at[vertex as usize]) else { continue };
            let place = mesh.vertices()[vertex as usize];
            // The patches in their order around the vertex, with their normals there, and whether
            // the edge to the next one is convex.
            let mut around: Vec<(u32, DVec3, bool)> = Vec::new();
            for (face, edge) in ring {
                let patch = self.of_face[face as usize];
                let [u, v] = sides_at(mesh.faces()[face as usize], vertex)
                    .map(|end| mesh.vertices()[end as usize] - place);
                let angle = libm::atan2(u.cross(v).length(), u.dot(v));
                let turn = angle * normals[face as usize];
                match around.last_mut() {
                    Some((last, normal, _)) if *last == patch => *normal += turn,
                    _ => around.push((patch, turn, true)),
                }
                let ends = edges.ends(edge as usize);
                let crease = own.iter().map(|&(_, k)| self.creases[k as usize]).find(|c| c.ends == ends);
                if let (Some(crease), Some((_, _, is_convex))) = (crease, around.last_mut()) {
                    *is_convex = crease.is_convex;
                }
            }
            if around.len() > 1 && around[0].0 == around[around.len() - 1].0 {
                // The walk began within this patch.
                let (_, normal, _) = around.remove(around.len() - 1);
                around[0].1 += normal;
            }
            let lengths = own.iter().map(|&(_, k)| {
                let [a, b] = self.creases[k as usize].ends.map(|end| mesh.vertices()[end as usize]);
                a.distance(b)
            });
            let shortest = lengths.fold(f64::INFINITY, f64::min);
            let is_inside = |way: DVec3| solid.tree.winding(place + 0.1 * shortest * way) > 0.5;
            if let Some(rule) = Rule::around(&around, is_inside) {
                let near = own.iter().map(|&(_, k)| self.creases[k as usize].near).fold(0.0, f64::max);
                corners.push(Corner { vertex, near: near.min(NEAR * shortest), rule });
            }
        }
        corners
    }
}

/// Which edges have faces that meet at `angle` or more.
fn sharp_edges(edges: &Edges, normals: &[DVec3], angle: f64) -> Vec<bool> {
    let least = libm::cos(angle) + 1e-9;
    (0..edges.len())
        .map(|edge| match edges.sides(edge) {
            [a, b] => normals[a.face as usize].dot(normals[b.face as usize]) < least,
            _ => true,
        })
        .collect()
}

/// Adds the edges in which two planes meet that bend nowhere else: they are no part of a curved
/// patch, however small their angle.
fn add_lone_bends(edges: &Edges, normals: &[DVec3], is_sharp: &mut [bool]) {
    let turn = |edge: usize| match edges.sides(edge) {
        [a, b] => {
            let [n, m] = [a, b].map(|side| normals[side.face as usize]);
            libm::atan2(n.cross(m).length(), n.dot(m))
        }
        _ => 0.0,
    };
    let turns: Vec<f64> = (0..edges.len()).map(turn).collect();
    let is_bent: Vec<bool> = turns.iter().map(|&turn| turn > BENT).collect();
    let plane = flood(normals.len(), edges, &is_bent);
    let bends = |edge: &usize| is_bent[*edge] && !is_sharp[*edge];
    // The planes next to each plane across edges that are not sharp.
    let mut beside: Vec<[u32; 2]> = Vec::new();
    for edge in (0..edges.len()).filter(bends) {
        if let [a, b] = edges.sides(edge) {
            let [p, q] = [a, b].map(|side| plane[side.face as usize]);
            beside.extend([[p, q], [q, p]]);
        }
    }
    beside.sort_unstable();
    beside.dedup();
    let neighbours = |p: u32| {
        let first = beside.partition_point(|pair| pair[0] < p);
        beside[first..].iter().take_while(|pair| pair[0] == p).count()
    };
    let lone: Vec<usize> = (0..edges.len())
        .filter(bends)
        .filter(|&edge| edges.sides(edge).iter().all(|side| neighbours(plane[side.face as usize]) == 1))
        .collect();
    lone.into_iter().for_each(|edge| is_sharp[edge] = true);
}

/// The part of each face, where parts end at the edges that are a limit.
fn flood(count: usize, edges: &Edges, is_limit: &[bool]) -> Vec<u32> {
    let mut part = vec![NONE; count];
    let mut parts = 0;
    let mut open = Vec::new();
    for start in 0..count {
        if part[start] != NONE {
            continue;
        }
        part[start] = parts;
        open.push(start as u32);
        while let Some(face) = open.pop() {
            for edge in edges.of_face(face).map(|edge| edge as usize).into_iter().filter(|&e| !is_limit[e]) {
                for side in edges.sides(edge) {
                    if part[side.face as usize] == NONE {
                        part[side.face as usize] = parts;
                        open.push(side.face);
                    }
                }
            }
        }
        parts += 1;
    }
    part
}

/// The ends of the two sides of a face at one of its corners: behind and ahead of it.
fn sides_at(face: [u32; 3], vertex: u32) -> [u32; 2] {
    let k = face.iter().position(|&corner| corner == vertex).unwrap_or(0);
    [face[(k + 1) % 3], face[(k + 2) % 3]]
}

/// The faces around a vertex in counter-clockwise order, each with the edge to the next one; none if
/// they do not close to one ring.
fn ring(faces: &[[u32; 3]], edges: &Edges, vertex: u32, first: u32) -> Option<Vec<(u32, u32)>> {
    /// More faces at a vertex are hardly a corner.
    const MOST: usize = 4096;
    let mut ring = Vec::new();
    let mut face = first;
    while ring.len() < MOST {
        // The side that ends at the vertex is shared with the next face.
        let side = (0..3).find(|&side| ends_of(&faces[face as usize], side)[1] == vertex)?;
        let edge = edges.of_face(face)[side as usize];
        ring.push((face, edge));
        let [a, b] = edges.sides(edge as usize) else { return None };
        face = if a.face == face { b.face } else { a.face };
        if face == first {
            return Some(ring);
        }
    }
    None
}
