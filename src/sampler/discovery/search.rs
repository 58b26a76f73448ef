//! The search for components as the sampler drives it: the [octree](super::octree), whose witnesses are seeds where the points of the
//! survey are covered, and the [audit](super::audit) at the end.

use crate::field::{Bounded, Field};
use crate::math::Bounds;
use crate::particles::Particles;
use crate::sampler::discovery::audit::{Audit, Audited, follow};
use crate::sampler::discovery::completeness::{Doubt, Sampled, Search};
use crate::sampler::discovery::nearness::{Nearness, nearest};
use crate::sampler::discovery::octree::{Octree, Seed, Witness};
use crate::sampler::discovery::sheets::{Oriented, TOGETHER, are_connected, is_connected_by_segments};
use crate::sampler::discovery::singular::Singular;
use crate::sampler::probe::{BATCH, Probe};
use crate::sampler::projection::{Descent, Tolerance};
use crate::sampler::sheet::{Pair, SheetRule};
use glam::{DVec3, Vec3};

/// Units of work that a witness counts for.
const UNITS: u32 = 16;
/// Largest number of particles with which a connection is tried.
const MOST_TRIED: usize = 6;
/// Largest number of particles with which a connection through a chain of segments is tried.
const MOST_TRIED_BY_SEGMENTS: usize = 2;
/// Largest number of evaluations in the projection of a witness onto the surface as single precision computes it.
const MAX_STEPS: u32 = 12;
/// Largest number of steps that move a witness from the margin around the box to its component inside.
const MOST_INWARD: u32 = 32;

/// The search, its witnesses and what became of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct ComponentSearch {
    octree: Octree,
    /// The witnesses on the surface as single precision computes it.
    points: Vec<Seed>,
    is_projected: bool,
    /// The next of them to be tried as a seed.
    next: usize,
    audit: Audit,
    /// Number of witnesses whose projection did not converge, and the first of them.
    lost: u64,
    first_lost: DVec3,
    /// The nearest sheet beside a witness, if it is nearer than particles tell apart.
    unresolved: Option<Nearness>,
    /// Scratch: particles near a witness.
    near: Vec<u32>,
}

/// Whether a witness needs a front of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cover {
    /// It lies on a component that has particles near it.
    Covered,
    /// A front has to start there.
    Bare,
}

impl ComponentSearch {
    /// Begins with a new field.
    pub(crate) fn begin(&mut self, field: &mut dyn Field, bounds: &Bounds) {
        self.octree.begin(field.bounded().is_some(), bounds);
        self.points.clear();
        (self.lost, self.unresolved) = (0, None);
        self.is_projected = false;
        self.restart();
    }

    /// Sets the expected number of particles.
    pub(crate) fn expect(&mut self, particles: f64) {
        self.octree.expect(particles);
    }

    /// Begins again with the first witness.
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

    /// Does up to `budget` units of the search. Returns the rest of the budget, 0 until the search is complete.
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
            self.project(probe, bounds, tolerance);
            self.unresolved = nearest(probe.field, self.points.iter().map(|seed| seed.exact), least_gap).0;
        }
        if self.octree.is_done() { left } else { 0 }
    }

    /// Projects the witnesses onto the surface as single precision computes it, and into the box.
    fn project(&mut self, probe: &mut Probe, bounds: &Bounds, tolerance: Tolerance) {
        let margin = self.octree.region.margin;
        if let Some(field) = probe.field.bounded() {
            self.thin_out(field, tolerance);
        }
        // A witness whose component lies in the margin alone is not needed.
        let starts: Vec<(DVec3, usize)> = self
            .octree
            .witnesses
            .iter()
            .filter_map(|&Witness { position, factor }| {
                let start = if bounds.holds(position) {
                    Some(position)
                } else {
                    moved_inside(probe.field, position, bounds, margin)
                };
                start.map(|p| (p, factor))
            })
            .collect();
        let mut normal = [Vec3::ZERO; BATCH];
        let mut ok = [false; BATCH];
        for starts in starts.chunks(BATCH) {
            let mut points: Vec<Vec3> = starts.iter().map(|start| start.0.as_vec3()).collect();
            let reach = margin as f32 + 16.0 * tolerance.residual;
            probe.land_along_gradient(
                &mut points,
                &mut normal,
                &mut ok,
                tolerance.min_gradient,
                &mut Descent { residual: tolerance.residual, reach, trust: 0.0 },
                MAX_STEPS,
            );
            for (k, &position) in points.iter().enumerate() {
                if ok[k] && bounds.contains(position) {
                    let (exact, factor) = starts[k];
                    self.points.push(Seed { position, normal: normal[k], exact, factor });
                } else {
                    self.first_lost = if self.lost == 0 { starts[k].0 } else { self.first_lost };
                    self.lost += 1;
                }
            }
        }
    }

    /// Drops witnesses that are connected with others within the box: along a ridge of equal height there are many.
    fn thin_out(&mut self, field: &mut dyn Bounded, tolerance: Tolerance) {
        let slack = f64::from(2.0 * tolerance.residual);
        let witnesses = core::mem::take(&mut self.octree.witnesses);
        let mut kept: Vec<(Witness, DVec3)> = Vec::new();
        for group in
            witnesses.chunk_by(|a, b| a.factor == b.factor).flat_map(|factor| factor.chunks(TOGETHER))
        {
            let factor = group[0].factor;
            let ends: Vec<Oriented> = group
                .iter()
                .map(|witness| {
                    let gradient = field.jet(witness.position).gradient;
                    (witness.position, gradient.try_normalize().unwrap_or(DVec3::Z))
                })
                .collect();
            let nearest: Vec<Option<DVec3>> = ends
                .iter()
                .map(|end| {
                    let distance = |p: DVec3| (p - end.0).length_squared();
                    kept.iter()
                        .filter(|(other, normal)| other.factor == factor && normal.dot(end.1) > 0.0)
                        .min_by(|(a, _), (b, _)| distance(a.position).total_cmp(&distance(b.position)))
                        .map(|(other, _)| other.position)
                })
                .collect();
            let pairs: Vec<(Oriented, DVec3)> =
                ends.iter().zip(&nearest).map(|(&end, nearest)| (end, nearest.unwrap_or(end.0))).collect();
            let connected = are_connected(field, factor, &pairs, slack, Some(&self.octree.region.bounds));
            for k in 0..group.len() {
                if nearest[k].is_none() || !connected[k] {
                    kept.push((group[k], ends[k].1));
                }
            }
        }
        self.octree.witnesses.extend(kept.into_iter().map(|(witness, _)| witness));
    }

    /// The next witness, if there is one, and what is left of the budget.
    pub(crate) fn next(&mut self, budget: u32) -> (Option<Seed>, u32) {
        let witness = self.points.get(self.next).copied();
        self.next += 1;
        (witness, budget.saturating_sub(UNITS))
    }

    /// Points where f and its gradient vanish together, as far as the search met them.
    pub(crate) fn singular(&self) -> &[Singular] {
        &self.octree.singular
    }

    /// All witnesses.
    pub(crate) fn points(&self) -> &[Seed] {
        &self.points
    }

    /// Room for the particles near a witness.
    pub(crate) fn take_near(&mut self) -> Vec<u32> {
        core::mem::take(&mut self.near)
    }

    /// Whether the witness lies on the component of one of the particles `near` it, the nearest first. By proof; or, where the
    /// bounds are too wide for one, by the field at a point between the two. The [audit](super::audit) asks again.
    pub(crate) fn cover(
        &mut self,
        probe: &mut Probe,
        particles: &Particles,
        seed: Seed,
        near: Vec<u32>,
        tolerance: Tolerance,
        rule: SheetRule,
    ) -> Cover {
        // Without bounds there is no witness.
        let Some(field) = probe.field.bounded() else { return Cover::Covered };
        let Seed { position, normal, factor, .. } = seed;
        let slack = f64::from(2.0 * tolerance.residual);
        let from = (position.as_dvec3(), normal.as_dvec3());
        let place_of = |j: u32| particles.position[j as usize].as_dvec3();
        let mut pairs = [(from, from.0); MOST_TRIED];
        let tried = near.len().min(MOST_TRIED);
        for (pair, &j) in pairs.iter_mut().zip(&near) {
            pair.1 = place_of(j);
        }
        let region = self.octree.region;
        let is_proven = are_connected(field, factor, &pairs[..tried], slack, None).contains(&true)
            || near
                .iter()
                .take(MOST_TRIED_BY_SEGMENTS)
                .any(|&j| is_connected_by_segments(field, factor, from, place_of(j), slack, &region));
        let is_covered = is_proven
            || near.iter().take(MOST_TRIED).any(|&j| {
                let j = j as usize;
                let offset = particles.position[j] - position;
                rule.is_one_sheet(probe, position, Pair { offset, normal, other: particles.normal[j] })
            });
        self.near = near;
        if is_covered { Cover::Covered } else { Cover::Bare }
    }

    /// The piece of the surface around the last witness, if it is small and closed in itself.
    pub(crate) fn small_piece(&self, field: &mut dyn Bounded, radius: f32) -> Option<(Seed, f64)> {
        /// Distance to which the piece is followed, in radii of a particle. Larger pieces have room for a child.
        const FOLLOWED: f64 = 4.0;
        let seed = *self.points.get(self.next.checked_sub(1)?)?;
        let piece = follow(field, seed.factor, seed.exact, FOLLOWED * f64::from(radius));
        (!piece.goes_on).then_some((seed, piece.reach))
    }

    /// Does up to `budget` units of the audit of the finished run, and returns what is left: 0 until the audit is complete.
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

    /// Whether there is a witness on every component, by proof.
    pub(crate) fn witnessed(&self) -> Search {
        if self.unwitnessed() == Some(0) { Search::Proven } else { Search::Searched }
    }

    /// Why it is not proven that there is a witness on every component, and of each witness that it is on the component of a
    /// particle or named; nothing where it is. Sheets nearer than `least_gap` are not told apart, of which the survey may have seen
    /// one.
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

    /// Which of the components hold particles; `is_proven` says whether there are no [doubts](Self::doubts).
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

    /// Cells left undecided, witnesses that were lost, and witnesses of which the audit does not know whether their component holds
    /// particles; none without a search.
    pub(crate) fn open_questions(&self) -> Option<u64> {
        self.unwitnessed().map(|open| open + self.audit.open)
    }
}

/// A point of the surface a margin inside the box, near `p` in the margin outside: by turns to the nearest point of the smaller
/// box and, along the gradient, to the surface. None where the surface does not reach into the box there.
fn moved_inside(field: &mut dyn Field, mut p: DVec3, bounds: &Bounds, margin: f64) -> Option<DVec3> {
    let inner = bounds.enlarged(-margin);
    for _ in 0..MOST_INWARD {
        p = p.clamp(inner.lo(), inner.hi());
        let jet = field.jet(p);
        let step = jet.gradient * (jet.value / jet.gradient.length_squared());
        if !step.is_finite() || step.length_squared() < 1e-6 * margin * margin {
            break;
        }
        p -= step;
    }
    bounds.holds(p).then_some(p)
}
