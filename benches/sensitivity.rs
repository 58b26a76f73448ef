//! Figures of random surfaces. `cargo xtask sensitivity` builds this bench with one constant of the
//! sampler at a time halved and doubled, and compares the lines that it prints.
//!
//! Every surface is sampled by both methods and with sizes that differ. A line has the name of the
//! run, the digest of its particles, and its figures.

#[path = "../tests/it/settings.rs"]
#[macro_use]
mod settings;

use marching_particles::{Bounds, Formula, Method, Sampling, Settings, SizeMode, sample};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Surfaces of each kind.
const SURFACES: u64 = 10;
const COUNT: u32 = 3_000;

/// Random numbers for the coefficients of a formula.
struct Dice(Pcg32);

impl Dice {
    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * f64::from(self.0.next_u32()) / f64::from(u32::MAX)
    }

    /// A point within a cube, as the terms of a shift: "x-0.1", "y-0.2", "z-0.3".
    fn axes(&mut self, reach: f64) -> [String; 3] {
        ["x", "y", "z"].map(|axis| format!("({axis}-({:.3}))", self.between(-reach, reach)))
    }

    /// An ellipsoid with waves on it.
    fn bumpy(&mut self) -> String {
        let [a, b, c] = [(); 3].map(|()| self.between(0.6, 1.4));
        let (depth, wave) = (self.between(0.0, 0.12), self.between(2.0, 5.0));
        format!(
            "x^2/{a:.3}^2+y^2/{b:.3}^2+z^2/{c:.3}^2 = 1+{depth:.3}*sin({wave:.2}x)*sin({wave:.2}y)*cos({wave:.2}z)"
        )
    }

    /// Balls and a torus that are joined smoothly.
    fn blend(&mut self) -> String {
        let ball = |dice: &mut Self| {
            let [x, y, z] = dice.axes(0.7);
            format!("hypot({x},{y},{z})-{:.3}", dice.between(0.3, 0.7))
        };
        let [first, second] = [ball(self), ball(self)];
        let [x, y, z] = self.axes(0.4);
        let (major, minor) = (self.between(0.5, 0.9), self.between(0.15, 0.3));
        let torus = format!("hypot(hypot({x},{y})-{major:.3},{z})-{minor:.3}");
        format!("smin(smin({first},{second},0.4),{torus},0.3) = 0")
    }

    /// A sum of waves, which the box cuts.
    fn waves(&mut self) -> String {
        let mut term = |axes: [&str; 2]| {
            let [a, b] = axes;
            format!(
                "{:.3}*sin({:.2}{a})*cos({:.2}{b})",
                self.between(0.5, 1.0),
                self.between(1.5, 3.5),
                self.between(1.5, 3.5)
            )
        };
        let terms = [term(["x", "y"]), term(["y", "z"]), term(["z", "x"])].join("+");
        format!("{terms} = {:.3}", self.between(-0.2, 0.2))
    }

    /// A solid with sharp edges.
    fn sharp(&mut self) -> String {
        let [x, y, z] = self.axes(0.3);
        let [a, b, c] = [(); 3].map(|()| self.between(0.6, 1.1));
        let ball = self.between(1.0, 1.25);
        format!("max(max(abs({x})-{a:.3},abs({y})-{b:.3},abs({z})-{c:.3}),hypot(x,y,z)-{ball:.3}) = 0")
    }
}

/// A name, and a maker of formulas.
type Kind = (&'static str, fn(&mut Dice) -> String);

const KINDS: [Kind; 4] =
    [("bumpy", Dice::bumpy), ("blend", Dice::blend), ("waves", Dice::waves), ("sharp", Dice::sharp)];

/// A name, the method and how large particles are.
const METHODS: [(&str, Method, Sampling); 4] = [
    ("front", Method::Front, Sampling::Uniform),
    ("front, adaptive", Method::Front, Sampling::Adaptive),
    ("refined", Method::Refined, Sampling::Uniform),
    ("refined, adaptive", Method::Refined, Sampling::Adaptive),
];

fn main() {
    println!(
        "run\tdigest\tsix neighbours\tmean smallest angle\tclosest pair\tlargest hole\tcount\tevaluations"
    );
    for (kind, formula) in KINDS {
        for seed in 0..SURFACES {
            let text = formula(&mut Dice(Pcg32::seed_from_u64(seed)));
            let field = Formula::parse(&text).unwrap_or_else(|error| panic!("{text}: {error}"));
            for (name, method, sampling) in METHODS {
                let settings = settings!(size_mode: SizeMode::Count, count: COUNT, method, sampling;
                    ..Settings::default());
                let sampled = sample(&field, &settings.in_box(Bounds::cube(2.0)));
                let run = format!("{name}: {kind} {seed}");
                let report = match &sampled {
                    Ok(sample) => sample.report(),
                    Err(error) => {
                        println!("{run}\t{error}");
                        continue;
                    }
                };
                let Some(figures) = &report.measures.quality else { continue };
                println!(
                    "{run}\t{}\t{}\t{}\t{}\t{}\t{}\t{}",
                    report.digest,
                    figures.order.six_neighbours,
                    figures.angles.mean_smallest_angle,
                    figures.spacing.rho,
                    figures.coverage.cover,
                    report.count as f64 / f64::from(COUNT),
                    report.growth.evaluations_per_particle,
                );
            }
        }
    }
}
