//! The search for edges. It joins neighbouring vertices whose jets agree. Where they disagree it
//! narrows the way between them, down to the point at which one piece gives way to another.

use super::grid::Grid;
use super::sampled::{Bracket, Sampled, Taylor};
use crate::math::newton::step_to_corner;
use crate::math::{Bounds, Meet, NONE};
use crate::slices::{HEAVY, pause};
use glam::DVec3;

/// Largest [residual](Search::residual) between two vertices of one piece.
pub(super) const ALIKE: f64 = 0.03;
/// The same for vertices nearer to each other than neighbours of the grid, where a jet predicts
/// more exactly.
pub(super) const ALIKE_NEAR: f64 = 0.01;
/// Largest distance |f|/|∇f| of the surface from the predicted place of an edge, as a share of the
/// distance between the vertices beside it.
const PREDICTED: f64 = 0.02;
/// Largest distance of the edge of a blade from the middle of vertices on both sides of it, over
/// the distance between them: no cell of the grid sees both sides nearer to a sharp one.
const BLADE: f64 = 4.0;
/// Distance of new vertices from the predicted place of an edge, as a share of the same distance.
const BESIDE: f64 = 0.1;
/// Distance between two vertices at which the search between them ends, as a share of the size of
/// the box, if neither piece turns by more than [`LITTLE_BENT`] over it.
const CLOSE: f64 = 4e-4;
/// An angle in radians, see [`CLOSE`].
const LITTLE_BENT: f64 = 0.05;
/// Distance between two vertices at which the search ends in any case, as a share of that size.
const CLOSEST: f64 = 1e-5;
/// Largest distance |f|/|∇f| of the surface from a point of an edge, as a share of the size of the
/// box. Where it is larger the edge is rounded, or a third piece lies between.
const OFF: f64 = 2e-7;
/// Ratio of the cells of the grid to those of a closer look.
const CLOSER: f64 = 3.0;
/// Maximum number of times that the way between two vertices is shortened.
const MOST_STEPS: u32 = 60;
/// Maximum number of evaluations that find the surface half-way between two vertices.
const MOST_EVALUATIONS: u32 = 40;
/// Maximum depth of searches within a search: the part of a way that is left aside may have an edge
/// of its own, as in a strip thinner than a cell.
const DEEPEST: u32 = 3;

/// A point of an edge, with the vertices on both sides of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct RawSite {
    pub(super) position: DVec3,
    pub(super) ends: [u32; 2],
}

/// Vertices of the surface, and how the surface continues from one to the next.
pub(super) struct Search<'a> {
    pub(super) f: &'a Sampled<'a>,
    /// The side of a cell of the grid of the whole box.
    pub(super) cell: f64,
    pub(super) vertices: Vec<Taylor>,
    /// The first of the vertices that lie on no edge of the grid.
    pub(super) inserted: usize,
    /// Pairs of vertices of one piece.
    pub(super) joined: Vec<[u32; 2]>,
    /// Pairs of a vertex and a new one on the same side of an edge.
    pub(super) beside: Vec<[u32; 2]>,
    pub(super) sites: Vec<RawSite>,
    /// Places between two vertices where the search found neither a smooth piece nor an edge.
    pub(super) unclear: Vec<DVec3>,
}

impl<'a> Search<'a> {
    pub(super) fn new(f: &'a Sampled<'a>, cell: f64) -> Self {
        let (vertices, joined, beside, sites, unclear) = Default::default();
        Self { f, cell, vertices, inserted: 0, joined, beside, sites, unclear }
    }

    /// Searches the box. With `is_first` it ends at the first point of an edge.
    pub(super) async fn run(&mut self, bounds: &Bounds, is_first: bool) {
        let grid = Grid::sample(self.f, bounds, self.cell).await;
        self.look_at_links(&grid, is_first).await;
    }

    /// Searches small boxes around places on finer grids.
    pub(super) async fn look_closely(&mut self, places: &[DVec3]) {
        for &place in places {
            let around = Bounds::point(place).enlarged(self.cell);
            let grid = Grid::sample(self.f, &around, self.cell / CLOSER).await;
            self.look_at_links(&grid, false).await;
        }
    }

    async fn look_at_links(&mut self, grid: &Grid, is_first: bool) {
        let (points, of_edge) = grid.points(self.f).await;
        let mut of_point = Vec::with_capacity(points.len());
        for points in points.chunks(HEAVY) {
            pause().await;
            for (&p, jet) in points.iter().zip(self.f.jets(points, self.f.step)) {
                let jet = jet.filter(|jet| jet.gradient.length() > 0.0);
                of_point.push(jet.map_or(NONE, |jet| self.add(Taylor { p, jet })));
            }
        }
        if self.inserted == 0 {
            self.inserted = self.vertices.len();
        }
        for link in grid.links(self.f) {
            if is_first && !self.sites.is_empty() {
                return;
            }
            let [a, b] = link.map(|edge| of_edge[edge]).map(|k| of_point[k as usize]);
            if a != NONE && b != NONE {
                if self.residual(a, b) <= ALIKE {
                    self.joined.push([a, b]);
                } else {
                    pause().await;
                    self.look(a, b, 0);
                }
            }
        }
    }

    fn add(&mut self, vertex: Taylor) -> u32 {
        self.vertices.push(vertex);
        self.vertices.len() as u32 - 1
    }

    /// The unit normals on both sides of a point of an edge.
    pub(super) fn normals_at(&self, site: &RawSite) -> [DVec3; 2] {
        site.ends.map(|end| self.vertices[end as usize].slope(site.position).1.normalize_or_zero())
    }

    pub(super) fn distance(&self, a: u32, b: u32) -> f64 {
        self.vertices[a as usize].p.distance(self.vertices[b as usize].p)
    }

    /// How badly each of two jets predicts the other one: the error of the unit normal, or twice
    /// the error of the position over the distance between the vertices, whichever is larger. It is
    /// 0 for a quadratic function.
    pub(super) fn residual(&self, a: u32, b: u32) -> f64 {
        residual(&self.vertices[a as usize], &self.vertices[b as usize], self.f.size)
    }

    /// Finds out how the surface continues from one vertex to another: the two are joined, or a
    /// point of an edge lies between them, or the place is unclear.
    fn look(&mut self, a: u32, b: u32, depth: u32) {
        let (mut u, mut v) = (a, b);
        let mut left: Vec<[u32; 2]> = Vec::new();
        for step in 0..MOST_STEPS {
            let most = if step == 0 { ALIKE } else { ALIKE_NEAR };
            if self.residual(u, v) <= most {
                self.joined.push([u, v]);
                break;
            }
            let length = self.distance(u, v);
            let bend = [u, v].map(|k| self.vertices[k as usize].bend()).into_iter().fold(0.0, f64::max);
            let size = self.f.size;
            if length <= CLOSEST * size || length <= CLOSE * size && bend * length < LITTLE_BENT {
                self.finish(u, v);
                break;
            }
            let predicted = self.predicted(u, v, length).and_then(|place| {
                let [next_u, next_v] = [u, v].map(|k| self.beside(k, place, BESIDE * length));
                next_u.zip(next_v)
            });
            if let Some((next_u, next_v)) = predicted {
                let [next_u, next_v] = [next_u, next_v].map(|vertex| self.add(vertex));
                self.beside.extend([[u, next_u], [v, next_v]]);
                (u, v) = (next_u, next_v);
                continue;
            }
            let Some(middle) = self.between(u, v, length) else {
                self.unclear.push(0.5 * (self.vertices[u as usize].p + self.vertices[v as usize].p));
                break;
            };
            let [of_u, of_v, normal] =
                [self.vertices[u as usize], self.vertices[v as usize], middle].map(|vertex| vertex.normal());
            let middle = self.add(middle);
            if of_u.distance(normal) >= of_v.distance(normal) {
                left.push([middle, v]);
                v = middle;
            } else {
                left.push([u, middle]);
                u = middle;
            }
        }
        for [a, b] in left {
            if self.residual(a, b) <= ALIKE {
                self.joined.push([a, b]);
            } else if depth < DEEPEST {
                self.look(a, b, depth + 1);
            }
        }
    }

    /// Ends the search between two vertices close to each other: where their normals agree to a
    /// degree the piece only bends, else there is an edge.
    fn finish(&mut self, u: u32, v: u32) {
        let Some(position) = self.common(u, v) else {
            self.unclear.push(self.vertices[u as usize].p);
            return;
        };
        let slopes = [u, v].map(|k| self.vertices[k as usize].slope(position).1);
        if Meet::of_gradients(slopes) == Some(Meet::Tangent) {
            self.joined.push([u, v]);
            return;
        }
        let off = self.f.value(position).abs() / slopes[0].length().min(slopes[1].length());
        if off <= OFF * self.f.size {
            self.sites.push(RawSite { position, ends: [u, v] });
        } else {
            self.unclear.push(position);
        }
    }

    /// The common zero of the polynomials of two vertices, in the plane of the way from one to the
    /// other and the mean of their normals.
    fn common(&self, u: u32, v: u32) -> Option<DVec3> {
        let [u, v] = [u, v].map(|k| self.vertices[k as usize]);
        let way = v.p - u.p;
        let across = way.cross(u.normal() + v.normal());
        let reach = reach(&u, &v) * way.length();
        let middle = 0.5 * (u.p + v.p);
        let mut p = middle;
        for _ in 0..6 {
            let plane = ((p - middle).dot(across), across);
            let (step, volume) = step_to_corner([u.slope(p), v.slope(p), plane]);
            // Written so that NaN fails.
            let is_step = volume > 1e-6 && step.length() <= 2.0 * reach;
            if !is_step {
                return None;
            }
            p -= step;
        }
        (p.distance(middle) <= reach).then_some(p)
    }

    /// The point of an edge that the polynomials of two vertices predict; none if f is not nearly
    /// zero there.
    fn predicted(&self, u: u32, v: u32, length: f64) -> Option<DVec3> {
        let place = self.common(u, v)?;
        let value = self.f.value(place).abs();
        let is_near = [u, v].into_iter().all(|k| {
            let slope = self.vertices[k as usize].jet.gradient.length();
            value <= PREDICTED * length * slope
        });
        is_near.then_some(place)
    }

    /// A new vertex on the piece of another one, at a distance from the predicted point of an edge;
    /// none if another piece gives f there.
    fn beside(&self, k: u32, place: DVec3, distance: f64) -> Option<Taylor> {
        let vertex = &self.vertices[k as usize];
        let normal = vertex.slope(place).1.normalize_or_zero();
        let way = vertex.p - place;
        let way = (way - normal * way.dot(normal)).try_normalize()?;
        let mut p = place + way * distance;
        for _ in 0..3 {
            let (_, slope) = vertex.slope(p);
            p -= slope * (self.f.value(p) / slope.length_squared());
        }
        let jet = self.f.jet(p, self.f.step.min(0.2 * distance))?;
        let new = Taylor { p, jet };
        (residual(vertex, &new, self.f.size) <= ALIKE).then_some(new)
    }

    /// The point of the surface half-way between two vertices.
    fn between(&self, u: u32, v: u32, length: f64) -> Option<Taylor> {
        let [u, v] = [u, v].map(|k| &self.vertices[k as usize]);
        let middle = 0.5 * (u.p + v.p);
        let way = (u.normal() + v.normal()).normalize_or(u.normal());
        let at = |t: f64| self.f.value(middle + way * t);
        // Tries farther and farther places, on the side on which f should change its sign.
        let value = at(0.0);
        let reaches = [0.125, 0.25, 0.5, 1.0, 2.0, 4.0].into_iter().filter(|&r| r <= reach(u, v));
        let mut tried = reaches.map(|reach| -reach * length * value.signum()).map(|t| (t, at(t)));
        let (t, other) = tried.find(|(_, other)| (*other < 0.0) != (value < 0.0))?;
        let mut bracket = Bracket::new([0.0, t], [value, other]);
        let mut root = 0.0;
        for _ in 0..MOST_EVALUATIONS {
            root = bracket.root();
            if bracket.narrow(root, at(root)) <= 1e-14 * self.f.size {
                break;
            }
        }
        let p = middle + way * root;
        let jet = self.f.jet(p, self.f.step.min(0.1 * length))?;
        (jet.gradient.length() > 0.0).then_some(Taylor { p, jet })
    }
}

/// Largest distance from the middle of two vertices, over the distance between them, at which their
/// sheets may meet.
fn reach(u: &Taylor, v: &Taylor) -> f64 {
    if u.normal().dot(v.normal()) < 0.0 { BLADE } else { 1.0 }
}

/// See [`Search::residual`].
fn residual(a: &Taylor, b: &Taylor, size: f64) -> f64 {
    let length = a.p.distance(b.p);
    let [one, other] = [[a, b], [b, a]].map(|[from, to]| {
        let (value, gradient) = from.slope(to.p);
        let turned = gradient.normalize_or_zero().distance(to.normal());
        let missed = (value - to.jet.value).abs() / (gradient.length() * length);
        // Vertices as near as this have no direction from one to the other.
        if length > 1e-9 * size { turned.max(2.0 * missed) } else { turned }
    });
    // A NaN is no likeness.
    if one <= f64::MAX && other <= f64::MAX { one.max(other) } else { f64::INFINITY }
}
