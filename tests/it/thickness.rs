//! Shells whose thickness is a formula, and shells by the share of a box that they leave empty.

use crate::solids::{field, grid, is_consistent};
use core::cmp::Ordering;
use glam::DVec3;
use marching_particles::field::Piecewise;
use marching_particles::field::formula::{FormulaErrorKind, PorosityError, Thickness};
use marching_particles::internal::session::{FaultKind, FieldRequest, Session, SolidSettings};
use marching_particles::internal::slices::complete;
use marching_particles::{Bounds, Field, Formula, Sample, Settings, gallery, sample};

fn gyroid() -> Formula {
    gallery::find("gyroid").expect("the gallery has a gyroid").field()
}

/// A closed mesh of about so many particles.
#[track_caller]
fn closed(solid: Formula, count: u32) -> Sample {
    let sample = sample(solid, &Settings::with_count(count).refined()).expect("a solid");
    assert!(sample.mesh().topology.is_closed(), "{:?}", sample.report().warnings);
    sample
}

#[track_caller]
fn thickened(text: &str, thickness: &str) -> Formula {
    field(text).thickened_by(thickness).unwrap_or_else(|error| panic!("{thickness}: {error:?}"))
}

#[test]
fn a_text_without_names_is_a_number() {
    let bounds = Bounds::cube(2.0);
    let [number, text] = [gyroid().thickened(0.3), gyroid().thickened_by("0.3").expect("a number")]
        .map(|f| f.closed_by(&bounds));
    assert_eq!(text.thickness(), Some(&Thickness::Number(0.3)));
    for p in grid(&Bounds::cube(2.2)) {
        let [a, b] = [&number, &text].map(|field| field.value_and_gradient(p));
        assert_eq!(a, b, "{p}");
    }
}

#[test]
fn the_thickness_is_that_of_the_place() {
    let text = "k = 0.05; 0.1 + k z + a/100 // towards the top";
    let mut shell = thickened("x^2 + y^2 + z^2 = a", text);
    for a in [1.0, 2.0] {
        shell.set_parameter("a", a).expect("a parameter");
        for p in grid(&Bounds::cube(1.6)) {
            let thickness = 0.1 + 0.05 * p.z + 0.01 * a;
            let wanted = (p.length_squared() - a).abs() - thickness * p.length();
            assert!((shell.value_and_gradient(p).0 - wanted).abs() < 1e-14, "{p}");
        }
    }
    assert_eq!(shell.thickness(), Some(&Thickness::Formula(text.to_owned())));
    is_consistent(&shell, &Bounds::cube(1.6), "a shell");
    // A thickness with an edge of its own.
    let step = thickened("z = 0.1 x", "max(0.1, 0.4 - abs(x))");
    is_consistent(&step, &Bounds::cube(1.0), "a plate with a rib");
    assert!(!complete(step.pieces_in(&Bounds::cube(1.0), 0.05, 64)).0.is_empty());
}

#[test]
fn a_shell_ends_where_its_thickness_is_not_positive() {
    let wedge = thickened("z = 0", "0.2 x").closed_by(&Bounds::cube(1.0));
    let volume = closed(wedge, 1_000).volume().expect("a closed mesh");
    assert!((volume - 0.2).abs() < 1e-3, "{volume}");
    for nothing in ["-0.2 - x^2", "ln(-1 - x^2)"] {
        let none = thickened("z = 0", nothing);
        assert!(
            grid(&Bounds::cube(1.0)).all(|p| none
                .value_and_gradient(p)
                .0
                .partial_cmp(&0.0)
                .is_none_or(Ordering::is_gt)),
            "{nothing}"
        );
    }
}

/// Share of a box in which |f| ≤ t/2 |∇f| for the gyroid, by the middles of 120³ cells.
fn gyroid_share(bounds: &Bounds, thickness: impl Fn(DVec3) -> f64) -> f64 {
    const SIDE: u32 = 120;
    let axes = (0..3).map(|axis| {
        let middle =
            |k: u32| bounds.lo()[axis] + bounds.size()[axis] * (f64::from(k) + 0.5) / f64::from(SIDE);
        (0..SIDE).map(|k| (middle(k), libm::sin(middle(k)), libm::cos(middle(k)))).collect::<Vec<_>>()
    });
    let axes: Vec<Vec<(f64, f64, f64)>> = axes.collect();
    let mut inside = 0_u32;
    for &(x, sx, cx) in &axes[0] {
        for &(y, sy, cy) in &axes[1] {
            for &(z, sz, cz) in &axes[2] {
                let f = sx * cy + sy * cz + sz * cx;
                let slope = DVec3::new(cx * cy - sz * sx, cy * cz - sx * sy, cz * cx - sy * sz).length();
                inside += u32::from(f.abs() <= 0.5 * thickness(DVec3::new(x, y, z)) * slope);
            }
        }
    }
    f64::from(inside) / f64::from(SIDE).powi(3)
}

#[test]
fn a_graded_gyroid_has_the_volume_of_its_integral() {
    let bounds = Bounds::cube(4.0);
    let part = gyroid().thickened_by("0.6 + 0.08 z").expect("a thickness").closed_by(&bounds);
    let volume = closed(part, 20_000).volume().expect("a closed mesh");
    let wanted = bounds.size().element_product() * gyroid_share(&bounds, |p| 0.6 + 0.08 * p.z);
    println!("{volume} of {wanted}");
    assert!((volume / wanted - 1.0).abs() < 0.01, "{volume} of {wanted}");
}

#[test]
fn a_shell_repeats_with_its_thickness() {
    let period = core::f64::consts::TAU;
    for (thickness, along_z) in [
        ("0.3", Some(period)),
        ("0.3 + 0.05 sin(2z)", Some(period)),
        ("0.3 + 0.05 sin(z/2)", Some(2.0 * period)),
        ("0.3 + 0.05 z", None),
    ] {
        let shell = gyroid().thickened_by(thickness).expect("a thickness");
        assert_eq!(shell.surface_periods(), [Some(period), Some(period), along_z], "{thickness}");
        let repeats =
            shell.repeated_in(&Bounds::cube(0.5 * period)).facts().unit_cell.expect("a cell").repeats;
        assert_eq!(repeats, [true, true, along_z == Some(period)], "{thickness}");
    }
}

#[test]
fn mistakes_of_a_thickness_are_told_in_its_text() {
    use FormulaErrorKind as Kind;
    for (text, kind, wrong, words) in [
        ("0.1 + b z", Kind::UnknownName, "b", "has no parameter `b`"),
        ("0.1 + 2 rr", Kind::UnknownName, "rr", "(r)"),
        ("0.1 = z", Kind::UnexpectedSymbol, " = z", "no `=`"),
        ("0.1 {z > 0}", Kind::UnexpectedSymbol, "z > 0", "no condition in braces"),
        ("0.1 + sin z y", Kind::MissingBrackets, "sin z", ""),
        ("0.1 + sni(z)", Kind::UnknownFunction, "sni", ""),
        ("z/0", Kind::NotFinite, "0", ""),
        ("0.1 +", Kind::UnexpectedEnd, "", ""),
        ("", Kind::Empty, "", "A thickness is a number"),
    ] {
        let error = field("hypot(x, y) = r").thickened_by(text).expect_err("a mistake");
        assert_eq!((error.kind, &text[error.span.clone()]), (kind, wrong), "{text}: {error:?}");
        assert!(error.message.contains(words), "{text}: {}", error.message);
        // There is no slider that a name of the thickness could become.
        assert_eq!(error.name, None, "{text}");
    }
    let error = field("hypot(x, y) = radius").thickened_by("0.1 + raduis/9").expect_err("a mistake");
    assert_eq!(error.suggestion.as_deref(), Some("radius"), "{error:?}");
    assert!(error.message.contains("(radius)") && error.name.is_none(), "{error:?}");
}

#[test]
fn a_shell_leaves_the_wanted_share_of_a_box_empty() {
    let bounds = Bounds::cube(4.0);
    for (shell, porosity) in
        [(gyroid(), 0.7), (gyroid().thickened_by("0.6 + 0.08 z").expect("a thickness"), 0.8)]
    {
        let is_formula = shell.thickness().is_some();
        let part = shell.with_porosity(porosity, &bounds).expect("a shell");
        let (first, slope) = match part.thickness().expect("a shell") {
            Thickness::Number(thickness) => (*thickness, 0.0),
            Thickness::Formula(text) => {
                let factor: f64 = text.split('*').next().expect("a factor").parse().expect("a number");
                assert_eq!(*text, format!("{factor}*(0.6 + 0.08*z)"));
                (0.6 * factor, 0.08 * factor)
            }
        };
        assert_eq!(slope != 0.0, is_formula);
        let share = gyroid_share(&bounds, |p| first + slope * p.z);
        assert!((1.0 - share - porosity).abs() < 1e-3, "{share} at {:?}", part.thickness());
        let volume = closed(part, 20_000).volume().expect("a closed mesh");
        let reached = 1.0 - volume / bounds.size().element_product();
        println!("{porosity}: {reached}");
        assert!((reached - porosity).abs() < 0.01, "{reached}");
    }
}

#[test]
fn what_no_shell_leaves_empty_is_told() {
    let bounds = Bounds::cube(1.0);
    for porosity in [0.0, 1.0, -0.3, 70.0, f64::NAN] {
        let error = gyroid().with_porosity(porosity, &bounds).expect_err("no share");
        assert!(matches!(error, PorosityError::OutOfRange { .. }), "{error}");
    }
    // Half of the box has no shell, however it is scaled.
    let half = || thickened("z = 0", "x");
    assert!(half().with_porosity(0.6, &bounds).is_ok());
    let error = half().with_porosity(0.4, &bounds).expect_err("impossible");
    let PorosityError::Unreachable { nearest, .. } = error else { panic!("{error}") };
    assert!((nearest - 0.5).abs() < 1e-3, "{nearest}");
    assert!(error.to_string().contains("leaves 40.0 % of the box empty: the nearest is 50.0 %"), "{error}");
}

fn request(surface: &str, formula: Option<&str>) -> FieldRequest {
    let (surface, formula) = (Some(surface.to_owned()), formula.map(str::to_owned));
    FieldRequest { surface, formula, ..FieldRequest::default() }
}

fn of_thickness(thickness: &str) -> SolidSettings {
    SolidSettings { thickness: thickness.into(), ..SolidSettings::default() }
}

#[test]
fn a_session_refuses_a_thickness_with_other_names() {
    let mut session = Session::new();
    session.set_field(&request("sphere", None)).expect("a field");
    let fault = session.choose(of_thickness("0.1 + √q")).expect_err("no parameter");
    assert_eq!((fault.kind, fault.start, fault.end), (FaultKind::Thickness, 7, 8), "{fault:?}");
    session.choose(of_thickness("0.1 + 0.05 r z")).expect("a thickness");
    let settings = Settings::with_count(1_500);
    while session.fit(&|_| settings, false, 3).is_none() {}
    // The shell has room in a box of its own.
    session.start(&settings).expect("a run");
    while session.run.step(u32::MAX).stop_reason.is_none() {}
    let report = session.report();
    assert_eq!((report.proof.components, report.border), (2, 0), "{report:?}");
    let record = session.record(None).expect("a record");
    assert_eq!(record.solid.thickness, Thickness::Formula("0.1 + 0.05 r z".to_owned()));
    let json = serde_json::to_string(&record.solid).expect("a text");
    assert!(json.contains(r#""thickness":"0.1 + 0.05 r z""#), "{json}");
    assert_eq!(serde_json::from_str::<SolidSettings>(&json).expect("settings"), record.solid);
    // Another formula does not have the name.
    session.set_field(&request("sphere", Some("x^2 + y^2 + z^2 = 1"))).expect("a field");
    while session.fit(&|_| settings, false, 3).is_none() {}
    session.start(&settings).expect("a run");
    assert_eq!(session.record(None).expect("a record").solid, SolidSettings::default());
}
