//! Cracks between patches: openings of the mesh in which no particle fits.
//!
//! Each patch is joined up to its creases. Where two patches meet along a line that was not traced,
//! since an edge fades out there or is rounded more finely than a particle, they have no vertices
//! in common and a crack is left between them. When all patches are joined, the cracks are divided
//! into triangles.

use super::Triangulation;
use super::holes::{AGREEMENT, AT_BOX, Around, Cutter, Fill, LARGEST_AT_RIM, circumradius};
use crate::math::{Bounds, median, sort_pairs};
use crate::particles::Particles;
use crate::slices::pause;
use glam::DVec3;

/// Largest distance across a crack, in distances between the vertices around it, unless one of
/// these is longer. A round opening with nine vertices around it is wider.
const WIDEST: f64 = 2.5;

/// The mesh around a crack. Each particle is one vertex, its first row.
struct Cracks<'a> {
    particles: &'a Particles,
    /// The first row of each particle on a crease, by its rows.
    joints: Vec<u32>,
    /// The rows of these particles, each after the first one of its particle; sorted.
    rows: Vec<[u32; 2]>,
    /// The edges of the mesh between vertices on borders, both ways; sorted.
    edges: Vec<[u32; 2]>,
    /// Largest distance across the crack.
    widest: f64,
    /// Least cosine of the angle between a triangle's normal and the mean one at its corners.
    least: f64,
}

/// Divides the cracks into triangles by rows. `bounds` is the box that cuts the surface.
pub(super) async fn fill(mesh: &Triangulation, particles: &Particles, bounds: Option<&Bounds>) -> Vec<Fill> {
    let mut cracks = Cracks::new(mesh, particles);
    let mut cutter = Cutter::default();
    let mut filled = Vec::new();
    for border in &mesh.topology.borders {
        pause().await;
        let (spacing, longest) = cracks.spacing(border);
        let is_at_box = |bounds: &Bounds| cracks.are_most_near(border, bounds, AT_BOX * spacing);
        if border.len() > LARGEST_AT_RIM || bounds.is_some_and(is_at_box) {
            continue;
        }
        cracks.widest = longest.max(WIDEST * spacing);
        // A border has the mesh on its left, a hole its inside, seen from where the triangles by
        // rows run counter-clockwise.
        let mut around = border.clone();
        if !mesh.turned.get(border[0] as usize).is_some_and(|is_turned| *is_turned) {
            around.reverse();
        }
        for hole in cracks.divided(&around) {
            let is_cut = [AGREEMENT, 0.0].into_iter().any(|least| {
                cracks.least = least;
                cutter.cut(&hole, &cracks)
            });
            if is_cut {
                cracks.add_edges(&cutter.triangles);
                let triangles = cutter.triangles.iter().map(|&triangle| cracks.facing(triangle).0).collect();
                filled.push(Fill { hole, triangles });
            }
        }
    }
    filled
}

impl<'a> Cracks<'a> {
    fn new(mesh: &Triangulation, particles: &'a Particles) -> Self {
        let joints = particles.joints();
        let mut rows: Vec<[u32; 2]> = joints.iter().zip(0..).map(|(&first, row)| [first, row]).collect();
        sort_pairs(&mut rows);
        let mut cracks = Self { particles, joints, rows, edges: Vec::new(), widest: 0.0, least: 0.0 };
        let mut is_at_border = vec![false; particles.len()];
        for &v in mesh.topology.borders.iter().flatten() {
            is_at_border[cracks.first(v) as usize] = true;
        }
        let triangles = mesh.triangles.iter().map(|triangle| triangle.map(|v| cracks.first(v)));
        let is_open = |side: &[u32; 2]| side.iter().all(|&v| is_at_border[v as usize]);
        cracks.edges = triangles.flat_map(sides).filter(is_open).collect();
        sort_pairs(&mut cracks.edges);
        cracks
    }

    /// The particle of a row, by its first row.
    fn first(&self, row: u32) -> u32 {
        self.joints.get(row as usize).copied().unwrap_or(row)
    }

    /// The holes within a loop of rows: where it visits a particle twice, one ends and another
    /// begins.
    fn divided(&self, around: &[u32]) -> Vec<Vec<u32>> {
        let (mut open, mut holes): (Vec<u32>, _) = (Vec::new(), Vec::new());
        for v in around.iter().map(|&row| self.first(row)) {
            if let Some(start) = open.iter().position(|&other| other == v) {
                holes.push(open.split_off(start));
            }
            open.push(v);
        }
        holes.push(open);
        holes.retain(|hole| hole.len() > 2);
        holes
    }

    fn add_edges(&mut self, triangles: &[[u32; 3]]) {
        self.edges.extend(triangles.iter().flat_map(|&triangle| sides(triangle)));
        sort_pairs(&mut self.edges);
    }

    fn place(&self, v: u32) -> DVec3 {
        self.particles.local[v as usize].as_dvec3()
    }

    /// The median distance between successive vertices of a border, and the longest one.
    fn spacing(&self, border: &[u32]) -> (f64, f64) {
        let next = border.iter().skip(1).chain(border.first());
        let sides = border.iter().zip(next).map(|(&a, &b)| self.place(a).distance(self.place(b)));
        let sides: Vec<f64> = sides.collect();
        let longest = sides.iter().copied().fold(0.0, f64::max);
        (median(sides).unwrap_or(0.0), longest)
    }

    /// Whether most of a border lies within `reach` of a face of the box.
    fn are_most_near(&self, border: &[u32], bounds: &Bounds, reach: f64) -> bool {
        let from_face = |p: DVec3| (p - bounds.lo()).min(bounds.hi() - p).min_element();
        2 * border.iter().filter(|&&v| from_face(self.place(v)) <= reach).count() > border.len()
    }

    /// For each corner of a triangle the row whose normal agrees best with the triangle's, and the
    /// cosine of the angle between that and the mean of these normals.
    fn facing(&self, triangle: [u32; 3]) -> ([u32; 3], f64) {
        let [a, b, c] = triangle.map(|v| self.place(v));
        let up = (b - a).cross(c - a).normalize_or_zero();
        let normal = |row: u32| self.particles.normal[row as usize].as_dvec3().normalize_or_zero();
        let agreement = |row: u32| normal(row).dot(up);
        let rows = triangle.map(|v| {
            let start = self.rows.partition_point(|row| row[0] < v);
            let own = self.rows[start..].iter().take_while(|row| row[0] == v).map(|row| row[1]);
            own.max_by(|&one, &other| agreement(one).total_cmp(&agreement(other))).unwrap_or(v)
        });
        let mean: DVec3 = rows.into_iter().map(normal).sum();
        (rows, mean.normalize_or_zero().dot(up))
    }
}

impl Around for Cracks<'_> {
    fn is_taken(&self, a: u32, b: u32) -> bool {
        a == b
            || self.place(a).distance(self.place(b)) > self.widest
            || self.edges.binary_search(&[a, b]).is_ok()
    }

    fn is_right(&self, triangle: [u32; 3]) -> bool {
        self.facing(triangle).1 >= self.least
    }

    fn circumradius(&self, triangle: [u32; 3]) -> f64 {
        circumradius(triangle.map(|v| self.place(v)))
    }
}

/// The sides of a triangle, both ways.
fn sides([a, b, c]: [u32; 3]) -> impl Iterator<Item = [u32; 2]> {
    [[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]].into_iter()
}

#[cfg(test)]
mod tests {
    use crate::mesh::triangulation::triangulate;
    use crate::particles::Particles;
    use glam::Vec3;

    /// A square of points in a plane, divided into two patches by a crease along its middle. The
    /// crease lacks the particles with these numbers, which begin with 0 in its middle.
    fn square(missing: core::ops::Range<i16>) -> Particles {
        const HALF: i16 = 6;
        let place = |x: f32, y: i16| Vec3::new(x, f32::from(y) + 0.03 * x, 0.0);
        let mut particles = Particles::default();
        for y in (-HALF..=HALF).filter(|y| !missing.contains(y)) {
            let first = particles.len() as u32;
            for patch in 0..2 {
                particles.push_seed(place(0.0, y), Vec3::Z, 0.5, Some(patch));
                particles.twins.push(first);
            }
            if y > -HALF && !missing.contains(&(y - 1)) {
                // Patch 0 is on the left of the way up.
                particles.segments.push([first - 2, first]);
                particles.sides.push(vec![[0, 1]]);
            }
        }
        for x in (-HALF..=HALF).filter(|&x| x != 0) {
            for y in -HALF..=HALF {
                particles.push_seed(place(f32::from(x), y), Vec3::Z, 0.5, Some(u32::from(x > 0)));
            }
        }
        particles
    }

    #[test]
    fn a_crack_along_a_crease_is_filled() {
        for missing in [0..0, 0..1, -1..2, -3..3] {
            let mesh = triangulate(&square(missing.clone()), None);
            assert!(mesh.topology.is_manifold(), "{missing:?}");
            assert_eq!((mesh.topology.borders.len(), mesh.topology.euler()), (1, 1), "{missing:?}");
            assert!(mesh.left_out.is_empty(), "{missing:?}");
        }
    }
}
