//! Random cases: which of them a run takes, and how many.
//!
//! A run takes a tenth of the cases, from a seed that changes every day, so that many runs see more
//! than one long run would. `MARCHING_PARTICLES_TENTHS=10` takes all of them (`cargo xtask test
//! --all`), a larger number more than that, and `MARCHING_PARTICLES_SEED` repeats a run: each test
//! prints the seed of a case that fails.

use rand_core::Rng;
use rand_pcg::Pcg32;
use std::env;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{SystemTime, UNIX_EPOCH};

/// Cases of different days are this far apart: more than any run takes.
const DAY: u64 = 100_000_000;

fn number(name: &str) -> Option<u64> {
    let text = env::var(name).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{name} is {text:?}, not a whole number")))
}

/// The part of the cases that a run takes, in tenths.
pub(crate) fn tenths() -> u64 {
    number("MARCHING_PARTICLES_TENTHS").unwrap_or(1)
}

/// The seed of the first case.
#[expect(clippy::disallowed_methods, reason = "the day chooses the cases, never what is made of them")]
pub(crate) fn first() -> u64 {
    let today = || SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs() / 86_400);
    number("MARCHING_PARTICLES_SEED").unwrap_or_else(today) * DAY
}

/// How many cases a run takes where all of them are `all`.
pub(crate) fn count(all: u64) -> u64 {
    (all * tenths()).div_ceil(10)
}

/// The seeds of the cases that a run takes where all of them are `all`.
pub(crate) fn seeds(all: u64) -> Range<u64> {
    first()..first() + count(all)
}

/// A random number between two others.
pub(crate) fn between(random: &mut Pcg32, lo: f64, hi: f64) -> f64 {
    lo + (hi - lo) * f64::from(random.next_u32()) / f64::from(u32::MAX)
}

/// Proptest's settings for a run that takes its part of `all` cases.
pub(crate) fn proptest(all: u64) -> proptest::test_runner::Config {
    proptest::test_runner::Config {
        cases: count(all).try_into().unwrap_or(u32::MAX),
        rng_seed: proptest::test_runner::RngSeed::Fixed(first()),
        failure_persistence: None,
        ..proptest::test_runner::Config::default()
    }
}

/// Asserts that about this share of the cases, or more, is as wanted: by no more than four standard
/// deviations fewer.
pub(crate) fn assert_share(wanted: u64, cases: u64, share: f64, what: &str) {
    let expected = share * cases as f64;
    let deviation = (expected * (1.0 - share)).sqrt();
    println!("{what}: {wanted} of {cases}");
    assert!(
        wanted as f64 >= expected - 4.0 * deviation,
        "{what}: {wanted} of {cases}, usual is a share of {share}"
    );
}

/// Whether the checks of a case hold; what fails is printed.
pub(crate) fn holds(check: impl FnOnce()) -> bool {
    catch_unwind(AssertUnwindSafe(check)).is_ok()
}
