//! Triangulation of any set of points with normals to one oriented manifold, closed or with border.
//!
//! 1. *Stars.* The natural neighbours of every point are found in its tangent plane, among the
//!    points of the same sheet.
//! 2. *Agreement.* A triangle on which the stars of its three corners agree is kept. Every directed
//!    edge then belongs to at most one triangle, and every triangle faces as its corners do.
//! 3. *Disputes.* Four points near a circle may each prefer another diagonal, since each sees the
//!    others in its own tangent plane. Triangles that fewer corners see are added if there is room.
//! 4. *Rim.* If it is known where the surface ends, triangles across those edges and beyond them
//!    are removed. So the patches of a surface with creases are joined one by one, and together are
//!    closed.
//! 5. *Holes.* The borders of the triangles are traced, and the polygons with few edges are divided
//!    into triangles. If that fails, a vertex is removed, which makes the hole larger and its
//!    border simpler. If the field is known, it then decides which of the fills are surface
//!    (`Triangulation::judged`).
//! 6. *Points left out* are inserted into the triangle below them.
//! 7. *Borders* lose vertices at which the surface touches itself.
//! 8. *Cracks* between patches are filled once all patches are joined.
//!
//! The stars are those of Gopi, Krishnan and Silva, "Surface Reconstruction based on Lower
//! Dimensional Localized Delaunay Triangulation", Computer Graphics Forum 19(3), 2000; holes are
//! divided by the dynamic programme of Klincsek, "Minimal Triangulations of Polygonal Domains",
//! Annals of Discrete Mathematics 9, 1980.

mod cracks;
mod creases;
mod holes;
mod insert;
mod patch;
mod rim;
mod settle;

use super::facing::{Facing, Inside, facing};
use super::stars::{ByDirection, Sheet, Sheets};
use crate::math::{Bounds, sort_pairs};
use crate::particles::Particles;
use crate::slices::{self, LIGHT, pause, ranges};
use crate::topology::{Topology, separate_fans};
use glam::DVec3;
pub(crate) use holes::Middle;
use holes::{Borders, Fill};
use patch::Patch;
use rim::Rim;

/// Triangles over points, with their topology, and the points and borders that remain.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangulation {
    /// Triples of particles, each by its first row, so that particles on creases are vertices that
    /// the patches share; at the tip of a cone each sheet has its own vertex, and where bodies
    /// touch in a point each body has one. They form an oriented manifold: every edge has one or
    /// two triangles, every vertex one fan. Closed parts face outward, even if f is larger inside;
    /// others are counter-clockwise round their normals, or face outward like all of a bounded
    /// surface whose field knows that it is bounded. [`Self::corners`] has the same triangles by
    /// rows.
    pub triangles: Vec<[u32; 3]>,
    /// Components, borders and Euler numbers, counted on these triangles.
    pub topology: Topology,
    /// Short borders that are not at the box: places where no manifold was possible. The surface
    /// ends at longer ones. Each starts at its smallest vertex and has the mesh on its left.
    pub unfilled: Vec<Vec<u32>>,
    /// Points in no triangle, in ascending order: those without a finite position or a normal,
    /// those at the place of another one, lone ones, and those that would spoil the manifold.
    pub left_out: Vec<u32>,
    /// Sign of f inside the closed parts; none if there is no closed part.
    pub inside: Option<Inside>,
    /// The triangles by rows, round the normals; empty if they equal `triangles`.
    pub(crate) corners: Vec<[u32; 3]>,
    /// For each vertex, whether the triangles around it were turned to face outward; empty if none
    /// were.
    pub(crate) turned: Vec<bool>,
    /// The holes that were filled, by rows.
    pub(crate) filled: Vec<Fill>,
    /// The component that is the outer wall of each component's body; empty if none has a hollow.
    pub(crate) body_of: Vec<u32>,
}

impl Triangulation {
    /// The triangulation by these `triangles` over the rows of particles, in slices of work. They
    /// must be an oriented manifold whose borders are borders of the surface.
    pub(crate) async fn known(mut triangles: Vec<[u32; 3]>, particles: &Particles) -> Self {
        creases::separate(&mut triangles, particles);
        Joined { triangles, ..Joined::default() }.counted(particles).await
    }

    /// The triangulation without fills over places that have no surface according to `has_surface`,
    /// which judges the largest triangle of each fill; the mesh is open there. If particles end at
    /// an unknown edge, as where two balls meet, they leave a loop that looks like a hole, and a
    /// disc in it would close either ball.
    pub(crate) async fn judged(
        self,
        particles: &Particles,
        mut has_surface: impl FnMut(Middle) -> bool,
    ) -> Self {
        let (filled, none): (Vec<Fill>, Vec<Fill>) =
            self.filled.iter().cloned().partition(|fill| has_surface(fill.middle(particles)));
        if none.is_empty() {
            return self;
        }
        let mut unfilled = self.unfilled.clone();
        let mut gone: Vec<[u32; 3]> = none.iter().flat_map(|fill| fill.triangles.iter().copied()).collect();
        unfilled.extend(none.into_iter().map(|fill| fill.hole));
        gone.sort_unstable();
        let mut triangles = self.into_corners();
        triangles.retain(|triangle| gone.binary_search(triangle).is_err());
        Joined { triangles, unfilled, filled }.counted(particles).await
    }

    /// The triangulation with the [cracks](cracks) between its patches filled.
    async fn without_cracks(self, particles: &Particles, bounds: Option<&Bounds>) -> Self {
        let found = cracks::fill(&self, particles, bounds).await;
        if found.is_empty() {
            return self;
        }
        let (unfilled, mut filled) = (self.unfilled.clone(), self.filled.clone());
        let mut triangles = self.into_corners();
        triangles.extend(found.iter().flat_map(|fill| fill.triangles.iter().copied()));
        filled.extend(found);
        Joined { triangles, unfilled, filled }.counted(particles).await
    }

    /// Reverses the triangles around these vertices.
    fn turn(&mut self, turned: Vec<bool>) {
        if self.corners.is_empty() {
            self.corners.clone_from(&self.triangles);
        }
        let is_turned = |v: u32| turned[v as usize];
        let inward = self.triangles.iter_mut().filter(|triangle| is_turned(triangle[0]));
        inward.for_each(|triangle| triangle.swap(1, 2));
        self.unfilled.iter_mut().filter(|hole| is_turned(hole[0])).for_each(|hole| hole[1..].reverse());
        self.topology.turn(is_turned);
        self.turned = turned;
    }

    /// The triangulation of a bounded surface outside which f is negative: if no part of it is
    /// closed, all parts are turned to face outward.
    pub(crate) fn facing_outward(mut self) -> Self {
        if self.inside.is_none() && !self.triangles.is_empty() {
            let vertices = self.topology.component_of.len();
            self.inside = Some(Inside::Positive);
            self.turn(vec![true; vertices]);
        }
        self
    }

    /// Returns the corners of the triangles as rows of the particles. A particle on a crease has a
    /// row for each patch, with the normal of that patch; [`Self::triangles`] always names the
    /// first of them. Corners run counter-clockwise round the normals of their rows, which point to
    /// larger f: if f is larger inside, [`Self::triangles`] run the other way round.
    #[must_use]
    pub fn corners(&self) -> &[[u32; 3]] {
        if self.corners.is_empty() { &self.triangles } else { &self.corners }
    }

    /// The [corners](Self::corners) of all triangles.
    pub(crate) fn into_corners(self) -> Vec<[u32; 3]> {
        if self.corners.is_empty() { self.triangles } else { self.corners }
    }

    /// Whether [`Self::corners`] differ from [`Self::triangles`].
    pub(crate) fn has_corners(&self) -> bool {
        !self.corners.is_empty()
    }

    /// Whether a triangle was turned to face outward.
    pub(crate) fn is_turned(&self, triangle: usize) -> bool {
        !self.turned.is_empty() && self.turned[self.triangles[triangle][0] as usize]
    }

    /// The [corners](Self::corners) of a triangle in the order of the triangle.
    pub(crate) fn outward_corners(&self, triangle: usize) -> [u32; 3] {
        let [a, b, c] = self.corners()[triangle];
        if self.is_turned(triangle) { [a, c, b] } else { [a, b, c] }
    }

    /// Volume that the triangles over these particles enclose, exact for the triangles, in cubed
    /// units of the coordinates: the sum of a · (b × c) / 6 over them, by the divergence theorem.
    /// Positive whether f is smaller or larger inside. `None` if they are not closed.
    #[must_use]
    pub fn volume(&self, particles: &Particles) -> Option<f64> {
        let at = |i: u32| particles.local[i as usize].as_dvec3();
        let of = |&[a, b, c]: &[u32; 3]| at(a).dot(at(b).cross(at(c))) / 6.0;
        self.topology.encloses().then(|| self.triangles.iter().map(of).sum())
    }

    /// Smallest angle of the triangles over these particles, in degrees, including those at
    /// borders; 0 for one without area. `None` without triangles.
    #[must_use]
    pub fn smallest_angle(&self, particles: &Particles) -> Option<f64> {
        // In a triangle the smallest angle has the largest cosine.
        let cosine = |&[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|i| particles.local[i as usize].as_dvec3());
            let at = |p: DVec3, q: DVec3, r: DVec3| {
                let (u, v) = (q - p, r - p);
                u.dot(v) / (u.length() * v.length())
            };
            let largest = at(a, b, c).max(at(b, c, a)).max(at(c, a, b));
            // Two corners coincide.
            if largest.is_finite() { largest } else { 1.0 }
        };
        let largest = self.triangles.iter().map(cosine).reduce(f64::max)?;
        Some(libm::acos(largest.clamp(0.0, 1.0)).to_degrees())
    }
}

/// Triangles over points, before they are counted.
#[derive(Default)]
struct Joined {
    triangles: Vec<[u32; 3]>,
    /// Loops around holes that no manifold fills.
    unfilled: Vec<Vec<u32>>,
    filled: Vec<Fill>,
}

impl Joined {
    /// The triangulation over the rows of particles.
    async fn counted(self, particles: &Particles) -> Triangulation {
        let Self { triangles: corners, unfilled, filled } = self;
        let (count, joints) = (particles.len(), particles.joints());
        let first = |v: u32| joints.get(v as usize).copied().unwrap_or(v);
        let mut is_met = vec![false; count];
        corners.iter().flatten().for_each(|&v| is_met[first(v) as usize] = true);
        pause().await;
        let left_out = (0..count as u32).filter(|&v| first(v) == v && !is_met[v as usize]).collect();
        pause().await;
        let (mut triangles, corners) = if joints.is_empty() {
            (corners, Vec::new())
        } else {
            (corners.iter().map(|triangle| triangle.map(first)).collect(), corners)
        };
        pause().await;
        let mut topology = Topology::in_slices(&triangles, count).await;
        if !corners.is_empty() && !topology.pinched_vertices.is_empty() {
            pause().await;
            separate_fans(&mut triangles, &corners, &topology.pinched_vertices);
            topology = Topology::in_slices(&triangles, count).await;
        }
        pause().await;
        // A border edge has one direction, which depends on whether its part was turned.
        let mut edges: Vec<[u32; 2]> = Vec::new();
        for hole in &unfilled {
            let sides = (0..hole.len()).map(|k| [hole[(k + 1) % hole.len()], hole[k]].map(first));
            edges.extend(sides.flat_map(|[a, b]| [[a, b], [b, a]]));
        }
        sort_pairs(&mut edges);
        let is_open = |border: &Vec<u32>| {
            let mut sides = (0..border.len()).map(|k| [border[k], border[(k + 1) % border.len()]]);
            sides.any(|side| edges.binary_search(&side).is_ok())
        };
        let is_unfilled: Vec<bool> = topology.borders.iter().map(is_open).collect();
        let Facing { turned, inside, body_of } = facing(&particles.local, &triangles, &topology).await;
        let unfilled = topology.borders.iter().zip(is_unfilled);
        let unfilled =
            unfilled.filter(|(_, is_unfilled)| *is_unfilled).map(|(border, _)| border.clone()).collect();
        let mut mesh = Triangulation {
            triangles,
            topology,
            unfilled,
            left_out,
            inside,
            corners,
            turned: Vec::new(),
            filled,
            body_of,
        };
        if !turned.is_empty() {
            mesh.turn(turned);
            pause().await;
        }
        mesh
    }
}

/// Joins particles to triangles of their rows. If the surface has creases, each patch is joined up
/// to its creases, which are edges of the mesh. The topology counts each particle once, so it is
/// that of the patches together.
///
/// `bounds` is the box that cuts the surface: loops along its faces are borders, however short.
/// Without it a small one may be filled.
///
/// Positions and outward normals are enough; the normals need not have unit length. The particles
/// should be so dense that the normals of neighbours are well within 90° of each other and sheets
/// are farther apart than neighbours; otherwise holes remain and are listed. Cost: linear, below a
/// microsecond per particle natively. No input causes a panic, and the work is bounded. The result
/// depends only on the particles and has the same bits natively and in WebAssembly.
///
/// # Panics
///
/// If the columns differ in length, or there are 2³¹ rows or more.
#[must_use]
pub fn triangulate(particles: &Particles, bounds: Option<&Bounds>) -> Triangulation {
    slices::in_pool(|| slices::complete(in_slices(particles, bounds)))
}

/// Number of slices that joining so many points is expected to take, with or without their stars.
pub(crate) fn expected_slices(points: usize, has_stars: bool) -> u64 {
    /// Slices for each point, of the star: [`HEAVY`](slices::HEAVY) points at once.
    const STAR: f64 = 0.032;
    /// Slices for each point, of everything else.
    const ELSE: f64 = 0.013;
    ((if has_stars { ELSE } else { STAR + ELSE }) * points as f64) as u64
}

/// [`triangulate`] in slices of work. The last few take all rows and triangles at once, for some 50
/// ns each.
pub(crate) async fn in_slices(particles: &Particles, bounds: Option<&Bounds>) -> Triangulation {
    join(particles, &Sheets::new(particles, &ByDirection).await, bounds).await
}

/// Joins particles with these sheets.
pub(crate) async fn join(particles: &Particles, sheets: &Sheets, bounds: Option<&Bounds>) -> Triangulation {
    let mut whole = Joined::default();
    let is_image =
        |sheet: &&Sheet| particles.opposite.iter().any(|faces| sheet.patch == Some(faces.patches[1]));
    for sheet in sheets.all.iter().filter(|sheet| !is_image(sheet)) {
        pause().await;
        sheet.join(bounds, &mut whole).await;
    }
    for faces in &particles.opposite {
        pause().await;
        creases::repeat(&mut whole.triangles, &mut whole.unfilled, faces, &particles.patch);
    }
    if !particles.patch.is_empty() {
        pause().await;
        creases::separate(&mut whole.triangles, particles);
    }
    let mesh = whole.counted(particles).await;
    if particles.patch.is_empty() || mesh.topology.borders.is_empty() {
        return mesh;
    }
    mesh.without_cracks(particles, bounds).await
}

impl Sheet {
    /// The edges along which the sheet is known to end, as places in its tree, with the sheet on
    /// the left, seen from outside.
    fn rim(&self) -> Rim {
        if self.border.is_empty() {
            return Rim::default();
        }
        let mut place: Vec<(u32, u32)> = self.tree.origin.iter().copied().zip(0..).collect();
        sort_pairs(&mut place);
        let in_tree = |i: u32| place.binary_search_by_key(&i, |&(i, _)| i).ok().map(|k| place[k].1);
        let edges = self.border.iter().filter_map(|&[a, b]| Some([in_tree(a)?, in_tree(b)?]));
        Rim::new(edges.collect(), &self.tree.position, &self.normal)
    }

    /// Adds the triangles and holes of the sheet, in the box that cuts the surface. No triangle
    /// lies beyond its rim; gaps on the left of the rim are holes.
    async fn join(&self, bounds: Option<&Bounds>, joined: &mut Joined) {
        let Self { tree, normal, stars, .. } = self;
        let rim = self.rim();
        let mut patch = Patch::new(&tree.position, normal, stars).await;
        let borders = Borders { bounds, rim: &rim };
        settle::settle(&mut patch).await;
        rim.clear(&mut patch).await;
        let filled = holes::fill(&mut patch, &borders).await;
        let mut keys = Vec::new();
        for range in ranges(tree.len(), LIGHT) {
            for v in range.start as u32..range.end as u32 {
                if patch.around(v).next().is_none() && !rim.holds(v) {
                    insert::insert(&mut patch, tree, v, &mut keys);
                    pause().await;
                }
            }
            pause().await;
        }
        holes::unpinch(&mut patch, &rim);
        pause().await;

        let row = |v: u32| tree.origin[v as usize];
        joined.filled.extend(filled.into_iter().map(|fill| fill.renamed(row)));
        joined.triangles.extend(patch.triangles().map(|triangle| triangle.map(row)));
        pause().await;
        let mut holes = borders.holes(&patch);
        holes.retain(|hole| !borders.is_open(&patch, hole));
        joined.unfilled.extend(holes.into_iter().map(|hole| hole.into_iter().map(row).collect()));
    }
}
