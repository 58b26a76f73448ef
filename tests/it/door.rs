//! Tests of the door: what a program that uses the library meets.

use marching_particles::field::{BatchField, FnField};
use marching_particles::glam::DVec3;
use marching_particles::run::{BoxError, Measured, Severity};
use marching_particles::sampler::SettingsError;
use marching_particles::{
    Bounds, Error, Field, Format, Formula, MeshFormat, Method, Particles, Radius, Run, Settings, Spacing,
    StopReason, Warning, sample,
};
use serde_json::json;
use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

const FEW: u32 = 1_500;

fn sphere(p: DVec3) -> f64 {
    p.length() - 1.0
}

fn outward(p: DVec3) -> DVec3 {
    p.normalize_or_zero()
}

#[test]
fn runs_and_samples_are_printed_and_shared_between_threads() {
    let settings = Settings::with_count(100);
    let mut run = Run::start(Formula::parse("x^2 + y^2 + z^2 = 1").unwrap(), &settings).unwrap();
    assert!(format!("{run:?}").starts_with("Run {"));
    while run.step(u32::MAX).stop_reason.is_none() {}
    let sample = std::sync::Arc::new(run.finish().unwrap());
    let other = sample.clone();
    let joined = std::thread::spawn(move || other.mesh().triangles.len());
    assert_eq!(joined.join().unwrap(), sample.mesh().triangles.len());
}

#[test]
fn a_closure_is_sampled_as_evenly_as_the_formula_of_its_surface() {
    let settings = Settings::with_count(FEW);
    let formula = sample(Formula::parse("x^2 + y^2 + z^2 = 1").unwrap(), &settings).unwrap();
    let plain = sample(FnField::new(sphere), &settings).unwrap();
    let given = sample(FnField::new(sphere).with_gradient(outward), &settings).unwrap();
    for sample in [&formula, &plain, &given] {
        let report = sample.report();
        assert!(report.count.abs_diff(FEW as usize) <= 45, "{}", report.count);
        assert_eq!(report.warnings, []);
        assert_eq!((report.proof.components, sample.mesh().topology.euler()), (1, 2));
        assert!(report.measures.quality.unwrap().order.six_neighbours > 0.85);
        let off = sample.particles().local.iter().map(|p| (p.length() - 1.0).abs()).fold(0.0, f32::max);
        assert!(off < 1e-5, "{off}");
    }
}

#[test]
fn closures_references_and_shared_fields_are_sampled_as_they_are() {
    let settings = Settings::with_count(FEW);
    let closure = sample(|p: DVec3| sphere(p), &settings).unwrap();
    let named = sample(FnField::new(sphere), &settings).unwrap();
    assert_eq!(closure.particles().digest(), named.particles().digest());

    let formula = Formula::parse("x^4 + y^4 + z^4 = a").unwrap();
    let owned = sample(formula.clone(), &settings).unwrap().particles().digest();
    assert_eq!(sample(&formula, &settings).unwrap().particles().digest(), owned);
    let shared: Arc<dyn Field> = Arc::new(formula);
    let threads = [(); 4].map(|()| {
        let field = Arc::clone(&shared);
        std::thread::spawn(move || sample(field, &settings).unwrap().particles().digest())
    });
    for thread in threads {
        assert_eq!(thread.join().unwrap(), owned);
    }
}

/// The sphere, a batch of points at a time; an error after so many points.
fn batches(
    most: usize,
    asked: &AtomicUsize,
) -> impl Fn(&[DVec3], &mut [f64]) -> Result<(), std::num::ParseIntError> {
    move |points, f| {
        if asked.fetch_add(points.len(), Ordering::Relaxed) > most {
            return "many".parse::<i32>().map(drop);
        }
        points.iter().zip(f).for_each(|(&p, f)| *f = sphere(p));
        Ok(())
    }
}

#[test]
fn a_function_of_a_batch_gives_what_that_of_a_point_does_and_is_asked_for_many_points_at_a_time() {
    let settings = Settings::with_count(FEW);
    let asked = AtomicUsize::new(0);
    let calls = AtomicUsize::new(0);
    let function = batches(usize::MAX, &asked);
    let counted = |points: &[DVec3], f: &mut [f64]| {
        calls.fetch_add(1, Ordering::Relaxed);
        assert!(points.len() <= 512);
        function(points, f)
    };
    let pointwise = sample(|p: DVec3| sphere(p), &settings).unwrap();
    let batched = sample(counted, &settings).unwrap();
    assert_eq!(batched.particles().digest(), pointwise.particles().digest());
    assert!(asked.load(Ordering::Relaxed) > 30 * calls.load(Ordering::Relaxed));

    let no_more = AtomicUsize::new(0);
    let field = BatchField::new(batches(usize::MAX, &no_more)).with_gradients(|points, gradients| {
        points.iter().zip(gradients).for_each(|(&p, gradient)| *gradient = outward(p));
        Ok(())
    });
    let given = sample(field, &settings).unwrap();
    let of_point = sample(FnField::new(sphere).with_gradient(outward), &settings).unwrap();
    assert_eq!(given.particles().digest(), of_point.particles().digest());
}

#[test]
fn a_function_that_fails_ends_the_run_with_its_error_whenever_that_is() {
    let settings = Settings::with_count(FEW);
    let asked = AtomicUsize::new(0);
    sample(batches(usize::MAX, &asked), &settings).unwrap();
    let all = asked.into_inner();
    for share in [0.0, 0.1, 0.5, 0.9, 0.99] {
        let (most, asked) = ((share * all as f64) as usize, AtomicUsize::new(0));
        let Err(Error::Field(error)) = sample(batches(most, &asked), &settings) else {
            panic!("no error after {most} of {all} points");
        };
        assert_eq!(error.to_string(), "invalid digit found in string");
        assert!(error.get().is::<std::num::ParseIntError>());
        // Nothing is asked of it once it has failed.
        assert!(asked.into_inner() <= most + 2 * 512);
    }
}

#[test]
fn a_sample_gives_the_buffers_of_a_graphics_card_and_files_by_their_names() {
    let centre = DVec3::new(500.0, -300.0, 0.25);
    let sample = sample(
        move |p: DVec3| sphere(p - centre),
        &Settings::with_count(FEW).in_box(Bounds::new(centre - 1.2, centre + 1.2)),
    );
    let sample = sample.unwrap();
    let (positions, normals) = (sample.positions(), sample.normals());
    assert_eq!((positions.len(), normals.len()), (sample.report().count, sample.report().count));
    for (&position, &normal) in positions.iter().zip(normals) {
        let away = DVec3::from_array(position.map(f64::from)) - centre;
        // Positions in single precision are whole multiples of 3·10⁻⁵ there.
        assert!((away.length() - 1.0).abs() < 1e-4, "{away}");
        assert!(away.distance(DVec3::from_array(normal.map(f64::from))) < 1e-3);
    }
    assert!(sample.indices().as_flattened().iter().all(|&i| (i as usize) < positions.len()));
    assert_eq!(sample.indices().len(), 2 * positions.len() - 4);

    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("door");
    std::fs::create_dir_all(&folder).unwrap();
    for name in ["mesh.glb", "mesh.3mf", "mesh.STL", "mesh.obj", "points.ply", "points.csv", "points.npy"] {
        let path = folder.join(name);
        sample.save(&path).unwrap();
        assert!(path.metadata().unwrap().len() > 10_000, "{name}");
    }
    let error = sample.save(folder.join("mesh.step")).unwrap_err().to_string();
    assert!(
        error.contains("mesh.step") && error.contains("glb, 3mf, stl, obj, ply, csv, xyz, npy"),
        "{error}"
    );
}

#[test]
fn warnings_have_names_that_stay_and_say_how_much_they_weigh() {
    let refused = sample(
        FnField::new(sphere).with_gradient(|p| -outward(p)),
        &Settings::with_count(300).in_box(Bounds::cube(1.3)),
    );
    let warnings = match refused {
        Ok(sample) => sample.report().warnings.clone(),
        Err(_) => vec![Warning::Gradient { position: [0.0; 3], length: 1.0 }],
    };
    assert!(
        warnings.iter().any(|w| (w.code(), w.severity()) == ("gradient", Severity::Fault)),
        "{warnings:?}"
    );
    assert!(Severity::Note < Severity::Caution && Severity::Caution < Severity::Fault);
    assert_eq!(Warning::Touches.severity(), Severity::Note);
    for severity in [Severity::Note, Severity::Caution, Severity::Fault] {
        assert_eq!(serde_json::to_value(severity).unwrap(), severity.name());
    }
    let told = serde_json::to_value(Warning::Touches).unwrap();
    assert_eq!((&told["code"], &told["severity"]), (&"touches".into(), &"note".into()), "{told}");
    assert_eq!(told["message"], Warning::Touches.to_string());
}

#[test]
fn what_a_heart_always_does_is_a_note() {
    let heart = Formula::parse("(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3").unwrap();
    let sample = sample(heart, &Settings::with_count(6000)).unwrap();
    let warnings = &sample.report().warnings;
    assert!(warnings.iter().any(|warning| warning.code() == "children"), "{warnings:?}");
    // It has two tips, and around it a curve where the gradient vanishes although it is smooth.
    assert!(warnings.iter().all(|warning| warning.code() != "rims"), "{warnings:?}");
    assert_eq!(sample.report().proof.singular_points, Some(3), "{warnings:?}");
    assert!(warnings.iter().all(|warning| warning.severity() == Severity::Note), "{warnings:?}");
}

#[test]
fn a_run_that_borrows_its_field_is_the_same_as_the_whole_job() {
    let settings = Settings::with_count(FEW).adaptive();
    let whole = sample(FnField::new(sphere), &settings).unwrap();
    let mut field = FnField::new(sphere);
    let mut run = Run::start(&mut field, &settings).unwrap();
    while run.step(37).stop_reason.is_none() {}
    assert_eq!(run.particles().digest(), whole.particles().digest());
    // More steps, and a cancelled run, are measured as they stand.
    assert!(run.relax(2));
    while run.step(1_000).stop_reason.is_none() {}
    assert_eq!(run.report().growth.energy.map(|energy| energy.len()), Some(13));
    run.restart(&Settings::with_count(4 * FEW)).unwrap();
    while run.count() < 200 {
        run.step(100);
    }
    run.cancel();
    let part = run.finish().unwrap();
    assert_eq!(part.report().stop_reason, Some(StopReason::Cancelled));
    assert!(part.particles().len() < 4 * FEW as usize);
}

#[test]
fn what_is_known_at_the_start_is_told_before_the_first_step_and_measuring_can_be_left_out() {
    let run = || Run::start(FnField::new(sphere), &Settings::with_radius(Radius::Share(0.03))).unwrap();
    let mut measured = run();
    let start = measured.start_report().clone();
    assert!((start.area / (4.0 * std::f64::consts::PI) - 1.0).abs() < 0.05, "{start:?}");
    while measured.step(1_000).stop_reason.is_none() {}
    let count = measured.count();
    assert!(start.predicted_count.abs_diff(count as u64) as f64 <= 0.2 * count as f64, "{start:?}");
    assert_eq!(measured.progress().unwrap().radius, start.radius);
    let measured = measured.finish().unwrap();
    let mut plain = run();
    while plain.step(1_000).stop_reason.is_none() {}
    let plain = plain.finish_with(Measured::Nothing).unwrap();
    assert_eq!(plain.report().digest, measured.report().digest);
    assert!(plain.report().measures.quality.is_none() && measured.report().measures.quality.is_some());
    assert!(plain.measured().residual.is_empty() && measured.measured().residual.len() == count);
}

#[test]
fn a_box_that_is_given_is_kept_and_one_that_is_not_is_fitted() {
    let given = sample(FnField::new(sphere), &Settings::with_count(FEW).in_box(Bounds::cube(0.8))).unwrap();
    assert_eq!(given.bounds(), Bounds::cube(0.8));
    assert!(given.report().border > 0 && given.report().cut.is_some());
    let fitted = sample(FnField::new(sphere), &Settings::with_count(FEW)).unwrap();
    assert!(fitted.bounds().max.iter().all(|end| (1.0..1.6).contains(end)), "{:?}", fitted.bounds());
    // Far from zero, too, where single precision does not hold the places of particles.
    let centre = DVec3::new(1e4, -2e4, 0.0);
    let mut far = Bounds::cube(1.2);
    for axis in 0..3 {
        far.min[axis] += centre[axis];
        far.max[axis] += centre[axis];
    }
    let settings = Settings::with_count(FEW).in_box(Bounds { min: far.min, max: far.max });
    let far = sample(FnField::new(|p: DVec3| sphere(p - centre)), &settings);
    assert_eq!(far.err(), Some(Error::Settings(SettingsError::Box(BoxError::Far))));
    let near = DVec3::new(100.0, -200.0, 0.0);
    let around = Bounds { min: (near - 1.2).to_array(), max: (near + 1.2).to_array() };
    let sampled =
        sample(FnField::new(|p: DVec3| sphere(p - near)), &Settings::with_count(FEW).in_box(around)).unwrap();
    let off = (0..sampled.particles().len()).map(|i| sphere(sampled.particles().place(i) - near).abs());
    assert!(off.fold(0.0, f64::max) < 1e-5);
}

#[test]
fn a_closure_far_away_needs_its_box_and_a_part_beyond_the_box_is_told() {
    let far = FnField::new(|p: DVec3| sphere(p - DVec3::new(1000.0, -2000.0, 3000.0)));
    let error = sample(far, &Settings::with_count(FEW)).unwrap_err();
    assert!(matches!(error, Error::NoBox { cells: 32, .. }), "{error:?}");
    // The numbers that the documentation of `FnField` has.
    let said =
        "no box was given, and on grids of 32 cells a side over cubes around the origin, from ±4 to ±10000, ";
    assert!(error.to_string().starts_with(said), "{error}");
    // The second sphere is wider than two cells of the cube in which it lies.
    for (distance, radius) in [(12.0, 2.1), (60.0, 8.0), (1_500.0, 150.0)] {
        let second = DVec3::new(0.6, 0.0, 0.8) * distance;
        let two = FnField::new(|p: DVec3| sphere(p).min((p - second).length() - radius));
        let sample = sample(two, &Settings::with_count(FEW)).unwrap();
        let bounds = sample.bounds();
        assert_eq!(sample.report().warnings, [Warning::Beyond { bounds }], "at {distance}");
    }
}

thread_local! {
    static CALLS: Cell<u64> = const { Cell::new(0) };
}

fn counted_sphere(p: DVec3) -> f64 {
    CALLS.set(CALLS.get() + 1);
    sphere(p)
}

#[test]
fn any_field_is_measured_in_slices_and_none_is_measured_twice() {
    let settings = Settings::with_count(FEW);
    let whole = sample(FnField::new(sphere), &settings).unwrap();
    // A box has no copy.
    let field: Box<dyn Field> = Box::new(FnField::new(counted_sphere));
    let mut run = Run::start(field, &settings).unwrap();
    while run.step(1_000).stop_reason.is_none() {}
    assert!(run.measure(Measured::Particles).step(3).is_none(), "a measurement that is given up");
    let mut measuring = run.measure(Measured::Particles);
    let mut steps = 1;
    let report = loop {
        match measuring.step(10) {
            Some(report) => break report,
            None => steps += 1,
        }
    };
    assert!(steps > 10, "{steps}");
    drop(measuring);
    assert_eq!(format!("{report:?}"), format!("{:?}", whole.report()));
    let calls = CALLS.replace(0);
    let again = [run.report(), run.measure(Measured::Particles).step(1).unwrap()];
    let sample = run.finish().unwrap();
    assert_eq!(format!("{again:?}"), format!("{:?}", [&report, sample.report()]));
    assert!(CALLS.get() < calls / 100, "{} calls after {calls}", CALLS.get());
}

#[test]
fn the_fraction_goes_forward_alone_and_relaxation_is_refused_under_way() {
    let by_count = Settings::with_count(10_000);
    for settings in
        [by_count, by_count.adaptive(), by_count.refined(), Settings::with_radius(Radius::Share(0.02))]
    {
        let mut run = Run::start(FnField::new(sphere).with_gradient(outward), &settings).unwrap();
        let mut last = 0.0;
        loop {
            let progress = run.step(500);
            assert!((last..=1.0).contains(&progress.fraction), "{} after {last}", progress.fraction);
            last = progress.fraction;
            if progress.stop_reason.is_some() {
                break;
            }
            assert!(!run.relax(2));
        }
        assert_eq!(last, 1.0);
        assert!(run.relax(2));
        assert!(run.step(500).fraction < 1.0);
    }
}

#[test]
fn a_size_and_a_seed_are_chosen_in_one_line() {
    let by_hand = settings!(seed: 7, chord_error: 1e-3; ..Settings::default()).adaptive();
    assert_eq!(Settings::with_chord_error(1e-3).seeded(7), by_hand);
    let taken = |seed| {
        let settings = Settings::with_chord_error(1e-3).seeded(seed);
        sample(FnField::new(sphere), &settings).unwrap().report().digest.clone()
    };
    assert_ne!(taken(7), taken(8));
}

#[test]
fn files_are_written_from_a_sample() {
    let sample = sample(FnField::new(sphere), &Settings::with_count(FEW)).unwrap();
    for (_, format) in Format::ALL {
        let mut bytes = Vec::new();
        sample.write(format, &mut bytes).unwrap();
        assert!(bytes.len() > 24 * sample.particles().len(), "{format:?}");
    }
    for (_, format) in MeshFormat::ALL {
        let mut bytes = Vec::new();
        sample.write_mesh(format, &mut bytes).unwrap();
        assert!(bytes.len() > 12 * sample.mesh().triangles.len(), "{format:?}");
    }
}

#[test]
fn a_gradient_that_is_not_that_of_the_values_is_told() {
    let settings = Settings::with_count(FEW);
    let is_told = |field: &dyn Field| match sample(field, &settings) {
        Ok(sample) => {
            sample.report().warnings.iter().any(|warning| matches!(warning, Warning::Gradient { .. }))
        }
        Err(error) => error.to_string().contains("The gradient does not fit the values of f"),
    };
    assert!(is_told(&mut FnField::new(sphere).with_gradient(|p| -outward(p))));
    assert!(is_told(&mut FnField::new(sphere).with_gradient(|p| 3.0 * outward(p))));
    assert!(is_told(&mut FnField::new(sphere).with_gradient(|_| DVec3::X)));
    assert!(is_told(&mut FnField::new(sphere).with_gradient(|_| DVec3::ZERO)));
    assert!(is_told(&mut FnField::new(sphere).with_gradient(|_| DVec3::splat(f64::INFINITY))));
    assert!(is_told(&mut FnField::new(sphere).with_gradient(|_| DVec3::NAN)));
    assert!(!is_told(&mut FnField::new(sphere).with_gradient(outward)));
    // A kink is no wrong gradient.
    let cube = |p: DVec3| p.abs().max_element() - 1.0;
    assert!(!is_told(&mut FnField::new(cube)));
}

#[test]
fn a_field_without_a_surface_gets_a_sentence() {
    let settings = Settings::with_count(FEW).in_box(Bounds::cube(1.5));
    let refused = |value: fn(DVec3) -> f64| match sample(FnField::new(value), &settings) {
        Err(Error::Nothing { reason, message }) => (reason, message),
        other => panic!("{other:?}"),
    };
    let (reason, message) = refused(|_| f64::NAN);
    assert_eq!(reason, StopReason::Undefined);
    assert!(message.contains("no value"), "{message}");
    let (reason, message) = refused(|p| if p.x > 0.1 { 1.0 } else { -1.0 });
    assert_eq!(reason, StopReason::NoSurface);
    assert!(message.contains("jumps"), "{message}");
    let (_, message) = refused(|p| p.length() + 1.0);
    assert!(message.contains("keeps one sign"), "{message}");
    let (_, message) = refused(|p| if p.x > 0.1 { f64::INFINITY } else { f64::NEG_INFINITY });
    assert!(!message.is_empty());
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn a_field_with_faults_in_places_ends_in_particles_of_the_rest_or_in_a_sentence() {
    let step = |p: DVec3| if p.x > 0.3 { sphere(p) + 1.0 } else { sphere(p) };
    let fields: [(&str, Box<dyn Field>); 8] = [
        ("no value in a half", Box::new(FnField::new(|p| if p.x > 0.0 { f64::NAN } else { sphere(p) }))),
        (
            "no value in a layer",
            Box::new(FnField::new(|p| if p.x.abs() < 0.1 { f64::NAN } else { sphere(p) })),
        ),
        ("infinite in a half", Box::new(FnField::new(|p| if p.x > 0.0 { f64::INFINITY } else { sphere(p) }))),
        ("beyond single precision", Box::new(FnField::new(|p| 1e60 * sphere(p)))),
        ("a jump across the surface", Box::new(FnField::new(step))),
        ("noise", Box::new(FnField::new(|p| sphere(p) + 0.05 * (1e6 * p.x).fract()))),
        (
            "no gradient in a half",
            Box::new(FnField::new(sphere).with_gradient(|p| if p.x > 0.0 { DVec3::NAN } else { outward(p) })),
        ),
        (
            "no gradient in a half",
            Box::new(
                FnField::new(sphere).with_gradient(|p| if p.x > 0.0 { DVec3::ZERO } else { outward(p) }),
            ),
        ),
    ];
    let in_box = Settings::with_count(300).in_box(Bounds::cube(1.3));
    let runs = [Settings::with_count(300), in_box.adaptive(), settings!(method: Method::Refined; ..in_box)];
    for (what, mut field) in fields {
        for settings in runs {
            match sample(&mut field, &settings) {
                Ok(sample) => {
                    let Particles { local: position, normal, .. } = sample.particles();
                    assert!(position.iter().all(|p| p.is_finite()), "{what}, {settings:?}");
                    assert!(normal.iter().all(|n| (n.length() - 1.0).abs() < 1e-4), "{what}, {settings:?}");
                    // Values beyond single precision are computed in double precision, and nothing
                    // is amiss.
                    let is_told = !sample.report().warnings.is_empty();
                    assert!(is_told || what == "beyond single precision", "{what}, {settings:?}: not a word");
                }
                Err(error) => assert!(error.to_string().len() > 20, "{what}, {settings:?}: {error}"),
            }
        }
    }
}

#[test]
fn settings_out_of_range_are_refused_before_any_work() {
    let untouched = || FnField::new(|_: DVec3| -> f64 { panic!("the field is asked for nothing") });
    let mut settings = Settings::with_count(FEW).in_box(Bounds::cube(1.0));
    settings.grading = 2.0;
    let error = sample(untouched(), &settings).unwrap_err();
    assert_eq!(error.to_string(), "grading is 2, but must lie between 0.01 and 0.5");
    for (max, fault) in [
        ([1.0, 1.0, 0.0], BoxError::Empty),
        ([1.0, -1.0, 1.0], BoxError::Empty),
        ([1.0, f64::NAN, 1.0], BoxError::NotFinite),
        ([3e-13; 3], BoxError::Size),
    ] {
        let bounds = Bounds { min: [0.0; 3], max };
        let error = sample(untouched(), &Settings::with_count(FEW).in_box(bounds)).unwrap_err();
        assert_eq!(error, Error::Settings(SettingsError::Box(fault)));
    }
    let error = sample(untouched(), &Settings::with_radius(Radius::Share(0.5))).unwrap_err();
    assert!(matches!(error, Error::Settings(SettingsError::OutOfRange { name: "radius", .. })), "{error:?}");
}

#[test]
fn every_call_of_a_function_is_counted_and_a_limit_ends_the_run() {
    let settings = Settings::with_count(FEW).in_box(Bounds::cube(1.2));
    let asked = AtomicU64::new(0);
    let function = |p: DVec3| {
        asked.fetch_add(1, Ordering::Relaxed);
        sphere(p)
    };
    let report_of = |settings: &Settings| {
        asked.store(0, Ordering::Relaxed);
        sample(function, settings).unwrap().report().clone()
    };
    let report = report_of(&settings);
    let all = report.growth.calls.unwrap();
    assert_eq!(all, asked.load(Ordering::Relaxed));
    let coarse = report_of(&settings!(survey_cells: Some(24); ..settings));
    assert_eq!(coarse.growth.calls, Some(asked.load(Ordering::Relaxed)));
    assert!(coarse.growth.calls.unwrap() + 200_000 < all && coarse.count.abs_diff(FEW as usize) <= 45);
    // Formulas call no function of the program.
    let formula = sample(Formula::parse("x^2 + y^2 + z^2 = 1").unwrap(), &settings).unwrap();
    assert_eq!(formula.report().growth.calls, None);

    // One field for two runs: the first one needs all that is allowed.
    let field = FnField::new(function).limit_calls(all);
    asked.store(0, Ordering::Relaxed);
    assert_eq!(sample(&field, &settings).unwrap().report().growth.calls, Some(all));
    let error = sample(&field, &settings).unwrap_err();
    assert!(error.to_string().contains(&format!("more than {all} points")), "{error}");
    assert_eq!(asked.load(Ordering::Relaxed), all);
    // A copy has been asked for nothing.
    assert!(sample(field.clone(), &settings).is_ok());
    for most in [0, all / 2, all - 1] {
        asked.store(0, Ordering::Relaxed);
        let error = sample(FnField::new(function).limit_calls(most), &settings).unwrap_err();
        assert!(matches!(error, Error::Field(_)), "{error:?}");
        assert!(asked.load(Ordering::Relaxed) <= most);
    }
}

#[test]
fn a_survey_with_other_cells_is_made_anew() {
    let settings = Settings::with_count(FEW).in_box(Bounds::cube(1.2));
    let field = FnField::new(sphere);
    let mut run = Run::start(&field, &settings).unwrap();
    let first = field.calls().unwrap();
    run.restart(&settings).unwrap();
    let again = field.calls().unwrap() - first;
    assert!(again < first / 10, "{again} of {first}");
    run.restart(&settings!(survey_cells: Some(32); ..settings)).unwrap();
    assert!(field.calls().unwrap() - first - again > first / 10);
}

#[test]
fn a_radius_is_a_length_or_a_share_and_makes_room() {
    let bounds = Bounds::cube(1.5);
    let by_length = Settings::with_radius(Radius::Length(0.02)).in_box(bounds);
    let by_share = Settings::with_radius(Radius::Share(0.02 / bounds.diagonal())).in_box(bounds);
    let [length, share] = [by_length, by_share].map(|settings| sample(sphere, &settings).unwrap());
    assert_eq!(length.particles().digest(), share.particles().digest());
    // In a fitted box the length is what it is.
    let fitted = sample(sphere, &Settings::with_radius(Radius::Length(0.02))).unwrap();
    assert!((fitted.report().sizes.radius - 0.02).abs() < 1e-12);
    let shell = Formula::parse("x^2 + y^2 + z^2 = 1").unwrap();
    let fine = settings!(relax_steps: 0; ..Settings::with_spacing(0.006));
    let mut run = Run::start(shell, &fine).unwrap();
    while run.step(u32::MAX).stop_reason.is_none() {}
    assert!(run.count() > 200_000);
    let error =
        sample(sphere, &Settings::with_radius(Radius::Length(2.0)).in_box(Bounds::cube(1.0))).unwrap_err();
    assert!(error.to_string().starts_with("radius is 2, but must lie between 0.000346"), "{error}");
}

#[test]
fn a_radius_of_particles_of_many_sizes_is_refused() {
    let sphere = Formula::parse("x^2 + y^2 + z^2 = 1").expect("a formula");
    for radius in [Radius::Length(0.1), Radius::Share(0.02)] {
        let settings = Settings::with_radius(radius);
        let spacing = Spacing::by(|p: DVec3| 0.1 + 0.01 * p.z.abs());
        for settings in [(&settings.adaptive()).into(), settings.spaced(spacing)] {
            let refused = sample(&sphere, &settings).err();
            assert!(matches!(refused, Some(Error::Settings(SettingsError::RadiusOfVarying))), "{refused:?}");
        }
    }
}

#[test]
fn settings_as_text_keep_the_box_and_refuse_names_that_they_do_not_have() {
    let in_box = Settings::with_count(7).in_box(Bounds::cube(1.5));
    for (radius, written) in
        [(Radius::Length(0.1), json!(0.1)), (Radius::Share(0.01), json!({"share": 0.01}))]
    {
        let settings = settings!(radius: Some(radius), survey_cells: Some(32); ..in_box);
        let text = serde_json::to_string(&settings).unwrap();
        assert_eq!(serde_json::from_str::<Settings>(&text).unwrap(), settings);
        assert_eq!(json!(settings)["radius"], written);
    }
    let whole = serde_json::from_str::<Settings>("{\"radius\": 1}").unwrap();
    assert_eq!(whole.radius, Some(Radius::Length(1.0)));
    let error = serde_json::from_str::<Settings>("{\"radius\": {\"part\": 1}}").unwrap_err().to_string();
    assert!(error.contains("expected a length, or {\"share\": a share"), "{error}");
    assert_eq!(serde_json::from_str::<Settings>("{}").unwrap(), Settings::DEFAULT);
    let error = serde_json::from_str::<Settings>("{\"relax_step\": 3}").unwrap_err();
    assert!(error.to_string().starts_with("unknown field `relax_step`"), "{error}");
}

/// The shares of the work that are told during a run, its report and its mesh rise to 1, and each
/// stage has slices to tell them by: an estimate that is half too small or large would show here.
#[test]
fn the_shares_of_a_call_rise_to_one() {
    for (text, method) in [
        ("x^2 + 2y^2 + 3z^2 = 1", Method::Front),
        ("x^2 + 2y^2 + 3z^2 = 1", Method::Refined),
        ("max(|x|, |y|, |z|) = 1", Method::Front),
    ] {
        let surface = Formula::parse(text).expect("a formula");
        let mut settings = Settings::with_count(30_000);
        settings.method = method;
        let mut run = Run::start(surface, &settings).expect("a run");
        run.plan(Measured::FrontToo, true);
        let mut told = vec![0.0];
        while run.step(10_000).stop_reason.is_none() {
            told.push(run.fraction());
        }
        let sampled = run.fraction();
        let mut reporting = run.measure(Measured::FrontToo);
        let mut before_last = 0.0;
        while reporting.step(100).is_none() {
            before_last = reporting.fraction();
            told.push(before_last);
        }
        drop(reporting);
        let measured = run.fraction();
        told.push(measured);
        let missing = (measured - before_last) / (measured - sampled);
        assert!(missing.abs() < 0.25, "{text}: {missing} of the measuring is untold");
        while run.join(100).is_none() {
            told.push(run.fraction());
        }
        told.push(run.fraction());
        assert!(told.is_sorted(), "{text}: {told:?}");
        assert!((0.1..0.6).contains(&sampled), "{text}: {sampled} after the run");
        assert!((run.fraction() - 1.0).abs() < 1e-9, "{text}: {} in the end", run.fraction());
    }
}

#[test]
fn a_run_that_is_cancelled_before_its_first_particle_is_no_empty_surface() {
    let settings = Settings::with_count(FEW).in_box(Bounds::cube(1.5));
    let run = |steps: u32, is_cancelled: bool| {
        let mut run = Run::start(sphere, &settings).expect("a sphere");
        for _ in 0..steps {
            run.step(1);
        }
        if is_cancelled {
            run.cancel();
        }
        run.finish()
    };
    for is_cancelled in [true, false] {
        assert_eq!(run(0, is_cancelled).err(), Some(Error::Cancelled));
    }
    // Later there are particles, and the sample says why it ends there.
    let mut steps = 1;
    while run(steps, true).is_err() {
        assert_eq!(run(steps, true).err(), Some(Error::Cancelled), "{steps} steps");
        steps *= 2;
    }
    let sample = run(steps, true).expect("particles");
    assert_eq!(sample.report().stop_reason, Some(StopReason::Cancelled));
    // Where there is no surface, a run to the end says so.
    let nothing = sample_of_nothing(&settings);
    assert!(matches!(nothing, Error::Nothing { reason: StopReason::NoSurface, .. }), "{nothing}");
}

fn sample_of_nothing(settings: &Settings) -> Error {
    sample(|p: DVec3| p.length() + 1.0, settings).expect_err("no surface")
}

#[test]
fn particles_become_fewer_only_where_another_attempt_at_a_count_begins() {
    let heart = Formula::parse("(x^2 + 9/4 y^2 + z^2 - 1)^3 = x^2 z^3 + 9/80 y^2 z^3").expect("a formula");
    let mut run = Run::start(heart, &Settings::with_count(FEW)).expect("a heart");
    let (mut attempt, mut attempt_before, mut particles) = (1, 1, 0);
    loop {
        let progress = run.step(200);
        if progress.stop_reason.is_some() {
            break;
        }
        assert!(progress.attempt >= attempt, "attempt {} after {attempt}", progress.attempt);
        // A seed that stays alone is taken back. The particles of an attempt go with the next one's
        // first step.
        assert!(
            progress.attempt > attempt_before || 2 * progress.particles >= particles,
            "attempt {attempt}: {} particles after {particles}",
            progress.particles
        );
        (attempt_before, attempt, particles) = (attempt, progress.attempt, progress.particles);
    }
}

#[test]
fn a_function_that_only_tells_inside_from_outside_is_refused_with_its_values() {
    use rand_core::Rng;
    let mut random = rand_pcg::Pcg64Mcg::new(17);
    let mut number = || f64::from(random.next_u32()) / f64::from(u32::MAX);
    for round in 0..40 {
        let centre = DVec3::new(number(), number(), number()) - 0.5;
        let is_round = number() < 0.5;
        let distance = move |p: DVec3| {
            let q = p - centre;
            if is_round { q.length() - 1.0 } else { q.abs().max_element() - 0.8 }
        };
        let values = [[0.0, 1.0], [1.0, 0.0], [-1.0, 1.0], [-0.25, 3.0]][round % 4];
        let is_layered = number() < 0.3;
        let told = move |p: DVec3| match distance(p) {
            d if d > 0.3 && is_layered => 7.0,
            d => values[usize::from(d > 0.0)],
        };
        let mut listed = values.to_vec();
        listed.extend(is_layered.then_some(7.0));
        listed.sort_by(f64::total_cmp);
        let listed: Vec<String> = listed.iter().map(f64::to_string).collect();
        let (last, others) = listed.split_last().expect("values");
        let text = format!("f takes only the values {} and {last} and jumps", others.join(", "));
        let settings = Settings::with_count(300);
        let settings = if number() < 0.5 { settings } else { settings.in_box(Bounds::cube(2.0)) };
        match sample(told, &settings) {
            Err(Error::Nothing { reason: StopReason::NoSurface, message }) => {
                assert!(message.starts_with(&text), "round {round}: {message} is not {text}");
            }
            other => panic!("round {round}: {other:?}"),
        }
        // A distance that is cut off is one where it is near zero.
        let width = 0.2 * number() * number();
        let cut = sample(move |p: DVec3| (p.distance(centre) - 1.0).clamp(-width, width), &settings);
        assert!(cut.is_ok(), "round {round}: a width of {width}");
    }
}

#[test]
fn a_formula_that_jumps_between_whole_numbers_is_refused_with_them() {
    for (text, values) in [
        ("step(1, hypot(x, y, z))", "the values 0 and 1"),
        ("sign(x^2 + y^2 + z^2 - 1)", "the values -1"),
        ("if(x^2 + y^2 < 1, -1, 1)", "the values -1 and 1"),
        ("floor(hypot(x, y, z))", "4 values, from 0 to 3,"),
    ] {
        let formula = Formula::parse(text).expect("a formula");
        match sample(formula, &Settings::with_count(300).in_box(Bounds::cube(2.0))) {
            Err(Error::Nothing { message, .. }) => {
                assert!(message.starts_with(&format!("f takes only {values}")), "{text}: {message}");
            }
            other => panic!("{text}: {other:?}"),
        }
    }
}
