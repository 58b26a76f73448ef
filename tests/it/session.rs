//! Tests of the session: fields, runs and reports.

use marching_particles::Bounds;
use marching_particles::field::BatchField;
use marching_particles::field::formula::Parameter;
use marching_particles::glam::DVec3;
use marching_particles::internal::session::{FaultKind, FieldRequest, Session, describe};
use marching_particles::run::Measured;
use marching_particles::sample;
use marching_particles::sampler::{GapPolicy, Method, Phase, Settings, SizeMode, StopReason};
use std::sync::Arc;

fn request(text: &str) -> FieldRequest {
    serde_json::from_str(text).expect("a field request")
}

#[test]
fn requests_and_settings_are_read_to_the_last_bit() {
    let request = request(
        r#" { "surface" : "torus", "formula":null,
        "parameters":{"a":1,"b":-2.5e-3,"\u00e9\ud83d\ude00\n\"":0.1},
        "declare":[{"name":"k","label":"K","value":1.0,"min":0,"max":2,"step":0.1}],
        "bounds":{"min":[-1,-1.5,-2],"max":[1,2,3e0]}, "unknown":[{},[],"",true,false,null,{"x":[1,2]}] } "#,
    );
    assert_eq!((request.surface.as_deref(), request.formula.as_deref()), (Some("torus"), None));
    assert_eq!(request.parameters.get("é😀\n\""), Some(&0.1));
    let declared =
        Parameter { name: "k".into(), label: "K".into(), value: 1.0, min: 0.0, max: 2.0, step: 0.1 };
    assert_eq!(request.declare, [declared]);
    assert_eq!(request.bounds, Some(Bounds { min: [-1.0, -1.5, -2.0], max: [1.0, 2.0, 3.0] }));
    let settings: Settings =
        serde_json::from_str(r#"{"seed":18446744073709551615,"count":77,"gaps":"leave"}"#).expect("settings");
    assert_eq!((settings.seed, settings.count, settings.gaps), (u64::MAX, 77, GapPolicy::Leave));
    assert_eq!(settings.relax_steps, Settings::default().relax_steps);
    // A reader that rounds twice takes the next double for some of these.
    for k in 1..1000 {
        let settings = settings!(radius_share: f64::from(k).sqrt() * 1e-3; ..Settings::default());
        let written = serde_json::to_string(&settings).expect("settings can be written");
        assert_eq!(serde_json::from_str::<Settings>(&written).expect("what was written"), settings);
    }
}

#[test]
fn malformed_settings_are_refused() {
    let nested = "[".repeat(100_000);
    for text in [
        "",
        "{",
        "{}x",
        "3",
        "{seed:1}",
        "{\"seed\":-1}",
        "{\"seed\":1.5}",
        "{\"seed\":\"1\"}",
        "{\"seed\":null}",
        "{\"count\":4294967296}",
        "{\"radius_share\":1e999}",
        "{\"radius_share\":NaN}",
        "{\"gaps\":\"sometimes\"}",
        "{\"seed\":1,\"seed\":2}",
        &nested,
    ] {
        assert!(serde_json::from_str::<Settings>(text).is_err(), "{text}");
    }
}

fn run(session: &mut Session, settings: &Settings, budget: u32) -> StopReason {
    session.start(settings).expect("valid settings");
    loop {
        let progress = session.run.step(budget);
        if let Some(reason) = progress.stop_reason {
            return reason;
        }
    }
}

fn sized(count: u32) -> Settings {
    settings!(size_mode: SizeMode::Count, count; ..Settings::default())
}

#[test]
fn a_run_cut_into_single_units_is_the_same_run() {
    let mut one = Session::new();
    let mut many = Session::new();
    let settings = sized(700);
    assert_eq!(run(&mut one, &settings, u32::MAX), StopReason::Complete);
    assert_eq!(run(&mut many, &settings, 1), StopReason::Complete);
    assert_eq!(one.run.particles().digest(), many.run.particles().digest());
    let mut seven = Session::new();
    run(&mut seven, &settings, 7);
    assert_eq!(one.run.particles().digest(), seven.run.particles().digest());
}

#[test]
fn the_figures_of_the_front_do_not_depend_on_the_steps() {
    let before = |budget| {
        let mut session = Session::new();
        run(&mut session, &sized(900), budget);
        session.report().measures.quality_before.expect("figures of the front")
    };
    let whole = before(u32::MAX);
    assert!(whole.order.six_neighbours > 0.5);
    // Compared as text, because an undefined figure is not equal to itself.
    assert_eq!(format!("{:?}", before(1)), format!("{whole:?}"));
    assert_eq!(format!("{:?}", before(1_234)), format!("{whole:?}"));
}

#[test]
fn a_report_cut_into_single_slices_is_the_same_report() {
    let text = |report| serde_json::to_string(&report).expect("a report can be written");
    let mut session = Session::new();
    run(&mut session, &sized(900), u32::MAX);
    let whole = text(session.report());
    let columns = session.run.measured().clone();
    for budget in [1, 7, 500] {
        let mut cut = Session::new();
        run(&mut cut, &sized(900), u32::MAX);
        let mut calls = 0;
        let report = loop {
            calls += 1;
            if let Some(report) = cut.measure(Measured::FrontToo, budget) {
                break report;
            }
        };
        assert!(calls * budget > 100 && (calls > 2 || budget > 100), "{calls} calls of {budget}");
        assert_eq!(text(report), whole);
        // Compared as text, because an undefined figure is not equal to itself.
        assert_eq!(format!("{:?}", cut.run.measured()), format!("{columns:?}"));
    }
}

#[test]
fn a_report_is_begun_anew_after_a_change() {
    let mut session = Session::new();
    run(&mut session, &sized(900), u32::MAX);
    assert!(session.measure(Measured::FrontToo, 300).is_none());
    run(&mut session, &sized(500), u32::MAX);
    let count = session.run.count();
    assert!(session.measure(Measured::FrontToo, 300).is_none());
    assert!(session.run.relax(1));
    while session.run.step(1_000).stop_reason.is_none() {}
    let report = session.report();
    assert_eq!((report.count, report.growth.energy.map_or(0, |energy| energy.len())), (count, 12));
    assert_eq!(report.measures.nearest_histogram.bins.iter().sum::<u32>() as usize, count);
    assert!(
        report.measures.quality_before.is_some(),
        "the front is measured though the first measurement was given up"
    );
    // On another field the particles are measured anew too.
    let ball = request(r#"{"formula":"x^2+y^2+z^2-1"}"#);
    assert!(session.measure(Measured::FrontToo, 0).is_some(), "what is measured is not measured again");
    session.set_field(&ball).unwrap();
    assert!(session.report().measures.quality.expect("particles").accuracy.error_max > 1.0);
}

#[test]
fn a_parameter_has_the_label_of_its_surface_in_the_formula_of_that_surface_alone() {
    let mut session = Session::new();
    let mut label = |field: &str| {
        let answer = session.set_field(&request(field)).expect("a field");
        let parameter = answer.parameters.iter().find(|parameter| parameter.name == "a");
        parameter.expect("the formula has `a`").label.clone()
    };
    assert_eq!(label(r#"{"surface":"ellipsoid"}"#), "Semi-axis along x");
    assert_eq!(label(r#"{"surface":"ellipsoid","formula":"x^2+y^2+a*z^2=1"}"#), "a");
    let declared = r#"{"surface":"ellipsoid","formula":"x^2+y^2+a*z^2=1",
        "declare":[{"name":"a","label":"Flatness","value":1,"min":0,"max":2,"step":0.1}]}"#;
    assert_eq!(label(declared), "Flatness");
    assert_eq!(label(r#"{"surface":"ellipsoid"}"#), "Semi-axis along x");
}

#[test]
fn a_parameter_of_a_formula_of_ones_own_begins_afresh() {
    let mut session = Session::new();
    let answer = session
        .set_field(&request(r#"{"surface":"ellipsoid","formula":"x^2/a^2 + y^2/b^2 - z^2/c^2 = 1"}"#))
        .expect("a field");
    assert_eq!(answer.parameters, ["a", "b", "c"].map(Parameter::automatic));
}

#[test]
fn a_parameter_that_is_no_longer_given_has_its_value_of_the_beginning_again() {
    let mut session = Session::new();
    let mut value = |field: &str| {
        let answer = session.set_field(&request(field)).expect("a field");
        answer.parameters[0].value
    };
    for (given, not_given) in [
        (r#"{"surface":"ellipsoid","parameters":{"a":0.5}}"#, r#"{"surface":"ellipsoid"}"#),
        (
            r#"{"surface":"ellipsoid","formula":"x^2+y^2+k*z^2=1","parameters":{"k":0.5}}"#,
            r#"{"surface":"ellipsoid","formula":"x^2+y^2+k*z^2=1"}"#,
        ),
    ] {
        let usual = value(not_given);
        assert_ne!(usual, 0.5);
        assert_eq!(value(given), 0.5);
        assert_eq!(value(not_given), usual);
    }
    // A change of the present field keeps the values that it does not name.
    assert_eq!(value(r#"{"surface":"ellipsoid","parameters":{"a":0.5}}"#), 0.5);
    assert_eq!(value(r#"{"parameters":{"b":0.25}}"#), 0.5);
}

#[test]
fn a_session_can_be_used_again_with_the_same_result() {
    let mut session = Session::new();
    run(&mut session, &sized(500), 1000);
    let first = session.run.particles().digest();
    session.set_field(&request(r#"{"surface":"torus"}"#)).unwrap();
    run(&mut session, &sized(900), 333);
    assert_ne!(session.run.particles().digest(), first);
    session.set_field(&request(r#"{"surface":"ellipsoid"}"#)).unwrap();
    run(&mut session, &sized(500), 10);
    assert_eq!(session.run.particles().digest(), first);
}

#[test]
fn another_seed_begins_elsewhere() {
    let mut session = Session::new();
    run(&mut session, &sized(500), 1000);
    let first = session.run.particles().local[0];
    run(&mut session, &settings!(seed: 1; ..sized(500)), 1000);
    assert_ne!(session.run.particles().local[0], first);
}

#[test]
fn the_count_is_met_within_three_percent() {
    for (surface, count) in [("ellipsoid", 1500), ("torus", 3000), ("tanglecube", 12_000), ("sphere", 9_000)]
    {
        let mut session = Session::new();
        session.set_field(&request(&format!(r#"{{"surface":"{surface}"}}"#))).unwrap();
        run(&mut session, &settings!(relax_steps: 0; ..sized(count)), u32::MAX);
        let miss = session.run.count() as f64 / f64::from(count) - 1.0;
        assert!(miss.abs() <= 0.03, "{surface}: {} particles for {count}", session.run.count());
    }
}

#[test]
fn a_count_that_cannot_be_met_gives_a_warning() {
    let said = |field: &str, count: u32| {
        let mut session = Session::new();
        session.set_field(&request(field)).expect("a field");
        run(&mut session, &sized(count), u32::MAX);
        let report = session.report();
        let miss = (report.count as f64 / f64::from(count) - 1.0).abs();
        let is_said = report
            .warnings
            .iter()
            .any(|warning| warning.to_string().contains(&format!("instead of {count}.")));
        assert_eq!(
            is_said,
            miss > 0.03,
            "{field}, {count}: {} particles, {:?}",
            report.count,
            report.warnings
        );
        is_said
    };
    // The surfaces are a strip narrower than its particles and bars thinner than theirs.
    assert!(said(r#"{"formula":"x","bounds":{"min":[-1,-1,-1e-4],"max":[1,1,1e-4]}}"#, 500));
    assert!(said(r#"{"surface":"decocube"}"#, 8));
    assert!(!said(r#"{"surface":"decocube"}"#, 1000));
    assert!(!said(r#"{"surface":"sphere"}"#, 1));
}

#[test]
fn cancelling_keeps_the_particles() {
    for budget in [100, 2_000, 6_000, 20_000] {
        let mut session = Session::new();
        session.start(&sized(2_000)).unwrap();
        session.run.step(budget);
        let progress = session.run.cancel();
        assert_eq!(progress.phase, Phase::Done);
        assert_eq!(progress.stop_reason, Some(StopReason::Cancelled));
        assert_eq!(progress.particles, session.run.particles().len());
        let particles = session.run.particles();
        let columns = [
            particles.normal.len(),
            particles.radius.len(),
            particles.parent.len(),
            particles.level.len(),
            particles.slots.len(),
        ];
        assert_eq!(columns, [particles.len(); 5]);
        assert!(particles.local.iter().all(|p| p.is_finite()));
        let report = session.report();
        assert_eq!(report.count, progress.particles);
        assert!(
            report.measures.quality.is_none_or(|q| q.accuracy.error_max < 1e-2),
            "cancelled after {budget}"
        );
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn another_field_ends_the_run_and_keeps_its_particles() {
    let changes = [
        r#"{"formula":"x y z"}"#,
        r#"{"bounds":{"min":[-2,-2,-2],"max":[2,2,2]}}"#,
        r#"{"parameters":{"a":0.6}}"#,
    ];
    for steps in 0..60 {
        for change in changes {
            let mut session = Session::new();
            session.start(&sized(300)).expect("valid settings");
            for _ in 0..steps {
                session.run.step(200);
            }
            session.set_field(&request(change)).expect("a field");
            let count = session.run.count();
            assert_eq!(session.run.particles().len(), count, "{change} after {steps} steps");
            let progress = session.run.step(1_000);
            assert!(progress.stop_reason.is_some(), "{change} after {steps} steps: {progress:?}");
            assert!(!session.run.relax(2));
            assert_eq!(session.run.step(1_000).relax_step, progress.relax_step);
            assert_eq!(session.run.count(), count);
            assert_eq!(run(&mut session, &sized(300), 5_000), StopReason::Complete);
        }
    }
    let mut session = Session::new();
    session.start(&sized(300)).expect("valid settings");
    session.run.step(200);
    session.set_field(&request(r#"{"parameters":{"a":1}}"#)).expect("the field that it is");
    assert_eq!(session.run.step(200).stop_reason, None);
}

#[test]
fn more_relaxation_can_be_asked_for() {
    let mut session = Session::new();
    run(&mut session, &settings!(relax_steps: 0; ..sized(1_000)), 500);
    let generated = session.run.particles().digest();
    assert!(session.run.relax(1));
    while session.run.step(100).stop_reason.is_none() {}
    assert_ne!(session.run.particles().digest(), generated);
    assert_eq!(session.report().growth.energy.expect("it was relaxed").len(), 2);
    assert!(session.run.relax(3));
    while session.run.step(77).stop_reason.is_none() {}
    let energy = session.report().growth.energy.expect("it was relaxed");
    assert_eq!(energy.len(), 5);
    assert!(energy.is_sorted_by(|a, b| a > b), "{energy:?}");
}

#[test]
fn a_mistake_leaves_the_last_good_field() {
    let mut session = Session::new();
    let before = session.answer();
    let flat = r#"{"bounds":{"min":[0,0,0],"max":[1,1,0]}}"#;
    let kinds = [r#"{"formula":"x^2+"}"#, r#"{"surface":"nowhere"}"#, flat]
        .map(|text| session.set_field(&request(text)).expect_err("a mistake").kind);
    assert!(matches!(kinds, [FaultKind::Formula(_), FaultKind::UnknownSurface, FaultKind::Box]), "{kinds:?}");
    assert_eq!(session.answer(), before);
}

#[test]
fn parameters_can_be_declared_and_set() {
    let mut session = Session::new();
    let answer = session
        .set_field(&request(r#"{"formula":"x^2+y^2+z^2-a^2","parameters":{"a":0.5,"gone":3}}"#))
        .unwrap();
    assert_eq!(answer.auto, ["a"]);
    assert_eq!(answer.parameters[0].value, 0.5);
    assert_eq!(answer.surface, None);
    let answer = session.set_field(&request(r#"{"parameters":{"a":0.75}}"#)).unwrap();
    assert_eq!(answer.parameters[0].value, 0.75);
    assert_eq!(answer.formula, "x^2+y^2+z^2-a^2");
}

#[test]
fn a_surface_without_zeros_is_reported() {
    let cases = [
        ("x^2+y^2+z^2+1", StopReason::NoSurface),
        ("0*x+3", StopReason::Constant),
        ("x-x", StopReason::Constant),
        ("ln(-1-x^2)", StopReason::Undefined),
    ];
    for (formula, reason) in cases {
        let mut session = Session::new();
        session.set_field(&request(&format!(r#"{{"formula":"{formula}"}}"#))).unwrap();
        assert_eq!(run(&mut session, &Settings::default(), 10_000), reason, "{formula}");
        assert_eq!(session.run.count(), 0);
        let last = session.run.step(1);
        assert!(last.message.is_some_and(|m| m.len() > 20), "{formula}");
        assert_eq!(session.report().count, 0);
    }
}

#[test]
fn an_absent_surface_is_proven_absent() {
    let mut session = Session::new();
    session.set_field(&request(r#"{"formula":"x^2+y^2+z^2+1"}"#)).unwrap();
    run(&mut session, &Settings::default(), 10_000);
    assert!(session.run.step(1).message.is_some_and(|m| m.contains("proven")));
}

#[test]
fn a_radius_larger_than_the_surface_gives_one_particle_and_an_explanation() {
    let mut session = Session::new();
    session
        .set_field(&request(r#"{"formula":"x^2+y^2+z^2-0.01","bounds":{"min":[-1,-1,-1],"max":[1,1,1]}}"#))
        .unwrap();
    let settings = settings!(radius_share: 0.1; ..Settings::default());
    assert_eq!(run(&mut session, &settings, 1000), StopReason::OneParticle);
    assert_eq!(session.run.count(), 1);
    assert!(session.run.step(1).message.is_some_and(|m| m.contains("smaller radius")));
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let mut session = Session::new();
    for radius in [0.0, -1.0, f64::NAN, 1e-9, f64::INFINITY] {
        let error = session.start(&settings!(radius_share: radius; ..Settings::default())).unwrap_err();
        assert!(error.to_string().contains("radius_share"), "{error}");
    }
}

#[test]
fn the_cap_stops_a_run_and_says_so() {
    let mut session = Session::new();
    let settings = settings!(max_particles: 300; ..Settings::default());
    let start = session.start(&settings).unwrap();
    assert!(start.predicted_count > 300);
    assert!(!start.warnings.is_empty());
    assert_eq!(run(&mut session, &settings, 50), StopReason::Cap);
    assert!(session.run.count() <= 300 && session.run.count() > 250, "{}", session.run.count());
}

#[test]
fn a_wanted_count_as_large_as_the_limit_is_met() {
    for count in [1_500, 12_000] {
        let mut session = Session::new();
        let settings = settings!(max_particles: count, relax_steps: 0; ..sized(count));
        assert_eq!(run(&mut session, &settings, 10_000), StopReason::Complete);
        let miss = session.run.count() as f64 / f64::from(count) - 1.0;
        assert!(miss.abs() <= 0.03, "{} particles for {count}", session.run.count());
    }
}

#[test]
fn every_row_of_the_report_is_in_the_report() {
    let mut session = Session::new();
    run(&mut session, &sized(800), 1000);
    let report = serde_json::to_value(session.report()).unwrap();
    let description = describe();
    assert!(description.report.len() > 10);
    for row in description.report {
        for path in [Some(row.key), row.to, row.unless].into_iter().flatten() {
            let found = path.split('.').try_fold(&report, |value, key| value.get(key));
            assert!(found.is_some_and(|v| !v.is_object() && !v.is_array()), "{path} is not in the report");
        }
    }
    for fate in description.fates {
        assert!(report["fates"].get(fate.name).is_some(), "{}", fate.name);
    }
}

#[test]
fn a_field_from_points_takes_the_formulas_place_and_gives_it_back() {
    use marching_particles::field::model::ModelInfo;
    use marching_particles::field::rbf::RbfData;

    // The field is r³ − 1, a sphere: one centre with α = 1 gives r³, and a far one with a small
    // coefficient adds a constant.
    let data = RbfData {
        centres: vec![[0.0; 3], [0.0, 0.0, 1000.0]],
        alpha: vec![1.0, -1e-9],
        beta: vec![[0.0; 3]; 2],
        border: None,
    };
    let info = ModelInfo { name: "ball".into(), points: 2, centres: 2, ..ModelInfo::default() };
    let mut session = Session::new();
    let own = FieldRequest::default();
    let before = session.answer();
    assert_eq!(before.model, None);
    let answer = session.set_points(data.clone(), info.clone(), Bounds::cube(1.5), &own).expect("a field");
    assert_eq!((answer.model.as_ref(), answer.surface, answer.formula.as_str()), (Some(&info), None, ""));

    session.start(&settings!(radius_share: 0.02; ..Settings::default())).expect("valid settings");
    while session.run.step(1000).stop_reason.is_none() {}
    let report = session.report();
    assert_eq!(report.stop_reason, Some(StopReason::Complete));
    assert_eq!(report.measures.quality.expect("particles").connectivity.euler, 2);
    assert!(session.run.particles().local.iter().all(|p| (p.length() - 1.0).abs() < 1e-2));

    // Only the box of such a field can be changed. An invalid box changes nothing.
    let smaller = FieldRequest { bounds: Some(Bounds::cube(1.2)), ..FieldRequest::default() };
    let answer = session.set_field(&smaller).expect("a box");
    assert_eq!((answer.model.as_ref(), answer.bounds), (Some(&info), Bounds::cube(1.2)));
    assert!(session.set_points(RbfData::default(), info.clone(), Bounds::cube(1.0), &own).is_err());
    assert!(session.set_points(data, info, Bounds { min: [1.0; 3], max: [0.0; 3] }, &own).is_err());
    assert_eq!(session.answer(), answer);

    let formula = FieldRequest { formula: Some("x^2 + y^2 + z^2 = 1".into()), ..FieldRequest::default() };
    let answer = session.set_field(&formula).expect("a formula");
    assert_eq!((answer.model, answer.bounds), (None, Bounds::cube(1.2)));
}

#[test]
fn a_run_beyond_the_memory_is_refused_and_a_smaller_one_goes_on() {
    let mut session = Session::new();
    session.run.limit_memory(16 << 20);
    let large = settings!(size_mode: SizeMode::Count, count: 100_000; ..Settings::default());
    let error = session.start(&large).expect_err("100,000 particles and their report take 38 MB").to_string();
    assert!(error.contains("about 100,000 particles") && error.contains("choose fewer"), "{error}");
    session.start(&settings!(count: 20_000; ..large)).expect("20,000 take 8 MB");
    while session.run.step(65_536).stop_reason.is_none() {}
    assert!(session.run.count().abs_diff(20_000) <= 600);
}

#[test]
fn a_field_that_stays_is_surveyed_once_and_sampled_alike() {
    let finish = |session: &mut Session| {
        while session.run.step(65_536).stop_reason.is_none() {}
        let report = session.report();
        (report.digest, report.growth.evaluations)
    };
    let coarse = settings!(radius_share: 0.02; ..Settings::default());
    let fine = settings!(radius_share: 0.01; ..coarse);
    let mut session = Session::new();
    let mut seen = Vec::new();
    for settings in [&coarse, &fine, &coarse] {
        session.set_field(&FieldRequest::default()).expect("nothing is asked");
        session.start(settings).expect("valid settings");
        seen.push(finish(&mut session));
    }
    assert_eq!(seen[0].0, seen[2].0);
    assert!(seen[2].1 + 25_000 < seen[0].1, "{seen:?}: the survey takes more than 25,000 evaluations");
    let mut fresh = Session::new();
    fresh.start(&fine).expect("valid settings");
    assert_eq!(finish(&mut fresh).0, seen[1].0);

    // A change of the field or of the box discards the survey.
    let parameter = FieldRequest { parameters: [("a".into(), 0.9)].into(), ..FieldRequest::default() };
    let boxed = FieldRequest { bounds: Some(Bounds::cube(1.5)), ..FieldRequest::default() };
    for request in [parameter, boxed] {
        session.set_field(&request).expect("valid");
        session.start(&coarse).expect("valid settings");
        let (digest, evaluations) = finish(&mut session);
        assert!(evaluations > 25_000, "{request:?}");
        let mut fresh = Session::new();
        fresh
            .set_field(&FieldRequest { parameters: [("a".into(), 0.9)].into(), ..request.clone() })
            .expect("valid");
        fresh.start(&coarse).expect("valid settings");
        assert_eq!(finish(&mut fresh).0, digest, "{request:?}");
    }
}

#[test]
fn a_surface_that_was_not_refined_is_warned_of() {
    let refined = settings!(method: Method::Refined, radius_share: 0.01; ..Settings::default());
    let warnings = |surface: &str| {
        let mut session = Session::new();
        session
            .set_field(&request(&format!(r#"{{"surface":"{surface}"}}"#)))
            .expect("a surface of the gallery");
        session.start(&refined).expect("valid settings");
        while session.run.step(65_536).stop_reason.is_none() {}
        session.report().warnings
    };
    let of_heart = warnings("heart");
    assert!(of_heart.iter().any(|warning| warning.to_string().contains("Not refined")), "{of_heart:?}");
    assert_eq!(warnings("ellipsoid"), []);
}

mod solids {
    use super::{request, run, sized};
    use marching_particles::Bounds;
    use marching_particles::field::formula::Thickness;
    use marching_particles::internal::session::{
        BeyondPoints, BoxCell, BoxFaces, BoxMode, FieldRequest, Session, SolidSettings,
    };
    use marching_particles::sampler::{Settings, StopReason};

    fn solid(box_faces: BoxFaces, thickness: f64) -> SolidSettings {
        SolidSettings { box_faces, thickness: thickness.into(), ..SolidSettings::default() }
    }

    const OPEN: SolidSettings = SolidSettings {
        box_mode: BoxMode::Fit,
        box_faces: BoxFaces::Open,
        box_cell: BoxCell::Lone,
        thickness: Thickness::Number(0.0),
        beyond_points: BeyondPoints::Cut,
    };

    /// A run of the session on a field, in which the box is found in slices of work, as the page
    /// has it.
    fn run_on(session: &mut Session, field: &str, choice: SolidSettings, settings: &Settings) -> Bounds {
        session.set_field(&request(field)).expect("a field");
        session.choose(choice).expect("a solid");
        let answer = loop {
            if let Some(answer) = session.fit(&|_| *settings, false, 3) {
                break answer;
            }
        };
        assert_eq!(run(session, settings, u32::MAX), StopReason::Complete);
        answer.bounds
    }

    /// Open edges of the mesh.
    fn open_edges(session: &mut Session) -> u32 {
        let mesh = loop {
            if let Some(mesh) = session.run.join(u32::MAX) {
                break mesh;
            }
        };
        mesh.components.iter().map(|component| component.open_edges).sum()
    }

    #[test]
    #[ignore = "slow: for cargo xtask test --all"]
    fn a_periodic_cell_is_one_period_unless_the_box_is_given() {
        let settings = sized(2000);
        let mut session = Session::new();
        let periodic = SolidSettings { box_cell: BoxCell::Periodic, ..solid(BoxFaces::Closed, 0.0) };
        let gyroid = r#"{"surface":"gyroid"}"#;
        let cell = run_on(&mut session, gyroid, periodic.clone(), &settings);
        let period = core::f64::consts::TAU;
        assert!((cell.size() - period).abs().max_element() < 1e-9, "{cell:?}");
        assert!(session.report().pairs.is_some_and(|pairs| pairs > 200));
        assert_eq!(open_edges(&mut session), 0);
        // Without the choice the box is that of the gallery, and its faces are sampled each by
        // itself.
        let closed = run_on(&mut session, gyroid, solid(BoxFaces::Closed, 0.0), &settings);
        assert!(closed.size().min_element() > 1.5 * period && session.report().pairs.is_none());
        // A box that is given stays, and the report says what does not repeat in it.
        let given = r#"{"formula":"cos(x) + cos(y) + cos(z)","bounds":{"min":[-2,-2,-2],"max":[2,2,2]}}"#;
        let own = run_on(&mut session, given, periodic, &settings);
        assert_eq!(own, Bounds::cube(2.0));
        let warnings = session.report().warnings.iter().map(ToString::to_string).collect::<String>();
        assert!(warnings.contains("across x are closed, but not the same"), "{warnings}");
    }

    #[test]
    #[ignore = "slow: for cargo xtask test --all"]
    fn a_gyroid_becomes_a_part_and_a_surface_again() {
        let settings = sized(3000);
        let mut session = Session::new();
        let gyroid = r#"{"surface":"gyroid"}"#;
        let own = run_on(&mut session, gyroid, OPEN, &settings);
        let open = session.run.particles().digest();
        assert!(open_edges(&mut session) > 0);
        for thickness in [0.0, 0.5] {
            let closed = solid(BoxFaces::Closed, thickness);
            let bounds = run_on(&mut session, gyroid, closed.clone(), &settings);
            assert_eq!(bounds, own, "the panel has the closing box");
            assert!(session.run.bounds().holds_inside(&own));
            assert_eq!(open_edges(&mut session), 0, "thickness {thickness}");
            let report = session.report();
            let volume = own.size().element_product();
            let half = 0.5 * volume;
            // One half of a box of whole periods is inside the gyroid; the sheet takes about its
            // thickness times its area.
            let wanted = if thickness > 0.0 { 0.2 * volume..0.3 * volume } else { 0.95 * half..1.05 * half };
            assert!(
                report.joined_volume.is_some_and(|found| wanted.contains(&found)),
                "{:?} of {volume}",
                report.joined_volume
            );
            assert_eq!(report.count, session.run.count());
            assert_eq!(session.run.rows(), session.run.particles().len());
            assert!(session.run.count() < session.run.rows());
            assert!(report.cut.is_none() && report.proof.creases > Some(0), "{report:?}");
            // The same request again, as when a setting changes, and the same parameters declared
            // anew.
            let digest = session.run.particles().digest();
            run_on(&mut session, gyroid, closed, &settings);
            assert_eq!(session.run.particles().digest(), digest);
            let field = session.answer();
            let again = FieldRequest {
                surface: Some("gyroid".to_owned()),
                declare: field.parameters.clone(),
                ..FieldRequest::default()
            };
            session.set_field(&again).expect("a field");
            run(&mut session, &settings, u32::MAX);
            assert_eq!(session.run.particles().digest(), digest);
        }
        assert_eq!(run_on(&mut session, gyroid, OPEN, &settings), own);
        assert_eq!(session.run.particles().digest(), open);
    }

    #[test]
    fn the_box_in_the_panel_closes_a_formula() {
        let settings = sized(2000);
        let mut session = Session::new();
        let closed = solid(BoxFaces::Closed, 0.0);
        let cylinder = r#"{"surface":"sphere","formula":"x^2 + y^2 - a","parameters":{"a":1}}"#;
        let fitted = run_on(&mut session, cylinder, closed.clone(), &settings);
        let sampled = session.run.bounds();
        assert!(sampled.min[2] < fitted.min[2] && sampled.max[2] > fitted.max[2], "{sampled:?} {fitted:?}");
        assert_eq!(open_edges(&mut session), 0);
        let given = r#"{"formula":"x^2 + y^2 - a","bounds":{"min":[-2,-2,-1],"max":[2,2,3]}}"#;
        let bounds = run_on(&mut session, given, closed, &settings);
        assert_eq!((bounds.min, bounds.max), ([-2.0, -2.0, -1.0], [2.0, 2.0, 3.0]));
        let heights = |session: &Session| {
            let z = session.run.particles().local.iter().map(|p| p.z);
            (z.clone().fold(f32::MAX, f32::min), z.fold(f32::MIN, f32::max))
        };
        assert_eq!(heights(&session), (-1.0, 3.0));
        // While a slider moves, the box stays.
        session.set_field(&request(r#"{"parameters":{"a":2}}"#)).expect("a field");
        assert_eq!(session.fit(&|_| settings, true, u32::MAX).expect("a box").bounds, bounds);
        run(&mut session, &settings, u32::MAX);
        assert_eq!(heights(&session), (-1.0, 3.0));
        let widest = session.run.particles().local.iter().map(|p| p.truncate().length()).fold(0.0, f32::max);
        assert!((widest - 2_f32.sqrt()).abs() < 1e-4, "{widest}");
    }

    #[test]
    fn the_sheet_around_a_closed_surface_is_inside_its_box() {
        let settings = sized(3000);
        let mut session = Session::new();
        for surface in ["sphere", "torus", "ellipsoid"] {
            let own = session.set_field(&request(&format!(r#"{{"surface":"{surface}"}}"#))).expect("a field");
            let sheet = solid(BoxFaces::Open, 0.2);
            let bounds = run_on(&mut session, &format!(r#"{{"surface":"{surface}"}}"#), sheet, &settings);
            assert!(bounds.holds_inside(&own.bounds), "{surface}");
            assert_eq!(open_edges(&mut session), 0, "{surface}");
            let report = session.report();
            assert_eq!((report.proof.components, report.border), (2, 0), "{surface}");
            session.choose(OPEN).expect("no solid");
        }
    }

    #[test]
    fn a_thickness_is_a_length() {
        let mut session = Session::new();
        for thickness in [-0.1, f64::NAN, f64::INFINITY, 1e13] {
            let error = session.choose(solid(BoxFaces::Closed, thickness)).expect_err("it is refused");
            assert!(error.to_string().starts_with("thickness is"), "{error}");
        }
        // Of what is constant and of points nothing is made.
        session.choose(solid(BoxFaces::Closed, 0.1)).expect("a solid");
        session.set_field(&request(r#"{"formula":"0 x - 1"}"#)).expect("a field");
        assert_eq!(run(&mut session, &sized(500), u32::MAX), StopReason::Constant);
    }
}

#[test]
fn particles_placed_elsewhere_are_measured_as_those_of_a_run_are() {
    for settings in [Settings::with_count(1_500), Settings::with_count(1_500).adaptive()] {
        let mut session = Session::new();
        session.start(&settings).unwrap();
        while session.run.step(10_000).stop_reason.is_none() {}
        let report = session.report();
        let mut meter = Session::new();
        let placed = meter.run.measure_placed(session.run.particles(), settings.sampling);
        // Undefined figures are NaN, which equals nothing.
        assert_eq!(format!("{:?}", placed.quality), format!("{:?}", report.measures.quality), "{settings:?}");
        assert_eq!(placed.places, report.measures.places);
        assert!(placed.quality.is_some_and(|figures| figures.coverage.uncovered < 0.2));
    }
}

/// The field of a function that fails where `fails` holds.
fn ball(fails: fn(DVec3) -> bool) -> impl marching_particles::Field + 'static {
    BatchField::new(move |points: &[DVec3], f: &mut [f64]| {
        f.iter_mut().zip(points).for_each(|(f, p)| *f = p.length() - 1.0);
        if points.iter().any(|&p| fails(p)) { Err("out of reach") } else { Ok(()) }
    })
}

#[test]
fn a_function_gives_the_particles_that_sampling_it_gives() {
    let settings = Settings::with_count(500);
    let direct = sample(ball(|_| false), &settings).expect("a ball");
    let mut session = Session::new();
    for bounds in [None, Some(Bounds::cube(f64::NAN))] {
        let taken = session.set_function(Arc::new(ball(|_| false)), bounds);
        assert_eq!(
            taken.map(|_| ()).map_err(|fault| fault.kind),
            bounds.map_or(Ok(()), |_| Err(FaultKind::Box))
        );
    }
    run(&mut session, &settings, 50);
    assert_eq!(session.run.particles().digest(), direct.particles().digest());
    assert!(session.record(None).is_none(), "no record can hold a function");
    session.set_field(&request(r#"{"formula":"x^2+y^2+z^2=1"}"#)).expect("a formula in its place");
    run(&mut session, &settings, 50);
    assert!(session.record(None).is_some());
}

#[test]
fn a_function_that_fails_ends_its_run() {
    let mut session = Session::new();
    session.set_function(Arc::new(ball(|p| p.length() > 1.5)), Some(Bounds::cube(1.2))).expect("a box");
    assert_eq!(run(&mut session, &Settings::with_count(500), 50), StopReason::Undefined);
    assert!(session.run.check_field().is_err());
}
