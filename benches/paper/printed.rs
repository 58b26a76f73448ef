//! Tables 1 and 2 as the paper prints them.

use marching_particles::sampler::Sampling;

/// A half of a line of Table 1. Times are seconds on the paper's 3 GHz PC.
pub(crate) struct Printed {
    /// Particles, in the paper's own words.
    pub(crate) particles: &'static str,
    pub(crate) steps: u32,
    /// Particles in the last step.
    pub(crate) last_particles: u32,
    pub(crate) last_step: f64,
    pub(crate) total: f64,
}

/// A line of Table 1.
pub(crate) struct Line {
    pub(crate) model: &'static str,
    /// The gallery's surface, or the model that stands in for the paper's.
    pub(crate) id: &'static str,
    pub(crate) sampling: Sampling,
    pub(crate) count: u32,
    pub(crate) ours: Printed,
    pub(crate) other: Printed,
}

const fn half(
    particles: &'static str,
    steps: u32,
    last_particles: u32,
    last_step: f64,
    total: f64,
) -> Printed {
    Printed { particles, steps, last_particles, last_step, total }
}

const fn line(
    (model, id): (&'static str, &'static str),
    sampling: Sampling,
    count: u32,
    ours: Printed,
    other: Printed,
) -> Line {
    Line { model, id, sampling, count, ours, other }
}

const ELLIPSOID: (&str, &str) = ("Ellipsoid", "ellipsoid");
/// The paper's bunny lacks points between its ears, which grow together.
const BUNNY: (&str, &str) = ("Bunny", "bunny-joined");

/// Table 1.
#[allow(clippy::approx_constant, reason = "3.14 is a time")]
pub(crate) const TABLE_1: [Line; 8] = [
    line(
        ELLIPSOID,
        Sampling::Uniform,
        13_923,
        half("13,923", 10, 13_923, 1.86, 19.80),
        half("10,633", 373, 10_633, 1.44, 219.63),
    ),
    line(
        ELLIPSOID,
        Sampling::Uniform,
        55_748,
        half("55,748", 10, 55_748, 59.05, 613.54),
        half("≈ 50,000", 1_613, 33_343, 17.79, 4_344.01),
    ),
    line(
        BUNNY,
        Sampling::Uniform,
        14_600,
        half("14,600", 10, 14_600, 14.14, 187.85),
        half("8,687", 465, 8_687, 3.14, 575.91),
    ),
    line(
        BUNNY,
        Sampling::Uniform,
        47_356,
        half("47,356", 10, 47_356, 151.55, 1_691.94),
        half("≈ 50,000", 1_959, 33_483, 68.13, 32_912.02),
    ),
    line(
        ELLIPSOID,
        Sampling::Adaptive,
        15_296,
        half("15,296", 10, 15_296, 5.60, 75.32),
        half("12,475", 1_320, 12_475, 4.81, 717.53),
    ),
    line(
        ELLIPSOID,
        Sampling::Adaptive,
        27_314,
        half("27,314", 10, 27_314, 26.41, 252.19),
        half("27,151", 2_136, 27_151, 27.04, 4_535.15),
    ),
    line(
        BUNNY,
        Sampling::Adaptive,
        12_388,
        half("12,388", 10, 12_388, 16.79, 313.77),
        half("≈ 13,000", 1_124, 10_570, 13.88, 2_294.73),
    ),
    line(
        BUNNY,
        Sampling::Adaptive,
        43_432,
        half("43,432", 10, 43_432, 181.09, 2_375.75),
        half("≈ 40,000", 2_246, 21_774, 63.38, 10_056.69),
    ),
];

/// Table 2, the analytic ellipsoid: particles; seconds of generation, relaxation and in all.
pub(crate) const TABLE_2: [(u32, [f64; 3]); 4] = [
    (2_225, [0.11, 0.49, 0.60]),
    (13_923, [1.22, 18.58, 19.80]),
    (55_748, [24.80, 588.74, 613.54]),
    (87_043, [61.60, 1_487.49, 1_549.09]),
];
