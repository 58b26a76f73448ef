//! A function with known edges at work: f within the regions of its pieces, and the pieces beyond.

use super::sampled::{STENCIL, Taylor, jet_across, stencil};
use super::table::{EdgeTable, Site};
use crate::field::{Evaluator, Field, Frame, Jet, Pieces};
use crate::math::{Bounds, Sym3};
use glam::{DVec3, Vec3};

/// Largest distance to which a polynomial from a place within the region is taken, in margins.
/// Farther away the polynomial of a vertex beside the edge is near enough.
const FAR: f64 = 40.0;
/// Number of times that a place is moved into the region of a piece, from one edge after another.
const MOVES: u32 = 12;
/// Largest difference of f from a piece, as a share of the size of the box, at which the piece
/// gives f as well as another one that differs less.
const SAME: f64 = 3e-10;

/// How a piece is evaluated at a place.
#[derive(Clone, Copy)]
enum Plan {
    /// It is f.
    Whole,
    /// By the polynomial from a place within its region.
    Around(DVec3),
    /// By the polynomial of this vertex.
    Vertex(u32),
}

/// An edge beside a place, as the piece of one label sees it.
struct Wall {
    /// The other label.
    beyond: u32,
    /// Distance of the site.
    near: f64,
    /// The vertex of the piece beside the site.
    end: u32,
    position: DVec3,
    own: Taylor,
    other: Taylor,
    sign: f64,
}

impl Wall {
    fn new(table: &EdgeTable, site: &Site, label: u32, p: DVec3) -> Option<Self> {
        let k = site.sides.iter().position(|side| side.label == label)?;
        let [own, other] = [site.sides[k], site.sides[1 - k]];
        Some(Self {
            beyond: other.label,
            near: site.position.distance(p),
            end: own.end,
            position: site.position,
            own: table.vertices[own.end as usize],
            other: table.vertices[other.end as usize],
            sign: site.sign,
        })
    }

    /// The distance of a place from where the piece gives way to the other one, negative beyond it,
    /// and the unit vector back into its region.
    fn depth(&self, p: DVec3) -> (f64, DVec3) {
        let [(f, u), (g, v)] = [self.own.slope(p), self.other.slope(p)];
        // The pieces may be of different steepness: what counts is where they are equal.
        let slope = (u - v) * self.sign;
        let length = slope.length();
        ((f - g) * self.sign / length, slope / length)
    }
}

/// The shortest step by which a place gets so much deeper within walls, by the ways into them:
/// within the first three of which no two are parallel.
fn step_within(walls: impl Iterator<Item = (f64, DVec3)>) -> DVec3 {
    let (mut across, mut step): (Vec<DVec3>, DVec3) = (Vec::new(), DVec3::ZERO);
    for (lacking, way) in walls {
        // The part of the way that leaves the depth within the walls before as it is.
        let free = across.iter().fold(way, |free, n| free - *n * free.dot(*n));
        let Some(free) = free.try_normalize().filter(|free| free.dot(way) > 0.05) else { continue };
        step += free * ((lacking - step.dot(way)) / free.dot(way));
        across.push(free);
    }
    step
}

impl EdgeTable {
    /// The edges beside a place that a piece has, the nearest of each other piece.
    fn walls(&self, label: u32, p: DVec3) -> Vec<Wall> {
        let mut walls: Vec<Wall> = Vec::new();
        for wall in self.sites_near(p).filter_map(|site| Wall::new(self, site, label, p)) {
            match walls.iter_mut().find(|known| known.beyond == wall.beyond) {
                Some(known) if known.near <= wall.near => {}
                Some(known) => *known = wall,
                None => walls.push(wall),
            }
        }
        walls
    }

    /// The walls that bound the region of a piece at a place, each with the place's depth within it
    /// and the way farther in. Where a region has a reflex angle at a corner, it lies within one
    /// wall or within the other, so that only the deeper one bounds it.
    fn bounding(walls: &[Wall], p: DVec3) -> Vec<(usize, f64, DVec3)> {
        let depths: Vec<(f64, DVec3)> = walls.iter().map(|wall| wall.depth(p)).collect();
        let is_reflex = |a: &Wall, b: &Wall| a.depth(b.position).0 < 0.0 && b.depth(a.position).0 < 0.0;
        let is_spared = |k: usize| {
            (0..walls.len()).any(|j| j != k && depths[j].0 > depths[k].0 && is_reflex(&walls[k], &walls[j]))
        };
        let bounding = (0..walls.len()).filter(|&k| !is_spared(k));
        bounding.map(|k| (k, depths[k].0, depths[k].1)).collect()
    }

    /// How a piece is evaluated at a place.
    fn plan(&self, label: u32, q: DVec3) -> Plan {
        let walls = self.walls(label, q);
        let Some(nearest) = walls.iter().min_by(|a, b| a.near.total_cmp(&b.near)) else { return Plan::Whole };
        let beside = Plan::Vertex(nearest.end);
        let mut p = q;
        // The walls that the place was beyond so far, the last one first.
        let mut passed: Vec<usize> = Vec::new();
        for _ in 0..MOVES {
            let bounding = Self::bounding(&walls, p);
            let Some(&(worst, depth, _)) = bounding.iter().min_by(|a, b| a.1.total_cmp(&b.1)) else { break };
            if depth >= self.margin {
                let moved = p.distance(q);
                return match moved {
                    0.0 if depth >= self.clear => Plan::Whole,
                    _ if moved <= FAR * self.margin => Plan::Around(p),
                    _ => beside,
                };
            }
            passed.retain(|&k| k != worst);
            passed.insert(0, worst);
            let lacking = passed.iter().filter_map(|k| bounding.iter().find(|(wall, ..)| wall == k));
            let step = step_within(lacking.map(|&(_, depth, way)| (1.01 * self.margin - depth, way)));
            // Written so that NaN fails.
            let is_near = (p + step).distance(q) <= self.cell;
            if !is_near {
                break;
            }
            p += step;
        }
        beside
    }

    /// Whether differences at a place may reach over an edge.
    fn is_beside_edge(&self, p: DVec3) -> bool {
        self.sites_near(p).any(|site| {
            let depth = Wall::new(self, site, site.sides[0].label, p).map(|wall| wall.depth(p).0);
            // NaN where both functions are the same.
            depth.is_some_and(|depth| depth.is_nan() || depth.abs() < self.clear)
        })
    }
}

/// A function with known edges, or one of its pieces.
pub(crate) struct EdgedEvaluator<'a> {
    field: &'a dyn Field,
    table: &'a EdgeTable,
    frame: Frame,
    whole: Box<dyn Evaluator + 'a>,
    /// The piece that is evaluated; none for f.
    label: Option<u32>,
    piece: Option<Box<Self>>,
    /// Points of a batch at which it is not f that is evaluated, with how and by which piece.
    planned: Vec<(usize, u32, Plan)>,
    places: Vec<DVec3>,
    values: Vec<f64>,
}

impl<'a> EdgedEvaluator<'a> {
    pub(crate) fn new(field: &'a dyn Field, table: &'a EdgeTable, frame: Frame) -> Self {
        Self::of(field, table, frame, None)
    }

    fn of(field: &'a dyn Field, table: &'a EdgeTable, frame: Frame, label: Option<u32>) -> Self {
        let whole = field.evaluator(frame);
        let (planned, places, values) = Default::default();
        Self { field, table, frame, whole, label, piece: None, planned, places, values }
    }

    /// Plans the points at which f, or differences of it, are not what is asked for. f itself has a
    /// gradient everywhere but beside edges, where it is that of the piece there.
    fn plan(&mut self, points: impl Iterator<Item = DVec3>) {
        self.planned.clear();
        for (k, p) in points.enumerate() {
            let place = self.frame.place(p);
            let label = match self.label {
                Some(label) => label,
                None if self.table.is_beside_edge(place) => self.label_at(place),
                None => continue,
            };
            let plan = self.table.plan(label, place);
            if !matches!(plan, Plan::Whole) {
                self.planned.push((k, label, plan));
            }
        }
    }

    /// Calls `store` with the index of each planned point and the jet of its piece there, in the
    /// coordinates of the field.
    fn planned_jets(&mut self, point: impl Fn(usize) -> DVec3, mut store: impl FnMut(usize, Jet)) {
        let step = self.step();
        self.places.clear();
        for (_, _, plan) in &self.planned {
            if let Plan::Around(p) = plan {
                self.places.extend(stencil(*p, step));
            }
        }
        self.values.resize(self.places.len(), 0.0);
        self.field.values(&self.places, &mut self.values);
        let mut stencils = self.values.as_chunks::<STENCIL>().0.iter();
        for &(k, _, plan) in &self.planned {
            let taylor = match plan {
                Plan::Around(p) => {
                    let own = stencils.next().expect("a stencil for each place");
                    Taylor { p, jet: jet_across(own, step) }
                }
                Plan::Vertex(vertex) => self.table.vertices[vertex as usize],
                Plan::Whole => continue,
            };
            store(k, taylor.jet(self.frame.place(point(k))));
        }
    }

    fn step(&self) -> f64 {
        self.table.step
    }

    /// The jet of a piece at a place, by its plan.
    fn piece_jet(&self, label: u32, q: DVec3, whole: f64) -> Jet {
        let step = self.step();
        let taylor = match self.table.plan(label, q) {
            Plan::Whole => return Jet { value: whole, ..Jet::default() },
            Plan::Around(p) => {
                let mut values = [0.0; STENCIL];
                self.field.values(&stencil(p, step), &mut values);
                Taylor { p, jet: jet_across(&values, step) }
            }
            Plan::Vertex(vertex) => self.table.vertices[vertex as usize],
        };
        taylor.jet(q)
    }

    /// The label of the piece that gives f at a place.
    fn label_at(&self, p: DVec3) -> u32 {
        let nearest = self.table.nearest(p);
        let mut labels: Vec<(u32, f64)> =
            nearest.iter().map(|(&label, &(distance, _))| (label, distance)).collect();
        for site in self.table.sites_near(p) {
            for side in site.sides {
                if labels.iter().all(|&(known, _)| known != side.label) {
                    labels.push((side.label, site.position.distance_squared(p)));
                }
            }
        }
        match labels[..] {
            [] => return 0,
            [(label, _)] => return label,
            _ => {}
        }
        labels.sort_by(|a, b| a.1.total_cmp(&b.1));
        let whole = self.field.value(p);
        let mut best = (f64::INFINITY, labels[0].0);
        for (label, _) in labels {
            let jet = self.piece_jet(label, p, whole);
            let slope = jet.gradient.length();
            let off = if jet.value == whole { 0.0 } else { (jet.value - whole).abs() / slope };
            // The nearest of those that are f counts.
            if off < best.0 - SAME * self.table.size {
                best = (off, label);
            }
        }
        best.1
    }
}

impl Evaluator for EdgedEvaluator<'_> {
    fn frame(&self) -> Frame {
        self.frame
    }

    fn another(&self) -> Box<dyn Evaluator + '_> {
        Box::new(EdgedEvaluator::of(self.field, self.table, self.frame, self.label))
    }

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        self.whole.values(points, value);
        if self.label.is_some() {
            self.plan(points.iter().map(|p| p.as_dvec3()));
            let frame = self.frame;
            self.planned_jets(|k| points[k].as_dvec3(), |k, jet| value[k] = frame.value(jet.value));
        }
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        self.whole.gradients(points, value, gradient);
        self.plan(points.iter().map(|p| p.as_dvec3()));
        let frame = self.frame;
        self.planned_jets(
            |k| points[k].as_dvec3(),
            |k, jet| (value[k], gradient[k]) = frame.gradient((jet.value, jet.gradient)),
        );
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        self.whole.hessians(points, value, gradient, hessian);
        self.plan(points.iter().map(|p| p.as_dvec3()));
        let frame = self.frame;
        self.planned_jets(
            |k| points[k].as_dvec3(),
            |k, jet| (value[k], gradient[k], hessian[k]) = frame.hessian(&jet),
        );
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        self.plan(core::iter::once(p));
        if self.planned.is_empty() {
            return self.whole.value_and_gradient(p);
        }
        let (frame, mut found) = (self.frame, (f64::NAN, DVec3::NAN));
        self.planned_jets(|_| p, |_, jet| found = frame.exact((jet.value, jet.gradient)));
        found
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        self.plan(core::iter::once(p));
        if self.planned.is_empty() {
            return self.whole.jet(p);
        }
        let (frame, mut found) = (self.frame, Jet::default());
        self.planned_jets(|_| p, |_, jet| found = frame.jet(jet));
        found
    }

    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        self.whole.exact_gradients(points, value, gradient);
        self.plan(points.iter().map(|p| p.as_dvec3()));
        let frame = self.frame;
        self.planned_jets(
            |k| points[k].as_dvec3(),
            |k, jet| (value[k], gradient[k]) = frame.exact((jet.value, jet.gradient)),
        );
    }

    fn pieces(&mut self) -> Option<&mut dyn Pieces> {
        Some(self)
    }
}

impl Pieces for EdgedEvaluator<'_> {
    fn label(&mut self, p: DVec3) -> u32 {
        self.label_at(self.frame.place(p))
    }

    fn labels_in(&mut self, bounds: &Bounds) -> Option<Vec<u32>> {
        self.table.labels_in(&self.frame.outward(bounds))
    }

    fn piece(&mut self, label: u32) -> &mut dyn Evaluator {
        let (field, table, frame) = (self.field, self.table, self.frame);
        let own = self.piece.get_or_insert_with(|| Box::new(Self::of(field, table, frame, Some(label))));
        own.label = Some(label);
        &mut **own
    }

    fn seams_in(&mut self, bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let cells = self.table.seams(&self.frame.outward(bounds), width);
        cells.iter().map(|cell| cell.relative_to(self.frame.origin)).collect()
    }
}
