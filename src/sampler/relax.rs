//! Relaxation by Gaussian repulsion, paper §4.5 after Witkin and Heckbert 1994, §4: no fission, no death, one radius.
//!
//! Each pair has the energy exp(−d²/2σ²) with σ = r; every particle moves against its gradient in the tangent plane and
//! is brought back onto the surface. The hexagonal lattice of spacing 2r is then close to equilibrium (2.017 r).
//!
//! # Differs from the paper
//!
//! * The pair energy is cut off at 3σ and shifted so that it ends at zero: the sum is continuous in the positions.
//! * The step is not the fixed dt = 0.03 of Witkin and Heckbert but as large as stays stable: a step that does not lower
//!   the energy is taken back and halved, so the energy falls at every step.

use super::pairs::Pairs;
use super::project::{BATCH, Projector, Tolerance};
use super::uniform::CELL_PER_REACH;
use crate::field::Field;
use crate::math::Bounds;
use crate::particles::Particles;
use crate::spatial::{CellGrid, Neighbour, Vicinity};
use glam::Vec3;

/// Range of the repulsion in σ.
pub(super) const CUT_OFF: f32 = 3.0;
/// The neighbour lists reach this much farther, in σ, so that they serve while particles move. It was chosen by counting
/// instructions: a wider one lengthens every list, a narrower one has more of them made anew.
pub(super) const SKIN: f32 = 0.4;
/// First step size, in units of σ². The stiffest wave of the hexagonal lattice at spacing 2σ has the eigenvalue 2.2 / σ²,
/// so steps below 0.9 are stable there; where rows are squeezed to 1.7σ, below 0.7. Longer steps reach no lower energy in
/// ten steps and set the squeezed rows trembling.
const FIRST_STEP: f32 = 0.6;
/// Step sizes halve after a failure and grow back by this factor after a success.
const GROWTH: f32 = 1.05;
/// Largest step size.
const MAX_STEP: f32 = FIRST_STEP;
/// No particle moves farther than this in one step, in σ.
const MAX_MOVE: f32 = 0.35;
/// Failures in a row after which the configuration counts as being at its minimum.
const MAX_FAILURES: u32 = 6;
/// Evaluations to bring one particle back onto the surface.
const MAX_NEWTON: u32 = 6;
/// A Newton correction shorter than this, in σ, leaves a residual of the order of its square.
const TRUSTED_CORRECTION: f32 = 0.02;

/// What a relaxation does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Put the particles around those who have gone far into the grid.
    Grid,
    /// Make the lists of those who have gone far anew.
    Refresh,
    Forces,
    Judge,
    Move,
    Restore,
    Polish,
    Done,
}

/// A relaxation under way.
#[derive(Clone, Debug)]
pub(super) struct Relaxation {
    radius: f32,
    tolerance: Tolerance,
    bounds: Bounds,
    target: u32,
    done: u32,
    stage: Stage,
    next: usize,
    found: Vec<Neighbour>,
    list: Vec<u32>,
    /// Particles that have gone far since their lists were made.
    far: Vec<u32>,
    vicinity: Vicinity,
    /// Whether all lists are made anew.
    all: bool,
    /// Length of each particle's way since its lists were made.
    way: Vec<f32>,
    /// Sum of (p_i − p_j) exp(−d²/2σ²) over the neighbours.
    force: Vec<Vec3>,
    /// Positions before the step under judgement; empty before the first.
    previous: Vec<Vec3>,
    has_previous: bool,
    step_size: f32,
    failures: u32,
    /// Energy of the positions whose forces are being computed.
    sum: f64,
    pub(super) energy: Vec<f64>,
}

impl Relaxation {
    pub(super) fn new() -> Self {
        Self {
            radius: 1.0,
            tolerance: Tolerance::default(),
            bounds: Bounds::cube(1.0),
            target: 0,
            done: 0,
            stage: Stage::Done,
            next: 0,
            found: Vec::new(),
            list: Vec::new(),
            far: Vec::new(),
            vicinity: Vicinity::default(),
            all: false,
            way: Vec::new(),
            force: Vec::new(),
            previous: Vec::new(),
            has_previous: false,
            step_size: FIRST_STEP,
            failures: 0,
            sum: 0.0,
            energy: Vec::new(),
        }
    }

    /// Forgets an earlier run.
    pub(super) fn clear(&mut self) {
        self.done = 0;
        self.stage = Stage::Done;
        self.energy.clear();
        self.step_size = FIRST_STEP;
    }

    /// Goes on until `target` steps are done in all. `pairs` are the lists of the front, if it was not cut short.
    pub(super) fn begin(
        &mut self,
        radius: f32,
        tolerance: Tolerance,
        bounds: &Bounds,
        target: u32,
        particles: usize,
        pairs: &mut Pairs,
    ) {
        self.radius = radius;
        self.tolerance = tolerance;
        self.bounds = *bounds;
        self.target = target;
        self.has_previous = false;
        self.failures = 0;
        self.energy.truncate(self.done as usize);
        self.way.clear();
        self.way.resize(particles, 0.0);
        self.far.clear();
        self.all = false;
        if pairs.len() == particles && self.done == 0 {
            self.begin_forces(particles);
        } else {
            pairs.extend_to(particles);
            self.far.extend(0..particles as u32);
            self.all = true;
            self.enter(Stage::Grid);
        }
    }

    pub(super) fn is_done(&self) -> bool {
        self.stage == Stage::Done
    }

    pub(super) fn steps_done(&self) -> u32 {
        self.done
    }

    /// Takes back a step that is only half made. Returns whether positions changed.
    pub(super) fn abandon(&mut self, particles: &mut Particles) -> bool {
        let half_made = matches!(self.stage, Stage::Move | Stage::Restore);
        if half_made {
            particles.position[..self.next].copy_from_slice(&self.previous[..self.next]);
        }
        self.stage = Stage::Done;
        half_made
    }

    fn enter(&mut self, stage: Stage) {
        self.stage = stage;
        self.next = 0;
    }

    /// Does up to `budget` units (one particle in one stage); returns what is left and whether particles moved.
    pub(super) fn step(
        &mut self,
        field: &mut dyn Field,
        projector: &mut Projector,
        grid: &mut CellGrid,
        pairs: &mut Pairs,
        particles: &mut Particles,
        mut budget: u32,
    ) -> (u32, bool) {
        let mut moved = false;
        while budget > 0 && self.stage != Stage::Done {
            let n = if self.stage == Stage::Refresh { self.far.len() } else { particles.len() };
            let last = n.min(self.next + budget as usize);
            let range = self.next..last;
            budget -= range.len() as u32;
            self.next = last;
            match self.stage {
                Stage::Grid => {
                    if range.start == 0 {
                        grid.reset(CELL_PER_REACH * self.list_reach());
                        self.vicinity.reset(self.list_reach(), self.far.len());
                        for &i in &self.far {
                            self.vicinity.add(particles.position[i as usize]);
                        }
                    }
                    for i in range {
                        let p = particles.position[i];
                        if self.all || self.vicinity.may_hold(p) {
                            grid.insert(p, i as u32);
                        }
                    }
                    if last == n {
                        self.enter(Stage::Refresh);
                    }
                }
                Stage::Refresh => {
                    for k in range {
                        self.refresh(grid, pairs, particles, self.far[k] as usize);
                    }
                    if last == n {
                        self.far.clear();
                        self.all = false;
                        self.begin_forces(particles.len());
                    }
                }
                Stage::Forces => {
                    for i in range {
                        self.repel(pairs, particles, i);
                    }
                    if last == n {
                        self.enter(Stage::Judge);
                    }
                }
                Stage::Judge => self.judge(particles),
                Stage::Move => {
                    for first in (range.start..last).step_by(BATCH) {
                        self.advance(field, projector, particles, first..last.min(first + BATCH));
                    }
                    moved |= !range.is_empty();
                    if last == n {
                        self.after_moving(n);
                    }
                }
                Stage::Restore => {
                    for i in range {
                        let back = (particles.position[i] - self.previous[i]).length();
                        particles.position[i] = self.previous[i];
                        self.went(i, back);
                    }
                    moved = true;
                    if last == n {
                        self.has_previous = false;
                        self.after_moving(n);
                    }
                }
                Stage::Polish => {
                    for first in (range.start..last).step_by(BATCH) {
                        self.polish(field, projector, particles, first..last.min(first + BATCH));
                    }
                    moved |= !range.is_empty();
                    if last == n {
                        self.enter(Stage::Done);
                    }
                }
                Stage::Done => {}
            }
        }
        (budget, moved)
    }

    fn begin_forces(&mut self, n: usize) {
        self.force.clear();
        self.force.resize(n, Vec3::ZERO);
        self.sum = 0.0;
        self.enter(Stage::Forces);
    }

    /// Goes on to the forces, by way of new lists where the old ones may miss a pair.
    fn after_moving(&mut self, n: usize) {
        if self.far.is_empty() {
            self.begin_forces(n);
        } else {
            self.enter(Stage::Grid);
        }
    }

    /// Radius within which the lists hold every pair.
    fn list_reach(&self) -> f32 {
        (CUT_OFF + SKIN) * self.radius
    }

    /// Notes that particle `i` has gone some way: two particles that have each gone half the skin may have come within
    /// the cut-off without being listed.
    #[inline]
    fn went(&mut self, i: usize, distance: f32) {
        let before = self.way[i];
        let after = before + distance;
        self.way[i] = after;
        let limit = 0.5 * SKIN * self.radius;
        if after > limit && before <= limit {
            self.far.push(i as u32);
        }
    }

    /// Makes the list of particle `i` anew: those of its sheet and of a smaller index within the cut-off and the skin.
    /// Those of a larger index get it into their lists.
    fn refresh(&mut self, grid: &CellGrid, pairs: &mut Pairs, particles: &Particles, i: usize) {
        self.way[i] = 0.0;
        grid.gather(particles.position[i], self.list_reach(), &mut self.found);
        let normal = particles.normal[i];
        self.list.clear();
        for &Neighbour { index: j, .. } in &self.found {
            if particles.normal[j as usize].dot(normal) <= 0.0 {
                continue;
            }
            if (j as usize) < i {
                self.list.push(j);
            } else if j as usize != i && !self.all {
                pairs.insert(j as usize, i as u32);
            }
        }
        pairs.replace(i, &self.list);
    }

    /// Adds the repulsion between particle `i` and its listed neighbours to the forces on both, and to the energy.
    #[inline]
    fn repel(&mut self, pairs: &Pairs, particles: &Particles, i: usize) {
        let p = particles.position[i];
        // Squared distances are measured in σ² = r².
        let scale = 0.5 / (self.radius * self.radius);
        let mut force = Vec3::ZERO;
        let mut energy = 0.0;
        for &j in pairs.of(i) {
            let d = p - particles.position[j as usize];
            let half_sq = d.length_squared() * scale;
            let near = half_sq < 0.5 * CUT_OFF * CUT_OFF;
            let weight = if near { gaussian(half_sq) } else { 0.0 };
            energy += if near { weight - CUT_OFF_ENERGY } else { 0.0 };
            force += d * weight;
            self.force[j as usize] -= d * weight;
        }
        self.force[i] += force;
        self.sum += f64::from(energy);
    }

    /// Accepts the last step or has it taken back.
    fn judge(&mut self, particles: &Particles) {
        let energy = self.sum / particles.len() as f64;
        if self.has_previous {
            let before = self.energy.last().copied().unwrap_or(f64::INFINITY);
            if energy >= before {
                self.step_size *= 0.5;
                self.failures += 1;
                return self.enter(Stage::Restore);
            }
            self.step_size = (self.step_size * GROWTH).min(MAX_STEP);
            self.failures = 0;
            self.done += 1;
        }
        // After a step taken back this is the energy of the same positions again; it differs only where a normal has
        // turned past 90° from a neighbour's, on creases that the radius does not resolve.
        self.energy.truncate(self.done as usize);
        self.energy.push(energy);
        if self.done >= self.target || self.failures > MAX_FAILURES {
            self.has_previous = false;
            return self.enter(Stage::Polish);
        }
        self.previous.resize(particles.len(), Vec3::ZERO);
        self.has_previous = true;
        self.enter(Stage::Move);
    }

    /// Moves a batch of particles along their forces and back onto the surface.
    fn advance(
        &mut self,
        field: &mut dyn Field,
        projector: &mut Projector,
        particles: &mut Particles,
        range: core::ops::Range<usize>,
    ) {
        let count = range.len();
        let mut points = [Vec3::ZERO; BATCH];
        let mut normals = [Vec3::ZERO; BATCH];
        let mut ok = [false; BATCH];
        let longest = MAX_MOVE * self.radius;
        for (point, i) in points.iter_mut().zip(range.clone()) {
            let p = particles.position[i];
            let normal = particles.normal[i];
            let force = self.force[i] - normal * normal.dot(self.force[i]);
            self.previous[i] = p;
            *point = p + (force * self.step_size).clamp_length_max(longest);
        }
        projector.land_along_gradient(
            field,
            &mut points[..count],
            &mut normals,
            &mut ok,
            self.tolerance,
            longest,
            TRUSTED_CORRECTION * self.radius,
            MAX_NEWTON,
        );
        for (k, i) in range.enumerate() {
            // A particle that cannot go stays: at the border of the box, where the field ends, at a fold.
            if ok[k] && self.bounds.contains(points[k]) && normals[k].dot(particles.normal[i]) > 0.0 {
                self.went(i, (points[k] - self.previous[i]).length());
                particles.position[i] = points[k];
                particles.normal[i] = normals[k];
            }
        }
    }

    /// Brings residual and normal of a batch to full accuracy.
    fn polish(
        &mut self,
        field: &mut dyn Field,
        projector: &mut Projector,
        particles: &mut Particles,
        range: core::ops::Range<usize>,
    ) {
        let count = range.len();
        let mut points = [Vec3::ZERO; BATCH];
        let mut normals = [Vec3::ZERO; BATCH];
        let mut ok = [false; BATCH];
        points[..count].copy_from_slice(&particles.position[range.clone()]);
        projector.land_along_gradient(
            field,
            &mut points[..count],
            &mut normals,
            &mut ok,
            self.tolerance,
            MAX_MOVE * self.radius,
            0.0,
            MAX_NEWTON,
        );
        for (k, i) in range.enumerate() {
            if ok[k] && self.bounds.contains(points[k]) {
                particles.position[i] = points[k];
                particles.normal[i] = normals[k];
            }
        }
    }
}

/// exp(−CUT_OFF²/2).
const CUT_OFF_ENERGY: f32 = 0.011_108_997;

/// exp(−x) for 0 ≤ x ≤ 4.5 to 2·10⁻⁵ of its value; of no meaning elsewhere.
///
/// exp(−x) = exp(−x/16)¹⁶ with the Taylor polynomial of degree 5, whose error at x/16 = 0.28 is 7·10⁻⁷.
#[inline(always)]
fn gaussian(x: f32) -> f32 {
    let y = x * (-1.0 / 16.0);
    let e = 1.0 + y * (1.0 + y * (0.5 + y * (1.0 / 6.0 + y * (1.0 / 24.0 + y * (1.0 / 120.0)))));
    let e2 = e * e;
    let e4 = e2 * e2;
    let e8 = e4 * e4;
    e8 * e8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaussian_is_accurate_within_the_cut_off() {
        for k in 0..=450 {
            let x = k as f32 * 0.01;
            let exact = libm::exp(-f64::from(x));
            let got = f64::from(gaussian(x));
            assert!((got / exact - 1.0).abs() < 3e-5, "x = {x}: {got} against {exact}");
        }
        let end = libm::exp(-0.5 * f64::from(CUT_OFF * CUT_OFF));
        assert!((f64::from(CUT_OFF_ENERGY) / end - 1.0).abs() < 1e-6);
    }
}
