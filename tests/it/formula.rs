//! Tests of the formula language: what it accepts, what a formula means, and the errors.

use glam::{DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::field::Frame;
use marching_particles::field::formula::{
    FUNCTIONS, Formula, FormulaError, FormulaErrorKind as Kind, MAX_DEPTH, MAX_FORMULA_BYTES, Parameter,
    utf16_offset,
};
use marching_particles::field::{Enclosure, Field};
use marching_particles::field::{Interval, Sym3};

fn parse(text: &str) -> Formula {
    Formula::as_written(text, &[]).unwrap_or_else(|error| panic!("{text}: {error:?}"))
}

fn error(text: &str) -> FormulaError {
    match Formula::as_written(text, &[]) {
        Ok(_) => panic!("{text} was accepted"),
        Err(error) => error,
    }
}

/// Value at (x, y, z) = (1.25, −0.5, 2).
fn value(text: &str) -> f64 {
    parse(text).jet(DVec3::new(1.25, -0.5, 2.0)).value
}

#[test]
fn formulas_mean_what_a_mathematician_reads() {
    let (x, y, z) = (1.25_f64, -0.5_f64, 2.0_f64);
    let cases: &[(&str, f64)] = &[
        ("x", x),
        ("2x", 2.0 * x),
        ("2x y", 2.0 * x * y),
        ("xyz", x * y * z),
        ("xy^2", x * y * y),
        ("3(x+1)", 3.0 * (x + 1.0)),
        ("(x+1)(y-1)", (x + 1.0) * (y - 1.0)),
        ("x(y+1)", x * (y + 1.0)),
        ("-x^2", -(x * x)),
        ("2^-x^2", libm::pow(2.0, -(x * x))),
        ("2^3^2", 512.0),
        ("x-y-z", x - y - z),
        ("x/y/z", x / y / z),
        ("x/y*z", x / y * z),
        ("x*-y", -x * y),
        ("x - -y", x + y),
        ("+x", x),
        ("--x", x),
        ("x^2 + y^2 = z", x * x + y * y - z),
        (
            "pi + e + tau + phi",
            3.0 * core::f64::consts::PI + core::f64::consts::E + f64::midpoint(1.0, 5_f64.sqrt()),
        ),
        ("2e3", 2000.0),
        ("2e-1x", 0.2 * x),
        ("2e", 2.0 * core::f64::consts::E),
        ("2e x", 2.0 * core::f64::consts::E * x),
        (".5x", 0.5 * x),
        ("5.x", 5.0 * x),
        ("sin^2(x)", libm::sin(x).powi(2)),
        ("sin²(x) + cos²(x)", 1.0),
        ("sin(x)y", libm::sin(x) * y),
        ("x² + y³", x * x + y * y * y),
        ("x⁻²", 1.0 / (x * x)),
        ("z¹⁰", 1024.0),
        ("2πx", core::f64::consts::TAU * x),
        ("x × y · z ÷ 4 − 1", x * y * z / 4.0 - 1.0),
        ("２ｘ＋（ｙ）", 2.0 * x + y),
        ("x\u{00A0}+\u{2009}y", x + y),
        ("cbrt(-8)", -2.0),
        ("sqrt(z)", 2.0_f64.sqrt()),
        ("abs(y)", 0.5),
        ("sign(y)", -1.0),
        ("floor(y)", -1.0),
        ("min(x, y, z)", y),
        ("max(x, y, z)", z),
        ("exp(ln(z))", 2.0),
        ("log10(1000)", 3.0),
        ("atan2(y, x)", libm::atan2(y, x)),
        ("asin(y) + acos(y)", core::f64::consts::FRAC_PI_2),
        ("atan(tan(y))", y),
        ("cosh(x)^2 - sinh(x)^2", 1.0),
        ("tanh(x)", libm::tanh(x)),
        ("hypot(3, 4)", 5.0),
        ("hypot(x, y, z)", (x * x + y * y + z * z).sqrt()),
        ("smin(x, y, 0)", y),
        ("smin(x, x, 0.6)", x - 0.1),
        ("smax(x, x, 0.6)", x + 0.1),
        ("x^0.5", x.sqrt()),
        ("z^-1.5", libm::pow(2.0, -1.5)),
        ("z^0.3", libm::pow(2.0, 0.3)),
        ("y^3", y * y * y),
        ("y^0", 1.0),
        ("x^y", libm::pow(x, y)),
        ("-0", 0.0),
        ("1e-320 + x", x),
    ];
    for &(text, wanted) in cases {
        let got = value(text);
        assert!((got - wanted).abs() <= 1e-13 * wanted.abs().max(1.0), "{text} = {got}, not {wanted}");
    }
}

#[test]
fn every_error_has_its_kind_span_and_suggestion() {
    let cases: &[(&str, Kind, core::ops::Range<usize>, Option<&str>)] = &[
        ("", Kind::Empty, 0..0, None),
        (" \t\n ", Kind::Empty, 0..0, None),
        ("x^2+", Kind::UnexpectedEnd, 4..4, None),
        ("x^2 + ", Kind::UnexpectedEnd, 6..6, None),
        (")(", Kind::UnexpectedSymbol, 0..1, None),
        ("(x", Kind::UnexpectedEnd, 2..2, Some(")")),
        ("[x", Kind::UnexpectedEnd, 2..2, Some("]")),
        ("[x)", Kind::UnexpectedSymbol, 2..3, Some("]")),
        ("|x", Kind::UnexpectedEnd, 2..2, Some("|")),
        ("|x|y|z|", Kind::Ambiguous, 4..5, Some("*|")),
        ("x)", Kind::UnexpectedSymbol, 1..2, None),
        ("()", Kind::UnexpectedSymbol, 1..2, None),
        ("sin", Kind::MissingBrackets, 0..3, Some("sin(…)")),
        ("cos x y", Kind::MissingBrackets, 0..5, Some("cos(x)")),
        ("2 sin x^2 y", Kind::MissingBrackets, 2..9, Some("sin(x^2)")),
        ("sin x/2", Kind::MissingBrackets, 0..5, Some("sin(x)")),
        ("ln x*y", Kind::MissingBrackets, 0..4, Some("ln(x)")),
        ("sin x(y + 1)", Kind::MissingBrackets, 0..5, Some("sin(x)")),
        ("exp -x", Kind::MissingBrackets, 0..6, Some("exp(-x)")),
        ("sqrt 2x", Kind::MissingBrackets, 0..7, Some("sqrt(2x)")),
        ("min x y", Kind::MissingBrackets, 0..3, Some("min(…)")),
        ("sin cos x y", Kind::MissingBrackets, 4..9, Some("cos(x)")),
        ("x = y = z", Kind::TooManyEquations, 6..7, None),
        ("= x", Kind::UnexpectedSymbol, 0..1, None),
        ("x =", Kind::UnexpectedEnd, 3..3, None),
        ("x * / y", Kind::UnexpectedSymbol, 4..5, None),
        ("x 2", Kind::UnexpectedSymbol, 2..3, None),
        ("2 3", Kind::UnexpectedSymbol, 2..3, None),
        ("0,5 x", Kind::DecimalComma, 0..3, Some("0.5")),
        ("min(x, 0,5)", Kind::DecimalComma, 7..10, Some("0.5")),
        ("x, y", Kind::UnexpectedSymbol, 1..2, None),
        ("a/2x", Kind::Ambiguous, 2..4, None),
        ("1/2pi", Kind::Ambiguous, 2..5, None),
        ("x % 2y", Kind::Ambiguous, 4..6, None),
        ("x²^3", Kind::Ambiguous, 0..4, None),
        ("sin^-1(x)", Kind::Ambiguous, 0..6, None),
        ("cos^-0 y", Kind::Ambiguous, 0..6, None),
        ("sin⁻¹(x)", Kind::Ambiguous, 0..8, None),
        ("sin^n(x)", Kind::Ambiguous, 0..5, None),
        ("1.2.3", Kind::BadNumber, 0..4, None),
        (".", Kind::BadNumber, 0..1, None),
        ("1e999", Kind::NotFinite, 0..5, None),
        ("0/0", Kind::NotFinite, 2..3, None),
        ("x + 1/0", Kind::NotFinite, 6..7, None),
        ("x/(2 - 2)", Kind::NotFinite, 2..9, None),
        ("x + ln(0)", Kind::NotFinite, 4..9, None),
        ("sqrt(-1) x", Kind::NotFinite, 0..8, None),
        ("10^400", Kind::NotFinite, 0..6, None),
        ("sn(x)", Kind::UnknownFunction, 0..2, Some("sin")),
        ("foo(x)", Kind::UnknownFunction, 0..3, None),
        ("k(x)", Kind::UnknownFunction, 0..1, Some("k*")),
        ("f(x, y, z) + 1", Kind::UnknownFunction, 0..1, None),
        ("f(x, y) = x y", Kind::Ambiguous, 0..9, Some("z =")),
        ("f(x, z) = x z", Kind::Ambiguous, 0..9, Some("y =")),
        ("f(x) = x", Kind::Ambiguous, 0..6, None),
        ("\\foo x", Kind::UnexpectedSymbol, 0..4, None),
        ("\\frac x + 1", Kind::UnexpectedSymbol, 8..9, None),
        ("\\operatorname x", Kind::UnexpectedSymbol, 0..13, None),
        ("log(x)", Kind::UnknownFunction, 0..3, None),
        ("x + lg(y)", Kind::UnknownFunction, 4..6, None),
        ("sqt(x)", Kind::UnknownFunction, 0..3, Some("sqrt")),
        ("pow(x) + y", Kind::WrongArity, 0..6, None),
        ("siin(x) + y", Kind::UnknownFunction, 0..4, Some("sin")),
        ("abs2(x) + y", Kind::UnknownFunction, 0..7, Some("x^2")),
        ("2 exp2(x + 1)", Kind::UnknownFunction, 2..13, Some("(2^(x + 1))")),
        ("sqr(x)", Kind::UnknownFunction, 0..6, None),
        ("sinc(x)", Kind::UnknownFunction, 0..7, None),
        ("gamma(x)", Kind::UnknownFunction, 0..5, None),
        ("length(x, y", Kind::UnexpectedEnd, 11..11, Some(")")),
        ("length(p) - 1", Kind::WrongArity, 0..9, Some("length(x, y, z)")),
        ("dot(p, p) - 1", Kind::WrongArity, 0..9, Some("(x^2 + y^2 + z^2)")),
        ("length(vec3(x, y, z) - 1)", Kind::UnexpectedSymbol, 7..20, None),
        ("vec3(x, y, z)", Kind::UnknownFunction, 0..4, None),
        ("p[0] + x", Kind::UnexpectedSymbol, 0..1, None),
        ("abs(p.xz)", Kind::UnexpectedSymbol, 4..8, None),
        ("length(p.xz)", Kind::UnexpectedSymbol, 7..11, Some("x, z")),
        ("p.x^2 + y", Kind::UnexpectedSymbol, 0..3, Some("x")),
        ("x^2 + (y^2 + z^2 = 1", Kind::UnexpectedSymbol, 16..16, Some(")")),
        ("x^2 + (y^2 + z^2 = 1)", Kind::UnexpectedSymbol, 16..21, Some(") = 1")),
        ("log x", Kind::UnknownFunction, 0..3, None),
        ("atan2(x)", Kind::WrongArity, 0..8, None),
        ("sin(x, y)", Kind::WrongArity, 0..9, None),
        ("sin()", Kind::WrongArity, 0..5, None),
        ("smin(x, y)", Kind::WrongArity, 0..10, None),
        ("X + 1", Kind::UnknownName, 0..1, Some("x")),
        ("cosx", Kind::UnknownName, 0..4, Some("cos(x)")),
        ("x2 + y2", Kind::UnknownName, 0..2, Some("x^2")),
        ("sim + x", Kind::UnknownName, 0..3, Some("sin")),
        ("x | y", Kind::UnexpectedEnd, 5..5, Some("|")),
        ("x\0", Kind::UnexpectedCharacter, 1..2, Some("")),
        ("x \u{202E}y", Kind::UnexpectedCharacter, 2..5, Some("")),
        ("x ☃", Kind::UnexpectedCharacter, 2..5, None),
        ("x < 1", Kind::UnexpectedCharacter, 2..3, Some("=")),
        ("x >= 1", Kind::UnexpectedCharacter, 2..4, Some("=")),
        ("x \\leq 1", Kind::UnexpectedCharacter, 2..6, Some("=")),
        ("x ≠ 1", Kind::UnexpectedCharacter, 2..5, Some("=")),
        ("<img onerror=alert(1)>", Kind::UnexpectedCharacter, 0..1, Some("=")),
    ];
    for (text, kind, span, suggestion) in cases {
        let error = error(text);
        assert_eq!(error.kind, *kind, "{text}: {error:?}");
        assert_eq!(error.span, *span, "{text}: {error:?}");
        assert_eq!(error.suggestion.as_deref(), *suggestion, "{text}: {error:?}");
        assert!(error.message.len() > 15, "{text}: {error:?}");
    }
}

#[test]
fn formulas_are_read_as_people_write_and_paste_them() {
    let pairs: &[(&str, &str)] = &[
        ("|x|", "abs(x)"),
        ("2|x|y", "2abs(x)*y"),
        ("|x||y|", "abs(x)*abs(y)"),
        ("||x| - 1|", "abs(abs(x) - 1)"),
        ("|x - |y||", "abs(x - abs(y))"),
        ("|x(|y| + 1)|", "abs(x*(abs(y) + 1))"),
        ("|x(y|z|)|", "abs(x*(y*abs(z)))"),
        ("|x|^2", "abs(x)^2"),
        ("x**2 + y**2 == z**3", "x^2 + y^2 = z^3"),
        ("[x + (y - 1)]{z}", "(x + (y - 1))*z"),
        ("sin[x]", "sin(x)"),
        ("f(x,y,z) = x^2 + y^2 + z^2 - 1", "x^2 + y^2 + z^2 - 1"),
        ("F(x, y, z) == x^2 + y^2 + z^2 = 1", "x^2 + y^2 + z^2 = 1"),
        ("g(y,x,z)=x", "x"),
        ("sin x", "sin(x)"),
        ("2 sin x^2 + 1", "2*sin(x^2) + 1"),
        ("sin 2x", "sin(2x)"),
        ("sin 2πx^2", "sin(2*pi*x^2)"),
        ("sin xy", "sin(x*y)"),
        ("sin^2 x + cos²y", "sin(x)^2 + cos(y)^2"),
        ("sin x cos y + sin y cos z", "sin(x)*cos(y) + sin(y)*cos(z)"),
        ("sin x * cos y / sin z", "sin(x)*cos(y)/sin(z)"),
        ("ln x", "ln(x)"),
        ("ln |x|", "ln(abs(x))"),
        ("ln sin x = y", "ln(sin(x)) = y"),
        ("√x + √(y)", "sqrt(x) + sqrt(y)"),
        ("sqrt z", "sqrt(z)"),
        ("r_{1} x", "r_1*x"),
        ("\\frac{x^{2}}{4} + \\frac12 y", "(x^2/4) + (1/2)*y"),
        ("\\dfrac{x}{y}z", "(x/y)*z"),
        ("\\sqrt{x^2+y^2} - \\sqrt[3]{z}", "sqrt(x^2 + y^2) - cbrt(z)"),
        ("\\sqrt[4]{x}", "x^(1/4)"),
        ("\\sin x \\cdot \\cos\\left(y\\right)", "sin(x)*cos(y)"),
        ("\\sin^{2}x", "sin(x)^2"),
        ("\\sin 2\\pi x", "sin(2*pi*x)"),
        ("\\left|x\\right|\\left|y\\right|", "abs(x)*abs(y)"),
        ("\\left| x \\lvert y \\rvert \\right|", "abs(x*abs(y))"),
        ("e^{-x^{2}} \\times 2", "e^(-x^2)*2"),
        ("\\left[x\\,y\\right]", "x*y"),
        ("$x^2 + y^2 = z$", "x^2 + y^2 = z"),
        ("\\[x\\]", "x"),
        ("\\arctan{x} + \\operatorname{atan2}(y, x)", "atan(x) + atan2(y, x)"),
        ("\\theta x", "θ*x"),
    ];
    for &(text, plain) in pairs {
        let (read, wanted) = (parse(text), parse(plain));
        assert!(read.same_tree(&wanted), "{text} is read as {}, not {plain}", read.normal_form());
    }
}

#[test]
fn one_suggestion_mends_every_mistake_of_its_kind() {
    let cases: &[(&str, Option<(&str, usize)>)] = &[
        ("x2 + y2 + z2 = 1", Some(("x^2 + y^2 + z^2 = 1", 3))),
        ("0,5x + 0,25y + 1,5", Some(("0.5x + 0.25y + 1.5", 3))),
        ("sin x y + cos y z", Some(("sin(x) y + cos(y) z", 2))),
        ("sqt(x) + sqt(y)", Some(("sqrt(x) + sqrt(y)", 2))),
        ("log(x) + log(y)", None),
        ("((x", Some(("((x))", 2))),
        // The other mistake is of another kind, and stays.
        ("x2 + y2 + sim", Some(("x^2 + y^2 + sim", 2))),
        ("x2 + sim", None),
        ("sin", None),
        ("x < 1", None),
        ("sinx + siny", Some(("sin(x) + sin(y)", 2))),
    ];
    for &(text, wanted) in cases {
        let mended = error(text).mended;
        let found = mended.as_ref().map(|mended| (mended.text.as_str(), mended.places));
        assert_eq!(found, wanted, "{text}");
    }
}

#[test]
fn a_definition_of_f_is_no_product() {
    let error = error("f(x, y, z) - 1 = 0");
    assert!(error.suggestion.is_none() && !error.message.contains('*'), "{error:?}");
}

#[test]
fn an_inequality_is_explained() {
    for text in ["x < 1", "x ≥ 1", "x \\le 1"] {
        assert!(error(text).message.contains("solid"), "{text}");
    }
}

#[test]
fn strange_characters_are_named_by_their_code_points() {
    assert!(error("x\0").message.contains("U+0000"));
    assert!(error("x + \u{202E}y").message.contains("U+202E"));
    assert!(error("x + ☃").message.contains("U+2603"));
}

#[test]
fn spans_convert_to_the_units_of_a_text_field() {
    // The characters have one byte, two bytes and one unit, and four bytes and two units.
    let text = "aπ𝛼b";
    let units: Vec<usize> = (0..=text.len()).map(|byte| utf16_offset(text, byte)).collect();
    assert_eq!(units, [0, 1, 1, 2, 2, 2, 2, 4, 5]);
    assert_eq!(utf16_offset(text, 99), 5);
    let text = "π × 𝛼";
    let error = error(text);
    assert_eq!((error.kind, error.utf16_span(text)), (Kind::UnexpectedCharacter, 4..6));
}

#[test]
fn a_suggestion_in_place_of_the_span_corrects_the_formula() {
    for text in [
        "sin x y",
        "2 sin x^2 y + 1",
        "[x)",
        "|x|y|z|",
        "x <= 1",
        "f(x, y) = x y",
        "0,5 x",
        "(x",
        "cosx",
        "x2 + y2",
        "X + 1",
        "sn(x)",
        "sqt(x)",
        "sinxcosy + xsin(z)",
        "length(vec2(length(p.xz) - 1, p.y)) = 0.2",
        "z - 2 exp2(x + 1) cube(x + y)",
        "-expm1(x) + saturate(y) trunc(z)",
        "E^x + max(x; y)",
        "c = x y z",
        "x^2 + (y^2 + z^2 = 1",
        "x^2 + (y^2 + z^2 = 1)",
        "hypot(x, y = 1",
    ] {
        let mut mended = text.to_owned();
        for _ in 0..4 {
            let Err(error) = Formula::as_written(&mended, &[]) else { break };
            mended.replace_range(error.span, &error.suggestion.unwrap());
        }
        parse(&mended);
    }
}

// Bad input, case by case.

#[test]
fn an_empty_formula_is_an_error_of_its_own_kind() {
    assert_eq!(error("").kind, Kind::Empty);
    assert_eq!(error("\u{00A0} \n").kind, Kind::Empty);
}

#[test]
fn unknown_names_become_parameters_after_the_declared_ones() {
    // All coefficients of a quadric.
    let text = "a x^2 + b y^2 + c z^2 + f y z + g z x + h x y + p x + q y + r z = s";
    let field = Formula::as_written(text, &[Parameter::automatic("s")]).unwrap();
    assert_eq!(field.auto(), ["a", "b", "c", "f", "g", "h", "p", "q", "r"]);
    assert_eq!(field.parameters()[0].name, "s");
    assert!(field.parameters().iter().all(|p| p.value == 1.0 && p.min < p.value && p.value < p.max));
}

#[test]
fn a_likely_misspelling_is_no_parameter_unless_it_is_declared() {
    let slip = error("alpha x + sim y");
    assert_eq!((slip.kind, slip.name.as_deref()), (Kind::UnknownName, Some("sim")));
    assert!(slip.message.contains("did you mean `sin`") && slip.message.contains("add a slider `sim`"));
    assert!(Formula::as_written("alpha x + sim y", &[Parameter::automatic("sim")]).is_ok());
    let near = Formula::as_written("radius x + radios y", &[Parameter::automatic("radius")]).unwrap_err();
    assert_eq!(near.suggestion.as_deref(), Some("radius"));
    // Indexed names, single letters and Greek letters are not taken for misspellings, and what is
    // only called elsewhere is a name.
    for text in ["length x + norm", "pow x", "phi0 x", "r_1 x + r_2 y", "E x + R", "λ x + μ", "rx x"] {
        parse(text);
    }
}

#[test]
fn parameters_can_be_declared_and_changed_without_parsing_again() {
    let declared = [
        Parameter { name: "a".into(), label: "Length".into(), value: 2.0, min: 0.5, max: 4.0, step: 0.1 },
        Parameter::automatic("unused"),
    ];
    let mut field = Formula::as_written("x^2/a^2 - b", &declared).unwrap();
    let names: Vec<&str> = field.parameters().iter().map(|p| &*p.name).collect();
    assert_eq!(names, ["a", "b"]);
    let point = [Vec3::new(3.0, 0.0, 0.0)];
    let mut value = [0.0];
    let mut gradient = [Vec3::ZERO];
    let mut hessian = [Sym3::default()];
    for (a, b) in [(2.0, 1.0), (0.5, -3.0), (5.0, 0.25)] {
        field.set_parameter("a", a).unwrap();
        field.set_parameter("b", b).unwrap();
        field.evaluator(Frame::default()).hessians(&point, &mut value, &mut gradient, &mut hessian);
        let exact = field.jet(DVec3::new(3.0, 0.0, 0.0));
        assert!((exact.value - (9.0 / (a * a) - b)).abs() < 1e-12);
        assert!((f64::from(value[0]) - exact.value).abs() < 1e-5);
        assert!((f64::from(gradient[0].x) - 6.0 / (a * a)).abs() < 1e-5);
        assert!((f64::from(hessian[0].xx) - 2.0 / (a * a)).abs() < 1e-5);
        assert_eq!(field.parameters()[0].value, a);
    }
    assert!(field.set_parameter("unused", 1.0).is_ok());
    assert_eq!(field.set_parameter("c", 1.0).unwrap_err().kind, Kind::BadParameter);
    assert_eq!(field.set_parameter("a", f64::NAN).unwrap_err().kind, Kind::BadParameter);
    assert_eq!(field.parameters()[0].value, 5.0);
}

#[test]
fn an_exponent_may_be_a_parameter_of_any_value() {
    let mut field = parse("x^p");
    let points: Vec<Vec3> = [-2.5, -1.0, -0.3, 0.0, 0.7, 1.0, 3.0].map(|x| Vec3::new(x, 0.0, 0.0)).to_vec();
    let mut value = vec![0.0; points.len()];
    let mut gradient = vec![Vec3::ZERO; points.len()];
    for p in [-9.0, -8.0, -2.5, -2.0, -1.0, 0.0, 0.5, 1.0, 2.0, 2.000_001, 3.0, 7.0, 8.0, 9.0, 30.0] {
        field.set_parameter("p", p).unwrap();
        field.evaluator(Frame::default()).gradients(&points, &mut value, &mut gradient);
        for (k, point) in points.iter().enumerate() {
            let exact = libm::pow(f64::from(point.x), f64::from(p as f32));
            let same = f64::from(value[k]) == exact || value[k].is_nan() && exact.is_nan();
            let close = (f64::from(value[k]) - exact).abs() <= 1e-6 * exact.abs();
            assert!(same || close, "{}^{p} = {}, not {exact}", point.x, value[k]);
            let slope = f64::from(p as f32) * libm::pow(f64::from(point.x), f64::from((p - 1.0) as f32));
            let close = (f64::from(gradient[k].x) - slope).abs() <= 2e-6 * slope.abs();
            let same = f64::from(gradient[k].x) == slope || gradient[k].x.is_nan() && slope.is_nan();
            assert!(same || close, "slope of x^{p} at {}: {}, not {slope}", point.x, gradient[k].x);
        }
    }
}

#[test]
fn declarations_that_make_no_sense_are_refused() {
    let with = |name: &str, value: f64, min: f64, max: f64| {
        let parameter =
            Parameter { name: name.to_owned().into(), label: "".into(), value, min, max, step: 0.1 };
        Formula::as_written("x", &[parameter]).map(|_| ()).map_err(|error| error.kind)
    };
    assert_eq!(with("a", 1.0, 0.0, 2.0), Ok(()));
    for name in ["x", "pi", "sin", "", "2a", "a b", "<b>", "a-b"] {
        assert_eq!(with(name, 1.0, 0.0, 2.0), Err(Kind::BadParameter), "{name}");
    }
    assert_eq!(with("a", f64::NAN, 0.0, 2.0), Err(Kind::BadParameter));
    assert_eq!(with("a", 1.0, 2.0, 0.0), Err(Kind::BadParameter));
    assert_eq!(with("a", 1.0, 0.0, f64::INFINITY), Err(Kind::BadParameter));
    let twice = [Parameter::automatic("a"), Parameter::automatic("a")];
    assert_eq!(Formula::as_written("x", &twice).unwrap_err().kind, Kind::BadParameter);
}

#[test]
fn deep_nesting_is_refused_before_it_can_overflow_a_stack() {
    for unit in ["(", "-", "+", "sin(", "2^", "x^-", "abs(-("] {
        // The text is within the limit of length, so the limit of depth refuses it.
        let text = unit.repeat(MAX_FORMULA_BYTES / unit.len());
        assert_eq!(error(&text).kind, Kind::TooDeep, "{unit}");
        // This text is beyond both limits.
        assert_eq!(error(&unit.repeat(100_000)).kind, Kind::TooLong, "{unit}");
    }
    let nested = |n: usize| format!("{}x{}", "(".repeat(n), ")".repeat(n));
    parse(&nested(MAX_DEPTH));
    assert_eq!(error(&nested(MAX_DEPTH + 1)).kind, Kind::TooDeep);
}

#[test]
fn a_megabyte_is_refused_before_parsing() {
    let text = "x+".repeat(500_000);
    let error = error(&text);
    assert_eq!((error.kind, error.span), (Kind::TooLong, MAX_FORMULA_BYTES..text.len()));
    // The span does not split a character.
    let text = "π".repeat(3000);
    let error = Formula::as_written(&text[..], &[]).unwrap_err();
    assert!(text.is_char_boundary(error.span.start), "{:?}", error.span);
}

#[test]
fn the_number_of_operations_is_bounded() {
    let tower = format!("{}x", "x^".repeat(1000));
    assert_eq!(error(&tower).kind, Kind::TooDeep);
    // Each power takes about thirty products.
    let powers: Vec<String> = (0..200).map(|k| format!("(x+{k})^{}", 1_073_741_823 - k)).collect();
    assert_eq!(error(&powers.join("+")).kind, Kind::TooComplex);
    // The longest sum that fits is accepted and evaluated.
    let long = format!("x{}", "+y^2".repeat(1000));
    let field = parse(&long);
    assert_eq!(field.jet(DVec3::new(1.0, 2.0, 0.0)).value, 4001.0);
    let terms: Vec<String> = (1..400).map(|k| format!("sin({k}x)")).collect();
    let field = parse(&terms.join("+"));
    let mut value = [0.0];
    let mut gradient = [Vec3::ZERO];
    let mut hessian = [Sym3::default()];
    field.evaluator(Frame::default()).hessians(
        &[Vec3::splat(0.001)],
        &mut value,
        &mut gradient,
        &mut hessian,
    );
    assert!(value[0].is_finite() && hessian[0].xx.is_finite());
}

#[test]
fn extreme_numbers_are_errors_where_constant_and_harmless_elsewhere() {
    for text in ["1e999", "0/0", "x + 0/0", "1/(1-1)", "exp(1000) x", "x^(1/0)"] {
        assert_eq!(error(text).kind, Kind::NotFinite, "{text}");
    }
    assert_eq!(parse("x^1e9").jet(DVec3::ONE).value, 1.0);
    assert_eq!(parse("x^1e9").jet(DVec3::splat(2.0)).value, f64::INFINITY);
    assert_eq!(parse("x^1e300").jet(DVec3::ONE).value, 1.0);
    assert_eq!(parse("x*1e-310").jet(DVec3::ONE).value, 1e-310);
    assert_eq!(parse("-0 + x").jet(DVec3::ONE).value, 1.0);
    // A number too large for single precision is infinite there, not a false zero.
    let mut value = [0.0];
    parse("x - 1e300").evaluator(Frame::default()).values(&[Vec3::ONE], &mut value);
    assert_eq!(value[0], f32::NEG_INFINITY);
}

#[test]
fn a_comma_that_may_be_a_decimal_one_is_refused() {
    for text in [
        "0,5",
        "x^2 = 0,5",
        "(0,5) x",
        "sin(0,5)",
        "sin(1,5e3 x)",
        "sin 0,5",
        "max(x, 1,5)",
        "max(1,5, x)",
        "max(1,5,2)",
        "smin(x, y, 0,5)",
    ] {
        assert_eq!(error(text).kind, Kind::DecimalComma, "{text}");
    }
}

#[test]
fn a_comma_that_has_one_reading_only_separates_arguments() {
    for (text, expected) in [
        ("min(1, 5)", 1.0),
        ("min(x,5)", 1.25),
        // With a decimal comma there would be one argument.
        ("min(1,5)", 1.0),
        ("max(1,5 x)", 6.25),
        ("max(x^2,1)", 1.5625),
        ("atan2(0,1)", 0.0),
        // A number with a point has no other decimals.
        ("max(x, 0.5,2)", 2.0),
        ("smin(x, x - 1.50,0.5)", -0.25),
        ("max(x,2,0.5)", 2.0),
        ("max(1e0,0)", 1.0),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
}

#[test]
fn a_field_without_a_zero_is_seen_by_its_bounds() {
    let bounds = |text: &str| {
        let mut out = [Enclosure::UNKNOWN];
        parse(text).evaluator(Frame::default()).bounded().expect("a formula has bounds").enclose(
            0,
            &[Bounds::cube(10.0)],
            &mut out,
        );
        out[0]
    };
    let known = bounds("x^2 + y^2 + z^2 + 1");
    assert!(known.value.lo > 0.9 && known.value.hi < 302.0 && known.defined, "{known:?}");
    // Whatever way an even power is written: the bounds of a product of two factors would reach
    // below 0.
    for text in ["x^4", "x^3 x", "x x^3", "x x x x", "x^2 x^2", "(x y) (x y)^3", "(x y)^3 (x y)"] {
        let known = bounds(&format!("{text} + 1"));
        assert!(known.value.lo > 0.9, "{text}: {known:?}");
    }
}

#[test]
fn poles_jumps_and_missing_values_are_seen_by_the_bounds_of_a_box() {
    let known = |text: &str, x: [f64; 2]| {
        let mut out = [Enclosure::UNKNOWN];
        let around = Bounds { min: [x[0], 0.1, 0.1], max: [x[1], 0.2, 0.2] };
        parse(text).evaluator(Frame::default()).bounded().expect("a formula has bounds").enclose(
            0,
            &[around],
            &mut out,
        );
        out[0]
    };
    // A box with a pole inside still has no zero.
    for (text, x) in [("1/x", [-0.5, 0.7]), ("exp(y)/x", [-0.5, 0.7]), ("tan(x)", [1.5, 1.6])] {
        let known = known(text, x);
        assert!(!known.may_vanish && !known.defined, "{text}: {known:?}");
    }
    assert!(known("1/x + 1", [-0.5, 0.7]).may_vanish);
    // The zeros of a product are those of its factors.
    assert_eq!(
        parse("-3x^2 (y - 1)/(z - 2)")
            .evaluator(Frame::default())
            .bounded()
            .expect("a formula has bounds")
            .factors(),
        2
    );
    assert_eq!(
        known("-3x^2/(z - 2)", [-0.5, 0.7]).gradient,
        [1.0, 0.0, 0.0].map(|slope| Interval::new(slope, slope))
    );
    assert!(known("tan(x)", [1.5, 3.2]).may_vanish);
    for (text, jump) in
        [("floor(x)", [0.9, 1.1]), ("sign(x)", [-0.1, 0.1]), ("atan2(y - 0.15, x)", [-0.2, 0.1])]
    {
        assert!(!known(text, jump).continuous, "{text}");
        assert!(known(text, [0.2, 0.3]).continuous && known(text, [0.2, 0.3]).defined, "{text}");
    }
    assert!(known("abs(x) + min(x, y)", [-0.5, 0.7]).continuous);
    assert!(!known("ln(x)", [-0.1, 0.1]).defined && known("ln(x)", [0.1, 0.2]).defined);
    assert_eq!(known("ln(x)", [-2.0, -1.0]), Enclosure::NOWHERE);
    assert_eq!(known("x + 0*ln(x)", [-2.0, -1.0]), Enclosure::NOWHERE);
}

#[test]
fn constant_fields_are_recognised() {
    for text in ["0", "1", "a - a", "x - x", "x*0", "(x+y)^2 - x^2 - 2x y - y^2 + 0x", "x = x", "k + 2"] {
        let expanded = text.contains("2x y");
        assert_eq!(parse(text).is_constant(), !expanded, "{text}");
    }
    for text in ["x", "floor(x)", "sign(x)", "abs(x)", "x*y - y*x + z", "k x"] {
        assert!(!parse(text).is_constant(), "{text}");
    }
}

#[test]
fn undefined_regions_are_nan_and_poles_are_infinite() {
    let probe = |text: &str, x: f32| {
        let mut value = [0.0];
        let mut gradient = [Vec3::ZERO];
        parse(text).evaluator(Frame::default()).gradients(
            &[Vec3::new(x, 0.3, 0.4)],
            &mut value,
            &mut gradient,
        );
        (value[0], gradient[0])
    };
    for text in
        ["ln(x)", "sqrt(x)", "x^0.3", "asin(x + 3)", "acos(x + 2)", "log10(x)", "0*ln(x)", "min(ln(x), y)"]
    {
        let at = if text.starts_with('a') { 1.5 } else { -1.5 };
        assert!(probe(text, at).0.is_nan(), "{text}");
    }
    assert!(probe("min(ln(x), y)", -1.5).1.is_nan() && probe("max(y, ln(x))", -1.5).1.is_nan());
    assert_eq!(probe("1/x", 0.0).0, f32::INFINITY);
    assert_eq!(probe("1/x^2 - 5", 0.0).0, f32::INFINITY);
    assert_eq!(probe("ln(x)", 0.0).0, f32::NEG_INFINITY);
    assert!(probe("x/x", 0.0).0.is_nan());
    assert!(probe("tan(x)", core::f32::consts::FRAC_PI_2).0.abs() > 1e7);
    // At the apex of a cone f is defined and has no gradient.
    let (value, gradient) = {
        let (mut value, mut gradient) = ([0.0], [Vec3::ZERO]);
        parse("hypot(x, y) - abs(z)").evaluator(Frame::default()).gradients(
            &[Vec3::ZERO],
            &mut value,
            &mut gradient,
        );
        (value[0], gradient[0])
    };
    assert!(value == 0.0 && gradient.is_nan(), "{value} {gradient}");
}

#[test]
fn a_branch_not_taken_does_not_spoil_the_interval_or_the_value() {
    let field = parse("min(x, exp(x^4))");
    assert_eq!(field.jet(DVec3::new(10.0, 0.0, 0.0)).value, 10.0);
    let mut value = [0.0];
    field.evaluator(Frame::default()).values(&[Vec3::new(10.0, 0.0, 0.0)], &mut value);
    assert_eq!(value[0], 10.0);
}

#[test]
fn kinks_have_the_documented_slopes() {
    let slope = |text: &str, p: DVec3| {
        let field = parse(text);
        let exact = field.jet(p).gradient;
        let mut value = [0.0];
        let mut gradient = [Vec3::ZERO];
        field.evaluator(Frame::default()).gradients(&[p.as_vec3()], &mut value, &mut gradient);
        assert_eq!(gradient[0].as_dvec3(), exact, "{text}");
        exact
    };
    assert_eq!(slope("abs(x)", DVec3::ZERO), DVec3::ZERO);
    assert_eq!(slope("sign(x) + floor(y)", DVec3::splat(0.5)), DVec3::ZERO);
    assert_eq!(slope("min(x, 2y)", DVec3::ZERO), DVec3::X);
    assert_eq!(slope("max(2y, x)", DVec3::ZERO), DVec3::Y * 2.0);
    // The smooth minimum has no kink: at a tie its slope is the mean of both.
    assert_eq!(slope("smin(x, 2y, 1)", DVec3::ZERO), DVec3::new(0.5, 1.0, 0.0));
}

#[test]
fn every_function_is_documented_with_its_own_name() {
    assert!(FUNCTIONS.len() >= 23);
    for function in FUNCTIONS {
        assert!(function.signature.starts_with(&format!("{}(", function.name)), "{function:?}");
        assert!(function.help.ends_with('.'), "{function:?}");
    }
}
