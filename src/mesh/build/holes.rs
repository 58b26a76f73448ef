//! Holes: their borders are traced and the polygons are cut into triangles.

use super::patch::{Gap, Patch};
use crate::math::Bounds;
use crate::slices::pause;

/// Least cosine of the angle between the normal of a triangle that fills a hole and that of each of its corners, or of their
/// mean where there is no other way.
const AGREEMENT: f64 = 0.2;
/// A vertex is at the box if it is nearer to one of the faces than this many spacings.
const AT_BOX: f64 = 1.5;
/// Rounds in which holes are filled and, where that fails, made larger by a vertex.
const ROUNDS: u32 = 12;

/// What is taken for a hole, and what for a border of the surface.
pub(super) struct Borders<'a> {
    /// Most edges of a hole.
    pub(super) largest_hole: usize,
    /// The box that cuts the surface.
    pub(super) bounds: Option<&'a Bounds>,
}

impl Borders<'_> {
    /// Whether a loop is a border for certain: it is long, or most of it lies at the box.
    pub(super) fn is_border(&self, patch: &Patch, hole: &[u32]) -> bool {
        let at_box = |v: &u32| {
            let (p, reach) = (patch.place(*v), AT_BOX * patch.spacing(*v));
            self.bounds.is_some_and(|bounds| (p - bounds.lo()).min(bounds.hi() - p).min_element() <= reach)
        };
        hole.len() > self.largest_hole || 2 * hole.iter().filter(|v| at_box(v)).count() > hole.len()
    }
}

/// Fills the holes; the number of rounds it took.
pub(super) async fn fill(patch: &mut Patch<'_>, borders: &Borders<'_>) -> u32 {
    let mut cutter = Cutter::default();
    for round in 0..ROUNDS {
        let mut resisting = Vec::new();
        for hole in trace(patch) {
            if borders.is_border(patch, &hole) {
                continue;
            }
            pause().await;
            if !cutter.cut(patch, &hole, faces_as_corners) && !cutter.cut(patch, &hole, faces_as_mean) {
                resisting.push(hole);
            }
        }
        let mut has_grown = false;
        for hole in resisting {
            if is_open(patch, &hole) {
                continue;
            }
            let count = |v: u32| patch.around(v).count();
            if let Some(v) = hole.into_iter().filter(|&v| count(v) > 0).min_by_key(|&v| (count(v), v)) {
                patch.clear(v);
                has_grown = true;
            }
        }
        if !has_grown {
            return round + 1;
        }
    }
    ROUNDS
}

/// Whether the surface may as well end at a loop that cannot be filled: most of the vertices see nothing near on that side.
pub(super) fn is_open(patch: &Patch, hole: &[u32]) -> bool {
    2 * hole.iter().filter(|&&v| patch.stars.is_open[v as usize]).count() > hole.len()
}

/// The borders of the triangles: closed loops of vertices with the hole on the left.
pub(super) fn trace(patch: &Patch) -> Vec<Vec<u32>> {
    let mut gaps: Vec<Gap> = Vec::new();
    let mut first_of = Vec::with_capacity(patch.changed().len());
    for &v in patch.changed() {
        first_of.push(gaps.len());
        patch.gaps(v, &mut gaps);
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
        if !hole.is_empty() {
            loops.push(hole);
        }
    }
    loops
}

/// Whether a triangle faces as each of its corners does.
pub(super) fn faces_as_corners(patch: &Patch, triangle: [u32; 3]) -> bool {
    patch.agreement(triangle).0 >= AGREEMENT
}

/// Whether a triangle faces as its corners do in the mean: what can be had where neighbours' normals are far apart.
fn faces_as_mean(patch: &Patch, triangle: [u32; 3]) -> bool {
    patch.agreement(triangle).1 >= AGREEMENT
}

/// Cuts polygons into triangles.
#[derive(Default)]
struct Cutter {
    /// For each chord the least sum of circumradii on its left, and the vertex of the triangle at the chord.
    best: Vec<(f64, usize)>,
    triangles: Vec<[u32; 3]>,
}

impl Cutter {
    /// Fills a hole with the triangles whose circumradii have the least sum, if there are any that are right and have no edge
    /// of the mesh but those of the hole; whether there were.
    fn cut(&mut self, patch: &mut Patch, hole: &[u32], is_right: impl Fn(&Patch, [u32; 3]) -> bool) -> bool {
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
                if span + 1 < n && (hole[i] == hole[j] || patch.has_edge(hole[i], hole[j])) {
                    continue;
                }
                for k in i + 1..j {
                    let rest = self.best[at(i, k)].0 + self.best[at(k, j)].0;
                    let triangle = [hole[i], hole[k], hole[j]];
                    if rest < self.best[at(i, j)].0 && is_right(patch, triangle) {
                        let sum = rest + patch.circumradius(triangle);
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
                chords.push((hole[i].min(hole[j]), hole[i].max(hole[j])));
                open.extend([(i, k), (k, j)]);
            }
        }
        // A hole that comes to a vertex twice may use a chord twice.
        chords.sort_unstable();
        if chords.windows(2).any(|pair| pair[0] == pair[1]) {
            return false;
        }
        self.triangles.iter().for_each(|&triangle| patch.add(triangle));
        true
    }
}

/// Removes all fans but the largest at every vertex with several, so that the surface does not touch itself.
pub(super) fn unpinch(patch: &mut Patch) {
    let mut open: Vec<u32> = patch.changed().to_vec();
    while let Some(v) = open.pop() {
        let mut fans = patch.fans(v);
        fans.sort_by_key(Vec::len);
        fans.pop();
        for id in fans.into_iter().flatten() {
            open.extend(patch.triangle(id));
            patch.remove(id);
        }
    }
}
