//! Particles that follow a moving surface, beside fresh runs: the table of `docs/results.md`.
//!
//! `cargo bench -p benches --bench flow > docs/tables/flow.md` moves each surface through a hundred
//! frames with 5,000 and with 20,000 particles, of fronts and of refined runs, and with 5,000 of a
//! refined run whose sizes follow the curvature. `--count N` takes another number of particles;
//! `--front` and `--refined` run one of the two; `--adaptive` lets all sizes follow the curvature;
//! `--random N` moves N random surfaces instead, which were used to choose the constants of the
//! flow. Then `UPDATE_GOLDEN=1 cargo test --test it docs::` writes the summary in
//! `docs/results.md`.
#![allow(clippy::disallowed_methods, reason = "a bench measures time")]

use marching_particles::Bounds;
use marching_particles::field::formula::Formula;
use marching_particles::quality::Figures;
use marching_particles::{Method, Run, Sampling, Settings, SizeMode};
use rand_core::Rng;
use rand_pcg::Pcg32;
use std::borrow::Cow;
use std::f64::consts::{PI, TAU};
use std::time::Instant;

#[path = "../tests/it/settings.rs"]
#[macro_use]
mod settings;

/// Numbers of particles.
const COUNTS: [u32; 2] = [5_000, 20_000];
const FRAMES: u32 = 100;
/// Frames from one comparison to the next, of one size and of sizes that differ.
const COMPARED_EVERY: [u32; 2] = [25, 50];

/// A surface, the parameter `q` that moves it, and the half-width of the box.
struct Sweep {
    name: Cow<'static, str>,
    formula: Cow<'static, str>,
    from: f64,
    to: f64,
    half: f64,
}

const fn sweep(name: &'static str, formula: &'static str, [from, to]: [f64; 2], half: f64) -> Sweep {
    Sweep { name: Cow::Borrowed(name), formula: Cow::Borrowed(formula), from, to, half }
}

/// A level set of three waves, each of which runs at a speed of its own.
fn random_sweep(seed: u64) -> Sweep {
    let mut random = Pcg32::new(seed, 0);
    let mut within = |most: f64| most * (f64::from(random.next_u32()) / f64::from(u32::MAX) * 2.0 - 1.0);
    let waves: Vec<String> = (0..3)
        .map(|_| {
            let [x, y, z] = [(); 3].map(|()| within(3.0));
            let [phase, speed] = [PI, 1.5].map(&mut within);
            format!("sin({x:.3}*x+{y:.3}*y+{z:.3}*z+{phase:.3}+{speed:.3}*q)")
        })
        .collect();
    let formula = format!("{}+{:.3}+{:.3}*q", waves.join("+"), within(0.8), within(0.5));
    Sweep { name: format!("`{formula}`").into(), formula: formula.into(), from: 0.0, to: 1.0, half: 1.5 }
}

const TANGLECUBE: &str = "x^4+y^4+z^4-5*(x^2+y^2+z^2)+q";
const SWEEPS: [Sweep; 12] = [
    sweep("ellipsoid grows", "x^2/q^2+y^2/0.49+z^2/0.25-1", [1.0, 1.6], 1.8),
    sweep("ellipsoid shrinks", "x^2/q^2+y^2/0.49+z^2/0.25-1", [1.6, 0.8], 1.8),
    sweep("ellipsoid turns", "(x*cos(q)+y*sin(q))^2+3*(y*cos(q)-x*sin(q))^2+3*z^2-1", [0.0, PI], 1.2),
    sweep("tanglecube splits", TANGLECUBE, [11.0, 14.5], 2.6),
    sweep("tanglecube joins", TANGLECUBE, [14.5, 11.0], 2.6),
    sweep("torus thickens", "(sqrt(x^2+y^2)-1)^2+z^2-q^2", [0.2, 0.5], 1.6),
    sweep("gyroid shifts its level", "sin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x)-q", [-0.8, 0.8], 3.2),
    sweep("gyroid slides through the box", "sin(x+q)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x+q)", [0.0, PI], 3.2),
    sweep("sphere leaves the box", "(x-q)^2+y^2+z^2-0.36", [0.0, 1.2], 1.0),
    sweep("sphere comes into the box", "(x-q)^2+y^2+z^2-0.36", [1.4, 0.0], 1.0),
    sweep(
        "a second sphere is born",
        "exp(-4*((x+0.6)^2+y^2+z^2))+q*exp(-4*((x-0.6)^2+y^2+z^2))-0.4",
        [0.3, 1.0],
        1.5,
    ),
    sweep("waves roll", "z-0.3*sin(3*x+q)*cos(3*y)", [0.0, TAU], 1.5),
];

fn finish(run: &mut Run<'_, Formula>) {
    while run.step(u32::MAX).stop_reason.is_none() {}
}

/// Text above the tables.
const HEAD: &str = "\
# Particles that follow a moving surface: all figures

Written by `cargo bench -p benches --bench flow > docs/tables/flow.md`. [Results](../results.md#moving-surfaces) explains the columns.
";

const COLUMNS: &str = "\
| Sweep | Frame | Count / fresh | Six neighbours | Largest hole | Closest pair | Still the first | Components | Euler number | ns a particle | Fresh / frame |
| --- | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: |";

fn main() {
    let (mut counts, mut sampling, mut sweeps) = (Vec::new(), Sampling::Uniform, Vec::from(SWEEPS));
    let mut methods = vec![Method::Front, Method::Refined];
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut number = || -> u32 {
            arguments.next().and_then(|number| number.parse().ok()).expect("a number after the option")
        };
        match argument.as_str() {
            "--front" => methods = vec![Method::Front],
            "--refined" => methods = vec![Method::Refined],
            "--count" => counts.push(number()),
            "--adaptive" => sampling = Sampling::Adaptive,
            "--random" => sweeps = (0..u64::from(number())).map(random_sweep).collect(),
            // From cargo.
            "--bench" => {}
            unknown => panic!("unknown option {unknown}"),
        }
    }
    if counts.is_empty() {
        counts.extend(COUNTS);
    }
    let all = methods.iter().flat_map(|&method| counts.iter().map(move |&count| (method, sampling, count)));
    let mut parts: Vec<(Method, Sampling, u32)> = all.collect();
    if sampling == Sampling::Uniform && methods.contains(&Method::Refined) {
        parts.push((Method::Refined, Sampling::Adaptive, counts[0]));
    }
    println!("{HEAD}");
    for (method, sampling, count) in parts {
        let of = if method == Method::Front { "a front" } else { "a refined run, with its mesh" };
        let sizes = if sampling == Sampling::Uniform { "" } else { ", sizes by curvature" };
        println!("## About {count} particles of {of}{sizes}\n\n{COLUMNS}");
        for sweep in &sweeps {
            measure(sweep, count, method, sampling);
        }
        println!();
    }
}

/// What is compared of two runs.
struct Compared {
    count: usize,
    figures: Figures,
}

impl Compared {
    fn of(run: &mut Run<'_, Formula>) -> Self {
        let report = run.report();
        Self {
            count: report.count,
            figures: report.measures.quality.expect("figures of a run that was measured"),
        }
    }

    /// The largest hole, where it is known over that of the radii wanted there.
    fn hole(&self) -> f64 {
        let coverage = &self.figures.coverage;
        if coverage.cover_local.is_nan() { coverage.cover } else { coverage.cover_local }
    }

    /// The closest pair, where it is known over the sum of the radii.
    fn closest(&self) -> f64 {
        let Figures { edges, spacing, .. } = &self.figures;
        if edges.overlap_min.is_nan() { spacing.nearest_min } else { edges.overlap_min }
    }
}

fn measure(sweep: &Sweep, count: u32, method: Method, sampling: Sampling) {
    let bounds = Bounds::cube(sweep.half);
    let by_count = settings!(method, sampling; ..Settings::with_count(count).in_box(bounds));
    let field = |frame: u32| {
        let q = sweep.from + (sweep.to - sweep.from) * f64::from(frame) / f64::from(FRAMES);
        Formula::parse(&sweep.formula).and_then(|formula| formula.with("q", q)).expect("a formula")
    };
    // A uniform run has one radius for all of the sweep: that with the wanted count in the middle.
    let settings = if sampling == Sampling::Uniform {
        let mut middle = Run::start(field(FRAMES / 2), &by_count).expect("a run");
        finish(&mut middle);
        let radius_share = middle.progress().map_or(0.0, |progress| progress.radius) / bounds.diagonal();
        settings!(size_mode: SizeMode::Radius, radius_share; ..by_count)
    } else {
        by_count
    };
    let mut run = Run::start(field(0), &settings).expect("a run");
    finish(&mut run);
    let first = run.count();
    let every = COMPARED_EVERY[usize::from(sampling == Sampling::Adaptive)];
    let (mut spent, mut moved) = (0.0, 0);
    for frame in 1..=FRAMES {
        let next = field(frame);
        let before = Instant::now();
        assert_eq!(run.follow(next), Ok(()), "{} in frame {frame}", sweep.name);
        finish(&mut run);
        spent += before.elapsed().as_secs_f64();
        moved += run.count();
        if frame % every != 0 {
            continue;
        }
        let before = Instant::now();
        let mut fresh = Run::start(field(frame), &settings).expect("a run");
        finish(&mut fresh);
        let took = before.elapsed().as_secs_f64();
        let alive = run.particles().identity.iter().filter(|&&number| (number as usize) < first).count();
        let (ours, fresh) = (Compared::of(&mut run), Compared::of(&mut fresh));
        println!(
            "| {} | {frame} | {:.3} | {:.2} ({:.2}) | {:.2} ({:.2}) | {:.2} ({:.2}) | {:.2} | {} ({}) | {} ({}) | {:.0} | {:.1} |",
            sweep.name,
            ours.count as f64 / fresh.count as f64,
            ours.figures.order.six_neighbours,
            fresh.figures.order.six_neighbours,
            ours.hole(),
            fresh.hole(),
            ours.closest(),
            fresh.closest(),
            alive as f64 / first.min(fresh.count) as f64,
            ours.figures.connectivity.components,
            fresh.figures.connectivity.components,
            ours.figures.connectivity.euler,
            fresh.figures.connectivity.euler,
            1e9 * spent / moved as f64,
            took * f64::from(every) / spent,
        );
        (spent, moved) = (0.0, 0);
    }
}
