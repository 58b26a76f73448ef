//! Triangulation of any set of points with normals to one oriented manifold, closed or with border.
//!
//! 1. *Stars.* The natural neighbours of every point are found in its tangent plane, among the points of the same sheet.
//! 2. *Agreement.* A triangle on which the stars of its three corners agree is kept. Every directed edge then belongs to one
//!    triangle at most, and every triangle faces as its corners do.
//! 3. *Disputes.* Four points near a circle may each prefer another diagonal, since each sees the others in its own tangent
//!    plane. Triangles that fewer corners see are added where there is room.
//! 4. *Holes.* The borders of what is left are traced, and the polygons with few edges are cut into triangles. Where that fails, a
//!    vertex is taken out, which makes the hole larger and its border simpler.
//! 5. *Points left out* go into the triangle below them.
//! 6. *Borders* are freed of vertices where the surface touches itself.
//!
//! The stars are those of Gopi, Krishnan and Silva, "Surface Reconstruction based on Lower Dimensional Localized Delaunay
//! Triangulation", Computer Graphics Forum 19(3), 2000; holes are cut by the dynamic programme of Klincsek, "Minimal
//! Triangulations of Polygonal Domains", Annals of Discrete Mathematics 9, 1980.

mod ball;
mod holes;
mod insert;
mod patch;
mod settle;
mod stars;

use crate::math::Bounds;
use crate::slices::{self, pause, ranges};
use crate::spatial::tree::Tree;
use crate::topology::Topology;
use glam::Vec3;
use holes::Borders;
use patch::Patch;
use stars::Stars;

/// Points that are looked at in one slice of work, where that takes some 10 ns each.
const SLICE: usize = 2048;

/// Options of the triangulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshOptions<'a> {
    /// Largest number of edges of a hole that is filled. A longer loop is taken for a border of the surface.
    pub largest_hole: usize,
    /// The box that cuts the surface: loops along its faces are borders, however short. Without it a small one may be
    /// filled.
    pub bounds: Option<&'a Bounds>,
}

impl Default for MeshOptions<'_> {
    fn default() -> Self {
        Self { largest_hole: 24, bounds: None }
    }
}

/// Triangles over points, with their topology and the points and borders that are left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangulation {
    /// Triples of the indices of points, counter-clockwise round their normals. They form an oriented manifold: every edge
    /// has one triangle or two, every vertex one fan.
    pub triangles: Vec<[u32; 3]>,
    /// Components, borders and Euler numbers, counted anew on the triangles.
    pub topology: Topology,
    /// Borders of at most [`MeshOptions::largest_hole`] edges that are not at the box: places where no manifold could be had.
    /// Each starts at its smallest vertex and has the mesh on its left.
    pub unfilled: Vec<Vec<u32>>,
    /// Points in no triangle, in ascending order: those without a finite position or a normal, those at the place of another
    /// one, lone ones, and those that would spoil the manifold.
    pub left_out: Vec<u32>,
    /// Number of triangles on which the stars of all three corners agreed.
    pub agreed: usize,
    /// Number of rounds in which holes were filled.
    pub rounds: u32,
}

impl Triangulation {
    /// The triangulation that consists of `triangles` over `point_count` points, in slices of work. They must be an oriented manifold whose
    /// borders are borders of the surface.
    pub(crate) async fn known(triangles: Vec<[u32; 3]>, point_count: usize) -> Self {
        let topology = Topology::in_slices(&triangles, point_count).await;
        let mut is_met = vec![false; point_count];
        triangles.iter().flatten().for_each(|&v| is_met[v as usize] = true);
        pause().await;
        let left_out = (0..point_count as u32).filter(|&v| !is_met[v as usize]).collect();
        let agreed = triangles.len();
        Self { triangles, topology, left_out, agreed, ..Self::default() }
    }
}

/// Joins points with outward normals to triangles.
///
/// `normal` is as long as `position`; its vectors need not have unit length. The points should be dense enough that the normals
/// of neighbours are well within 90° of each other and sheets are farther apart than neighbours; where they are not,
/// holes remain and are listed. Cost: linear, below a microsecond per point natively. Any input is met without a panic, and the work is
/// bounded. The result depends on the points alone and has the same bits natively and in WebAssembly.
///
/// # Panics
///
/// If the slices differ in length, or there are 2³¹ points or more.
#[must_use]
pub fn triangulate(position: &[Vec3], normal: &[Vec3], options: &MeshOptions) -> Triangulation {
    slices::complete(in_slices(position, normal, options))
}

/// [`triangulate`] in slices of work. The last few look at all points and triangles, for some 50 ns each.
pub(crate) async fn in_slices(
    position: &[Vec3],
    normal: &[Vec3],
    options: &MeshOptions<'_>,
) -> Triangulation {
    assert_eq!(position.len(), normal.len(), "every point has a normal");
    assert!(position.len() < 1 << 31, "indices of points have 31 bits");
    let is_usable = |i: usize| position[i].is_finite() && normal[i].try_normalize().is_some();
    let mut usable: Vec<bool> = (0..position.len()).map(is_usable).collect();
    loop {
        let points = JoinablePoints::new(position, normal, &usable).await;
        let stars = Stars::new(&points.tree, &points.normal).await;
        if stars.twins.is_empty() {
            return points.triangulate(&stars, position.len(), options).await;
        }
        // They would be neighbours of everything that the first one is a neighbour of.
        for &twin in &stars.twins {
            usable[points.tree.origin[twin as usize] as usize] = false;
        }
    }
}

/// The points that can be joined, in tree order.
struct JoinablePoints {
    tree: Tree,
    /// Unit normals.
    normal: Vec<Vec3>,
}

impl JoinablePoints {
    async fn new(position: &[Vec3], normal: &[Vec3], usable: &[bool]) -> Self {
        let points: Vec<(Vec3, u32)> =
            position.iter().copied().zip(0..).filter(|&(_, i)| usable[i as usize]).collect();
        let tree = Tree::in_slices(points).await;
        let normal = tree.origin.iter().map(|&i| normal[i as usize].normalize_or_zero()).collect();
        Self { tree, normal }
    }

    async fn triangulate(
        &self,
        stars: &Stars,
        point_count: usize,
        options: &MeshOptions<'_>,
    ) -> Triangulation {
        let mut patch = Patch::new(&self.tree.position, &self.normal, stars).await;
        let agreed = patch.len();
        let borders = Borders { largest_hole: options.largest_hole, bounds: options.bounds };
        settle::settle(&mut patch).await;
        let rounds = holes::fill(&mut patch, &borders).await;
        let mut keys = Vec::new();
        for range in ranges(self.tree.len(), SLICE) {
            for v in range.start as u32..range.end as u32 {
                if patch.around(v).next().is_none() {
                    insert::insert(&mut patch, &self.tree, v, &mut keys);
                    pause().await;
                }
            }
            pause().await;
        }
        holes::unpinch(&mut patch);
        pause().await;

        let origin = &self.tree.origin;
        let triangles: Vec<[u32; 3]> =
            patch.triangles().map(|triangle| triangle.map(|v| origin[v as usize])).collect();
        pause().await;
        let topology = Topology::in_slices(&triangles, point_count).await;
        pause().await;
        let mut place = vec![u32::MAX; point_count];
        for (k, &i) in origin.iter().enumerate() {
            place[i as usize] = k as u32;
        }
        pause().await;
        let unfilled = topology.borders.iter().filter(|border| {
            let hole: Vec<u32> = border.iter().map(|&v| place[v as usize]).collect();
            !borders.is_border(&patch, &hole) && !holes::is_open(&patch, &hole)
        });
        let unfilled = unfilled.cloned().collect();
        pause().await;
        let is_left_out =
            |&i: &u32| place[i as usize] == u32::MAX || patch.around(place[i as usize]).next().is_none();
        let left_out = (0..point_count as u32).filter(is_left_out).collect();
        Triangulation { triangles, topology, unfilled, left_out, agreed, rounds }
    }
}
