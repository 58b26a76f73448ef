//! The smooth patches of a mesh, and the edges and corners at which they meet.

use super::edges::{Edges, ends_of};
use super::rule::Rule;
use super::tree::Tree;
use super::{MeshSolid, TriangleMesh};
use crate::math::{NONE, sort_pairs};
use glam::DVec3;

/// Distance from an edge within which either of its patches may give f, divided by the diagonal.
/// The smooth surfaces meet beside the edge of the mesh, by up to the height of an arc over its
/// chord; each extends twice this distance beyond the edge.
const NEAR: f64 = 0.06;
/// Distance from a corner within which any of its patches may give f, as a share of the distance to
/// the next corner.
const NEAR_CORNER: f64 = 0.45;
/// Largest angle between faces of one plane, in radians: rounding and repairs turn faces by less.
const BENT: f64 = 0.02;

/// An edge of the mesh at which two patches meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crease {
    pub(super) ends: [u32; 2],
    pub(super) patches: [u32; 2],
    pub(super) is_convex: bool,
}

/// A vertex at which creases meet.
#[derive(Clone, Debug)]
pub(super) struct Corner {
    pub(super) vertex: u32,
    /// Within this distance any of its patches may give f.
    pub(super) near: f64,
    /// The minima and maxima of the patches' functions that give f there; none if no combination
    /// has the inside of the mesh.
    pub(super) rule: Option<Rule>,
    pub(super) patches: Vec<u32>,
    /// The mean of the normals around the vertex.
    pub(super) normal: DVec3,
}

/// The patches of a mesh.
#[derive(Debug, Default)]
pub(super) struct Patches {
    /// The patch of each face.
    pub(super) of_face: Vec<u32>,
    /// Whether each face is a real plane, much wider than the curved faces next to it, and no facet
    /// of a curve.
    pub(super) is_flat: Vec<bool>,
    pub(super) count: usize,
    pub(super) creases: Vec<Crease>,
    pub(super) corners: Vec<Corner>,
    /// Sharp edges with the same patch on both sides. They end curves that fade out, and are
    /// rounded.
    pub(super) faded: usize,
    /// All sharp edges.
    pub(super) sharp: usize,
    /// Whether each patch is a wall, which only limits the surface; empty without walls.
    pub(super) is_wall: Vec<bool>,
    /// Among the vertices where exactly two creases meet, how many are turns: the creases bend by
    /// more than 45° there, or one is convex and the other concave. Then the number of all of them.
    pub(super) turns: [usize; 2],
    /// Within this distance of a crease either of its patches may give f.
    pub(super) near: f64,
}

impl Patches {
    /// Divides a mesh into patches along edges whose faces meet at `angle` or more, in radians, and
    /// along the edges where the faces from number `walls` on meet the others; walls among each
    /// other where the border turns by `turn` or more. `keeps_coarse` divides patches that are too
    /// coarse for curves into their planes.
    pub(super) fn new(
        solid: &MeshSolid,
        angle: f64,
        keeps_coarse: bool,
        (walls, turn): (usize, f64),
    ) -> Self {
        let (mesh, edges) = (&*solid.mesh, &*solid.edges);
        let normals: Vec<DVec3> = mesh.area_vectors().map(DVec3::normalize_or_zero).collect();
        let mut is_sharp = sharp_edges(edges, &normals, angle);
        is_sharp.iter_mut().zip(solid.marked_edges()).for_each(|(own, is_marked)| *own |= is_marked);
        let planes = Planes::new(solid, &normals);
        planes.add_lone_bends(edges, &mut is_sharp);
        bridge(mesh, edges, &mut is_sharp);
        if keeps_coarse {
            planes.add_coarse_bends(edges, &mut is_sharp);
        }
        sharpen_walls(edges, &normals, walls, turn, &mut is_sharp);
        let is_flat = planes.are_flat(solid, &is_sharp);
        let of_face = flood(normals.len(), edges, &is_sharp);
        let count = of_face.iter().max().map_or(0, |&last| last as usize + 1);
        let near = NEAR * mesh.bounds().diagonal();
        let mut found = Self { of_face, is_flat, count, near, ..Self::default() };
        if walls < normals.len() {
            found.is_wall = vec![false; count];
            found.of_face[walls..].iter().for_each(|&patch| found.is_wall[patch as usize] = true);
        }
        for edge in (0..edges.len()).filter(|&edge| is_sharp[edge]) {
            let [here, there] = edges.sides(edge) else { continue };
            found.sharp += 1;
            let patches = [here, there].map(|side| found.of_face[side.face as usize]);
            if patches[0] == patches[1] {
                found.faded += 1;
                continue;
            }
            let ends = edges.ends(edge);
            let a = mesh.vertices()[ends[0] as usize];
            let other = mesh.faces()[there.face as usize][(there.side as usize + 2) % 3];
            let rise = normals[here.face as usize].dot(mesh.vertices()[other as usize] - a);
            found.creases.push(Crease { ends, patches, is_convex: rise < 0.0 });
        }
        found.turns = found.count_turns(mesh);
        found
    }

    /// The patches with the rules of their corners.
    pub(super) fn with_corners(self, solid: &MeshSolid) -> Self {
        let normals: Vec<DVec3> = solid.mesh.area_vectors().map(DVec3::normalize_or_zero).collect();
        Self { corners: self.find_corners(solid, &normals), ..self }
    }

    pub(super) fn is_wall(&self, patch: u32) -> bool {
        self.is_wall.get(patch as usize).is_some_and(|&is_wall| is_wall)
    }

    /// Whether a crease is an edge of the surface, and not of two walls.
    pub(super) fn is_of_surface(&self, crease: &Crease) -> bool {
        !crease.patches.iter().all(|&patch| self.is_wall(patch))
    }

    /// Whether the mesh is a part with edges: nearly all sharp edges separate two patches, there
    /// are few patches, and curves of sharp edges hardly bend. The sharp edges of a noisy scan
    /// begin and end anywhere, zigzag, and alternate between convex and concave.
    pub(super) fn are_of_part(&self) -> bool {
        /// Largest share of the sharp edges that fade out.
        const FADED: f64 = 0.1;
        /// Most patches.
        const MOST: usize = 2_000;
        /// Largest share of turns among the vertices between two sharp edges.
        const TURNS: f64 = 0.25;
        let [turns, all] = self.turns;
        self.sharp > 0
            && self.faded as f64 <= FADED * self.sharp as f64
            && self.count <= MOST
            && turns as f64 <= TURNS * all as f64
    }

    fn count_turns(&self, mesh: &TriangleMesh) -> [usize; 2] {
        const STRAIGHT: f64 = 0.7;
        let both = |&Crease { ends: [a, b], is_convex, .. }: &Crease| [(a, b, is_convex), (b, a, is_convex)];
        let mut from_vertex: Vec<(u32, u32, bool)> = self.creases.iter().flat_map(both).collect();
        from_vertex.sort_unstable();
        let place = |vertex: u32| mesh.vertices()[vertex as usize];
        let mut turns = [0, 0];
        for own in from_vertex.chunk_by(|a, b| a.0 == b.0) {
            if let &[(at, a, first), (_, b, second)] = own {
                let [u, v] = [a, b].map(|end| (place(end) - place(at)).normalize_or_zero());
                turns[0] += usize::from(u.dot(v) > -STRAIGHT || first != second);
                turns[1] += 1;
            }
        }
        turns
    }

    /// Finds the corners, where three or more creases meet, and for each the minima and maxima of
    /// its patches' functions that give f, if there are some.
    fn find_corners(&self, solid: &MeshSolid, normals: &[DVec3]) -> Vec<Corner> {
        let (mesh, edges) = (&*solid.mesh, &*solid.edges);
        let mut at_vertex: Vec<(u32, u32)> =
            (0..).zip(&self.creases).flat_map(|(k, crease)| crease.ends.map(|end| (end, k))).collect();
        at_vertex.sort_unstable();
        // One face at each vertex, from which a walk around the vertex begins.
        let mut face_at = vec![NONE; mesh.vertices().len()];
        for (face, corners) in (0..).zip(mesh.faces()) {
            corners.iter().for_each(|&corner| face_at[corner as usize] = face);
        }
        let meetings = || at_vertex.chunk_by(|a, b| a.0 == b.0).filter(|own| own.len() > 2);
        let places: Vec<[DVec3; 3]> = meetings().map(|own| [mesh.vertices()[own[0].0 as usize]; 3]).collect();
        let places = Tree::new(&places);
        let segments = self.creases.iter().map(|crease| {
            let [a, b] = crease.ends.map(|end| mesh.vertices()[end as usize]);
            [a, b, b]
        });
        let creases = Tree::new(&segments.collect::<Vec<_>>());
        let mut corners = Vec::new();
        for (number, own) in (0..).zip(meetings()) {
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
                // The walk began in the middle of this patch.
                let (_, normal, _) = around.remove(around.len() - 1);
                around[0].1 += normal;
            }
            let lengths = own.iter().map(|&(_, k)| {
                let [a, b] = self.creases[k as usize].ends.map(|end| mesh.vertices()[end as usize]);
                a.distance(b)
            });
            let shortest = lengths.fold(f64::INFINITY, f64::min);
            let is_inside = |way: DVec3| solid.is_below(place + 0.1 * shortest * way);
            // A rule holds for the corner alone: not as far as the next corner, nor another crease.
            let most = self.near / NEAR_CORNER;
            let next = places.nearest_of(place, most * most, |k| k != number);
            let beside =
                creases.nearest_of(place, most * most, |k| !self.creases[k as usize].ends.contains(&vertex));
            let next = [next, beside].into_iter().flatten().map(|found| found.distance_sq);
            let near = next.reduce(f64::min).map_or(self.near, |next| NEAR_CORNER * libm::sqrt(next));
            corners.push(Corner {
                vertex,
                near,
                rule: Rule::around(&around, is_inside),
                patches: around.iter().map(|own| own.0).collect(),
                normal: around.iter().map(|own| own.1).sum(),
            });
        }
        corners
    }
}

/// Makes edges sharp that connect the end of one curve of sharp edges to another curve: along the
/// intersection of two curved surfaces the angle between them may pass through zero.
fn bridge(mesh: &TriangleMesh, edges: &Edges, is_sharp: &mut [bool]) {
    /// Most edges between two ends.
    const STEPS: usize = 12;
    /// Cosine of the largest turn between edges.
    const AHEAD: f64 = 0.7;
    let place = |vertex: u32| mesh.vertices()[vertex as usize];
    let mut at_vertex: Vec<(u32, u32)> =
        (0..edges.len()).flat_map(|edge| edges.ends(edge).map(|end| (end, edge as u32))).collect();
    at_vertex.sort_unstable();
    let around = |vertex: u32| {
        let first = at_vertex.partition_point(|own| own.0 < vertex);
        at_vertex[first..].iter().take_while(move |own| own.0 == vertex).map(|own| own.1 as usize)
    };
    let mut ends: Vec<u32> =
        (0..edges.len()).filter(|&edge| is_sharp[edge]).flat_map(|edge| edges.ends(edge)).collect();
    ends.sort_unstable();
    let lone: Vec<u32> =
        ends.chunk_by(|a, b| a == b).filter(|own| own.len() == 1).map(|own| own[0]).collect();
    ends.dedup();
    for start in lone {
        let Some(first) = around(start).find(|&edge| is_sharp[edge]) else { continue };
        let across = |edge: usize, vertex: u32| {
            let [a, b] = edges.ends(edge);
            if a == vertex { b } else { a }
        };
        let mut at = start;
        let mut way = (place(start) - place(across(first, start))).normalize_or_zero();
        let mut path = Vec::new();
        while path.len() < STEPS && (path.is_empty() || ends.binary_search(&at).is_err()) {
            let ahead = around(at).filter(|&edge| !is_sharp[edge]).map(|edge| {
                let step = (place(across(edge, at)) - place(at)).normalize_or_zero();
                (edge, step, step.dot(way))
            });
            let best = ahead.fold(None, |best: Option<(usize, DVec3, f64)>, own| match best {
                Some(best) if best.2 >= own.2 => Some(best),
                _ => Some(own),
            });
            let Some((edge, step, _)) = best.filter(|best| best.2 > AHEAD) else { break };
            path.push(edge);
            (at, way) = (across(edge, at), step);
        }
        if !path.is_empty() && ends.binary_search(&at).is_ok() {
            path.into_iter().for_each(|edge| is_sharp[edge] = true);
        }
    }
}

/// The number of edges with two faces that meet at the default angle or more.
pub(super) fn sharp_count(solid: &MeshSolid) -> usize {
    let normals: Vec<DVec3> = solid.mesh.area_vectors().map(DVec3::normalize_or_zero).collect();
    let is_sharp = sharp_edges(&solid.edges, &normals, super::DEFAULT_EDGE_ANGLE.to_radians());
    let has_two = |edge: usize| solid.edges.sides(edge).len() == 2;
    (0..is_sharp.len()).filter(|&edge| is_sharp[edge] && has_two(edge)).count()
}

/// Makes the edges sharp at which walls meet the surface, and of those between walls the ones where
/// the border turns by `turn`. The two faces from number `walls` on that come next stand on one
/// edge.
fn sharpen_walls(edges: &Edges, normals: &[DVec3], walls: usize, turn: f64, is_sharp: &mut [bool]) {
    let least = libm::cos(turn) + 1e-9;
    for (edge, is_sharp) in is_sharp.iter_mut().enumerate() {
        let [a, b] = edges.sides(edge) else { continue };
        let [a, b] = [a, b].map(|side| side.face as usize);
        if a.max(b) >= walls {
            let is_one_wall = a.min(b) >= walls && (a - walls) / 2 == (b - walls) / 2;
            *is_sharp = a.min(b) < walls || !is_one_wall && normals[a].dot(normals[b]) < least;
        }
    }
}

/// Whether the faces at each edge meet at `angle` or more.
fn sharp_edges(edges: &Edges, normals: &[DVec3], angle: f64) -> Vec<bool> {
    let least = libm::cos(angle) + 1e-9;
    (0..edges.len())
        .map(|edge| match edges.sides(edge) {
            [a, b] => normals[a.face as usize].dot(normals[b.face as usize]) < least,
            _ => true,
        })
        .collect()
}

/// The planes in which the faces of a mesh lie, and the edges where planes meet.
struct Planes {
    of_face: Vec<u32>,
    count: usize,
    is_bent: Vec<bool>,
}

impl Planes {
    fn new(solid: &MeshSolid, normals: &[DVec3]) -> Self {
        let edges = &*solid.edges;
        let mut of_face = vec![NONE; normals.len()];
        let (mut count, mut open) = (0, Vec::new());
        for start in 0..normals.len() {
            if of_face[start] != NONE {
                continue;
            }
            of_face[start] = count;
            open.push(start as u32);
            while let Some(face) = open.pop() {
                for side in edges.of_face(face).iter().flat_map(|&edge| edges.sides(edge as usize)) {
                    let other = side.face as usize;
                    // Compared with the first face, so that small turns of a curve do not add up.
                    let turn = normals[start].cross(normals[other]).length();
                    if of_face[other] == NONE && turn < BENT && normals[start].dot(normals[other]) > 0.0 {
                        of_face[other] = count;
                        open.push(side.face);
                    }
                }
            }
            count += 1;
        }
        let is_bent = (0..edges.len()).map(|edge| match edges.sides(edge) {
            [a, b] => of_face[a.face as usize] != of_face[b.face as usize],
            _ => true,
        });
        Self { is_bent: is_bent.collect(), count: count as usize, of_face }
    }

    /// The two planes that meet at an edge, if the edge is not sharp.
    fn meeting(&self, edges: &Edges, is_sharp: &[bool], edge: usize) -> Option<[u32; 2]> {
        match edges.sides(edge) {
            [a, b] if self.is_bent[edge] && !is_sharp[edge] => {
                Some([a, b].map(|side| self.of_face[side.face as usize]))
            }
            _ => None,
        }
    }

    /// Makes an edge sharp if its two planes meet no other planes at such edges: however small
    /// their angle, they are not facets of a curved patch.
    fn add_lone_bends(&self, edges: &Edges, is_sharp: &mut [bool]) {
        let pairs = (0..edges.len()).filter_map(|edge| self.meeting(edges, is_sharp, edge));
        let mut beside: Vec<[u32; 2]> = pairs.flat_map(|[p, q]| [[p, q], [q, p]]).collect();
        beside.sort_unstable();
        beside.dedup();
        let neighbours = |p: &u32| {
            let first = beside.partition_point(|pair| pair[0] < *p);
            beside[first..].iter().take_while(|pair| pair[0] == *p).count()
        };
        let lone = (0..edges.len()).filter(|&edge| {
            let pair = self.meeting(edges, is_sharp, edge);
            pair.is_some_and(|pair| pair.iter().all(|plane| neighbours(plane) == 1))
        });
        let lone: Vec<usize> = lone.collect();
        lone.into_iter().for_each(|edge| is_sharp[edge] = true);
    }

    /// Makes all bends of a patch sharp if most of the vertices on its border are corners, until
    /// there is no such patch. The border of a curved patch is divided as the patch is, and has
    /// vertices between its corners. Without them the faces are those of a coarse model, some of
    /// whose angles are above the least one of an edge and others below.
    fn add_coarse_bends(&self, edges: &Edges, is_sharp: &mut [bool]) {
        loop {
            let of_face = flood(self.of_face.len(), edges, is_sharp);
            let sharp: Vec<usize> = (0..edges.len()).filter(|&edge| is_sharp[edge]).collect();
            let mut ends: Vec<u32> = sharp.iter().flat_map(|&edge| edges.ends(edge)).collect();
            ends.sort_unstable();
            let is_corner =
                |vertex: u32| ends.get(ends.partition_point(|&own| own < vertex) + 2) == Some(&vertex);
            let mut borders: Vec<(u32, u32)> = Vec::new();
            for &edge in &sharp {
                for side in edges.sides(edge) {
                    borders.extend(edges.ends(edge).map(|end| (of_face[side.face as usize], end)));
                }
            }
            sort_pairs(&mut borders);
            borders.dedup();
            let is_coarse =
                |own: &[(u32, u32)]| 2 * own.iter().filter(|own| is_corner(own.1)).count() > own.len();
            let mut is_divided = vec![false; of_face.len()];
            for own in borders.chunk_by(|a, b| a.0 == b.0).filter(|own| is_coarse(own)) {
                is_divided[own[0].0 as usize] = true;
            }
            let mut is_done = true;
            for (edge, is_sharp) in is_sharp.iter_mut().enumerate() {
                let patch = edges.sides(edge).first().map(|side| of_face[side.face as usize]);
                let is_inner = !*is_sharp && self.is_bent[edge];
                if is_inner && patch.is_some_and(|patch| is_divided[patch as usize]) {
                    *is_sharp = true;
                    is_done = false;
                }
            }
            if is_done {
                return;
            }
        }
    }

    /// Which faces are flat, by the widths of their planes: twice the area divided by the length of
    /// the edges where the plane bends. For a facet it is the distance between these edges.
    fn are_flat(&self, solid: &MeshSolid, is_sharp: &[bool]) -> Vec<bool> {
        /// How many times wider a plane is than facets next to it; facets of one curve differ less.
        const WIDER: f64 = 3.0;
        let (mesh, edges) = (&*solid.mesh, &*solid.edges);
        let mut size = vec![[0.0, 0.0]; self.count];
        for (&plane, vector) in self.of_face.iter().zip(mesh.area_vectors()) {
            size[plane as usize][0] += vector.length();
        }
        for edge in 0..edges.len() {
            let Some(pair) = self.meeting(edges, is_sharp, edge) else { continue };
            let [a, b] = edges.ends(edge).map(|end| mesh.vertices()[end as usize]);
            pair.iter().for_each(|&plane| size[plane as usize][1] += a.distance(b));
        }
        let width: Vec<f64> = size.iter().map(|[area, length]| 2.0 * area / length).collect();
        let mut is_flat = vec![false; self.count];
        for [p, q] in (0..edges.len()).filter_map(|edge| self.meeting(edges, is_sharp, edge)) {
            for (own, other) in [(p, q), (q, p)] {
                is_flat[own as usize] |= width[own as usize] > WIDER * width[other as usize];
            }
        }
        self.of_face.iter().map(|&plane| is_flat[plane as usize]).collect()
    }
}

/// The connected part of each face, where parts end at the edges in `is_limit`.
pub(super) fn flood(count: usize, edges: &Edges, is_limit: &[bool]) -> Vec<u32> {
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

/// The two other corners of a face: the one after `vertex`, then the one before it.
fn sides_at(face: [u32; 3], vertex: u32) -> [u32; 2] {
    let k = face.iter().position(|&corner| corner == vertex).unwrap_or(0);
    [face[(k + 1) % 3], face[(k + 2) % 3]]
}

/// The faces around a vertex in counter-clockwise order, each with the edge to the next one; none
/// if they do not close to one ring.
fn ring(faces: &[[u32; 3]], edges: &Edges, vertex: u32, first: u32) -> Option<Vec<(u32, u32)>> {
    /// A vertex with more faces is unlikely to be a corner.
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
