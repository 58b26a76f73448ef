//! Triangles of several patches that were joined separately.

use crate::math::{sort_by_key, sort_few, sort_pairs};
use crate::particles::{OppositeFaces, Particles};
use glam::Vec3;

/// Repeats the triangles and the loops around holes of the lower of two opposite faces of a cell on
/// the upper one, by rows of particles on these patches.
pub(super) fn repeat(
    triangles: &mut Vec<[u32; 3]>,
    unfilled: &mut Vec<Vec<u32>>,
    faces: &OppositeFaces,
    patch: &[u32],
) {
    let mut rows = faces.rows.clone();
    sort_pairs(&mut rows);
    let image = |row: u32| rows[rows.partition_point(|pair| pair[0] < row)][1];
    let is_lower = |row: u32| patch[row as usize] == faces.patches[0];
    let lower: Vec<[u32; 3]> = triangles.iter().copied().filter(|triangle| is_lower(triangle[0])).collect();
    triangles.extend(lower.into_iter().map(|[a, b, c]| [a, c, b].map(image)));
    let holes: Vec<Vec<u32>> = unfilled.iter().filter(|hole| is_lower(hole[0])).cloned().collect();
    unfilled.extend(holes.into_iter().map(|hole| hole.into_iter().rev().map(image).collect()));
}

/// Flips chords between particles on creases that two patches have in common, by rows: each patch
/// is joined by itself, and three successive particles along a crease may form a triangle of
/// either. The chord of the patch that it follows less is replaced by the other diagonal of its two
/// triangles, if possible.
pub(super) fn separate(triangles: &mut [[u32; 3]], particles: &Particles) {
    let vertices = particles.joints();
    // The ends of each side of a triangle between particles on creases, with the place of its first
    // corner among all corners.
    let mut sides: Vec<(u64, usize)> = Vec::new();
    for (triangle, rows) in triangles.iter().enumerate() {
        for corner in 0..3 {
            let ends = [rows[corner], rows[(corner + 1) % 3]].map(|row| vertices.get(row as usize));
            if let [Some(&a), Some(&b)] = ends {
                sides.push((u64::from(a.min(b)) << 32 | u64::from(a.max(b)), 3 * triangle + corner));
            }
        }
    }
    sort_by_key(&mut sides, |side| side.0);
    for of_edge in sides.chunk_by(|one, other| one.0 == other.0).filter(|sides| sides.len() > 2) {
        let mut chords: Vec<Chord> = Vec::new();
        for (k, &(_, one)) in of_edge.iter().enumerate() {
            let others = of_edge[..k].iter();
            chords
                .extend(others.filter_map(|&(_, other)| Chord::between([one, other], triangles, particles)));
        }
        sort_few(&mut chords, |one, other| one.follows < other.follows);
        let mut left = of_edge.len();
        for chord in chords {
            if left > 2 && chord.turn(triangles, particles, &vertices) {
                left -= 2;
            }
        }
    }
}

/// Two triangles of a patch with a common side: the triangles (a, b, c) and (b, a, d).
#[derive(Clone, Copy, Debug)]
struct Chord {
    triangles: [usize; 2],
    rows: [u32; 4],
    /// How closely its triangles follow the patch: the lesser of the cosines between their normals
    /// and those at their corners.
    follows: f32,
}

impl Chord {
    /// The chord between two triangles, from the places at which their sides begin, if both are on
    /// one patch that is not a repeated face or its image.
    fn between(sides: [usize; 2], triangles: &[[u32; 3]], particles: &Particles) -> Option<Self> {
        let [[a, b, c], [e, f, d]] = sides.map(|side| {
            let rows = triangles[side / 3];
            [0, 1, 2].map(|k| rows[(side + k) % 3])
        });
        let patch = particles.patch[a as usize];
        let is_face = particles.opposite.iter().any(|faces| faces.patches.contains(&patch));
        let follows = follows([a, b, c], particles).min(follows([b, a, d], particles));
        let triangles = sides.map(|side| side / 3);
        ([e, f] == [b, a] && !is_face).then_some(Self { triangles, rows: [a, b, c, d], follows })
    }

    /// Replaces the chord by the other diagonal, unless that is an edge of the mesh or its
    /// triangles turn away from the patch.
    fn turn(&self, triangles: &mut [[u32; 3]], particles: &Particles, vertices: &[u32]) -> bool {
        let [a, b, c, d] = self.rows;
        let turned = [[a, d, c], [d, b, c]];
        let vertex = |row: u32| vertices.get(row as usize).copied().unwrap_or(row);
        let has_ends = |triangle: &[u32; 3]| {
            let has = |end: u32| triangle.iter().any(|&row| vertex(row) == vertex(end));
            has(c) && has(d)
        };
        let is_free = vertex(c) != vertex(d) && !triangles.iter().any(has_ends);
        let can_turn = is_free && turned.iter().all(|&triangle| follows(triangle, particles) > 0.0);
        if can_turn {
            self.triangles.iter().zip(turned).for_each(|(&k, triangle)| triangles[k] = triangle);
        }
        can_turn
    }
}

/// Cosine of the angle between the normal of a triangle and the mean one at its corners; 0 for a
/// triangle without area.
fn follows(rows: [u32; 3], particles: &Particles) -> f32 {
    let [a, b, c] = rows.map(|row| particles.local[row as usize]);
    let mean: Vec3 = rows.iter().map(|&row| particles.normal[row as usize]).sum();
    (b - a).cross(c - a).normalize_or_zero().dot(mean.normalize_or_zero())
}
