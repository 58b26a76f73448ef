//! Holes: their borders are traced, and the polygons are divided into triangles.

use super::patch::{Gap, Patch};
use super::rim::Rim;
use crate::math::{Bounds, sort_few};
use crate::particles::Particles;
use crate::slices::pause;
use glam::{DVec3, Vec3};

/// Least cosine of the angle between the normal of a triangle and that of a point on it: of 78°.
/// The points are those inserted into the triangle, and the corners of one that fills a hole, or
/// their mean if nothing else fits.
pub(super) const AGREEMENT: f64 = 0.2;
/// A vertex is at the box if it is nearer to one of the faces than this many spacings. Larger: more
/// holes are taken for borders.
pub(super) const AT_BOX: f64 = 1.5;
/// Largest number of rounds in which holes are filled and, if that fails, enlarged by a vertex: a
/// limit on time.
const ROUNDS: u32 = 12;
/// Largest number of edges of a hole that is filled. A longer loop is taken for a border of the
/// surface. Smaller: more holes remain; larger: more borders of the surface are closed.
const LARGEST: usize = 24;
/// Largest number of edges of a hole along a rim, or between patches, that is filled: the work
/// grows with the cube of it, to some 10 ms at this number.
pub(super) const LARGEST_AT_RIM: usize = 96;

/// Distinguishes holes of the mesh from borders of the surface.
pub(super) struct Borders<'a> {
    /// The box that cuts the surface.
    pub(super) bounds: Option<&'a Bounds>,
    /// The rim of the surface.
    pub(super) rim: &'a Rim,
}

impl Borders<'_> {
    /// The holes that are not borders of the surface, and not too large.
    pub(super) fn holes(&self, patch: &Patch) -> Vec<Vec<u32>> {
        let mut loops = trace(patch, self.rim);
        loops.retain(|hole| !self.is_border(patch, hole));
        loops
    }

    /// Whether the surface may end at a loop that cannot be filled: most of the vertices see no
    /// near points on that side.
    pub(super) fn is_open(&self, patch: &Patch, hole: &[u32]) -> bool {
        2 * hole.iter().filter(|&&v| patch.stars.is_open[v as usize]).count() > hole.len()
            && !self.rim.is_along(hole)
    }

    /// Whether a loop is certainly a border: it is not along the rim, and it is long or most of it
    /// lies at the box.
    fn is_border(&self, patch: &Patch, hole: &[u32]) -> bool {
        let at_box = |v: &u32| {
            let (p, reach) = (patch.place(*v), AT_BOX * patch.spacing(*v));
            self.bounds.is_some_and(|bounds| (p - bounds.lo()).min(bounds.hi() - p).min_element() <= reach)
        };
        !self.rim.is_along(hole)
            && (hole.len() > LARGEST || 2 * hole.iter().filter(|v| at_box(v)).count() > hole.len())
    }
}

/// A hole that was filled.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fill {
    /// The loop around it, with the hole on the left.
    pub(super) hole: Vec<u32>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// The middle of a triangle that fills a hole.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Middle {
    pub(crate) place: Vec3,
    /// Unit normal.
    pub(crate) up: Vec3,
    /// Longest side of the triangle.
    pub(crate) reach: f32,
}

impl Fill {
    /// The middle of the largest triangle.
    pub(super) fn middle(&self, particles: &Particles) -> Middle {
        let place = |row: u32| particles.local[row as usize];
        let area = |&[a, b, c]: &[u32; 3]| (place(b) - place(a)).cross(place(c) - place(a));
        let size = |triangle: &[u32; 3]| area(triangle).length_squared();
        let largest = |one: [u32; 3], other: [u32; 3]| if size(&other) > size(&one) { other } else { one };
        let triangle = self.triangles.iter().copied().reduce(largest).unwrap_or_default();
        let [a, b, c] = triangle.map(place);
        Middle {
            place: (a + b + c) / 3.0,
            up: area(&triangle).normalize_or_zero(),
            reach: a.distance(b).max(b.distance(c)).max(c.distance(a)),
        }
    }

    /// The fill with other names for its vertices.
    pub(super) fn renamed(self, name: impl Fn(u32) -> u32) -> Self {
        let Self { hole, triangles } = self;
        Self {
            hole: hole.into_iter().map(&name).collect(),
            triangles: triangles.into_iter().map(|triangle| triangle.map(&name)).collect(),
        }
    }
}

/// Fills the holes.
pub(super) async fn fill(patch: &mut Patch<'_>, borders: &Borders<'_>) -> Vec<Fill> {
    let mut cutter = Cutter::default();
    let mut filled = Vec::new();
    for _ in 0..ROUNDS {
        let mut resisting = Vec::new();
        for hole in borders.holes(patch) {
            pause().await;
            if hole.len() > LARGEST_AT_RIM {
                continue;
            }
            let mut cut =
                |is_right| cutter.cut(&hole, &Within { patch: &*patch, rim: borders.rim, is_right });
            if cut(faces_as_corners) || cut(faces_as_mean) {
                cutter.triangles.iter().for_each(|&triangle| patch.add(triangle));
                filled.push(Fill { hole, triangles: cutter.triangles.clone() });
            } else {
                resisting.push(hole);
            }
        }
        let mut has_grown = false;
        for hole in resisting {
            if borders.is_open(patch, &hole) {
                continue;
            }
            let count = |v: u32| patch.around(v).count();
            if let Some(v) = hole.into_iter().filter(|&v| count(v) > 0).min_by_key(|&v| (count(v), v)) {
                patch.clear(v);
                has_grown = true;
            }
        }
        if !has_grown {
            break;
        }
    }
    filled
}

/// The borders of the triangles: closed loops of vertices with the hole on the left. If there is a
/// rim, a hole ends at it: only what the triangles leave open on its left counts.
fn trace(patch: &Patch, rim: &Rim) -> Vec<Vec<u32>> {
    let mut gaps: Vec<Gap> = Vec::new();
    let mut first_of = Vec::with_capacity(patch.changed().len());
    for &v in patch.changed() {
        first_of.push(gaps.len());
        patch.gaps(v, &mut gaps);
        rim.narrow(patch, v, &mut gaps, first_of[first_of.len() - 1]);
    }
    let mut is_used = vec![false; gaps.len()];
    let mut loops = Vec::new();
    for start in 0..gaps.len() {
        let mut hole = Vec::new();
        let mut at = Some(start);
        while let Some(k) = at.filter(|&k| !core::mem::replace(&mut is_used[k], true)) {
            let Gap { vertex, to, .. } = gaps[k];
            hole.push(vertex);
            let first = patch.list_number(to).map_or(gaps.len(), |list| first_of[list]);
            at = (first..gaps.len()).take_while(|&k| gaps[k].vertex == to).find(|&k| gaps[k].from == vertex);
        }
        // A walk along the rim may end where the box cuts the rim.
        if !hole.is_empty() && (rim.is_empty() || at == Some(start)) {
            loops.push(hole);
        }
    }
    loops
}

/// Whether a triangle faces as each of its corners does.
pub(super) fn faces_as_corners(patch: &Patch, triangle: [u32; 3]) -> bool {
    patch.agreement(triangle).0 >= AGREEMENT
}

/// Whether a triangle faces as its corners do on average, which is enough if neighbours' normals
/// are far apart.
fn faces_as_mean(patch: &Patch, triangle: [u32; 3]) -> bool {
    patch.agreement(triangle).1 >= AGREEMENT
}

/// The mesh around a hole.
pub(super) trait Around {
    /// Whether there can be no new edge between two vertices.
    fn is_taken(&self, a: u32, b: u32) -> bool;

    /// Whether a new triangle faces as its corners do.
    fn is_right(&self, triangle: [u32; 3]) -> bool;

    /// Radius of the circle through the corners of a triangle.
    fn circumradius(&self, triangle: [u32; 3]) -> f64;
}

/// The mesh around a hole of a patch.
struct Within<'a, 'p> {
    patch: &'a Patch<'p>,
    rim: &'a Rim,
    is_right: fn(&Patch, [u32; 3]) -> bool,
}

impl Around for Within<'_, '_> {
    fn is_taken(&self, a: u32, b: u32) -> bool {
        // An edge of the rim has a triangle only on its left; filling another hole may have made
        // it.
        a == b || self.patch.has_edge(a, b) || self.rim.has(a, b) || self.rim.has(b, a)
    }

    fn is_right(&self, triangle: [u32; 3]) -> bool {
        (self.is_right)(self.patch, triangle)
    }

    fn circumradius(&self, triangle: [u32; 3]) -> f64 {
        circumradius(triangle.map(|v| self.patch.place(v)))
    }
}

/// Radius of the circle through three points; infinite if they lie on a line.
pub(super) fn circumradius([a, b, c]: [DVec3; 3]) -> f64 {
    let product = (b - a).length() * (c - b).length() * (a - c).length();
    product / (2.0 * (b - a).cross(c - a).length())
}

/// Divides polygons into triangles.
#[derive(Default)]
pub(super) struct Cutter {
    /// For each chord the least sum of circumradii on its left, and the vertex of the triangle at
    /// the chord.
    best: Vec<(f64, usize)>,
    /// The triangles of the last hole that could be filled.
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Cutter {
    /// Fills a hole, which is on the left of its vertices in their order, with the triangles whose
    /// circumradii have the least sum, if there are any that are right and have no edge that is
    /// taken except those of the hole. Returns whether there are.
    pub(super) fn cut(&mut self, hole: &[u32], around: &dyn Around) -> bool {
        let n = hole.len();
        let at = |i: usize, j: usize| i * n + j;
        self.best.clear();
        self.best.resize(n * n, (f64::INFINITY, 0));
        for i in 0..n - 1 {
            self.best[at(i, i + 1)] = (0.0, 0);
        }
        for span in 2..n {
            for i in 0..n - span {
                let j = i + span;
                if span + 1 < n && around.is_taken(hole[i], hole[j]) {
                    continue;
                }
                for k in i + 1..j {
                    let rest = self.best[at(i, k)].0 + self.best[at(k, j)].0;
                    let triangle = [hole[i], hole[k], hole[j]];
                    if rest < self.best[at(i, j)].0 && around.is_right(triangle) {
                        let sum = rest + around.circumradius(triangle);
                        if sum < self.best[at(i, j)].0 {
                            self.best[at(i, j)] = (sum, k);
                        }
                    }
                }
            }
        }
        if self.best[at(0, n - 1)].0 == f64::INFINITY {
            return false;
        }
        self.triangles.clear();
        let mut chords = Vec::new();
        let mut open = vec![(0, n - 1)];
        while let Some((i, j)) = open.pop() {
            if j - i > 1 {
                let k = self.best[at(i, j)].1;
                self.triangles.push([hole[i], hole[k], hole[j]]);
                chords.push(u64::from(hole[i].min(hole[j])) << 32 | u64::from(hole[i].max(hole[j])));
                open.extend([(i, k), (k, j)]);
            }
        }
        // A hole that visits a vertex twice may use a chord twice.
        chords.sort_unstable();
        chords.windows(2).all(|pair| pair[0] != pair[1])
    }
}

/// Removes all fans but the largest at every vertex with several, so that the surface touches
/// itself only where its rim does.
pub(super) fn unpinch(patch: &mut Patch, rim: &Rim) {
    let mut open: Vec<u32> = patch.changed().to_vec();
    while let Some(v) = open.pop() {
        let mut fans = patch.fans(v);
        sort_few(&mut fans, |a, b| a.len() < b.len());
        fans.truncate(fans.len().saturating_sub(rim.fans(v)));
        for id in fans.into_iter().flatten() {
            open.extend(patch.triangle(id));
            patch.remove(id);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::patch::with_plane;
    use super::*;

    /// Least sum of circumradii over all ways to divide a convex polygon, tried one by one.
    fn least_sum(polygon: &[DVec3]) -> f64 {
        let last = polygon.len() - 1;
        let with_corner = |k: usize| {
            circumradius([polygon[0], polygon[k], polygon[last]])
                + least_sum(&polygon[..=k])
                + least_sum(&polygon[k..])
        };
        if last < 2 { 0.0 } else { (1..last).map(with_corner).fold(f64::INFINITY, f64::min) }
    }

    /// Divides the hole between convex corners, counter-clockwise in the plane, next to existing
    /// triangles and edges of a rim. Numbers stand for corners, and those beyond for the other
    /// points.
    fn cut(
        corners: &[Vec3],
        others: &[Vec3],
        triangles: &[[u32; 3]],
        rim: &[[u32; 2]],
    ) -> Option<Vec<[u32; 3]>> {
        with_plane(&[corners, others].concat(), triangles, |patch, tree, in_tree| {
            let edges = rim.iter().map(|edge| edge.map(|v| in_tree[v as usize])).collect();
            let rim = Rim::new(edges, patch.position, patch.normal);
            let mut cutter = Cutter::default();
            let around = Within { patch, rim: &rim, is_right: faces_as_corners };
            let is_cut = cutter.cut(&in_tree[..corners.len()], &around);
            is_cut.then(|| cutter.triangles.iter().map(|t| t.map(|v| tree.origin[v as usize])).collect())
        })
    }

    #[test]
    fn a_fan_that_leads_back_into_itself_is_left() {
        let points = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NEG_X];
        // The second and the third triangle form a ring around the first point, which the first one
        // enters.
        let gaps = with_plane(&points, &[[0, 1, 2], [0, 2, 3], [0, 3, 2]], |patch, _, in_tree| {
            let mut gaps = Vec::new();
            patch.gaps(in_tree[0], &mut gaps);
            gaps.iter().map(|gap| (gap.vertex, gap.from)).eq([(in_tree[0], in_tree[1])])
        });
        assert!(gaps);
    }

    #[test]
    fn a_hole_is_cut_into_the_triangles_of_the_least_circumradii() {
        for (case, n) in (4..10).flat_map(|n| (0..4).map(move |case| (case, n))) {
            // Corners that are spread unevenly over an ellipse.
            let corner = |k: usize| {
                let uneven = 0.8 * (0.618_034 * (k + 1 + 13 * case) as f32).fract();
                let (sine, cosine) = libm::sincosf((k as f32 + uneven) * core::f32::consts::TAU / n as f32);
                Vec3::new((0.6 + 0.8 * case as f32) * cosine, sine, 0.0)
            };
            let corners: Vec<Vec3> = (0..n).map(corner).collect();
            let place = |v: u32| corners[v as usize].as_dvec3();
            let triangles = cut(&corners, &[], &[], &[]).expect("a convex hole can be cut");
            assert_eq!(triangles.len(), n - 2, "{n} corners, case {case}");
            let sum: f64 = triangles.iter().map(|t| circumradius(t.map(place))).sum();
            let least = least_sum(&(0..n as u32).map(place).collect::<Vec<_>>());
            assert!((sum / least - 1.0).abs() < 1e-6, "{n} corners, case {case}: {sum} instead of {least}");
        }
    }

    #[test]
    fn an_edge_of_the_mesh_or_the_rim_is_no_chord_of_a_hole() {
        // Of the two diagonals, 0–2 is the shorter one.
        let corners = [[0.0, -1.0], [1.5, 0.0], [0.0, 1.0], [-1.5, 0.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let has = |triangles: &[[u32; 3]], a: u32, b: u32| {
            triangles.iter().filter(|t| t.contains(&a) && t.contains(&b)).count() == 2
        };
        let free = cut(&corners, &[], &[], &[]).expect("a convex hole can be cut");
        assert!(has(&free, 0, 2), "{free:?}");
        let others = [Vec3::new(0.0, 0.0, 5.0), Vec3::new(0.0, 0.0, 6.0)];
        for (triangles, rim) in [([[0, 2, 4]].as_slice(), [].as_slice()), (&[], &[[0, 2]]), (&[], &[[2, 0]])]
        {
            let beside = cut(&corners, &others, triangles, rim).expect("the other diagonal is free");
            assert!(has(&beside, 1, 3), "{beside:?}");
        }
        assert_eq!(cut(&corners, &others, &[[0, 2, 4], [1, 3, 5]], &[]), None);
        assert_eq!(cut(&corners, &others, &[[0, 2, 4]], &[[3, 1]]), None);
    }
}
