//! Definitions, choices, functions of other languages, names written as one, numbers: what each
//! becomes.

use glam::{DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::field::Frame;
use marching_particles::field::formula::{
    Formula, FormulaError, FormulaErrorKind as Kind, Parameter, number,
};
use marching_particles::field::{Enclosure, Field};

fn parse(text: &str) -> Formula {
    Formula::as_written(text, &[]).unwrap_or_else(|error| panic!("{text}: {error:?}"))
}

fn error(text: &str) -> FormulaError {
    match Formula::as_written(text, &[]) {
        Ok(field) => panic!("{text} was accepted as {}", field.normal_form()),
        Err(error) => error,
    }
}

/// Value at (x, y, z) = (1.25, −0.5, 2).
fn value(text: &str) -> f64 {
    parse(text).jet(DVec3::new(1.25, -0.5, 2.0)).value
}

#[test]
fn functions_have_the_values_of_their_definitions() {
    let (x, y, z) = (1.25_f64, -0.5_f64, 2.0_f64);
    let cases: &[(&str, f64)] = &[
        ("sec(x)", 1.0 / libm::cos(x)),
        ("csc(x)", 1.0 / libm::sin(x)),
        ("cot(x)", 1.0 / libm::tan(x)),
        ("sech(x)", 1.0 / libm::cosh(x)),
        ("csch(x)", 1.0 / libm::sinh(x)),
        ("coth(x)", 1.0 / libm::tanh(x)),
        ("asinh(y) + arsinh(x)", libm::asinh(y) + libm::asinh(x)),
        ("acosh(z) + arcosh(x)", libm::acosh(z) + libm::acosh(x)),
        ("atanh(y) + artanh(y)", 2.0 * libm::atanh(y)),
        ("log2(z) + log2(1/8)", -2.0),
        ("erf(y)", libm::erf(y)),
        ("mod(y, 2) + x % 1", 1.75),
        ("-x % 2", -1.25),
        ("x*y % 2", 1.375),
        ("fract(y) + ceil(x) + round(x) + round(z + 1/2)", 0.5 + 2.0 + 1.0 + 3.0),
        ("clamp(x, 0, 1) + clamp(y, 0, 1) + clamp(z, 0, 3)", 3.0),
        ("mix(x, z, y) + lerp(x, z, 1)", x * 1.5 - 1.0 + 2.0),
        ("step(x, x) + step(z, x) + step(y, x)", 2.0),
        ("smoothstep(1, 2, x) + smoothstep(0, 1, z) + smoothstep(0, 1, y)", 0.156_25 + 1.0),
        ("length(3, 4) + norm(x, y, z)", 5.0 + (x * x + y * y + z * z).sqrt()),
        ("dot(x, y, z, x, y, z)", x * x + y * y + z * z),
        ("pow(x, 2) + square(y) + powf(z, 3.0f)", x * x + y * y + 8.0),
        ("smin2(x, y, 0.5) + smin2(x, x, 0.4)", y + x - 0.1),
        ("smax2(x, y, 0.5) + smax2(x, x, 0.4)", x + x + 0.1),
        ("smin2(x, y, 0)", y),
        ("if(x < 1, y, z)", z),
        ("if(x >= 1.25, y, z) + if(x <= 1.25, y, z)", 2.0 * y),
        ("if(x > 1.25, y, z) + if(x < 1.25, y, z)", 2.0 * z),
        ("x > 1 and y > 0 or z > 1 ? 1 : 2", 1.0),
        ("x > 1 and (y > 0 or z < 1) ? 1 : 2", 2.0),
        ("not x > 1 ? 1 : y > 0 ? 2 : 3", 3.0),
        ("-1 < y < 0 < x ? 1 : 2", 1.0),
        ("atan(y, x) + arctan2(y, x)", 2.0 * libm::atan2(y, x)),
        ("Sin[x] + Log[z] + ArcTan[x, y]", libm::sin(x) + libm::log(z) + libm::atan2(y, x)),
        ("E^x + 2 Pi + Cos[y]", libm::exp(x) + core::f64::consts::TAU + libm::cos(y)),
        ("Math.PI + np.e + math.log(z)", core::f64::consts::PI + core::f64::consts::E + libm::log(z)),
        ("sqrtf(z) + fabs(y) + fmax(x, y) + fminf(x, y)", 2_f64.sqrt() + 0.5 + 0.75),
        ("⌊x⌋ + \\lceil x\\rceil", 3.0),
    ];
    for &(text, wanted) in cases {
        let got = value(text);
        assert!((got - wanted).abs() <= 1e-12 * wanted.abs().max(1.0), "{text} = {got}, not {wanted}");
    }
}

#[test]
fn single_precision_and_bounds_agree_with_double_precision() {
    let texts = [
        "asinh(x) + acosh(z)",
        "atanh(y) + erf(x)",
        "sec(x) + csc(y) + cot(z)",
        "mod(x, z) - fract(y)",
        "smin2(x, y, z) + smax2(y, z, x)",
        "clamp(x, y, z) + mix(x, y, z)",
        "smoothstep(y, z, x)",
        "if(x < y or z > 1.5, x y, z)",
        "x > y ? step(y, z) : log2(z)",
    ];
    for text in texts {
        let field = parse(text);
        for p in [Vec3::new(1.25, -0.5, 2.0), Vec3::new(0.3, 0.7, 1.1), Vec3::new(-2.0, -0.25, 1.75)] {
            let (mut single, mut slope) = ([0.0], [Vec3::ZERO]);
            field.evaluator(Frame::default()).gradients(&[p], &mut single, &mut slope);
            let exact = field.jet(p.as_dvec3());
            assert!(
                (f64::from(single[0]) - exact.value).abs() <= 1e-5 * (1.0 + exact.value.abs()),
                "{text} at {p}"
            );
            let step = (slope[0].as_dvec3() - exact.gradient).length();
            assert!(step <= 1e-4 * (1.0 + exact.gradient.length()), "{text} at {p}");
            let mut out = [Enclosure::UNKNOWN];
            let around = Bounds::new(p.as_dvec3() - 0.01, p.as_dvec3() + 0.02);
            // A sum is its own only factor.
            parse(&format!("({text}) + x^2 + 0.618034"))
                .evaluator(Frame::default())
                .bounded()
                .expect("a formula has bounds")
                .enclose(0, &[around], &mut out);
            let shifted = exact.value + f64::from(p.x).powi(2) + 0.618_034;
            assert!(out[0].value.holds(shifted), "{text} at {p}: {shifted} in {:?}", out[0]);
        }
    }
}

#[test]
fn bounds_of_a_choice_are_those_of_what_it_takes() {
    let known = |text: &str, x: [f64; 2]| {
        let mut out = [Enclosure::UNKNOWN];
        parse(text).evaluator(Frame::default()).bounded().expect("a formula has bounds").enclose(
            0,
            &[Bounds { min: [x[0], 0.1, 0.1], max: [x[1], 0.2, 0.2] }],
            &mut out,
        );
        out[0]
    };
    // Beside the tie, on it, and with a value that is defined on one side only.
    assert!(!known("if(x < 1, y - 5, z + 5)", [0.0, 0.5]).may_vanish);
    assert!(known("if(x < 1, y - 5, z - 6)", [0.0, 2.0]).value.hi < -4.0);
    assert!(known("if(x < 1, y, z + 5)", [0.0, 2.0]).value.hi > 5.0);
    assert!(!known("if(x < 1, y, z + 5)", [0.0, 2.0]).continuous);
    assert!(known("if(x < 1, y, z + 5)", [1.1, 2.0]).continuous);
    assert!(known("if(x > 0, ln(x), y)", [0.5, 2.0]).defined);
    assert!(!known("if(x > 1, ln(-x), y)", [0.5, 2.0]).defined);
    assert_eq!(known("if(x > 1, ln(-x), y)", [1.5, 2.0]), Enclosure::NOWHERE);
    // Minima, maxima and absolute values are known to be continuous.
    for text in [
        "x < y ? x : y",
        "x > y ? x : y",
        "x > 0 ? x : -x",
        "if(x < 0.15, 0.15 - x, x - 0.15)",
        "x > 0 ? x : 0",
    ] {
        assert!(known(text, [-1.0, 1.0]).continuous, "{text}");
    }
}

#[test]
fn definitions_stand_for_what_they_define() {
    let pairs: &[(&str, &str)] = &[
        ("r = hypot(x, y); (r - 1)^2 + z^2 = 0.1", "(hypot(x, y) - 1)^2 + z^2 = 0.1"),
        ("r = hypot(x, y)\n(r - 1)^2 + z^2 = 0.1\n", "(hypot(x, y) - 1)^2 + z^2 = 0.1"),
        ("f(a, b) = a^2 + b^2; f(x, y) = f(y, z)", "x^2 + y^2 = y^2 + z^2"),
        ("g(x) = x^2 + 1; g(y) = z", "y^2 + 1 = z"),
        ("s(x, y, z) = x + 2y + 3z; s(z, x, y)", "z + 2x + 3y"),
        ("h(a) = a + 1; k(a) = h(a) h(2a); k(x)", "(x + 1)*(2x + 1)"),
        ("a = 2; b = 3\nc = a b; c x", "6x"),
        ("d = x; d = min(d, y); d", "min(x, y)"),
        ("r = hypot(x, y); r = 2", "hypot(x, y) = 2"),
        ("k = 3; k(x + 1)", "3(x + 1)"),
        ("x^2 + y^2\n  + z^2 =\n 1", "x^2 + y^2 + z^2 = 1"),
        ("max(x,\n y)", "max(x, y)"),
        ("f(x, y, z) = x\n + y", "x + y"),
        ("a = 1\n-x + y = a", "-x + y = 1"),
        ("// a line\n# another\nx /* inside */ + y (* both *) - z // end", "x + y - z"),
        ("x + y;", "x + y"),
        ("; x", "x"),
        ("return x + y;", "x + y"),
        ("(x, y, z) => x + y", "x + y"),
        ("E = 2; E x", "2x"),
        ("a := 2; a x", "2x"),
        ("r = hypot(x, y); (r) = 2r - 1", "hypot(x, y) = 2hypot(x, y) - 1"),
    ];
    for &(text, plain) in pairs {
        let (field, wanted) = (parse(text), parse(plain));
        assert_eq!(field.auto(), wanted.auto(), "{text}");
        let p = DVec3::new(0.75, -0.5, 2.0);
        assert!((field.jet(p).value - wanted.jet(p).value).abs() < 1e-15, "{text}: {}", field.normal_form());
        let again = parse(&field.normal_form());
        assert!(again.same_tree(&field), "{text} → {}", field.normal_form());
    }
    // Names that are not defined are parameters, in definitions too.
    assert_eq!(parse("s = a x; s + b").auto(), ["a", "b"]);
    // A definition takes the place of a declared parameter.
    let field = Formula::as_written("a = 2; a x", &[Parameter::automatic("a")]).unwrap();
    assert!(field.parameters().is_empty() && field.normal_form() == "a = 2; a*x");
}

#[test]
fn definitions_that_make_no_sense_are_refused_where_they_stand() {
    let cases: &[(&str, Kind, core::ops::Range<usize>, &str)] = &[
        ("r = r + 1; r x", Kind::BadDefinition, 4..5, "by itself"),
        ("f(a) = f(a - 1); f(x)", Kind::BadDefinition, 7..8, "by itself"),
        ("b = a; a = 2; b x", Kind::BadDefinition, 4..5, "before it is defined"),
        ("r = 1; r = 2; r x", Kind::BadDefinition, 7..8, "twice"),
        ("f(a) = a; f = 2; f(x)", Kind::BadDefinition, 10..11, "twice"),
        ("x = 2; y", Kind::BadDefinition, 0..1, "meaning of its own"),
        ("pi = 3; x", Kind::BadDefinition, 0..2, "meaning of its own"),
        ("sin(a) = a; sin(x)", Kind::BadDefinition, 0..3, "meaning of its own"),
        ("arctan = 1; x", Kind::BadDefinition, 0..6, "meaning of its own"),
        ("f(pi) = pi; f(x)", Kind::BadDefinition, 0..1, "argument"),
        ("f(a, a) = a; f(x, y)", Kind::BadDefinition, 0..1, "argument"),
        ("x^2 + y; z", Kind::BadDefinition, 0..7, "the last statement"),
        ("vec3 q = x; q", Kind::BadDefinition, 0..10, "vectors"),
        ("k = x\ny z", Kind::BadDefinition, 0..1, "Nothing uses"),
        ("f(a, b) = a b; f(x)", Kind::WrongArity, 15..19, "takes 2 arguments"),
        ("f(a) = a; f x", Kind::MissingBrackets, 10..11, "`f(a)`"),
        ("a = x = y; a", Kind::TooManyEquations, 6..7, "one `=`"),
        ("a = (x; a + y", Kind::UnexpectedSymbol, 6..6, "not closed before `;`"),
        ("a = x < 1; a", Kind::UnexpectedSymbol, 4..9, "condition"),
        ("x^2 + y\nz^2 = 1", Kind::Ambiguous, 8..9, "new line"),
        ("r = hypot(x, y); r = cos(r)", Kind::Ambiguous, 17..20, "defined above"),
        ("/* x", Kind::UnexpectedEnd, 0..2, "not closed"),
        ("x // 2", Kind::Ambiguous, 2..4, "floor(a/b)"),
        ("x = 1 % unit sphere", Kind::Ambiguous, 6..7, "comment"),
    ];
    for (text, kind, span, words) in cases {
        let error = error(text);
        assert_eq!((error.kind, &error.span), (*kind, span), "{text}: {error:?}");
        assert!(error.message.contains(words), "{text}: {error:?}");
    }
}

#[test]
fn definitions_are_evaluated_once_and_functions_within_bounds() {
    // Written out, the sum has 2^200 terms.
    let mut text = "a_0 = x; ".to_owned();
    (1..=200).for_each(|k| text.push_str(&format!("a_{k} = a_{} + a_{};", k - 1, k - 1)));
    assert_eq!(parse(&format!("{text} a_200")).jet(DVec3::X).value, libm::exp2(200.0));
    let mut text = "f_0(t) = t + 1; ".to_owned();
    (1..=40).for_each(|k| text.push_str(&format!("f_{k}(t) = f_{}(t) + f_{}(2t); ", k - 1, k - 1)));
    assert_eq!(error(&format!("{text} f_40(x)")).kind, Kind::TooComplex);
    // A chain of functions is as deep as their bodies together.
    let mut text = "f_0(t) = t; ".to_owned();
    (1..=100).for_each(|k| text.push_str(&format!("f_{k}(t) = (f_{}(t)); ", k - 1)));
    assert_eq!(error(&format!("{text} f_100(x)")).kind, Kind::TooDeep);
    assert_eq!(error("f(a) = 1/a; x + f(1 - 1)").span, 16..24);
}

#[test]
fn a_name_before_the_only_equals_sign_is_asked_about() {
    let asked = error("c = x y z");
    assert_eq!((asked.kind, asked.span.clone()), (Kind::Ambiguous, 0..3));
    assert_eq!((asked.suggestion.as_deref(), asked.name.as_deref()), (Some(""), Some("c")));
    assert_eq!(*error("phi = x + y").choices, ["", "(phi) ="]);
    // It is a parameter where it is declared or in brackets, and on the right.
    let declared = Formula::as_written("c = x y z", &[Parameter::automatic("c")]).unwrap();
    assert_eq!(declared.parameters().len(), 1);
    for text in ["(c) = x y z", "x y z = c", "c = a", "c = c x + y"] {
        assert!(parse(text).auto().contains(&"c".to_owned()), "{text}");
    }
    // Programs name the function, and so does f.
    for text in [
        "f = x y z",
        "F = x y z;",
        "c = x y z;",
        "a = x; c = a y z",
        "float c = x y z",
        "c = @(x, y, z) x.*y.*z",
    ] {
        assert!(parse(text).auto().is_empty(), "{text}");
    }
}

#[test]
fn functions_written_as_one_with_their_arguments_are_asked_about() {
    for (text, wanted) in [
        ("cosx", "cos(x)"),
        ("expx", "exp(x)"),
        ("lnx", "ln(x)"),
        ("xsinx", "x*sin(x)"),
        ("sinxcosy", "sin(x)*cos(y)"),
        ("asin2x", "asin(2*x)"),
        ("sinkx", "sin(k*x)"),
        ("cospix", "cos(pi*x)"),
        ("sincosx", "sin(cos(x))"),
        ("cosr", "cos(r)"),
        ("tanθ", "tan(θ)"),
        ("sqrt2", "sqrt(2)"),
        ("rsinx", "r*sin(x)"),
        ("cothx", "coth(x)"),
        ("arctanx", "arctan(x)"),
        ("x2y2", "x^2*y^2"),
        ("sinx2", "sin(x^2)"),
    ] {
        let slip = error(&format!("z + {text}"));
        assert_eq!(
            (slip.kind, slip.suggestion.as_deref()),
            (Kind::UnknownName, Some(wanted)),
            "{text}: {slip:?}"
        );
        assert_eq!(slip.name.as_deref(), Some(text));
        // Declared, it is a name like any other.
        assert!(Formula::as_written(&format!("z + {text}"), &[Parameter::automatic(text)]).is_ok(), "{text}");
    }
    // With another name in the formula there is another reading.
    assert_eq!(*error("a z + asinx").choices, ["asin(x)", "a*sin(x)"]);
    assert_eq!(*error("sinx^2").choices, ["sin(x)^2", "sin(x^2)"]);
    assert_eq!(*error("log2x").choices, ["log2(x)", "log(2*x)"]);
    assert_eq!(error("xsin(y)").suggestion.as_deref(), Some("x*sin"));
    assert!(error("sinxsiny=z").suggestion.as_deref() == Some("sin(x)*sin(y)"));
    // Words in which a function's name stands, and indices, are names.
    for name in [
        "maxr",
        "min_r",
        "radius_max",
        "sinus",
        "logo",
        "expand",
        "absolute",
        "tan_a",
        "signal",
        "modulus",
        "mixture",
        "lengthx",
        "scale",
        "tangent",
        "minx",
        "maxy",
        "cosine",
        "exponent",
        "x0",
        "x1",
        "y_2",
        "rx",
        "secret",
        "steps",
        "modes",
        "dots",
        "absorb",
        "rounding",
        "floor_1",
        "period",
        "kx",
    ] {
        assert_eq!(parse(&format!("x + {name} y")).auto(), [name]);
    }
}

#[test]
fn no_name_of_another_function_is_taken_for_misspelt() {
    for name in [
        "sinc", "erfc", "gamma", "asec", "acot", "besselj", "nthroot", "expm1", "log1p", "trunc", "fmod",
        "sind", "sqr",
    ] {
        let refused = error(&format!("{name}(x) + y"));
        let mends = refused.suggestion.iter().chain(&*refused.choices);
        for mend in mends {
            assert!(mend.contains('x'), "{name} → {mend}: a name in place of a call");
        }
    }
    assert_eq!(*error("log(x)").choices, ["ln", "log10", "log2"]);
    assert_eq!(*error("lg(x)").choices, ["log10", "log2"]);
    assert_eq!(*error("sqr(x)").choices, ["x^2", "sqrt(x)"]);
}

#[test]
fn a_fraction_of_two_numbers_multiplies_what_stands_beside_it() {
    for (text, wanted) in [
        ("9/4y^2", "(9/4)*y^2"),
        ("1/2x", "(1/2)*x"),
        ("x - 1/2(x + y)", "x - (1/2)*(x + y)"),
        ("3/2sin(x)", "(3/2)*sin(x)"),
        ("z*1/2x", "z*(1/2)*x"),
        ("1/2x/z", "(1/2)*x/z"),
        ("1/2a x", "(1/2)*a*x"),
        ("-9/80x^2z^3", "-(9/80)*x^2*z^3"),
    ] {
        assert!((value(text) - value(wanted)).abs() < 1e-15, "{text}");
    }
    for text in ["a/2x", "x/2y", "x^2/4y^2", "1/2pi", "1/2sqrt(2) x", "2/3/4x", "1/2^2x", "1/2x/3y", "1/x y"]
    {
        let asked = error(text);
        assert_eq!((asked.kind, asked.choices.len()), (Kind::Ambiguous, 2), "{text}: {asked:?}");
    }
    assert_eq!(*error("x/2y").choices, ["(2 y)", "2*y"]);
}

#[test]
fn commas_without_spaces_separate_where_no_argument_is_a_number_alone() {
    for (text, wanted) in [
        ("max(abs(x)-1,abs(y)-1,3-z)", 1.0),
        ("max(x-1,3-y,z)", 3.5),
        ("hypot(x-1.25,3-y,0*z)", 3.5),
        ("clamp(z,0,1)", 1.0),
        ("max(x,1,5 x)", 6.25),
    ] {
        assert_eq!(value(text), wanted, "{text}");
    }
    for text in ["max(x,1,5)", "max(x, 1,5 y)", "mix(x,y,0,5)", "f(a, b) = a + b; f(x,0,5)", "0,5x"] {
        assert_eq!(error(text).kind, Kind::DecimalComma, "{text}");
    }
}

#[test]
fn numbers_are_texts_of_the_language_without_names() {
    use core::f64::consts::PI;
    for (text, wanted) in [
        ("2", 2.0),
        (" -pi ", -PI),
        ("pi/2", PI / 2.0),
        ("1e-3", 1e-3),
        ("2*10^5", 2e5),
        ("max(1, 2)", 2.0),
        ("1/2", 0.5),
    ] {
        assert_eq!(number(text), Ok(wanted), "{text}");
    }
    for text in ["", "x", "2x", "a", "nan", "inf", "1/0", "0,5", "x = 1", "1 = 1", "sqrt(-1)", "2;3", "sin"] {
        assert!(number(text).is_err(), "{text}");
    }
}

#[test]
fn a_formula_without_coordinates_says_what_its_name_is() {
    let field = parse("k = 2");
    let why = field.facts().why_constant.unwrap_or_default();
    assert_eq!(why, "`k` is a parameter here, not a coordinate: a surface is a formula of x, y and z.");
    assert!(field.jet(DVec3::ONE).gradient == DVec3::ZERO);
    assert_eq!(parse("x - x + r").facts().why_constant, None);
}
