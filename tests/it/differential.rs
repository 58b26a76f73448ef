//! Tests of curvatures against closed forms and finite differences.

use glam::{DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::field::Frame;
use marching_particles::field::Sym3;
use marching_particles::field::gallery::{self, SURFACES};
use marching_particles::field::{Field, Jet};
use marching_particles::internal::differential::{Curvature, curvatures, curvatures_of, exact_curvature};
use rand_core::Rng;

/// Tolerance for double precision.
const RELATIVE: f64 = 1e-5;

/// The curvature for one pair of a gradient and a Hessian.
fn curvature(gradient: Vec3, hessian: Sym3<f32>) -> Curvature {
    let mut out = [Curvature::default()];
    curvatures_of(&[gradient], &[hessian], &mut out);
    out[0]
}

/// Points of the surface near pseudo-random points of the box, the same in every run.
fn surface_points(field: &dyn Field, bounds: &Bounds, count: usize) -> Vec<DVec3> {
    let mut random = rand_pcg::Pcg32::new(3, 5);
    let mut unit = || f64::from(random.next_u32()) / f64::from(u32::MAX);
    let (lo, hi) = (bounds.lo(), bounds.hi());
    let mut points = Vec::new();
    for _ in 0..100 * count {
        let mut p = lo + (hi - lo) * DVec3::new(unit(), unit(), unit());
        for _ in 0..20 {
            let jet = field.jet(p);
            p -= jet.gradient * (jet.value / jet.gradient.length_squared());
        }
        let jet = field.jet(p);
        let inside = p.cmpge(lo).all() && p.cmple(hi).all();
        if inside && jet.value.abs() <= 1e-12 * jet.gradient.length() {
            points.push(p);
            if points.len() == count {
                break;
            }
        }
    }
    assert!(points.len() > count / 2, "{} points of the surface found", points.len());
    points
}

/// Points of a gallery surface, with the curvature at each.
fn sampled(id: &str, count: usize) -> Vec<(DVec3, Curvature<f64, DVec3>)> {
    let surface = gallery::find(id).expect("a surface of the gallery");
    let field = surface.field();
    let points = surface_points(&field, &surface.bounds, count);
    points.into_iter().map(|p| (p, exact_curvature(&field.jet(p)))).collect()
}

#[track_caller]
fn assert_close(got: f64, exact: f64, what: &str, p: DVec3) {
    assert!((got - exact).abs() <= RELATIVE * exact.abs(), "{what} at {p}: {got}, exactly {exact}");
}

#[test]
fn a_sphere_has_the_same_curvature_everywhere() {
    for (p, k) in sampled("sphere", 200) {
        assert_close(k.k1, 1.0, "κ₁", p);
        assert_close(k.k2, 1.0, "κ₂", p);
        assert_close(k.mean(), 1.0, "mean", p);
        assert_close(k.gaussian(), 1.0, "Gaussian", p);
        assert!((k.direction.length() - 1.0).abs() < 1e-12 && k.direction.dot(p).abs() < 1e-12);
    }
}

#[test]
fn a_torus_has_the_curvatures_of_its_circles() {
    let (ring, tube) = (1.0, 0.4);
    for (p, k) in sampled("torus", 500) {
        let axis_distance = p.truncate().length();
        let around_tube = 1.0 / tube;
        let along_ring = (axis_distance - ring) / (tube * axis_distance);
        assert_close(k.k1, around_tube, "κ₁", p);
        assert!((k.k2 - along_ring).abs() <= RELATIVE * around_tube, "κ₂ at {p}: {}", k.k2);
        // κ₁ is the curvature of the tube, so its direction is in the plane of the tube's
        // cross-section.
        let along = DVec3::new(-p.y, p.x, 0.0) / axis_distance;
        assert!(k.direction.dot(along).abs() < 1e-6, "direction at {p}: {}", k.direction);
        assert_close(k.max_abs(), around_tube, "max|κ|", p);
    }
}

#[test]
fn an_ellipsoid_has_the_curvatures_of_the_closed_form() {
    let [a, b, c] = [1.0_f64, 0.7, 0.5].map(|axis| axis * axis);
    for (p, k) in sampled("ellipsoid", 500) {
        // With w = Σ x_i²/a_i⁴: K = 1/((abc)² w²), and 2H = (a² + b² + c² − |p|²) / ((abc)²
        // w^{3/2}).
        let w = p.x * p.x / (a * a) + p.y * p.y / (b * b) + p.z * p.z / (c * c);
        let gaussian = 1.0 / (a * b * c * w * w);
        let mean = 0.5 * (a + b + c - p.length_squared()) / (a * b * c * w * w.sqrt());
        assert_close(k.gaussian(), gaussian, "Gaussian", p);
        assert_close(k.mean(), mean, "mean", p);
        let root = (mean * mean - gaussian).max(0.0).sqrt();
        assert!(
            (k.k1 - mean - root).abs() <= RELATIVE * mean,
            "κ₁ at {p}: {}, exactly {}",
            k.k1,
            mean + root
        );
        assert!(
            (k.k2 - mean + root).abs() <= RELATIVE * mean,
            "κ₂ at {p}: {}, exactly {}",
            k.k2,
            mean - root
        );
    }
}

#[test]
fn normals_of_the_gallery_turn_as_the_curvature_says() {
    let normal = |field: &dyn Field, p: DVec3| {
        let gradient = field.jet(p).gradient;
        gradient / gradient.length()
    };
    for surface in SURFACES.iter() {
        let mut field = surface.field();
        let diagonal = surface.bounds.diagonal();
        let mut compared = 0;
        let points = surface_points(&field, &surface.bounds, 200);
        for &p in &points {
            let jet = field.jet(p);
            let k = exact_curvature(&jet);
            let n = jet.gradient / jet.gradient.length();
            let size = k.max_abs() + 1.0 / diagonal;
            for (kappa, d) in [(k.k1, k.direction), (k.k2, n.cross(k.direction))] {
                let mut difference =
                    |h: f64| (normal(&mut field, p + d * h) - normal(&mut field, p - d * h)) / (2.0 * h);
                let h = 2e-4 / size;
                let (coarse, fine) = (difference(h), difference(0.5 * h));
                // A difference that changes when the step is halved is not that of a smooth normal,
                // as at the joints of the drilled block's blends and at the foot of a cone. Such
                // points are skipped.
                if (coarse - fine).length() > 0.5 * RELATIVE * size {
                    continue;
                }
                compared += 1;
                assert!(
                    (fine - d * kappa).length() <= RELATIVE * size,
                    "{} at {p}: ∂n = {fine} along {d}, but κ = {kappa}",
                    surface.id
                );
            }
        }
        assert!(compared >= 2 * points.len() * 9 / 10, "{}: only {compared} compared", surface.id);
    }
}

#[test]
fn single_precision_and_lanes_agree_with_double() {
    for surface in SURFACES.iter() {
        let field = surface.field();
        let points: Vec<Vec3> =
            surface_points(&field, &surface.bounds, 203).iter().map(|p| p.as_vec3()).collect();
        let n = points.len();
        let (mut value, mut gradient) = (vec![0.0; n], vec![Vec3::ZERO; n]);
        let mut hessian = vec![Sym3::default(); n];
        field.evaluator(Frame::default()).hessians(&points, &mut value, &mut gradient, &mut hessian);
        let mut lanes = vec![Curvature::default(); n];
        curvatures_of(&gradient, &hessian, &mut lanes);
        let mut of_field = vec![Curvature::default(); n];
        curvatures(&mut *field.evaluator(Frame::default()), &points, &mut of_field);
        assert_eq!(lanes, of_field, "{}", surface.id);
        let mut errors: Vec<f64> = Vec::new();
        for k in 0..n {
            assert_eq!(lanes[k], curvature(gradient[k], hessian[k]), "{} at {}", surface.id, points[k]);
            let exact = exact_curvature(&field.jet(points[k].as_dvec3()));
            let error = (f64::from(lanes[k].k1) - exact.k1).abs() + (f64::from(lanes[k].k2) - exact.k2).abs();
            // The size of the box stands for the radius of curvature of what is flat.
            errors.push(error / exact.max_abs().max(1.0 / surface.bounds.diagonal()));
        }
        // Near singular points the formulas suffer from cancellation in single precision.
        errors.sort_by(f64::total_cmp);
        assert!(errors[n * 9 / 10] < 1e-3, "{}: {:e}", surface.id, errors[n * 9 / 10]);
        if surface.smooth {
            assert!(errors[n - 1] < 1e-2, "{}: {:e}", surface.id, errors[n - 1]);
        }
    }
}

#[test]
fn a_plane_and_a_sphere_give_a_unit_direction() {
    for (gradient, hessian) in [
        (Vec3::new(0.0, 0.0, -3.0), Sym3::default()),
        (Vec3::new(0.6, 0.8, 0.0), Sym3 { xx: 2.0, yy: 2.0, zz: 2.0, ..Sym3::default() }),
    ] {
        let k = curvature(gradient, hessian);
        assert!(k.is_defined());
        assert!((k.k1 - k.k2).abs() < 1e-6);
        assert!((k.direction.length() - 1.0).abs() < 1e-6);
        assert!(k.direction.dot(gradient).abs() < 1e-6);
    }
}

#[test]
fn nothing_is_defined_where_the_gradient_vanishes_or_anything_is_not_finite() {
    let flat = Sym3 { xx: 1.0, ..Sym3::default() };
    let mut cases: Vec<(Vec3, Sym3<f32>)> =
        vec![(Vec3::ZERO, flat), (Vec3::splat(1e-30), flat), (Vec3::splat(1e25), flat)];
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let mut gradient = Vec3::ONE;
            gradient[axis] = bad;
            cases.push((gradient, flat));
        }
        for entry in 0..6 {
            let mut h = flat;
            *[&mut h.xx, &mut h.xy, &mut h.xz, &mut h.yy, &mut h.yz, &mut h.zz][entry] = bad;
            cases.push((Vec3::new(0.3, -0.5, 0.8), h));
        }
    }
    let (gradient, hessian): (Vec<Vec3>, Vec<Sym3<f32>>) = cases.iter().copied().unzip();
    let mut lanes = vec![Curvature::default(); cases.len()];
    curvatures_of(&gradient, &hessian, &mut lanes);
    for ((gradient, hessian), lane) in cases.into_iter().zip(lanes) {
        for k in [curvature(gradient, hessian), lane] {
            assert!(!k.is_defined(), "{gradient} {hessian:?}: {k:?}");
            assert!(k.k1.is_nan() && k.k2.is_nan() && k.direction.is_nan(), "{gradient} {hessian:?}: {k:?}");
            assert!(k.mean().is_nan() && k.gaussian().is_nan() && k.max_abs().is_nan());
        }
    }
    assert!(!exact_curvature(&Jet::default()).is_defined());
}
