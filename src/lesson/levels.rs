//! Uniform sampling level by level, like the fast front: the children of a generation level are
//! predicted and compared; then the free ones are projected together and compared again.
//!
//! A child's position depends only on its parent, so the children of a level can be projected in
//! any order. Their fates are still decided in the order of the queue.

use super::course::{Course, Predicted};
use super::prediction::{predicted_angle, second_form};
use crate::paper::{ChildSlot, DIRECTIONS, Moment, Nearby, REACH, TangentFrame};
use crate::particles::SlotFate;
use glam::DVec3;

/// The curvature around a parent is fitted to particles within this many radii: the six ideal
/// neighbours are at 2, the next ring at 3.46.
const RING: f64 = 2.6;

/// Weight of "equal curvature in all directions" in that fit. It matters only if the neighbours
/// leave the curvature undetermined.
const ISOTROPY: f64 = 0.005;

impl Course {
    /// First stage: predicts the children of a particle and compares them at the predicted
    /// positions. The free ones wait for their projection.
    pub(super) fn predict(&mut self, particle: u32) {
        let radius = self.setup.settings.radius;
        let neighbours = self.run.gather(particle, REACH * radius);
        let frame = self.run.tangent_frame(particle);
        let form = if frame.is_seed {
            second_form(&mut self.run.surface, &frame)
        } else {
            self.fitted_form(radius, &frame, &neighbours)
        };
        self.run.tell(ChildSlot { parent: particle, slot: 0 }, Moment::Frame(&frame));
        let candidates = self.run.candidates(&neighbours);
        if let Some(parent) = self.run.particles[particle as usize].parent {
            self.run.decide(ChildSlot { parent: particle, slot: 0 }, SlotFate::Parent, Some(parent));
        }
        for slot in frame.slots() {
            let child = ChildSlot { parent: particle, slot: slot as u32 };
            let [cos, sin] = DIRECTIONS[slot];
            let theta_rad = predicted_angle(form, [cos, sin], radius);
            let circle = frame.circle(slot, radius, theta_rad);
            self.run.tell(child, Moment::Proposed(&circle));
            let position = circle.point(theta_rad);
            // The normal turns along the offset.
            let turn = frame.u * (form[0] * cos + form[1] * sin) + frame.w * (form[1] * cos + form[2] * sin);
            let normal = (frame.n + turn * (2.0 * radius * libm::cos(theta_rad))).normalize_or(frame.n);
            let placed = self.run.child(particle, (position, normal), radius);
            // Children that wait for their projection are numbered after the particles.
            let particles = self.run.particles.len() as u32;
            let predicted = (particles..).zip(self.predicted.iter().map(|child| child.placed));
            if let Some(other) =
                self.run.corresponding(child, &placed, candidates.iter().copied().chain(predicted))
            {
                let particle = Some(other).filter(|&other| other < particles);
                self.run.decide(child, SlotFate::Matched, particle);
            } else if self.run.particles.len() + self.predicted.len() >= self.run.rules.max_particles {
                self.run.decide(child, SlotFate::Capped, None);
            } else {
                self.predicted.push_back(Predicted { child, circle, placed });
            }
        }
    }

    /// Second stage: projects the next child and decides its fate at its final position.
    pub(super) fn settle_next(&mut self) {
        let Some(Predicted { child, circle, .. }) = self.predicted.pop_front() else { return };
        let landing = self.run.land(child, &circle);
        let Some(place) = self.run.usable(child, landing) else { return };
        let placed = self.run.child(child.parent, place, self.setup.settings.radius);
        let reach = 2.0 * placed.radius * self.run.rules.match_tolerance;
        let neighbours = self.run.buckets.near(&self.run.particles, placed.p(), reach);
        // There is room, since predicted children were counted.
        self.run.settle(child, placed, &neighbours);
    }

    /// Second fundamental form [a, b, c] fitted to the normals around a particle by least squares.
    fn fitted_form(&self, radius: f64, frame: &TangentFrame, neighbours: &[Nearby]) -> [f64; 3] {
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        let (mut xa, mut ya, mut xb, mut yb) = (0.0, 0.0, 0.0, 0.0);
        for near in neighbours.iter().filter(|near| near.distance <= RING * radius) {
            let other = &self.run.particles[near.particle as usize];
            let (offset, turn) = (other.p() - frame.p, other.n() - frame.n);
            // A normal that differs by more than 60° is beyond a crease or on another sheet.
            if turn.length_squared() > 1.0 {
                continue;
            }
            let [x, y] = [offset.dot(frame.u), offset.dot(frame.w)];
            let [a, b] = [turn.dot(frame.u), turn.dot(frame.w)];
            (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
            (xa, ya, xb, yb) = (xa + x * a, ya + y * a, xb + x * b, yb + y * b);
        }
        // Normal equations of a x + b y and b x + c y with the prior (a − c)² + b², solved by
        // Cramer's rule.
        let pull = ISOTROPY * (xx + yy);
        let matrix = [
            DVec3::new(xx + pull, xy, -pull),
            DVec3::new(xy, xx + yy + pull, xy),
            DVec3::new(-pull, xy, yy + pull),
        ];
        let right = DVec3::new(xa, ya + xb, yb);
        let [c0, c1, c2] = matrix;
        let determinant = c0.dot(c1.cross(c2));
        let form = [
            right.dot(c1.cross(c2)) / determinant,
            c0.dot(right.cross(c2)) / determinant,
            c0.dot(c1.cross(right)) / determinant,
        ];
        if form.iter().all(|value| value.is_finite()) { form } else { [0.0; 3] }
    }
}
