//! The components of a surface. Each is refined as often as its own curvature and size allow.
//!
//! A first front covers all of them, with a radius at which each succeeds: the component that bends
//! most, or is smallest, decides. For each component that may be coarser another front grows from
//! one of its particles. The components are then refined level by level, the coarsest first.
//!
//! On a surface with creases, patches are refined instead of components. All are refined equally
//! often, and take their particles on creases from one [`CreaseLadder`], so that they fit together
//! at every level.

use super::coarse::{self, FrontPart, halvings, largest_curvatures};
use super::refusal::Refusal;
use super::{Count, Refinement, Rings, Target};
use crate::math::{Bounds, Forest, NONE};
use crate::mesh::triangulation::triangulate;
use crate::particles::Particles;
use crate::sampler::constraint::CreaseLadder;
use crate::sampler::probe::Probe;
use crate::sampler::sizing::Sizing;
use core::mem;
use glam::Vec3;

/// A component with a front that is good enough.
#[derive(Clone, Debug)]
struct AcceptedComponent {
    refinement: Refinement,
    /// Share of the particles due to the component, relative to the other components.
    weight: f64,
    /// The particles of the last finished level, or of the front. Particles on creases come first,
    /// with their numbers in the [`CreaseLadder`] in `twins`.
    particles: Particles,
}

/// A component for which a coarser front is to be tried.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    component: usize,
    halvings: u32,
}

/// Properties of the surface that are known before it is refined.
#[derive(Default)]
pub(crate) struct SurfaceFacts<'a> {
    /// The box that is sampled. Coarse fronts grow beyond it.
    pub(crate) bounds: Bounds,
    /// The wanted sizes, if they vary.
    pub(crate) sizing: Option<&'a Sizing>,
    /// The particles on creases at every level, where there are creases.
    pub(crate) ladder: Option<&'a CreaseLadder>,
    /// Point of the surface with the largest curvature.
    pub(crate) bend: Vec3,
    /// Number of failed refinements. Each takes one level from every component that is tried again,
    /// so that the attempts end.
    pub(crate) failures: u32,
}

impl SurfaceFacts<'_> {
    fn bent(&self) -> Refusal {
        Refusal::Bent { at: self.bend.into() }
    }
}

/// The fronts from which a refinement begins, made one after the other.
#[derive(Clone, Debug, Default)]
pub(crate) struct CoarseFronts {
    components: Vec<AcceptedComponent>,
    /// A stack: the next one to try is at its end.
    candidates: Vec<Candidate>,
    /// The particles of the first front, once another one begins.
    first: Particles,
    /// Whether the surface has several components.
    pub(crate) are_several: bool,
}

/// The step that follows a front.
pub(crate) enum Next {
    /// A front over one component, with its radius halved this many times.
    Front(u32),
    /// The refinement.
    Refine(Components),
}

impl CoarseFronts {
    /// The known particles of the component that the next front covers alone, growing from the
    /// first of them; none if the front covers all components.
    pub(crate) fn known(&self) -> Option<&Particles> {
        self.candidates.last().map(|candidate| &self.components[candidate.component].particles)
    }

    /// Drops the candidates. Returns the particles of the first front, if another one has begun.
    pub(crate) fn end(&mut self) -> Option<Particles> {
        self.candidates.clear();
        let first = mem::take(&mut self.first);
        (!first.is_empty()).then_some(first)
    }

    /// Accepts a front that has ended. `target` says how it is to be refined. When no front is left
    /// to try, `particles` are restored from the first front.
    ///
    /// # Errors
    ///
    /// The defect that refuses the first front.
    pub(crate) fn take_in(
        &mut self,
        probe: &mut Probe,
        surface: &SurfaceFacts,
        particles: &mut Particles,
        target: Target,
    ) -> Result<Next, Refusal> {
        match self.candidates.pop() {
            None => self.take_first(probe, surface, particles, target)?,
            Some(candidate) => self.take_coarser(probe, surface, particles, target, candidate),
        }
        if let Some(candidate) = self.candidates.last() {
            return Ok(Next::Front(candidate.halvings));
        }
        // With varying sizes, healing at full resolution needs coarser components next to it:
        // alone, the closest pair and largest hole may get worse.
        let is_whole = |component: &AcceptedComponent| component.refinement.target.halvings == 0;
        if surface.sizing.is_some() && self.components.iter().all(is_whole) {
            return Err(surface.bent());
        }
        let components = mem::take(&mut self.components);
        if let Some(first) = self.end() {
            *particles = first;
        }
        Ok(Next::Refine(Components::new(components, target)))
    }

    fn take_first(
        &mut self,
        probe: &mut Probe,
        surface: &SurfaceFacts,
        particles: &Particles,
        target: Target,
    ) -> Result<(), Refusal> {
        if let Some(ladder) = surface.ladder {
            return self.take_patches(probe, surface, particles, target, ladder);
        }
        let &SurfaceFacts { ref bounds, failures, .. } = surface;
        let mut parts = split(particles);
        // There may be others beyond the box.
        parts.retain(|part| part.local.iter().any(|&p| bounds.contains(p)));
        *self = Self { are_several: parts.len() > 1, ..Self::default() };
        for part in &parts {
            let mut refinement = Refinement::of_component(probe, surface, part, target)?;
            let mut part = part.clone();
            part.keep_within(bounds);
            if self.are_several {
                let largest = largest_curvatures(probe.field, &part.local).into_iter().fold(0.0, f64::max);
                let bend = largest * 2.0 * f64::from(target.radius);
                let count = (part.len() as f64) * f64::from(1_u32 << (2 * target.halvings));
                let candidate = Candidate {
                    component: self.components.len(),
                    halvings: halvings(bend, count).unwrap_or(0).saturating_sub(failures),
                };
                if candidate.halvings > target.halvings {
                    self.candidates.push(candidate);
                }
            }
            let weight = refinement.weight(probe, surface.sizing);
            // A lone component hands on its own levels.
            let particles = if self.are_several { part } else { Particles::default() };
            self.components.push(AcceptedComponent { refinement, weight, particles });
        }
        self.candidates.reverse();
        if !self.candidates.is_empty() {
            self.first = particles.clone();
        }
        Ok(())
    }

    /// Takes the patches of a front on a surface with creases.
    fn take_patches(
        &mut self,
        probe: &mut Probe,
        surface: &SurfaceFacts,
        particles: &Particles,
        target: Target,
        ladder: &CreaseLadder,
    ) -> Result<(), Refusal> {
        *self = Self::default();
        if target.halvings == 0 {
            return Err(surface.bent());
        }
        let triangles = coarse::triangles(particles, &surface.bounds)?;
        if let Some(at) = ladder.ambiguous() {
            return Err(coarse::doubtful(particles, at));
        }
        let mut patches = particles.patch.clone();
        patches.sort_unstable();
        patches.dedup();
        let number = |row: u32| {
            let patch = particles.patch[row as usize];
            patches.partition_point(|&other| other < patch)
        };
        let parts = gather(particles, (0..particles.len() as u32).map(number));
        let mut faces: Vec<Vec<[u32; 3]>> = vec![Vec::new(); patches.len()];
        for triangle in triangles {
            faces[number(triangle[0])].push(triangle.map(|row| parts.place[row as usize]));
        }
        for ((mut part, triangles), &patch) in parts.particles.into_iter().zip(&faces).zip(&patches) {
            let is_in_box = |row: usize| {
                let number = part.twins.get(row);
                let is_at_box = number.is_some_and(|&number| ladder.is_at_box(number));
                surface.bounds.contains(part.local[row]) && !is_at_box
            };
            // There may be others beyond the box.
            if !(0..part.len()).any(is_in_box) {
                continue;
            }
            let front = FrontPart { particles: &part, triangles, patch: Some(patch) };
            let mut refinement = Refinement::new(probe, surface, &front, target)?;
            let weight = refinement.weight(probe, surface.sizing);
            // These are numbers in the ladder, not rows.
            let mut numbers = mem::take(&mut part.twins);
            let place = part.keep_within(&surface.bounds);
            let mut places = place.iter();
            numbers.retain(|_| places.next() != Some(&Particles::NO_PARENT));
            part.twins = numbers;
            self.components.push(AcceptedComponent { refinement, weight, particles: part });
        }
        Ok(())
    }

    /// Accepts a coarser front of a component, or tries a less coarse one.
    fn take_coarser(
        &mut self,
        probe: &mut Probe,
        surface: &SurfaceFacts,
        particles: &Particles,
        target: Target,
        tried: Candidate,
    ) {
        let component = &mut self.components[tried.component];
        let known = &component.refinement;
        if let Ok(refinement) = Refinement::of_component(probe, surface, particles, target)
            && refinement.shape.euler == known.shape.euler
        {
            component.refinement = refinement;
            component.particles = particles.clone();
            component.particles.keep_within(&surface.bounds);
        } else if tried.halvings > known.target.halvings + 1 {
            self.candidates.push(Candidate { halvings: tried.halvings - 1, ..tried });
        }
    }
}

/// The particles of each component. Particles of one front are on one component, and so are
/// neighbours.
fn split(particles: &Particles) -> Vec<Particles> {
    let fronts = particles.parent.iter().filter(|&&parent| parent == Particles::NO_PARENT).count();
    if fronts == 1 {
        return vec![particles.clone()];
    }
    // A child is on the component of its parent, which comes before it.
    let links = (0..).zip(&particles.parent).map(|(i, &parent)| parent.min(i));
    let mut components = Forest::with_links(links.collect());
    let joined = triangulate(particles, None);
    for [a, b, c] in joined.into_corners() {
        for other in [b, c] {
            components.join(a, other);
        }
    }
    let mut part_of: Vec<usize> = Vec::with_capacity(particles.len());
    let mut parts = 0;
    for i in 0..particles.len() {
        let root = components.find(i as u32) as usize;
        part_of.push(if root == i { parts } else { part_of[root] });
        parts += usize::from(root == i);
    }
    gather(particles, part_of.into_iter()).particles
}

/// The particles of each part of a surface.
struct Parts {
    particles: Vec<Particles>,
    /// Place of each particle in its part.
    place: Vec<u32>,
}

/// Gathers the particles of each part, in their order; those on creases keep their first rows among
/// all particles.
fn gather(particles: &Particles, part_of: impl Iterator<Item = usize>) -> Parts {
    let mut parts = Parts { particles: Vec::new(), place: Vec::with_capacity(particles.len()) };
    for (i, part) in part_of.enumerate() {
        if parts.particles.len() <= part {
            parts.particles.resize_with(part + 1, Particles::default);
        }
        let parent = match particles.parent[i] {
            Particles::NO_PARENT => Particles::NO_PARENT,
            parent => parts.place[parent as usize],
        };
        let own = &mut parts.particles[part];
        parts.place.push(own.len() as u32);
        let (position, normal) = (particles.local[i], particles.normal[i]);
        own.push(position, normal, particles.radius[i], parent, particles.level[i], particles.slots[i]);
        own.twins.extend(particles.twins.get(i));
    }
    parts
}

/// The refinement of all components.
#[derive(Debug, Default)]
pub(crate) struct Components {
    components: Vec<AcceptedComponent>,
}

impl Components {
    fn new(mut components: Vec<AcceptedComponent>, target: Target) -> Self {
        if let Count::Total(count) = target.count
            && components.len() > 1
        {
            let sum: f64 = components.iter().map(|component| component.weight).sum();
            for component in &mut components {
                component.refinement.target.count = Count::Total(count * component.weight / sum);
            }
        }
        Self { components }
    }

    /// Whether no particle had a defect when the last level began.
    pub(crate) fn are_in_order(&self) -> bool {
        self.components.iter().all(|component| component.refinement.is_in_order)
    }

    /// Halvings of the least refined component.
    pub(crate) fn fewest_halvings(&self) -> u32 {
        self.components.iter().map(|component| component.refinement.target.halvings).min().unwrap_or(0)
    }

    /// Halvings of the most refined component.
    pub(crate) fn most_halvings(&self) -> u32 {
        self.components.iter().map(|component| component.refinement.target.halvings).max().unwrap_or(0)
    }

    /// The components that have the level with `to_come` levels after it, by index, and the share
    /// of its particles that each has.
    pub(crate) fn at_level(&self, to_come: u32) -> Vec<(usize, f64)> {
        let all = self.components.iter().enumerate();
        let there = all.filter(|(_, component)| component.refinement.target.halvings >= to_come);
        let weights: Vec<(usize, f64)> = there.map(|(k, component)| (k, component.weight)).collect();
        let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
        weights.into_iter().map(|(k, weight)| (k, weight / sum)).collect()
    }

    /// The refinement of a component.
    pub(crate) fn refinement(&mut self, k: usize) -> &mut Refinement {
        &mut self.components[k].refinement
    }

    /// Takes the particles of a component at the end of a level.
    pub(crate) fn end_level(&mut self, k: usize, rings: Rings) {
        let component = &mut self.components[k];
        component.particles = component.refinement.end_level(rings);
    }

    /// The particles of all components at the end of a level.
    pub(crate) fn particles(&mut self, to_come: u32, ladder: Option<&CreaseLadder>) -> Particles {
        match &mut self.components[..] {
            [lone] if ladder.is_none() => mem::take(&mut lone.particles),
            all => joined(all, to_come, ladder),
        }
    }

    /// The mesh of the last level, by the particles at the corners of its faces.
    pub(crate) fn into_corners(mut self) -> Vec<u32> {
        if let [lone] = &mut self.components[..]
            && lone.particles.is_empty()
        {
            return mem::take(&mut lone.refinement.corners);
        }
        let places = RowPlaces::of(&self.components);
        let corners =
            self.components.iter().zip(&places).map(|(component, places)| {
                component.refinement.corners.iter().map(|&corner| places.row(corner))
            });
        corners.flatten().collect()
    }
}

/// Where the rows of a component lie among all rows: `crease` is the place of its first row on a
/// crease, `inner` of its first other row.
#[derive(Clone, Copy, Debug)]
struct RowPlaces {
    on_creases: u32,
    crease: u32,
    inner: u32,
}

impl RowPlaces {
    fn of(components: &[AcceptedComponent]) -> Vec<Self> {
        let on_creases = |component: &AcceptedComponent| component.particles.twins.len() as u32;
        let (mut crease, mut inner) = (0, components.iter().map(on_creases).sum());
        let place = |component: &AcceptedComponent| {
            let own = Self { on_creases: on_creases(component), crease, inner };
            crease += own.on_creases;
            inner += component.particles.len() as u32 - own.on_creases;
            own
        };
        components.iter().map(place).collect()
    }

    /// Place of a row of the component.
    fn row(self, own: u32) -> u32 {
        if own < self.on_creases { self.crease + own } else { self.inner + own - self.on_creases }
    }
}

/// The particles of all components in one set of columns, for the level with `to_come` levels after
/// it: first those on creases of all patches, then the others.
fn joined(components: &[AcceptedComponent], to_come: u32, ladder: Option<&CreaseLadder>) -> Particles {
    let places = RowPlaces::of(components);
    let (mut joint, mut patches) = (Particles::default(), Vec::new());
    joint.reserve(components.iter().map(|component| component.particles.len()).sum());
    for is_on_crease in [true, false] {
        for (AcceptedComponent { refinement, particles: own, .. }, place) in components.iter().zip(&places) {
            let on_creases = own.twins.len();
            for i in if is_on_crease { 0..on_creases } else { on_creases..own.len() } {
                let (position, normal, radius) = (own.local[i], own.normal[i], own.radius[i]);
                let parent = match own.parent[i] {
                    Particles::NO_PARENT => Particles::NO_PARENT,
                    parent => place.row(parent),
                };
                joint.push(position, normal, radius, parent, own.level[i], own.slots[i]);
                patches.extend(refinement.patch);
                joint.twins.extend(own.twins.get(i));
            }
        }
    }
    joint.patch = patches;
    if let Some(ladder) = ladder {
        join_creases(&mut joint, to_come, ladder);
    }
    joint
}

/// Replaces the number of every particle on a crease by its first row, and lists the pairs of rows
/// that follow each other at this level.
fn join_creases(particles: &mut Particles, to_come: u32, ladder: &CreaseLadder) {
    let mut first = vec![NONE; ladder.len()];
    for (row, twin) in (0..).zip(&mut particles.twins) {
        let first = &mut first[*twin as usize];
        *first = row.min(*first);
        *twin = *first;
    }
    particles.share_radii();
    for (pair, sides) in ladder.pairs(to_come) {
        let rows = pair.map(|number| first[number as usize]);
        // Pieces beyond the box are left out, with what only they share.
        if !rows.contains(&NONE) {
            particles.segments.push(rows);
            particles.sides.push(sides.to_vec());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::formula::Formula;
    use crate::field::{Field, Frame};
    use crate::particles::Slots;
    use crate::sampler::probe::ProbeMemory;

    /// A spiral over the unit sphere, with about the radius of this many particles.
    fn sphere(count: u32) -> Particles {
        let mut particles = Particles::default();
        for k in 0..count {
            let z = 1.0 - (2 * k + 1) as f32 / count as f32;
            let (sine, cosine) = libm::sincosf(2.399_963 * k as f32);
            let p = Vec3::new(cosine * (1.0 - z * z).sqrt(), sine * (1.0 - z * z).sqrt(), z);
            let parent = if k == 0 { Particles::NO_PARENT } else { 0 };
            particles.push(p, p, 1.9 / (count as f32).sqrt(), parent, 0, Slots::default());
        }
        particles
    }

    #[test]
    fn after_a_front_that_is_refused_one_is_tried_that_is_refined_once_less() {
        let field = Formula::as_written("x^2 + y^2 + z^2 = 1", &[]).expect("a formula");
        let field = &mut *field.evaluator(Frame::default());
        let mut memory = ProbeMemory::default();
        let mut probe = Probe::new(field, &mut memory);
        let bounds = Bounds::cube(1.5);
        let surface = SurfaceFacts { bounds, sizing: None, ladder: None, bend: Vec3::ZERO, failures: 0 };
        let target = |halvings| Target { halvings, radius: 0.03, grading: None, count: Count::PerCell(1.0) };
        let known = sphere(4_000);
        let refinement =
            Refinement::of_component(&mut probe, &surface, &known, target(1)).expect("a good front");
        let mut fronts = CoarseFronts {
            components: vec![AcceptedComponent { refinement, weight: 1.0, particles: known }],
            are_several: true,
            ..CoarseFronts::default()
        };
        fronts.candidates.push(Candidate { component: 0, halvings: 4 });
        let mut tried = Vec::new();
        while let Some(candidate) = fronts.candidates.pop() {
            tried.push(candidate.halvings);
            assert!(tried.len() < 9, "{tried:?}");
            // Too few particles for a triangle, and then enough.
            let particles = sphere(if candidate.halvings > 2 { 2 } else { 1_000 });
            fronts.take_coarser(&mut probe, &surface, &particles, target(candidate.halvings), candidate);
        }
        assert_eq!(tried, [4, 3, 2]);
        assert_eq!(fronts.components[0].refinement.target.halvings, 2);
        assert_eq!(fronts.components[0].particles.len(), 1_000);
        // Only fronts coarser than the present one are tried.
        let candidate = Candidate { component: 0, halvings: 3 };
        fronts.take_coarser(&mut probe, &surface, &sphere(2), target(3), candidate);
        assert!(fronts.candidates.is_empty());
        assert_eq!(fronts.components[0].particles.len(), 1_000);
    }
}
