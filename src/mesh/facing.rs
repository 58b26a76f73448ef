//! The inside of the closed parts of a mesh, and which parts must be turned to face outward.

use crate::math::{key_of, sort_by_key, sort_pairs};
use crate::slices::{LIGHT, pause};
use crate::topology::Topology;
use glam::{DVec3, Vec3};
use serde::Serialize;

/// The sign of f inside the closed parts of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[non_exhaustive]
pub enum Inside {
    /// f is negative inside, as a distance is.
    #[serde(rename = "f < 0")]
    Negative,
    /// f is positive inside, as a density above its level is.
    #[serde(rename = "f > 0")]
    Positive,
    /// f is negative inside some parts and positive inside others.
    #[serde(rename = "f < 0, f > 0")]
    Both,
}

/// The orientation of the parts of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Facing {
    /// For each vertex, whether the triangles around it must be turned to face outward; empty if
    /// all do.
    pub(crate) turned: Vec<bool>,
    /// Sign of f inside the closed parts; none if there is no closed part.
    pub(crate) inside: Option<Inside>,
    /// For each component, the outer wall of its body: itself or, for the wall of a hollow, the
    /// wall around that. Empty if no component has a hollow.
    pub(crate) body_of: Vec<u32>,
}

/// A part of a mesh: triangles that are connected by edges.
struct Part {
    /// A vertex of the part, the origin of the sum for its volume.
    origin: DVec3,
    /// Volume that its triangles enclose as they are; negative if they face inward.
    volume: f64,
    /// Whether it is closed: along every edge as many triangles run one way as the other way.
    is_closed: bool,
    /// The vertex with the largest x.
    last: u32,
}

impl Part {
    fn faces_inward(&self) -> bool {
        self.volume < 0.0
    }
}

/// The orientation of the parts of a mesh whose triangles are counter-clockwise round the gradient
/// of f.
///
/// A closed part that lies in no other one faces outward if it encloses a positive volume. Parts
/// inside it keep their orientation relative to it: the walls of a hollow bound one solid. If f is
/// positive inside all closed parts, the open ones are turned, too, so that the whole mesh is that
/// of −f; otherwise open parts stay as f has them.
///
/// Linear in the triangles. If the signs of the volumes differ, a ray from each part shows which
/// part contains which.
pub(crate) async fn facing(position: &[Vec3], triangles: &[[u32; 3]], topology: &Topology) -> Facing {
    let parts = parts(position, triangles, topology).await;
    let part_of = &topology.component_of;
    let is_inward = |k: usize| parts[k].faces_inward();
    let closed: Vec<usize> = (0..parts.len()).filter(|&k| parts[k].is_closed).collect();
    if closed.is_empty() {
        return Facing::default();
    }
    let inward = closed.iter().filter(|&&k| is_inward(k)).count();
    if inward == 0 {
        return Facing { inside: Some(Inside::Negative), ..Facing::default() };
    }
    let mut outer: Vec<usize> = (0..parts.len()).collect();
    let mut body_of = Vec::new();
    if inward < closed.len() {
        Nesting { outer, body_of } = nesting(position, triangles, &parts, part_of).await;
    }
    let turned = |k: &&usize| is_inward(outer[**k]);
    let inside = match closed.iter().filter(turned).count() {
        0 => return Facing { inside: Some(Inside::Negative), turned: Vec::new(), body_of },
        count if count == closed.len() => Inside::Positive,
        _ => Inside::Both,
    };
    let is_turned: Vec<bool> = (0..parts.len())
        .map(|k| if parts[k].is_closed { is_inward(outer[k]) } else { inside == Inside::Positive })
        .collect();
    let turned = part_of.iter().map(|&part| is_turned.get(part as usize).copied().unwrap_or(false));
    Facing { turned: turned.collect(), inside: Some(inside), body_of }
}

/// The parts of a mesh, which are the components of its topology.
async fn parts(position: &[Vec3], triangles: &[[u32; 3]], topology: &Topology) -> Vec<Part> {
    let part_of = &topology.component_of;
    let mut parts: Vec<Option<Part>> = topology.components.iter().map(|_| None).collect();
    for slice in triangles.chunks(LIGHT) {
        for &triangle in slice {
            let first = triangle[0] as usize;
            let origin = position[first].as_dvec3();
            let part = parts[part_of[first] as usize].get_or_insert(Part {
                origin,
                volume: 0.0,
                is_closed: true,
                last: first as u32,
            });
            let [a, b, c] = triangle.map(|v| position[v as usize].as_dvec3() - part.origin);
            part.volume += a.dot(b.cross(c)) / 6.0;
            for v in triangle {
                if position[v as usize].x > position[part.last as usize].x {
                    part.last = v;
                }
            }
        }
        pause().await;
    }
    // Every component has a triangle.
    let mut parts: Vec<Part> = parts.into_iter().flatten().collect();
    for &[a, _] in &topology.lone_edges {
        parts[part_of[a as usize] as usize].is_closed = false;
    }
    // An edge of more than two triangles may still have as many in each direction.
    let mut is_crowded = vec![false; parts.len()];
    topology.crowded_edges.iter().for_each(|&[a, _]| is_crowded[part_of[a as usize] as usize] = true);
    if is_crowded.contains(&true) {
        let mut sides: Vec<(u64, i32)> = Vec::new();
        for &[a, b, c] in
            triangles.iter().filter(|triangle| is_crowded[part_of[triangle[0] as usize] as usize])
        {
            for (v, w) in [(a, b), (b, c), (c, a)] {
                sides.push((u64::from(v.min(w)) << 32 | u64::from(v.max(w)), if v < w { 1 } else { -1 }));
            }
        }
        pause().await;
        sort_by_key(&mut sides, |side| side.0);
        for of_edge in sides.chunk_by(|one, other| one.0 == other.0) {
            if of_edge.iter().map(|side| side.1).sum::<i32>() != 0 {
                parts[part_of[(of_edge[0].0 >> 32) as usize] as usize].is_closed = false;
            }
        }
    }
    // A part without a volume has no inside.
    parts.iter_mut().for_each(|part| part.is_closed &= part.volume.abs() > 0.0);
    parts
}

/// Which parts contain others.
struct Nesting {
    /// For each part, the outermost closed part that contains it: itself if there is none, or if it
    /// is open.
    outer: Vec<usize>,
    /// See [`Facing::body_of`].
    body_of: Vec<u32>,
}

async fn nesting(position: &[Vec3], triangles: &[[u32; 3]], parts: &[Part], part_of: &[u32]) -> Nesting {
    // Rays along x from the last vertices of the closed parts, by their y.
    let mut rays: Vec<(Vec3, u32)> = (0..)
        .zip(parts)
        .filter(|(_, part)| part.is_closed)
        .map(|(k, part)| (position[part.last as usize], k))
        .collect();
    sort_by_key(&mut rays, |(p, _)| key_of(p.y.into()));
    // Pairs of the part of a ray and a part that it meets, one for each intersection.
    let mut met: Vec<[u32; 2]> = Vec::new();
    for slice in triangles.chunks(LIGHT) {
        for triangle in slice {
            let holder = part_of[triangle[0] as usize];
            if !parts[holder as usize].is_closed {
                continue;
            }
            let corners = triangle.map(|v| position[v as usize]);
            let low = corners[0].min(corners[1]).min(corners[2]);
            let high = corners[0].max(corners[1]).max(corners[2]);
            let from = rays.partition_point(|(p, _)| p.y < low.y);
            for &(p, part) in rays[from..].iter().take_while(|(p, _)| p.y <= high.y) {
                if part != holder && (low.z..=high.z).contains(&p.z) && p.x < high.x && is_met(corners, p) {
                    met.push([part, holder]);
                }
            }
        }
        pause().await;
    }
    sort_pairs(&mut met);
    let holders: Vec<[u32; 2]> =
        met.chunk_by(|a, b| a == b).filter(|times| times.len() % 2 == 1).map(|times| times[0]).collect();
    let holders_of = |part: u32| {
        let from = holders.partition_point(|pair| pair[0] < part);
        holders[from..].iter().take_while(move |pair| pair[0] == part).map(|pair| pair[1])
    };
    let depth = |part: u32| holders_of(part).count();
    let outer = |part: u32| holders_of(part).find(|&holder| depth(holder) == 0);
    // Walls alternate from outside to inside: of a body, of its hollow, of a body in the hollow.
    let wall =
        |part: u32| holders_of(part).find(|&holder| depth(part) % 2 == 1 && depth(holder) + 1 == depth(part));
    let all = 0..parts.len() as u32;
    Nesting {
        outer: all.clone().map(|part| outer(part).unwrap_or(part) as usize).collect(),
        body_of: all.map(|part| wall(part).unwrap_or(part)).collect(),
    }
}

/// Whether the ray along x from a point meets a triangle. A ray meets a closed mesh an odd number
/// of times if and only if it begins inside, even if it runs through edges and corners: each side
/// counts by a rule that is the same for both of its triangles.
fn is_met(corners: [Vec3; 3], p: Vec3) -> bool {
    let [a, b, c] = corners.map(|corner| (corner - p).as_dvec3());
    // Whether the ray from p along y, in the plane of y and z, crosses a side.
    let crosses = |a: DVec3, b: DVec3| {
        let (low, high) = if a.z < b.z { (a, b) } else { (b, a) };
        low.z <= 0.0 && 0.0 < high.z && {
            let share = -low.z / (high.z - low.z);
            low.y + share * (high.y - low.y) > 0.0
        }
    };
    if !(crosses(a, b) ^ crosses(b, c) ^ crosses(c, a)) {
        return false;
    }
    let normal = (b - a).cross(c - a);
    // The x at which the plane of the triangle meets the ray.
    let x = a.dot(normal) / normal.x;
    if x.is_finite() { x > 0.0 } else { a.x.max(b.x).max(c.x) > 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slices::complete;

    const OUTWARD: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

    /// A mesh of tetrahedra: each has a middle and a size, and faces outward or inward.
    #[derive(Default)]
    struct Tetrahedra {
        position: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
    }

    impl Tetrahedra {
        fn with(mut self, middle: [f32; 3], size: f32, faces_outward: bool) -> Self {
            let first = self.position.len() as u32;
            let corners = [[-1.0, -1.0, -1.0], [3.0, -1.0, -1.0], [-1.0, 3.0, -1.0], [-1.0, -1.0, 3.0]];
            let middle = Vec3::from_array(middle);
            self.position.extend(corners.map(|corner| middle + size * Vec3::from_array(corner)));
            self.triangles.extend(OUTWARD.map(|[a, b, c]| {
                let triangle = if faces_outward { [a, b, c] } else { [a, c, b] };
                triangle.map(|v| first + v)
            }));
            self
        }

        /// Without the last face.
        fn opened(mut self) -> Self {
            self.triangles.pop();
            self
        }

        /// For each tetrahedron, whether it must be turned, and the sign inside.
        fn facing(&self) -> (Vec<bool>, Option<Inside>) {
            let topology = Topology::new(&self.triangles, self.position.len());
            let Facing { turned, inside, .. } = complete(facing(&self.position, &self.triangles, &topology));
            assert!(turned.chunks(4).all(|of_part| of_part.iter().all(|&t| t == of_part[0])));
            (turned.into_iter().step_by(4).collect(), inside)
        }
    }

    #[test]
    fn a_closed_part_that_faces_inward_is_turned() {
        let one = |faces_outward| Tetrahedra::default().with([0.3, 2.0, 1.0], 1.0, faces_outward);
        assert_eq!(one(true).facing(), (vec![], Some(Inside::Negative)));
        assert_eq!(one(false).facing(), (vec![true], Some(Inside::Positive)));
        assert_eq!(one(false).opened().facing(), (vec![], None));
        assert_eq!(Tetrahedra::default().facing(), (vec![], None));
    }

    #[test]
    fn walls_of_a_hollow_are_turned_together() {
        let around = [0.0; 3];
        // Also if the ray from the inner wall runs through a corner of the outer one.
        for inner in [around, [0.1, -0.2, 0.05], [0.0, 0.0, -0.75]] {
            let hollow = |outer: bool| {
                Tetrahedra::default().with(inner, 0.25, !outer).with(around, 1.0, outer).with(
                    [10.0, 0.0, 0.0],
                    1.0,
                    outer,
                )
            };
            assert_eq!(hollow(true).facing(), (vec![], Some(Inside::Negative)), "{inner:?}");
            assert_eq!(hollow(false).facing(), (vec![true; 3], Some(Inside::Positive)), "{inner:?}");
        }
        // A ball in the hollow, and a hollow in the ball.
        for outer in [false, true] {
            let onion = Tetrahedra::default()
                .with(around, 1.0, outer)
                .with(around, 0.7, !outer)
                .with(around, 0.4, outer)
                .with(around, 0.1, !outer);
            assert_eq!(onion.facing().0, if outer { vec![] } else { vec![true; 4] });
        }
    }

    #[test]
    fn parts_beside_each_other_are_turned_one_by_one() {
        let mixed = Tetrahedra::default()
            .with([0.0; 3], 1.0, true)
            .with([10.0, 0.0, 0.0], 1.0, false)
            .with([10.0, 0.0, 0.0], 0.5, true)
            .with([20.0, 0.0, 0.0], 1.0, false)
            .opened();
        assert_eq!(mixed.facing(), (vec![false, true, true, false], Some(Inside::Both)));
    }

    #[test]
    fn open_parts_are_turned_with_the_closed_ones() {
        let beside =
            Tetrahedra::default().with([0.0; 3], 1.0, false).with([10.0, 0.0, 0.0], 1.0, false).opened();
        assert_eq!(beside.facing(), (vec![true; 2], Some(Inside::Positive)));
    }

    #[test]
    fn parts_that_share_an_edge_are_closed() {
        // Two tetrahedra with a common edge, of four triangles.
        let mut pair = Tetrahedra::default().with([0.0; 3], 1.0, false).with([0.0; 3], -1.0, true);
        let shared = |v: u32| match v {
            4 => 0,
            5 => 1,
            v => v,
        };
        pair.triangles.iter_mut().flatten().for_each(|v| *v = shared(*v));
        pair.position[6] = Vec3::new(0.0, -4.0, -1.0);
        pair.position[7] = Vec3::new(0.0, -1.0, -4.0);
        let topology = Topology::new(&pair.triangles, 8);
        assert!(!topology.crowded_edges.is_empty());
        let found = complete(facing(&pair.position, &pair.triangles, &topology));
        assert!(found.inside.is_some(), "{found:?}");
        pair.triangles.pop();
        let topology = Topology::new(&pair.triangles, 8);
        assert_eq!(complete(facing(&pair.position, &pair.triangles, &topology)).inside, None);
    }
}
