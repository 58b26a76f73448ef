//! Fields put together of others.

use glam::{DVec3, Vec3, dvec2, dvec3};
use marching_particles::field::model::ModelInfo;
use marching_particles::field::rbf::RbfData;
use marching_particles::field::{Combined, Field, FnField, Frame};
use marching_particles::internal::session::{FieldRequest, Session};
use marching_particles::{
    Bounds, Formula, Sample, Settings, difference, intersection, offset, sample, smooth_union, union,
};

fn formula(text: &str) -> Formula {
    Formula::parse(text).unwrap_or_else(|error| panic!("{text}: {error:?}"))
}

fn ball(centre: DVec3, radius: f64) -> impl Fn(DVec3) -> f64 + Send + Sync + 'static {
    move |p: DVec3| p.distance(centre) - radius
}

fn block() -> Formula {
    formula("max(abs(x) - 1, abs(y) - 1, abs(z) - 0.5)")
}

/// The centres of two balls of radius 1 that overlap.
const CENTRES: [DVec3; 2] = [dvec3(-0.5, 0.0, 0.0), dvec3(0.5, 0.0, 0.0)];

/// Checks that the mesh of a field in a cube is closed, with this Euler number, number of creases
/// and volume, to half a per cent.
fn check(
    field: Combined,
    half: f64,
    (euler, creases, volume): (i64, Option<usize>, f64),
    what: &str,
) -> Sample {
    let settings = Settings::with_count(4_000).in_box(Bounds::cube(half));
    let sample = sample(field, &settings).unwrap_or_else(|error| panic!("{what}: {error}"));
    let topology = &sample.mesh().topology;
    assert!(topology.is_closed(), "{what}: {:?}", sample.report().warnings);
    assert_eq!((topology.euler(), sample.report().proof.creases), (euler, creases), "{what}");
    let found = sample.volume().unwrap_or_default();
    assert!((found / volume - 1.0).abs() < 5e-3, "{what}: {found} of {volume}");
    sample
}

#[test]
fn functions_meet_in_an_edge() {
    let [left, right] = CENTRES.map(|centre| move || ball(centre, 1.0));
    // The cap of a ball beyond the plane in the middle.
    let cap = core::f64::consts::PI * 0.25 * (3.0 - 0.5) / 3.0;
    let whole = core::f64::consts::PI * 4.0 / 3.0;
    check(union([left(), right()]), 2.0, (2, Some(1), 2.0 * (whole - cap)), "union");
    check(intersection([left(), right()]), 2.0, (2, Some(1), 2.0 * cap), "intersection");
    check(difference(left(), right()), 2.0, (2, Some(1), whole - 2.0 * cap), "difference");
}

#[test]
fn lists_are_combined_pair_by_pair() {
    let three = || [-0.5, 0.0, 0.5].map(|x| ball(dvec3(x, 0.0, 0.0), 0.5));
    let [a, b, c] = three();
    let lists = [
        union(three()),
        union(Vec::from(three())),
        union((a, b, formula("hypot(x - 0.5, y, z) - 0.5"))),
        union([union(three()), union([c])]),
    ];
    for k in 0..100 {
        let p = DVec3::from_array([0.37, 0.61, 0.83].map(|step| (f64::from(k) * step).fract() * 2.0 - 1.0));
        let values = three().map(|f| f(p));
        let least = values.into_iter().fold(f64::INFINITY, f64::min);
        for list in &lists {
            assert!((list.value(p) - least).abs() < 1e-12, "{p}");
        }
        let most = values.into_iter().fold(f64::NEG_INFINITY, f64::max);
        assert_eq!(intersection(three()).value(p), most, "{p}");
    }
}

#[test]
#[should_panic(expected = "at least one solid")]
fn a_union_of_nothing_is_a_mistake_of_the_program() {
    union(Vec::<Combined>::new());
}

#[test]
fn their_edge_is_where_that_of_the_formula_is() {
    let field = union([ball(CENTRES[0], 1.0), ball(CENTRES[1], 1.0)]);
    let made = check(field, 2.0, (2, Some(1), 7.0686), "union");
    for &first in &made.particles().twins {
        let p = made.particles().place(first as usize);
        let off = dvec3(p.x, dvec2(p.y, p.z).length() - 0.75_f64.sqrt(), 0.0).length();
        assert!(off < 1e-6, "{p} lies {off} beside the circle");
    }
}

#[test]
fn a_formula_keeps_its_own_edges() {
    // The four edges at each of the faces, the four between them, and the two of the hole.
    let hole = |p: DVec3| p.truncate().length() - 0.4;
    let volume = 4.0 - core::f64::consts::PI * 0.16;
    let drilled = check(difference(block(), hole), 1.5, (0, Some(14), volume), "drilled");
    assert_eq!(drilled.report().proof.corners, Some(8));
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn fields_that_meet_without_an_edge_are_closed_as_their_formula_is() {
    let capped = || formula("max(hypot(x, y) - 0.5, abs(z) - 1)");
    // A sheet that rises from the plane without an edge where y < 0, and at an angle elsewhere.
    let sheet = intersection((formula("z - x*(x + max(y, 0))"), |p: DVec3| -p.x));
    for (joined, text, half) in [
        // A rod with one round end.
        (
            union((capped(), ball(DVec3::Z, 0.5))),
            "min(max(hypot(x, y) - 0.5, abs(z) - 1), hypot(x, y, z - 1) - 0.5)",
            1.8,
        ),
        // One with two, of functions.
        (
            union((
                intersection((|p: DVec3| p.truncate().length() - 0.5, |p: DVec3| p.z.abs() - 0.7)),
                ball(0.7 * DVec3::Z, 0.5),
                ball(-0.7 * DVec3::Z, 0.5),
            )),
            "hypot(x, y, max(abs(z) - 0.7, 0)) - 0.5",
            1.5,
        ),
        // A fillet that fades out in one of the operands.
        (
            intersection((formula("smin(z, x, max(0, -y))"), ball(DVec3::ZERO, 1.0))),
            "max(smin(z, x, max(0, -y)), hypot(x, y, z) - 1)",
            1.3,
        ),
        (
            intersection((union((|p: DVec3| p.z, sheet)), ball(DVec3::ZERO, 1.0))),
            "max(z - max(x, 0)*(x + max(y, 0)), hypot(x, y, z) - 1)",
            1.3,
        ),
    ] {
        let settings = Settings::with_count(5_000).in_box(Bounds::cube(half));
        let run = |sample: Sample| {
            let topology = &sample.mesh().topology;
            assert!(topology.is_closed(), "{text}: {:?}", sample.report().warnings);
            assert_eq!((topology.components.len(), topology.euler()), (1, 2), "{text}");
            sample.volume().expect("a closed mesh")
        };
        let known = run(sample(formula(text), &settings).expect("a sample"));
        let found = run(sample(joined, &settings).expect("a sample"));
        assert!((found / known - 1.0).abs() < 2e-3, "{text}: volume {found} for {known}");
    }
}

#[test]
fn operations_follow_each_other() {
    let [left, right] = CENTRES.map(|centre| ball(centre, 1.0));
    let both = union([left, right]);
    // The drill goes through both balls and cuts off nothing.
    let drilled = difference(both, |p: DVec3| dvec2(p.y, p.z).length() - 0.3);
    let settings = Settings::with_count(4_000).in_box(Bounds::cube(2.0));
    let sample = sample(drilled, &settings).expect("a surface");
    assert_eq!((sample.mesh().topology.is_closed(), sample.mesh().topology.euler()), (true, 0));
    assert_eq!(sample.report().proof.creases, Some(3));
}

#[test]
fn an_offset_moves_every_face() {
    check(offset(block(), 0.2), 1.5, (2, Some(12), 2.4 * 2.4 * 1.4), "block");
    check(
        offset(difference(block(), ball(dvec3(0.0, 0.0, 0.5), 0.4)), -0.1),
        1.5,
        (2, Some(13), 2.4077),
        "both",
    );
}

#[test]
fn a_smooth_union_is_that_of_formulas() {
    let written = formula("smin(hypot(x + 0.5, y, z) - 0.6, hypot(x - 0.5, y, z) - 0.6, 0.5)");
    let made = smooth_union(ball(CENTRES[0], 0.6), ball(CENTRES[1], 0.6), 0.5);
    for k in 0..100 {
        let p = DVec3::from_array([0.37, 0.61, 0.83].map(|step| (f64::from(k) * step).fract() * 2.0 - 1.0));
        let (own, known) = (made.jet(p), written.jet(p));
        assert!((own.value - known.value).abs() < 1e-12, "{p}");
        assert!(own.gradient.distance(known.gradient) < 1e-3, "{p}");
        let off = own.hessian.entries().into_iter().zip(known.hessian.entries()).map(|(a, b)| (a - b).abs());
        let size = known.hessian.entries().into_iter().fold(1.0, |size: f64, entry| size.max(entry.abs()));
        assert!(off.fold(0.0, f64::max) < 0.01 * size, "{p}");
    }
    check(made, 1.5, (2, None, 1.8303), "blend");
    // Of no width it is the union.
    check(smooth_union(ball(CENTRES[0], 1.0), ball(CENTRES[1], 1.0), 0.0), 2.0, (2, Some(1), 7.0686), "0");
}

#[test]
fn batches_agree_with_single_points_in_any_frame() {
    let field =
        union([offset(ball(CENTRES[0], 1.0), 0.1), smooth_union(block(), ball(CENTRES[1], 1.0), 0.3)]);
    let points: Vec<Vec3> = (0..300)
        .map(|k| Vec3::from_array([0.37, 0.61, 0.83].map(|step| (k as f32 * step).fract() * 2.0 - 1.0)))
        .collect();
    for frame in [
        Frame::default(),
        Frame { scale: 4.0, ..Frame::default() },
        Frame { double: Some(0.5), ..Frame::around(dvec3(0.25, 0.0, 0.0)) },
    ] {
        let mut evaluator = field.evaluator(frame);
        let (mut value, mut gradient) = (vec![0.0; points.len()], vec![Vec3::ZERO; points.len()]);
        evaluator.gradients(&points, &mut value, &mut gradient);
        for (k, &p) in points.iter().enumerate() {
            let exact = field.value_and_gradient(frame.place(p.as_dvec3()));
            let (known, slope) = frame.gradient(exact);
            assert!((value[k] - known).abs() < 1e-4, "{frame:?} at {p}: {} {known}", value[k]);
            assert!(gradient[k].distance(slope) < 1e-2 * frame.scale, "{frame:?} at {p}");
        }
    }
}

#[test]
fn calls_are_counted_and_limited() {
    let counted = |centre| FnField::new(ball(centre, 1.0)).limit_calls(1_000);
    let field = union([counted(CENTRES[0]), counted(CENTRES[1])]);
    let settings = Settings::with_count(4_000).in_box(Bounds::cube(2.0));
    assert!(sample(field.clone(), &settings).is_err());
    assert!(field.calls().is_some_and(|calls| calls >= 1_000));
    assert!(field.failure().is_some());
}

mod with_a_model {
    use super::*;
    use marching_particles::field::formula::{FormulaErrorKind, MODEL, Parameter};
    use marching_particles::field::model;
    use marching_particles::field::rbf::RbfField;
    use marching_particles::pointcloud::fit_model;
    use std::sync::Arc;

    fn bunny() -> (Arc<dyn Field>, Bounds) {
        let fit = fit_model(model::find("bunny").expect("a built-in model"));
        (Arc::new(RbfField::new(fit.data).expect("the data is whole")), fit.bounds)
    }

    fn within(text: &str, model: &Arc<dyn Field>) -> Result<Combined, FormulaErrorKind> {
        let declared = [Parameter::automatic(MODEL)];
        Formula::as_written(text, &declared)
            .and_then(|formula| formula.with_model(model))
            .map_err(|error| error.kind)
    }

    #[test]
    #[ignore = "slow: for cargo xtask test --all"]
    fn a_formula_cuts_hollows_and_fills_it() {
        let (bunny, bounds) = bunny();
        let waves = "k = 8; abs(sin(k x)cos(k y) + sin(k y)cos(k z) + sin(k z)cos(k x)) - 0.3";
        let (defined, waves) = waves.split_once(';').expect("a definition");
        for (text, euler, parts) in [
            ("shell = abs(model) - 0.05; max(shell, z)".to_owned(), 2, 1),
            ("-min(-model, 0.1 - z)".to_owned(), 2, 1),
            (format!("{defined}; max(model, {waves})"), -54, 1),
        ] {
            let field = within(&text, &bunny).unwrap_or_else(|error| panic!("{text}: {error:?}"));
            let settings = Settings::with_count(8_000).in_box(bounds).refined();
            let sample = sample(field, &settings).expect(&text);
            let topology = &sample.mesh().topology;
            assert!(topology.is_closed(), "{text}: {:?}", sample.report().warnings);
            assert_eq!((topology.euler(), topology.components.len()), (euler, parts), "{text}");
        }
    }

    #[test]
    fn other_uses_are_refused() {
        let (bunny, _) = bunny();
        for text in
            ["2model", "model^2", "max(model x, z)", "sin(model)", "z", "max(model, smin(model, z, x))"]
        {
            assert_eq!(within(text, &bunny).err(), Some(FormulaErrorKind::ModelUse), "{text}");
        }
    }
}

#[test]
fn a_formula_with_a_model_is_described_and_its_creases_are_found_in_slices() {
    let data = RbfData {
        centres: vec![[0.0; 3], [0.0, 0.0, 1000.0]],
        alpha: vec![1.0, -1e-9],
        beta: vec![[0.0; 3]; 2],
        border: None,
    };
    let info = ModelInfo { name: "ball".into(), points: 2, centres: 2, ..ModelInfo::default() };
    let with = |text: &str| FieldRequest {
        formula: Some(text.into()),
        parameters: [("h".to_owned(), 0.25)].into(),
        ..FieldRequest::default()
    };
    let mut session = Session::new();
    let set = |session: &mut Session, text: &str| {
        session.set_points(data.clone(), info.clone(), Bounds::cube(1.5), &with(text))
    };
    let answer = set(&mut session, "max(model, z - h)").expect("a field");
    assert_eq!((answer.model.as_ref(), answer.formula.as_str()), (Some(&info), "max(model, z - h)"));
    assert_eq!((answer.parameters.len(), answer.parameters[0].value), (1, 0.25));
    assert_eq!(answer.auto, ["h"]);
    assert!(answer.mathml.is_some());

    let settings = settings!(radius_share: 0.02; ..Settings::default());
    let mut slices = 0;
    while session.fit(&|_| settings, false, 1).is_none() {
        slices += 1;
    }
    assert!(slices > 1000, "{slices}");
    session.start(&settings).expect("valid settings");
    while session.run.step(1000).stop_reason.is_none() {}
    assert_eq!(session.report().proof.creases, Some(1));

    let fault = set(&mut session, "2model").expect_err("no operand");
    assert!(fault.message.contains("`max(model, z)`"), "{}", fault.message);
    assert_eq!(session.answer(), answer);
}
