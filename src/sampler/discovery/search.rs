//! The search for components as the sampler drives it: the [octree](super::octree), whose witnesses
//! are seeds where the points of the survey are covered, and the [audit](super::audit) at the end.

use crate::field::descent::Descent;
use crate::field::{Bounded, Evaluator};
use crate::math::{Bounds, newton};
use crate::particles::Particles;
use crate::sampler::discovery::audit::{Audit, Audited, EXPLORED, UNITS, explore};
use crate::sampler::discovery::completeness::{Doubt, Sampled, Search};
use crate::sampler::discovery::nearness::{Nearness, nearest};
use crate::sampler::discovery::octree::{Octree, Seed, Witness};
use crate::sampler::discovery::sheets::{ExactPoint, Prover, Segment, TOGETHER, value_at};
use crate::sampler::discovery::singular::Singular;
use crate::sampler::probe::Probe;
use crate::sampler::projection::Tolerance;
use crate::sampler::sheet::{PointPair, SheetRule};
use glam::{DVec3, Vec3};

/// The search for components, with its witnesses and the audit.
#[derive(Clone, Debug, Default)]
pub(crate) struct ComponentSearch {
    octree: Octree,
    /// The witnesses on the surface as single precision computes it.
    points: Vec<Seed>,
    is_projected: bool,
    /// Index of the next witness to be tried as a seed.
    next: usize,
    audit: Audit,
    /// Number of witnesses whose projection did not converge, and the first of them.
    lost: u64,
    first_lost: DVec3,
    /// The sheet nearest to a witness, if it is nearer than particles distinguish.
    unresolved: Option<Nearness>,
    /// Distance at which f is examined around a witness, where it may be a zero on no surface.
    bare_size: Option<f64>,
}

impl ComponentSearch {
    /// Begins the search on a new field, with its known singular points.
    pub(crate) fn begin(&mut self, field: &mut dyn Evaluator, bounds: &Bounds, singular: &[Singular]) {
        let mut octree = Octree::default();
        octree.begin(field.bounded(), bounds);
        octree.singular.extend_from_slice(singular);
        self.begin_with(octree);
    }

    /// Begins with a search by bounds that has been made before.
    pub(crate) fn begin_with(&mut self, octree: Octree) {
        *self = Self { octree, ..Self::default() };
    }

    /// The search by bounds, if it is complete. It depends on the field and the box alone.
    pub(crate) fn into_octree(self) -> Option<Octree> {
        Some(self.octree).filter(|octree| octree.is_available() && octree.is_done())
    }

    /// Sets the distance to which f is examined around witnesses, to leave out those on no surface;
    /// none to keep all.
    pub(crate) fn leave_out_bare(&mut self, size: Option<f64>) {
        self.bare_size = size;
    }

    /// Starts again with the first witness.
    pub(crate) fn restart(&mut self) {
        self.next = 0;
        self.audit.restart();
    }

    /// Forgets the last audit: particles may have moved.
    pub(crate) fn restart_audit(&mut self) {
        self.audit.restart();
    }

    /// Whether the search is complete.
    pub(crate) fn is_searched(&self) -> bool {
        self.octree.is_done()
    }

    /// Does up to `budget` units of the search. Returns the rest of the budget, 0 until the search
    /// is complete.
    pub(crate) fn search(
        &mut self,
        probe: &mut Probe,
        bounds: &Bounds,
        tolerance: Tolerance,
        least_gap: f64,
        budget: u32,
    ) -> u32 {
        let Some(field) = probe.field.bounded() else { return budget };
        let left = self.octree.step(field, budget);
        if self.octree.is_done() && !self.is_projected {
            self.is_projected = true;
            let starts = self.starts(field, bounds, tolerance);
            self.project(probe, &starts, bounds, tolerance);
            self.unresolved = nearest(probe.field, self.points.iter().map(|seed| seed.exact), least_gap).0;
        }
        if self.octree.is_done() { left } else { 0 }
    }

    /// The witnesses in the box; of those connected with each other only a few.
    fn starts(&self, field: &mut dyn Bounded, bounds: &Bounds, tolerance: Tolerance) -> Vec<Witness> {
        let slack = f64::from(2.0 * tolerance.residual);
        let mut prover = Prover { field, factor: 0, slack, region: self.octree.region };
        // A zero of a branch that does not give f there is no point of the surface. The test is
        // made a little outside: where two bodies share a face, each of two branches gives f only
        // on its inner side.
        let mut witnesses = self.octree.witnesses.clone();
        witnesses.retain(|&Witness { position, factor }| {
            let (value, gradient) = value_at(&mut *prover.field, factor, position);
            let outside = (slack * gradient.length() - value) / gradient.length_squared();
            let outside = if outside.is_finite() { position + outside * gradient } else { position };
            prover.field.gives(factor, outside)
        });
        let witnesses = thinned_out(&mut prover, &witnesses);
        // A witness whose component lies only in the margin is not needed.
        let start = |&Witness { position, factor }: &Witness| {
            prover.factor = factor;
            let position =
                if bounds.holds(position) { position } else { prover.moved_inside(position, bounds)? };
            Some(Witness { position, factor })
        };
        witnesses.iter().filter_map(start).collect()
    }

    /// Projects the witnesses onto the surface as single precision computes it.
    fn project(&mut self, probe: &mut Probe, starts: &[Witness], bounds: &Bounds, tolerance: Tolerance) {
        // Single precision may move the surface by more than the residual.
        let reach = self.octree.region.margin as f32 + 16.0 * tolerance.residual;
        let limits = Descent { residual: tolerance.residual, reach, trust: 0.0 };
        let mut points: Vec<Vec3> = starts.iter().map(|start| start.position.as_vec3()).collect();
        let landed = probe.land_all(&mut points, tolerance.min_gradient, limits, newton::STEPS);
        for ((&Witness { position: exact, factor }, mut position), mut normal) in
            starts.iter().zip(points).zip(landed)
        {
            if normal.is_none() && probe.field.pieces().is_some() {
                // Where branches meet smoothly on the surface f may have no gradient there.
                let branch = probe.field.label(exact);
                let mut place = [exact.as_vec3()];
                let own = &mut probe.on(Some(branch));
                normal = own.land_all(&mut place, tolerance.min_gradient, limits, newton::STEPS)[0];
                [position] = place;
            }
            if self.bare_size.is_some_and(|size| probe.is_bare_zero(exact, size)) {
                continue;
            }
            match normal.filter(|_| bounds.contains(position)) {
                Some(normal) => self.points.push(Seed { position, normal, exact, factor }),
                None => {
                    self.first_lost = if self.lost == 0 { exact } else { self.first_lost };
                    self.lost += 1;
                }
            }
        }
    }

    /// The next witness, if any, and what is left of the budget.
    pub(crate) fn next(&mut self, budget: u32) -> (Option<Seed>, u32) {
        let witness = self.points.get(self.next).copied();
        self.next += 1;
        (witness, budget.saturating_sub(UNITS))
    }

    /// Points found by the search at which f and its gradient vanish together.
    pub(crate) fn singular(&self) -> &[Singular] {
        &self.octree.singular
    }

    /// All witnesses.
    pub(crate) fn points(&self) -> &[Seed] {
        &self.points
    }

    /// Whether the witness lies on the component of one of the particles `near` it, the nearest
    /// first: by proof, or, if the bounds are too wide for one, by the field at a point between the
    /// two. The [audit](super::audit) checks again.
    pub(crate) fn is_covered(
        &self,
        probe: &mut Probe,
        particles: &Particles,
        seed: Seed,
        near: &[u32],
        tolerance: Tolerance,
        rule: SheetRule,
    ) -> bool {
        // Without bounds there is no witness.
        let Some(field) = probe.field.bounded() else { return true };
        let Seed { position, normal, factor, .. } = seed;
        let slack = f64::from(2.0 * tolerance.residual);
        let mut prover = Prover { field, factor, slack, region: self.octree.region };
        let from = ExactPoint { position: position.as_dvec3(), normal: normal.as_dvec3() };
        let tried = near.iter().take(TOGETHER);
        let segments: Vec<Segment> =
            tried.map(|&j| Segment { from, to: particles.local[j as usize].as_dvec3() }).collect();
        let is_proven = prover.are_connected(&segments, None).contains(&true)
            || segments.iter().any(|&segment| prover.is_connected_by_segments(segment));
        is_proven
            || near.iter().take(TOGETHER).any(|&j| {
                let j = j as usize;
                let offset = particles.local[j] - position;
                rule.is_one_sheet(probe, position, PointPair { offset, normal, other: particles.normal[j] })
            })
    }

    /// The piece of the surface around the last witness, if it is small and closed.
    pub(crate) fn small_piece(&self, field: &mut dyn Bounded, radius: f32) -> Option<(Seed, f64)> {
        let seed = *self.points.get(self.next.checked_sub(1)?)?;
        let piece = explore(field, seed.factor, seed.exact, EXPLORED * f64::from(radius));
        (!piece.goes_on).then_some((seed, piece.reach))
    }

    /// Does up to `budget` units of the audit of the finished run, and returns what is left: 0
    /// until the audit is complete.
    pub(crate) fn audit(
        &mut self,
        probe: &mut Probe,
        particles: &Particles,
        radius: f64,
        tolerance: Tolerance,
        rule: SheetRule,
        budget: u32,
    ) -> u32 {
        if probe.field.bounded().is_none() {
            return budget;
        }
        let mut audited = Audited {
            probe,
            particles,
            seeds: &self.points,
            slack: f64::from(2.0 * tolerance.residual),
            radius,
            rule,
            region: self.octree.region,
        };
        let left = self.audit.step(&mut audited, budget);
        if self.audit.is_done() { left } else { 0 }
    }

    /// Whether the proof takes in the edges of the surface.
    pub(crate) fn proves_edges(&self) -> bool {
        self.octree.edged.is_some()
    }

    /// Whether there is a witness on every component, by proof.
    pub(crate) fn witnessed(&self) -> Search {
        if self.unwitnessed() == Some(0) { Search::Proven } else { Search::Searched }
    }

    /// The doubts that every component has a witness, or that each witness is on the component of a
    /// particle or named; empty if both are proven. Sheets nearer than `least_gap`, of which the
    /// survey may have found one, are not distinguished.
    pub(crate) fn doubts(&self, surveyed: Option<Nearness>, least_gap: f64) -> Vec<Doubt> {
        let nearness = [surveyed, self.unresolved].into_iter().flatten();
        let nearest = nearness.min_by(|a, b| a.gap.total_cmp(&b.gap)).filter(|near| near.gap < least_gap);
        let mut doubts: Vec<Doubt> = nearest
            .map(|Nearness { position, gap, .. }| Doubt::Unresolved {
                position: position.to_array(),
                gap,
                least: least_gap,
            })
            .into_iter()
            .collect();
        if !self.octree.is_available() {
            doubts.push(Doubt::NoBounds);
        } else if !(self.octree.is_done() && self.audit.is_done()) {
            doubts.push(Doubt::Unfinished);
        }
        if self.octree.is_done()
            && let Some(cell) = self.octree.undecided.first()
        {
            doubts.push(Doubt::Cells {
                count: self.octree.undecided.len() as u64,
                position: cell.middle().to_array(),
                size: cell.size().max_element(),
            });
        }
        let count = self.lost + self.audit.open;
        if count > 0 {
            let first = if self.lost > 0 { self.first_lost } else { self.audit.first_open };
            doubts.push(Doubt::Witnesses { count, position: first.to_array() });
        }
        doubts
    }

    /// The components that hold particles, and those that do not; `is_proven` says whether there
    /// are no [doubts](Self::doubts).
    pub(crate) fn sampled(&self, is_proven: bool) -> Sampled {
        let without = self.audit.without.clone();
        let is_known = is_proven && !without.iter().any(|piece| piece.goes_on);
        let above = without.iter().map(|piece| piece.reach).fold(0.0, f64::max);
        let missing = self.unwitnessed().map(|_| without.len());
        Sampled { above: is_known.then_some(above), missing, without }
    }

    /// Cells left undecided and witnesses that were lost; none without a search.
    fn unwitnessed(&self) -> Option<u64> {
        (self.octree.is_available() && self.octree.is_done())
            .then_some(self.octree.undecided.len() as u64 + self.lost)
    }

    /// Undecided cells, lost witnesses, and witnesses for which the audit does not know whether
    /// their component holds particles; none without a search.
    pub(crate) fn open_questions(&self) -> Option<u64> {
        self.unwitnessed().map(|open| open + self.audit.open)
    }
}

/// The witnesses without those that are proven to be connected with others within the region: along
/// a ridge of equal height there are many.
fn thinned_out(prover: &mut Prover, witnesses: &[Witness]) -> Vec<Witness> {
    let region = prover.region.bounds;
    let mut kept: Vec<Witness> = Vec::new();
    for of_factor in witnesses.chunk_by(|a, b| a.factor == b.factor) {
        prover.factor = of_factor[0].factor;
        let mut ends: Vec<ExactPoint> = Vec::new();
        for group in of_factor.chunks(TOGETHER) {
            let (segments, has_other): (Vec<Segment>, Vec<bool>) = group
                .iter()
                .map(|witness| {
                    let normal =
                        prover.field.jet(witness.position).gradient.try_normalize().unwrap_or(DVec3::Z);
                    let from = ExactPoint { position: witness.position, normal };
                    let distance = |end: &&ExactPoint| (end.position - from.position).length_squared();
                    let nearest = ends
                        .iter()
                        .filter(|end| end.normal.dot(normal) > 0.0)
                        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
                    let to = nearest.map_or(from.position, |end| end.position);
                    (Segment { from, to }, nearest.is_some())
                })
                .unzip();
            let connected = prover.are_connected(&segments, Some(&region));
            for k in (0..group.len()).filter(|&k| !(has_other[k] && connected[k])) {
                kept.push(group[k]);
                ends.push(segments[k].from);
            }
        }
    }
    kept
}
