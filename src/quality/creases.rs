//! The rows of particles on creases: which are on one patch, and which belong to one particle.

use crate::field::Evaluator;
use crate::math::{NONE, sort_pairs, unkey};
use crate::particles::Particles;
use crate::spatial::tree::Tree;
use core::ops::Range;
use glam::{DVec3, Vec3};

/// The patches of the points, in tree order; all columns are empty on a surface without creases.
#[derive(Debug, Default)]
pub(super) struct CreaseRows {
    patch: Vec<u32>,
    /// The first row of the particle of each point, as given.
    particle: Vec<u32>,
    /// Index of the point with the first row of the mesh vertex (one vertex for each particle, one
    /// for each nappe at a tip); the point itself if that one was left out.
    first: Vec<u32>,
    /// Whether each point is at a tip.
    is_tip: Vec<bool>,
    /// Whether each point is on the rim of the surface, where it ends at a limit.
    is_rim: Vec<bool>,
    /// Particle and patch of each row on a crease, sorted.
    on_creases: Vec<(u32, u32)>,
    /// Edges of the triangles between points on creases, the lower point first. Sorted.
    edges: Vec<[u32; 2]>,
}

impl CreaseRows {
    pub(super) fn new(tree: &Tree, rows: Option<&Particles>) -> Self {
        let Some(rows) = rows.filter(|rows| !rows.patch.is_empty()) else { return Self::default() };
        let particle = |row: u32| rows.first_row(row as usize) as u32;
        let joints = rows.joints();
        let vertex = |row: u32| joints.get(row as usize).copied().unwrap_or(row);
        let mut place = vec![NONE; rows.patch.len()];
        for (k, &row) in (0..).zip(&tree.origin) {
            place[row as usize] = k;
        }
        let first = |(k, &row): (u32, &u32)| match place[vertex(row) as usize] {
            NONE => k,
            first => first,
        };
        let mut on_creases: Vec<(u32, u32)> =
            rows.twins.iter().copied().zip(rows.patch.iter().copied()).collect();
        sort_pairs(&mut on_creases);
        let tips = rows.tips();
        let on_rim = rows.on_rim();
        Self {
            is_rim: tree.origin.iter().map(|&row| on_rim.contains(&particle(row))).collect(),
            is_tip: tree.origin.iter().map(|row| tips.binary_search(row).is_ok()).collect(),
            patch: tree.origin.iter().map(|&row| rows.patch[row as usize]).collect(),
            particle: tree.origin.iter().map(|&row| particle(row)).collect(),
            first: (0..).zip(&tree.origin).map(first).collect(),
            on_creases,
            edges: Vec::new(),
        }
    }

    /// Whether the surface ends at point `i`, on a limit.
    pub(super) fn is_rim(&self, i: usize) -> bool {
        self.is_rim.get(i).copied().unwrap_or(false)
    }

    /// Whether the surface ends on a limit anywhere.
    pub(super) fn has_rim(&self) -> bool {
        self.is_rim.contains(&true)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.patch.is_empty()
    }

    /// The particle of point `i`: the first of its rows, as given.
    pub(super) fn particle(&self, tree: &Tree, i: usize) -> u32 {
        self.particle.get(i).copied().unwrap_or(tree.origin[i])
    }

    /// The point that represents the vertex of point `i`.
    pub(super) fn first(&self, i: usize) -> usize {
        self.first.get(i).map_or(i, |&first| first as usize)
    }

    /// Whether point `i` represents its vertex.
    pub(super) fn is_first(&self, i: usize) -> bool {
        self.first(i) == i
    }

    /// Number of points that another one represents.
    pub(super) fn further(&self) -> usize {
        (0..self.first.len()).filter(|&i| !self.is_first(i)).count()
    }

    /// Whether two points are the same particle, which has one row on each patch that it borders.
    pub(super) fn are_one(&self, i: usize, j: usize) -> bool {
        !self.is_empty() && self.particle[i] == self.particle[j]
    }

    /// Squared distance from point `i` to the nearest other particle, and a row of that particle;
    /// infinite and [`NONE`] if there is none.
    pub(super) fn nearest(&self, tree: &Tree, i: usize) -> (f32, u32) {
        if self.is_empty() {
            return tree.nearest(tree.position[i], i as u32, f32::INFINITY);
        }
        let mut keys = Vec::new();
        tree.nearest_many(tree.position[i], 1, |j| !self.are_one(i, j as usize), &mut keys);
        keys.first().map_or((f32::INFINITY, NONE), |&key| unkey(key))
    }

    /// Distance from point `i` to the nearest other particle, given the distance `of_patch` to the
    /// nearest one on its own patch.
    pub(super) fn nearest_within(&self, tree: &Tree, i: usize, of_patch: f32) -> f32 {
        if self.is_empty() {
            return of_patch;
        }
        if of_patch.is_infinite() {
            return self.nearest(tree, i).0.sqrt();
        }
        let (p, mut near) = (tree.position[i], Vec::new());
        tree.within_box(p - of_patch, p + of_patch, &mut near);
        let others = near.into_iter().filter(|&j| !self.are_one(i, j as usize));
        others.map(|j| tree.position[j as usize].distance(p)).fold(of_patch, f32::min)
    }

    /// Whether point `i` is at a tip, where f has no gradient and the sheet is a cone.
    pub(super) fn is_tip(&self, i: usize) -> bool {
        self.is_tip.get(i) == Some(&true)
    }

    /// Whether two points are on one patch.
    pub(super) fn is_one_patch(&self, i: usize, j: usize) -> bool {
        self.is_empty() || self.patch[i] == self.patch[j]
    }

    /// Whether point `i` lies on a crease.
    pub(super) fn holds(&self, i: usize) -> bool {
        !self.is_empty() && !self.patches_of(self.particle[i]).is_empty()
    }

    /// The patches of a particle on a crease.
    fn patches_of(&self, particle: u32) -> &[(u32, u32)] {
        let start = self.on_creases.partition_point(|&(other, _)| other < particle);
        let end = self.on_creases.partition_point(|&(other, _)| other <= particle);
        &self.on_creases[start..end]
    }

    /// Takes the edges between points on creases from the triangles.
    pub(super) fn find_edges(&mut self, mesh: &[[u32; 3]]) {
        let edges = mesh.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let mut edges: Vec<[u32; 2]> = edges
            .filter(|edge| edge.iter().all(|&i| self.holds(i as usize)))
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        sort_pairs(&mut edges);
        self.edges = edges;
    }

    /// Whether natural neighbours i < j are neighbours on the surface. Between points on creases
    /// there may be a hole of their patch.
    pub(super) fn are_joined(&self, i: usize, j: usize) -> bool {
        !(self.holds(i) && self.holds(j)) || self.edges.binary_search(&[i as u32, j as u32]).is_ok()
    }

    /// Whether the patch of two points is the first one that their particles share: successive
    /// particles along a crease are neighbours on each of its patches.
    pub(super) fn is_first_pair(&self, i: usize, j: usize) -> bool {
        if self.is_empty() {
            return true;
        }
        let (of_i, of_j) = (self.patches_of(self.particle[i]), self.patches_of(self.particle[j]));
        let is_common = |patch: u32| of_j.iter().any(|&(_, other)| other == patch);
        of_i.iter()
            .map(|&(_, patch)| patch)
            .find(|&patch| is_common(patch))
            .is_none_or(|patch| patch == self.patch[i])
    }

    /// f and ∇f at the points of a range, each on its own patch.
    pub(super) fn exact_gradients(
        &self,
        field: &mut dyn Evaluator,
        range: Range<usize>,
        position: &[Vec3],
        value: &mut [f64],
        gradient: &mut [DVec3],
    ) {
        let Some(patch) = self.patch.get(range) else {
            field.exact_gradients(position, value, gradient);
            return;
        };
        let mut done = 0;
        while done < position.len() {
            // Near points are on few patches, in long runs of the same patch.
            let run = patch[done..].iter().take_while(|&&other| other == patch[done]).count();
            let end = done + run;
            field.on(Some(patch[done])).exact_gradients(
                &position[done..end],
                &mut value[done..end],
                &mut gradient[done..end],
            );
            done = end;
        }
    }

    /// The evaluator of the patch of point `i`.
    pub(super) fn on<'e>(&self, field: &'e mut dyn Evaluator, i: usize) -> &'e mut dyn Evaluator {
        field.on(self.patch.get(i).copied())
    }

    /// Whether a place is on the patch of point `i`, not beyond its creases.
    pub(super) fn reaches(&self, field: &mut dyn Evaluator, i: usize, p: Vec3) -> bool {
        self.patch.get(i).is_none_or(|&patch| field.label(p.as_dvec3()) == patch)
    }

    /// The particles with the positions of the points and these normals. Rows that were left out
    /// have no position.
    pub(super) fn placed(&self, tree: &Tree, normal: &[Vec3], rows: &Particles) -> Particles {
        let count = rows.patch.len();
        let (mut local, mut normals) = (vec![Vec3::NAN; count], vec![Vec3::ZERO; count]);
        for (k, &row) in tree.origin.iter().enumerate() {
            (local[row as usize], normals[row as usize]) = (tree.position[k], normal[k]);
        }
        Particles { local, normal: normals, ..rows.clone() }
    }
}
