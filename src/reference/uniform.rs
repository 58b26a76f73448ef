//! Uniform sampling, paper §4: Algorithm 2, particle by particle, and the same level by level as the fast front does it.

use super::event::{Event, Nearby};
use super::settings::{Matched, Order, Projection, Start};
use super::state::is_same_sheet;
use super::surface::{Circle, Landing, Surface, Trial};
use super::walk::{Child, Setup, Walk};
use crate::math::frame_of;
use crate::particles::SlotFate;
use glam::DVec3;

/// Directions of the six slots in the frame (V̂⁰, N̂ × V̂⁰): §4.2, (cos iπ/3, sin iπ/3).
const DIRECTIONS: [[f64; 2]; 6] = {
    const SIN_60: f64 = 0.866_025_403_784_438_6;
    [[1.0, 0.0], [0.5, SIN_60], [-0.5, SIN_60], [-1.0, 0.0], [-0.5, -SIN_60], [0.5, -SIN_60]]
};

/// Neighbours are gathered within this many radii: a child at 2r meets particles up to 2r + the match radius from its parent.
const REACH: f64 = 4.0;

/// Slack of the sheet test, as a share of the match radius.
const RISE_SLACK: f64 = 0.5;

/// A child that meets a particle farther away than this share of 2r is out of step with it. In a lattice it is below 0.2.
pub(super) const SEAM: f64 = 0.35;

/// Particles within this many radii tell the curvature around a parent: the six ideal neighbours are at 2, the next ring at 3.46.
const RING: f64 = 2.6;

/// Weight of "equal curvature in all directions" in that fit.
const ISOTROPY: f64 = 0.005;

/// Largest |sin θ₀|.
const STEEPEST: f64 = 0.9;

/// The tangent frame of a particle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) n: DVec3,
    pub(super) u: DVec3,
    pub(super) w: DVec3,
    is_seed: bool,
}

impl Frame {
    fn direction(&self, slot: usize) -> DVec3 {
        let [cos, sin] = DIRECTIONS[slot];
        self.u * cos + self.w * sin
    }

    /// Slots of children: slot 0 of every particle but a seed is its parent.
    fn slots(&self) -> core::ops::Range<usize> {
        usize::from(!self.is_seed)..6
    }
}

/// Angle θ₀ at which the surface leaves the tangent plane in the direction `d` of a frame in which its second form is [a, b, c]:
/// it falls away by κ l²/2 in a distance l, hence sin θ = −κ_V r at l = 2r.
fn predicted_angle([a, b, c]: [f64; 3], [cos, sin]: [f64; 2], radius: f64) -> f64 {
    let curvature = (a * cos + b * sin) * cos + (b * cos + c * sin) * sin;
    libm::asin((-curvature * radius).clamp(-STEEPEST, STEEPEST))
}

impl Walk {
    /// Treats a particle as Algorithm 2 does.
    pub(super) fn treat_next(&mut self, surface: &mut Surface, setup: &Setup, log: &mut Vec<Event>) {
        let next = match setup.settings.order {
            Order::Queue => self.place.waiting.pop_front(),
            Order::Stack => self.place.waiting.pop_back(),
        };
        let Some(particle) = next else { return };
        log.push(Event::Taken { particle });
        let (frame, form) = self.frame(surface, setup, particle, log);

        // Place its six children on the surface.
        let landings: Vec<(u32, Landing)> = frame
            .slots()
            .map(|slot| (slot as u32, self.project(surface, setup, (particle, slot), &frame, form, log)))
            .collect();

        // Gather its neighbouring particles.
        let centre = self.particles[particle as usize].p();
        let mut neighbours = self.gather(setup, particle, log);
        if let Some(parent) = self.particles[particle as usize].parent {
            // "For each particle, we define its first child as being its father."
            if setup.settings.matched == Matched::Leave {
                neighbours.retain(|near| near.particle != parent);
            }
            self.decide((particle, 0), SlotFate::Parent, Some(parent), log);
        }

        // For all of its six children.
        for (slot, landing) in landings {
            let Some((position, normal)) = self.usable(surface, (particle, slot), landing, log) else {
                continue;
            };
            let found = self.corresponding(setup, (particle, slot), (position, normal), &neighbours, log);
            if let Some(other) = found {
                // Update the child with this particle; remove it from the neighbouring particles.
                self.decide((particle, slot), SlotFate::Matched, Some(other), log);
                if setup.settings.matched == Matched::Leave {
                    neighbours.retain(|near| near.particle != other);
                }
            } else if self.particles.len() >= setup.settings.max_particles as usize {
                self.place.is_capped = true;
                self.decide((particle, slot), SlotFate::Capped, None, log);
            } else {
                // Add the child, marked as not done, to the particle set.
                let child = self.add(particle, position, normal, setup.radius(), log);
                self.place.waiting.push_back(child);
                self.decide((particle, slot), SlotFate::Added, Some(child), log);
                if setup.settings.matched == Matched::Stay {
                    neighbours.push(Nearby { particle: child, distance: position.distance(centre) });
                }
            }
        }
        self.finish(particle, surface, log);
    }

    /// The tangent frame of a particle, and the second fundamental form there if the start on the circle needs it.
    fn frame(
        &self,
        surface: &mut Surface,
        setup: &Setup,
        particle: u32,
        log: &mut Vec<Event>,
    ) -> (Frame, Option<[f64; 3]>) {
        let frame = self.tangent_frame(particle);
        let form = match setup.settings.start {
            Start::Tangent => None,
            Start::Curvature => {
                Some(surface.second_form(self.particles[particle as usize].p(), frame.u, frame.w))
            }
        };
        self.note_frame(particle, &frame, form, log);
        (frame, form)
    }

    pub(super) fn note_frame(
        &self,
        particle: u32,
        frame: &Frame,
        form: Option<[f64; 3]>,
        log: &mut Vec<Event>,
    ) {
        let [normal, u, w] = [frame.n, frame.u, frame.w].map(|v| v.to_array());
        log.push(Event::Frame { particle, normal, u, w, form });
    }

    /// The first direction is towards the parent; that of a seed is arbitrary (Fig. 3).
    pub(super) fn tangent_frame(&self, particle: u32) -> Frame {
        let own = &self.particles[particle as usize];
        let (p, n) = (own.p(), own.n());
        let towards = own.parent.and_then(|parent| {
            let towards = self.particles[parent as usize].p() - p;
            (towards - n * towards.dot(n)).try_normalize()
        });
        let (u, w) = match towards {
            Some(u) => (u, n.cross(u)),
            None => {
                let (u, w) = frame_of(own.normal);
                (u.into(), w.into())
            }
        };
        Frame { n, u, w, is_seed: own.parent.is_none() }
    }

    /// Places one child on the surface (§4.2, §4.3).
    fn project(
        &self,
        surface: &mut Surface,
        setup: &Setup,
        (parent, slot): (u32, usize),
        frame: &Frame,
        form: Option<[f64; 3]>,
        log: &mut Vec<Event>,
    ) -> Landing {
        let centre = self.particles[parent as usize].p();
        let radius = setup.radius();
        let direction = frame.direction(slot);
        let circle = Circle { centre, normal: frame.n, direction, radius: 2.0 * radius };
        let theta_rad = form.map_or(0.0, |form| predicted_angle(form, DIRECTIONS[slot], radius));
        let place = circle.point(theta_rad);
        log.push(Event::Slot {
            parent,
            slot: slot as u32,
            direction: direction.to_array(),
            theta_rad,
            place: place.to_array(),
        });
        self.land(surface, setup, (parent, slot as u32), &circle, theta_rad, log)
    }

    /// Moves a child onto the surface.
    pub(super) fn land(
        &self,
        surface: &mut Surface,
        setup: &Setup,
        (parent, slot): (u32, u32),
        circle: &Circle,
        theta_rad: f64,
        log: &mut Vec<Event>,
    ) -> Landing {
        let residual = setup.residual(self.particles[parent as usize].radius);
        let mut note = |trial: Trial| {
            log.push(Event::Iterate {
                parent,
                slot,
                step: trial.step,
                theta_rad: trial.theta_rad,
                position: trial.position.to_array(),
                value: trial.sample.value,
                slope: trial.sample.slope,
                bracket_rad: trial.bracket_rad,
            });
        };
        let landing = match setup.settings.projection {
            Projection::Circle => surface.land_on_circle(circle, theta_rad, residual, &mut note),
            Projection::Newton => {
                let start = circle.point(theta_rad);
                surface.land_by_newton(start, circle.radius, residual, &mut note)
            }
        };
        if let Landing::On { position, normal } = landing {
            log.push(Event::Landed {
                parent,
                slot,
                position: position.to_array(),
                normal: normal.to_array(),
                distance: position.distance(circle.centre),
            });
        }
        landing
    }

    /// Where a child landed, if it may be a particle there; otherwise its fate is decided.
    pub(super) fn usable(
        &mut self,
        surface: &Surface,
        (parent, slot): (u32, u32),
        landing: Landing,
        log: &mut Vec<Event>,
    ) -> Option<(DVec3, DVec3)> {
        let fate = match landing {
            Landing::NotConverged => SlotFate::NotConverged,
            Landing::Undefined => SlotFate::Undefined,
            // The circle may meet the far side of a rim or of a thin sheet.
            Landing::On { normal, .. } if normal.dot(self.particles[parent as usize].n()) <= 0.0 => {
                SlotFate::NotConverged
            }
            Landing::On { position, .. } if !surface.contains(position) => SlotFate::Outside,
            Landing::On { position, normal } => return Some((position, normal)),
        };
        self.decide((parent, slot), fate, None, log);
        None
    }

    /// The particles around a parent.
    fn gather(&self, setup: &Setup, particle: u32, log: &mut Vec<Event>) -> Vec<Nearby> {
        let reach = REACH * setup.radius();
        let mut neighbours = self.buckets.near(&self.particles, self.particles[particle as usize].p(), reach);
        neighbours.retain(|near| near.particle != particle);
        log.push(Event::Gathered { particle, reach, neighbours: neighbours.clone() });
        neighbours
    }

    /// The nearest of the neighbours that is of the child's sheet, if it is within the match radius.
    fn corresponding(
        &mut self,
        setup: &Setup,
        (parent, slot): (u32, u32),
        (position, normal): (DVec3, DVec3),
        neighbours: &[Nearby],
        log: &mut Vec<Event>,
    ) -> Option<u32> {
        let limit = setup.match_radius();
        let nearest = neighbours
            .iter()
            .filter_map(|near| {
                let other = &self.particles[near.particle as usize];
                let offset = other.p() - position;
                is_same_sheet(offset, normal, other.n(), RISE_SLACK * limit)
                    .then_some((offset.length(), near.particle))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        self.note_comparison(setup, (parent, slot), position, nearest.map(|(d, i)| (d, Some(i))), log);
        nearest.filter(|&(distance, _)| distance <= limit).map(|(_, particle)| particle)
    }

    /// Logs a comparison with the nearest particle, and that fronts meet if it is out of step.
    fn note_comparison(
        &mut self,
        setup: &Setup,
        (parent, slot): (u32, u32),
        position: DVec3,
        nearest: Option<(f64, Option<u32>)>,
        log: &mut Vec<Event>,
    ) {
        let limit = setup.match_radius();
        let corresponds = nearest.is_some_and(|(distance, _)| distance <= limit);
        log.push(Event::Compared {
            parent,
            slot,
            position: position.to_array(),
            against: nearest.and_then(|(_, particle)| particle),
            distance: nearest.map(|(distance, _)| distance),
            limit,
            corresponds,
        });
        if let Some((distance, other)) = nearest
            && corresponds
            && distance > SEAM * 2.0 * setup.radius()
        {
            if self.place.seams.last() != Some(&parent) {
                self.place.seams.push(parent);
            }
            if let Some(particle) = other {
                let front = |i: u32| self.particles[i as usize].front;
                let is_other = front(parent) != front(particle);
                log.push(Event::FrontsMeet { parent, slot, particle, is_other });
            }
        }
    }

    /// Level by level, first stage: predicts the children of the next particle and compares them there. Those that are free
    /// wait to be projected.
    pub(super) fn predict_next(&mut self, surface: &mut Surface, setup: &Setup, log: &mut Vec<Event>) {
        let Some(particle) = self.place.waiting.pop_front() else { return };
        log.push(Event::Taken { particle });
        let neighbours = self.gather(setup, particle, log);
        let frame = self.tangent_frame(particle);
        let (p, radius, limit) =
            (self.particles[particle as usize].p(), setup.radius(), setup.match_radius());
        let form = if frame.is_seed {
            surface.second_form(p, frame.u, frame.w)
        } else {
            self.fitted_form(radius, particle, &frame, &neighbours)
        };
        self.note_frame(particle, &frame, Some(form), log);
        if let Some(parent) = self.particles[particle as usize].parent {
            self.decide((particle, 0), SlotFate::Parent, Some(parent), log);
        }
        for slot in frame.slots() {
            let direction = frame.direction(slot);
            let circle = Circle { centre: p, normal: frame.n, direction, radius: 2.0 * radius };
            let theta_rad = predicted_angle(form, DIRECTIONS[slot], radius);
            let place = circle.point(theta_rad);
            // The normal turns with the offset.
            let [cos, sin] = DIRECTIONS[slot];
            let turn = frame.u * (form[0] * cos + form[1] * sin) + frame.w * (form[1] * cos + form[2] * sin);
            let normal = (frame.n + turn * (2.0 * radius * libm::cos(theta_rad))).normalize_or(frame.n);
            let slot = slot as u32;
            log.push(Event::Slot {
                parent: particle,
                slot,
                direction: direction.to_array(),
                theta_rad,
                place: place.to_array(),
            });
            let settled = neighbours.iter().map(|near| {
                let other = &self.particles[near.particle as usize];
                (other.p(), other.n(), Some(near.particle))
            });
            let predicted = self.children.iter().map(|child| (child.place, child.normal, None));
            let nearest = settled
                .chain(predicted)
                .filter(|(q, m, _)| is_same_sheet(*q - place, normal, *m, RISE_SLACK * limit))
                .map(|(q, _, particle)| (q.distance(place), particle))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            self.note_comparison(setup, (particle, slot), place, nearest, log);
            match nearest {
                Some((distance, other)) if distance <= limit => {
                    self.decide((particle, slot), SlotFate::Matched, other, log);
                }
                _ if self.particles.len() + self.children.len() >= setup.settings.max_particles as usize => {
                    self.place.is_capped = true;
                    self.decide((particle, slot), SlotFate::Capped, None, log);
                }
                _ => {
                    self.children.push_back(Child {
                        parent: particle,
                        slot,
                        circle,
                        theta_rad,
                        place,
                        normal,
                    });
                }
            }
        }
        self.finish(particle, surface, log);
    }

    /// Level by level, second stage: projects the next child and decides its fate where it lands.
    pub(super) fn settle_next(&mut self, surface: &mut Surface, setup: &Setup, log: &mut Vec<Event>) {
        let Some(child) = self.children.pop_front() else { return };
        let of = (child.parent, child.slot);
        let landing = self.land(surface, setup, of, &child.circle, child.theta_rad, log);
        let Some((position, normal)) = self.usable(surface, of, landing, log) else { return };
        let neighbours = self.buckets.near(&self.particles, position, setup.match_radius());
        match self.corresponding(setup, of, (position, normal), &neighbours, log) {
            Some(other) => self.decide(of, SlotFate::Matched, Some(other), log),
            None => {
                let particle = self.add(child.parent, position, normal, setup.radius(), log);
                self.place.waiting.push_back(particle);
                self.decide(of, SlotFate::Added, Some(particle), log);
            }
        }
    }

    /// Second fundamental form [a, b, c] fitted to the normals around a particle by least squares.
    fn fitted_form(&self, radius: f64, particle: u32, frame: &Frame, neighbours: &[Nearby]) -> [f64; 3] {
        let p = self.particles[particle as usize].p();
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        let (mut xa, mut ya, mut xb, mut yb) = (0.0, 0.0, 0.0, 0.0);
        for near in neighbours.iter().filter(|near| near.distance <= RING * radius) {
            let other = &self.particles[near.particle as usize];
            let (offset, turn) = (other.p() - p, other.n() - frame.n);
            // A normal that differs by more than 60° lies beyond a crease or on another sheet.
            if turn.length_squared() > 1.0 {
                continue;
            }
            let [x, y] = [offset.dot(frame.u), offset.dot(frame.w)];
            let [a, b] = [turn.dot(frame.u), turn.dot(frame.w)];
            (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
            (xa, ya, xb, yb) = (xa + x * a, ya + y * a, xb + x * b, yb + y * b);
        }
        // Normal equations of a x + b y, b x + c y, with the prior (a − c)² + b²; solved by Cramer's rule.
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
