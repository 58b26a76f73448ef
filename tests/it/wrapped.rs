//! Formulas inside the calls with which other programs draw them, in other coordinates and in other
//! languages: each is refused, and what is suggested is the same function.

use crate::cases;
use marching_particles::field::Field;
use marching_particles::field::formula::Formula;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

const POINTS: [[f64; 3]; 4] = [[0.3, 0.7, 0.45], [-0.6, 0.25, 1.3], [1.4, -0.9, -0.35], [-2.3, -0.4, 0.8]];

/// A random expression, which is evaluated and written here.
enum Tree {
    Axis(usize),
    Number(f64),
    /// A constant that the text around the formula defines.
    Named(usize),
    Sum(Box<[Self; 2]>),
    Product(Box<[Self; 2]>),
    Square(Box<Self>),
    Call(usize, Box<Self>),
}

/// A name in most programs, one in Mathematica, and its function.
type Call = (&'static str, &'static str, fn(f64) -> f64);
/// Functions with their names in Mathematica.
const CALLS: [Call; 3] = [("sin", "Sin", libm::sin), ("cos", "Cos", libm::cos), ("abs", "Abs", f64::abs)];

fn below(random: &mut Pcg32, n: usize) -> usize {
    random.next_u32() as usize % n
}

fn number(random: &mut Pcg32) -> f64 {
    f64::from(random.next_u32() % 39 + 1) / 8.0
}

impl Tree {
    fn random(random: &mut Pcg32, axes: usize, depth: u32) -> Self {
        if depth == 0 {
            return match below(random, 6) {
                0 => Self::Number(number(random)),
                1 => Self::Named(below(random, 2)),
                axis => Self::Axis(axis % axes),
            };
        }
        let mut inner = || Self::random(random, axes, depth - 1);
        let two = [inner(), inner()];
        match below(random, 5) {
            0 | 1 => Self::Sum(Box::new(two)),
            2 => Self::Product(Box::new(two)),
            3 => Self::Square(Box::new(two.into_iter().next().expect("two"))),
            _ => {
                let call = below(random, CALLS.len());
                Self::Call(call, Box::new(two.into_iter().next().expect("two")))
            }
        }
    }

    fn value(&self, p: [f64; 3], named: [f64; 2]) -> f64 {
        match self {
            Self::Axis(k) => p[*k],
            Self::Number(number) => *number,
            Self::Named(k) => named[*k],
            Self::Sum(two) => two[0].value(p, named) + two[1].value(p, named),
            Self::Product(two) => two[0].value(p, named) * two[1].value(p, named),
            Self::Square(inner) => inner.value(p, named).powi(2),
            Self::Call(k, inner) => CALLS[*k].2(inner.value(p, named)),
        }
    }

    fn text(&self, axes: [&str; 3], is_mathematica: bool) -> String {
        let text = |inner: &Self| inner.text(axes, is_mathematica);
        match self {
            Self::Axis(k) => axes[*k].to_owned(),
            Self::Number(number) => number.to_string(),
            Self::Named(k) => ["A", "B"][*k].to_owned(),
            Self::Sum(two) => format!("{} + {}", text(&two[0]), text(&two[1])),
            Self::Product(two) => format!("({})*({})", text(&two[0]), text(&two[1])),
            Self::Square(inner) => format!("({})^2", text(inner)),
            Self::Call(k, inner) if is_mathematica => format!("{}[{}]", CALLS[*k].1, text(inner)),
            Self::Call(k, inner) => format!("{}({})", CALLS[*k].0, text(inner)),
        }
    }
}

/// What the parts of a text mean: the sides u and v with the coordinates of a point.
type Meaning = fn(u: f64, v: f64, z: f64) -> f64;

/// A call that draws a formula, in which «u» and «v» stand for expressions of these axes.
struct Wrapper {
    text: &'static str,
    is_mathematica: bool,
    axes: [&'static str; 3],
    /// Number of axes that vary.
    count: usize,
    meaning: Meaning,
}

const fn wrapper(text: &'static str, is_mathematica: bool, count: usize, meaning: Meaning) -> Wrapper {
    Wrapper { text, is_mathematica, axes: ["x", "y", "z"], count, meaning }
}

const fn named(wrapper: Wrapper, axes: [&'static str; 3]) -> Wrapper {
    Wrapper { axes, ..wrapper }
}

const SIDES: Meaning = |u, v, _| u - v;

/// Every text gives A the value 1.5 and B the value −0.25.
fn wrappers() -> Vec<Wrapper> {
    vec![
        wrapper("With[{A = 1.5, B = -0.25}, «u» == «v»]", true, 3, SIDES),
        wrapper("With[{A=1.5,B=-0.25},ContourPlot3D[«u»==«v»,{x,-2,2},{y,-2,2},{z,-2,2}]]", true, 3, SIDES),
        wrapper(
            "A = 1.5; B = -0.25;\nContourPlot3D[«u» == «v», {x, -2, 2}, {y, -2, 2}, {z, -2, 2}, PlotPoints -> 20, Mesh -> None]",
            true,
            3,
            SIDES,
        ),
        wrapper(
            "Show[ContourPlot3D[«u» == 0 /. {A -> 1.5, B -> -0.25}, {x, -2, 2}, {y, -2, 2}, {z, -2, 2}], Axes -> False]",
            true,
            3,
            |u, _, _| u,
        ),
        wrapper(
            "Block[{A = 1.5, B = -0.25}, ContourPlot3D[«u», {x, -2, 2}, {y, -2, 2}, {z, -2, 2}, Contours -> {0.5}]]",
            true,
            3,
            |u, _, _| u - 0.5,
        ),
        wrapper(
            "A = 1.5; B = -0.25; f[x_, y_, z_] := «u»; ContourPlot3D[f[x, y, z] == 0.5, {x, -2, 2}, {y, -2, 2}, {z, -2, 2}]",
            true,
            3,
            |u, _, _| u - 0.5,
        ),
        wrapper(
            "RegionPlot3D[«u» < «v» && z > -1 /. {A -> 1.5, B -> -0.25}, {x, -2, 2}, {y, -2, 2}, {z, -2, 2}]",
            true,
            3,
            |u, v, z| (u - v).max(-1.0 - z),
        ),
        named(
            wrapper(
                "With[{A = 1.5, B = -0.25}, ContourPlot3D[«u» == «v», {u, -2, 2}, {v, -2, 2}, {w, -2, 2}]]",
                true,
                3,
                SIDES,
            ),
            ["u", "v", "w"],
        ),
        wrapper("With[{A = 1.5, B = -0.25}, Plot3D[«u», {x, -2, 2}, {y, -2, 2}]]", true, 2, |u, _, z| {
            z - u
        }),
        wrapper(
            "A = 1.5; B = -0.25\nimplicit_plot3d(«u» == «v», (x,-3,3), (y,-3,3), (z,-3,3), color='red')",
            false,
            3,
            SIDES,
        ),
        wrapper(
            "var('x,y,z')\nA = 1.5\nB = -0.25\nf(x,y,z) = «u»\nP = implicit_plot3d(f, (x,-3,3), (y,-3,3), (z,-3,3), contour=2)\nP.show()",
            false,
            3,
            |u, _, _| u - 2.0,
        ),
        named(
            wrapper(
                "A = 1.5; B = -0.25; implicit_plot3d(lambda a, b, c: «u», (-3,3), (-3,3), (-3,3))",
                false,
                3,
                |u, _, _| u,
            ),
            ["a", "b", "c"],
        ),
        wrapper(
            "with(plots): A := 1.5: B := -0.25: implicitplot3d(«u» = «v», x=-2..2, y=-2..2, z=-2..2, grid=[20,20,20]);",
            false,
            3,
            SIDES,
        ),
        wrapper("A := 1.5; B := -0.25; plot3d(«u», x=-2..2, y=-2..2)", false, 2, |u, _, z| z - u),
        wrapper("A = 1.5; B = -0.25; fimplicit3(@(x,y,z) «u», [-5 5])", false, 3, |u, _, _| u),
        wrapper("A = 1.5; B = -0.25;\nf = @(x,y,z) «u»;\nfimplicit3(f)\naxis equal", false, 3, |u, _, _| u),
        wrapper(
            "A = 1.5; B = -0.25; [X,Y,Z] = meshgrid(-2:0.1:2); V = «u»; isosurface(X,Y,Z,V,0.5)",
            false,
            3,
            |u, _, _| u - 0.5,
        ),
        wrapper(
            "A = 1.5; B = -0.25; draw3d(enhanced3d=true, implicit(«u» = «v», x,-2,2, y,-2,2, z,-2,2))$",
            false,
            3,
            SIDES,
        ),
        wrapper(
            "A = 1.5; B = -0.25; isosurface { function { «u» } contained_by { sphere { 0, 2 } } threshold 0.5 }",
            false,
            3,
            |u, _, _| u - 0.5,
        ),
        wrapper("A = 1.5; B = -0.25; splot «u»", false, 2, |u, _, z| z - u),
        wrapper(
            "A = 1.5\nB = -0.25\ndef f(x, y, z):\n    return «u»\nfig = k3d.marching_cubes(f, level=0)",
            false,
            3,
            |u, _, _| u,
        ),
    ]
}

fn suggested(text: &str) -> String {
    let error = Formula::as_written(text, &[]).expect_err(text);
    assert!(error.message.starts_with("Type the formula alone"), "{text}: {error:?}");
    let mut mended = text.to_owned();
    mended.replace_range(error.span, &error.suggestion.unwrap_or_else(|| panic!("no suggestion for {text}")));
    mended
}

fn assert_same(text: &str, mended: &str, meaning: impl Fn([f64; 3]) -> f64) {
    let field = Formula::as_written(mended, &[]).unwrap_or_else(|error| panic!("{mended}: {error:?}"));
    for p in POINTS {
        let (found, wanted) = (field.value(p.into()), meaning(p));
        assert!(
            (found - wanted).abs() <= 1e-9 * (1.0 + wanted.abs()),
            "{text} at {p:?} as {mended}: {found}, not {wanted}"
        );
    }
}

#[test]
fn formulas_in_foreign_calls_are_suggested_alone() {
    for seed in cases::seeds(100) {
        let random = &mut Pcg32::seed_from_u64(seed);
        for Wrapper { text, is_mathematica, axes, count, meaning } in wrappers() {
            let [u, v] = [0, 1].map(|_| Tree::random(random, count, 3));
            // A formula without coordinates is no surface.
            let u = Tree::Sum(Box::new([u, Tree::Axis(0)]));
            let filled = text
                .replace("«u»", &u.text(axes, is_mathematica))
                .replace("«v»", &v.text(axes, is_mathematica));
            let named = [1.5, -0.25];
            let wanted = |p: [f64; 3]| meaning(u.value(p, named), v.value(p, named), p[2]);
            assert_same(&filled, &suggested(&filled), wanted);
        }
    }
}

#[test]
fn a_call_that_draws_no_formula_that_is_known_has_no_suggestion() {
    for text in [
        "implicit_plot3d(f, (x, -3, 3), (y, -3, 3), (z, -3, 3))",
        "SphericalPlot3D[1 + Cos[t], {t, 0, Pi}, {p, 0, 2 Pi}]",
        "ContourPlot3D[x^2 + y^2 == 1, {x, -2, 2}, {y, -2, 2}, {z, -2, 2}, RegionFunction -> Function[{x, y, z}, z > 0]]",
        "plot3d(1, x=0..2*Pi, y=0..Pi, coords=spherical)",
    ] {
        let error = Formula::as_written(text, &[]).expect_err(text);
        assert!(error.message.starts_with("Type the formula alone, without"), "{text}: {error:?}");
        assert_eq!((error.suggestion, error.choices.len(), error.mended), (None, 0, None), "{text}");
    }
    let several = "ContourPlot3D[{x == 0, y == 1}, {x, -2, 2}, {y, -2, 2}, {z, -2, 2}]";
    let error = Formula::as_written(several, &[]).expect_err(several);
    assert_eq!(error.choices.to_vec(), ["x = 0", "y = 1"]);
    // The level is to be filled in.
    let open = "ContourPlot3D[x^2 + y^2, {x, -2, 2}, {y, -2, 2}, {z, -2, 2}]";
    let error = Formula::as_written(open, &[]).expect_err(open);
    assert_eq!(error.suggestion.as_deref(), Some("x^2 + y^2 = …"));
}

#[test]
fn the_imaginary_unit_is_no_slider() {
    for (text, name) in [
        ("(x - 1/2) + hypot(y, z)*i", "i"),
        ("x^2 + I y", "I"),
        ("1i*x + y", "i"),
        ("2j*x + y", "j"),
        ("%i*x + y", "i"),
        ("x + 2*%i*y = z", "i"),
    ] {
        let error = Formula::as_written(text, &[]).expect_err(text);
        assert!(error.message.starts_with("Complex numbers are not read"), "{text}: {error:?}");
        assert_eq!((error.name.as_deref(), error.suggestion), (Some(name), None), "{text}");
    }
    // A name that is defined, or an index, is any other name.
    for text in ["i = 2; x + i", "x + i_1", "j x + y", "x + a_i"] {
        assert!(Formula::as_written(text, &[]).is_ok(), "{text}");
    }
    assert_same("%pi", "2*%pi*x + %e^y", |[x, y, _]| core::f64::consts::TAU * x + libm::exp(y));
    assert_same("\\[Pi]", "\\[Pi] x + Pi y", |[x, y, _]| core::f64::consts::PI * (x + y));
    // Of MATLAB.
    assert_same("%", "%pi is great\nx + y", |[x, y, _]| x + y);
}

#[test]
fn equations_in_other_coordinates_are_suggested_in_x_y_and_z() {
    fn around([x, y, _]: [f64; 3]) -> f64 {
        libm::atan2(y, x)
    }
    fn from_axis([x, y, z]: [f64; 3]) -> f64 {
        libm::atan2(libm::hypot(x, y), z)
    }
    fn axis([x, y, _]: [f64; 3]) -> f64 {
        libm::hypot(x, y)
    }
    fn origin([x, y, z]: [f64; 3]) -> f64 {
        (x * x + y * y + z * z).sqrt()
    }
    type Of = fn([f64; 3]) -> f64;
    // The radius, the names of the angles in u and v, and what they are.
    let kinds: [(&str, [&str; 2], Of, [Of; 2]); 7] = [
        ("r", ["theta", "theta"], axis, [around, around]),
        ("r", ["θ", "θ"], axis, [around, around]),
        ("r", ["phi", "phi"], axis, [around, around]),
        ("r", ["t", "t"], axis, [around, around]),
        ("r", ["theta", "phi"], origin, [from_axis, around]),
        ("rho", ["theta", "phi"], origin, [around, from_axis]),
        ("ρ", ["θ", "φ"], origin, [around, from_axis]),
    ];
    for seed in cases::seeds(100) {
        let random = &mut Pcg32::seed_from_u64(seed);
        for (radius, [u, v], of_radius, [of_u, of_v]) in kinds {
            let (a, b, n) = (number(random), number(random), 1 + below(random, 6));
            let text = format!("{radius} = {a} + {b}*sin {n}{u} cos {v}^2 + {radius}*{u}/9");
            let error = Formula::as_written(&text, &[]).expect_err(&text);
            assert!(error.message.contains("coordinates are written by x, y and z"), "{text}: {error:?}");
            let mended = error.suggestion.unwrap_or_else(|| panic!("no suggestion for {text}"));
            assert_same(&text, &mended, |p| {
                let (r, u, v) = (of_radius(p), of_u(p), of_v(p));
                r - (a + b * libm::sin(n as f64 * u) * libm::cos(v * v) + r * u / 9.0)
            });
        }
    }
    let error = Formula::as_written("r = 2", &[]).expect_err("a radius");
    assert_eq!(error.choices.to_vec(), ["hypot(x, y, z) = 2", "hypot(x, y) = 2"]);
    // A slider would leave nothing that changes with x, y or z.
    assert_eq!(error.name, None);
    assert_eq!(Formula::as_written("r = 2cos(3θ)", &[]).expect_err("polar").name, None);
    let error = Formula::as_written("z = r^2 cos(2 theta)", &[]).expect_err("cylindrical");
    assert_eq!(error.suggestion.as_deref(), Some("z = hypot(x, y)^2 cos(2 atan2(y, x))"));
    // Sliders of these names.
    for text in
        ["x^2 + y^2 = r^2", "x cos(theta) + y sin(theta) = z", "z = r", "x = phi", "r = hypot(x, y); r = 2"]
    {
        assert!(Formula::as_written(text, &[]).is_ok(), "{text}");
    }
}

#[test]
fn paths_and_functions_with_bodies_are_refused_with_what_to_do() {
    for text in [
        "(cos(u), sin(u), v)",
        "x = cos(u), y = sin(u), z = v",
        "x = cos(u); y = sin(u); z = v",
        "x = cos(u)\ny = sin(u)\nz = v",
        "x(u,v) = u; y(u,v) = v; z(u,v) = u*v",
        "f(u, v) = (u, v, u*v)",
        "r(u, v) = [u, v, u*v]",
        "ParametricPlot3D[{Cos[u], Sin[u], v}, {u, 0, 2 Pi}, {v, 0, 1}]",
        "plot3d([cos(u), sin(u), v], u=0..2*Pi, v=0..1)",
        "(2 + cos v) cos u, (2 + cos v) sin u, sin v",
        "x=cos(t) y=sin(t) z=t",
        "x(t) = t",
        "y(u, v) = u cos(v)",
    ] {
        let error = Formula::as_written(text, &[]).expect_err(text);
        assert!(error.message.contains("not surfaces or curves given by parameters"), "{text}: {error:?}");
        assert_eq!((error.suggestion, error.mended), (None, None), "{text}");
    }
    for text in ["1,5", "x, y, z", "x = y = z", "a, b, 2"] {
        let error = Formula::as_written(text, &[]).expect_err(text);
        assert!(!error.message.contains("given by parameters"), "{text}: {error:?}");
    }
    // Products.
    for text in ["x(a) = y", "x(a) = 1", "x(y) = a", "x(a + b) = a b", "z(x) = x"] {
        assert!(Formula::as_written(text, &[]).is_ok(), "{text}");
    }
    for (text, head) in [
        ("float h(vec3 i){ return length(i) - 1.0; }", "float h(vec3 i)"),
        ("float a = 1.0;\nfloat sdf(vec3 p) {\n  return length(p) - a;\n}", "float sdf(vec3 p)"),
        ("fn map(p: vec3f) -> f32 { return length(p) - 1.0; }", "fn map(p: vec3f) -> f32"),
        ("function f(x, y, z) { return x*x + y*y - z; }", "function f(x, y, z)"),
    ] {
        let error = Formula::as_written(text, &[]).expect_err(text);
        assert!(error.message.contains("body in braces"), "{text}: {error:?}");
        assert_eq!((&text[error.span.clone()], error.suggestion), (head, None), "{text}");
    }
}

#[test]
fn definitions_that_nothing_uses_are_told() {
    for seed in cases::seeds(200) {
        let random = &mut Pcg32::seed_from_u64(seed);
        let count = 1 + below(random, 6);
        // Each definition uses some of those before it, the surface some of all.
        let uses: Vec<Vec<usize>> =
            (0..=count).map(|k| (0..k).filter(|_| below(random, 3) == 0).collect()).collect();
        let sum = |k: usize| uses[k].iter().map(|j| format!(" + d_{j}")).collect::<String>();
        let definitions: String = (0..count).map(|k| format!("d_{k} = {k} + x{}; ", sum(k))).collect();
        let text = format!("{definitions}x^2 + y^2 + z^2 = 9{}", sum(count));
        let mut used = vec![false; count + 1];
        used[count] = true;
        for k in (0..=count).rev() {
            if used[k] {
                uses[k].iter().for_each(|&j| used[j] = true);
            }
        }
        let unused: Vec<String> = (0..count).filter(|&k| !used[k]).map(|k| format!("d_{k}")).collect();
        let field = Formula::as_written(&text, &[]).expect("a formula").for_sampling();
        assert_eq!(field.facts().unused, unused, "{text}");
    }
}
