//! Whole runs on damaged formulas of the gallery, with random settings: none panics, each ends within a bounded number of
//! evaluations, and what comes out is finite. `FUZZ_CASES` sets the number of runs, 300 by default.

use marching_particles::field::formula::MAX_FORMULA_BYTES;
use marching_particles::field::gallery;
use marching_particles::math::Bounds;
use marching_particles::sampler::{Method, Sampling, Search, Settings};
use marching_particles::session::{FieldRequest, Session};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Pieces that are put into a formula.
const PIECES: &[&str] = &[
    "x", "y", "z", "+", "-", "*", "/", "^", "(", ")", "^2", "^-1", "1e300", "1e-300", "0", "7", ".", ",",
    "=", "sin(", "cos(", "exp(", "ln(", "sqrt(", "abs(", "floor(", "sign(", "min(", "atan2(", "tan(", "100*",
    "mod(", "²", "π", "|",
];

/// A formula of the gallery in which some pieces are dropped, put in or taken from another formula.
fn damaged(random: &mut Pcg32) -> String {
    let mut pick = |count: usize| random.next_u32() as usize % count;
    let of_gallery = |k: usize| gallery::SURFACES[k].formula;
    let mut text: Vec<char> = of_gallery(pick(gallery::SURFACES.len())).chars().collect();
    for _ in 0..pick(4) {
        let (at, length) = (pick(text.len() + 1), pick(6));
        let end = (at + length).min(text.len());
        match pick(4) {
            0 => drop(text.drain(at..end)),
            1 => drop(text.splice(at..at, PIECES[pick(PIECES.len())].chars())),
            2 => drop(text.splice(at..end, PIECES[pick(PIECES.len())].chars())),
            _ => {
                let other: Vec<char> = of_gallery(pick(gallery::SURFACES.len())).chars().collect();
                text.truncate(at);
                text.extend(&other[pick(other.len())..]);
            }
        }
    }
    text.into_iter().take(MAX_FORMULA_BYTES).collect()
}

#[test]
fn runs_on_damaged_formulas_end_with_finite_particles() {
    /// Evaluations that no run of so few particles needs.
    const MOST: u64 = 20_000_000;
    let cases: u64 = std::env::var("FUZZ_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(300);
    let (mut ran, mut proven) = (0, 0);
    for seed in 0..cases {
        let mut random = Pcg32::seed_from_u64(seed);
        let formula = damaged(&mut random);
        let mut session = Session::new();
        let half = [0.01, 1.0, 3.0, 40.0, 1e4][random.next_u32() as usize % 5];
        let bounds = Some(Bounds::cube(half));
        let request = FieldRequest { formula: Some(formula.clone()), bounds, ..FieldRequest::default() };
        if session.set_field(&request).is_err() {
            continue;
        }
        ran += 1;
        let settings = Settings {
            radius_share: [0.01, 0.03, 0.2][random.next_u32() as usize % 3],
            sampling: if random.next_u32() % 3 == 0 { Sampling::Adaptive } else { Sampling::Uniform },
            method: if random.next_u32() % 3 == 0 { Method::Refined } else { Method::Front },
            relax_steps: random.next_u32() % 4,
            max_particles: 3_000,
            seed,
            ..Settings::default()
        };
        let context = format!("{seed}: {formula} in ±{half}, {settings:?}");
        session.start(&settings).unwrap_or_else(|error| panic!("{context}: {error}"));
        while session.step(20_000).stop_reason.is_none() {}
        let report = session.report();
        assert!(report.evaluations < MOST, "{context}: {} evaluations", report.evaluations);
        for (p, n) in session.particles().position.iter().zip(&session.particles().normal) {
            assert!(p.is_finite() && (n.length() - 1.0).abs() < 1e-4, "{context}: {p} {n}");
        }
        let is_proven = report.search == Search::Proven;
        proven += u32::from(is_proven);
        assert!(!is_proven || report.sampled.missing == Some(report.sampled.without.len()), "{context}");
    }
    println!("{ran} of {cases} formulas are valid, {proven} of the runs proven");
    assert!(u64::from(proven) * 10 > cases, "{proven} of {cases} proven");
}
