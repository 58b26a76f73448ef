//! Tests of particles that follow a moving surface.

use glam::DVec3;
use marching_particles::Bounds;
use marching_particles::field::Field;
use marching_particles::field::formula::Formula;
use marching_particles::internal::math::NONE;
use marching_particles::internal::session::{FieldRequest, Session};
use marching_particles::mesh::half_edge::HalfEdges;
use marching_particles::quality::figures::Coverage;
use marching_particles::run::{Cut, Measured};
use marching_particles::sampler::{FollowError, Phase, SizeMode};
use marching_particles::{Method, Run, Sampling, Settings, Warning, sample};

const TANGLECUBE: &str = "x^4+y^4+z^4-5*(x^2+y^2+z^2)+q";
const ELLIPSOID: &str = "x^2/q^2+y^2/0.49+z^2/0.25-1";

/// The field of a formula with its parameter `q`.
fn field(formula: &str, q: f64) -> Formula {
    Formula::parse(formula).and_then(|formula| formula.with("q", q)).expect("a formula")
}

fn finish(run: &mut Run<'_, Formula>, budget: u32) {
    while run.step(budget).stop_reason.is_none() {}
}

/// A finished run on the surface with `q`, in a box of this half-width.
fn started(formula: &str, q: f64, half: f64, settings: &Settings) -> Run<'static, Formula> {
    let settings = settings.in_box(Bounds::cube(half));
    let mut run = Run::start(field(formula, q), &settings).expect("a run");
    finish(&mut run, u32::MAX);
    run
}

/// Moves the surface of a run from one value of `q` to another in so many frames, each done with
/// steps of `budget`.
fn sweep(run: &mut Run<'_, Formula>, formula: &str, [from, to]: [f64; 2], frames: u32, budget: u32) {
    for frame in 1..=frames {
        let q = from + (to - from) * f64::from(frame) / f64::from(frames);
        assert_eq!(run.follow(field(formula, q)), Ok(()), "{formula}, to {q}");
        finish(run, budget);
    }
}

#[test]
fn particles_stay_even_where_a_surface_falls_apart_and_joins() {
    let settings = Settings::with_count(3_000);
    for sampling in [Sampling::Uniform, Sampling::Adaptive] {
        let settings = settings!(sampling; ..settings);
        let mut run = started(TANGLECUBE, 11.0, 2.6, &settings);
        for (way, euler, components) in [([11.0, 14.0], 16, 8), ([14.0, 11.0], -8, 1)] {
            sweep(&mut run, TANGLECUBE, way, 60, u32::MAX);
            let mut fresh = started(TANGLECUBE, way[1], 2.6, &settings);
            let (report, fresh) = (run.report(), fresh.report());
            let of = format!("{sampling:?}, {way:?}");
            assert!(
                report.warnings.contains(&Warning::Moved) && !fresh.warnings.contains(&Warning::Moved),
                "{of}"
            );
            let figures = report.measures.quality.expect("figures");
            assert_eq!(
                (figures.connectivity.euler, figures.connectivity.components),
                (euler, components),
                "{of}"
            );
            let count = report.count as f64 / fresh.count as f64;
            assert!((0.85..1.15).contains(&count), "{of}: {count} of the particles of a fresh run");
            let Coverage { cover, cover_local, .. } = figures.coverage;
            let hole = if sampling == Sampling::Uniform { cover } else { cover_local };
            assert!(hole < 1.9, "{of}: a hole of {hole}");
            assert!(figures.accuracy.error_max < 1e-3, "{of}: off by {}", figures.accuracy.error_max);
            let first = run.particles().identity.iter().filter(|&&number| number < 3_000).count();
            assert!(first > 1_000, "{of}: only {first} of the first particles are left");
        }
    }
}

#[test]
fn how_a_flow_is_cut_into_steps_changes_no_bit() {
    for (method, sampling) in [
        (Method::Front, Sampling::Uniform),
        (Method::Front, Sampling::Adaptive),
        (Method::Refined, Sampling::Uniform),
        (Method::Refined, Sampling::Adaptive),
    ] {
        let settings = settings!(method, sampling; ..Settings::with_count(1_200));
        let digest = |budget: u32| {
            let mut run = started(ELLIPSOID, 1.0, 1.5, &settings);
            sweep(&mut run, ELLIPSOID, [1.0, 1.2], 9, budget);
            (run.particles().digest(), run.particles().identity.clone())
        };
        assert_eq!(digest(u32::MAX), digest(77), "{method:?}, {sampling:?}");
    }
}

#[test]
fn a_particle_keeps_its_number_and_its_level() {
    let mut run = started(ELLIPSOID, 1.0, 1.5, &Settings::with_count(2_000));
    let born: Vec<u32> = run.particles().level.clone();
    sweep(&mut run, ELLIPSOID, [1.0, 1.3], 40, u32::MAX);
    let particles = run.particles();
    let identity = &particles.identity;
    assert_eq!(identity.len(), particles.len());
    assert!(identity.is_sorted_by(|a, b| a < b));
    assert!(identity.iter().any(|&number| number as usize >= born.len()), "no particle was born");
    for (i, &number) in identity.iter().enumerate() {
        if let Some(&level) = born.get(number as usize) {
            assert_eq!(particles.level[i], level, "particle {number}");
        }
        assert!((particles.parent[i] as usize) < i || particles.parent[i] == u32::MAX, "particle {number}");
    }
}

#[test]
fn a_component_that_is_born_gets_particles() {
    let two = "exp(-4*((x+0.6)^2+y^2+z^2))+q*exp(-4*((x-0.6)^2+y^2+z^2))-0.4";
    let mut run = started(two, 0.3, 1.5, &Settings::with_count(1_000));
    assert!(run.particles().local.iter().all(|p| p.x < 0.0));
    sweep(&mut run, two, [0.3, 0.6], 30, u32::MAX);
    let figures = run.report().measures.quality.expect("figures");
    assert_eq!((figures.connectivity.components, figures.connectivity.euler), (2, 4));
}

#[test]
fn what_leaves_the_box_is_dropped_and_what_comes_in_is_covered() {
    let ball = "(x-q)^2+y^2+z^2-0.36";
    let settings = Settings::with_count(1_500);
    let mut run = started(ball, 0.0, 1.0, &settings);
    sweep(&mut run, ball, [0.0, 0.8], 80, u32::MAX);
    let bounds = Bounds::cube(1.0);
    assert!(run.particles().local.iter().all(|&p| bounds.contains(p)));
    sweep(&mut run, ball, [0.8, 0.0], 80, u32::MAX);
    let figures = run.report().measures.quality.expect("figures");
    assert_eq!((figures.connectivity.components, figures.connectivity.euler), (1, 2));
    assert!(figures.coverage.cover < 1.9, "a hole of {}", figures.coverage.cover);
}

/// What of a run may not change where its particles cannot follow.
fn state(run: &mut Run<'_, Formula>) -> (u64, u64, String) {
    let progress = run.progress().map(|progress| format!("{progress:?}"));
    (
        run.particles().digest(),
        run.field().clone().value_and_gradient(DVec3::splat(0.1)).0.to_bits(),
        format!("{progress:?}"),
    )
}

#[test]
fn a_surface_too_far_or_with_creases_is_not_followed_and_nothing_changes() {
    let settings = Settings::with_count(800);
    for (next, why) in [
        ("(x-0.3)^2+y^2+z^2-0.25", "far at its ends"),
        ("x^2+y^2+z^2+1", "gone"),
        ("max(x^2+y^2+z^2-0.26,z-0.3)", "creased"),
    ] {
        let mut run = started("x^2+y^2+z^2-0.25+0*q", 0.0, 1.5, &settings);
        let before = state(&mut run);
        let error = run.follow(Formula::parse(next).expect("a formula")).expect_err(why);
        match error {
            FollowError::TooFar { share, .. } if why == "gone" => assert!(share > 0.99, "{share}"),
            FollowError::TooFar { share, .. } => assert!((0.2..0.9).contains(&share), "{why}: {share}"),
            FollowError::Creased => assert_eq!(why, "creased"),
            _ => panic!("{why}: {error}"),
        }
        assert_eq!(state(&mut run), before, "{why}");
    }
}

#[test]
fn a_run_that_has_not_ended_goes_on_as_if_nothing_had_been_asked() {
    let settings = Settings::with_count(2_000).in_box(Bounds::cube(1.5));
    let mut asked = Run::start(field(ELLIPSOID, 1.0), &settings).expect("a run");
    let mut other = Run::start(field(ELLIPSOID, 1.0), &settings).expect("a run");
    let mut phases = Vec::new();
    loop {
        let ended = asked.step(500).stop_reason.is_some();
        other.step(500);
        if ended {
            break;
        }
        phases.push(asked.progress().expect("a step").phase);
        assert_eq!(asked.follow(field(ELLIPSOID, 1.01)), Err(FollowError::UnderWay));
        assert_eq!(state(&mut asked), state(&mut other));
    }
    assert!(phases.contains(&Phase::Generation) && phases.contains(&Phase::Relaxation), "{phases:?}");
    assert_eq!(state(&mut asked), state(&mut other));
    assert_eq!(asked.follow(field(ELLIPSOID, 1.01)), Ok(()));

    let mut stopped = Run::start(field(ELLIPSOID, 1.0), &settings).expect("a run");
    stopped.step(500);
    stopped.cancel();
    assert_eq!(stopped.follow(field(ELLIPSOID, 1.01)), Err(FollowError::NotCovered));
}

#[test]
fn a_leap_that_some_particles_cannot_make_leaves_no_hole() {
    // Only the ends are farther than two radii away.
    for method in [Method::Front, Method::Refined] {
        let settings = settings!(method; ..Settings::with_count(3_000));
        let moved = "(x-q)^2/4+y^2+z^2-0.25";
        for warm in 0..4 {
            let mut run = started(moved, 0.0, 1.5, &settings);
            sweep(&mut run, moved, [0.0, 0.0], warm, u32::MAX);
            sweep(&mut run, moved, [0.0, 0.06], 1, u32::MAX);
            let hole = run.report().measures.quality.expect("figures").coverage.cover;
            assert!(hole < 1.9, "{method:?}, {warm}: a hole of {hole}");
        }
    }
}

#[test]
fn a_report_says_that_a_surface_has_outgrown_the_box_that_was_fitted_to_it() {
    let ball = "x^2+y^2+z^2-q^2";
    let mut run = Run::start(field(ball, 1.0), &Settings::with_count(1_000)).expect("a run");
    finish(&mut run, u32::MAX);
    sweep(&mut run, ball, [1.0, 1.02], 4, u32::MAX);
    let report = run.report();
    assert_eq!((report.border, report.cut), (0, None));
    sweep(&mut run, ball, [1.02, 1.25], 40, u32::MAX);
    let report = run.report();
    assert!(report.border > 50, "{} particles at the border", report.border);
    assert_eq!(report.cut, Some(Cut::Outgrown));
}

#[test]
fn a_frame_that_is_cut_short_is_made_up_for_by_the_next() {
    for method in [Method::Front, Method::Refined] {
        let mut run = started(ELLIPSOID, 1.0, 1.5, &settings!(method; ..Settings::with_count(2_000)));
        for frame in 1..=20 {
            assert_eq!(run.follow(field(ELLIPSOID, 1.0 + 0.01 * f64::from(frame))), Ok(()));
            assert_eq!(run.step(500).phase, Phase::Flow);
            match frame % 3 {
                0 => drop(run.cancel()),
                1 => finish(&mut run, u32::MAX),
                // The next frame begins before this one has ended.
                _ => {}
            }
        }
        finish(&mut run, u32::MAX);
        let figures = run.report().measures.quality.expect("figures");
        assert!(figures.accuracy.error_max < 1e-3, "{method:?}: off by {}", figures.accuracy.error_max);
        assert_eq!(figures.connectivity.euler, 2, "{method:?}");
    }
}

/// The mesh of a run.
fn mesh_of(run: &mut Run<'_, Formula>) -> HalfEdges {
    while run.join(u32::MAX).is_none() {}
    HalfEdges::from_triangles(run.count(), run.triangles()).expect("a manifold")
}

#[test]
fn the_mesh_of_a_refined_run_moves_and_keeps_its_order() {
    let waves = "z-0.3*sin(3*x+q)*cos(3*y)";
    for (sampling, formula, way, count, euler) in [
        (Sampling::Uniform, ELLIPSOID, [1.0, 1.3], 2_000, 2),
        (Sampling::Uniform, waves, [0.0, 1.0], 2_000, 1),
        (Sampling::Adaptive, ELLIPSOID, [1.0, 1.3], 2_000, 2),
        (Sampling::Adaptive, waves, [0.0, 1.0], 2_000, 1),
        (Sampling::Adaptive, TANGLECUBE, [11.0, 12.0], 3_000, -8),
    ] {
        let of = format!("{sampling:?}, {formula}");
        let settings = settings!(method: Method::Refined, sampling; ..Settings::with_count(count));
        let half = if formula == TANGLECUBE { 2.6 } else { 1.5 };
        let mut run = started(formula, way[0], half, &settings);
        sweep(&mut run, formula, way, 40, u32::MAX);
        let mesh = mesh_of(&mut run);
        assert_eq!(mesh.euler(), euler, "{of}");
        assert_eq!(
            mesh.edges().all(|h| mesh.twin(h) != NONE),
            formula != waves,
            "{of}: the mesh has a border"
        );
        let figures = run.report().measures.quality.expect("figures");
        assert!(
            figures.order.six_neighbours > 0.8,
            "{of}: {} have six neighbours",
            figures.order.six_neighbours
        );
        let Coverage { cover, cover_local, .. } = figures.coverage;
        let hole = if sampling == Sampling::Uniform { cover } else { cover_local };
        assert!(hole < 1.5, "{of}: a hole of {hole}");
        assert!(
            100 * run.count().abs_diff(count as usize) <= 3 * count as usize,
            "{of}: {} particles",
            run.count()
        );
        let mean_radius =
            |run: &Run<'_, Formula>| run.particles().radius.iter().sum::<f32>() / run.count() as f32;
        let grown = mean_radius(&run) / mean_radius(&started(formula, way[1], half, &settings));
        assert!((0.97..1.03).contains(&grown), "{of}: radii {grown} times those of a fresh run");
        let identity = &run.particles().identity;
        assert!(identity.is_sorted_by(|a, b| a < b), "{of}");
        let first = identity.iter().filter(|&&number| number < count).count();
        assert!(10 * first > 7 * count as usize, "{of}: only {first} of the first particles are left");
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn a_mesh_is_given_up_where_its_surface_falls_apart_and_joined_again() {
    for sampling in [Sampling::Uniform, Sampling::Adaptive] {
        let settings = settings!(method: Method::Refined, sampling; ..Settings::with_count(4_000));
        let mut run = started(TANGLECUBE, 11.0, 2.6, &settings);
        for (way, euler) in [([11.0, 14.0], 16), ([14.0, 11.0], -8)] {
            sweep(&mut run, TANGLECUBE, way, 60, u32::MAX);
            let mesh = mesh_of(&mut run);
            assert_eq!(mesh.euler(), euler, "{sampling:?}, {way:?}");
        }
    }
}

#[test]
fn particles_that_have_followed_can_be_relaxed() {
    let mut run = started(ELLIPSOID, 1.0, 1.5, &Settings::with_count(1_000));
    sweep(&mut run, ELLIPSOID, [1.0, 1.3], 40, u32::MAX);
    let before = (run.count(), run.report().measures.quality.expect("figures").spacing.spacing_variation);
    assert!(run.relax(20));
    finish(&mut run, u32::MAX);
    let after = (run.count(), run.report().measures.quality.expect("figures").spacing.spacing_variation);
    assert_eq!(before.0, after.0);
    assert!(after.1 < before.1, "{after:?} from {before:?}");
    assert_eq!(run.particles().identity.len(), after.0);
    // How components were looked for is told once.
    let warnings = run.report().warnings;
    assert!(matches!(warnings.as_slice(), [Warning::Count { .. }, Warning::Moved]), "{warnings:?}");
}

/// An ellipsoid of the length `q`, in the box of all of them.
fn ellipsoid(q: f64) -> FieldRequest {
    FieldRequest {
        formula: Some(ELLIPSOID.to_string()),
        parameters: [("q".to_string(), q)].into_iter().collect(),
        bounds: Some(DRAWN_OUT),
        ..FieldRequest::default()
    }
}

/// The box of ellipsoids that are drawn out to twice their length.
const DRAWN_OUT: Bounds = Bounds::symmetric([1.7, 0.8, 0.6]);

/// A session, as on the page, that takes each surface and then starts or follows it.
struct Drag {
    session: Session,
    settings: Settings,
}

impl Drag {
    fn new(radius: f64) -> Self {
        let share = radius / DRAWN_OUT.diagonal();
        let settings = settings!(size_mode: SizeMode::Radius, radius_share: share; ..Settings::default());
        let mut drag = Self { session: Session::new(), settings };
        drag.take(0.8);
        drag.session.start(&drag.settings).expect("valid settings");
        drag.finish();
        drag
    }

    fn take(&mut self, q: f64) {
        self.session.set_field(&ellipsoid(q)).expect("a formula");
        while self.session.fit(&|_| self.settings, true, u32::MAX).is_none() {}
    }

    fn follow(&mut self, q: f64, is_closed: bool) {
        self.take(q);
        assert_eq!(self.session.follow(&self.settings, is_closed), Ok(()), "to {q}");
    }

    fn finish(&mut self) {
        while self.session.run.step(u32::MAX).stop_reason.is_none() {}
    }
}

/// A finished run on an ellipsoid that is drawn out to twice its length, as in the lesson: without
/// births and deaths, too.
fn drawn_out(is_closed: bool) -> Session {
    let mut drag = Drag::new(0.04);
    for step in 1..=60 {
        drag.follow(0.8 + 0.8 * f64::from(step) / 60.0, is_closed);
        drag.finish();
    }
    drag.session
}

#[test]
fn a_frame_that_has_not_ended_is_gone_on_from_whether_or_not_the_surface_moves_again() {
    for next in [0.82, 0.84] {
        let mut drag = Drag::new(0.06);
        drag.follow(0.82, false);
        assert_eq!(drag.session.run.step(1).stop_reason, None);
        drag.follow(next, false);
        drag.finish();
        let figures = drag
            .session
            .measure(Measured::FrontToo, u32::MAX)
            .expect("a report")
            .measures
            .quality
            .expect("figures");
        assert!(figures.accuracy.error_max < 1e-4, "{next}: {}", figures.accuracy.error_max);
    }
}

#[test]
fn without_births_and_deaths_the_same_particles_drift_apart_and_keep_more_of_their_order() {
    let [(open, some), (closed, all)] = [false, true].map(|is_closed| {
        let mut session = drawn_out(is_closed);
        let identity = session.run.particles().identity.clone();
        (session.measure(Measured::FrontToo, u32::MAX).expect("a report"), identity)
    });
    let first = all.len() as u32;
    assert!(all.iter().copied().eq(0..first), "a particle has come or gone");
    let alive = some.iter().filter(|&&number| number < first).count();
    assert!(some.len() > all.len() && alive as f64 > 0.95 * f64::from(first), "{alive} of {first} are alive");
    let [open, closed] = [open, closed].map(|report| report.measures.quality.expect("figures"));
    assert!(open.coverage.cover < 1.5 && closed.coverage.cover > 4.0, "holes");
    assert!(
        closed.order.six_neighbours > open.order.six_neighbours + 0.1,
        "{} and {}",
        closed.order.six_neighbours,
        open.order.six_neighbours
    );
}

#[test]
fn a_session_gives_a_sample_and_goes_on() {
    let settings = Settings::with_count(500);
    let ball = "x^2 + y^2 + z^2 = a";
    let mut session = Session::without_surface();
    session
        .set_field(&FieldRequest { formula: Some(ball.into()), ..FieldRequest::default() })
        .expect("a ball");
    while session.fit(&|_| settings, false, u32::MAX).is_none() {}
    session.start(&settings).expect("a run");
    while session.run.step(u32::MAX).stop_reason.is_none() {}
    let sampled = |session: &mut Session| {
        session.sample(Measured::Particles, |_| Ok::<(), marching_particles::Error>(())).expect("a sample")
    };
    let first = sampled(&mut session);
    let direct = sample(Formula::parse(ball).expect("a formula"), &settings).expect("a ball");
    assert_eq!(first.particles().digest(), direct.particles().digest());
    assert_eq!(first.mesh(), direct.mesh());
    assert!(first.particles().identity.is_empty());
    let larger = FieldRequest { parameters: [("a".to_owned(), 1.02)].into(), ..FieldRequest::default() };
    session.set_field(&larger).expect("a larger ball");
    while session.fit(&|_| settings, true, u32::MAX).is_none() {}
    session.follow(&settings, false).expect("a near surface");
    while session.run.step(u32::MAX).stop_reason.is_none() {}
    let moved = sampled(&mut session);
    let most = moved.particles().len();
    let kept = moved
        .particles()
        .identities()
        .into_iter()
        .filter(|number| first.particles().identities().contains(number));
    assert!(kept.count() * 100 > 95 * most);
    assert!((0..most).all(|i| (moved.particles().place(i).length_squared() - 1.02).abs() < 1e-4));
    // The first sample has its own copies.
    assert_eq!(first.particles().digest(), direct.particles().digest());
}
