//! Tests of the compiled form.

use super::branches::Branches;
use super::graph::Graph;
use super::operations::{Binary, Unary};
use super::program::{Op, Program};
use super::{Formula, build, derivative, statements};
use crate::field::{Field as _, gallery};

fn compiled(text: &str) -> Formula {
    Formula::as_written(text, &[]).unwrap_or_else(|error| panic!("{text}: {error:?}"))
}

fn operations(program: &Program) -> Vec<Op> {
    program.instructions.iter().map(|instruction| instruction.op).collect()
}

#[test]
fn equal_operations_are_computed_once() {
    let field = compiled("exp(x y + 1) + exp(1 + y x)^2 + z exp(y x + 1)");
    let exponentials =
        operations(&field.compiled.value_program).iter().filter(|op| **op == Op::Unary(Unary::Exp)).count();
    assert_eq!(exponentials, 1);
}

#[test]
fn constants_and_parameters_cost_nothing_per_point() {
    let field = compiled("x + 2*3^2 - sin(1) + a^2 exp(b)");
    assert_eq!(operations(&field.compiled.value_program), [Op::Uniform(Binary::Add)]);
    let field = compiled("3(2(a x)) + 1 + 2");
    assert_eq!(
        operations(&field.compiled.value_program),
        [Op::Uniform(Binary::Mul), Op::Uniform(Binary::Add)]
    );
}

#[test]
fn integer_powers_are_products() {
    for (text, most) in [("x^15", 6), ("x^-15", 8), ("x^64", 6), ("x^6 + x^5", 6)] {
        let field = compiled(text);
        let operations = operations(&field.compiled.value_program);
        assert!(operations.len() <= most, "{text}: {operations:?}");
        assert!(!operations.contains(&Op::Binary(Binary::Pow)), "{text}: {operations:?}");
        assert!(!operations.contains(&Op::Uniform(Binary::Pow)), "{text}: {operations:?}");
    }
}

#[test]
fn derivatives_hold_no_dead_operations() {
    // One sum for the value; the gradient is constant, and only put into registers.
    let field = compiled("x + y + z");
    let operations_of = |field: &Formula| operations(&field.compiled.gradient_program);
    assert_eq!(operations_of(&field).iter().filter(|op| **op != Op::Splat).count(), 2);
    // Three squares and three sums for the value. The gradient of a sphere is three products by 2,
    // and no product by a known zero or one.
    let field = compiled("x^2 + y^2 + z^2 - 1");
    assert_eq!(operations_of(&field).len(), 9);
}

#[test]
fn sine_and_cosine_of_one_angle_are_one_operation() {
    let field = gallery::find("gyroid").map(gallery::Surface::field).expect("the gallery has a gyroid");
    let operations = operations(&field.compiled.gradient_program);
    assert_eq!(operations.iter().filter(|op| **op == Op::SineCosine).count(), 3);
    assert!(!operations.contains(&Op::Unary(Unary::Sin)) && !operations.contains(&Op::Unary(Unary::Cos)));
}

#[test]
fn a_long_sum_needs_few_registers() {
    let terms: Vec<String> = (1..200).map(|k| format!("exp({k}x y)")).collect();
    let field = compiled(&terms.join("+"));
    assert!(field.compiled.value_program.registers <= 6, "{}", field.compiled.value_program.registers);
}

#[test]
fn a_forward_and_a_backward_sweep_give_the_same_gradient() {
    let point = [0.3, -0.7, 0.4];
    for surface in gallery::SURFACES.iter() {
        let declared = surface.parameters;
        let names: Vec<&str> = declared.iter().map(|parameter| &*parameter.name).collect();
        let values: Vec<f64> = declared.iter().map(|parameter| parameter.value).collect();
        let parsed = statements::parse(surface.formula, &names).expect("the gallery parses");
        let mut graph = Graph::default();
        let root = build::build(&mut graph, &parsed.equation, &names).expect("the gallery compiles");
        graph.let_zero_annihilate();
        let backward = derivative::backward(&mut graph, root);
        for axis in 0..3_u8 {
            let forward = derivative::forward(&mut graph, &[root], axis)[0];
            let mut results: Vec<f64> = Vec::new();
            for node in graph.nodes() {
                results.push(node.evaluate(&values, point, |id| results[id as usize]));
            }
            let (a, b) = (results[forward as usize], results[backward[usize::from(axis)] as usize]);
            assert!((a - b).abs() <= 1e-12 * (1.0 + a.abs()), "{} axis {axis}: {a} {b}", surface.id);
        }
    }
}

#[test]
fn periods_are_found_along_each_axis() {
    use core::f64::consts::{PI, TAU};
    let of = |text: &str| compiled(text).facts().periods;
    let close = |text: &str, wanted: [Option<f64>; 3]| {
        let found = of(text);
        for axis in 0..3 {
            let is_close = match (found[axis], wanted[axis]) {
                (Some(found), Some(wanted)) => (found - wanted).abs() < 1e-9,
                (found, wanted) => found == wanted,
            };
            assert!(is_close, "{text}: {found:?}");
        }
    };
    close("sin(x)cos(y)+sin(y)cos(z)+sin(z)cos(x)", [Some(TAU); 3]);
    close("cos(10x) + cos(4 y/2) = tan(z)/3", [Some(TAU / 10.0), Some(PI), Some(PI)]);
    // Half a period and a third of one come together after a whole one; phases and other axes
    // change nothing.
    close("sin(2x + y)^2 + exp(cos(3x - 1)) = 1", [Some(TAU), Some(TAU), Some(0.0)]);
    close("sin(-2 pi x) = max(cos(x - x + y), 0)", [Some(1.0), Some(TAU), Some(0.0)]);
    close("sin(sqrt(2) x) = cos(y/3)", [Some(TAU / core::f64::consts::SQRT_2), Some(3.0 * TAU), Some(0.0)]);
    // A parameter counts by its value, here 1.
    close("sin(k x) + sin(y) + sin(z)", [Some(TAU); 3]);
    // None of these come again: a plane, a factor that is not a number, a frequency that changes,
    // incommensurate ones.
    close("z = sin(x)", [Some(TAU), Some(0.0), None]);
    close("x sin(x) = 0", [None, Some(0.0), Some(0.0)]);
    close("sin(x y) = z - z", [None, None, Some(0.0)]);
    close("sin(x) + sin(sqrt(2) x) + sin(1.41x) = 0", [None, Some(0.0), Some(0.0)]);
    close("sin(x^2) = 0", [None, Some(0.0), Some(0.0)]);
}

#[test]
fn products_are_taken_apart_where_their_factors_may_cross() {
    let sphere = |x: f64, radius: f64| format!("((x - {x})^2 + y^2 + (z - a)^2 - {radius})");
    for (factors, may_cross) in [
        (vec![sphere(0.5, 1.0), sphere(0.5, 1.001)], false),
        (vec![sphere(0.5, 1.0), sphere(0.5, 1.001), sphere(0.5, 2.0)], false),
        (vec![sphere(0.5, 1.0), sphere(0.501, 1.0)], true),
        (vec![sphere(0.5, 1.0), sphere(0.5, 2.0), sphere(0.501, 1.0)], true),
        (vec!["(z - sin(x))".into(), "(sin(x) - z + b)".into()], true),
        (vec!["(z - sin(x))".into(), "(z - sin(x) - b)".into()], false),
    ] {
        let text = factors.join("*");
        let field = compiled(&text);
        assert_eq!(Branches::of_factors(&field.compiled, &field.values).is_some(), may_cross, "{text}");
    }
}
