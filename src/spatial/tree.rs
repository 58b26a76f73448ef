//! A balanced tree of bounding boxes over points. The cost of a nearest-neighbour query depends
//! neither on the distribution of the points nor on distant outliers. Points around a leaf are
//! gathered once, in lanes.

use crate::math::{LANES, Lanes, key, signed_key, sort_few, unkey};
use crate::slices::{self, LIGHT, pause};
use glam::{Vec3, Vec4};

/// Largest number of points in a leaf; a leaf holds at least half as many, so the candidates of a
/// whole leaf can be gathered once.
const LEAF: usize = 16;
/// Depth of the traversal stack: a balanced tree over 2³² points has fewer than 33 levels.
const STACK: usize = 64;

#[derive(Clone, Copy, Debug)]
struct TreeNode {
    /// Corners of the bounding box, each padded by a 0.
    lo: Vec4,
    hi: Vec4,
    first: u32,
    end: u32,
    /// Index of the second child (the first one follows its parent); 0 for a leaf.
    second: u32,
}

impl TreeNode {
    /// Returns the squared distance from `p` to the box; 0 inside.
    #[inline]
    fn distance_sq(&self, p: Vec4) -> f32 {
        (self.lo - p).max(p - self.hi).max(Vec4::ZERO).truncate().length_squared()
    }
}

/// A few points that are near one another.
#[derive(Clone, Debug)]
pub(crate) struct Leaf {
    /// The points, in tree order.
    pub(crate) range: core::ops::Range<usize>,
    /// Smallest corner of their box.
    pub(crate) lo: Vec3,
    /// Largest corner of their box.
    pub(crate) hi: Vec3,
}

impl Leaf {
    /// Radius of the first ball that is searched around each of the points.
    pub(crate) fn reach(&self) -> f32 {
        /// Share of the diagonal of the box. A leaf of 8 to 16 points of spacing d spans 3 to 5 d,
        /// so the ball reaches 1.4 to 2.2 d, and few points need a second one. A larger ball would
        /// hold more useless points.
        const SHARE: f32 = 0.45;
        SHARE * (self.hi - self.lo).length()
    }
}

/// Points in tree order: the points of a leaf are contiguous, and leaves near one another are near
/// in memory.
#[derive(Debug)]
pub(crate) struct Tree {
    /// The points, in tree order.
    pub(crate) position: Vec<Vec3>,
    /// For each point in tree order, its index as given.
    pub(crate) origin: Vec<u32>,
    nodes: Vec<TreeNode>,
}

impl Tree {
    /// Makes the tree over `points`, which must be finite.
    pub(crate) fn new(points: &[Vec3]) -> Self {
        Self::of(points.iter().copied().zip(0..).collect())
    }

    /// Makes the tree over points with their indices. The points must be finite.
    pub(crate) fn of(items: Vec<(Vec3, u32)>) -> Self {
        slices::complete(Self::in_slices(items))
    }

    /// Makes the tree over points with their indices in slices of work, the largest of which visits
    /// all points once. The points must be finite. The result depends only on points and indices.
    pub(crate) async fn in_slices(mut items: Vec<(Vec3, u32)>) -> Self {
        let mut nodes = Vec::with_capacity(items.len() / 4 + 1);
        // Ranges that still have to become nodes, each with the node whose second child it is.
        let mut open = vec![(0..items.len(), None)];
        let mut splitter = Splitter::default();
        let mut seen = 0;
        while let Some((range, parent)) = open.pop().filter(|(range, _)| !range.is_empty()) {
            let node = nodes.len();
            if let Some(parent) = parent {
                let parent: &mut TreeNode = &mut nodes[parent];
                parent.second = node as u32;
            }
            nodes.push(node_of(&items[range.clone()], range.start));
            seen += range.len();
            if range.len() > LEAF {
                let middle = range.start + splitter.split(&mut items[range.clone()], &nodes[node]);
                open.push((middle..range.end, Some(node)));
                open.push((range.start..middle, None));
            } else {
                // The median search leaves an unspecified order; sorting by index makes it our own.
                sort_few(&mut items[range], |a, b| a.1 < b.1);
            }
            if seen >= LIGHT {
                seen = 0;
                pause().await;
            }
        }
        let (position, origin) = items.into_iter().unzip();
        Self { position, origin, nodes }
    }

    /// Returns the number of points.
    pub(crate) fn len(&self) -> usize {
        self.position.len()
    }

    /// Returns all leaves in order.
    pub(crate) fn leaves(&self) -> impl Iterator<Item = Leaf> {
        let leaves = self.nodes.iter().filter(|node| node.second == 0);
        leaves.map(|node| Leaf {
            range: node.first as usize..node.end as usize,
            lo: node.lo.truncate(),
            hi: node.hi.truncate(),
        })
    }

    /// Calls `visit` with the range of every leaf that meets the ball of squared radius `bound_sq`
    /// around `p`, nearer ones first. `visit` may shrink the bound.
    #[inline]
    fn search(&self, p: Vec3, mut bound_sq: f32, mut visit: impl FnMut(u32, u32, &mut f32)) {
        if self.nodes.is_empty() {
            return;
        }
        let mut stack = [(0_u32, 0.0_f32); STACK];
        let mut depth = 1;
        let p = p.extend(0.0);
        stack[0] = (0, self.nodes[0].distance_sq(p));
        while depth > 0 {
            depth -= 1;
            let (index, distance_sq) = stack[depth];
            if distance_sq > bound_sq {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.second == 0 {
                visit(node.first, node.end, &mut bound_sq);
                continue;
            }
            let near = (index + 1, self.nodes[index as usize + 1].distance_sq(p));
            let far = (node.second, self.nodes[node.second as usize].distance_sq(p));
            let (near, far) = if near.1 <= far.1 { (near, far) } else { (far, near) };
            stack[depth] = far;
            stack[depth + 1] = near;
            depth += 2;
        }
    }

    /// Returns the squared distance from `p` to the nearest point other than `except`, and that
    /// point, if the distance is below `bound_sq`; otherwise `bound_sq` and `except`.
    pub(crate) fn nearest(&self, p: Vec3, except: u32, bound_sq: f32) -> (f32, u32) {
        let mut best = (bound_sq, except);
        self.search(p, bound_sq, |first, end, bound| {
            for i in first..end {
                let distance_sq = (self.position[i as usize] - p).length_squared();
                if distance_sq < best.0 && i != except {
                    best = (distance_sq, i);
                }
            }
            *bound = best.0;
        });
        best
    }

    /// Returns the squared distance from `p` to the nearest point other than `except`, if it is
    /// below `bound_sq`; otherwise `bound_sq`.
    pub(crate) fn nearest_sq(&self, p: Vec3, except: u32, bound_sq: f32) -> f32 {
        self.nearest(p, except, bound_sq).0
    }

    /// Replaces `out` by the keys of the `count` nearest points to `p` that pass `accept`, nearest
    /// first.
    pub(crate) fn nearest_many(
        &self,
        p: Vec3,
        count: usize,
        mut accept: impl FnMut(u32) -> bool,
        out: &mut Vec<u64>,
    ) {
        out.clear();
        self.search(p, f32::INFINITY, |first, end, bound| {
            for i in first..end {
                let candidate = key((self.position[i as usize] - p).length_squared(), i);
                let full = out.len() == count;
                if full && out.last().is_some_and(|&last| candidate >= last) || !accept(i) {
                    continue;
                }
                if full {
                    out.pop();
                }
                let place = out.partition_point(|&other| other < candidate);
                out.insert(place, candidate);
                if out.len() == count {
                    *bound = unkey(out[count - 1]).0;
                }
            }
        });
    }

    /// Appends to `out` every point in the closed box from `lo` to `hi`, in tree order.
    pub(crate) fn within_box(&self, lo: Vec3, hi: Vec3, out: &mut Vec<u32>) {
        let mut index = 0;
        let mut stack = [0_u32; STACK];
        let mut depth = 0;
        let (lo, hi) = (lo.extend(0.0), hi.extend(0.0));
        while let Some(node) = self.nodes.get(index as usize) {
            let meets = (node.lo.cmple(hi) & node.hi.cmpge(lo)).all();
            if meets && node.second != 0 {
                stack[depth] = node.second;
                depth += 1;
                index += 1;
                continue;
            }
            if meets {
                // Every point is written, and overwritten by the next if it is not in the box: no
                // branch depends on the point.
                let mut count = out.len();
                out.resize(count + (node.end - node.first) as usize, 0);
                for (i, p) in (node.first..).zip(&self.position[node.first as usize..node.end as usize]) {
                    let p = p.extend(0.0);
                    out[count] = i;
                    count += usize::from((p.cmpge(lo) & p.cmple(hi)).all());
                }
                out.truncate(count);
            }
            if depth == 0 {
                return;
            }
            depth -= 1;
            index = stack[depth];
        }
    }
}

/// The points of a tree in a box.
#[derive(Debug, Default)]
pub(crate) struct PointsInBox {
    /// Indices of the points in tree order.
    pub(crate) index: Vec<u32>,
    /// Coordinates of the points; the last lanes are filled up with points infinitely far away.
    pub(crate) position: Vec<[Lanes; 3]>,
}

impl PointsInBox {
    /// Replaces the content by the points in the closed box from `lo` to `hi`.
    pub(crate) fn gather(&mut self, tree: &Tree, lo: Vec3, hi: Vec3) {
        self.index.clear();
        tree.within_box(lo, hi, &mut self.index);
        self.position.clear();
        self.position.extend(self.index.chunks(LANES).map(|chunk| {
            let mut lanes = [Lanes::splat(f32::INFINITY); 3];
            for (k, &i) in chunk.iter().enumerate() {
                let p = tree.position[i as usize];
                (lanes[0].0[k], lanes[1].0[k], lanes[2].0[k]) = (p.x, p.y, p.z);
            }
            lanes
        }));
    }

    /// Returns the squared distances from `p` in the order of the points, followed by some infinite
    /// ones.
    #[inline]
    pub(crate) fn distances_sq(&self, p: Vec3) -> impl Iterator<Item = Lanes> {
        self.position.iter().map(move |[x, y, z]| {
            let (dx, dy, dz) = (*x - Lanes::splat(p.x), *y - Lanes::splat(p.y), *z - Lanes::splat(p.z));
            dx * dx + dy * dy + dz * dz
        })
    }
}

/// Returns a leaf over `items`, whose first index is `first`.
fn node_of(items: &[(Vec3, u32)], first: usize) -> TreeNode {
    let mut lo = Vec4::INFINITY;
    let mut hi = Vec4::NEG_INFINITY;
    for (p, _) in items {
        let p = p.extend(0.0);
        lo = lo.min(p);
        hi = hi.max(p);
    }
    TreeNode { lo, hi, first: first as u32, end: (first + items.len()) as u32, second: 0 }
}

/// Memory for the splits of a tree.
#[derive(Default)]
struct Splitter {
    keys: Vec<u64>,
    above: Vec<(Vec3, u32)>,
}

impl Splitter {
    /// Splits the `items` of `node` at the median along its longest side, ties by index. Returns
    /// the start of the second part.
    fn split(&mut self, items: &mut [(Vec3, u32)], node: &TreeNode) -> usize {
        match (node.hi - node.lo).truncate().max_position() {
            0 => self.split_along(items, |p| p.x),
            1 => self.split_along(items, |p| p.y),
            _ => self.split_along(items, |p| p.z),
        }
    }

    fn split_along(&mut self, items: &mut [(Vec3, u32)], coordinate: impl Fn(Vec3) -> f32) -> usize {
        let middle = items.len() / 2;
        let key = |&(p, i): &(Vec3, u32)| signed_key(coordinate(p), i);
        self.keys.clear();
        self.keys.extend(items.iter().map(key));
        let (_, &mut pivot, _) = self.keys.select_nth_unstable(middle);
        // Every item is written to both parts, of which one then grows: no branch depends on it.
        self.above.resize(items.len() + 1, (Vec3::ZERO, 0));
        let (mut below, mut above) = (0, 0);
        for k in 0..items.len() {
            let item = items[k];
            let is_below = key(&item) < pivot;
            items[below] = item;
            self.above[above] = item;
            below += usize::from(is_below);
            above += usize::from(!is_below);
        }
        items[below..].copy_from_slice(&self.above[..above]);
        middle
    }
}
