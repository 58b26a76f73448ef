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

use super::project::{BATCH, Projector, Tolerance};
use crate::field::Field;
use crate::math::{Bounds, LANES, Lanes};
use crate::particles::Particles;
use crate::spatial::{CellGrid, Neighbours};
use glam::Vec3;

/// Range of the repulsion in σ.
const CUT_OFF: f32 = 3.0;
/// The neighbour lists reach this much farther, in σ, so that they serve while particles move. The second ring of the
/// lattice begins at 3.46.
const SKIN: f32 = 0.4;
/// First step size, in units of σ²: the stiffest wave of the hexagonal lattice has the eigenvalue 2.2 / σ², so
/// steps below 0.9 are stable.
const FIRST_STEP: f32 = 0.7;
/// Step sizes grow by this factor after a success and halve after a failure.
const GROWTH: f32 = 1.05;
/// Largest step size.
const MAX_STEP: f32 = 0.8;
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
    Grid,
    Lists,
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
    /// Neighbours of particle i: `list[start[i]..start[i + 1]]`.
    start: Vec<u32>,
    list: Vec<u32>,
    found: Neighbours,
    /// Sum of (p_i − p_j) exp(−d²/2σ²) over the neighbours, in the tangent plane.
    force: Vec<Vec3>,
    /// Positions before the step under judgement; empty before the first.
    previous: Vec<Vec3>,
    has_previous: bool,
    step_size: f32,
    failures: u32,
    /// Twice the energy of the positions whose forces are being computed.
    sum: f64,
    /// Largest distance any particle has gone since the lists were made.
    travelled: f32,
    largest_move: f32,
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
            start: Vec::new(),
            list: Vec::new(),
            found: Neighbours::default(),
            force: Vec::new(),
            previous: Vec::new(),
            has_previous: false,
            step_size: FIRST_STEP,
            failures: 0,
            sum: 0.0,
            travelled: 0.0,
            largest_move: 0.0,
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

    /// Goes on until `target` steps are done in all.
    pub(super) fn begin(&mut self, radius: f32, tolerance: Tolerance, bounds: &Bounds, target: u32) {
        self.radius = radius;
        self.tolerance = tolerance;
        self.bounds = *bounds;
        self.target = target;
        self.has_previous = false;
        self.failures = 0;
        self.energy.truncate(self.done as usize);
        self.enter(Stage::Grid);
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
        particles: &mut Particles,
        mut budget: u32,
    ) -> (u32, bool) {
        let mut moved = false;
        while budget > 0 && self.stage != Stage::Done {
            let n = particles.len();
            let last = n.min(self.next + budget as usize);
            let range = self.next..last;
            budget -= range.len() as u32;
            self.next = last;
            match self.stage {
                Stage::Grid => {
                    if range.start == 0 {
                        grid.reset((CUT_OFF + SKIN) * 1.2 * self.radius);
                    }
                    for i in range {
                        grid.insert(particles.position[i], i as u32);
                    }
                    if last == n {
                        self.start.clear();
                        self.list.clear();
                        self.start.reserve_exact(n + 1);
                        self.start.push(0);
                        self.enter(Stage::Lists);
                    }
                }
                Stage::Lists => {
                    for i in range {
                        self.collect(grid, particles, i);
                    }
                    if last == n {
                        grid.release();
                        self.travelled = 0.0;
                        self.force.resize(n, Vec3::ZERO);
                        self.sum = 0.0;
                        self.enter(Stage::Forces);
                    }
                }
                Stage::Forces => {
                    for i in range {
                        self.repel(particles, i);
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
                        self.travelled += self.largest_move;
                        self.sum = 0.0;
                        // Two particles may have approached each other by twice what each has travelled.
                        let stale = 2.0 * self.travelled > SKIN * self.radius;
                        self.enter(if stale { Stage::Grid } else { Stage::Forces });
                    }
                }
                Stage::Restore => {
                    particles.position[range.clone()].copy_from_slice(&self.previous[range]);
                    moved = true;
                    if last == n {
                        self.travelled += self.largest_move;
                        self.has_previous = false;
                        self.sum = 0.0;
                        let stale = 2.0 * self.travelled > SKIN * self.radius;
                        self.enter(if stale { Stage::Grid } else { Stage::Forces });
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

    /// Neighbour list of particle `i`: those of its sheet within the cut-off and the skin.
    fn collect(&mut self, grid: &CellGrid, particles: &Particles, i: usize) {
        let reach = (CUT_OFF + SKIN) * self.radius;
        grid.gather(particles.position[i], reach, &mut self.found);
        let normal = particles.normal[i];
        for &j in &self.found.index[..self.found.len()] {
            if j as usize != i && particles.normal[j as usize].dot(normal) > 0.0 {
                self.list.push(j);
            }
        }
        self.start.push(self.list.len() as u32);
    }

    /// Force on particle `i` and its part of the energy.
    #[inline]
    fn repel(&mut self, particles: &Particles, i: usize) {
        let list = &self.list[self.start[i] as usize..self.start[i + 1] as usize];
        let p = particles.position[i];
        // Distances are measured in σ.
        let inverse_radius = 1.0 / self.radius;
        let (mut fx, mut fy, mut fz) = (Lanes::splat(0.0), Lanes::splat(0.0), Lanes::splat(0.0));
        let mut energy = Lanes::splat(0.0);
        for chunk in list.chunks(LANES) {
            // Lanes without a neighbour hold a point beyond the cut-off.
            let far = CUT_OFF * 2.0 * self.radius;
            let (mut dx, mut dy, mut dz) = (Lanes::splat(far), Lanes::splat(0.0), Lanes::splat(0.0));
            for (lane, &j) in chunk.iter().enumerate() {
                let d = p - particles.position[j as usize];
                (dx.0[lane], dy.0[lane], dz.0[lane]) = (d.x, d.y, d.z);
            }
            let scale = Lanes::splat(inverse_radius);
            let (dx, dy, dz) = (dx * scale, dy * scale, dz * scale);
            let half_sq = (dx * dx + dy * dy + dz * dz) * Lanes::splat(0.5);
            let weight = gaussian(half_sq);
            let shifted = weight - Lanes::splat(CUT_OFF_ENERGY);
            let near = |w: Lanes| {
                Lanes(core::array::from_fn(
                    |k| if half_sq.0[k] < 0.5 * CUT_OFF * CUT_OFF { w.0[k] } else { 0.0 },
                ))
            };
            let weight = near(weight);
            energy += near(shifted);
            fx += dx * weight;
            fy += dy * weight;
            fz += dz * weight;
        }
        let force = Vec3::new(fx.sum(), fy.sum(), fz.sum()) * self.radius;
        let normal = particles.normal[i];
        self.force[i] = force - normal * force.dot(normal);
        self.sum += f64::from(energy.sum());
    }

    /// Accepts the last step or has it taken back.
    fn judge(&mut self, particles: &Particles) {
        let energy = 0.5 * self.sum / particles.len() as f64;
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
        if self.energy.len() == self.done as usize {
            self.energy.push(energy);
        }
        if self.done >= self.target || self.failures > MAX_FAILURES {
            self.has_previous = false;
            return self.enter(Stage::Polish);
        }
        self.has_previous = true;
        self.previous.resize(particles.len(), Vec3::ZERO);
        self.largest_move = 0.0;
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
            self.previous[i] = p;
            *point = p + (self.force[i] * self.step_size).clamp_length_max(longest);
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
                let travelled = (points[k] - self.previous[i]).length();
                self.largest_move = self.largest_move.max(travelled);
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
fn gaussian(x: Lanes) -> Lanes {
    let y = x * Lanes::splat(-1.0 / 16.0);
    let c = |value: f32| Lanes::splat(value);
    let e =
        c(1.0) + y * (c(1.0) + y * (c(0.5) + y * (c(1.0 / 6.0) + y * (c(1.0 / 24.0) + y * c(1.0 / 120.0)))));
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
            let got = f64::from(gaussian(Lanes::splat(x)).0[0]);
            assert!((got / exact - 1.0).abs() < 3e-5, "x = {x}: {got} against {exact}");
        }
        let end = libm::exp(-0.5 * f64::from(CUT_OFF * CUT_OFF));
        assert!((f64::from(CUT_OFF_ENERGY) / end - 1.0).abs() < 1e-6);
    }
}
