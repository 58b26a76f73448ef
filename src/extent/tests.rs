//! Tests of the box around a surface.

use super::*;
use crate::field::formula::Formula;

fn extent(text: &str) -> Extent {
    let field = Formula::as_written(text, &[]).unwrap_or_else(|error| panic!("{text}: {error:?}"));
    find(&field.for_sampling())
}

/// Asserts that the box holds `lo` to `hi` and is larger by less than 5 % of its longest side.
fn assert_fits(text: &str, lo: [f64; 3], hi: [f64; 3]) {
    let Extent { bounds, reach } = extent(text);
    assert_eq!(reach, Reach::Bounded, "{text}: {bounds:?}");
    let room = 0.05 * (0..3).map(|axis| hi[axis] - lo[axis]).fold(0.0, f64::max);
    for axis in 0..3 {
        let (below, above) = (lo[axis] - bounds.min[axis], bounds.max[axis] - hi[axis]);
        assert!(below >= 0.0 && below < room && above >= 0.0 && above < room, "{text}: {bounds:?}");
    }
}

#[test]
fn the_box_of_a_bounded_surface_holds_all_of_it() {
    for (text, half) in [
        ("x^2 + y^2 + z^2 = 1", [1.0, 1.0, 1.0]),
        ("x^2 + y^2 + z^2 = 250000", [500.0, 500.0, 500.0]),
        ("x^2 + y^2 + z^2 = 1e-6", [1e-3, 1e-3, 1e-3]),
        ("x^2/9 + y^2/4 + z^2 = 1", [3.0, 2.0, 1.0]),
        ("(sqrt(x^2 + y^2) - 2)^2 + z^2 = 0.25", [2.5, 2.5, 0.5]),
        ("max(|x|, |y|, |z|) = 3", [3.0, 3.0, 3.0]),
        ("x^20 + y^20 + z^20 = 1", [1.0, 1.0, 1.0]),
        ("exp(-(x^2 + y^2 + z^2)) = 0.5", [0.8326, 0.8326, 0.8326]),
        ("1/(x^2 + y^2 + z^2) = 4", [0.5, 0.5, 0.5]),
        ("sqrt(1 - x^2 - y^2 - z^2) = 0.6", [0.8, 0.8, 0.8]),
        ("(x^2 + y^2 + z^2 - 1)^2 = 0", [1.0, 1.0, 1.0]),
    ] {
        assert_fits(text, half.map(|half: f64| -half), half);
    }
    // Three-dimensional relatives of a well-known quartic.
    let Extent { bounds, reach } = extent("x^4-5x^2+y^4-5y^2+z^4-5z^2+11.8");
    assert_eq!(reach, Reach::Bounded);
    assert!(bounds.max.iter().chain(&bounds.min).all(|end| (2.1..2.5).contains(&end.abs())), "{bounds:?}");
}

#[test]
fn the_box_holds_every_component_wherever_it_is() {
    let two = "min((x-15)^2 + y^2 + z^2, (x+15)^2 + y^2 + z^2) = 0.01";
    assert_fits(two, [-15.1, -0.1, -0.1], [15.1, 0.1, 0.1]);
    let product = "((x-15)^2 + y^2 + z^2 - 0.01)((x+15)^2 + y^2 + z^2 - 0.01)";
    assert_fits(product, [-15.1, -0.1, -0.1], [15.1, 0.1, 0.1]);
    assert_fits("(x-3000)^2 + (y+70)^2 + (z-1)^2 = 4", [2998.0, -72.0, -1.0], [3002.0, -68.0, 3.0]);
    // Particles are in single precision, so a small box far away is made larger.
    let Extent { bounds, reach } = extent("(x-9000)^2 + y^2 + z^2 = 0.01");
    assert_eq!(reach, Reach::Bounded);
    assert!(bounds.is_valid() && bounds.min[0] < 8999.9 && bounds.max[0] > 9000.1, "{bounds:?}");
}

#[test]
fn bounds_with_mixed_terms_are_tight_enough() {
    // Eigenvalues 0.5, 0.5 and 2: an ellipsoid along (1, −1, 0) and (1, 1, −2).
    let half = 1.2248;
    assert_fits("x^2 + y^2 + z^2 + x y + y z + x z = 1", [-half; 3], [half; 3]);
    let shifted = "(x-y)^2 + (y-z)^2 + (z+x-4)^2 + x^4 = 3";
    assert_eq!(extent(shifted).reach, Reach::Bounded);
}

#[test]
fn what_goes_on_for_ever_keeps_a_sensible_box_and_is_said_to() {
    for text in [
        "z = 0",
        "x + 2y - z = 1",
        "sin(x)cos(y) + sin(y)cos(z) + sin(z)cos(x)",
        "x^2 + y^2 = z^2",
        "x^2 + y^2 = 1",
        "z = x^2 + y^2",
        "z = 1/x",
        "1/x + 1/y + 1/z = 1",
        "x^2 + y^2 - z^2 = 1",
        "z = sin(x) cos(y)",
        "x y z = 1",
        "tan(x) = y",
        "floor(x) = y",
        "z = abs(x) - y^2",
    ] {
        let Extent { bounds, reach } = extent(text);
        assert_eq!(reach, Reach::Endless, "{text}: {bounds:?}");
        assert_eq!(bounds, Bounds::cube(USUAL_HALF), "{text}");
    }
    // A box far from the origin holds some of it.
    for text in ["z = 300", "x + y + z = 1500", "x^2 + y^2 = 2500"] {
        let Extent { bounds, reach } = extent(text);
        assert_eq!(reach, Reach::Endless, "{text}");
        assert!(bounds.max[2] > 50.0 && bounds.max[2] < 3000.0, "{text}: {bounds:?}");
    }
}

#[test]
fn of_an_endless_surface_of_short_period_the_box_holds_two_periods() {
    use core::f64::consts::TAU;
    let tenth = TAU / 10.0;
    for (text, half) in [
        ("cos(10x)+cos(10y)+cos(10z)", [tenth; 3]),
        ("sin(10x)cos(20y)+sin(20y)cos(5z)+sin(5z)cos(10x)", [tenth, 0.5 * tenth, 2.0 * tenth]),
        // One axis of a long period, and one along which nothing changes.
        ("cos(10x)+cos(y)+cos(10z)", [tenth, USUAL_HALF, tenth]),
        ("cos(10x)+cos(10y)", [tenth; 3]),
        // Long enough for the usual box.
        ("cos(2x)+cos(2y)+cos(2z)", [USUAL_HALF; 3]),
        // What does not come again along every axis keeps it too.
        ("z = sin(10x)", [USUAL_HALF; 3]),
    ] {
        let Extent { bounds, reach } = extent(text);
        assert_eq!(reach, Reach::Endless, "{text}");
        for (axis, half) in half.into_iter().enumerate() {
            assert!((bounds.max[axis] - half).abs() < 1e-9, "{text}: {bounds:?}");
            assert!((bounds.min[axis] + half).abs() < 1e-9, "{text}: {bounds:?}");
        }
    }
    assert_eq!(extent("cos(10x)+cos(10y)+cos(10z)=4").reach, Reach::Nowhere);
}

#[test]
fn bounded_components_beside_an_endless_one_are_in_the_box() {
    // The sphere of radius 30, and the plane beyond it.
    let Extent { bounds, reach } = extent("(x^2 + y^2 + z^2 - 900)(z - 3000)");
    assert_eq!(reach, Reach::Endless);
    assert!(bounds.max.iter().all(|&end| (30.0..40.0).contains(&end)), "{bounds:?}");
    // The oval of an elliptic curve, turned about its axis, and the sheet that goes on.
    let Extent { bounds, reach } = extent("y^2 + z^2 = x^3/100 - 100x");
    assert_eq!(reach, Reach::Endless);
    assert!(bounds.min[0] < -100.0 && bounds.max[1] > 62.0, "{bounds:?}");
}

#[test]
fn a_scan_finds_what_is_within_but_a_fiftieth_of_its_half_width() {
    for half in [4.0, 10_000.0] {
        for axis in 0..6 {
            let mut centre = ["0".to_string(), "0".to_string(), "0".to_string()];
            let sign = if axis < 3 { 1.0 } else { -1.0 };
            centre[axis % 3] = format!("{}", 0.973 * half * sign);
            let [x, y, z] = centre;
            let text =
                format!("(x-({x}))^2 + (y-({y}))^2 + (z-({z}))^2 = {}", (0.005 * half) * (0.005 * half));
            let field = Formula::as_written(&text, &[]).expect("a formula");
            let mut evaluator = field.evaluator(Frame::default());
            let bounded = evaluator.bounded().expect("a formula has bounds");
            let found = crate::slices::complete(scan::scan(bounded, half, scan::Effort::Plain, &mut 10_000));
            let scan::Scan::Inside(hull) = found else { panic!("{text} within {half}: {found:?}") };
            let reach = if axis < 3 { hull.max[axis] } else { -hull.min[axis - 3] };
            assert!((0.978 * half..0.981 * half).contains(&reach), "{text}: {hull:?}");
        }
    }
}

#[test]
fn where_there_is_no_surface_it_is_said() {
    for text in
        ["x^2 + y^2 + z^2 = -1", "exp(x) + 1", "1/x", "sqrt(-1 - x^2)", "x^2 + y^2 + (z - 30000)^2 = 1"]
    {
        assert_eq!(extent(text).reach, Reach::Nowhere, "{text}");
    }
}

#[test]
fn the_sign_of_terms_that_cancel_far_away_is_not_rounding() {
    // Cylinders of radius 1 or more, of which intervals decide nothing far from the origin.
    for text in [
        "x^2 + y^2 + z^2 = 1 + if(z > 0, z, z^2)",
        "x^2 + y^2 + z^2 - 1 - z^2*cos(0*z)",
        "x^2 + y^2 + z^2*z^2 - 2 - z^4*cos(0*x)",
    ] {
        let extent = extent(text);
        assert_eq!(extent.reach, Reach::Endless, "{text}: {extent:?}");
        assert_eq!(extent.bounds, Bounds::cube(USUAL_HALF), "{text}");
    }
}

#[test]
fn the_room_is_a_twentieth_and_three_radii() {
    let sphere = Extent { bounds: Bounds::cube(1.0), reach: Reach::Bounded };
    assert_eq!(sphere.with_room(|_| 0.006).max, [1.1; 3]);
    for share in [0.02, 0.03] {
        let bounds = sphere.with_room(|_| share);
        let room = bounds.max[0] - 1.0;
        assert!((room / (3.0 * share * bounds.diagonal()) - 1.0).abs() < 0.01, "{share}: {bounds:?}");
    }
    // Very large particles take no more than half of the side.
    assert_eq!(sphere.with_room(|_| 0.2).max, [2.0; 3]);
    let plane = Extent { bounds: Bounds::cube(4.0), reach: Reach::Endless };
    assert_eq!(plane.with_room(|_| 0.006), plane.bounds);
    // A radius that is a length has three times that length on every side.
    let bounds = sphere.with_room(|bounds| 0.15 / bounds.diagonal());
    assert!(bounds.max.iter().all(|x| (x - 1.45).abs() < 1e-12), "{bounds:?}");
}

#[test]
fn budgets_do_not_change_the_box() {
    let text = "x^4-5x^2+y^4-5y^2+z^4-5z^2+11.8";
    let field = Formula::as_written(text, &[]).expect("a formula");
    let mut fit = core::pin::pin!(find_in_slices(&field));
    let mut steps = 0;
    let slowly = loop {
        steps += 1;
        if let Some(extent) = slices::advance(fit.as_mut(), 1) {
            break extent;
        }
    };
    assert!(steps > 10);
    assert_eq!(slowly, extent(text));
}

#[test]
fn a_field_without_bounds_is_looked_at_on_a_grid() {
    struct Blob;
    impl Field for Blob {
        fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
            (p.length() - 2.5, p.normalize_or_zero())
        }
    }
    let extent = find(&Blob);
    assert_eq!(extent.reach, Reach::Bounded);
    assert!(extent.bounds.max.iter().all(|end| (2.5..3.0).contains(end)), "{extent:?}");
}
