//! The audit at the end of a run: whether a particle lies on the component of every witness.
//!
//! The audit says which components hold particles, after the relaxation has moved them. So each
//! witness is connected with a particle again, by proof. If that fails and no particle near it even
//! seems to be on its sheet, the witness is reported as [`Unsampled`], with the distance to which
//! its component can be explored.

use crate::field::{Bounded, Enclosure};
use crate::math::newton::step_to_surface;
use crate::math::{Bounds, Interval, ROUNDING, Sym3, sort_few};
use crate::particles::Particles;
use crate::sampler::discovery::completeness::Unsampled;
use crate::sampler::discovery::octree::{Region, Seed};
use crate::sampler::discovery::sheets::{ExactPoint, Prover, Segment, TOGETHER, value_at};
use crate::sampler::probe::Probe;
use crate::sampler::sheet::{PointPair, SheetRule};
use crate::spatial::tree::Tree;
use glam::DVec3;

/// Particles within this many of their radii of a witness are tried. A closed cover leaves no hole
/// larger than 1.85. Smaller: components with particles seem to have none.
const REACH: f32 = 2.5;
/// Particles assigned to the witnesses around them in one unit of work: a search in a tree takes an
/// eighth of the time of placing a particle.
const SCANNED: usize = 8;
/// Units of work that a witness counts for. One takes 21,000 to 190,000 instructions as a seed and
/// 87,000 to 410,000 in the audit, and a unit of the front 2,400 to 5,100.
pub(super) const UNITS: u32 = 32;
/// After this many named components and open witnesses the remaining witnesses are not examined and
/// count as open.
const MOST_NAMED: usize = 256;
/// Distance, in radii, to which a component without a particle is explored. One that reaches
/// farther has room for a child, at two radii.
pub(super) const EXPLORED: f64 = 4.0;

/// A particle near a witness.
#[derive(Clone, Copy, Debug)]
struct NearParticle {
    index: usize,
    distance_sq: f32,
}

/// The state of an audit, and its findings.
#[derive(Clone, Debug, Default)]
pub(crate) struct Audit {
    /// The particles nearest to each witness, nearest first.
    near: Vec<Vec<NearParticle>>,
    /// Index of the next particle to assign, then of the next witness.
    next: usize,
    /// Whether all particles have been assigned.
    is_scanned: bool,
    is_done: bool,
    /// Number of witnesses that are neither proven to be on the component of a particle nor named.
    pub(crate) open: u64,
    /// The first witness that is neither proven to be on the component of a particle nor named.
    pub(crate) first_open: DVec3,
    /// Components without a particle, each by its first witness.
    pub(crate) without: Vec<Unsampled>,
    /// The first witness of each component without a particle.
    named: Vec<Seed>,
}

/// Input of an audit.
pub(crate) struct Audited<'a, 'b> {
    pub(crate) probe: &'a mut Probe<'b>,
    pub(crate) particles: &'a Particles,
    pub(crate) seeds: &'a [Seed],
    /// Largest distance of a particle from the surface.
    pub(crate) slack: f64,
    /// Usual radius of a particle.
    pub(crate) radius: f64,
    /// Rule that distinguishes sheets.
    pub(crate) rule: SheetRule,
    /// The region that was searched.
    pub(crate) region: Region,
}

impl Audit {
    /// Begins anew.
    pub(crate) fn restart(&mut self) {
        *self = Self::default();
    }

    /// Whether the audit is complete.
    pub(crate) fn is_done(&self) -> bool {
        self.is_done
    }

    /// Does up to `budget` units of the audit and returns what is left.
    pub(crate) fn step(&mut self, audited: &mut Audited, mut budget: u32) -> u32 {
        if !self.is_scanned {
            budget = self.scan(audited, budget);
        }
        while budget > 0 && self.is_scanned && !self.is_done {
            let Some(seed) = audited.seeds.get(self.next).copied() else {
                self.is_done = true;
                self.near = Vec::new();
                break;
            };
            if self.without.len() + self.open as usize >= MOST_NAMED {
                self.leave_open(seed.exact, (audited.seeds.len() - self.next) as u64);
                self.next = audited.seeds.len();
                continue;
            }
            let near = core::mem::take(&mut self.near[self.next]);
            self.look_at(audited, seed, &near);
            self.next += 1;
            budget = budget.saturating_sub(UNITS);
        }
        budget
    }

    /// Assigns particles to the witnesses near them.
    fn scan(&mut self, audited: &Audited, mut budget: u32) -> u32 {
        let Audited { particles, seeds, .. } = audited;
        self.near.resize(seeds.len(), Vec::new());
        let tree = Tree::of(seeds.iter().map(|seed| seed.position).zip(0..).collect());
        let mut found = Vec::new();
        while budget > 0 && self.next < particles.len() {
            let last = (self.next + SCANNED).min(particles.len());
            for i in self.next..last {
                let (p, reach) = (particles.local[i], REACH * particles.radius[i]);
                found.clear();
                tree.within_box(p - reach, p + reach, &mut found);
                for &k in &found {
                    let distance_sq = tree.position[k as usize].distance_squared(p);
                    let near = &mut self.near[tree.origin[k as usize] as usize];
                    let is_nearer = near.len() < TOGETHER || distance_sq < near[TOGETHER - 1].distance_sq;
                    if distance_sq <= reach * reach && is_nearer {
                        near.truncate(TOGETHER - 1);
                        let place = near.partition_point(|other| other.distance_sq <= distance_sq);
                        near.insert(place, NearParticle { index: i, distance_sq });
                    }
                }
            }
            self.next = last;
            budget -= 1;
        }
        if self.next == particles.len() {
            (self.is_scanned, self.next) = (true, 0);
        }
        budget
    }

    /// Counts this many witnesses, beginning with this one, as open.
    fn leave_open(&mut self, first: DVec3, count: u64) {
        self.first_open = if self.open == 0 { first } else { self.first_open };
        self.open += count;
    }

    /// Decides whether the component of a witness holds one of the particles near it.
    fn look_at(&mut self, audited: &mut Audited, seed: Seed, near: &[NearParticle]) {
        let Audited { probe, particles, slack, radius, rule, region, .. } = audited;
        let Seed { exact, factor, .. } = seed;
        let Some(field) = probe.field.bounded() else { return };
        let normal = value_at(field, factor, exact).1.try_normalize().unwrap_or(DVec3::Z);
        let from = ExactPoint { position: exact, normal };
        let near = on_factor(field, factor, particles, near, *slack);
        let place_of = |j: usize| particles.local[j].as_dvec3();
        let segments: Vec<Segment> =
            near.iter().take(TOGETHER).map(|&j| Segment { from, to: place_of(j) }).collect();
        let mut prover = Prover { field, factor, slack: *slack, region: *region };
        let is_held = prover.are_connected(&segments, None).contains(&true)
            || segments.iter().any(|&segment| prover.is_connected(segment));
        if is_held {
            return;
        }
        let seen = &mut Probe::new(&mut *prover.field, probe.memory);
        let seems_held = near.iter().take(TOGETHER).any(|&j| {
            let offset = particles.local[j] - seed.position;
            let pair = PointPair { offset, normal: seed.normal, other: particles.normal[j] };
            pair.faces_one_way() && rule.is_one_sheet(seen, seed.position, pair)
        });
        if seems_held {
            self.leave_open(exact, 1);
            return;
        }
        let most = EXPLORED * *radius;
        if self.is_on_named(&mut prover, from, most) {
            return;
        }
        self.without.push(explore(prover.field, factor, exact, most));
        self.named.push(seed);
    }

    /// Whether a witness within `reach` of a named one is proven to be on the same component.
    fn is_on_named(&self, prover: &mut Prover, from: ExactPoint, reach: f64) -> bool {
        let of_factor = self.named.iter().filter(|named| named.factor == prover.factor);
        let mut near: Vec<(f64, DVec3)> = of_factor
            .map(|named| (named.exact.distance(from.position), named.exact))
            .filter(|&(distance, _)| distance <= reach)
            .collect();
        sort_few(&mut near, |a, b| a.0 < b.0);
        near.truncate(TOGETHER);
        near.into_iter().any(|(_, to)| {
            let segment = Segment { from, to };
            prover.is_connected(segment) || is_connected_along(prover, segment, reach)
        })
    }
}

/// The particles near a witness that lie on the factor of the field that vanishes there: the others
/// are on other sheets.
fn on_factor(
    field: &mut dyn Bounded,
    factor: usize,
    particles: &Particles,
    near: &[NearParticle],
    slack: f64,
) -> Vec<usize> {
    let boxes: Vec<Bounds> =
        near.iter().map(|near| Bounds::point(particles.local[near.index].as_dvec3())).collect();
    let mut known = vec![Enclosure::UNKNOWN; boxes.len()];
    field.enclose(factor, &boxes, &mut known);
    let index_if_on = |(near, known): (&NearParticle, Enclosure)| {
        let p = particles.local[near.index].as_dvec3();
        let steepest = DVec3::from_array(known.gradient.map(Interval::magnitude)).length();
        // At least as near as the particle is to its own sheet: another factor's sheet may be
        // within the slack too.
        let (value, gradient) = field.value_and_gradient(p);
        let own = value.abs() / gradient.length() + ROUNDING * p.abs().max_element();
        (known.value.magnitude() <= 2.0 * own.min(slack) * steepest).then_some(near.index)
    };
    near.iter().zip(known).filter_map(index_if_on).collect()
}

/// Steps of a path. A circle takes 32, the long way around a spheroid with axes of 1 and 3 takes
/// 200. With fewer a small component may count twice.
const STEPS: u32 = 256;

/// Paths along cuts of the zero set of a factor of the field with planes.
struct Paths<const N: usize> {
    at: [DVec3; N],
    heading: [DVec3; N],
    /// The plane of each path is perpendicular to this.
    across: [DVec3; N],
    /// Length of a step.
    step: f64,
}

impl<const N: usize> Paths<N> {
    /// Paths from a point with this unit normal in these directions, perpendicular to it, which
    /// lead to a distance of `most`.
    fn new(
        (field, factor): (&mut dyn Bounded, usize),
        ExactPoint { position, normal }: ExactPoint,
        heading: [DVec3; N],
        most: f64,
    ) -> Self {
        /// A step as a share of the radius of curvature: its sagitta is a fiftieth of that.
        const SHARE: f64 = 0.2;
        /// Largest step as a share of `most`: a path that is flat at its start may bend farther on.
        const LARGEST: f64 = 1.0 / 16.0;
        let gradient = value_at(field, factor, position).1;
        let mut second = [Sym3::splat(Interval::EVERYTHING)];
        field.enclose_second(factor, &[Bounds::point(position)], &mut second);
        let most_second = second[0].entries().into_iter().map(Interval::magnitude).fold(0.0, f64::max);
        let bend = most_second / gradient.length();
        let across = heading.map(|direction| normal.cross(direction));
        // `min` passes over a NaN.
        Self { at: [position; N], heading, across, step: (SHARE / bend).min(LARGEST * most) }
    }

    /// Makes a step on each path.
    fn advance(&mut self, field: &mut dyn Bounded, factor: usize) {
        let Self { at, heading, across, step } = self;
        let mut known = [Enclosure::UNKNOWN; N];
        let mut next: [DVec3; N] = core::array::from_fn(|k| at[k] + heading[k] * *step);
        // Two Newton steps in the planes.
        for _ in 0..2 {
            field.enclose(factor, &next.map(Bounds::point), &mut known);
            for k in 0..N {
                let (value, gradient) = known[k].middle();
                let within = gradient - across[k] * gradient.dot(across[k]);
                let correction = step_to_surface((value, within));
                if correction.is_finite() {
                    next[k] -= correction.clamp_length_max(*step);
                }
                let along = across[k].cross(within).normalize_or_zero();
                let along = if along.dot(next[k] - at[k]) < 0.0 { -along } else { along };
                heading[k] = if along == DVec3::ZERO { heading[k] } else { along };
            }
        }
        *at = next;
    }
}

/// Explores the zero set of a factor of the field from its point `from`, to a distance of `most`:
/// along its cuts with eight half-planes through the normal.
pub(crate) fn explore(field: &mut dyn Bounded, factor: usize, from: DVec3, most: f64) -> Unsampled {
    /// Eight lanes. The reach of a path half-way between two axes of an ellipse is at least 0.92 of
    /// the longer one: cos 22.5°.
    const PATHS: usize = 8;
    let normal = value_at(field, factor, from).1.try_normalize().unwrap_or(DVec3::Z);
    let (u, v) = crate::math::tangent_frame(normal.as_vec3());
    let outward: [DVec3; PATHS] = core::array::from_fn(|k| {
        let angle = core::f64::consts::TAU * k as f64 / PATHS as f64;
        u.as_dvec3() * libm::cos(angle) + v.as_dvec3() * libm::sin(angle)
    });
    let start = ExactPoint { position: from, normal };
    let mut paths = Paths::new((&mut *field, factor), start, outward, most);
    let mut farthest = [0.0_f64; PATHS];
    // A path is closed once it returns to its start in the direction in which it left.
    let mut is_closed = [false; PATHS];
    let reach_of = |farthest: [f64; PATHS]| farthest.into_iter().fold(0.0, f64::max);
    for _ in 0..STEPS {
        paths.advance(field, factor);
        for k in 0..PATHS {
            let distance = (paths.at[k] - from).length();
            let has_returned = distance < paths.step && farthest[k] > paths.step;
            is_closed[k] |= has_returned && paths.heading[k].dot(outward[k]) > 0.0;
            farthest[k] = farthest[k].max(distance);
        }
        if reach_of(farthest) > most {
            return Unsampled { position: from.to_array(), reach: most, goes_on: true };
        }
        if !is_closed.contains(&false) {
            break;
        }
    }
    let goes_on = is_closed.contains(&false);
    Unsampled { position: from.to_array(), reach: reach_of(farthest), goes_on }
}

/// Whether the two points of a segment are proven to be connected along the cut of the zero set
/// with the plane through both that contains the normal at the first, one way or the other, no
/// farther than `most` from that one.
fn is_connected_along(prover: &mut Prover, Segment { from, to }: Segment, most: f64) -> bool {
    let Some(across) = from.normal.cross(to - from.position).try_normalize() else { return false };
    let ahead = across.cross(from.normal);
    let factor = prover.factor;
    let mut paths = Paths::new((&mut *prover.field, factor), from, [ahead, -ahead], most);
    let mut ends = [Some(from); 2];
    for _ in 0..STEPS {
        paths.advance(prover.field, factor);
        for (end, at) in ends.iter_mut().zip(&mut paths.at) {
            let Some(before) = *end else { continue };
            let next = prover.land(*at).filter(|next| {
                next.position.distance(from.position) <= most
                    && prover.is_connected_by_segments(Segment { from: before, to: next.position })
            });
            if let Some(next) = next {
                *at = next.position;
                if next.position.distance(to) <= paths.step
                    && prover.is_connected_by_segments(Segment { from: next, to })
                {
                    return true;
                }
            }
            *end = next;
        }
        if ends.iter().all(Option::is_none) {
            return false;
        }
    }
    false
}

/// Whether one of the particles with these indices lies on the small piece around a seed, which has
/// this reach.
pub(crate) fn holds_any(
    field: &mut dyn Bounded,
    particles: &Particles,
    seed: Seed,
    reach: f64,
    mut indices: impl Iterator<Item = usize>,
    slack: f64,
) -> bool {
    indices.any(|j| {
        let p = particles.local[j].as_dvec3();
        let (value, gradient) = value_at(field, seed.factor, p);
        (p - seed.exact).length() <= reach && value.abs() <= 2.0 * slack * gradient.length()
    })
}
