//! Takes a mesh apart whose closed pieces may intersect or touch each other: each becomes a field
//! by itself, and the mesh is their union.

use super::edges::ends_of;
use super::mesh::volume;
use super::patches::flood;
use super::tree::Tree;
use super::{Function, MeshError, MeshField, MeshKind, MeshOptions, MeshSolid, TriangleMesh};
use crate::field::union;
use crate::math::{Bounds, Forest, NONE, key_of, sort_by_key};
use core::f64::consts::PI;
use glam::DVec3;

/// Largest number of bodies that are united: evaluating their union at a point evaluates every body
/// there.
const MOST: usize = 32;

impl MeshSolid {
    /// The closed pieces as solids of their own, each with the cavities in it; none if their boxes
    /// are apart, if there are too many, or if a piece is open.
    pub(super) async fn bodies(&self) -> Option<Vec<Self>> {
        let mesh = &*self.mesh;
        let pieces = self.closed_pieces()?;
        let count = pieces.len();
        let volumes: Vec<f64> = pieces.iter().map(|faces| volume(mesh.vertices(), faces.iter())).collect();
        let outer: Vec<usize> = (0..count).filter(|&piece| volumes[piece] > 0.0).collect();
        let boxes: Vec<Bounds> = outer
            .iter()
            .map(|&piece| Bounds::around(pieces[piece].iter().flat_map(|face| mesh.corners(face))))
            .collect();
        let are_apart =
            boxes.iter().enumerate().all(|(k, own)| boxes[..k].iter().all(|other| own.is_apart_from(other)));
        if are_apart || outer.len() > MOST {
            return None;
        }
        let corners = |piece: usize| -> Vec<[DVec3; 3]> {
            pieces[piece].iter().map(|face| mesh.corners(face)).collect()
        };
        let trees: Vec<Tree> = outer.iter().map(|&piece| Tree::new(&corners(piece))).collect();
        let mut own: Vec<Vec<[u32; 3]>> = outer.iter().map(|&piece| pieces[piece].clone()).collect();
        for cavity in (0..count).filter(|&piece| volumes[piece] <= 0.0) {
            let p = mesh.vertices()[pieces[cavity][0][0] as usize];
            let around = (0..outer.len())
                .filter(|&k| volumes[outer[k]] > -volumes[cavity] && trees[k].winding(p) > 0.5)
                .min_by(|&a, &b| volumes[outer[a]].total_cmp(&volumes[outer[b]]));
            own[around?].extend(&pieces[cavity]);
        }
        let mut bodies = Vec::with_capacity(own.len());
        for faces in own {
            let (body, marks) = (self.part_of(faces), self.marks());
            bodies.push(body.mended().await.ok()?.with_edges_along(&marks));
        }
        Some(bodies)
    }

    /// The faces of each closed piece; none if a piece is open. Where more than two faces share an
    /// edge, those go on into each other that enclose a part of the inside.
    fn closed_pieces(&self) -> Option<Vec<Vec<[u32; 3]>>> {
        let (mesh, edges) = (&*self.mesh, &*self.edges);
        let is_limit: Vec<bool> = (0..edges.len()).map(|edge| edges.sides(edge).len() != 2).collect();
        let part_of = flood(mesh.faces().len(), edges, &is_limit);
        let count = part_of.iter().max().map_or(0, |&last| last as usize + 1);
        let mut forest = Forest::new(count);
        for edge in (0..edges.len()).filter(|&edge| is_limit[edge]) {
            for [opening, closing] in self.around(edge, &part_of)? {
                forest.join(opening, closing);
            }
        }
        let roots: Vec<u32> = part_of.iter().map(|&part| forest.find(part)).collect();
        let mut pieces: Vec<Vec<[u32; 3]>> = vec![Vec::new(); count];
        for (face, &root) in mesh.faces().iter().zip(&roots) {
            pieces[root as usize].push(*face);
        }
        pieces.retain(|faces| !faces.is_empty());
        Some(pieces)
    }

    /// Pairs of parts that belong to one body, at an edge where more than two faces meet: going
    /// around the edge, the inside lies between a face of the one part and a face of the other.
    /// None if the faces do not alternate so. A part with two faces there needs no other one.
    fn around(&self, edge: usize, part_of: &[u32]) -> Option<Vec<[u32; 2]>> {
        /// Largest angle in radians between faces that two bodies share.
        const SHARED: f64 = 1e-4;
        #[derive(Clone, Copy)]
        struct Own {
            part: u32,
            /// Whether the inside ends at the face, in the direction in which angles grow.
            closes: bool,
            way: DVec3,
            angle: f64,
        }
        let (mesh, edges) = (&*self.mesh, &*self.edges);
        let [from, to] = edges.ends(edge).map(|end| mesh.vertices()[end as usize]);
        let axis = (to - from).normalize_or_zero();
        let mut own: Vec<Own> = Vec::new();
        for side in edges.sides(edge) {
            let corners = mesh.faces()[side.face as usize];
            let third = mesh.vertices()[corners[(side.side as usize + 2) % 3] as usize];
            own.push(Own {
                part: part_of[side.face as usize],
                closes: ends_of(&corners, side.side) == edges.ends(edge),
                way: (third - from).reject_from_normalized(axis),
                angle: 0.0,
            });
        }
        sort_by_key(&mut own, |face| u64::from(face.part));
        let is_pair = |faces: &[Own]| matches!(faces, [a, b] if a.closes != b.closes);
        let mut rest: Vec<Own> = own
            .chunk_by(|a, b| a.part == b.part)
            .filter(|faces| !is_pair(faces))
            .flatten()
            .copied()
            .collect();
        let Some(first) = rest.first().map(|face| face.way) else { return Some(Vec::new()) };
        for face in &mut rest {
            face.angle = libm::atan2(face.way.dot(axis.cross(first)), face.way.dot(first));
            if face.angle < -0.5 * SHARED {
                face.angle += 2.0 * PI;
            }
        }
        sort_by_key(&mut rest, |face| key_of(face.angle));
        // Where two bodies share a face, one ends there and the other one begins.
        for shared in rest.chunk_by_mut(|a, b| b.angle - a.angle < SHARED) {
            sort_by_key(shared, |face| u64::from(!face.closes));
        }
        let opening = rest.iter().position(|face| !face.closes)?;
        rest.rotate_left(opening);
        let pair = |pair: &[Own]| match pair {
            [a, b] if !a.closes && b.closes => Some([a.part, b.part]),
            _ => None,
        };
        rest.chunks(2).map(pair).collect()
    }

    /// These faces as a mesh of their own, in the coordinates of the given mesh.
    fn part_of(&self, mut faces: Vec<[u32; 3]>) -> TriangleMesh {
        let mut number = vec![NONE; self.mesh.vertices().len()];
        let mut vertices = Vec::new();
        for corner in faces.as_flattened_mut() {
            let own = &mut number[*corner as usize];
            if *own == NONE {
                *own = vertices.len() as u32;
                vertices.push(self.origin + self.mesh.vertices()[*corner as usize]);
            }
            *corner = *own;
        }
        TriangleMesh::of_parts(vertices, faces)
    }

    /// The field of the union of these bodies of the mesh.
    pub(super) async fn united(
        self,
        bodies: Vec<Self>,
        options: MeshOptions,
    ) -> Result<MeshField, MeshError> {
        let mut fields = Vec::with_capacity(bodies.len());
        for body in bodies {
            fields.push(Box::pin(body.into_field(options)).await?);
        }
        let edges = fields.iter().map(|body| match body.kind() {
            MeshKind::Parts { edges, .. } => edges,
            _ => 0,
        });
        let kind = MeshKind::Union { bodies: fields.len(), edges: edges.sum() };
        let function = Function::Union { united: union(fields.clone()), bodies: fields };
        Ok(MeshField { solid: self, kind, function })
    }
}
