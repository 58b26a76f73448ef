//! Claims about every surface of the gallery.

use glam::{DVec3, Vec3};
use marching_particles::field::gallery::{self, SURFACES, Surface};
use marching_particles::field::{Field, Jet};
use marching_particles::math::Sym3;
use rand_core::Rng;

/// Pseudo-random points of the surface's box, the same in every run.
fn points(surface: &Surface, count: usize) -> Vec<DVec3> {
    let mut random = rand_pcg::Pcg32::new(7, 11);
    let mut unit = || f64::from(random.next_u32()) / f64::from(u32::MAX);
    let (lo, hi) = (surface.bounds.lo(), surface.bounds.hi());
    (0..count).map(|_| lo + (hi - lo) * DVec3::new(unit(), unit(), unit())).collect()
}

fn entries(hessian: &Sym3<f64>) -> [f64; 6] {
    [hessian.xx, hessian.xy, hessian.xz, hessian.yy, hessian.yz, hessian.zz]
}

/// Central differences of f, and of ∇f, with a step of `h`.
fn differences(field: &mut dyn Field, p: DVec3, h: f64) -> (DVec3, [f64; 6]) {
    let mut ends = |axis: DVec3| (field.jet(p - axis * h), field.jet(p + axis * h));
    let pairs: [(Jet, Jet); 3] = [ends(DVec3::X), ends(DVec3::Y), ends(DVec3::Z)];
    let gradient = DVec3::from_array(pairs.map(|(a, b)| (b.value - a.value) / (2.0 * h)));
    let [x, y, z] = pairs.map(|(a, b)| (b.gradient - a.gradient) / (2.0 * h));
    (gradient, [x.x, y.x, z.x, y.y, z.y, z.z])
}

#[test]
fn derivatives_agree_with_central_differences() {
    // The error of a central difference is about h² in the third derivative plus 1e-16/h in rounding.
    const STEP: f64 = 1e-5;
    const TOLERANCE: f64 = 1e-6;
    for surface in SURFACES {
        let mut field = surface.field();
        for p in points(surface, 200) {
            let jet = field.jet(p);
            let (gradient, hessian) = differences(&mut field, p, STEP);
            let size = jet.value.abs() + jet.gradient.length() + 1.0;
            assert!(
                (jet.gradient - gradient).length() <= TOLERANCE * size,
                "{} at {p}: gradient {} but difference {gradient}",
                surface.id,
                jet.gradient,
            );
            let size = size + entries(&jet.hessian).iter().map(|e| e.abs()).sum::<f64>();
            for (entry, difference) in entries(&jet.hessian).into_iter().zip(hessian) {
                assert!(
                    (entry - difference).abs() <= TOLERANCE * size,
                    "{} at {p}: Hessian {:?} but difference {hessian:?}",
                    surface.id,
                    jet.hessian,
                );
            }
        }
    }
}

#[test]
fn batches_agree_with_double_precision() {
    for surface in SURFACES {
        let mut field = surface.field();
        let points: Vec<Vec3> = points(surface, 203).iter().map(|p| p.as_vec3()).collect();
        let n = points.len();
        let mut values = vec![0.0; n];
        field.values(&points, &mut values);
        let (mut value, mut gradient) = (vec![0.0; n], vec![Vec3::ZERO; n]);
        field.gradients(&points, &mut value, &mut gradient);
        let mut hessian = vec![Sym3::default(); n];
        let (mut value2, mut gradient2) = (vec![0.0; n], vec![Vec3::ZERO; n]);
        field.hessians(&points, &mut value2, &mut gradient2, &mut hessian);
        let jets: Vec<Jet> = points.iter().map(|p| field.jet(p.as_dvec3())).collect();
        // Rounding is relative to the terms that are summed, which are as large as the field ever is in the box.
        let size = |of: &dyn Fn(&Jet) -> f64| jets.iter().map(of).fold(1.0, f64::max);
        let sizes = [
            size(&|jet| jet.value.abs()),
            size(&|jet| jet.gradient.length()),
            size(&|jet| entries(&jet.hessian).iter().map(|e| e.abs()).sum()),
        ];
        for k in 0..n {
            let jet = jets[k];
            let id = surface.id;
            let close = |a: f64, b: f64, size: f64| (a - b).abs() <= 4e-6 * size;
            for value in [values[k], value[k], value2[k]] {
                assert!(close(value.into(), jet.value, sizes[0]), "{id} at {}: {value} {jet:?}", points[k]);
            }
            for gradient in [gradient[k], gradient2[k]] {
                let error = (gradient.as_dvec3() - jet.gradient).length();
                assert!(error <= 4e-6 * sizes[1], "{id} at {}: {gradient} {jet:?}", points[k]);
            }
            let h = hessian[k];
            for (a, b) in [h.xx, h.xy, h.xz, h.yy, h.yz, h.zz].into_iter().zip(entries(&jet.hessian)) {
                assert!(close(a.into(), b, sizes[2]), "{id} at {}: {h:?} {jet:?}", points[k]);
            }
        }
    }
}

#[test]
fn a_value_lies_in_the_interval_of_every_box_that_holds_its_point() {
    for surface in SURFACES {
        let mut field = surface.field();
        let diagonal = surface.bounds.diagonal();
        for (k, p) in points(surface, 300).into_iter().enumerate() {
            let half = DVec3::splat(diagonal * 0.5_f64.powi((k % 12).try_into().unwrap()));
            // The point sits off the middle of its box.
            let lo = p - half * 0.3;
            let hi = p + half * 0.7;
            let bounds = field.interval(lo, hi);
            let value = field.jet(p).value;
            assert!(
                value.is_nan() && !bounds.defined || bounds.lo <= value && value <= bounds.hi,
                "{} at {p}: {value} outside {bounds:?} of {lo} … {hi}",
                surface.id,
            );
        }
    }
}

#[test]
fn small_boxes_off_the_surface_are_proven_empty() {
    for surface in SURFACES {
        let mut field = surface.field();
        let half = DVec3::splat(surface.bounds.diagonal() * 1e-5);
        let mut proven = 0;
        let all = points(surface, 200);
        for &p in &all {
            let bounds = field.interval(p - half, p + half);
            proven += usize::from(bounds.lo > 0.0 || bounds.hi < 0.0);
        }
        assert!(proven * 10 >= all.len() * 9, "{}: {proven} of {} boxes", surface.id, all.len());
    }
}

#[test]
fn identifiers_are_unique_and_findable() {
    for surface in SURFACES {
        assert!(core::ptr::eq(gallery::find(surface.id).unwrap(), surface), "{}", surface.id);
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        assert!(surface.id.chars().all(plain), "{}", surface.id);
    }
    assert!(gallery::find("no-such-surface").is_none());
}

#[test]
fn every_parameter_is_used_and_starts_inside_its_range() {
    for surface in SURFACES {
        assert!(surface.bounds.is_valid(), "{}", surface.id);
        let field = surface.field();
        let used: Vec<&str> = field.parameters().iter().map(|p| p.name.as_str()).collect();
        let declared: Vec<&str> = surface.parameters.iter().map(|p| p.name).collect();
        assert_eq!(used, declared, "{}", surface.id);
        assert!(field.auto().is_empty(), "{}", surface.id);
        for p in surface.parameters {
            assert!(p.min <= p.value && p.value <= p.max && p.step > 0.0, "{} {}", surface.id, p.name);
        }
    }
}
