//! Tests of the two particle systems that the paper compares its methods with: they do what their
//! sources say.

use marching_particles::field::gallery;
use marching_particles::internal::lesson::{Event, Lesson, LessonMethod, LessonSettings};
use marching_particles::internal::paper::Particle;
use marching_particles::sampler::{LawKind, Sampling};

fn start(surface: &str, settings: &LessonSettings) -> Lesson {
    let surface = gallery::find(surface).expect("a gallery surface");
    Lesson::new(Box::new(surface.field()), &surface.bounds, settings).expect("valid settings")
}

fn run(surface: &str, settings: &LessonSettings) -> Lesson {
    let mut run = start(surface, settings);
    while !run.step(10_000).is_done {}
    run.seek(u32::MAX);
    run
}

fn witkin_heckbert(radius: f64) -> LessonSettings {
    settings!(method: LessonMethod::WitkinHeckbert, radius; ..LessonSettings::default())
}

fn forces() -> LessonSettings {
    settings!(method: LessonMethod::Forces,
        sampling: Sampling::Adaptive,
        law: LawKind::MaxCurvature,
        law_scale: 0.12,
        radius_min: 0.03,
        radius_max: 0.12; ..LessonSettings::default())
}

/// Distance from each particle to the nearest of its side, in r_i + r_j.
fn nearest(particles: &[Particle]) -> Vec<f64> {
    let apart = |a: &Particle, b: &Particle| a.p().distance(b.p()) / (a.radius + b.radius);
    let others =
        |i: usize| particles.iter().enumerate().filter(move |(j, _)| *j != i).map(|(_, other)| other);
    (0..particles.len())
        .map(|i| {
            let own = &particles[i];
            others(i)
                .filter(|b| own.n().dot(b.n()) > 0.0)
                .map(|b| apart(own, b))
                .fold(f64::INFINITY, f64::min)
        })
        .collect()
}

#[test]
fn one_particle_divides_until_the_surface_is_covered_and_all_is_at_rest() {
    for (settings, least, most) in [(witkin_heckbert(0.12), 1.0, 1.35), (forces(), 0.65, 1.0)] {
        let run = run("sphere", &settings);
        let progress = run.progress();
        assert!(progress.is_settled && !progress.is_capped, "{progress:?}");
        let particles = run.particles();
        // On the unit sphere the curvature is 1, so both have the radius 0.12.
        let hexagons = 4.0 * core::f64::consts::PI / (2.0 * 3.0_f64.sqrt() * 0.12 * 0.12);
        let share = particles.len() as f64 / hexagons;
        assert!((least..most).contains(&share), "{:?}: {share} of the hexagons", settings.method);
        let chapters = run.chapters();
        let (fissions, deaths) = chapters
            .iter()
            .fold((0, 0), |(born, dead), chapter| (born + chapter.fissions, dead + chapter.deaths));
        assert_eq!(particles.len() as u32, 1 + fissions - deaths, "{:?}", settings.method);
        assert!(chapters[chapters.len() - 20..].iter().all(|chapter| chapter.fissions + chapter.deaths == 0));
        let apart = nearest(particles);
        assert!(apart.iter().all(|share| (0.6..1.5).contains(share)), "{:?}: {apart:?}", settings.method);
        assert!(particles.iter().all(|particle| (particle.p().length() - 1.0).abs() < 1e-3));
    }
}

#[test]
fn lone_particle_of_witkin_and_heckbert_grows_to_half_the_diameter_and_divides() {
    let mut run = run("sphere", &settings!(max_iterations: 30; ..witkin_heckbert(0.05)));
    let events = run.events(0, u32::MAX);
    let divided = events.iter().position(|event| matches!(event, Event::Divided { .. })).expect("a fission");
    let radii: Vec<f64> = events[..divided]
        .iter()
        .filter_map(|event| match event {
            Event::Moved { particle: 0, radius, .. } => Some(*radius),
            _ => None,
        })
        .collect();
    // The diagonal of the box around the unit sphere is 2 √3.
    let largest = radii.last().expect("the first particle has moved");
    assert!((largest / 3.0_f64.sqrt() - 1.0).abs() < 0.03, "{radii:?}");
    assert!(radii.windows(2).all(|pair| pair[1] > pair[0]), "{radii:?}");
    let Event::Divided { data, particle: 0, child: 1, .. } = &events[divided] else {
        panic!("{:?}", events[divided])
    };
    for child in data.iter() {
        assert!((child.radius / largest * 2.0_f64.sqrt() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn witkin_and_heckberts_particles_cover_a_surface_that_bends_more_than_its_first_particle_or_ends_at_the_box()
{
    for (surface, radius) in [("gyroid", 0.5), ("plane", 0.1), ("schwarz-d", 0.6), ("helicoid", 0.3)] {
        let progress = run(surface, &witkin_heckbert(radius)).progress();
        let front = run(surface, &settings!(radius; ..LessonSettings::default())).progress().particles;
        assert!(
            progress.is_settled && (front..2 * front).contains(&progress.particles),
            "{surface}: {front}, {progress:?}"
        );
    }
}

#[test]
fn only_a_free_disc_divides_and_only_a_pressed_one_dies() {
    let mut run = run("ellipsoid", &forces());
    let (mut divided, mut died) = (0, 0);
    for event in run.events(0, u32::MAX) {
        match event {
            Event::Divided { energy, .. } => {
                assert!(energy < 0.01, "{energy}");
                divided += 1;
            }
            Event::Died { energy, .. } => {
                // Six neighbours at 0.7 of the spacing: 6 (2.3 − 1.4)².
                assert!(energy > 4.86, "{energy}");
                died += 1;
            }
            _ => {}
        }
    }
    assert!(divided > 300 && died < divided, "{divided} divided, {died} died");
}
