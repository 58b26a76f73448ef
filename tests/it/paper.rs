//! Tests of the paper's algorithms and of the lesson's engine, which runs them: what the paper says
//! holds, going back is exact, and the digests are those of every platform.
//!
//! A change that is meant to move particles rewrites the golden file:
//! `UPDATE_GOLDEN=1 cargo test --test it paper::`.

use crate::golden;
use glam::DVec3;
use marching_particles::field::formula::Formula;
use marching_particles::field::gallery;
use marching_particles::internal::lesson::{
    ChapterKind, Event, Lesson, LessonError, LessonField, LessonMethod, LessonPlacing, LessonSettings,
    Matched, Projection, QueueOrder, digest,
};
use marching_particles::internal::paper::{
    ImplicitSurface, PaperRun, Particle, RadiusRule, Rules, sum_of_curvatures,
};
use marching_particles::sampler::{GapPolicy, LawKind, Sampling};
use serde::{Deserialize, Serialize};

fn start(surface: &str, settings: &LessonSettings) -> Result<Lesson, LessonError> {
    let surface = gallery::find(surface).expect("a gallery surface");
    Lesson::new(Box::new(surface.field()), &surface.bounds, settings)
}

fn run(surface: &str, settings: &LessonSettings) -> Lesson {
    let mut run = start(surface, settings).unwrap_or_else(|error| panic!("{surface}: {error}"));
    while !run.step(1_000).is_done {}
    run.seek(u32::MAX);
    run
}

/// Some hundred particles.
fn coarse() -> LessonSettings {
    settings!(radius: 0.08, relax_steps: 3; ..LessonSettings::default())
}

/// Adaptive sampling with some hundred particles.
fn adaptive() -> LessonSettings {
    settings!(sampling: Sampling::Adaptive,
        law: LawKind::MaxCurvature,
        law_scale: 0.12,
        radius_min: 0.03,
        radius_max: 0.12,
        relax_steps: 3; ..LessonSettings::default())
}

fn all_settings() -> [LessonSettings; 8] {
    [
        coarse(),
        adaptive(),
        settings!(radius: 0.08, relax_steps: 3, gaps: GapPolicy::Fill; ..LessonSettings::of_fast_front()),
        settings!(order: QueueOrder::Stack, matched: Matched::Stay; ..coarse()),
        settings!(projection: Projection::Newton; ..coarse()),
        settings!(seeds: vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]; ..coarse()),
        settings!(method: LessonMethod::WitkinHeckbert, radius: 0.12, max_iterations: 60; ..LessonSettings::default()),
        settings!(method: LessonMethod::Forces, max_iterations: 60; ..adaptive()),
    ]
}

#[test]
fn back_is_exact_to_the_last_bit() {
    for settings in all_settings() {
        let mut straight = run("sphere", &settings);
        let total = straight.progress().events;
        let events = straight.events(0, total);
        assert_eq!(events.len(), total as usize, "{settings:?}");
        let end = digest(straight.particles());
        // What the events alone make of no particles, at every 97th event.
        let mut particles: Vec<Particle> = Vec::new();
        let mut digests = Vec::new();
        for (k, event) in events.iter().enumerate() {
            if k % 97 == 0 {
                digests.push((k as u32, digest(&particles)));
            }
            event.apply(&mut particles);
        }
        assert_eq!(digest(&particles), end, "{settings:?}");
        // Backwards, and then in an order that jumps about.
        for &(event, expected) in digests.iter().rev().chain(digests.iter().skip(1).step_by(7)) {
            assert_eq!(straight.seek(event), event);
            assert_eq!(digest(straight.particles()), expected, "{settings:?} at event {event} of {total}");
        }
        straight.seek(u32::MAX);
        assert_eq!(digest(straight.particles()), end, "{settings:?}");
        // Events are the same wherever the reader begins.
        for first in (0..total).step_by(613) {
            let part = straight.events(first, 50);
            assert_eq!(part, events[first as usize..(first as usize + 50).min(events.len())], "{settings:?}");
        }
        // Each chapter begins where the one before it ends.
        for pair in straight.chapters().windows(2) {
            assert_eq!(pair[0].first_event + pair[0].events, pair[1].first_event);
            assert_eq!(pair[0].after, pair[1].before);
        }
    }
}

#[test]
fn the_paper_by_itself_gives_the_particles_of_the_lesson() {
    let surface = gallery::find("ellipsoid").expect("a gallery surface");
    let adaptive = LessonSettings { law: LawKind::SumOfCurvatures, ..adaptive() };
    let by_curvature = RadiusRule::ByCurvature {
        law: sum_of_curvatures,
        scale: adaptive.law_scale,
        least: adaptive.radius_min,
        most: adaptive.radius_max,
    };
    for (sizes, settings) in [(RadiusRule::Same(0.08), coarse()), (by_curvature, adaptive)] {
        let settings = LessonSettings { seeds: vec![[0.0, 0.0, 0.5]], ..settings };
        let zeros = ImplicitSurface::new(Box::new(surface.field()), &surface.bounds);
        let mut alone = PaperRun::new(zeros, Rules::with_sizes(sizes), ());
        assert!(alone.begin_at(DVec3::from(settings.seeds[0])));
        alone.sample(settings.relax_steps);
        let lesson = run("ellipsoid", &settings);
        assert_eq!(digest(alone.particles()), digest(lesson.particles()), "{settings:?}");
    }
}

#[test]
fn how_a_run_is_cut_into_steps_does_not_change_it() {
    for settings in all_settings() {
        let whole = run("ellipsoid", &settings);
        for budget in [1, 7, 100_000] {
            let mut cut = start("ellipsoid", &settings).expect("valid settings");
            while !cut.step(budget).is_done {
                // A look back in between leaves the run alone.
                let middle = cut.progress().events / 2;
                cut.seek(middle);
            }
            cut.seek(u32::MAX);
            assert_eq!(cut.progress(), whole.progress(), "{settings:?} by {budget}");
            assert_eq!(digest(cut.particles()), digest(whole.particles()), "{settings:?} by {budget}");
        }
    }
}

#[test]
fn an_unfinished_chapter_can_be_looked_at() {
    let mut run = start("sphere", &coarse()).expect("valid settings");
    let progress = run.step(5);
    assert!(!progress.is_done && !run.chapters().last().expect("a chapter").is_over);
    let events = run.events(0, u32::MAX);
    assert_eq!(events.len(), progress.events as usize);
    assert_eq!(run.seek(u32::MAX), progress.events);
    assert_eq!(run.particles().len(), progress.particles as usize);
}

#[test]
fn the_seed_has_six_children_and_rings_grow_by_six() {
    let run = run("sphere", &settings!(radius: 0.03, relax_steps: 0; ..LessonSettings::default()));
    let added: Vec<u64> = run.chapters().iter().map(|chapter| chapter.fates.added).take(4).collect();
    assert_eq!(added, [6, 12, 18, 24]);
    for (level, chapter) in run.chapters().iter().enumerate() {
        assert_eq!(chapter.kind, ChapterKind::Level { front: 0, level: level as u32 });
        let fates = chapter.fates;
        let slots = fates.added + fates.matched + fates.not_converged + fates.outside + fates.undefined;
        // Five slots of every particle but the seed.
        let treated = if level == 0 { 6 } else { 5 * run.chapters()[level - 1].fates.added };
        assert_eq!(slots, treated, "level {level}");
    }
    assert!(run.particles().iter().all(|particle| particle.is_done));
}

#[test]
fn a_stack_gives_no_rings() {
    let settings = settings!(radius: 0.05, relax_steps: 0; ..LessonSettings::default());
    let levels = |order| {
        let run = run("sphere", &settings!(order; ..settings.clone()));
        run.particles().iter().map(|particle| particle.level).max().expect("particles")
    };
    assert!(levels(QueueOrder::Stack) > 5 * levels(QueueOrder::Queue));
}

#[test]
fn the_circle_keeps_the_distance_and_newton_does_not() {
    let settings = settings!(radius: 0.1, relax_steps: 0; ..LessonSettings::default());
    let farthest = |projection| {
        let run = run("ellipsoid", &settings!(projection; ..settings.clone()));
        let particles = run.particles();
        let off = particles.iter().filter_map(|particle| {
            let parent = &particles[particle.parent? as usize];
            Some((particle.p().distance(parent.p()) / (2.0 * settings.radius) - 1.0).abs())
        });
        off.fold(0.0, f64::max)
    };
    assert!(farthest(Projection::Circle) < 1e-9, "{}", farthest(Projection::Circle));
    assert!(farthest(Projection::Newton) > 0.02, "{}", farthest(Projection::Newton));
}

#[test]
fn matched_particles_that_stay_bound_all_distances() {
    let settings = settings!(relax_steps: 0, matched: Matched::Stay; ..coarse());
    let run = run("torus", &settings);
    let particles = run.particles();
    let limit = 2.0 * settings.radius * settings.match_tolerance;
    for (i, a) in particles.iter().enumerate() {
        for b in &particles[..i] {
            let apart = a.p().distance(b.p());
            assert!(apart > limit || a.n().dot(b.n()) <= 0.0, "particle {i}: {apart} of {limit}");
        }
    }
}

#[test]
fn every_iterate_of_a_child_leads_to_its_landing() {
    let mut run = run("ellipsoid", &coarse());
    let events = run.events(0, u32::MAX);
    let mut last: Option<(u32, u32, [f64; 3])> = None;
    let mut landings = 0;
    for event in &events {
        match *event {
            Event::Slot { parent, slot, place, .. } => last = Some((parent, slot, place)),
            Event::Iterate { parent, slot, step, position, .. } => {
                let (p, s, place) = last.expect("a slot comes first");
                assert_eq!((p, s), (parent, slot));
                assert!(step > 0 || place == position, "the first iterate is at the start");
                last = Some((parent, slot, position));
            }
            Event::Landed { parent, slot, position, distance, .. } => {
                assert_eq!(last, Some((parent, slot, position)));
                assert!((distance - 0.16).abs() < 1e-9, "{distance}");
                landings += 1;
            }
            _ => {}
        }
    }
    assert!(landings > 1_000, "{landings}");
}

#[test]
fn energy_falls_in_small_steps_and_not_in_large_ones() {
    let energies = |step_size| {
        let run = run("sphere", &settings!(step_size: Some(step_size), relax_steps: 10; ..coarse()));
        run.chapters().iter().filter_map(|chapter| chapter.energy).collect::<Vec<f64>>()
    };
    let small = energies(0.3);
    assert_eq!(small.len(), 10);
    assert!(small.windows(2).all(|pair| pair[1] < pair[0]), "{small:?}");
    let large = energies(3.0);
    assert!(large.windows(2).any(|pair| pair[1] > pair[0]), "{large:?}");
}

/// Figures 7 and 8, event by event.
#[test]
fn an_adaptive_child_is_pushed_until_it_touches_and_then_compared() {
    let mut run = run("ellipsoid", &settings!(relax_steps: 0; ..adaptive()));
    let events = run.events(0, u32::MAX);
    let particles = run.particles();
    let (mut at, mut radius, mut overlap_before) = (DVec3::ZERO, 0.0, f64::INFINITY);
    let (mut has_room, mut landed) = (false, None);
    let [mut pushes, mut turns, mut added, mut crowded] = [0; 4];
    for event in &events {
        match *event {
            Event::Start { parent, position, radius: r, .. } => {
                let own = &particles[parent as usize];
                (at, radius, overlap_before, landed) = (position.into(), r, f64::INFINITY, None);
                // The point s lies on the circle C of the parent.
                assert!((at.distance(own.p()) / own.radius - 1.0).abs() < 1e-9);
            }
            Event::Push { parent, position, radius: r, .. } => {
                let own = &particles[parent as usize];
                assert!(at.distance(own.p()) < own.radius + radius, "a child that touches is not pushed");
                assert!(own.p().distance(position.into()) > at.distance(own.p()));
                (at, radius, pushes) = (position.into(), r, pushes + 1);
            }
            Event::PushOnCircle { parent, position, radius: r, overlap, .. } => {
                let own = &particles[parent as usize];
                assert!((own.p().distance(position.into()) / (own.radius + r) - 1.0).abs() < 1e-9);
                assert!(overlap < overlap_before);
                (at, radius, overlap_before, turns) = (position.into(), r, overlap, turns + 1);
            }
            Event::Room { parent, phi_rad, tau_rad, fits, .. } => {
                let own = &particles[parent as usize];
                assert!(at.distance(own.p()) >= (own.radius + radius) * (1.0 - 1e-9));
                assert!((libm::sin(0.5 * phi_rad) - radius / (own.radius + radius)).abs() < 1e-9);
                assert_eq!(fits, tau_rad >= 0.5 * phi_rad);
                (has_room, crowded) = (fits, crowded + u32::from(!fits));
            }
            Event::Landed { position, distance, parent, .. } => {
                // The circle C^i keeps the distance.
                assert!((distance / at.distance(particles[parent as usize].p()) - 1.0).abs() < 1e-9);
                landed = Some(position);
            }
            Event::Added { data, .. } => {
                assert!(has_room && landed == Some(data.position));
                added += 1;
            }
            _ => {}
        }
    }
    let context = format!("{pushes} pushes, {turns} turns, {added} added, {crowded} without room");
    assert!(pushes > 1_000 && turns > 100 && added > 200 && crowded > 100, "{context}");
}

#[test]
fn adaptive_particles_follow_the_law_and_crowd_nothing() {
    let settings = settings!(relax_steps: 0; ..adaptive());
    let run = run("ellipsoid", &settings);
    let particles = run.particles();
    let radii = particles.iter().map(|particle| particle.radius);
    let (least, most) = (radii.clone().fold(f64::INFINITY, f64::min), radii.fold(0.0, f64::max));
    assert!(most > 2.0 * least && least >= settings.radius_min && most <= settings.radius_max);
    for (i, a) in particles.iter().enumerate() {
        for b in &particles[..i] {
            let share = a.p().distance(b.p()) / (a.radius + b.radius);
            assert!(share > settings.match_tolerance || a.n().dot(b.n()) <= 0.0, "particle {i}: {share}");
        }
    }
    // The discs cover about as much of the surface as those of a lattice, which is 0.907 of it.
    let discs: f64 = particles.iter().map(|particle| particle.radius * particle.radius).sum::<f64>()
        * std::f64::consts::PI;
    // The area of the ellipsoid with the semi-axes 1, 0.7 and 0.5.
    let share = discs / 6.7;
    assert!((0.7..1.1).contains(&share), "{share} of the area");
}

#[test]
fn a_section_lies_on_the_surface() {
    let run = start("sphere", &coarse()).expect("valid settings");
    let segments = run.section([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0.3, 60);
    assert!(segments.len() > 60);
    for [x0, y0, x1, y1] in segments {
        for p in [DVec3::new(x0, 0.0, 1.0 + y0), DVec3::new(x1, 0.0, 1.0 + y1)] {
            assert!((p.length() - 1.0).abs() < 1e-4, "{p}");
        }
    }
    let steps = run.newton([0.2, 0.0, 1.0], 1.0);
    let last = DVec3::from(steps.last().expect("a step").position);
    assert!(steps.len() > 2 && (last.length() - 1.0).abs() < 1e-4);
}

#[test]
fn what_cannot_be_followed_is_refused_in_words() {
    let refused = |settings: LessonSettings| match start("sphere", &settings) {
        Ok(_) => panic!("{settings:?} was accepted"),
        Err(error) => error.to_string(),
    };
    let words = refused(settings!(radius: 0.005; ..LessonSettings::default()));
    assert!(words.starts_with("about 14") && words.contains("times as large"), "{words}");
    assert!(refused(settings!(radius: f64::NAN; ..LessonSettings::default())).starts_with("radius is NaN"));
    assert!(refused(settings!(match_tolerance: 2.0; ..coarse())).starts_with("match_tolerance is 2"));
    assert!(refused(settings!(placing: LessonPlacing::LevelByLevel; ..coarse())).contains("needs a queue"));
    assert!(refused(settings!(gaps: GapPolicy::Fill; ..adaptive())).starts_with("adaptive sampling places"));
    let two_sizes = settings!(method: LessonMethod::WitkinHeckbert; ..adaptive());
    assert!(refused(two_sizes).contains("one radius everywhere"));
    let negative = settings!(method: LessonMethod::WitkinHeckbert, radius_max: -1.0; ..coarse());
    assert!(refused(negative).starts_with("radius_max is -1"));
    assert!(refused(settings!(max_iterations: 0; ..coarse())).starts_with("max_iterations is 0"));
    assert!(refused(settings!(radius_min: 0.5; ..adaptive())).starts_with("radius_min is 0.5"));
    let tiny = settings!(law_scale: 1e-3, radius_min: 1e-3; ..adaptive());
    assert!(refused(tiny).contains("choose radii"));
    // The factor that the message names is large enough.
    let factor: f64 = words.split(' ').rev().nth(3).and_then(|word| word.parse().ok()).expect("a factor");
    assert!(
        start("sphere", &settings!(radius: 0.005 * factor; ..LessonSettings::default())).is_ok(),
        "{words}"
    );
}

#[test]
fn the_limit_on_particles_ends_the_front() {
    let run = run("sphere", &settings!(max_particles: 100; ..coarse()));
    assert_eq!(run.particles().len(), 100);
    assert!(run.progress().is_capped);
}

/// Contents of the golden file.
#[derive(Serialize, Deserialize)]
struct Golden {
    runs: Vec<GoldenRun>,
}

/// A run with its expected result.
#[derive(Serialize, Deserialize)]
struct GoldenRun {
    name: String,
    field: LessonField,
    settings: LessonSettings,
    events: u32,
    /// Of the particles at the end.
    digest: String,
    /// Of those after half of the events.
    half: String,
}

#[test]
fn lessons_have_the_digests_that_other_platforms_give() {
    let mut golden: Golden = golden::read("lessons.json");
    assert!(golden.runs.len() >= 4, "there are {} runs", golden.runs.len());
    let mut faults = Vec::new();
    for lesson in &mut golden.runs {
        let LessonField { formula, parameters, bounds } = &lesson.field;
        let field = Formula::as_written(formula, parameters).expect("the formula can be read");
        let mut run = Lesson::new(Box::new(field.for_sampling()), bounds, &lesson.settings)
            .unwrap_or_else(|error| panic!("{}: {error}", lesson.name));
        while !run.step(1_000).is_done {}
        let events = run.progress().events;
        let mut at = |event| {
            run.seek(event);
            format!("{:016x}", digest(run.particles()))
        };
        let (half, end) = (at(events / 2), at(events));
        assert!(events > 5_000, "{}: {events} events are too few to show anything", lesson.name);
        golden::compare(&lesson.name, &mut lesson.events, events, &mut faults);
        golden::compare(&lesson.name, &mut lesson.half, half, &mut faults);
        golden::compare(&lesson.name, &mut lesson.digest, end, &mut faults);
    }
    golden::finish("lessons.json", &golden, &faults, "paper");
}
