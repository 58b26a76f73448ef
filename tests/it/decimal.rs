//! Holds the reading and writing of decimal numbers to the standard library's.

use marching_particles::math::decimal::{read, text};
use proptest::prelude::{ProptestConfig, any, proptest};

fn standard_text(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-5..1e15).contains(&size) { format!("{value}") } else { format!("{value:e}") }
}

fn assert_both_ways(value: f64) {
    let written = text(value);
    assert_eq!(written, standard_text(value));
    assert_eq!(read(&written).map(f64::to_bits), Some(value.to_bits()), "{written}");
    for digits in [0, 1, 14, 15, 16, 17, 18, 25] {
        let written = format!("{value:.digits$e}");
        assert_eq!(read(&written), written.parse().ok(), "{written}");
    }
}

#[test]
fn numbers_at_the_edges_of_the_format() {
    for value in [
        0.0,
        -0.0,
        1.0,
        -1.5,
        0.1,
        0.006,
        1e15,
        1e-5,
        9.999_999_999_999_999e-6,
        999_999_999_999_999.9,
        123_456_789.0,
        1e21,
        1e22,
        1e23,
        9_007_199_254_740_992.0,
        5e-324,
        2.225_073_858_507_201e-308,
        f64::MIN_POSITIVE,
        f64::MAX,
        f64::EPSILON,
    ] {
        assert_both_ways(value);
    }
    // At the powers of two the spacing of the doubles changes.
    for exponent in 1..2047_u64 {
        for bits in [(exponent << 52) - 1, exponent << 52, (exponent << 52) + 1] {
            assert_both_ways(f64::from_bits(bits));
        }
    }
}

#[test]
fn midpoints_go_to_the_even_neighbour_and_a_digit_beyond_them_decides() {
    // 1 + 2⁻⁵³ lies midway between 1 and the next double.
    let midpoint = "1.00000000000000011102230246251565404236316680908203125";
    assert_eq!(read(midpoint), Some(1.0));
    assert_eq!(read(&format!("{midpoint}{}1", "0".repeat(2000))), Some(1.0 + f64::EPSILON));
    // Half of the least double, and the end of the range.
    for written in [
        "2.4703282292062327e-324",
        "2.4703282292062328e-324",
        "1.7976931348623158e308",
        "1.7976931348623159e308",
    ] {
        assert_eq!(read(written), written.parse().ok(), "{written}");
    }
}

#[test]
fn what_is_no_number_is_refused_and_odd_numbers_are_read() {
    for written in
        ["", "-", ".", "-.", "e5", "1e", "1e+", "1.2.3", "1x", "+1", "--1", "1e5.", "inf", "NaN", "1 ", "½"]
    {
        assert_eq!(read(written), None, "`{written}`");
    }
    for written in ["5.", ".5", "00012", "0e999999999999", "1e999999999999", "1e-999999999999", "0.000e-400"]
    {
        assert_eq!(read(written), written.parse().ok(), "`{written}`");
    }
    let long = format!("0.{}123e400", "0".repeat(500));
    assert_eq!(read(&long), long.parse().ok());
    let whole = format!("1{}e-1500", "0".repeat(1500));
    assert_eq!(read(&whole), Some(1.0));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_double_is_written_and_read_as_by_the_standard_library(bits in any::<u64>()) {
        let value = f64::from_bits(bits);
        if value.is_finite() {
            assert_both_ways(value);
        }
    }

    #[test]
    fn every_text_of_digits_is_read_as_by_the_standard_library(written in "-?[0-9]{1,40}(\\.[0-9]{0,40})?(e-?[0-9]{1,3})?") {
        assert_eq!(read(&written), written.parse().ok());
    }
}
