//! The search for edges: vertices of one smooth piece are linked, and where a link fails the place
//! is followed in which one piece gives way to another.

use super::grid::Grid;
use super::sampled::{Sampled, Taylor};
use crate::math::newton::step_to_corner;
use crate::math::{Bounds, NONE, SHARP};
use crate::slices::{HEAVY, pause};
use glam::DVec3;

/// Largest difference of a normal from the one that is foretold, between vertices of one piece.
const ALIKE: f64 = 0.03;
/// The same once the way between them has been halved, where a jet foretells more.
const ALIKE_NEAR: f64 = 0.01;
/// Largest |f|/|∇f| at the foretold place of an edge, as a share of the distance between the
/// vertices beside it.
const FORETOLD: f64 = 0.02;
/// Largest distance of the edge of a blade from the middle of vertices on both sides of it, over
/// the distance between them: no cell of the grid sees both sides nearer to a sharp one.
const BLADE: f64 = 4.0;
/// Distance of new vertices from the foretold place of an edge, as a share of that distance.
const BESIDE: f64 = 0.1;
/// Distance between the vertices on both sides of an edge at which its place is taken, as a share
/// of the size of the box.
const CLOSE: f64 = 4e-4;
/// Largest angle by which a piece turns over that distance.
const LITTLE_BENT: f64 = 0.05;
/// Distance at which the place is taken however much the pieces turn.
const CLOSEST: f64 = 1e-5;
/// Largest |f|/|∇f| at the place of an edge, as a share of the size of the box. Where it is larger
/// the edge is rounded, or a third piece lies between.
const OFF: f64 = 2e-7;
/// How many times as fine a grid is in the small boxes that are looked at more closely.
const CLOSER: f64 = 3.0;
/// Maximum number of vertices between two that are looked at.
const MOST_STEPS: u32 = 60;
/// Maximum number of times that what is left of a way beside an edge is looked at by itself: strips
/// thinner than a cell have several edges there.
const DEEPEST: u32 = 3;

/// A point of an edge, with the vertices on both sides of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct RawSite {
    pub(super) position: DVec3,
    pub(super) ends: [u32; 2],
}

/// Vertices of the surface, and what is known of those beside each other.
pub(super) struct Search<'a> {
    pub(super) f: &'a Sampled<'a>,
    /// The side of a cell of the grid of the whole box.
    pub(super) cell: f64,
    pub(super) vertices: Vec<Taylor>,
    /// The first of the vertices that lie on no edge of the grid.
    pub(super) inserted: usize,
    /// Pairs of vertices of one piece.
    pub(super) joined: Vec<[u32; 2]>,
    pub(super) sites: Vec<RawSite>,
    /// Places between vertices at which it was not found out how the surface goes on.
    pub(super) unclear: Vec<DVec3>,
}

impl<'a> Search<'a> {
    pub(super) fn new(f: &'a Sampled<'a>, cell: f64) -> Self {
        let (vertices, joined, sites, unclear) = Default::default();
        Self { f, cell, vertices, inserted: 0, joined, sites, unclear }
    }

    /// Looks at the whole box; with `is_first` only up to the first place of an edge.
    pub(super) async fn run(&mut self, bounds: &Bounds, is_first: bool) {
        let grid = Grid::sample(self.f, bounds, self.cell).await;
        self.look_at_links(&grid, is_first).await;
    }

    /// Looks more closely at small boxes around places.
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

    fn distance(&self, a: u32, b: u32) -> f64 {
        self.vertices[a as usize].p.distance(self.vertices[b as usize].p)
    }

    /// How far the jets of two vertices are from those of one smooth function: the larger of the
    /// difference of the normal that one foretells for the other, and of twice the distance by
    /// which it misses that, over the distance between them.
    pub(super) fn residual(&self, a: u32, b: u32) -> f64 {
        residual(&self.vertices[a as usize], &self.vertices[b as usize], self.f.size)
    }

    /// Looks how the surface goes on from one vertex to another.
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
            let foretold = self.foretold(u, v, length).and_then(|place| {
                let [next_u, next_v] = [u, v].map(|k| self.beside(k, place, BESIDE * length));
                next_u.zip(next_v)
            });
            if let Some((next_u, next_v)) = foretold {
                let [next_u, next_v] = [next_u, next_v].map(|vertex| self.add(vertex));
                self.joined.extend([[u, next_u], [v, next_v]]);
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

    /// Takes the place between two vertices that are close to each other as one of an edge, or as
    /// one of a piece that bends.
    fn finish(&mut self, u: u32, v: u32) {
        let Some(position) = self.common(u, v) else {
            self.unclear.push(self.vertices[u as usize].p);
            return;
        };
        let slopes = [u, v].map(|k| self.vertices[k as usize].slope(position).1);
        let [m, n] = slopes.map(DVec3::normalize_or_zero);
        if m.cross(n).length() < SHARP && m.dot(n) > 0.0 {
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

    /// The place between two vertices at which their polynomials foretell an edge, where f is
    /// nearly zero there.
    fn foretold(&self, u: u32, v: u32, length: f64) -> Option<DVec3> {
        let place = self.common(u, v)?;
        let value = self.f.value(place).abs();
        let is_near = [u, v].into_iter().all(|k| {
            let slope = self.vertices[k as usize].jet.gradient.length();
            value <= FORETOLD * length * slope
        });
        is_near.then_some(place)
    }

    /// A new vertex on the piece of another one, at a distance from the foretold place of an edge;
    /// none if what is there is no such piece.
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
        // A change of the sign along the mean normal, and its place by the Illinois method.
        let mut ends = [[0.0, at(0.0)]; 2];
        for reach in [0.125, 0.25, 0.5, 1.0, 2.0, 4.0].into_iter().filter(|&r| r <= reach(u, v)) {
            let t = -reach * length * ends[0][1].signum();
            let value = at(t);
            if (value < 0.0) != (ends[0][1] < 0.0) {
                ends[1] = [t, value];
                break;
            }
        }
        if (ends[1][1] < 0.0) == (ends[0][1] < 0.0) {
            return None;
        }
        let (mut last, mut root) = (2, 0.0);
        for _ in 0..40 {
            let [[a, f], [b, g]] = ends;
            root = (a * g - b * f) / (g - f);
            let value = at(root);
            let side = usize::from((value < 0.0) != (f < 0.0));
            let moved = (ends[side][0] - root).abs();
            ends[side] = [root, value];
            if last == side {
                ends[1 - side][1] *= 0.5;
            }
            last = side;
            if value == 0.0 || !value.is_finite() || moved <= 1e-14 * self.f.size {
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
