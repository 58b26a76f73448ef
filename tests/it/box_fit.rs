//! Tests of the box that a session fits around the surface of a formula.

use crate::runs::run;
use marching_particles::Bounds;
use marching_particles::Report;
use marching_particles::field::gallery;
use marching_particles::internal::extent::Reach;
use marching_particles::internal::session::{BoxMode, FieldAnswer, FieldRequest, Session, SolidSettings};
use marching_particles::quality::Figures;
use marching_particles::run::Cut;
use marching_particles::sampler::Settings;

fn set(session: &mut Session, formula: &str) -> FieldAnswer {
    // As the page does: a formula is typed over that of a gallery surface.
    let request = FieldRequest {
        surface: Some("ellipsoid".to_owned()),
        formula: Some(formula.to_owned()),
        ..FieldRequest::default()
    };
    session.set_field(&request).unwrap_or_else(|error| panic!("{formula}: {error}"))
}

fn fit(session: &mut Session, settings: &Settings, only_grows: bool) -> FieldAnswer {
    loop {
        if let Some(answer) = session.fit(&|_| *settings, only_grows, 64) {
            return answer;
        }
    }
}

fn coarse() -> Settings {
    settings!(radius_share: 0.012, relax_steps: 3; ..Settings::default())
}

fn euler(report: &Report) -> i64 {
    report.measures.quality.as_ref().map_or(i64::MIN, |figures: &Figures| figures.connectivity.euler)
}

#[test]
fn a_sphere_typed_after_the_ellipsoid_is_whole() {
    let mut session = Session::new();
    set(&mut session, "x^2+y^2+z^2=1");
    let report = run(&mut session, &coarse());
    assert_eq!((euler(&report), report.border, report.cut), (2, 0, None));
    let answer = session.answer();
    assert_eq!(answer.reach, Some(Reach::Bounded));
    assert!(answer.bounds.max.iter().all(|end| (1.05..1.2).contains(end)), "{:?}", answer.bounds);
}

#[test]
fn surfaces_of_every_size_and_place_are_whole() {
    for (formula, components, euler_number) in [
        ("x^4-5x^2+y^4-5y^2+z^4-5z^2+11.8", 1, Some(-8)),
        ("x^2 + y^2 + z^2 = 250000", 1, Some(2)),
        ("(x - 700)^2 + (y + 20)^2 + z^2 = 4", 1, Some(2)),
        ("min((x-3)^2 + y^2 + z^2, (x+3)^2 + y^2 + z^2) = 0.25", 2, Some(4)),
        // Along its sharp edges the triangles do not close up.
        ("|x| + |y| + |z| = 7", 1, None),
    ] {
        let mut session = Session::new();
        set(&mut session, formula);
        let report = run(&mut session, &coarse());
        assert_eq!(report.cut, None, "{formula}");
        assert_eq!(report.proof.components, components, "{formula}");
        assert!(euler_number.is_none_or(|number| euler(&report) == number), "{formula}: {}", euler(&report));
    }
}

#[test]
fn the_box_has_room_for_large_particles() {
    let mut session = Session::new();
    set(&mut session, "x^2+y^2+z^2=1");
    for radius_share in [0.006, 0.02, 0.04] {
        let settings = settings!(radius_share; ..coarse());
        let bounds = fit(&mut session, &settings, false).bounds;
        let room = bounds.max[0] - 1.0;
        assert!(room >= 0.1 && room >= 3.0 * radius_share * bounds.diagonal() * 0.99, "{bounds:?}");
        assert_eq!(run(&mut session, &settings).growth.fates.outside, 0, "{radius_share}");
    }
}

#[test]
fn what_goes_on_for_ever_is_cut_and_said_to_be() {
    for formula in ["z = 0", "sin(x)cos(y)+sin(y)cos(z)+sin(z)cos(x)", "x^2 + y^2 = z^2", "z = 1/x"] {
        let mut session = Session::new();
        set(&mut session, formula);
        let report = run(&mut session, &coarse());
        assert_eq!(report.cut, Some(Cut::Endless), "{formula}");
        assert!(report.border > 20, "{formula}: {}", report.border);
        assert_eq!(session.answer().reach, Some(Reach::Endless), "{formula}");
    }
}

#[test]
fn the_periods_of_the_surface_are_told_with_the_values_of_its_parameters() {
    use core::f64::consts::TAU;
    let mut session = Session::new();
    let mut told = |formula: &str| {
        set(&mut session, formula);
        session.answer().periods
    };
    assert_eq!(told("sin(x)cos(y)+sin(y)cos(z)+sin(z)cos(x)"), [Some(TAU); 3]);
    assert_eq!(told("x^2+y^2+sin(2z)=1"), [None, None, Some(TAU / 2.0)]);
    assert_eq!(told("sin(x)=y"), [Some(TAU), None, Some(0.0)]);
    set(&mut session, "cos(x/k)+cos(y)+cos(z)");
    let request = FieldRequest { parameters: [("k".to_owned(), 0.5)].into(), ..FieldRequest::default() };
    let answer = session.set_field(&request).expect("a value of the parameter");
    assert_eq!(answer.periods, [Some(TAU / 2.0), Some(TAU), Some(TAU)]);
}

#[test]
fn a_box_that_is_given_stays_and_a_surface_that_it_cuts_is_told() {
    let mut session = Session::new();
    let given = Bounds::cube(0.8);
    let request = FieldRequest {
        surface: Some("ellipsoid".to_owned()),
        formula: Some("x^2+y^2+z^2=1".to_owned()),
        bounds: Some(given),
        ..FieldRequest::default()
    };
    session.set_field(&request).expect("a good field");
    let report = run(&mut session, &coarse());
    assert_eq!((session.run.bounds(), report.cut), (given, Some(Cut::Fixed)));
    assert!(report.border > 20);
    let larger = FieldRequest { bounds: Some(Bounds::cube(1.5)), ..request };
    session.set_field(&larger).expect("a good field");
    let report = run(&mut session, &coarse());
    assert_eq!((report.border, report.cut), (0, None));
}

#[test]
fn a_fixed_box_is_that_of_the_surface_with_which_the_formula_began() {
    let mut session = Session::new();
    set(&mut session, "x^2+y^2+z^2=1");
    session.choose(SolidSettings { box_mode: BoxMode::Fixed, ..SolidSettings::default() }).expect("a box");
    let report = run(&mut session, &coarse());
    assert_eq!(session.run.bounds(), gallery::find("ellipsoid").expect("it is the first").bounds);
    assert_eq!(report.cut, Some(Cut::Fixed));
    session.choose(SolidSettings { box_mode: BoxMode::Fit, ..SolidSettings::default() }).expect("a box");
    let report = run(&mut session, &coarse());
    assert_eq!(report.cut, None);
}

#[test]
fn gallery_surfaces_keep_their_boxes() {
    for surface in gallery::SURFACES.iter() {
        let mut session = Session::new();
        let request = FieldRequest { surface: Some(surface.id.to_owned()), ..FieldRequest::default() };
        session.set_field(&request).expect("a surface of the gallery");
        let answer = fit(&mut session, &Settings::default(), false);
        assert_eq!((answer.bounds, answer.reach), (surface.bounds, None), "{}", surface.id);
    }
}

#[test]
fn while_a_slider_moves_the_box_only_grows_and_then_it_settles() {
    let mut session = Session::new();
    let formula = "x^2 + y^2 + z^2 = a^2";
    set(&mut session, formula);
    let size = |session: &mut Session, a: f64, only_grows: bool| {
        let request = FieldRequest {
            surface: Some("ellipsoid".to_owned()),
            formula: Some(formula.to_owned()),
            parameters: [("a".to_owned(), a)].into(),
            ..FieldRequest::default()
        };
        session.set_field(&request).expect("a good field");
        fit(session, &coarse(), only_grows).bounds.max[0]
    };
    let one = size(&mut session, 1.0, false);
    let two = size(&mut session, 2.0, true);
    assert!(one < 1.2 && two > 2.1, "{one} {two}");
    assert_eq!(size(&mut session, 1.5, true), two);
    assert_eq!(size(&mut session, 0.5, true), two);
    assert!(size(&mut session, 0.5, false) < 0.6);
    // Of another formula nothing is kept.
    set(&mut session, "x^2 + y^2 + z^2 = 0.01");
    assert!(fit(&mut session, &coarse(), true).bounds.max[0] < 0.2);
}

#[test]
fn the_same_box_is_not_searched_or_surveyed_again() {
    let mut session = Session::new();
    set(&mut session, "x^2+y^2+z^2=1");
    let first = run(&mut session, &coarse());
    // The next run with another number of steps begins at once: one slice is enough to know the
    // box.
    set(&mut session, "x^2+y^2+z^2=1");
    assert!(session.fit(&|_| coarse(), false, 1).is_some());
    assert_eq!(run(&mut session, &coarse()).digest, first.digest);
}

#[test]
fn where_there_is_no_surface_the_box_says_so() {
    let mut session = Session::new();
    set(&mut session, "x^2+y^2+z^2=-1");
    let report = run(&mut session, &coarse());
    assert_eq!((report.count, report.cut), (0, None));
    assert_eq!(session.answer().reach, Some(Reach::Nowhere));
}

#[test]
fn a_heavy_formula_is_searched_in_short_slices() {
    let terms: Vec<String> = (1..90).map(|k| format!("sin({k}x + {k}y)cos(z/{k})/{k}^3")).collect();
    let mut session = Session::new();
    set(&mut session, &format!("x^2 + y^2 + z^2 + {} = 1", terms.join(" + ")));
    let mut slices = 0;
    let answer = loop {
        if let Some(answer) = session.fit(&|_| coarse(), false, 1) {
            break answer;
        }
        slices += 1;
    };
    assert!(slices > 10 && slices < 2_000, "{slices}");
    assert_eq!(answer.reach, Some(Reach::Bounded));
}

#[test]
fn creases_are_found_slice_by_slice_before_the_start() {
    const CUBE: &str = "max(abs(x), abs(y), abs(z)) - 1";
    let mut session = Session::new();
    set(&mut session, CUBE);
    let at_once = run(&mut session, &coarse()).digest;

    let mut session = Session::new();
    // The search in a box that is given up leaves nothing behind.
    let given = FieldRequest { bounds: Some(Bounds::cube(1.2)), ..FieldRequest::default() };
    set(&mut session, CUBE);
    session.set_field(&given).expect("a good box");
    assert!((0..500).all(|_| session.fit(&|_| coarse(), false, 1).is_none()));
    set(&mut session, CUBE);
    let mut slices = 0;
    while session.fit(&|_| coarse(), false, 1).is_none() {
        slices += 1;
    }
    assert!(slices > 3_000, "{slices}");
    assert_eq!(run(&mut session, &coarse()).digest, at_once);
    assert!(session.fit(&|_| coarse(), false, 1).is_some());
}
