//! Formulas as people have them at hand: from papers, from programs in four languages, and typed as
//! on paper. Each is read as it is meant, or refused with words that say what to do; none is taken
//! for another surface.

use Reading::{As, Mended, Refused};
use marching_particles::field::Field;
use marching_particles::field::formula::Formula;

type Meaning = fn(f64, f64, f64) -> f64;

/// What becomes of a formula.
enum Reading {
    /// It has this meaning; parameters are 1.
    As(Meaning),
    /// It is refused, and has this meaning once the suggestions are taken.
    Mended(Meaning),
    /// It is refused with these words.
    Refused(&'static str),
}

const POINTS: [[f64; 3]; 5] =
    [[0.3, 0.7, 0.45], [-0.6, 0.25, 1.3], [1.4, -0.9, -0.35], [0.05, 1.7, -1.1], [-2.3, -0.4, 0.8]];

fn hypot(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

fn length(x: f64, y: f64, z: f64) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

fn sphere(x: f64, y: f64, z: f64) -> f64 {
    x * x + y * y + z * z - 1.0
}

fn torus(x: f64, y: f64, z: f64) -> f64 {
    (hypot(x, y) - 1.0).powi(2) + z * z - 0.1
}

fn heart(x: f64, y: f64, z: f64) -> f64 {
    (x * x + 2.25 * y * y + z * z - 1.0).powi(3) - x * x * z.powi(3) - 0.1125 * y * y * z.powi(3)
}

fn gyroid(x: f64, y: f64, z: f64) -> f64 {
    let (sin, cos) = (libm::sin, libm::cos);
    sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x)
}

fn cosines(x: f64, y: f64, z: f64) -> f64 {
    libm::cos(x) + libm::cos(y) + libm::cos(z)
}

fn cube(x: f64, y: f64, z: f64) -> f64 {
    x.abs().max(y.abs()).max(z.abs()) - 1.0
}

fn remainder(x: f64, y: f64) -> f64 {
    x - y * (x / y).floor()
}

fn ring(x: f64, y: f64, z: f64) -> f64 {
    hypot(hypot(x, z) - 1.0, y) - 0.25
}

const LATEX: &[(&str, Reading)] = &[
    ("x^2+y^2+z^2=1", As(sphere)),
    ("\\left(\\sqrt{x^2+y^2}-1\\right)^2+z^2=\\frac{1}{10}", As(torus)),
    ("\\left(x^2+\\frac{9}{4}y^2+z^2-1\\right)^3-x^2z^3-\\frac{9}{80}y^2z^3=0", As(heart)),
    ("\\sin x\\cos y+\\sin y\\cos z+\\sin z\\cos x=0", As(gyroid)),
    ("\\cos x+\\cos y+\\cos z=0", As(cosines)),
    ("\\frac{x^2}{4}+\\frac{y^2}{9}-z^2=1", As(|x, y, z| x * x / 4.0 + y * y / 9.0 - z * z - 1.0)),
    (
        "4(\\varphi^2x^2-y^2)(\\varphi^2y^2-z^2)(\\varphi^2z^2-x^2)-(1+2\\varphi)(x^2+y^2+z^2-1)^2=0",
        As(|x, y, z| {
            let phi = f64::midpoint(1.0, 5_f64.sqrt());
            let (x, y, z) = (x * x, y * y, z * z);
            let p = phi * phi;
            4.0 * (p * x - y) * (p * y - z) * (p * z - x) - (1.0 + 2.0 * phi) * (x + y + z - 1.0).powi(2)
        }),
    ),
    (
        "x^4+y^4+z^4-5(x^2+y^2+z^2)+11.8=0",
        As(|x, y, z| x.powi(4) + y.powi(4) + z.powi(4) - 5.0 * (x * x + y * y + z * z) + 11.8),
    ),
    (
        "\\begin{equation}\n  (x^2+y^2+z^2+R^2-r^2)^2 = 4R^2(x^2+y^2)\n\\end{equation}",
        As(|x, y, z| (x * x + y * y + z * z).powi(2) - 4.0 * (x * x + y * y)),
    ),
    (
        "\\left|x\\right|^{2/3}+\\left|y\\right|^{2/3}+\\left|z\\right|^{2/3}=1",
        As(|x, y, z| [x, y, z].map(|a| libm::pow(a.abs(), 2.0 / 3.0)).iter().sum::<f64>() - 1.0),
    ),
    ("z=\\ln\\frac{\\cos x}{\\cos y}", As(|x, y, z| z - libm::log(libm::cos(x) / libm::cos(y)))),
    ("\\sqrt{x^2+y^2}=\\cosh z", As(|x, y, z| hypot(x, y) - libm::cosh(z))),
    ("x\\sin z=y\\cos z", As(|x, y, z| x * libm::sin(z) - y * libm::cos(z))),
    (
        "$$x^3+y^3+z^3+1=(x+y+z+1)^3$$",
        As(|x, y, z| x.powi(3) + y.powi(3) + z.powi(3) + 1.0 - (x + y + z + 1.0).powi(3)),
    ),
    ("\\max\\left\\{|x|,|y|,|z|\\right\\}=1", As(cube)),
    ("e^{-x^2-y^2-z^2}=\\tfrac12", As(|x, y, z| libm::exp(-x * x - y * y - z * z) - 0.5)),
    (
        "x^2y^2+y^2z^2+z^2x^2-2xyz=0",
        As(|x, y, z| x * x * y * y + y * y * z * z + z * z * x * x - 2.0 * x * y * z),
    ),
    ("\\sin z=\\sinh x\\,\\sinh y", As(|x, y, z| libm::sin(z) - libm::sinh(x) * libm::sinh(y))),
    (
        "\\begin{align} x^4 + 2x^2y^2 &+ y^4 \\\\\n &- z^2 = 0 \\end{align}",
        As(|x, y, z| (x * x + y * y).powi(2) - z * z),
    ),
    ("z = \\log(x^2+y^2)", Refused("`log10` and `log2`")),
];

const MATLAB: &[(&str, Reading)] = &[
    ("x.^2 + y.^2 + z.^2 - 1", As(sphere)),
    ("f = @(x,y,z) (sqrt(x.^2+y.^2)-1).^2 + z.^2 - 0.1;", As(torus)),
    ("(x.^2+(9/4).*y.^2+z.^2-1).^3-x.^2.*z.^3-(9/80).*y.^2.*z.^3", As(heart)),
    ("% heart\nf = (x.^2 + 9/4*y.^2 + z.^2 - 1).^3 - x.^2.*z.^3 - 9/80*y.^2.*z.^3;", As(heart)),
    ("F = sin(x).*cos(y) + sin(y).*cos(z) + sin(z).*cos(x);", As(gyroid)),
    ("V = cos(x)+cos(y)+cos(z);", As(cosines)),
    ("max(max(abs(x),abs(y)),abs(z)) - 1", As(cube)),
    ("r = sqrt(x.^2+y.^2);\nf = (r-1).^2 + z.^2 - 0.1;", As(torus)),
    (
        "v = exp(-((x-1).^2+y.^2+z.^2)) + exp(-((x+1).^2+y.^2+z.^2)) - 0.5;",
        As(|x, y, z| {
            let ball = |x: f64| libm::exp(-(x * x + y * y + z * z));
            ball(x - 1.0) + ball(x + 1.0) - 0.5
        }),
    ),
    ("mod(x,2) - 1 + y", As(|x, y, _| remainder(x, 2.0) - 1.0 + y)),
    (
        "abs(x).^0.8+abs(y).^0.8+abs(z).^0.8-1",
        As(|x, y, z| [x, y, z].map(|a| libm::pow(a.abs(), 0.8)).iter().sum::<f64>() - 1.0),
    ),
    ("x.^2 + y.^2 ... the sphere\n  + z.^2 - 1", As(sphere)),
    ("hypot(x,y) - cosh(z)", As(|x, y, z| hypot(x, y) - libm::cosh(z))),
    ("z - atan2(y,x)", As(|x, y, z| z - libm::atan2(y, x))),
    ("x.^2./4 + y.^2./9 + z.^2 - 1", As(|x, y, z| x * x / 4.0 + y * y / 9.0 + z * z - 1.0)),
    ("2.^x - y.*z + 1e-3", As(|x, y, z| libm::pow(2.0, x) - y * z + 1e-3)),
    ("norm([x y z]) - 1", Refused("There are no vectors")),
    ("(x.^2+y.^2 < 1).*z", Refused("`if(x < 1, a, b)`")),
    ("[x,y,z] = meshgrid(-2:0.1:2); v = x.^2+y.^2+z.^2-1;", Refused("the last statement is the surface")),
    ("fimplicit3(@(x,y,z) x.^2+y.^2-z.^2)", Refused("Type the formula alone")),
];

const PYTHON: &[(&str, Reading)] = &[
    ("x**2 + y**2 + z**2 - 1", As(sphere)),
    ("np.sin(x)*np.cos(y) + np.sin(y)*np.cos(z) + np.sin(z)*np.cos(x)", As(gyroid)),
    ("f = lambda x, y, z: (np.sqrt(x**2 + y**2) - 1)**2 + z**2 - 0.1", As(torus)),
    ("def f(x, y, z):\n    return x**2 + y**2 + z**2 - 1", As(sphere)),
    (
        "def torus(x, y, z):\n    r = np.hypot(x, y)  # from the axis\n    return (r - 1)**2 + z**2 - 0.1",
        As(torus),
    ),
    ("import numpy as np\nf = np.cos(x) + np.cos(y) + np.cos(z)", As(cosines)),
    ("math.sqrt(x*x + y*y + z*z) - 1.0", As(|x, y, z| length(x, y, z) - 1.0)),
    ("np.maximum(np.abs(x), np.maximum(np.abs(y), np.abs(z))) - 1", As(cube)),
    ("np.linalg.norm([x, y, z]) - 1", As(|x, y, z| length(x, y, z) - 1.0)),
    ("(x**2 + 9/4*y**2 + z**2 - 1)**3 - x**2*z**3 - 9/80*y**2*z**3", As(heart)),
    ("np.where(x < 0, z - 1, z + 1)", As(|x, _, z| if x < 0.0 { z - 1.0 } else { z + 1.0 })),
    ("np.clip(x, -1, 1) - y", As(|x, y, _| x.clamp(-1.0, 1.0) - y)),
    ("sp.Abs(x) + sp.Abs(y) + sp.Abs(z) - 1", As(|x, y, z| x.abs() + y.abs() + z.abs() - 1.0)),
    ("x % 1 - 0.5 + y", As(|x, y, _| remainder(x, 1.0) - 0.5 + y)),
    ("np.log(x**2 + y**2 + 1) - z", As(|x, y, z| libm::log(x * x + y * y + 1.0) - z)),
    (
        "min(x**2 + y**2 + z**2 - 1, (x - 1)**2 + y**2 + z**2 - 0.5)",
        As(|x, y, z| sphere(x, y, z).min((x - 1.0).powi(2) + y * y + z * z - 0.5)),
    ),
    ("x**2 // 4", Refused("floor(a/b)")),
    ("1 if x > 0 else -1", Refused("if(c, a, b)")),
    ("p[0]**2 + p[1]**2 + p[2]**2 - 1", Refused("There are no vectors")),
    ("torch.sigmoid(x) - y", Refused("define it first")),
];

const GLSL: &[(&str, Reading)] = &[
    ("length(vec3(x, y, z)) - 1.0", As(|x, y, z| length(x, y, z) - 1.0)),
    ("float d = length(vec3(x,y,z)) - 1.0;", As(|x, y, z| length(x, y, z) - 1.0)),
    ("max(abs(x), max(abs(y), abs(z))) - 1.0f", As(cube)),
    ("float q = length(vec2(x, z)) - 1.0; return length(vec2(q, y)) - 0.25;", As(ring)),
    ("length(vec2(length(p.xz)-1.0,p.y))-0.25", Mended(ring)),
    ("min(length(vec3(x,y,z))-1.0, y+0.5)", As(|x, y, z| (length(x, y, z) - 1.0).min(y + 0.5))),
    ("mix(x, y, 0.25) - z", As(|x, y, z| 0.75 * x + 0.25 * y - z)),
    (
        "smoothstep(0.0, 1.0, x) - z",
        As(|x, _, z| {
            let t = x.clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t) - z
        }),
    ),
    ("mod(x, 2.0) - 1.0 + y", As(|x, y, _| remainder(x, 2.0) - 1.0 + y)),
    ("fract(x) - 0.5 + y*z", As(|x, y, z| x - x.floor() - 0.5 + y * z)),
    ("x > 0.0 && y > 0.0 ? z : x - 3.0", As(|x, y, z| if x > 0.0 && y > 0.0 { z } else { x - 3.0 })),
    ("clamp(x, -1.0, 1.0) + y*y - z", As(|x, y, z| x.clamp(-1.0, 1.0) + y * y - z)),
    ("step(0.25, x) + y", As(|x, y, _| if x < 0.25 { y } else { 1.0 + y })),
    (
        "sign(x)*pow(abs(x), 1.5) + y*y + z*z - 1.",
        As(|x, y, z| x.signum() * libm::pow(x.abs(), 1.5) + y * y + z * z - 1.0),
    ),
    (
        "const float R = 1.0;\nconst float r = 0.3;\nfloat a = sqrt(x*x+y*y)-R; // from the circle\nreturn a*a+z*z-r*r;",
        As(|x, y, z| (hypot(x, y) - 1.0).powi(2) + z * z - 0.09),
    ),
    (
        "float h = clamp(0.5 + 0.5*(y-x)/0.3, 0.0, 1.0);\nfloat d = mix(y, x, h) - 0.3*h*(1.0-h);\nreturn d;",
        As(|x, y, _| {
            let h = (0.5 + 0.5 * (y - x) / 0.3).clamp(0.0, 1.0);
            y * (1.0 - h) + x * h - 0.3 * h * (1.0 - h)
        }),
    ),
    (
        "float d = length(vec3(x,y,z)) - 1.0; d = max(d, -y); return d;",
        As(|x, y, z| (length(x, y, z) - 1.0).max(-y)),
    ),
    ("atan(y, x) - z", As(|x, y, z| libm::atan2(y, x) - z)),
    ("dot(p, p) - 1.0", Mended(sphere)),
    ("sdSphere(p, 1.0)", Refused("define it before the surface")),
];

const HAND: &[(&str, Reading)] = &[
    ("sinxsiny = z", Mended(|x, y, z| libm::sin(x) * libm::sin(y) - z)),
    ("x²+y²+z²=1", As(sphere)),
    ("(x^2+9/4y^2+z^2-1)^3-x^2z^3-9/80y^2z^3=0", As(heart)),
    ("z = 1/2x^2 + 1/3 y^2", As(|x, y, z| z - (0.5 * x * x + y * y / 3.0))),
    ("z = xy", As(|x, y, z| z - x * y)),
    ("x^2/a^2 + y^2/b^2 + z^2/c^2 = 1", As(sphere)),
    ("|x|+|y|+|z|=1", As(|x, y, z| x.abs() + y.abs() + z.abs() - 1.0)),
    ("r=hypot(x,y); (r-1)^2+z^2=0.1", As(torus)),
    ("sin x cos y + sin y cos z + sin z cos x = 0", As(gyroid)),
    ("0,5x + 1,5z = 0", Mended(|x, _, z| 0.5 * x + 1.5 * z)),
    ("max(abs(x)-1,abs(y)-1,3-z)", As(|x, y, z| (x.abs() - 1.0).max(y.abs() - 1.0).max(3.0 - z))),
    ("x2+y2+z2=1", Mended(sphere)),
    ("cot(x)=yz", As(|x, y, z| 1.0 / libm::tan(x) - y * z)),
    ("y = sec x", As(|x, y, _| y - 1.0 / libm::cos(x))),
    ("z=cosh(sqrt(x^2+y^2))", As(|x, y, z| z - libm::cosh(hypot(x, y)))),
    ("f(x,y,z) = x^2\n + y^2\n + z^2 - 1", As(sphere)),
    ("f(t) = t^2; f(x) + f(y) + f(z) = 1", As(sphere)),
    ("log(x)=y", Refused("`ln` is the natural one")),
    ("x/2y = z", Refused("`/(2 y)` or `/2*y`")),
    ("w = x^2+y^2+z^2-1", Mended(sphere)),
];

/// The formula with its suggestions taken.
fn mended(text: &str) -> String {
    let mut text = text.to_owned();
    for _ in 0..8 {
        let Err(error) = Formula::as_written(&text, &[]) else { break };
        match (error.mended, error.suggestion) {
            (Some(mended), _) => text = mended.text,
            (None, Some(suggestion)) => text.replace_range(error.span, &suggestion),
            (None, None) => break,
        }
    }
    text
}

fn check(text: &str, meaning: Meaning) {
    let field = Formula::as_written(text, &[]).unwrap_or_else(|error| panic!("{text}: {error:?}"));
    for [x, y, z] in POINTS {
        let (found, wanted) = (field.jet([x, y, z].into()).value, meaning(x, y, z));
        let is_same =
            (found - wanted).abs() <= 1e-12 * (1.0 + wanted.abs()) || found.is_nan() && wanted.is_nan();
        assert!(is_same, "{text} at {x}, {y}, {z} is {found}, not {wanted}: {}", field.normal_form());
    }
}

#[test]
fn a_hundred_pasted_formulas_are_read_as_meant_or_refused_with_advice() {
    let sources =
        [("LaTeX", LATEX), ("MATLAB", MATLAB), ("Python", PYTHON), ("GLSL", GLSL), ("by hand", HAND)];
    let (mut read, mut all) = (0, 0);
    for (source, formulas) in sources {
        assert_eq!(formulas.len(), 20, "{source}");
        let mut of_source = 0;
        for (text, reading) in formulas {
            let refusal = Formula::as_written(text, &[]).err();
            match (reading, &refusal) {
                (As(meaning), _) => {
                    check(text, *meaning);
                    of_source += 1;
                }
                (Mended(meaning), Some(_)) => check(&mended(text), *meaning),
                (Refused(words), Some(error)) => assert!(error.message.contains(words), "{text}: {error:?}"),
                (Mended(_) | Refused(_), None) => panic!("{text} is accepted"),
            }
        }
        println!("{source}: {of_source} of 20 are read as meant, the others are refused with advice");
        (read, all) = (read + of_source, all + formulas.len());
    }
    println!("{read} of {all} are read as meant");
    assert!(all == 100 && read >= 80, "{read} of {all}");
}
