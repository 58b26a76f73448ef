//! Mutated formulas, files and requests, by the checks that libFuzzer runs for long (`fuzz/`), and
//! whole runs on damaged formulas of the gallery.

use crate::cases;
use crate::golden::checkout;
use marching_particles::Bounds;
use marching_particles::field::formula::MAX_FORMULA_BYTES;
use marching_particles::field::gallery;
use marching_particles::internal::session::{FieldRequest, Session};
use marching_particles::sampler::{Method, Sampling, Search, Settings};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use std::fs;

#[path = "../../fuzz/harness.rs"]
#[expect(unreachable_pub, reason = "it is a library of its own for libFuzzer")]
pub(crate) mod harness;

pub(crate) fn below(random: &mut Pcg32, count: usize) -> usize {
    random.next_u32() as usize % count.max(1)
}

/// The files of a folder of `fuzz/seeds`, in the order of their names.
fn seeds(folder: &str) -> Vec<Vec<u8>> {
    let folder = checkout().join("fuzz/seeds").join(folder);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("a file").path()).collect();
    paths.sort();
    assert!(paths.len() >= 5, "{}: {} seeds", folder.display(), paths.len());
    paths.iter().map(|path| fs::read(path).expect("a seed")).collect()
}

/// The pieces of `fuzz/tokens.dict`.
fn tokens() -> Vec<Vec<u8>> {
    let quoted = include_str!("../../fuzz/tokens.dict").lines().filter_map(|line| line.strip_prefix('"'));
    quoted.map(|line| line.trim_end_matches('"').replace("\\\\", "\\").into_bytes()).collect()
}

/// A seed with fewer than `most` changes: bytes drop out or change, pieces of the dictionary or of
/// another seed come in.
fn mutated(random: &mut Pcg32, seeds: &[Vec<u8>], tokens: &[Vec<u8>], most: usize) -> Vec<u8> {
    let mut bytes = seeds[below(random, seeds.len())].clone();
    for _ in 0..below(random, most) {
        let at = below(random, bytes.len() + 1);
        let end = (at + below(random, 8)).min(bytes.len());
        match below(random, 6) {
            0 => drop(bytes.drain(at..end)),
            1 => drop(bytes.splice(at..end, tokens[below(random, tokens.len())].iter().copied())),
            2 => drop(bytes.splice(at..at, tokens[below(random, tokens.len())].iter().copied())),
            3 => {
                let again = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, again));
            }
            4 => {
                let other = &seeds[below(random, seeds.len())];
                bytes.truncate(at);
                bytes.extend(&other[below(random, other.len())..]);
            }
            _ => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << below(random, 8);
                }
            }
        }
    }
    bytes.truncate(MAX_FORMULA_BYTES);
    bytes
}

/// Checks every seed and mutations of them.
fn fuzz(folder: &str, all: u64, check: impl Fn(&[u8])) {
    let (seeds, tokens) = (seeds(folder), tokens());
    seeds.iter().for_each(|seed| check(seed));
    for case in cases::seeds(all) {
        let bytes = mutated(&mut Pcg32::seed_from_u64(case), &seeds, &tokens, 7);
        let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| check(&bytes)));
        assert!(outcome.is_ok(), "case {case} of {folder}: {:?}", String::from_utf8_lossy(&bytes));
    }
}

#[test]
fn all_readings_of_mutated_formulas_agree() {
    fuzz("formula", 40_000, harness::formula);
}

#[test]
fn mutated_files_are_read_or_refused() {
    fuzz("file", 200_000, harness::file);
}

#[test]
fn mutated_images_are_read_or_refused() {
    fuzz("image", 100_000, harness::image);
}

#[test]
fn mutated_meshes_are_mended_or_refused() {
    fuzz("mesh", 40_000, harness::mesh);
}

#[test]
fn mutated_requests_end_with_finite_particles_or_are_refused() {
    seeds("request").iter().for_each(|seed| harness::whole_request(seed));
    fuzz("request", 4_000, harness::request);
}

/// A formula of the gallery in which some pieces are dropped, put in or taken from another formula.
fn damaged(random: &mut Pcg32, tokens: &[Vec<u8>]) -> String {
    let formulas: Vec<Vec<u8>> = gallery::SURFACES.iter().map(|surface| surface.formula.into()).collect();
    String::from_utf8_lossy(&mutated(random, &formulas, tokens, 4)).into_owned()
}

#[test]
fn runs_on_damaged_formulas_end_with_finite_particles() {
    /// Shares that were usual when the test was written.
    const VALID: f64 = 0.4;
    const PROVEN: f64 = 0.38;
    let tokens = tokens();
    let (mut ran, mut proven) = (0, 0);
    for seed in cases::seeds(100) {
        let mut random = Pcg32::seed_from_u64(seed);
        let formula = Some(damaged(&mut random, &tokens));
        let bounds = Some(Bounds::cube([0.01, 1.0, 3.0, 40.0, 1e4][below(&mut random, 5)]));
        let settings = settings!(radius_share: [0.01, 0.03, 0.2][below(&mut random, 3)],
            sampling: if below(&mut random, 3) == 0 { Sampling::Adaptive } else { Sampling::Uniform },
            method: if below(&mut random, 3) == 0 { Method::Refined } else { Method::Front },
            relax_steps: random.next_u32() % 4,
            max_particles: 3_000,
            seed; ..Settings::default());
        let request = FieldRequest { formula, bounds, ..FieldRequest::default() };
        let mut session = Session::new();
        if let Some(outcome) = harness::run(&mut session, &request, &settings, 20_000) {
            ran += 1;
            proven += u64::from(outcome.search == Search::Proven);
            if seed % 8 == 0 {
                session.report();
            }
        }
    }
    cases::assert_share(ran, cases::count(100), VALID, "valid formulas");
    cases::assert_share(proven, ran, PROVEN, "proven runs");
}
