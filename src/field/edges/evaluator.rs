//! The evaluator of a field whose edges were found. Within its region a piece is f; beyond its
//! edges it is extrapolated.

use super::sampled::{STENCIL, Taylor, jet, stencil};
use super::search::ALIKE;
use super::site::Site;
use super::table::EdgeTable;
use crate::field::{Evaluator, Field, Frame, Jet, Pieces};
use crate::math::{Bounds, Sym3};
use glam::{DVec3, Vec3};

/// Largest distance, in margins, to which a piece is extrapolated from a place within its region.
/// Farther away the jet of a vertex beside the edge, which takes no values of f, is exact enough.
const FAR: f64 = 40.0;
/// Maximum number of moves that bring a place into the region of a piece.
const MOVES: u32 = 12;
/// Two pieces whose distances from f differ by no more than this share of the size of the box count
/// as equally near to it.
const SAME: f64 = 3e-10;
/// Largest distance between the unit normals of a piece and of f where f is the piece: the piece
/// may turn by so much within a cell.
const TURNED: f64 = 1.0;
/// Depths within the region, in margins, that are tried in turn where the walls are not exact.
const DEEPER: [f64; 2] = [4.0, 16.0];

/// The way to evaluate a piece at a place.
enum Plan {
    /// Evaluates f: the place is within the region of the piece.
    Whole,
    /// Extrapolates from this place within the region. There f is like the first rather than the
    /// second vertex of each pair; the first pair is the nearest.
    Around(DVec3, Vec<[u32; 2]>),
    /// Extrapolates from this vertex.
    Vertex(u32),
}

/// The border of the region of a piece at a site: there the piece equals the one beyond.
struct Wall {
    /// The label beyond.
    beyond: u32,
    /// Distance of the site from the place that is asked for.
    near: f64,
    /// The vertices of the piece and of the one beyond, beside the site.
    ends: [u32; 2],
    /// Where the site is.
    position: DVec3,
    /// The piece, and the one beyond.
    own: Taylor,
    other: Taylor,
    /// See [`Site::sign`].
    sign: f64,
    /// See [`Side::is_flush`](super::site::Side::is_flush), of the piece and of the one beyond.
    is_flush: [bool; 2],
    /// The unit vector along the edge, if it fades out somewhere.
    fades_along: Option<DVec3>,
}

impl Wall {
    fn new(table: &EdgeTable, site: &Site, label: u32, p: DVec3) -> Option<Self> {
        let k = site.sides.iter().position(|side| side.label == label)?;
        // Known points of an edge are up to a cell apart: farther along, it has faded out.
        if site.fades && (p - site.position).dot(site.along).abs() > table.cell {
            return None;
        }
        let [own, other] = [site.sides[k], site.sides[1 - k]];
        Some(Self {
            beyond: other.label,
            near: site.position.distance(p),
            ends: [own.end, other.end],
            position: site.position,
            own: table.vertices[own.end as usize],
            other: table.vertices[other.end as usize],
            sign: site.sign,
            is_flush: [own.is_flush, other.is_flush],
            fades_along: site.fades.then_some(site.along),
        })
    }

    /// The distance of a place from the wall, negative beyond it, and the unit vector that leads
    /// into the region.
    fn depth(&self, p: DVec3) -> (f64, DVec3) {
        if let Some(along) = self.fades_along {
            return self.depth_from_parabola(p, along);
        }
        let [(f, u), (g, v)] = [self.own.slope(p), self.other.slope(p)];
        // Where bodies touch along the sheet of the piece beyond, its negative gives f on the other
        // side of it.
        let (f, u) = if self.is_flush[1] && f * self.sign > 0.0 { (-f, -u) } else { (f, u) };
        let slope = (u - v) * self.sign;
        let length = slope.length();
        ((f - g) * self.sign / length, slope / length)
    }

    /// [`Wall::depth`] from the parabola through the site with the direction and the bend of the
    /// edge. Where the angle of the edge vanishes, beyond its end, the difference of the pieces has
    /// the other sign.
    fn depth_from_parabola(&self, p: DVec3, along: DVec3) -> (f64, DVec3) {
        let [u, v] = [self.own.slope(self.position).1, self.other.slope(self.position).1];
        let slope = (u - v) * self.sign;
        let length = slope.length();
        let bend = [self.own, self.other].map(|piece| along.dot(piece.jet.hessian.apply(along)));
        let bend = (bend[0] - bend[1]) * self.sign / length;
        let way = p - self.position;
        let ahead = way.dot(along);
        let across = slope / length;
        (way.dot(across) + 0.5 * bend * ahead * ahead, (across + along * (bend * ahead)).normalize_or_zero())
    }
}

/// The shortest step that makes a place deeper within several walls, each given with the depth that
/// is lacking and the direction into the region: along the surface of the piece, where its region
/// is sure to go on, unless that is steep to the first wall. A wall nearly parallel to those before
/// is ignored, and so is one more than there are dimensions.
fn step_within(normal: DVec3, walls: impl Iterator<Item = (f64, DVec3)>) -> DVec3 {
    /// Cosine of the largest angle between the surface and the shortest way from the first wall. A
    /// smaller one makes steps along the surface longer, and with them the error of extrapolation.
    const STEEP: f64 = 0.5;
    let (mut across, mut step): (Vec<DVec3>, DVec3) = (Vec::new(), DVec3::ZERO);
    let mut walls = walls.peekable();
    if walls.peek().is_some_and(|(_, way)| way.reject_from_normalized(normal).length() > STEEP) {
        across.push(normal);
    }
    for (lacking, way) in walls {
        // The part of the direction along the walls before, which keeps the depth within them.
        let free = across.iter().fold(way, |free, n| free - *n * free.dot(*n));
        let Some(free) = free.try_normalize().filter(|free| free.dot(way) > 0.05) else { continue };
        step += free * ((lacking - step.dot(way)) / free.dot(way));
        across.push(free);
    }
    step
}

impl EdgeTable {
    /// The walls of a piece around a place: for each neighbouring piece that at the nearest site.
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

    /// The walls that bound the region of a piece at a place: the index of each, the depth within
    /// it and the direction into the region. Where the region has a reflex angle at a corner, being
    /// within one of both walls is enough, so only the deeper one bounds it.
    fn bounding(walls: &[Wall], p: DVec3) -> Vec<(usize, f64, DVec3)> {
        let depths: Vec<(f64, DVec3)> = walls.iter().map(|wall| wall.depth(p)).collect();
        let is_reflex = |a: &Wall, b: &Wall| a.depth(b.position).0 < 0.0 && b.depth(a.position).0 < 0.0;
        let is_spared = |k: usize| {
            (0..walls.len()).any(|j| j != k && depths[j].0 > depths[k].0 && is_reflex(&walls[k], &walls[j]))
        };
        let bounding = (0..walls.len()).filter(|&k| !is_spared(k));
        bounding.map(|k| (k, depths[k].0, depths[k].1)).collect()
    }

    /// Plans how to evaluate a piece at a place: moves the place by a margin into the region of the
    /// piece, and extrapolates from there.
    fn plan(&self, label: u32, q: DVec3, margin: f64) -> Plan {
        let walls = self.walls(label, q);
        let Some(nearest) = walls.iter().min_by(|a, b| a.near.total_cmp(&b.near)) else { return Plan::Whole };
        let beside = Plan::Vertex(nearest.ends[0]);
        let normal = nearest.own.slope(q).1.normalize_or_zero();
        let mut p = q;
        // The walls that have moved the place, the last one first.
        let mut passed: Vec<usize> = Vec::new();
        for _ in 0..MOVES {
            let bounding = Self::bounding(&walls, p);
            let Some(&(worst, depth, _)) = bounding.iter().min_by(|a, b| a.1.total_cmp(&b.1)) else { break };
            if depth >= margin {
                let moved = p.distance(q);
                return match moved {
                    0.0 if depth >= self.clear => Plan::Whole,
                    _ if moved <= FAR * self.margin => {
                        let others = walls.iter().map(|wall| wall.ends).filter(|&ends| ends != nearest.ends);
                        Plan::Around(p, core::iter::once(nearest.ends).chain(others).collect())
                    }
                    _ => beside,
                };
            }
            passed.retain(|&k| k != worst);
            passed.insert(0, worst);
            let lacking = passed.iter().filter_map(|k| bounding.iter().find(|(wall, ..)| wall == k));
            let step = step_within(normal, lacking.map(|&(_, depth, way)| (1.01 * margin - depth, way)));
            // Written so that NaN fails.
            let is_near = (p + step).distance(q) <= self.cell;
            if !is_near {
                break;
            }
            p += step;
        }
        beside
    }

    /// The polynomial of a piece around a place by the values of its [stencil] there; none if an
    /// edge passes between these, or if f is like the piece beyond a wall.
    fn around(&self, p: DVec3, values: &[f64; STENCIL], pairs: &[[u32; 2]]) -> Option<Taylor> {
        let found = Taylor { p, jet: jet(values, self.step)? };
        let normal = found.normal();
        let off = |k: u32| self.vertices[k as usize].slope(p).1.normalize_or_zero().distance(normal);
        let is_own = |&[own, other]: &[u32; 2]| off(own) <= off(other).clamp(ALIKE, TURNED);
        pairs.iter().all(is_own).then_some(found)
    }

    /// The polynomial of a piece around a place farther within its region: between the known points
    /// of an edge that bends, its walls are not exact.
    fn deeper(&self, field: &dyn Field, label: u32, q: DVec3, beside: u32) -> Taylor {
        let mut values = [0.0; STENCIL];
        let places = DEEPER.iter().map(|margins| self.plan(label, q, margins * self.margin));
        let found = places.into_iter().find_map(|plan| {
            let Plan::Around(p, pairs) = plan else { return None };
            field.values(&stencil(p, self.step), &mut values);
            self.around(p, &values, &pairs)
        });
        found.unwrap_or(self.vertices[beside as usize])
    }

    /// Whether the sheet of a piece at a place is no surface, since the piece has ended before it
    /// and f [is zero all the same](super::site::Side::is_flush). The pieces around the place are
    /// given with their values there.
    fn is_in_flush(&self, label: u32, p: DVec3, pieces: &[(u32, Jet)]) -> bool {
        let is_flush = |site: &Site| site.sides.iter().any(|side| side.label == label && side.is_flush);
        if !self.sites_near(p).any(is_flush) {
            return false;
        }
        let value = |label: u32| pieces.iter().find(|piece| piece.0 == label).map(|piece| piece.1.value);
        let walls = self.walls(label, p);
        Self::bounding(&walls, p).into_iter().any(|(k, depth, _)| {
            let Wall { is_flush: [is_flush, _], beyond, sign, .. } = walls[k];
            // The polynomials of a wall are not exact enough beside it.
            let depth = match value(label).zip(value(beyond)) {
                Some((own, other)) => (own - other) * sign,
                None => depth,
            };
            is_flush && depth < 0.0
        })
    }

    /// Whether differences at a place could reach over an edge.
    fn is_beside_edge(&self, p: DVec3) -> bool {
        self.sites_near(p).any(|site| {
            let depth = Wall::new(self, site, site.sides[0].label, p).map(|wall| wall.depth(p).0);
            // It is NaN where both pieces have the same gradient.
            depth.is_some_and(|depth| depth.is_nan() || depth.abs() < self.clear)
        })
    }
}

/// The evaluator of f, or of one of its pieces.
pub(super) struct EdgedEvaluator<'a> {
    field: &'a dyn Field,
    table: &'a EdgeTable,
    frame: Frame,
    /// The evaluator of f without its edges.
    whole: Box<dyn Evaluator + 'a>,
    /// The piece that is evaluated; none for f.
    label: Option<u32>,
    /// The evaluator of a piece, once one has been asked for.
    piece: Option<Box<Self>>,
    /// The points of a batch that need extrapolation, by their index, each with the label of the
    /// piece and its plan.
    planned: Vec<(usize, u32, Plan)>,
    /// The stencils of the planned points, and the values of f there.
    places: Vec<DVec3>,
    values: Vec<f64>,
}

impl<'a> EdgedEvaluator<'a> {
    pub(super) fn new(field: &'a dyn Field, table: &'a EdgeTable, frame: Frame) -> Self {
        Self::of(field, table, frame, None)
    }

    fn of(field: &'a dyn Field, table: &'a EdgeTable, frame: Frame, label: Option<u32>) -> Self {
        let whole = field.evaluator(frame);
        let (planned, places, values) = Default::default();
        Self { field, table, frame, whole, label, piece: None, planned, places, values }
    }

    /// Plans the points of a batch that need extrapolation, and returns whether any of them do not.
    /// Beside an edge the gradient of f is that of the piece there, since differences of f would
    /// reach over the edge.
    fn plan(&mut self, points: impl ExactSizeIterator<Item = DVec3>) -> bool {
        let count = points.len();
        self.planned.clear();
        for (k, p) in points.enumerate() {
            let place = self.frame.place(p);
            let label = match self.label {
                Some(label) => label,
                None if self.table.is_beside_edge(place) => self.label_at(place),
                None => continue,
            };
            let plan = self.table.plan(label, place, self.table.margin);
            if !matches!(plan, Plan::Whole) {
                self.planned.push((k, label, plan));
            }
        }
        self.planned.len() < count
    }

    /// Calls `store` with the index of each planned point and the jet of its piece there, as the
    /// field gives it. `point` returns a point of the batch.
    fn planned_jets(&mut self, point: impl Fn(usize) -> DVec3, mut store: impl FnMut(usize, Jet)) {
        let step = self.table.step;
        self.places.clear();
        for (.., plan) in &self.planned {
            if let Plan::Around(p, _) = plan {
                self.places.extend(stencil(*p, step));
            }
        }
        self.values.resize(self.places.len(), 0.0);
        self.field.values(&self.places, &mut self.values);
        let mut stencils = self.values.as_chunks::<STENCIL>().0.iter();
        for (k, label, plan) in &self.planned {
            let q = self.frame.place(point(*k));
            let taylor = match plan {
                Plan::Around(p, pairs) => {
                    let own = stencils.next().expect("a stencil for each place");
                    let found = self.table.around(*p, own, pairs);
                    found.unwrap_or_else(|| self.table.deeper(self.field, *label, q, pairs[0][0]))
                }
                Plan::Vertex(vertex) => self.table.vertices[*vertex as usize],
                Plan::Whole => continue,
            };
            store(*k, taylor.jet(q));
        }
    }

    /// The jet of a piece at a place where the value of f is `whole`; within its region the value
    /// alone. None where f is another function, although no edge is known: inside a solid, `vertex`
    /// of the piece being the nearest one.
    fn piece_jet(&self, (label, vertex): (u32, u32), q: DVec3, whole: f64) -> Option<Jet> {
        let step = self.table.step;
        let taylor = match self.table.plan(label, q, self.table.margin) {
            Plan::Whole => {
                let jet = Jet { value: whole, ..Jet::default() };
                return Some(jet).filter(|_| self.table.fits(vertex, q, whole));
            }
            Plan::Around(p, pairs) => {
                let mut values = [0.0; STENCIL];
                self.field.values(&stencil(p, step), &mut values);
                let found = self.table.around(p, &values, &pairs);
                found.unwrap_or_else(|| self.table.deeper(self.field, label, q, pairs[0][0]))
            }
            Plan::Vertex(vertex) => self.table.vertices[vertex as usize],
        };
        Some(taylor.jet(q))
    }

    /// The label of the piece that gives f at a place: that of the piece nearest to f; of several
    /// equally near ones, that of the nearest vertex, unless they [meet smoothly](super::joins).
    /// It is [no label](EdgeTable::no_label) where
    /// none of them does, as along a face inside a solid that two of its bodies share.
    fn label_at(&self, p: DVec3) -> u32 {
        let labels = self.table.labels_near(p);
        // On the surface, where labels are asked for, this needs no call.
        if let [(label, vertex)] = labels[..]
            && self.table.is_beside(vertex, p)
            && self.table.fits(vertex, p, 0.0)
        {
            return label;
        }
        let whole = self.field.value(p);
        let jet_of = |&piece: &(u32, u32)| Some((piece.0, self.piece_jet(piece, p, whole)?));
        let pieces: Vec<(u32, Jet)> = labels.iter().filter_map(jet_of).collect();
        let same = SAME * self.table.size;
        let mut best = (f64::INFINITY, self.table.no_label());
        let mut tried: Vec<(f64, u32)> = Vec::new();
        for &(label, jet) in &pieces {
            let vertex = labels.iter().find(|piece| piece.0 == label).map_or(0, |piece| piece.1);
            if (jet.value - whole).abs() > self.table.error(vertex, p)
                || self.table.is_in_flush(label, p, &pieces)
            {
                continue;
            }
            let slope = jet.gradient.length();
            let off = if jet.value == whole { 0.0 } else { (jet.value - whole).abs() / slope };
            tried.push((off, label));
            if off < best.0 - same {
                best = (off, label);
            }
        }
        let equal = tried.iter().filter(|&&(off, label)| label != best.1 && off <= best.0 + same);
        let mut joined = equal.filter_map(|&(_, label)| self.table.joined_label(p, [best.1, label]));
        joined.next().unwrap_or(best.1)
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
        if self.label.is_none() {
            return self.whole.values(points, value);
        }
        if self.plan(points.iter().map(|p| p.as_dvec3())) {
            self.whole.values(points, value);
        }
        let frame = self.frame;
        self.planned_jets(|k| points[k].as_dvec3(), |k, jet| value[k] = frame.value(jet.value));
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        if self.plan(points.iter().map(|p| p.as_dvec3())) {
            self.whole.gradients(points, value, gradient);
        }
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
        if self.plan(points.iter().map(|p| p.as_dvec3())) {
            self.whole.hessians(points, value, gradient, hessian);
        }
        let frame = self.frame;
        self.planned_jets(
            |k| points[k].as_dvec3(),
            |k, jet| (value[k], gradient[k], hessian[k]) = frame.hessian(&jet),
        );
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        if self.plan(core::iter::once(p)) {
            return self.whole.value_and_gradient(p);
        }
        let (frame, mut found) = (self.frame, (f64::NAN, DVec3::NAN));
        self.planned_jets(|_| p, |_, jet| found = frame.exact((jet.value, jet.gradient)));
        found
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        if self.plan(core::iter::once(p)) {
            return self.whole.jet(p);
        }
        let (frame, mut found) = (self.frame, Jet::default());
        self.planned_jets(|_| p, |_, jet| found = frame.jet(jet));
        found
    }

    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        if self.plan(points.iter().map(|p| p.as_dvec3())) {
            self.whole.exact_gradients(points, value, gradient);
        }
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
        Some(self.table.labels_in(&self.frame.outward(bounds)))
    }

    fn piece(&mut self, label: u32) -> &mut dyn Evaluator {
        let (field, table, frame) = (self.field, self.table, self.frame);
        let own = self.piece.get_or_insert_with(|| Box::new(Self::of(field, table, frame, Some(label))));
        own.label = Some(label);
        &mut **own
    }

    fn tangent_pairs(&mut self) -> Vec<[u32; 2]> {
        self.table.tangent_pairs()
    }

    fn edge_cells(&mut self, bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let cells = self.table.edge_cells(&self.frame.outward(bounds), width);
        cells.iter().map(|cell| cell.relative_to(self.frame.origin)).collect()
    }
}
