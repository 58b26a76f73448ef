//! Uses each point's neighbours to estimate missing normals, correct the signs of given ones, and
//! find outliers.
//!
//! The normal of a point is perpendicular to the plane through its neighbours. Its sign is
//! propagated from point to point (H. Hoppe, T. DeRose, T. Duchamp, J. McDonald & W. Stuetzle,
//! "Surface Reconstruction from Unorganized Points", SIGGRAPH 1992, §3.2 and 3.3).
//!
//! # Differences from the paper
//!
//! * A normal that is propagated along an edge is first reflected in the plane that bisects the
//!   edge; the weight of the edge is the difference of the two normals after that.
//! * The graph connects every point to its nearest neighbours, without the edges of a Euclidean
//!   minimum spanning tree. Each connected component is oriented separately.
//! * The outermost points in six directions decide together which side is outside, not the highest
//!   point alone.

use super::thin::covariance;
use super::{Cloud, NormalSource, eigen};
use crate::math::{Bounds, median, significant, unkey};
use crate::slices::{HEAVY, MEDIUM, pause, ranges};
use crate::spatial::tree::Tree;
use core::cmp::Reverse;
use glam::DVec3;
use std::collections::BinaryHeap;

/// Number of neighbours to which a plane is fitted. Fewer: planes follow the noise. More: they
/// reach the other side of thin parts.
const NEIGHBOURS: usize = 12;

/// How often the number of a plane's neighbours may be doubled where points are noisy.
const WIDENINGS: u32 = 4;
/// Number of planes whose flatness is compared.
const COMPARED: usize = 500;
/// Least kurtosis of the distances from planes that are thick because of noise. It is 3 for a
/// normal distribution, 1.8 for a cap of constant curvature, where the distances are spread evenly,
/// and 1 for points on two sheets, one on each side of the plane.
const NOISE_KURTOSIS: f64 = 2.0;

/// Cosine of 120°. Neighbours whose normals make a larger angle are on different sheets, or one has
/// the wrong sign. The repulsion of particles uses the same angle.
const OPPOSITE_COS: f64 = -0.5;

/// A point is an outlier if the median distance to its neighbours exceeds this many times the
/// medians of its neighbours and of all points.
const FAR: f64 = 5.0;
/// A given normal is reversed if the neighbours that disagree with it outweigh those that agree by
/// more than this share of their total weight. Smaller: right normals of thin plates are reversed;
/// larger: some wrong ones stay.
const DISAGREEING: f64 = 0.3;
/// Most rounds in which all given normals are compared with their neighbours; each reversal makes
/// its surroundings clearer. The limit is for clouds that never settle, since a point need not be a
/// neighbour of its neighbours.
const MOST_ROUNDS: u32 = 16;

/// Share of neighbours with opposite normals above which the user is warned. A choice.
const WARN_SHARE: f64 = 0.01;

/// Changes to a cloud of points, for the user.
#[derive(Clone, Debug, Default)]
pub struct Changes {
    /// Points that were left out because they are far from all others.
    pub outliers: Vec<DVec3>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

/// Removes the outliers of a cloud. Then estimates its normals, outward, or reverses given ones
/// that disagree with their neighbours. The points must be distinct and not coplanar. `tell` gets
/// the completed fraction of the points.
pub async fn settle(cloud: &mut Cloud, tell: impl Fn(f64)) -> Changes {
    let mut settled = Changes::default();
    let mut graph = NeighbourGraph::new(&cloud.position, tell).await;
    let is_outlier = graph.outliers();
    let count = is_outlier.iter().filter(|&&is_outlier| is_outlier).count();
    if count > 0 {
        let of_kind = |kind: bool| -> Vec<u32> {
            (0..cloud.len() as u32).filter(|&i| is_outlier[i as usize] == kind).collect()
        };
        settled.outliers = cloud.only(&of_kind(true)).position;
        *cloud = cloud.only(&of_kind(false));
        let [x, y, z] = settled.outliers[0].to_array().map(significant);
        let are = if count == 1 { "1 point is" } else { &format!("{count} points are") };
        settled.warnings.push(format!(
            "{are} far from all others, for the distances between those, and left out as noise: the first at ({x}, {y}, {z})."
        ));
        graph = NeighbourGraph::new(&cloud.position, |_| {}).await;
    }
    let warnings = if cloud.normal.is_empty() { estimate(cloud, graph) } else { turn(cloud, graph).await };
    settled.warnings.extend(warnings);
    settled
}

/// Reverses the given normals that disagree with their neighbours. Returns warnings for the user.
async fn turn(cloud: &mut Cloud, mut graph: NeighbourGraph) -> Vec<String> {
    let mut warnings = Vec::new();
    graph.normal.clone_from(&cloud.normal);
    let turned = graph.turn_minority().await;
    if turned > 0 {
        warnings.push(format!(
            "The normals of {turned} of {} points disagree with those of the points around them: they were turned round.",
            cloud.len()
        ));
    }
    let contrary = graph.pairs().filter(|&(i, j)| graph.agreement(i, j) < OPPOSITE_COS).count();
    let share = contrary as f64 / graph.neighbours.len().max(1) as f64;
    if share > WARN_SHARE {
        warnings.push(format!(
            "{:.0} % of neighbouring points have normals that contradict each other for their places: normals are wrong, the points are \
             noisy, or the surface is thinner than they are apart. Expect flaps and holes.",
            100.0 * share
        ));
    }
    cloud.normal = graph.normal;
    warnings
}

/// Takes the normals of the planes through the neighbours, pointing outward. Returns warnings for
/// the user.
fn estimate(cloud: &mut Cloud, mut graph: NeighbourGraph) -> Vec<String> {
    let components = graph.orient();
    let mut warnings = vec![
        "The points have no normals: they were estimated from each point's neighbours, and where the surface is thin or \
         sparsely sampled they can be wrong."
            .to_owned(),
    ];
    if components > 1 {
        warnings.push(format!(
            "The points fall into {components} components without a connection; the normals of each were turned outward by itself."
        ));
    }
    let opposite =
        graph.pairs().filter(|&(i, j)| graph.normal[i].dot(graph.normal[j]) < OPPOSITE_COS).count();
    let share = opposite as f64 / graph.neighbours.len().max(1) as f64;
    if share > WARN_SHARE {
        warnings.push(format!(
            "{:.0} % of neighbouring points have opposite estimated normals: give a file with normals, or more points.",
            100.0 * share
        ));
    }
    cloud.normal = graph.normal;
    cloud.source = NormalSource::Estimated;
    warnings
}

/// Points with normals, each connected to its nearest neighbours.
#[derive(Debug)]
struct NeighbourGraph {
    /// Points relative to the centre of their box, in units of its diagonal.
    local: Vec<DVec3>,
    /// Number of neighbours of each point.
    per_point: usize,
    /// The nearest neighbours of each point in turn, without the point itself.
    neighbours: Vec<u32>,
    /// Normals of the planes through the neighbours.
    normal: Vec<DVec3>,
}

/// The plane through a point and its nearest neighbours.
struct Plane {
    mean: DVec3,
    normal: DVec3,
    /// Variance across the plane divided by the smaller variance along it.
    variation: f64,
}

impl Plane {
    /// The plane through point `i` and `count` neighbours, which are returned in `nearest`.
    fn around(local: &[DVec3], tree: &Tree, i: usize, count: usize, nearest: &mut Vec<u32>) -> Self {
        let p = local[i];
        let mut keys = Vec::new();
        tree.nearest_many(p.as_vec3(), count + 1, |_| true, &mut keys);
        nearest.clear();
        // If points coincide in single precision, the point itself may not be among its nearest
        // ones.
        let others = keys.iter().map(|&key| tree.origin[unkey(key).1 as usize]).filter(|&j| j as usize != i);
        nearest.extend(others.take(count));
        let near = || core::iter::once(p).chain(nearest.iter().map(|&j| local[j as usize]));
        let mean = near().sum::<DVec3>() / (nearest.len() + 1) as f64;
        let ([across, along, _], axes) = eigen::symmetric(&covariance(near(), mean));
        let variation = if along > 0.0 { across / along } else { 0.0 };
        Self { mean, normal: axes[0].normalize_or(DVec3::Z), variation }
    }
}

/// The number of neighbours for which planes are flattest relative to their width: noise thickens
/// narrow ones, curvature wide ones (M. Pauly, R. Keiser & M. Gross, "Multi-scale Feature
/// Extraction on Point-Sampled Surfaces", 2003, §3). Without noise it is [`NEIGHBOURS`]. A plane
/// between two sheets does not count as noisy.
async fn flattest(local: &[DVec3], tree: &Tree) -> usize {
    let (mut best, mut least, mut nearest) = (0, f64::INFINITY, Vec::new());
    let step = local.len().div_ceil(COMPARED).max(1);
    for doublings in 0..=WIDENINGS {
        let count = (NEIGHBOURS << doublings).min(local.len().saturating_sub(1));
        let (mut variation, mut kurtosis) = (0.0, 0.0);
        for i in (0..local.len()).step_by(step) {
            let plane = Plane::around(local, tree, i, count, &mut nearest);
            variation += plane.variation;
            let across = nearest.iter().map(|&j| (local[j as usize] - plane.mean).dot(plane.normal));
            let [square, fourth] =
                across.map(|d| d * d).fold([0.0, 0.0], |[square, fourth], d| [square + d, fourth + d * d]);
            if square > 0.0 {
                kurtosis += fourth * count as f64 / (square * square);
            }
            pause().await;
        }
        let is_noise = kurtosis > NOISE_KURTOSIS * local.len().div_ceil(step) as f64;
        if variation < least && (is_noise || doublings == 0) {
            (best, least) = (count, variation);
        }
    }
    best
}

impl NeighbourGraph {
    /// Fits a plane to the neighbours of each point.
    async fn new(points: &[DVec3], tell: impl Fn(f64)) -> Self {
        let bounds = Bounds::around(points.iter().copied());
        let (middle, unit) = (bounds.middle(), bounds.diagonal());
        let local: Vec<DVec3> = points.iter().map(|p| (*p - middle) / unit).collect();
        let single: Vec<_> = local.iter().map(|p| p.as_vec3()).collect();
        let tree = Tree::new(&single);
        let per_point = NEIGHBOURS.min(points.len().saturating_sub(1));
        let wide = flattest(&local, &tree).await;
        let (mut neighbours, mut normal, mut flat, mut nearest) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for range in ranges(points.len(), HEAVY) {
            tell(range.start as f64 / points.len() as f64);
            for i in range {
                let plane = Plane::around(&local, &tree, i, wide, &mut nearest);
                neighbours.extend(nearest.iter().take(per_point));
                normal.push(plane.normal);
                flat.push(local[i] - plane.normal * (local[i] - plane.mean).dot(plane.normal));
            }
            pause().await;
        }
        // Without noise the points themselves are nearer to the surface than the planes are.
        Self { local: if wide > per_point { flat } else { local }, per_point, neighbours, normal }
    }

    /// Whether each point is far from all others, compared with the distances between those.
    fn outliers(&self) -> Vec<bool> {
        let of_neighbours = |i: usize, value: &dyn Fn(usize) -> f64| {
            let near = &self.neighbours[i * self.per_point..(i + 1) * self.per_point];
            median(near.iter().map(|&j| value(j as usize)).collect()).unwrap_or(0.0)
        };
        let all = 0..self.local.len();
        let distance = |i: usize| of_neighbours(i, &|j| self.local[i].distance(self.local[j]));
        let reach: Vec<f64> = all.clone().map(distance).collect();
        let usual = median(reach.clone()).unwrap_or(0.0);
        let is_far = |i: usize| reach[i] > FAR * usual.max(of_neighbours(i, &|j| reach[j]));
        all.map(is_far).collect()
    }

    /// Reverses normals that disagree with their neighbours until none is left. Returns their
    /// number.
    async fn turn_minority(&mut self) -> usize {
        let mut is_turned = vec![false; self.local.len()];
        for _ in 0..MOST_ROUNDS {
            let mut is_settled = true;
            for range in ranges(self.local.len(), MEDIUM) {
                for i in range {
                    let near = &self.neighbours[i * self.per_point..(i + 1) * self.per_point];
                    let (mut sum, mut weight) = (0.0, 0.0);
                    for &j in near {
                        let agreement = self.agreement(i, j as usize);
                        (sum, weight) = (sum + agreement, weight + agreement.abs());
                    }
                    if sum < -DISAGREEING * weight {
                        self.normal[i] = -self.normal[i];
                        is_turned[i] = !is_turned[i];
                        is_settled = false;
                    }
                }
                pause().await;
            }
            if is_settled {
                break;
            }
        }
        is_turned.iter().filter(|&&is_turned| is_turned).count()
    }

    /// Pairs of a point and one of its neighbours.
    fn pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        let per_point = self.per_point.max(1);
        self.neighbours.iter().enumerate().map(move |(k, &j)| (k / per_point, j as usize))
    }

    /// Orients the normals and returns the number of connected components of the graph.
    ///
    /// The sign is propagated along the minimum spanning tree with weights 1 − |agreement| (Prim's
    /// algorithm), so it follows the most certain edges. Each component is then turned outward.
    fn orient(&mut self) -> usize {
        let mut joined = vec![Vec::new(); self.local.len()];
        for (i, j) in self.pairs() {
            joined[i].push(j);
            joined[j].push(i);
        }
        let mut reached = vec![false; self.local.len()];
        let mut queue = BinaryHeap::new();
        let mut component = Vec::new();
        let mut components = 0;
        for start in 0..self.local.len() {
            if reached[start] {
                continue;
            }
            components += 1;
            component.clear();
            // Bits of weights sort like the weights, which are not negative. Ties go to the smaller
            // index.
            queue.push(Reverse((0_u64, start, start)));
            while let Some(Reverse((_, i, from))) = queue.pop() {
                if reached[i] {
                    continue;
                }
                reached[i] = true;
                component.push(i);
                if self.agreement(from, i) < 0.0 {
                    self.normal[i] = -self.normal[i];
                }
                for &j in &joined[i] {
                    if !reached[j] {
                        let weight = (1.0 - self.agreement(i, j).abs()).max(0.0);
                        queue.push(Reverse((weight.to_bits(), j, i)));
                    }
                }
            }
            if self.points_inward(&component) {
                for &i in &component {
                    self.normal[i] = -self.normal[i];
                }
            }
        }
        components
    }

    /// Cosine of the angle between the normal of point `j` and that of point `i` after reflection
    /// in the plane that bisects the two points.
    ///
    /// On a circle the reflection gives exactly the normal of `j`. On the other side of a thin part
    /// it gives the opposite of the normal at `i`, as it should.
    fn agreement(&self, i: usize, j: usize) -> f64 {
        let along = (self.local[j] - self.local[i]).normalize_or_zero();
        let carried = self.normal[i] - 2.0 * self.normal[i].dot(along) * along;
        carried.dot(self.normal[j])
    }

    /// Whether the normals at the outermost points of a component, in the six axis directions,
    /// mostly point inward.
    fn points_inward(&self, component: &[usize]) -> bool {
        let mut sum = 0.0;
        for axis in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z] {
            let mut outermost = component[0];
            for &i in component {
                if self.local[i].dot(axis) > self.local[outermost].dot(axis) {
                    outermost = i;
                }
            }
            let along = self.normal[outermost].dot(axis);
            // Squares weigh the directions: a normal perpendicular to the axis does not count.
            sum += along * along.abs();
        }
        sum < 0.0
    }
}
