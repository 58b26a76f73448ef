//! Tests of the particle systems that the paper compares its method with (§6): from one particle they cover a surface,
//! as evenly as their sources promise, with the same result every time, and they end on any field.

use marching_particles::baseline::{Baseline, Settings, StopReason};
use marching_particles::field::formula::FormulaField;
use marching_particles::field::{Field, gallery};
use marching_particles::math::Bounds;
use marching_particles::quality::{self, Figures, Sizes};
use marching_particles::sampler::{Sampling, Settings as Of, SettingsError, SizeMode};

const SCHEMES: [Sampling; 2] = [Sampling::Uniform, Sampling::Adaptive];

fn settings(sampling: Sampling, count: u32) -> Settings {
    let sizes = Of { sampling, size_mode: SizeMode::Count, count, ..Of::default() };
    Settings { sizes, ..Settings::default() }
}

/// Runs to the end in steps of `budget`.
fn run(field: &mut dyn Field, bounds: &Bounds, settings: &Settings, budget: u32) -> Baseline {
    let mut baseline = Baseline::start(field, bounds, settings).expect("valid settings");
    while baseline.progress().stop_reason.is_none() {
        baseline.step(field, budget);
    }
    baseline
}

fn of_gallery(id: &str, settings: &Settings) -> (Baseline, Figures) {
    let surface = gallery::find(id).expect("a surface of the gallery");
    let mut field = surface.field();
    let baseline = run(&mut field, &surface.bounds, settings, u32::MAX);
    let radii = baseline.radii();
    let sizes = match settings.sizes.sampling {
        Sampling::Uniform => Sizes::None,
        Sampling::Adaptive => Sizes::Given(&radii),
    };
    let options = quality::Options { sizes, ..quality::Options::default() };
    let (position, normal) = (baseline.positions(), baseline.normals());
    let report = quality::measure(&position, &normal, &mut field, Some(&surface.bounds), &options);
    (baseline, report.figures)
}

#[test]
fn one_particle_multiplies_until_the_surface_has_no_holes() {
    for (id, euler) in [("sphere", 2), ("ellipsoid", 2), ("torus", 0)] {
        for (sampling, hole) in [(Sampling::Uniform, 1.45), (Sampling::Adaptive, 1.75)] {
            let (baseline, figures) = of_gallery(id, &settings(sampling, 1_500));
            let state = baseline.progress();
            assert_eq!(state.stop_reason, Some(StopReason::Settled), "{id}, {sampling:?}: {state:?}");
            assert_eq!(figures.euler, euler, "{id}, {sampling:?}");
            let cover = if sampling == Sampling::Uniform { figures.cover } else { figures.cover_local };
            assert!(cover < hole, "{id}, {sampling:?}: a hole of {cover}");
            assert!(figures.ang_min > 25.0 && figures.six > 0.5, "{id}, {sampling:?}: {figures:?}");
            assert!(figures.err_max < 1e-3, "{id}, {sampling:?}: {}", figures.err_max);
        }
    }
}

#[test]
fn count_is_near_that_of_a_hexagonal_lattice_of_the_wanted_radius() {
    // A particle of the first system divides above σ̂ and settles below it. One of the second divides only if its
    // nearest neighbours are 2.3 radii away.
    for (sampling, range) in [(Sampling::Uniform, 1.0..1.3), (Sampling::Adaptive, 0.7..0.95)] {
        for id in ["sphere", "torus"] {
            let (baseline, _) = of_gallery(id, &settings(sampling, 2_000));
            let share = baseline.positions().len() as f64 / 2_000.0;
            assert!(range.contains(&share), "{id}, {sampling:?}: {share} of the hexagons");
        }
    }
}

#[test]
fn every_particle_but_the_first_comes_from_a_fission() {
    for sampling in SCHEMES {
        let (baseline, _) = of_gallery("ellipsoid", &settings(sampling, 3_000));
        let state = baseline.progress();
        let born = 1 + state.fissions - state.deaths - state.dropped;
        assert_eq!(state.particles as u64, born, "{sampling:?}: {state:?}");
        assert_eq!(baseline.positions().len(), state.particles);
    }
}

#[test]
fn crowded_particles_die_until_they_have_room() {
    // Children have half of the area and divide without resting, so the surface is overcrowded when they come to rest.
    let hasty =
        Settings { fission_energy: 0.0, equilibrium_speed: 1e3, ..settings(Sampling::Uniform, 3_000) };
    let (baseline, figures) = of_gallery("ellipsoid", &hasty);
    let state = baseline.progress();
    assert!(state.deaths > 0, "{state:?}");
    assert!(figures.rho > 0.6, "closest pair at {}", figures.rho);
}

#[test]
fn radii_of_settled_particles_lie_between_those_of_death_and_fission() {
    let (baseline, _) = of_gallery("torus", &settings(Sampling::Uniform, 2_000));
    for radius in baseline.radii() {
        let share = f64::from(radius) / baseline.radius();
        assert!((0.65..1.01).contains(&share), "{share} of the wanted radius");
    }
}

#[test]
fn particles_depend_on_the_seed_and_not_on_the_steps() {
    let surface = gallery::find("torus").expect("a surface of the gallery");
    for sampling in SCHEMES {
        let of = |seed: u64, budget: u32| {
            let mut settings = settings(sampling, 300);
            settings.sizes.seed = seed;
            let baseline = run(&mut surface.field(), &surface.bounds, &settings, budget);
            let bits = |v: &glam::Vec3| v.to_array().map(f32::to_bits);
            let columns: Vec<_> = baseline.positions().iter().chain(&baseline.normals()).map(bits).collect();
            (columns, baseline.progress().evaluations)
        };
        let whole = of(1, u32::MAX);
        for budget in [1, 7, 1_000] {
            assert!(of(1, budget) == whole, "{sampling:?}: budget {budget} gives others");
        }
        assert!(of(2, u32::MAX) != whole, "{sampling:?}: the seed changes nothing");
    }
}

#[test]
fn stop_reason_is_the_true_one() {
    let surface = gallery::find("sphere").expect("a surface of the gallery");
    let (field, bounds) = (&mut surface.field(), &surface.bounds);
    for sampling in SCHEMES {
        let few = Settings { max_iterations: 12, ..settings(sampling, 1_000) };
        let state = run(field, bounds, &few, u32::MAX).progress();
        assert_eq!((state.stop_reason, state.iterations), (Some(StopReason::Iterations), 12));

        let mut small = settings(sampling, 1_000);
        small.sizes.max_particles = 100;
        let state = run(field, bounds, &small, u32::MAX).progress();
        assert_eq!((state.stop_reason, state.particles), (Some(StopReason::Cap), 100));

        let mut cut = Baseline::start(field, bounds, &settings(sampling, 1_000)).expect("valid settings");
        while cut.progress().particles < 50 {
            cut.step(field, 1_000);
        }
        cut.cancel();
        while cut.progress().stop_reason.is_none() {
            cut.step(field, 10);
        }
        assert_eq!(cut.progress().stop_reason, Some(StopReason::Cancelled));
        for position in cut.positions() {
            assert!((position.length() - 1.0).abs() < 1e-3, "{position} is off the sphere");
        }

        let none = &mut FormulaField::parse("x^2 + y^2 + z^2 + 1", &[]).expect("a formula");
        let state = run(none, bounds, &settings(sampling, 1_000), u32::MAX).progress();
        assert_eq!((state.stop_reason, state.particles), (Some(StopReason::NoSurface), 0));
    }
}

#[test]
fn odd_fields_end_with_every_particle_on_the_surface_and_in_the_box() {
    let formulas = [
        "1/x",
        "tan(4x)",
        "sqrt(x) - 0.3",
        "log10(x + y) + z",
        "abs(x) + abs(y) + abs(z) = 0.7",
        "x y z",
        "x^2 + y^2 + z^2",
        "(x^2 + y^2 + z^2 - 0.5)^2",
        "x^2 + y^2 = z^2",
        "floor(3x) + y",
        "1e30 (x^2 + y^2 + z^2 - 0.5)",
        "1e-30 (x + y/2)",
        "x^2 + y^2 + z^2 - 1e-6",
        "0",
        "log10(-1 - x^2)",
    ];
    let bounds = Bounds::cube(1.0);
    for formula in formulas {
        for sampling in SCHEMES {
            let settings = Settings { max_iterations: 120, ..settings(sampling, 300) };
            let mut field = FormulaField::parse(formula, &[]).expect("a formula");
            let baseline = run(&mut field, &bounds, &settings, u32::MAX);
            assert!(baseline.radii().iter().all(|r| *r > 0.0 && r.is_finite()), "{formula}, {sampling:?}");
            for (position, normal) in baseline.positions().iter().zip(baseline.normals()) {
                assert!(bounds.contains(*position), "{formula}, {sampling:?}: {position}");
                assert!((normal.length() - 1.0).abs() < 1e-3, "{formula}, {sampling:?}: {normal}");
                let jet = field.jet(position.as_dvec3());
                let distance = jet.value.abs() / jet.gradient.length();
                assert!(distance < 2e-3, "{formula}, {sampling:?}: {position} is {distance} away");
            }
        }
    }
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let surface = gallery::find("sphere").expect("a surface of the gallery");
    let refuse = |settings: Settings, bounds: Bounds| match Baseline::start(
        &mut surface.field(),
        &bounds,
        &settings,
    ) {
        Ok(_) => panic!("accepted: {settings:?}"),
        Err(error) => error.to_string(),
    };
    let good = Settings::default();
    for (bad, message) in [
        (Settings { time_step: 0.1, ..good }, "time_step is 0.1, but must lie between 0.0001 and 0.06"),
        (Settings { amplitude: f64::NAN, ..good }, "amplitude is NaN, but must lie between 0.1 and 10"),
        (Settings { max_iterations: 0, ..good }, "max_iterations is 0, but must lie between 1 and 1000000"),
        (Settings { death_radius: 0.8, ..good }, "death_radius is 0.8, but must lie between 0 and 0.707"),
        (
            Settings { sizes: Of { count: 0, ..Of::default() }, ..good },
            "count is 0, but must lie between 1 and 4000000",
        ),
    ] {
        assert_eq!(refuse(bad, surface.bounds), message);
    }
    let flat = Bounds { min: [0.0; 3], max: [1.0, 1.0, 0.0] };
    assert_eq!(refuse(good, flat), SettingsError::Box.to_string());
    assert!(Settings::default().validate().is_ok());
}
