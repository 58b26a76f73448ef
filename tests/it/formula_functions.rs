//! Tests of the single-precision functions against double-precision references.

use marching_particles::internal::math::functions as single;

/// Numbers of every magnitude: a few hundred mantissas for each exponent, in both signs, with the
/// ends of the range.
fn all_sizes() -> Vec<f32> {
    let mut out = vec![0.0, f32::from_bits(1), f32::MIN_POSITIVE, f32::MAX, 1.0, f32::EPSILON];
    let mut bits: u32 = 3;
    while bits < f32::INFINITY.to_bits() {
        out.push(f32::from_bits(bits));
        bits += 30_011;
    }
    let negative: Vec<f32> = out.iter().map(|x| -x).collect();
    out.extend(negative);
    out
}

/// `count` numbers from `lo` to `hi`.
fn between(lo: f32, hi: f32, count: u32) -> Vec<f32> {
    (0..=count).map(|k| lo + (hi - lo) * (k as f32 / count as f32)).collect()
}

/// Distance from `got` to `exact` in units in the last place of `exact`, or infinity if only one of
/// them is NaN or infinite.
fn ulps(got: f32, exact: f64) -> f64 {
    let rounded = exact as f32;
    if got.is_nan() && exact.is_nan() || got == rounded {
        return 0.0;
    }
    if got.is_nan() || exact.is_nan() {
        return f64::INFINITY;
    }
    // Infinity counts as the successor of the largest finite number, so rounding to infinity is 1
    // ulp.
    let finite = |x: f32| f64::from(x.clamp(-f32::MAX, f32::MAX));
    let size = rounded.abs().min(f32::MAX.next_down());
    let unit = f64::from(size.next_up()) - f64::from(size);
    let steps = (finite(got) - exact.clamp(-f64::from(f32::MAX), f64::from(f32::MAX))).abs() / unit;
    if got.is_infinite() != rounded.is_infinite() { steps + 1.0 } else { steps }
}

fn worst(name: &str, numbers: &[f32], single: fn(f32) -> f32, double: fn(f64) -> f64, bound: f64) {
    let (mut most, mut at) = (0.0, f32::NAN);
    for &x in numbers {
        let error = ulps(single(x), double(f64::from(x)));
        if error > most {
            (most, at) = (error, x);
        }
    }
    println!("{name}: {most:.2} ulp at {at:e}");
    assert!(most <= bound, "{name}({at:e}) = {:e}, off by {most} ulp", single(at));
}

#[test]
fn exponentials_and_logarithms_are_good_to_one_ulp_or_two() {
    let wide = all_sizes();
    worst("exp", &wide, single::exp, libm::exp, 1.0);
    worst("exp near", &between(-104.0, 89.0, 400_000), single::exp, libm::exp, 1.0);
    worst("ln", &wide, single::ln, libm::log, 1.0);
    worst("ln near", &between(0.4, 2.5, 400_000), single::ln, libm::log, 1.0);
    worst("log10", &wide, single::log10, libm::log10, 2.0);
}

#[test]
fn trigonometric_functions_are_good_to_a_few_ulp_within_a_million_radians() {
    let wide: Vec<f32> = all_sizes().into_iter().filter(|x| x.abs() < 1e6).collect();
    let near = between(-10.0, 10.0, 400_000);
    for numbers in [&wide, &near] {
        worst("sin", numbers, single::sin, libm::sin, 1.5);
        worst("cos", numbers, single::cos, libm::cos, 1.5);
        worst("tan", numbers, single::tan, libm::tan, 4.0);
    }
}

#[test]
fn sine_and_cosine_stay_within_one_at_any_angle() {
    for x in all_sizes() {
        assert!(single::sin(x).abs() <= 1.0 && single::cos(x).abs() <= 1.0, "{x:e}");
        if x.abs() < 1e9 {
            assert!((f64::from(single::sin(x)) - libm::sin(f64::from(x))).abs() < 1e-6, "{x:e}");
        }
    }
}

#[test]
fn inverse_functions_are_good_to_a_few_ulp() {
    let wide = all_sizes();
    let unit = between(-1.0, 1.0, 400_000);
    for numbers in [&wide, &unit] {
        worst("asin", numbers, single::asin, libm::asin, 2.5);
        worst("acos", numbers, single::acos, libm::acos, 2.5);
        worst("atan", numbers, single::atan, libm::atan, 2.5);
    }
}

#[test]
fn hyperbolic_functions_are_good_to_a_few_ulp() {
    let wide = all_sizes();
    let near = between(-20.0, 20.0, 400_000);
    let far = between(85.0, 90.0, 50_000);
    for numbers in [&wide, &near, &far] {
        worst("sinh", numbers, single::sinh, libm::sinh, 2.0);
        worst("cosh", numbers, single::cosh, libm::cosh, 2.0);
        worst("tanh", numbers, single::tanh, libm::tanh, 2.0);
    }
}

#[test]
fn cube_roots_are_correctly_rounded_almost_always() {
    worst("cbrt", &all_sizes(), single::cbrt, libm::cbrt, 0.51);
}

#[test]
fn floor_and_sign_are_exact() {
    for x in all_sizes().into_iter().chain(between(-5.0, 5.0, 1000)) {
        assert_eq!(single::floor(x).to_bits(), libm::floorf(x).to_bits(), "{x:e}");
        let sign = if x == 0.0 { 0.0 } else { x.signum() };
        assert_eq!(single::sign(x), sign, "{x:e}");
    }
}

#[test]
fn powers_are_good_to_one_ulp_at_any_size() {
    let bases: Vec<f32> = all_sizes().into_iter().step_by(101).chain(between(0.5, 2.0, 99)).collect();
    let exponents = [
        -3.0,
        -2.5,
        -1.0,
        -0.5,
        -1e-3,
        0.0,
        1e-3,
        0.3,
        0.5,
        1.0,
        1.5,
        2.0,
        3.0,
        2.7,
        7.0,
        40.25,
        1e4,
        8_388_609.0,
        3e9,
        -1e30,
    ];
    let mut most: f64 = 0.0;
    for &a in &bases {
        for b in exponents {
            let exact = libm::pow(f64::from(a), f64::from(b));
            let error = ulps(single::pow(a, b), exact);
            most = most.max(error);
            assert!(error <= 0.75, "{a:e}^{b} = {:e}, exactly {exact:e}", single::pow(a, b));
        }
    }
    println!("pow: {most:.2} ulp");
}

#[test]
fn angles_are_right_in_every_quadrant() {
    let sides: Vec<f32> = all_sizes().into_iter().step_by(617).chain(between(-2.0, 2.0, 40)).collect();
    for &y in &sides {
        for &x in &sides {
            let exact = libm::atan2(f64::from(y), f64::from(x));
            let error = ulps(single::atan2(y, x), exact);
            assert!(error <= 3.5, "atan2({y:e}, {x:e}) = {:e}, exactly {exact:e}", single::atan2(y, x));
        }
    }
}

#[test]
fn the_undefined_gives_nan_and_poles_give_infinities() {
    let inf = f32::INFINITY;
    for f in [single::ln, single::log10] {
        assert!(f(-1.0).is_nan() && f(-f32::MIN_POSITIVE).is_nan() && f(-inf).is_nan());
        assert_eq!((f(0.0), f(-0.0), f(inf)), (-inf, -inf, inf));
    }
    for f in [single::asin, single::acos] {
        assert!(f(1.000_000_1).is_nan() && f(-2.0).is_nan() && f(inf).is_nan());
    }
    for f in [single::sin, single::cos, single::tan] {
        assert!(f(inf).is_nan() && f(-inf).is_nan());
    }
    assert_eq!((single::exp(inf), single::exp(-inf), single::exp(1e30)), (inf, 0.0, inf));
    assert_eq!((single::sinh(-inf), single::cosh(-inf), single::tanh(-inf)), (-inf, inf, -1.0));
    assert_eq!((single::cbrt(-inf), single::cbrt(-8.0)), (-inf, -2.0));
    assert!(single::pow(-2.0, 0.5).is_nan());
    assert_eq!((single::pow(0.0, -1.0), single::pow(-2.0, 3.0), single::pow(0.0, 0.0)), (inf, -8.0, 1.0));
    assert_eq!(
        (single::atan2(inf, inf), single::atan2(0.0, -1.0)),
        (core::f32::consts::FRAC_PI_4, core::f32::consts::PI)
    );
}

#[test]
fn nan_is_never_lost() {
    let nan = f32::NAN;
    let functions: [fn(f32) -> f32; 15] = [
        single::exp,
        single::ln,
        single::log10,
        single::sin,
        single::cos,
        single::tan,
        single::asin,
        single::acos,
        single::atan,
        single::sinh,
        single::cosh,
        single::tanh,
        single::cbrt,
        single::floor,
        single::sign,
    ];
    for (index, f) in functions.into_iter().enumerate() {
        assert!(f(nan).is_nan(), "function {index}");
    }
    for f in [single::min, single::max, single::pow, single::atan2] {
        for (a, b) in [(nan, 0.0), (0.0, nan), (nan, nan), (1.0, nan), (nan, f32::INFINITY)] {
            assert!(f(a, b).is_nan(), "{a} {b}");
        }
    }
}

#[test]
fn sine_and_cosine_together_have_the_bits_of_each_alone() {
    let same = |a: f32, b: f32| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
    for x in all_sizes() {
        let (sine, cosine) = single::sin_cos(x);
        assert!(same(sine, single::sin(x)) && same(cosine, single::cos(x)), "{x:e}");
    }
}
