//! A spacing by a function of place: particles are as far apart as it asks, as far as the grading
//! lets them. Wishes and distances are found by brute force, from other points of the surface than
//! those of the sampler.

use marching_particles::field::{BatchField, FnField};
use marching_particles::glam::DVec3;
use marching_particles::sampler::SettingsError;
use marching_particles::{
    Bounds, Error, Field, Formula, Method, Run, Sample, Settings, SizeMode, Spacing, Warning, sample,
};
use rand_core::Rng;
use rand_pcg::Pcg64Mcg;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

fn random(rng: &mut Pcg64Mcg) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Points on a surface in a box: random ones, brought to it by Newton's method.
fn surface_points(field: &dyn Field, bounds: &Bounds, count: usize) -> Vec<DVec3> {
    let rng = &mut Pcg64Mcg::new(0x5EED);
    let mut points = Vec::new();
    for _ in 0..20 * count {
        let mut p = bounds.lo() + bounds.size() * DVec3::new(random(rng), random(rng), random(rng));
        for _ in 0..12 {
            let (f, gradient) = field.value_and_gradient(p);
            p -= gradient * (f / gradient.length_squared());
        }
        let (f, gradient) = field.value_and_gradient(p);
        if f.abs() < 1e-6 * gradient.length() && bounds.holds(p) {
            points.push(p);
        }
        if points.len() == count {
            break;
        }
    }
    assert!(points.len() > count / 2, "{} points on the surface", points.len());
    points
}

/// How well the distances of a sample fit the graded wish.
#[derive(Debug)]
struct Fit {
    /// Share of the distances to the six nearest particles that are 0.8 to 1.25 times the mean of
    /// what is wanted at their ends.
    good: f64,
    /// Mean of these ratios.
    mean: f64,
    /// Largest ratio of what is wanted at two particles.
    range: f64,
}

/// The fit of particles to `spacing`, with this largest slope of the radius: of some 600 of them.
fn fit(sample: &Sample, field: &dyn Field, spacing: &dyn Fn(DVec3) -> f64, slope: f64) -> Fit {
    let (particles, bounds) = (sample.particles(), sample.bounds());
    let places: Vec<DVec3> = (0..particles.len()).map(|i| particles.place(i)).collect();
    // Beside the random points some of the particles: where sizes are small there are more.
    let mut known = surface_points(field, &bounds, 3_000);
    known.extend(places.iter().step_by(1 + places.len() / 2_000));
    let known: Vec<(DVec3, f64)> = known.into_iter().map(|p| (p, spacing(p))).collect();
    let wanted = |i: usize| {
        let p = places[i];
        let graded = |(q, wish): &(DVec3, f64)| wish + 2.0 * slope * p.distance(*q);
        known.iter().map(graded).fold(spacing(p), f64::min)
    };
    let (mut ratios, mut range) = (Vec::new(), [f64::INFINITY, 0.0_f64]);
    for (i, p) in places.iter().enumerate().step_by(1 + places.len() / 600) {
        let own = wanted(i);
        range = [range[0].min(own), range[1].max(own)];
        // A particle at the border of the box has no neighbours beyond.
        let room = (*p - bounds.lo()).min(bounds.hi() - *p).min_element();
        if room < 1.5 * own {
            continue;
        }
        let mut near: Vec<(f64, usize)> = (0..places.len())
            .filter(|&j| j != i && particles.normal[i].dot(particles.normal[j]) > 0.0)
            .map(|j| (p.distance(places[j]), j))
            .collect();
        near.select_nth_unstable_by(6, |a, b| a.0.total_cmp(&b.0));
        ratios.extend(near[..6].iter().map(|&(distance, j)| distance / (0.5 * (own + wanted(j)))));
    }
    let count = ratios.len() as f64;
    let good = ratios.iter().filter(|ratio| (0.8..=1.25).contains(*ratio)).count() as f64 / count;
    Fit { good, mean: ratios.iter().sum::<f64>() / count, range: range[1] / range[0] }
}

fn formula(text: &str) -> Formula {
    Formula::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

const SPHERE: &str = "x^2 + y^2 + z^2 = 1";
const TORUS: &str = "(sqrt(x^2 + y^2) - 1)^2 + z^2 = 0.16";
const CYCLIDE: &str = "(x^2 + y^2 + z^2 + 0.75 - 0.36)^2 = 4 (x - 0.1)^2 + 4 * 0.75 y^2";

/// Spacings from 10 to 1 on surfaces between −1.5 and 1.5.
type Wish = (&'static str, fn(DVec3) -> f64);

const WISHES: [Wish; 4] = [
    ("0.16 (1 - 0.82 z)/1.82", |p| 0.16 * (1.0 - 0.82 * p.z) / 1.82),
    ("0.02 + 0.1 hypot(x, y)", |p| 0.02 + 0.1 * libm::hypot(p.x, p.y)),
    ("0.06 + 0.03 sin(4 x)", |p| 0.06 + 0.03 * libm::sin(4.0 * p.x)),
    // A jump.
    ("if(x > 0, 0.03, 0.15)", |p| if p.x > 0.0 { 0.03 } else { 0.15 }),
];

#[test]
fn particles_are_as_far_apart_as_a_formula_asks() {
    let mut misses = Vec::new();
    for surface in [SPHERE, TORUS, CYCLIDE] {
        let field = formula(surface);
        for (text, wish) in WISHES {
            // The mesh of a refined run has a few stretched triangles where sizes change most.
            // Beside a jump sizes change as fast as they may over a band of many particles.
            let is_jump = text.starts_with("if");
            let [front, refined] = if is_jump { [0.96, 0.94] } else { [0.98, 0.97] };
            for (method, least) in [(Method::Front, front), (Method::Refined, refined)] {
                let settings = settings!(method; ..Settings::default());
                let spacing = Spacing::parse(text).expect("a formula");
                let sample = sample(&field, &settings.spaced(spacing)).expect("a sample");
                let fit = fit(&sample, &field, &wish, settings.grading);
                let says = format!("{surface}, {text}, {method:?}: {} {fit:?}", sample.report().count);
                println!("{says}");
                if fit.good < least || (fit.mean - 1.0).abs() > 0.06 {
                    misses.push(says);
                }
            }
        }
    }
    assert!(misses.is_empty(), "{misses:#?}");
}

/// A smooth surface of random waves around a sphere.
fn blob(rng: &mut Pcg64Mcg) -> String {
    let waves: Vec<String> = (0..4)
        .map(|_| {
            let [a, b, c, phase] = [0; 4].map(|_| 6.0 * random(rng) - 3.0);
            format!("0.04 sin({a:.3} x + {b:.3} y + {c:.3} z + {phase:.3})")
        })
        .collect();
    format!("x^2 + y^2 + z^2 - 1 + {}", waves.join(" + ")).replace("+ -", "- ")
}

#[test]
fn random_spacings_are_met_on_random_surfaces() {
    let rng = &mut Pcg64Mcg::new(0xB10B);
    for _ in 0..4 {
        let surface = blob(rng);
        let field = formula(&surface);
        let [a, b, c, phase] = [0; 4].map(|_| 4.0 * random(rng) - 2.0);
        let wish = move |p: DVec3| 0.05 + 0.04 * libm::sin(a * p.x + b * p.y + c * p.z + phase);
        for settings in [Settings::default(), Settings::default().refined(), Settings::with_count(2_000)] {
            let sample = sample(&field, &settings.spaced(Spacing::by(wish))).expect("a sample");
            // Of a count the function is the ratio, which the largest slope limits at its scale.
            let radii = &sample.particles().radius;
            let mut scales: Vec<f64> = (0..radii.len())
                .map(|i| 2.0 * f64::from(radii[i]) / wish(sample.particles().place(i)))
                .collect();
            scales.sort_by(f64::total_cmp);
            let scale = if settings.size_mode == SizeMode::Count { scales[scales.len() / 2] } else { 1.0 };
            let scaled = move |p: DVec3| scale * wish(p);
            let fit = fit(&sample, &field, &scaled, settings.grading);
            println!("{surface}, {:?}: {} {fit:?}", settings.method, sample.report().count);
            assert!(fit.good >= 0.98, "{surface}, {settings:?}: {fit:?}");
            if settings.size_mode == SizeMode::Count {
                assert!(sample.report().count.abs_diff(2_000) <= 60, "{}", sample.report().count);
            }
        }
    }
}

#[test]
fn formula_and_functions_give_the_same_particles_in_any_steps() {
    let field = formula(SPHERE);
    // In double precision, as functions are evaluated.
    let [pointwise, batched] = [
        Spacing::by(|p: DVec3| 0.1 + 0.05 * p.x),
        Spacing::by(|points: &[DVec3], s: &mut [f64]| -> Result<(), std::io::Error> {
            points.iter().zip(s).for_each(|(p, s)| *s = 0.1 + 0.05 * p.x);
            Ok(())
        }),
    ];
    for settings in [Settings::default(), Settings::default().refined()] {
        let digest = |spacing: &Spacing, budget: u32| {
            let mut run = Run::start(&field, &settings.spaced(spacing.clone())).expect("a run");
            while run.step(budget).stop_reason.is_none() {}
            run.particles().digest()
        };
        let whole = digest(&pointwise, u32::MAX);
        assert_eq!(digest(&batched, u32::MAX), whole);
        assert_eq!(digest(&pointwise, 7), whole);
        let text = Spacing::parse("0.1 + 0.05 x").expect("a formula");
        let (a, b) =
            (sample(&field, &settings.spaced(text)), sample(&field, &settings.spaced(pointwise.clone())));
        let [a, b] = [a, b].map(|sample| sample.expect("a sample").report().count);
        assert!(a.abs_diff(b) <= a / 50, "{a} by a formula, {b} by a function");
    }
}

#[test]
fn a_surface_far_from_the_origin_has_the_same_sizes() {
    let far = formula("(x - 1e3)^2 + y^2 + (z + 700)^2 = 1");
    let bounds = Bounds { min: [1e3 - 1.2, -1.2, -701.2], max: [1e3 + 1.2, 1.2, -698.8] };
    let spacing = Spacing::parse("0.1 + 0.08 (x - 1e3)").expect("a formula");
    let wish = |p: DVec3| 0.1 + 0.08 * (p.x - 1e3);
    let settings = Settings::default().in_box(bounds);
    let sample = sample(&far, &settings.spaced(spacing)).expect("a sample");
    let fit = fit(&sample, &far, &wish, 0.2);
    assert!(fit.good >= 0.98 && fit.range > 4.0, "{fit:?}");
}

#[test]
fn with_adaptive_sampling_the_smaller_size_is_met() {
    let field = formula("x^2/4 + y^2 + z^2/0.25 = 1");
    let by_curvature = sample(&field, &Settings::with_chord_error(5e-4)).expect("a sample");
    let spacing = Spacing::parse("if(x > 0, 0.06, 10)").expect("a formula");
    let both = sample(&field, &Settings::with_chord_error(5e-4).spaced(spacing)).expect("a sample");
    let largest = |sample: &Sample, side: f64| {
        let particles = sample.particles();
        let on_side = (0..particles.len()).filter(|&i| side * particles.place(i).x > 0.7);
        on_side.map(|i| particles.radius[i]).fold(0.0, f32::max)
    };
    assert!(largest(&by_curvature, 1.0) > 0.035);
    assert!(largest(&both, 1.0) <= 0.030_001);
    let same = largest(&both, -1.0) / largest(&by_curvature, -1.0);
    assert!((same - 1.0).abs() < 0.02, "{same}");
}

#[test]
fn limits_hold_and_make_a_spacing_of_zero_good() {
    let field = formula(SPHERE);
    let spacing = |text: &str| Spacing::parse(text).expect("a formula");
    let limited = spacing("0.3 z").at_least(0.05).at_most(0.2);
    let sample = sample(&field, &Settings::default().spaced(limited)).expect("a sample");
    let sizes = sample.report().sizes;
    assert!((2.0 * sizes.radius_min - 0.05).abs() < 1e-6, "{sizes:?}");
    assert!((2.0 * sizes.radius_max - 0.2).abs() < 0.01, "{sizes:?}");
    for (smallest, largest, name) in
        [(0.3, 0.2, "spacing_min"), (0.0, 0.2, "spacing_min"), (0.1, f64::NAN, "spacing_max")]
    {
        let bad = spacing("0.1").at_least(smallest).at_most(largest);
        match Run::start(&field, &Settings::default().spaced(bad)) {
            Err(Error::Settings(SettingsError::OutOfRange { name: found, .. })) => assert_eq!(found, name),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn a_spacing_that_is_no_length_on_the_surface_is_refused_with_its_place() {
    let field = formula(SPHERE);
    let refusal = |text: &str| {
        let spacing = Spacing::parse(text).expect("a formula");
        match sample(&field, &Settings::default().spaced(spacing)) {
            Err(Error::Settings(error @ SettingsError::Spacing { .. })) => error,
            other => panic!("{text}: {:?}", other.map(|sample| sample.report().count)),
        }
    };
    for text in ["0.1 z", "0", "-1", "0.1 sqrt(z)", "0.1 ln(z + 0.5)"] {
        let error = refusal(text);
        let SettingsError::Spacing { value, position } = error else { unreachable!() };
        let radius = DVec3::from_array(position).length();
        assert!((radius - 1.0).abs() < 1e-3, "{text}: {position:?} is on the surface");
        assert!(value.is_nan() || value <= 0.0, "{text}: {value}");
        assert!(error.to_string().starts_with("the spacing "), "{error}");
    }
    // Far from the surface it may be anything, and infinity is as large as sizes can be.
    for text in ["if(hypot(x, y, z) < 0.5, -1, 0.1)", "0.1 + 0.01/max(z, 0)", "0.15/abs(z)"] {
        let spacing = Spacing::parse(text).expect("a formula");
        let sample =
            sample(&field, &Settings::default().spaced(spacing)).unwrap_or_else(|e| panic!("{text}: {e}"));
        assert!(sample.report().count > 30, "{text}: {}", sample.report().count);
    }
}

#[test]
fn a_place_between_the_points_of_the_survey_is_found_at_the_end() {
    let hole = |p: DVec3| if p.distance(DVec3::new(0.6, 0.64, 0.48)) < 0.03 { f64::NAN } else { 0.03 };
    match sample(formula(SPHERE), &Settings::default().spaced(Spacing::by(hole))) {
        Err(Error::Settings(SettingsError::Spacing { value, .. })) => assert!(value.is_nan()),
        other => panic!("{:?}", other.map(|sample| sample.report().count)),
    }
}

#[test]
fn functions_may_fail_and_their_calls_are_limited() {
    let field = formula(SPHERE);
    let asked = Arc::new(AtomicU64::new(0));
    let seen = Arc::clone(&asked);
    let failing = move |points: &[DVec3], s: &mut [f64]| {
        s.fill(0.05);
        if seen.fetch_add(points.len() as u64, Ordering::Relaxed) > 8_000 { Err("no more") } else { Ok(()) }
    };
    let error = |spacing: Spacing| match sample(&field, &Settings::default().spaced(spacing)) {
        Err(Error::Settings(error @ SettingsError::SpacingFunction(_))) => error.to_string(),
        other => panic!("{:?}", other.map(|sample| sample.report().count)),
    };
    assert_eq!(error(Spacing::by(failing)), "the function of the spacing has failed: no more");
    assert!(asked.load(Ordering::Relaxed) < 10_000);
    let limited = FnField::new(|_: DVec3| 0.05).limit_calls(5_000);
    assert!(error(Spacing::by(limited)).contains("more than 5000 points"));
    let at_once = BatchField::new(|_: &[DVec3], _: &mut [f64]| Err::<(), _>("not at all"));
    assert!(error(Spacing::by(at_once)).ends_with("not at all"));
}

#[test]
fn it_is_said_where_sizes_follow_more_slowly() {
    let field = formula(SPHERE);
    let smoothed = |text: &str| {
        let spacing = Spacing::parse(text).expect("a formula");
        let run = Run::start(&field, &Settings::default().spaced(spacing)).expect("a run");
        run.start_report().warnings.iter().find_map(|warning| match warning {
            Warning::Smoothed { share, ratio, position, .. } => Some((*share, *ratio, *position)),
            _ => None,
        })
    };
    assert_eq!(smoothed("0.1 + 0.05 z"), None);
    // From 0.02 to 0.2 at the slope 0.4 sizes rise for 0.45 along the surface, at latitudes of
    // nearly as many radians: half the sine of these is the share of the area.
    let (share, ratio, [x, ..]) = smoothed("if(x > 0, 0.02, 0.2)").expect("it is smoothed");
    assert!((share - 0.2).abs() < 0.05, "{share}");
    assert!(ratio > 5.0 && (-0.12..=0.0).contains(&x), "{ratio} at {x}");
}

#[test]
fn mistakes_in_a_formula_are_those_of_formulas() {
    for (text, says) in [
        ("", "A spacing is a number such as `0.1`, or a formula such as `0.02 + 0.1 hypot(x, y)`"),
        ("0.1 q", "The formula has no parameter `q`: a spacing is made of x, y, z"),
        ("x = 0.1", "A spacing has no `=`"),
        ("0.1 {x > 0}", "A spacing has no condition in braces: `if(z > 0, 0.02, 0.1)` chooses one"),
    ] {
        let error = Spacing::parse(text).expect_err(text);
        assert!(error.to_string().starts_with(says), "{text}: {error}");
    }
}

#[test]
fn a_spacing_that_falls_to_zero_is_limited_by_the_largest() {
    let sphere = Formula::parse("x^2 + y^2 + z^2 = 1").expect("a formula");
    let spacing = Spacing::parse("1 + z").expect("a formula");
    let made = sample(sphere, &Settings::with_count(1_000).spaced(spacing)).expect("a sample");
    let radii = &made.particles().radius;
    let [least, most] = radii.iter().fold([f32::INFINITY, 0.0], |[a, b], &r| [a.min(r), b.max(r)]);
    assert!(least > most / 2_000.0, "{least} of {most}");
    assert!((900..1_100).contains(&made.report().count), "{}", made.report().count);
}
