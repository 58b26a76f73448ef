//! Takes a mesh apart whose closed pieces may intersect or touch each other: each becomes a field
//! by itself, and the mesh is their union.

use super::edges::Edges;
use super::mesh::volume;
use super::patches::flood;
use super::tree::Tree;
use super::{Function, MeshError, MeshField, MeshKind, MeshOptions, MeshSolid, TriangleMesh};
use crate::field::union;
use crate::math::{Bounds, NONE};
use glam::DVec3;

/// Largest number of bodies that are united: evaluating their union at a point evaluates every body
/// there.
const MOST: usize = 32;

impl MeshSolid {
    /// The closed pieces as solids of their own, each with the cavities in it; none if their boxes
    /// are apart, if there are too many, or if a piece is open.
    pub(super) async fn bodies(&self) -> Option<Vec<Self>> {
        let (mesh, edges) = (&*self.mesh, &*self.edges);
        let is_limit: Vec<bool> = (0..edges.len()).map(|edge| edges.sides(edge).len() != 2).collect();
        let of_face = flood(mesh.faces().len(), edges, &is_limit);
        let count = of_face.iter().max().map_or(0, |&last| last as usize + 1);
        let mut pieces: Vec<Vec<[u32; 3]>> = vec![Vec::new(); count];
        for (face, &piece) in mesh.faces().iter().zip(&of_face) {
            pieces[piece as usize].push(*face);
        }
        let volumes: Vec<f64> = pieces.iter().map(|faces| volume(mesh.vertices(), faces.iter())).collect();
        let outer: Vec<usize> = (0..count).filter(|&piece| volumes[piece] > 0.0).collect();
        let boxes: Vec<Bounds> = outer
            .iter()
            .map(|&piece| Bounds::around(pieces[piece].iter().flat_map(|face| mesh.corners(face))))
            .collect();
        let are_apart =
            boxes.iter().enumerate().all(|(k, own)| boxes[..k].iter().all(|other| own.is_apart_from(other)));
        let is_closed = |faces: &Vec<[u32; 3]>| Edges::new(faces).count(|sides| sides != 2) == 0;
        if are_apart || outer.len() > MOST || !pieces.iter().all(is_closed) {
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
