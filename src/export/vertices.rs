//! The vertices of a mesh in a file, and the triangles over them.

use crate::mesh::triangulation::Triangulation;
use crate::particles::Particles;
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// How particles become vertices of a mesh file. The choices differ on sharp edges, where a
/// particle has a normal for each side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Vertices {
    /// One vertex per particle, so that the mesh is closed where the surface is. On a sharp edge it
    /// has the mean of the sides' normals.
    #[default]
    Joined,
    /// On a sharp edge a vertex for each side, with its normal. In OBJ the points stay joined, and
    /// faces refer to normals separately.
    Split,
    /// A vertex for each row of the particles, also on smooth joins, in their order, with all
    /// columns if the format is PLY.
    Columns,
}

/// A way to write vertices, as an interface shows it.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct VerticesChoice {
    /// The way.
    pub value: Vertices,
    /// Name for a person.
    pub label: &'static str,
    /// Explanation in one line.
    pub help: &'static str,
    /// Extensions of the formats in which it makes a difference.
    pub formats: &'static [&'static str],
}

/// The ways to write vertices, the default first.
pub const VERTICES: &[VerticesChoice] = &[
    VerticesChoice {
        value: Vertices::Joined,
        label: "Joined",
        help: "One vertex for each particle: programs find a closed surface closed. On sharp edges the normals are the means of those of \
               the sides, so that viewers blur the shading there.",
        formats: &["glb", "obj", "ply"],
    },
    VerticesChoice {
        value: Vertices::Split,
        label: "Split at sharp edges",
        help: "On sharp edges a vertex for each side, with the normal of that side: viewers shade the edges sharply, and programs find the \
               mesh open along them. In OBJ the points stay joined and the normals are apart, which some programs split when they read it.",
        formats: &["glb", "obj", "ply"],
    },
    VerticesChoice {
        value: Vertices::Columns,
        label: "All columns",
        help: "A vertex for each row of the particles, split wherever patches meet, with all their columns: radius, level, parent and more. \
               Some programs read no PLY mesh with whole numbers in it.",
        formats: &["ply"],
    },
];

impl Vertices {
    /// The word for the way in interfaces.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Joined => "joined",
            Self::Split => "split",
            Self::Columns => "columns",
        }
    }
}

/// A mesh as lists of vertices and triangles, as in files: closed parts and their normals face
/// outward.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshBuffers {
    /// Position of each vertex, in the coordinates of the formula.
    pub positions: Vec<DVec3>,
    /// Unit normal of each vertex.
    pub normals: Vec<Vec3>,
    /// Triples of vertices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// For each vertex, its row among the particles, which leads to the other columns.
    pub rows: Vec<u32>,
}

impl MeshBuffers {
    /// The mesh over the rows of `particles`. Vertices are in the order of rows; except for
    /// [`Vertices::Columns`], those in no triangle are left out.
    ///
    /// # Panics
    ///
    /// If the mesh is not one of these particles.
    #[must_use]
    pub fn new(mesh: &Triangulation, particles: &Particles, vertices: Vertices) -> Self {
        let outward = outward_normals(mesh, particles);
        let Indexed { rows, normals, triangles } =
            Indexed::new(mesh, particles, outward.as_ref().unwrap_or(&particles.normal), vertices);
        let positions = rows.iter().map(|&row| particles.place(row as usize)).collect();
        Self { positions, normals, triangles, rows }
    }
}

/// The normals of all rows, reversed on reversed triangles; none if no triangle was reversed.
pub(super) fn outward_normals(mesh: &Triangulation, particles: &Particles) -> Option<Vec<Vec3>> {
    let turned: Vec<usize> = (0..mesh.triangles.len()).filter(|&k| mesh.is_turned(k)).collect();
    if turned.is_empty() {
        return None;
    }
    let mut normals = particles.normal.clone();
    for &row in turned.iter().flat_map(|&k| &mesh.corners()[k]) {
        normals[row as usize] = -particles.normal[row as usize];
    }
    Some(normals)
}

/// The vertices of a mesh by their rows, with their normals, and the triangles over them.
#[derive(Default)]
pub(super) struct Indexed {
    pub(super) rows: Vec<u32>,
    pub(super) normals: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Indexed {
    /// The vertices of a mesh with outward `normals` of all rows.
    pub(super) fn new(
        mesh: &Triangulation,
        particles: &Particles,
        normals: &[Vec3],
        vertices: Vertices,
    ) -> Self {
        let by_rows = (0..mesh.triangles.len()).map(|k| mesh.outward_corners(k));
        match vertices {
            Vertices::Columns => Self {
                rows: (0..particles.len() as u32).collect(),
                normals: normals.to_vec(),
                triangles: by_rows.collect(),
            },
            Vertices::Split => {
                let smooth = particles.smooth_rows();
                let vertex = |row: u32| smooth.get(row as usize).copied().unwrap_or(row);
                Self::over(by_rows.map(|corners| corners.map(vertex)).collect(), normals)
            }
            Vertices::Joined => {
                let mut joined = Self::over(mesh.triangles.clone(), normals);
                if mesh.has_corners() {
                    joined.normals = joined.mean_normals(by_rows, normals);
                }
                joined
            }
        }
    }

    /// The vertices of triangles over rows, renumbered.
    fn over(mut triangles: Vec<[u32; 3]>, normals: &[Vec3]) -> Self {
        let mut number = vec![0; normals.len()];
        triangles.iter().flatten().for_each(|&row| number[row as usize] = 1);
        let rows: Vec<u32> =
            (0..).zip(&number).filter(|&(_, &is_met)| is_met == 1).map(|(row, _)| row).collect();
        (0..).zip(&rows).for_each(|(vertex, &row)| number[row as usize] = vertex);
        triangles.iter_mut().flatten().for_each(|row| *row = number[*row as usize]);
        let normals = rows.iter().map(|&row| normals[row as usize]).collect();
        Self { rows, normals, triangles }
    }

    /// The mean normal of each vertex, over the distinct rows at its corners.
    fn mean_normals(&self, corners: impl Iterator<Item = [u32; 3]>, normals: &[Vec3]) -> Vec<Vec3> {
        let mut sums = vec![(Vec3::ZERO, 0_u32); self.rows.len()];
        let mut is_met = vec![false; normals.len()];
        for (triangle, corners) in self.triangles.iter().zip(corners) {
            for (&vertex, row) in triangle.iter().zip(corners) {
                if !core::mem::replace(&mut is_met[row as usize], true) {
                    let (sum, count) = &mut sums[vertex as usize];
                    (*sum, *count) = (*sum + normals[row as usize], *count + 1);
                }
            }
        }
        // A single normal keeps its bits; for opposite ones, at the edge of a blade, the first
        // row's is taken.
        let mean = |(&own, (sum, count)): (&Vec3, (Vec3, u32))| {
            if count < 2 { sum } else { sum.try_normalize().unwrap_or(own) }
        };
        self.normals.iter().zip(sums).map(mean).collect()
    }
}
