//! The state of a run: its particles, and all that is small.
//!
//! A chapter is what a snapshot is taken before: a generation level, the filling of gaps, or a relaxation step.

use super::buckets::Buckets;
use super::event::Event;
use super::felt::Felt;
use super::settings::Settings;
use super::state::Particle;
use super::surface::{Circle, Surface};
use crate::particles::{SlotFate, Slots};
use crate::sampler::{LawKind, Sampling};
use glam::DVec3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use serde::Serialize;
use std::collections::VecDeque;

/// What a chapter is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonChapterKind"))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ChapterKind {
    /// The particles of a generation level place their children.
    Level {
        /// Number of the front.
        front: u32,
        /// Number of the level.
        level: u32,
    },
    /// The next particles of the stack place their children.
    Stack {
        /// Number of the front.
        front: u32,
        /// Number of the part, from 0.
        part: u32,
    },
    /// Gaps are filled.
    Filling,
    /// A relaxation step.
    Relaxation {
        /// Number of the step, from 1.
        step: u32,
    },
    /// An iteration of a particle system.
    Iteration {
        /// Number of the iteration, from 1.
        iteration: u32,
    },
}

/// What a run is given and never changes.
pub(super) struct Setup {
    pub(super) settings: Settings,
    /// Points of the surface at which fronts may begin, in the order in which they are tried.
    pub(super) candidates: Vec<DVec3>,
    /// Diagonal of the box around the surface.
    pub(super) diameter: f64,
}

impl Setup {
    /// Radius of the particles of uniform sampling.
    pub(super) fn radius(&self) -> f64 {
        self.settings.radius
    }

    /// Smallest radius of a particle.
    pub(super) fn smallest(&self) -> f64 {
        match self.settings.sampling {
            Sampling::Uniform => self.settings.radius,
            Sampling::Adaptive => self.settings.radius_min,
        }
    }

    /// Largest radius of a particle.
    pub(super) fn largest(&self) -> f64 {
        match self.settings.sampling {
            Sampling::Uniform => self.settings.radius,
            Sampling::Adaptive => self.settings.radius_max,
        }
    }

    /// Radius of a particle at a point (§5.3): a law of the curvature of the level set there, between the smallest and the largest
    /// radius; `None` where it is undefined.
    pub(super) fn radius_at(&self, surface: &mut Surface, p: DVec3) -> Option<f64> {
        let settings = &self.settings;
        if settings.sampling == Sampling::Uniform {
            return Some(settings.radius);
        }
        let curvature = surface.curvature(p);
        if !curvature.is_defined() {
            return None;
        }
        let scale = settings.law_scale;
        let radius = match settings.law {
            LawKind::SumOfCurvatures => scale / (2.0 * curvature.mean().abs()),
            LawKind::MaxCurvature => scale / curvature.max_abs(),
            // The middle of an equilateral triangle of side 2r, inscribed in a sphere, is this far from the sphere.
            LawKind::ChordError => 0.5 * (3.0 * scale * (2.0 / curvature.max_abs() - scale)).max(0.0).sqrt(),
        };
        Some(radius.clamp(settings.radius_min, settings.radius_max))
    }

    /// Distance below which a child is identified with a particle.
    pub(super) fn match_radius(&self) -> f64 {
        2.0 * self.radius() * self.settings.match_tolerance
    }

    /// Largest |f|/|∇f| on the surface, for a particle of this radius.
    pub(super) fn residual(&self, radius: f64) -> f64 {
        self.settings.residual * radius
    }

    /// Side of the cubes in which particles are sorted.
    pub(super) fn cube(&self) -> f64 {
        2.0 * self.largest()
    }
}

/// All of a run that is small: what a snapshot holds beside the particles.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// The particles that are not done, the next one first.
    pub(super) waiting: VecDeque<u32>,
    /// The next candidate for a seed.
    pub(super) candidate: usize,
    /// Number of fronts so far.
    pub(super) fronts: u32,
    /// Chapters of the present front so far.
    pub(super) part: u32,
    /// Particles with a child on a seam, in the order in which they were treated.
    pub(super) seams: Vec<u32>,
    /// Whether the gaps have been filled.
    pub(super) is_filled: bool,
    /// Whether the limit on particles was reached.
    pub(super) is_capped: bool,
    /// Relaxation steps or iterations done.
    pub(super) steps: u32,
    /// Consecutive iterations of rest.
    pub(super) quiet: u32,
    /// Particles that have divided.
    pub(super) fissions: u32,
    /// Particles that have died.
    pub(super) deaths: u32,
    /// What decides deaths and the directions of fissions.
    pub(super) random: Pcg32,
    /// Evaluations of the field.
    pub(super) evaluations: u64,
}

impl Place {
    /// The beginning of a run.
    pub(super) fn new(seed: u32) -> Self {
        let mut random = Pcg32::seed_from_u64(u64::from(seed));
        // The first number has chosen the seed.
        random.next_u64();
        Self {
            waiting: VecDeque::new(),
            candidate: 0,
            fronts: 0,
            part: 0,
            seams: Vec::new(),
            is_filled: false,
            is_capped: false,
            steps: 0,
            quiet: 0,
            fissions: 0,
            deaths: 0,
            random,
            evaluations: 0,
        }
    }
}

/// A child that is predicted and not projected yet.
#[derive(Clone, Debug)]
pub(super) struct Child {
    pub(super) parent: u32,
    pub(super) slot: u32,
    pub(super) circle: Circle,
    pub(super) theta_rad: f64,
    pub(super) place: DVec3,
    pub(super) normal: DVec3,
}

/// A run.
pub(super) struct Walk {
    pub(super) place: Place,
    pub(super) particles: Vec<Particle>,
    pub(super) buckets: Buckets,
    /// The chapter under way.
    pub(super) kind: Option<ChapterKind>,
    /// Units left in it.
    pub(super) left: u32,
    /// Children of the level that are predicted and not projected, the next one first.
    pub(super) children: VecDeque<Child>,
    /// Forces of the relaxation step.
    pub(super) forces: Vec<DVec3>,
    /// Force and energy of each particle in an iteration of a particle system.
    pub(super) felt: Vec<Felt>,
    /// Particles that die at the end of the iteration, by index.
    pub(super) dying: Vec<u32>,
    pub(super) largest_move: f64,
}

impl Walk {
    /// A run with these particles at this place, between two chapters.
    pub(super) fn at(setup: &Setup, place: Place, particles: Vec<Particle>) -> Self {
        Self {
            place,
            buckets: Buckets::new(setup.cube(), &particles),
            particles,
            kind: None,
            left: 0,
            children: VecDeque::new(),
            forces: Vec::new(),
            felt: Vec::new(),
            dying: Vec::new(),
            largest_move: 0.0,
        }
    }

    /// Adds a child to the particle set.
    pub(super) fn add(
        &mut self,
        parent: u32,
        position: DVec3,
        normal: DVec3,
        radius: f64,
        log: &mut Vec<Event>,
    ) -> u32 {
        let Particle { level, front, .. } = self.particles[parent as usize];
        let particle = self.particles.len() as u32;
        let data = Particle {
            position: position.to_array(),
            normal: normal.to_array(),
            radius,
            parent: Some(parent),
            level: level + 1,
            front,
            slots: Slots::default(),
            is_done: false,
            height: 0.0,
        };
        self.particles.push(data);
        self.buckets.insert(position, particle);
        log.push(Event::Added { particle, data });
        particle
    }

    /// Decides the fate of a slot.
    pub(super) fn decide(
        &mut self,
        (parent, slot): (u32, u32),
        fate: SlotFate,
        particle: Option<u32>,
        log: &mut Vec<Event>,
    ) {
        self.particles[parent as usize].slots.set(slot as usize, fate);
        log.push(Event::Fate { parent, slot, fate, particle });
    }

    /// Marks a particle as done.
    pub(super) fn finish(&mut self, particle: u32, surface: &Surface, log: &mut Vec<Event>) {
        self.particles[particle as usize].is_done = true;
        log.push(Event::Done { particle, evaluations: surface.evaluations });
    }
}
