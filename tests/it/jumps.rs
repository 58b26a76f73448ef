//! Surfaces that end where f jumps, and rims and crossings where f has no gradient: each is told as
//! what it is, once.

use crate::cases;
use marching_particles::Bounds;
use marching_particles::{Formula, Settings, Warning, sample};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// The warnings about a sample of this formula in a cube.
fn warnings(formula: &str, half: f64, count: u32) -> Vec<Warning> {
    let field = Formula::parse(formula).unwrap_or_else(|error| panic!("{formula}: {error}"));
    let settings = Settings::with_count(count).in_box(Bounds::cube(half));
    let sample = sample(field, &settings).unwrap_or_else(|error| panic!("{formula}: {error}"));
    let mut all = sample.report().warnings.clone();
    all.extend(sample.mesh_warnings());
    all
}

fn count_of(warnings: &[Warning], code: &str) -> usize {
    warnings.iter().filter(|warning| warning.code() == code).count()
}

#[test]
fn a_surface_that_ends_at_a_jump_is_told_once() {
    // The second one ends near an edge of the box alone.
    let mut formulas = vec![
        "z = 0.25 round(4 sin(x) sin(y))".to_owned(),
        "if(0.088 x - 0.076 y + 0.242 > 0, z, z - 0.96)".to_owned(),
    ];
    for seed in cases::seeds(40) {
        let random = &mut Pcg32::seed_from_u64(seed);
        let mut number = |from: f64, to: f64| {
            let share = f64::from(random.next_u32()) / f64::from(u32::MAX);
            from + (to - from) * share
        };
        let (a, b, c, height) = (number(-1.0, 1.0), number(-1.0, 1.0), number(-0.3, 0.3), number(0.5, 1.0));
        let plane = format!("{a}*x + {b}*y + {c}");
        formulas.push(match seed % 4 {
            0 => format!("z = {height}*floor(1.3*({plane}))"),
            1 => format!("if({plane} < 0, z, z - {height})"),
            2 => format!("x^2 + y^2 + z^2 + {height}*sign({plane}) = 1.7"),
            _ => format!("z + 0.2 x = {height}*step(0, {plane} + 0.3 sin(3 y))"),
        });
    }
    for formula in formulas {
        let warnings = warnings(&formula, 1.9, 900);
        let told: Vec<&str> = warnings.iter().map(Warning::code).collect();
        assert_eq!(count_of(&warnings, "jumps"), 1, "{formula}: {told:?}");
        for warning in &warnings {
            assert!(!warning.to_string().contains("choose a smaller"), "{formula}: {warning}");
        }
    }
    // As steep, but not a jump; and an end of another kind.
    for formula in ["z = 0.5 tanh(30(x + y))", "z = x^2 - y^2", "z = sqrt(x)", "x^2 + y^2 + z^2 = 1"] {
        assert_eq!(count_of(&warnings(formula, 1.9, 900), "jumps"), 0, "{formula}");
    }
}

#[test]
fn a_cusp_is_a_rim_and_a_crossing_crosses() {
    // The formula, and whether it has a rim, and a crossing or a touch.
    let kinds = [
        ("y^2*(1 - (x^2 + z^2)) - (x^2 + z^2 + 2*y - 1)^2 = 0", [true, false]),
        ("y^2 = x^3", [true, false]),
        ("(hypot(x, y) - 1)^3 = z^2", [true, false]),
        ("(x^2 + 2 y^2 + z^2 - 1)^3 = x^2", [true, false]),
        ("y^2 - x^2 + x^3 = 0", [false, true]),
        ("x^2 - 0.01 z^2 = 0.1 x^3", [false, true]),
        ("(x^2 + y^2 + z^2 - 1)^2 = 0.8 (x + 0.3 y)^2 - 1e-9 z", [false, true]),
        ("x^2 + y^2 + z^2 = 1", [false, false]),
    ];
    for (formula, [has_rim, meets]) in kinds {
        let warnings = warnings(formula, 1.6, 900);
        let told: Vec<&str> = warnings.iter().map(Warning::code).collect();
        let found = [count_of(&warnings, "rims") > 0, count_of(&warnings, "meets") > 0];
        assert_eq!(found, [has_rim, meets], "{formula}: {told:?}");
    }
}
