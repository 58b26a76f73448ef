//! Runs to their end, and what is measured of them.

use marching_particles::Bounds;
use marching_particles::field::Field;
use marching_particles::field::gallery;
use marching_particles::internal::session::{FieldRequest, Session};
use marching_particles::particles::{Particles, SlotFate, Slots};
use marching_particles::quality::{Figures, MeasureOptions, measure};
use marching_particles::sampler::{Sampler, Settings};
use marching_particles::{Report, Run};
use std::sync::Arc;

/// A sampler that has begun a run on a field in a box.
pub(crate) fn begun<'f>(field: impl Field + 'f, bounds: &Bounds, settings: &Settings) -> Sampler<'f> {
    Run::start(field, &settings.in_box(*bounds)).expect("valid settings").into_sampler()
}

/// A field that is shared with a sampler.
pub(crate) fn shared<'f>(field: impl Field + 'f) -> Arc<dyn Field + 'f> {
    Arc::new(field)
}

/// A field, sampled in a box by steps of `budget`.
pub(crate) fn sampled<'f>(
    field: impl Field + 'f,
    bounds: &Bounds,
    settings: &Settings,
    budget: u32,
) -> Sampler<'f> {
    let mut run = Run::start(field, &settings.in_box(*bounds)).expect("valid settings");
    while run.step(budget).stop_reason.is_none() {}
    run.into_sampler()
}

/// Samples a field in a box, and finds the same particles however the run is cut into steps.
pub(crate) fn sampled_in_any_steps<'f>(
    field: &'f dyn Field,
    bounds: &Bounds,
    settings: &Settings,
) -> Sampler<'f> {
    let whole = sampled(field, bounds, settings, u32::MAX);
    for budget in [1, 777] {
        let cut = sampled(field, bounds, settings, budget);
        assert_eq!(cut.particles().digest(), whole.particles().digest(), "in steps of {budget}");
    }
    whole
}

/// A surface of the gallery, sampled.
pub(crate) fn of_gallery(id: &str, settings: &Settings) -> Sampler<'static> {
    let surface = gallery::find(id).expect("a surface of the gallery");
    sampled(surface.field(), &surface.bounds, settings, 10_000)
}

/// The fates of the slots agree with what was counted, and each particle but a seed is the child of
/// one other.
pub(crate) fn assert_fates(sampler: &Sampler, context: &str) {
    let (particles, fates) = (sampler.particles(), sampler.counts().fates);
    let count = |fate| {
        let slots = particles.slots.iter().flat_map(|slots| (0..Slots::COUNT).map(|k| slots.get(k)));
        slots.filter(|&found| found == fate).count() as u64
    };
    assert_eq!(count(SlotFate::Added), fates.added, "{context}");
    assert_eq!(count(SlotFate::Matched), fates.matched, "{context}");
    assert_eq!(count(SlotFate::Outside), fates.outside, "{context}");
    assert_eq!(count(SlotFate::NotConverged), fates.not_converged, "{context}");
    assert_eq!(count(SlotFate::Undefined), fates.undefined, "{context}");
    let seeds = particles.parent.iter().filter(|&&p| p == Particles::NO_PARENT).count() as u64;
    assert_eq!(fates.added + seeds, particles.len() as u64, "{context}");
    assert_eq!(count(SlotFate::Parent) + seeds, particles.len() as u64, "{context}");
}

pub(crate) fn figures(
    field: &dyn Field,
    bounds: &Bounds,
    Particles { local: position, normal, .. }: &Particles,
    radii: Option<&[f32]>,
) -> Figures {
    measure(position, normal, field, Some(bounds), &MeasureOptions { radii, ..MeasureOptions::default() })
        .figures
}

/// Figures of particles on a surface of the gallery.
pub(crate) fn gallery_figures(id: &str, particles: &Particles, radii: Option<&[f32]>) -> Figures {
    let surface = gallery::find(id).expect("a surface of the gallery");
    figures(&surface.field(), &surface.bounds, particles, radii)
}

/// A session with a formula in a box.
pub(crate) fn session(formula: &str, bounds: Bounds) -> Session {
    let mut session = Session::new();
    let request =
        FieldRequest { formula: Some(formula.into()), bounds: Some(bounds), ..FieldRequest::default() };
    session.set_field(&request).unwrap_or_else(|error| panic!("{formula}: {error}"));
    session
}

/// A finished run of a formula in a box.
pub(crate) fn finished(formula: &str, bounds: Bounds, settings: &Settings) -> (Session, Report) {
    let mut session = session(formula, bounds);
    let report = run(&mut session, settings);
    (session, report)
}

/// Leads a session through a run.
pub(crate) fn run(session: &mut Session, settings: &Settings) -> Report {
    session.start(settings).expect("valid settings");
    while session.run.step(100_000).stop_reason.is_none() {}
    session.report()
}
