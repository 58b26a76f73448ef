//! A tree of boxes over triangles: finds the nearest one, those in a box, and the winding number.

use crate::math::{Bounds, key_of, sort_by_key};
use glam::DVec3;

/// Triangles in a leaf. Fewer take more memory; more are tested in vain.
const LEAF: usize = 6;
/// A node farther away than this many of its radii counts as a single dipole in the winding number,
/// which is then off by some hundredths (G. Barill et al., "Fast Winding Numbers for Soups and
/// Clouds", 2018, use 2).
const FAR: f64 = 2.0;

/// The point of a triangle that is nearest to a given point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// The squared distance.
    pub(super) distance_sq: f64,
    /// Index of the triangle in the list given to the tree.
    pub(super) triangle: u32,
    pub(super) point: DVec3,
}

struct Node {
    bounds: Bounds,
    /// The triangles of a leaf; `count` is 0 for other nodes.
    first: u32,
    count: u32,
    /// The second child; the first one is the next node.
    right: u32,
    /// The dipole: mean position, sum of the area vectors, and largest distance of a corner.
    centre: DVec3,
    area: DVec3,
    radius: f64,
}

/// The tree.
pub(super) struct Tree {
    nodes: Vec<Node>,
    number: Vec<u32>,
    corners: Vec<[DVec3; 3]>,
}

/// Triangles that are still to become a node.
struct Open {
    first: usize,
    count: usize,
    /// The node of which this becomes the second child.
    parent: Option<usize>,
}

impl Tree {
    /// The tree of these triangles, which are identified by their index. A triangle with two equal
    /// corners stands for a segment.
    pub(super) fn new(corners: &[[DVec3; 3]]) -> Self {
        let mut tree =
            Self { nodes: Vec::new(), number: (0..corners.len() as u32).collect(), corners: Vec::new() };
        let middle = |t: u32| corners[t as usize].iter().sum::<DVec3>() / 3.0;
        let mut open = vec![Open { first: 0, count: corners.len(), parent: None }];
        while let Some(Open { first, count, parent }) = open.pop() {
            let place = tree.nodes.len();
            if let Some(parent) = parent {
                tree.nodes[parent].right = place as u32;
            }
            let own = &mut tree.number[first..first + count];
            tree.nodes.push(node(own, first, corners));
            if count <= LEAF {
                continue;
            }
            tree.nodes[place].count = 0;
            let size = Bounds::around(own.iter().map(|&t| middle(t))).size();
            let axis = (0..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
            sort_by_key(own, |&t| key_of(middle(t)[axis]));
            let half = count / 2;
            open.push(Open { first: first + half, count: count - half, parent: Some(place) });
            open.push(Open { first, count: half, parent: None });
        }
        tree.corners = tree.number.iter().map(|&t| corners[t as usize]).collect();
        tree
    }

    /// The nearest point of the triangles for which `is_meant` holds, if its squared distance is at
    /// most `most`.
    pub(super) fn nearest_of(
        &self,
        p: DVec3,
        mut most: f64,
        is_meant: impl Fn(u32) -> bool,
    ) -> Option<Nearest> {
        let mut best: Option<Nearest> = None;
        let mut stack = [(0_u32, 0.0_f64); 64];
        let mut top = usize::from(!self.number.is_empty());
        stack[0] = (0, distance_sq(&self.nodes[0].bounds, p));
        while top > 0 {
            top -= 1;
            let (place, away) = stack[top];
            if away > most {
                continue;
            }
            let node = &self.nodes[place as usize];
            for k in node.first as usize..(node.first + node.count) as usize {
                if !is_meant(self.number[k]) {
                    continue;
                }
                let point = nearest_on(p, self.corners[k]);
                let distance_sq = point.distance_squared(p);
                let is_nearer = match &best {
                    None => distance_sq <= most,
                    Some(best) => distance_sq < most || distance_sq == most && self.number[k] < best.triangle,
                };
                if is_nearer {
                    most = distance_sq;
                    best = Some(Nearest { distance_sq, triangle: self.number[k], point });
                }
            }
            if node.count == 0 {
                let mut children = [place + 1, node.right]
                    .map(|child| (child, distance_sq(&self.nodes[child as usize].bounds, p)));
                if children[0].1 < children[1].1 {
                    children.swap(0, 1);
                }
                // The nearer child is visited first.
                stack[top..top + 2].copy_from_slice(&children);
                top += 2;
            }
        }
        best
    }

    /// The nearest point of all triangles; there is at least one.
    pub(super) fn nearest(&self, p: DVec3) -> Nearest {
        let far = Nearest { distance_sq: f64::INFINITY, triangle: 0, point: DVec3::NAN };
        self.nearest_of(p, f64::INFINITY, |_| true).unwrap_or(far)
    }

    /// Calls `each` for every triangle whose squared distance is at most `most`, with its nearest
    /// point.
    pub(super) fn within(&self, p: DVec3, most: f64, mut each: impl FnMut(Nearest)) {
        self.descend(
            |bounds| distance_sq(bounds, p) <= most,
            |triangle, corners| {
                let point = nearest_on(p, *corners);
                let distance_sq = point.distance_squared(p);
                if distance_sq <= most {
                    each(Nearest { distance_sq, triangle, point });
                }
            },
        );
    }

    /// Calls `each` with every triangle whose box meets this one.
    pub(super) fn in_box(&self, bounds: &Bounds, mut each: impl FnMut(u32)) {
        self.descend(
            |own| !own.is_apart_from(bounds),
            |triangle, corners| {
                if !Bounds::around(*corners).is_apart_from(bounds) {
                    each(triangle);
                }
            },
        );
    }

    fn descend(&self, opens: impl Fn(&Bounds) -> bool, mut each: impl FnMut(u32, &[DVec3; 3])) {
        let mut stack = [0_u32; 64];
        let mut top = usize::from(!self.number.is_empty());
        while top > 0 {
            top -= 1;
            let place = stack[top];
            let node = &self.nodes[place as usize];
            if !opens(&node.bounds) {
                continue;
            }
            for k in node.first as usize..(node.first + node.count) as usize {
                each(self.number[k], &self.corners[k]);
            }
            if node.count == 0 {
                stack[top..top + 2].copy_from_slice(&[node.right, place + 1]);
                top += 2;
            }
        }
    }

    /// The generalised winding number: 1 inside a closed surface whose faces are oriented outward,
    /// 0 outside, and between them near missing faces (A. Jacobson et al., "Robust Inside-Outside
    /// Segmentation Using Generalized Winding Numbers", 2013).
    pub(super) fn winding(&self, p: DVec3) -> f64 {
        let mut sum = 0.0;
        let mut stack = [0_u32; 64];
        let mut top = usize::from(!self.number.is_empty());
        while top > 0 {
            top -= 1;
            let place = stack[top];
            let node = &self.nodes[place as usize];
            let way = node.centre - p;
            let length = way.length();
            if length > FAR * node.radius {
                sum += node.area.dot(way) / (length * length * length);
                continue;
            }
            for k in node.first as usize..(node.first + node.count) as usize {
                sum += solid_angle(self.corners[k].map(|corner| corner - p));
            }
            if node.count == 0 {
                stack[top..top + 2].copy_from_slice(&[node.right, place + 1]);
                top += 2;
            }
        }
        sum / (4.0 * core::f64::consts::PI)
    }
}

/// The node of these triangles, as if it were a leaf.
fn node(own: &[u32], first: usize, corners: &[[DVec3; 3]]) -> Node {
    let all = || own.iter().map(|&t| corners[t as usize]);
    let bounds = Bounds::around(all().flatten());
    let (mut area, mut total, mut centre) = (DVec3::ZERO, 0.0, DVec3::ZERO);
    for [a, b, c] in all() {
        let vector = 0.5 * (b - a).cross(c - a);
        let size = vector.length();
        area += vector;
        total += size;
        centre += size * (a + b + c) / 3.0;
    }
    let centre = if total > 0.0 { centre / total } else { bounds.middle() };
    let radius = all().flatten().map(|corner| corner.distance(centre)).fold(0.0, f64::max);
    Node { bounds, first: first as u32, count: own.len() as u32, right: 0, centre, area, radius }
}

/// The squared distance from `p` to a box.
fn distance_sq(bounds: &Bounds, p: DVec3) -> f64 {
    (bounds.lo() - p).max(p - bounds.hi()).max(DVec3::ZERO).length_squared()
}

/// The solid angle under which a triangle is seen from the origin (A. van Oosterom & J. Strackee,
/// "The Solid Angle of a Plane Triangle", 1983).
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let [u, v, w] = [a, b, c].map(DVec3::length);
    let across = u * v * w + a.dot(b) * w + b.dot(c) * u + c.dot(a) * v;
    2.0 * libm::atan2(a.dot(b.cross(c)), across)
}

/// The point of a triangle that is nearest to `p` (C. Ericson, "Real-Time Collision Detection",
/// 2005, §5.1.5). Its corners may coincide.
pub(super) fn nearest_on(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let sum = va + vb + vc;
    a + ab * (vb / sum) + ac * (vc / sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_core::{Rng, SeedableRng};
    use rand_pcg::Pcg32;

    /// Random triangles, and places around them.
    fn soup() -> (Vec<[DVec3; 3]>, Vec<DVec3>) {
        let mut random = Pcg32::seed_from_u64(11);
        let mut unit = move || f64::from(random.next_u32()) / f64::from(u32::MAX);
        let mut point = move |size: f64| size * (DVec3::new(unit(), unit(), unit()) - 0.5);
        let triangles = (0..200).map(|_| {
            let middle = point(2.0);
            core::array::from_fn(|_| middle + point(0.4))
        });
        let triangles: Vec<[DVec3; 3]> = triangles.collect();
        (triangles, (0..200).map(|_| point(4.0)).collect())
    }

    #[test]
    fn nearest_is_that_of_all_triangles() {
        let (triangles, places) = soup();
        let tree = Tree::new(&triangles);
        for p in places {
            let found = tree.nearest(p);
            // The least over a fine grid of each triangle is no less, and hardly more.
            let mut least = f64::INFINITY;
            for [a, b, c] in &triangles {
                for i in 0..=40 {
                    for j in 0..=40 - i {
                        let (u, v) = (f64::from(i) / 40.0, f64::from(j) / 40.0);
                        least = least.min((*a + u * (*b - *a) + v * (*c - *a)).distance(p));
                    }
                }
            }
            let distance = found.distance_sq.sqrt();
            assert!(distance <= least + 1e-12 && distance >= least - 0.02, "{p}: {distance} {least}");
            assert!((found.point.distance(p) - distance).abs() < 1e-12);
            let mut count = 0;
            tree.within(p, found.distance_sq, |_| count += 1);
            assert_eq!(count, 1);
        }
    }

    #[test]
    fn winding_number_is_the_sum_of_all_solid_angles() {
        let (triangles, places) = soup();
        let tree = Tree::new(&triangles);
        for p in places {
            let angles = triangles.iter().map(|corners| solid_angle(corners.map(|corner| corner - p)));
            let all = angles.sum::<f64>() / (4.0 * core::f64::consts::PI);
            assert!((tree.winding(p) - all).abs() < 0.02, "{p}");
        }
    }
}
