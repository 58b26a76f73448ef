//! Properties of arbitrary formulas: nothing panics, printing and parsing are inverse, all ways of
//! evaluation agree, and the MathML is well formed.

use crate::fuzz::harness;
use glam::{DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::field::Frame;
use marching_particles::field::Sym3;
use marching_particles::field::formula::{
    FUNCTIONS, Formula, FormulaErrorKind as Kind, MAX_FORMULA_BYTES, MathGroup, MathNode,
};
use marching_particles::field::gallery::SURFACES;
use marching_particles::field::{Enclosure, Field};
use proptest::prelude::*;

/// Strategy for formulas with all constructs of the language; `a` and `b_1` are parameters.
fn formulas() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        6 => prop::sample::select(vec!["x", "y", "z"]).prop_map(str::to_owned),
        2 => prop::sample::select(vec!["pi", "e", "tau", "phi", "a", "b_1", "xy"]).prop_map(str::to_owned),
        3 => (0_u32..40, 0_u32..100).prop_map(|(whole, part)| format!("{whole}.{part}")),
        1 => prop::sample::select(vec!["1e3", "2.5e-7", "1e21", ".5", "0"]).prop_map(str::to_owned),
    ];
    leaf.prop_recursive(5, 40, 4, |inner| {
        let calls: Vec<(&str, usize)> = FUNCTIONS
            .iter()
            // A choice, whose first argument is a condition, is made below.
            .filter(|f| f.name != "if")
            .map(|f| {
                (f.name, if f.signature.contains('…') { 3 } else { f.signature.matches(',').count() + 1 })
            })
            .collect();
        let call = (prop::sample::select(calls), prop::collection::vec(inner.clone(), 3))
            .prop_map(|((name, arity), arguments)| format!("{name}({})", arguments[..arity].join(", ")));
        let operators = vec![" + ", " - ", "*", "/", "^", " (", ")(", "^-", "*-", " × ", "−"];
        let binary = (inner.clone(), prop::sample::select(operators), inner.clone()).prop_map(
            |(left, operator, right)| match operator {
                " (" => format!("({left}) ({right})"),
                ")(" => format!("({left} + 1)({right})"),
                "^" | "^-" => format!("({left}){operator}({right})"),
                "/" => format!("{left}/({right})"),
                _ => format!("({left}){operator}({right})"),
            },
        );
        let powers =
            (inner.clone(), prop::sample::select(vec!["²", "³", "⁻¹", "^2", "^5", "^-3", "^0.5", "^1.5"]));
        let conditions =
            vec!["{} < {}", "{} >= {}", "not {} <= {}", "{} > 0.1 and {} < 1", "{} < 0 or {} > 1"];
        let choice = (prop::sample::select(conditions), prop::collection::vec(inner.clone(), 4)).prop_map(
            |(condition, parts)| {
                let filled = condition.replacen("{}", &format!("({})", parts[0]), 1);
                let filled = filled.replacen("{}", &format!("({})", parts[1]), 1);
                format!("if({filled}, {}, {})", parts[2], parts[3])
            },
        );
        prop_oneof![
            3 => call,
            1 => choice,
            5 => binary,
            2 => powers.prop_map(|(base, power)| format!("({base}){power}")),
            1 => inner.prop_map(|inner| format!("-({inner})")),
        ]
    })
}

/// Strategy for formulas that define a value and a function.
fn programs() -> impl Strategy<Value = String> {
    (formulas(), formulas(), formulas(), 0..3_u32).prop_map(|(value, body, surface, kind)| {
        let separator = ["; ", " ;\n", "\n"][kind as usize];
        format!("s = {value}{separator}q(u, v) = (u) - v*({body}) + s{separator}q({surface}, s) + q(s, x)")
    })
}

/// The same formula as it might be pasted from LaTeX, where it has brackets, quotients, powers and
/// calls.
fn in_latex(node: &MathNode) -> Option<String> {
    let all = |children: &[MathNode]| children.iter().map(in_latex).collect::<Option<Vec<String>>>();
    match node {
        MathNode::Token { text, .. } => Some(match text.as_str() {
            "\u{2061}" => " ".into(),
            "\u{2062}" | "⋅" => "\\cdot ".into(),
            "−" => "-".into(),
            "," => ", ".into(),
            "π" => "\\pi ".into(),
            "τ" => "\\tau ".into(),
            "φ" => "\\varphi ".into(),
            "(" => "\\left(".into(),
            ")" => "\\right)".into(),
            "sin" | "cos" | "tan" | "sinh" | "cosh" | "tanh" | "ln" | "min" | "max" => format!("\\{text} "),
            // The name of a function or a parameter.
            _ if text.chars().count() > 1 && text.chars().all(char::is_alphabetic) => {
                format!("\\operatorname{{{text}}}")
            }
            _ => text.clone(),
        }),
        MathNode::Group { tag, children } => {
            let parts = all(children)?;
            Some(match tag {
                MathGroup::Mrow if is_bars(children) => {
                    format!("\\left|{}\\right|", parts[1..parts.len() - 1].concat())
                }
                MathGroup::Mrow => parts.concat(),
                MathGroup::Mfrac => format!("\\frac{{{}}}{{{}}}", parts[0], parts[1]),
                MathGroup::Msup => format!("{}^{{{}}}", parts[0], parts[1]),
                MathGroup::Msqrt => format!("\\sqrt{{{}}}", parts.concat()),
                MathGroup::Mroot => format!("\\sqrt[{}]{{{}}}", parts[1], parts[0]),
                // LaTeX has an environment for choices, which is not read.
                MathGroup::Mtable | MathGroup::Mtr | MathGroup::Mtd => return None,
                MathGroup::Msub if parts[0].starts_with("\\operatorname") => return None,
                MathGroup::Msub => format!("{}_{{{}}}", parts[0], parts[1]),
            })
        }
    }
}

fn is_bars(children: &[MathNode]) -> bool {
    matches!(children.first(), Some(MathNode::Token { text, .. }) if text == "|")
}

proptest! {
    #![proptest_config(crate::cases::proptest(1000))]

    #[test]
    fn no_text_makes_the_parser_panic(text in "\\PC{0,200}") {
        check_error(&text);
    }

    #[test]
    fn no_text_of_formula_characters_makes_the_parser_panic(
        text in "[xyzabersincotapqhl0-9.,+*/^()=²³⁻¹−×π \u{202E}\\-]{0,120}"
    ) {
        check_error(&text);
    }

    #[test]
    fn no_text_of_latex_makes_the_parser_panic(
        text in prop::collection::vec(
            prop::sample::select(vec![
                "if(", " < ", "? ", ": ", ";", "\n", "r =", "f(a,b) =", "and ", "not ", "||", "%", "//", "/*", "*/", "#", "np.", "@",
                "\\frac", "\\sqrt", "\\sin", "\\left", "\\right", "\\pi", "\\cdot", "\\operatorname", "\\", "\\le",
                "|", "{", "}", "[", "]", "(", ")", "x", "y", "2", "1", "^", "_", "-", "=", "f(x,y,z)=", "sin", "ln ", " ",
                "**", ",", "²", "√", "$",
            ]),
            0..30,
        )
    ) {
        check_error(&text.concat());
    }

    #[test]
    fn a_formula_means_the_same_with_other_brackets_and_signs(text in formulas(), at in any::<u64>()) {
        if let Ok(field) = Formula::as_written(&text, &[]) {
            let brackets = [('(', ')'), ('[', ']'), ('{', '}')];
            let mut open = Vec::new();
            let mut choice = at;
            let other: String = text.replace('^', "**").chars().map(|c| match c {
                '(' => {
                    let pair = brackets[(choice % 3) as usize];
                    choice = choice.rotate_right(7) ^ 5;
                    open.push(pair.1);
                    pair.0
                }
                ')' => open.pop().unwrap_or(c),
                _ => c,
            }).collect();
            let again = Formula::as_written(&format!("f(x,y,z) == {other}"), &[])
                .unwrap_or_else(|e| panic!("{text} → {other}: {e}"));
            prop_assert!(field.same_tree(&again), "{} → {}", text, other);
        }
    }

    #[test]
    fn a_formula_set_in_latex_has_the_same_value(
        text in formulas(),
        point in prop::array::uniform3(0.1..2.0_f64),
    ) {
        let Ok(field) = Formula::as_written(&text, &[]) else { return Ok(()) };
        let MathNode::Group { children, .. } = field.mathml() else { return Ok(()) };
        // Without the `= 0` at its end.
        let Some(latex) = in_latex(&children[0]) else { return Ok(()) };
        // Numbers with exponents and calls of `hypot` are set in other ways.
        if latex.len() > MAX_FORMULA_BYTES || text.contains("1e") || text.contains("e-") || text.contains("hypot") {
            return Ok(());
        }
        let again = match Formula::as_written(&latex, &[]) {
            Ok(again) => again,
            // A quotient adds operations, and braces add levels.
            Err(e) if matches!(e.kind, Kind::TooDeep | Kind::TooComplex | Kind::NotFinite) => return Ok(()),
            Err(e) => panic!("{text} → {latex}: {e}"),
        };
        let p = DVec3::from_array(point);
        let (wanted, got) = (field.jet(p).value, again.jet(p).value);
        prop_assert!(
            !wanted.is_finite() || (wanted - got).abs() <= 1e-9 * wanted.abs().max(1.0),
            "{text} → {latex}: {wanted} but {got}"
        );
    }

    #[test]
    fn mending_throughout_leaves_no_mistake_of_the_kind(
        terms in prop::collection::vec(prop::sample::select(vec!["x2", "y3", "z2 x", "0,5", "x", "cosx", "sin x y"]), 1..9)
    ) {
        let text = terms.join(" + ");
        if let Err(error) = Formula::as_written(&text, &[])
            && let Some(mended) = error.mended
            && let Err(next) = Formula::as_written(&mended.text, &[])
        {
            let is_same = next.kind == error.kind
                && next.message.split('`').step_by(2).eq(error.message.split('`').step_by(2));
            prop_assert!(!is_same, "{text} → {}: {next:?}", mended.text);
        }
    }

    #[test]
    fn damaged_formulas_make_no_trouble(text in formulas(), cut in 0.0..1.0_f64, insert in any::<char>()) {
        let characters: Vec<char> = text.chars().collect();
        let at = (cut * characters.len() as f64) as usize;
        let mut damaged: String = characters[..at].iter().collect();
        damaged.push(insert);
        damaged.extend(&characters[(at + 1).min(characters.len())..]);
        check_error(&damaged);
    }

    #[test]
    fn printing_and_parsing_are_inverse(text in formulas()) {
        if let Ok(field) = Formula::as_written(&text, &[]) {
            let printed = field.normal_form();
            let again = Formula::as_written(&printed, &[]).unwrap_or_else(|e| panic!("{text} → {printed}: {e}"));
            prop_assert_eq!(again.normal_form(), printed);
            prop_assert!(field.same_tree(&again), "{} → {}", text, field.normal_form());
        }
    }

    #[test]
    fn printing_and_parsing_definitions_are_inverse(text in programs(), point in prop::array::uniform3(-2.0..2.0_f64)) {
        if let Ok(field) = Formula::as_written(&text, &[]) {
            let printed = field.normal_form();
            let again = match Formula::as_written(&printed, &[]) {
                Ok(again) => again,
                Err(e) => panic!("{text} → {printed}: {e}"),
            };
            prop_assert_eq!(again.normal_form(), printed);
            prop_assert!(field.same_tree(&again), "{} → {}", text, field.normal_form());
            let (one, other) = (field.jet(point.into()).value, again.jet(point.into()).value);
            prop_assert!(one.to_bits() == other.to_bits() || one.is_nan() && other.is_nan());
            check_mathml(&field.mathml());
        }
    }

    #[test]
    fn mathml_is_well_formed(text in formulas()) {
        if let Ok(field) = Formula::as_written(&text, &[]) {
            check_mathml(&field.mathml());
        }
    }

    #[test]
    fn the_value_lies_within_the_bounds_of_any_box_around_the_point(
        text in formulas(),
        point in prop::array::uniform3(-3.0..3.0_f64),
        below in prop::array::uniform3(0.0..2.0_f64),
        above in prop::array::uniform3(0.0..2.0_f64),
        exponent in 0..12_i32,
        a in -2.0..2.0_f64,
    ) {
        // A sum has itself as its only factor, provided that the last term cancels nothing.
        let Ok(mut field) = Formula::as_written(&format!("({text}) + x^2 + 0.618034"), &[]) else { return Ok(()) };
        for name in field.auto().to_vec() {
            field.set_parameter(&name, a).unwrap();
        }
        let p = DVec3::from_array(point);
        let [below, above] = [below, above].map(|size| DVec3::from_array(size) * 0.25_f64.powi(exponent));
        harness::check_value(&mut field, p, below, above);
        if field.jet(p).value.is_nan() {
            let mut out = [Enclosure::UNKNOWN];
            field.evaluator(Frame::default()).bounded().expect("a formula has bounds").enclose(0, &[Bounds::new(p - below, p + above)], &mut out);
            prop_assert!(!out[0].defined, "{text} has no value at {p} but {out:?}");
        }
    }

    #[test]
    fn the_gradient_and_every_mean_slope_lie_within_the_bounds_of_a_box_where_the_value_has_no_jump(
        text in formulas(),
        low in prop::array::uniform3(-3.0..3.0_f64),
        size in prop::array::uniform3(0.0..2.0_f64),
        places in prop::array::uniform6(0.0..1.0_f64),
        exponent in 0..12_i32,
        a in -2.0..2.0_f64,
    ) {
        // A sum has itself as its only factor, provided that the last term cancels nothing.
        let text = format!("({text}) + x^2 + 0.618034");
        let Ok(mut field) = Formula::as_written(&text, &[]) else { return Ok(()) };
        for name in field.auto().to_vec() {
            field.set_parameter(&name, a).unwrap();
        }
        let size = DVec3::from_array(size) * 0.25_f64.powi(exponent);
        let [x, y, z, a, b, c] = places;
        harness::check_enclosure(&mut field, DVec3::from_array(low), size, [DVec3::new(x, y, z), DVec3::new(a, b, c)]);
    }

    #[test]
    fn a_point_gives_the_same_bits_wherever_it_stands_in_a_batch(
        text in formulas(),
        first in prop::array::uniform3(-2.0..2.0_f32),
        length in 1..200_usize,
    ) {
        let Ok(field) = Formula::as_written(&text, &[]) else { return Ok(()) };
        let first = Vec3::from_array(first);
        let points: Vec<Vec3> = (0..length).map(|k| first * (k as f32 * 0.01 + 1.0)).collect();
        let (mut value, mut gradient) = (vec![0.0; length], vec![Vec3::ZERO; length]);
        let mut hessian = vec![Sym3::default(); length];
        field.evaluator(Frame::default()).hessians(&points, &mut value, &mut gradient, &mut hessian);
        let k = length / 2;
        let (mut value1, mut gradient1, mut hessian1) = ([0.0], [Vec3::ZERO], [Sym3::default()]);
        field.evaluator(Frame::default()).hessians(&points[k..=k], &mut value1, &mut gradient1, &mut hessian1);
        let same = |a: f32, b: f32| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
        prop_assert!(same(value[k], value1[0]), "{} {}", value[k], value1[0]);
        for axis in 0..3 {
            prop_assert!(same(gradient[k][axis], gradient1[0][axis]));
        }
        prop_assert!(same(hessian[k].xy, hessian1[0].xy) && same(hessian[k].zz, hessian1[0].zz));
    }

    #[test]
    fn transformed_derivatives_agree_with_forward_jets(
        text in formulas(),
        point in prop::array::uniform3(-2.0..2.0_f64),
    ) {
        let Ok(field) = Formula::as_written(&text, &[]) else { return Ok(()) };
        harness::check_derivatives(&field, &[DVec3::from_array(point)]);
    }
}

/// Parses `text`; if that fails, the error must be usable.
fn check_error(text: &str) {
    if let Err(error) = Formula::as_written(text, &[]) {
        assert!(error.span.start <= error.span.end && error.span.end <= text.len().max(MAX_FORMULA_BYTES));
        assert!(
            text.is_char_boundary(error.span.start) && text.is_char_boundary(error.span.end),
            "{error:?}"
        );
        let units = error.utf16_span(text);
        assert!(units.start <= units.end && units.end <= text.encode_utf16().count());
        assert!(!error.message.is_empty());
    }
}

/// Panics unless every element has as many children as MathML prescribes, or a text.
fn check_mathml(node: &MathNode) {
    match node {
        MathNode::Token { text, .. } => assert!(!text.is_empty(), "{node:?}"),
        MathNode::Group { tag, children } => {
            let wanted = match tag {
                MathGroup::Mfrac | MathGroup::Msup | MathGroup::Msub | MathGroup::Mroot => 2..=2,
                MathGroup::Msqrt | MathGroup::Mtable | MathGroup::Mtr | MathGroup::Mtd => 1..=usize::MAX,
                MathGroup::Mrow => 2..=usize::MAX,
            };
            assert!(wanted.contains(&children.len()), "{tag:?} with {} children in {node:?}", children.len());
            children.iter().for_each(check_mathml);
        }
    }
}

/// The element as `tag(children)`; a token is its text alone, with `·` for the invisible product.
fn written(node: &MathNode) -> String {
    match node {
        MathNode::Token { text, .. } => text.replace('\u{2062}', "·").replace('\u{2061}', "apply"),
        MathNode::Group { tag, children } => {
            let children: Vec<String> = children.iter().map(written).collect();
            format!("{}({})", format!("{tag:?}").to_lowercase(), children.join(" "))
        }
    }
}

#[test]
fn mathml_of_the_gallery_is_well_formed() {
    for surface in SURFACES.iter() {
        check_mathml(&surface.field().mathml());
    }
}

#[test]
fn mathml_is_set_as_one_writes_by_hand() {
    let cases = [
        ("x = 1", "mrow(x = 1)"),
        ("x/2", "mrow(mfrac(x 2) = 0)"),
        ("x^2", "mrow(msup(x 2) = 0)"),
        ("(x + 1)^2", "mrow(msup(mrow(( mrow(x + 1) )) 2) = 0)"),
        ("sqrt(pi)x", "mrow(mrow(msqrt(π) · x) = 0)"),
        ("cbrt(x)", "mrow(mroot(x 3) = 0)"),
        ("2*3x", "mrow(mrow(2 ⋅ 3 · x) = 0)"),
        ("x y/2*z", "mrow(mrow(mfrac(mrow(x · y) 2) · z) = 0)"),
        ("x - y + z", "mrow(mrow(x − y + z) = 0)"),
        ("1e20 x", "mrow(mrow(mrow(1 ⋅ msup(10 20)) · x) = 0)"),
        ("alpha_1 x", "mrow(mrow(msub(α 1) · x) = 0)"),
        ("sin(x)^2", "mrow(mrow(msup(sin 2) apply mrow(( x ))) = 0)"),
        ("smin(x, y, 1)", "mrow(mrow(smin apply mrow(( x , y , 1 ))) = 0)"),
        ("log10(x)", "mrow(mrow(msub(log 10) apply mrow(( x ))) = 0)"),
        ("hypot(x, y)", "mrow(msqrt(msup(x 2) + msup(y 2)) = 0)"),
        ("exp(-x)", "mrow(msup(e mrow(− x)) = 0)"),
        ("abs(x)", "mrow(mrow(| x |) = 0)"),
        ("ceil(x)", "mrow(mrow(⌈ x ⌉) = 0)"),
        ("log2(x)", "mrow(mrow(msub(log 2) apply mrow(( x ))) = 0)"),
        ("atanh(x)", "mrow(mrow(artanh apply mrow(( x ))) = 0)"),
        (
            "if(x < 1 and not y > 2, y, z)",
            "mrow(mrow({ mtable(mtr(mtd(y) mtd(mrow(if\u{a0} mrow(mrow(x < 1) ∧ mrow(¬ mrow(( mrow(y > 2) ))))))) \
             mtr(mtd(z) mtd(otherwise)))) = 0)",
        ),
        ("r = x; r + y", "mtable(mtr(mtd(mrow(r = x))) mtr(mtd(mrow(mrow(r + y) = 0))))"),
        (
            "f(a) = a; f(x)",
            "mtable(mtr(mtd(mrow(mrow(f apply mrow(( a ))) = a))) mtr(mtd(mrow(mrow(f apply mrow(( x ))) = 0))))",
        ),
    ];
    for (text, wanted) in cases {
        assert_eq!(written(&Formula::as_written(text, &[]).unwrap().mathml()), wanted, "{text}");
    }
}

#[test]
fn mathml_crosses_to_the_page_as_tags_with_texts_or_children() {
    let node = Formula::as_written("x = 1", &[]).unwrap().mathml();
    let wanted = serde_json::json!({
        "tag": "mrow",
        "children": [{"tag": "mi", "text": "x"}, {"tag": "mo", "text": "="}, {"tag": "mn", "text": "1"}],
    });
    assert_eq!(serde_json::to_value(&node).unwrap(), wanted);
}

#[test]
fn the_normal_form_is_readable() {
    for (text, wanted) in [
        ("2x y", "2*x*y"),
        ("x² + −y", "x^2 + -y"),
        ("((x))", "x"),
        ("(x*y)*z", "(x*y)*z"),
        ("x-(y-z)", "x - (y - z)"),
        ("-(x*y)", "-x*y"),
        ("x^-2", "x^-2"),
        ("(-x)^2", "(-x)^2"),
        ("(x^y)^z", "(x^y)^z"),
        ("x^(y^z)", "x^y^z"),
        ("1e21 x = .5", "1e21*x = 0.5"),
    ] {
        assert_eq!(Formula::as_written(text, &[]).unwrap().normal_form(), wanted);
    }
}
