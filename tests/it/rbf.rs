//! Tests of fields from points: the fit, its errors, and the evaluation against the sum in double
//! precision.

use crate::runs::run;
use glam::{DVec3, Vec3};
use marching_particles::Report;
use marching_particles::field::Field;
use marching_particles::field::Frame;
use marching_particles::field::Sym3;
use marching_particles::field::model::{self, MODELS};
use marching_particles::field::rbf::{DataError, Pull, RbfData, RbfField};
use marching_particles::internal::session::{FieldRequest, Session};
use marching_particles::internal::slices::complete;
use marching_particles::pointcloud::fit::{Fit, FitError, approximate};
use marching_particles::pointcloud::{Cloud, CloudError, ModelInfo};
use marching_particles::pointcloud::{fit_model, models};
use marching_particles::sampler::{Settings, StopReason};
use rand_core::Rng;
use rand_pcg::Pcg64Mcg;

fn of_model(id: &str) -> Fit {
    let model = model::find(id).expect("a built-in model");
    fit_model(model)
}

/// Points of an ellipsoid along a spiral, evenly spread.
fn ellipsoid(count: usize) -> Cloud {
    let axes = DVec3::new(1.0, 0.7, 0.5);
    let golden = core::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let mut cloud = Cloud::default();
    for k in 0..count {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / count as f64;
        let (sin, cos) = libm::sincos(golden * k as f64);
        let unit = DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z;
        cloud.position.push(unit * axes);
        cloud.normal.push((unit / axes).normalize_or_zero());
    }
    cloud
}

fn fitted(cloud: &Cloud) -> Result<Fit, FitError> {
    let all: Vec<u32> = (0..cloud.len() as u32).collect();
    complete(approximate(cloud, &all, &cloud.position, ModelInfo::default(), |_| {}))
}

/// A session that has sampled the surface of a fit, and its report.
pub(crate) fn sampled(fit: Fit, settings: &Settings) -> (Session, Report) {
    let mut session = Session::new();
    session.set_points(fit.data, fit.info, fit.bounds, &FieldRequest::default()).expect("a field");
    let report = run(&mut session, settings);
    (session, report)
}

/// Pseudo-random numbers between −1 and 1.
struct Random(Pcg64Mcg);

impl Random {
    fn new(seed: u128) -> Self {
        Self(Pcg64Mcg::new(seed))
    }

    fn number(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / f64::from(u32::MAX) * 2.0 - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }
}

#[test]
fn the_field_vanishes_at_the_points_and_has_their_normals_as_gradients() {
    for model in MODELS {
        let cloud = models::cloud(model.id).expect("a model has points");
        let fit = of_model(model.id);
        for (centre, (p, n)) in fit.data.centres.iter().zip(cloud.position.iter().zip(&cloud.normal)) {
            let centre = DVec3::from_array(*centre);
            assert!(centre.distance(*p) < 1e-7, "{}: a point moved to {centre}", model.id);
            let jet = fit.data.jet(centre);
            assert!(jet.value.abs() < 1e-10, "{}: {} at {centre}", model.id, jet.value);
            assert!(jet.gradient.distance(*n) < 1e-9, "{}: {} at {centre}", model.id, jet.gradient);
        }
        assert!(fit.info.condition > 1e5 && fit.info.condition < 1e9, "{}: {:?}", model.id, fit.info);
        assert!(fit.info.residual_max < 1e-5, "{}: {:?}", model.id, fit.info);
        assert_eq!((fit.info.points, fit.info.centres, &*fit.info.credit), (200, 200, model.credit));
    }
}

#[test]
fn points_between_the_centres_are_within_a_few_thousandths_of_the_surface() {
    let (few, many) = (ellipsoid(100), ellipsoid(4000));
    let all: Vec<u32> = (0..few.len() as u32).collect();
    let fit = complete(approximate(&few, &all, &many.position, ModelInfo::default(), |_| {}));
    let info = fit.expect("a field").info;
    assert_eq!((info.points, info.centres), (4000, 100));
    assert!(info.residual_mean > 1e-6 && info.residual_mean < 1e-3, "{info:?}");
    assert!(info.residual_max < 5e-3, "{info:?}");
}

#[test]
fn derivatives_agree_with_differences() {
    let data = of_model("bunny").data;
    let mut random = Random::new(7);
    let h = 1e-5;
    for _ in 0..200 {
        let p = random.vector() * 1.2;
        let jet = data.jet(p);
        let hessian = [DVec3::X, DVec3::Y, DVec3::Z].map(|e| jet.hessian.apply(e));
        for axis in 0..3 {
            let mut step = DVec3::ZERO;
            step[axis] = h;
            let (ahead, behind) = (data.jet(p + step), data.jet(p - step));
            let slope = (ahead.value - behind.value) / (2.0 * h);
            assert!((slope - jet.gradient[axis]).abs() < 1e-5, "∂{axis} at {p}: {slope} {}", jet.gradient);
            // Near a centre the third derivative, and with it the error of a difference, is large.
            let bend = (ahead.gradient - behind.gradient) / (2.0 * h);
            let nearest = data.centres.iter().map(|&c| p.distance(DVec3::from_array(c))).fold(1.0, f64::min);
            let allowed = 1e-4 + 1e-7 / nearest;
            assert!(bend.distance(hessian[axis]) < allowed, "∂∂{axis} at {p}: {bend} {}", hessian[axis]);
        }
    }
}

/// Points on the surface and off it, near a centre, on the faces of the octree's cells, and far
/// away.
fn places(fit: &Fit) -> Vec<Vec3> {
    let mut random = Random::new(11);
    let mut places = Vec::new();
    for k in 0..600 {
        let centre = DVec3::from_array(fit.data.centres[k % fit.data.centres.len()]);
        let mut p = centre + random.vector() * [0.1, 1e-3, 0.5][k % 3];
        if k % 2 == 0 {
            for _ in 0..6 {
                let jet = fit.data.jet(p);
                p -= jet.gradient * (jet.value / jet.gradient.length_squared());
            }
        }
        places.push(p.as_vec3());
    }
    places.extend([
        Vec3::ZERO,
        Vec3::splat(0.25),
        Vec3::splat(-0.5),
        Vec3::splat(3.9),
        Vec3::new(0.0, 4.0, 50.0),
    ]);
    places
}

#[test]
fn batches_agree_with_the_sum_in_double_precision() {
    for id in ["bunny", "sack-and-hat"] {
        let fit = of_model(id);
        let field = RbfField::new(fit.data.clone()).expect("a field");
        let places = places(&fit);
        let n = places.len();
        let mut value = vec![0.0; n];
        let mut gradient = vec![Vec3::ZERO; n];
        let mut hessian = vec![Sym3::<f32>::default(); n];
        field.evaluator(Frame::default()).hessians(&places, &mut value, &mut gradient, &mut hessian);
        let mut distances = Vec::new();
        for (i, &p) in places.iter().enumerate() {
            let jet = fit.data.jet(p.as_dvec3());
            let size = jet.gradient.length().max(1.0);
            // The coordinates are of the order of 1. Away from the surface the cells are larger and
            // less accurate.
            let off = (f64::from(value[i]) - jet.value).abs();
            let allowed = if jet.value.abs() < 1e-3 { 3e-5 } else { 2e-4 * (1.0 + jet.value.abs()) };
            assert!(off < allowed * size, "{id}: {} for {} at {p}", value[i], jet.value);
            let slope = gradient[i].as_dvec3().distance(jet.gradient);
            assert!(slope < 2e-3 * size, "{id}: {} for {} at {p}", gradient[i], jet.gradient);
            let nearest = fit
                .data
                .centres
                .iter()
                .map(|&c| p.as_dvec3().distance(DVec3::from_array(c)))
                .fold(9.0, f64::min);
            let bend = jet.hessian.apply(DVec3::ONE);
            let found = hessian[i].apply(Vec3::ONE).as_dvec3();
            assert!(
                found.distance(bend) < 0.02 * (1.0 + bend.length()) + 1e-4 / nearest,
                "{id}: {found} for {bend} at {p}"
            );
            if i % 2 == 0 && i < 600 {
                distances.push(off / jet.gradient.length());
            }
        }
        // On the surface, three quarters of the errors are within a tenth of the tolerance of
        // particles of the default radius.
        distances.sort_by(f64::total_cmp);
        let quartile = distances[distances.len() * 3 / 4] / fit.bounds.diagonal();
        assert!(quartile < 6e-7, "{id}: {quartile:e} of the diagonal");
    }
}

#[test]
fn exact_gradients_are_those_of_the_jet() {
    let fit = of_model("bunny");
    let mut field = RbfField::new(fit.data.clone()).expect("a field");
    let mut places = places(&fit);
    // The points include a centre that single precision represents exactly, if there is one.
    let mut data = RbfData::clone(&fit.data);
    data.centres[7] = [0.5, -0.25, 0.125];
    places.push(Vec3::new(0.5, -0.25, 0.125));
    let mut moved = RbfField::new(data.clone()).expect("a field");
    for (field, data) in [(&mut field, &*fit.data), (&mut moved, &data)] {
        let mut value = vec![0.0; places.len()];
        let mut gradient = vec![DVec3::ZERO; places.len()];
        field.evaluator(Frame::default()).exact_gradients(&places, &mut value, &mut gradient);
        for (i, &p) in places.iter().enumerate() {
            let jet = data.jet(p.as_dvec3());
            // The tolerance allows for the cancellation of hundreds of terms.
            let size = 1e-11 * (1.0 + jet.value.abs() + jet.gradient.length());
            assert!((value[i] - jet.value).abs() < size, "{} for {} at {p}", value[i], jet.value);
            assert!(gradient[i].distance(jet.gradient) < size, "{} for {} at {p}", gradient[i], jet.gradient);
        }
    }
}

#[test]
fn the_result_at_a_point_depends_on_the_point_alone() {
    let fit = of_model("rabbit");
    let places = places(&fit);
    let n = places.len();
    let field = RbfField::new(fit.data.clone()).expect("a field");
    let mut value = vec![0.0; n];
    let mut gradient = vec![Vec3::ZERO; n];
    field.evaluator(Frame::default()).gradients(&places, &mut value, &mut gradient);
    // The point is evaluated alone, in another order, with cells made by other points, and with
    // fewer and more derivatives.
    let other = RbfField::new(fit.data).expect("a field");
    let mut hessian = [Sym3::<f32>::default()];
    for i in (0..n).rev() {
        let (mut v, mut w, mut g) = ([0.0], [0.0], [Vec3::ZERO]);
        other.evaluator(Frame::default()).values(&places[i..=i], &mut v);
        other.evaluator(Frame::default()).hessians(&places[i..=i], &mut w, &mut g, &mut hessian);
        assert_eq!(v[0].to_bits(), value[i].to_bits(), "at {}", places[i]);
        assert_eq!((w[0].to_bits(), g[0]), (value[i].to_bits(), gradient[i]), "at {}", places[i]);
    }
    let mut v = [0.0; 3];
    other
        .evaluator(Frame::default())
        .values(&[Vec3::NAN, Vec3::INFINITY, Vec3::new(0.0, f32::NAN, 0.0)], &mut v);
    assert!(v.iter().all(|v| v.is_nan()), "{v:?}");
}

#[test]
fn a_centre_is_an_ordinary_point() {
    let fit = of_model("bunny");
    let field = RbfField::new(fit.data.clone()).expect("a field");
    for &centre in &fit.data.centres {
        let p = DVec3::from_array(centre).as_vec3();
        let (mut v, mut g, mut h) = ([1.0], [Vec3::ZERO], [Sym3::<f32>::default()]);
        field.evaluator(Frame::default()).hessians(&[p], &mut v, &mut g, &mut h);
        assert!(v[0].abs() < 3e-5 && (g[0].length() - 1.0).abs() < 1e-3, "{} {} at {p}", v[0], g[0]);
        assert!(h[0].apply(Vec3::ONE).is_finite(), "{:?} at {p}", h[0]);
    }
}

#[test]
fn the_field_is_invariant_under_scaling_and_translation() {
    let cloud = models::cloud("bunny").expect("points");
    let plain = fitted(&cloud).expect("a field");
    let (_, expected) = sampled(plain.clone(), &settings!(radius_share: 0.01; ..Settings::default()));
    // Scaling by a power of two keeps every bit.
    let scale = 2.0_f64.powi(-20);
    let small =
        fitted(&Cloud { position: cloud.position.iter().map(|&p| p * scale).collect(), ..cloud.clone() })
            .expect("a field");
    assert_eq!(small.info.condition.to_bits(), plain.info.condition.to_bits());
    for (a, b) in small.data.alpha.iter().zip(&plain.data.alpha) {
        assert_eq!(a * scale * scale, *b);
    }
    let (a, b) =
        (RbfField::new(small.data).expect("a field"), RbfField::new(plain.data.clone()).expect("a field"));
    let places = places(&plain);
    let scaled: Vec<Vec3> = places.iter().map(|&p| p * scale as f32).collect();
    let (mut of_a, mut of_b) = (vec![0.0; places.len()], vec![0.0; places.len()]);
    a.evaluator(Frame::default()).values(&scaled, &mut of_a);
    b.evaluator(Frame::default()).values(&places, &mut of_b);
    assert_eq!(of_a, of_b.iter().map(|value| value * scale as f32).collect::<Vec<_>>());
    // A hundred model sizes from the origin, single precision has two digits less.
    let away = DVec3::new(200.0, -150.0, 90.0);
    let far = Cloud { position: cloud.position.iter().map(|&p| p * 0.3 + away).collect(), ..cloud };
    let (_, report) =
        sampled(fitted(&far).expect("a field"), &settings!(radius_share: 0.01; ..Settings::default()));
    assert_eq!(report.stop_reason, Some(StopReason::Complete));
    let off = report.count.abs_diff(expected.count) as f64 / expected.count as f64;
    assert!(off < 0.03, "{} particles, not about {}", report.count, expected.count);
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn the_models_have_one_closed_component_and_the_joined_ears_a_handle() {
    for (id, euler) in [("bunny", 2), ("bunny-joined", 0), ("rabbit", 2), ("sack-and-hat", 2)] {
        let (_, report) =
            sampled(of_model(id), &settings!(radius_share: 0.003, seed: 2; ..Settings::default()));
        let quality = report.measures.quality.expect("there are particles");
        assert_eq!(report.stop_reason, Some(StopReason::Complete), "{id}");
        assert_eq!((quality.connectivity.euler, quality.connectivity.components), (euler, 1), "{id}");
        assert_eq!(quality.boundary_excluded, 0, "{id}: the surface leaves its box");
        assert!(quality.order.six_neighbours > 0.75 && quality.coverage.cover < 1.45, "{id}: {quality:?}");
    }
}

#[test]
fn the_models_have_nothing_outside_of_their_box() {
    // The search is dense: the cells of its grid are smaller than the thinnest part of any model.
    const NODES: usize = 61;
    for model in MODELS {
        let fit = of_model(model.id);
        let field = RbfField::new(fit.data).expect("a field");
        let (middle, half) =
            ((fit.bounds.lo() + fit.bounds.hi()) * 0.5, (fit.bounds.hi() - fit.bounds.lo()) * 0.5);
        let mut value = [0.0; NODES];
        let mut outside = 0;
        for row in 0..NODES * NODES {
            let at = |k: usize| 6.0 * k as f64 / (NODES - 1) as f64 - 3.0;
            let line: Vec<Vec3> = (0..NODES)
                .map(|k| (middle + half * DVec3::new(at(k), at(row % NODES), at(row / NODES))).as_vec3())
                .collect();
            field.evaluator(Frame::default()).values(&line, &mut value);
            for (p, value) in line.iter().zip(value) {
                if !fit.bounds.contains(*p) {
                    assert!(value > 0.0, "{}: {value} at {p}", model.id);
                    outside += 1;
                }
            }
        }
        assert!(outside > 200_000);
    }
}

#[test]
fn unusable_points_are_refused_with_the_reason() {
    let good = ellipsoid(30);
    let with = |change: &dyn Fn(&mut Cloud)| {
        let mut cloud = good.clone();
        change(&mut cloud);
        fitted(&cloud).expect_err("no field can be made")
    };
    assert_eq!(with(&|c| *c = ellipsoid(3)), FitError::TooFew { count: 3 });
    assert_eq!(with(&|c| *c = Cloud::default()), FitError::TooFew { count: 0 });
    let plane = with(&|c| c.position.iter_mut().for_each(|p| p.z = 0.25));
    assert_eq!(plane, FitError::Cloud(CloudError::Plane));
    // Two points are as near as allowed, with normals that point at each other. The system is
    // solved, with or without a warning.
    let mut cloud = good;
    cloud.position[20] = cloud.position[4] + DVec3::X * 3e-6;
    cloud.normal[20] = -cloud.normal[4];
    match fitted(&cloud) {
        Ok(fit) => assert!(!fit.info.warnings.is_empty() && fit.info.condition > 1e10, "{:?}", fit.info),
        Err(error) => {
            assert!(matches!(error, FitError::Singular { condition } if condition > 1e13), "{error}");
        }
    }
}

#[test]
fn bytes_hold_a_field_and_other_bytes_are_refused() {
    let data = RbfData::clone(&fitted(&ellipsoid(20)).expect("a field").data);
    let bytes = data.to_bytes();
    assert_eq!(bytes.len(), 8 + 20 * 56);
    assert_eq!(RbfData::from_bytes(&bytes), Ok(data.clone()));
    assert_eq!(RbfData::from_bytes(&[]), Err(DataError::Bytes));
    assert_eq!(RbfData::from_bytes(&bytes[..bytes.len() - 1]), Err(DataError::Bytes));
    assert_eq!(RbfData::from_bytes(&bytes[..bytes.len() - 8]), Err(DataError::Bytes));
    assert_eq!(RbfData::from_bytes(&bytes[..8]), Err(DataError::Empty));
    assert_eq!(RbfData::from_bytes(&bytes[8..]), Err(DataError::Bytes));
    let mut wrong = bytes;
    wrong[8 + 56 * 3..][..8].copy_from_slice(&f64::NAN.to_le_bytes());
    assert_eq!(RbfData::from_bytes(&wrong), Err(DataError::NotFinite { index: 3 }));
    let short = RbfData { alpha: vec![0.0; 19], ..data };
    assert_eq!(RbfField::new(short).err(), Some(DataError::Lengths { centres: 20, alpha: 19, beta: 20 }));
}

/// The bunny, and two pulls on it that meet: the second one moves what the first one has moved.
fn pulled_bunny() -> (Fit, [Pull; 2]) {
    let fit = fit_model(model::find("bunny").expect("a model"));
    let size = fit.bounds.diagonal();
    let at = DVec3::from(fit.data.centres[7]);
    let out = DVec3::new(0.03, 0.05, -0.02) * size;
    let first = Pull { at: at.into(), by: out.into(), reach: 0.2 * size };
    let second = Pull { at: (at + out).into(), by: [-0.04 * size, 0.0, 0.03 * size], reach: 0.15 * size };
    (fit, [first, second])
}

#[test]
fn a_pull_takes_its_place_along_and_leaves_what_is_far() {
    let (fit, pulls) = pulled_bunny();
    let own = RbfField::new(fit.data).expect("a field");
    let mut pulled = own.clone();
    pulled.pull(&pulls).expect("pulls");
    let [first, second] = pulls;
    let end = DVec3::from(second.at) + DVec3::from(second.by);
    let (there, before) = (pulled.jet(end).value, own.jet(first.at.into()).value);
    assert!((there - before).abs() < 1e-12, "{there} in the place of {before}");
    let far = DVec3::from(first.at) + DVec3::splat(2.0 * first.reach);
    assert_eq!(pulled.jet(far), own.jet(far));
    // The second derivatives of the model itself have no limit at its centres; the points are
    // beside them.
    let step = 1e-5 * first.reach;
    let mut random = Random::new(5);
    for _ in 0..40 {
        let p = end + random.vector() * 0.7 * second.reach;
        let jet = pulled.jet(p);
        for axis in 0..3 {
            let along = DVec3::AXES[axis] * step;
            let [(less, less_slope), (more, more_slope)] =
                [p - along, p + along].map(|q| pulled.value_and_gradient(q));
            let slope = (more - less) / (2.0 * step);
            assert!((slope - jet.gradient[axis]).abs() < 1e-6 * jet.gradient.length(), "{slope} at {p}");
            let bend = (more_slope - less_slope) / (2.0 * step);
            let known = DVec3::from_array([0, 1, 2].map(|k| jet.hessian.at(axis, k)));
            let size: f64 = jet.hessian.entries().iter().map(|entry| entry.abs()).sum();
            assert!((bend - known).length() < 1e-4 * size, "{bend} in the place of {known} at {p}");
        }
        let q = [p.as_vec3()];
        let exact = pulled.jet(q[0].as_dvec3());
        let (mut value, mut gradient, mut hessian) = ([0.0], [Vec3::ZERO], [Sym3::splat(0.0)]);
        pulled.evaluator(Frame::default()).hessians(&q, &mut value, &mut gradient, &mut hessian);
        let size = exact.gradient.length().max(1.0);
        // As accurate as the model itself is in batches.
        assert!((f64::from(value[0]) - exact.value).abs() < 2e-4 * (1.0 + exact.value.abs()) * size);
        assert!(gradient[0].as_dvec3().distance(exact.gradient) < 2e-3 * size);
        let (found, bend) = (hessian[0].apply(Vec3::ONE).as_dvec3(), exact.hessian.apply(DVec3::ONE));
        assert!(found.distance(bend) < 0.02 * (1.0 + bend.length()), "{found} for {bend} at {p}");
        let (mut slope, mut number) = ([Vec3::ZERO], [0.0]);
        pulled.evaluator(Frame::default()).gradients(&q, &mut number, &mut slope);
        assert!(slope[0].as_dvec3().distance(exact.gradient) < 2e-3 * size);
    }
}

#[test]
fn a_pull_that_would_tear_the_surface_is_refused_and_changes_nothing() {
    let (fit, [first, _]) = pulled_bunny();
    let mut field = RbfField::new(fit.data).expect("a field");
    field.pull(&[first]).expect("a pull");
    let too_short = Pull { reach: 1.9 * DVec3::from(first.by).length(), ..first };
    let endless = Pull { at: [f64::NAN, 0.0, 0.0], ..first };
    for wrong in [too_short, endless, Pull { reach: -first.reach, ..first }] {
        assert_eq!(field.pull(&[first, wrong]), Err(DataError::Pull { index: 1 }), "{wrong:?}");
        assert_eq!(field.pulls(), [first]);
    }
}

#[test]
fn the_particles_of_a_model_follow_a_pull_and_come_back() {
    let (fit, pulls) = pulled_bunny();
    let settings = Settings::with_count(3_000);
    let mut session = Session::new();
    let set = |session: &mut Session, pulls: &[Pull]| {
        let request = FieldRequest { pulls: pulls.to_vec(), ..FieldRequest::default() };
        session.set_points(fit.data.clone(), fit.info.clone(), fit.bounds, &request).expect("a field");
    };
    let finish = |session: &mut Session| while session.run.step(100_000).stop_reason.is_none() {};
    set(&mut session, &[]);
    session.start(&settings).expect("valid settings");
    finish(&mut session);
    let before = session.report();
    for step in (0..=10).chain((0..10).rev()) {
        let part = pulls.map(|pull| Pull { by: pull.by.map(|x| x * f64::from(step) / 10.0), ..pull });
        set(&mut session, &part[..1]);
        while session.fit(&|_| settings, true, 100_000).is_none() {}
        assert_eq!(session.follow(&settings, false), Ok(()), "step {step}");
        finish(&mut session);
        if step == 10 {
            let end = (DVec3::from(pulls[0].at) + DVec3::from(pulls[0].by)).as_vec3();
            let radius = session.run.particles().radius[0];
            let near = session.run.particles().local.iter().map(|p| p.distance(end));
            assert!(near.fold(f32::INFINITY, f32::min) < 1.5 * radius, "nothing has come along");
        }
    }
    let after = session.report();
    let off = after.count as f64 / before.count as f64;
    assert!((0.95..1.1).contains(&off), "{off} times as many");
    let figures = after.measures.quality.expect("figures");
    assert!(figures.coverage.cover < 1.5, "a hole of {}", figures.coverage.cover);
    assert!(figures.accuracy.error_max < 1e-3, "off by {}", figures.accuracy.error_max);
}
