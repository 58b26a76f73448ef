//! Tests of every surface of the gallery.

use crate::crease_box::euler_on_grid;
use crate::golden::checkout;
use glam::{DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::field::Frame;
use marching_particles::field::Sym3;
use marching_particles::field::formula::Formula;
use marching_particles::field::gallery::{self, SURFACES, Surface};
use marching_particles::field::model::MODELS;
use marching_particles::field::{Enclosure, Field, Jet};
use rand_core::Rng;
use std::collections::BTreeSet;

/// Pseudo-random points in the surface's box, the same in every run.
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
fn differences(field: &dyn Field, p: DVec3, h: f64) -> (DVec3, [f64; 6]) {
    let ends = |axis: DVec3| (field.jet(p - axis * h), field.jet(p + axis * h));
    let pairs: [(Jet, Jet); 3] = [ends(DVec3::X), ends(DVec3::Y), ends(DVec3::Z)];
    let gradient = DVec3::from_array(pairs.map(|(a, b)| (b.value - a.value) / (2.0 * h)));
    let [x, y, z] = pairs.map(|(a, b)| (b.gradient - a.gradient) / (2.0 * h));
    (gradient, [x.x, y.x, z.x, y.y, z.y, z.z])
}

#[test]
fn derivatives_agree_with_central_differences() {
    // The error of a central difference is about h² times the third derivative, plus a rounding
    // error of 1e-16/h.
    const STEP: f64 = 1e-5;
    const TOLERANCE: f64 = 1e-6;
    for surface in SURFACES.iter() {
        let field = surface.field();
        for p in points(surface, 200) {
            let jet = field.jet(p);
            let (gradient, hessian) = differences(&field, p, STEP);
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
    for surface in SURFACES.iter() {
        let field = surface.field();
        let points: Vec<Vec3> = points(surface, 203).iter().map(|p| p.as_vec3()).collect();
        let n = points.len();
        let mut values = vec![0.0; n];
        field.evaluator(Frame::default()).values(&points, &mut values);
        let (mut value, mut gradient) = (vec![0.0; n], vec![Vec3::ZERO; n]);
        field.evaluator(Frame::default()).gradients(&points, &mut value, &mut gradient);
        let mut hessian = vec![Sym3::default(); n];
        let (mut value2, mut gradient2) = (vec![0.0; n], vec![Vec3::ZERO; n]);
        field.evaluator(Frame::default()).hessians(&points, &mut value2, &mut gradient2, &mut hessian);
        let jets: Vec<Jet> = points.iter().map(|p| field.jet(p.as_dvec3())).collect();
        // Rounding errors are relative to the terms of the sum, which are as large as the field's
        // maximum in the box.
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
fn values_lie_within_the_bounds_of_boxes_around_the_point() {
    for surface in SURFACES.iter() {
        // A sum has itself as its only factor.
        let text = match surface.formula.split_once('=') {
            Some((left, right)) => format!("{left} - ({right}) + x^2 + 0.618034"),
            None => format!("{} + x^2 + 0.618034", surface.formula),
        };
        let field = Formula::as_written(&text, surface.parameters).expect("a formula");
        let diagonal = surface.bounds.diagonal();
        for (k, p) in points(surface, 300).into_iter().enumerate() {
            let half = DVec3::splat(diagonal * 0.5_f64.powi((k % 12).try_into().unwrap()));
            // The point is off the centre of its box.
            let lo = p - half * 0.3;
            let hi = p + half * 0.7;
            let mut out = [Enclosure::UNKNOWN];
            field.evaluator(Frame::default()).bounded().expect("a formula has bounds").enclose(
                0,
                &[Bounds::new(lo, hi)],
                &mut out,
            );
            let [Enclosure { value: bounds, defined, .. }] = out;
            let value = field.jet(p).value;
            assert!(
                value.is_nan() && !defined || bounds.holds(value),
                "{} at {p}: {value} outside {out:?} of {lo} … {hi}",
                surface.id,
            );
        }
    }
}

#[test]
fn small_boxes_off_the_surface_are_proven_empty() {
    for surface in SURFACES.iter() {
        let field = surface.field();
        let half = DVec3::splat(surface.bounds.diagonal() * 1e-5);
        let mut proven = 0;
        let all = points(surface, 200);
        for &p in &all {
            let is_empty =
                (0..field.evaluator(Frame::default()).bounded().expect("a formula has bounds").factors())
                    .all(|factor| {
                        let mut out = [Enclosure::UNKNOWN];
                        field.evaluator(Frame::default()).bounded().expect("a formula has bounds").enclose(
                            factor,
                            &[Bounds::new(p - half, p + half)],
                            &mut out,
                        );
                        !out[0].may_vanish || out[0].value.excludes_zero()
                    });
            proven += usize::from(is_empty);
        }
        assert!(proven * 10 >= all.len() * 9, "{}: {proven} of {} boxes", surface.id, all.len());
    }
}

#[test]
fn identifiers_are_unique_and_findable() {
    for surface in SURFACES.iter() {
        assert!(core::ptr::eq(gallery::find(surface.id).unwrap(), surface), "{}", surface.id);
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        assert!(surface.id.chars().all(plain), "{}", surface.id);
    }
    assert!(gallery::find("no-such-surface").is_none());
}

#[test]
fn every_parameter_is_used_and_starts_inside_its_range() {
    for surface in SURFACES.iter() {
        assert!(surface.bounds.is_valid(), "{}", surface.id);
        let field = surface.field();
        let used: Vec<&str> = field.parameters().iter().map(|p| &*p.name).collect();
        let declared: Vec<&str> = surface.parameters.iter().map(|p| &*p.name).collect();
        assert_eq!(used, declared, "{}", surface.id);
        assert!(field.auto().is_empty(), "{}", surface.id);
        for p in surface.parameters {
            assert!(p.min <= p.value && p.value <= p.max && p.step > 0.0, "{} {}", surface.id, p.name);
        }
    }
}

/// Points on the six faces of a surface's box.
fn faces(surface: &Surface, steps: u32) -> Vec<DVec3> {
    let (lo, hi) = (surface.bounds.lo(), surface.bounds.hi());
    let mut out = Vec::new();
    for axis in 0..3 {
        for i in 0..=steps {
            for j in 0..=steps {
                for end in [0.0, 1.0] {
                    let mut unit = [f64::from(i) / f64::from(steps), f64::from(j) / f64::from(steps), 0.0];
                    unit[2] = end;
                    unit.rotate_right(axis);
                    out.push(lo + (hi - lo) * DVec3::from_array(unit));
                }
            }
        }
    }
    out
}

#[test]
fn closed_surfaces_lie_inside_their_boxes_over_the_whole_range_of_every_parameter() {
    for surface in SURFACES.iter().filter(|surface| surface.closed) {
        let mut field = surface.field();
        let corners = 1_u32 << surface.parameters.len();
        for corner in 0..corners {
            for (k, p) in surface.parameters.iter().enumerate() {
                let value = if corner >> k & 1 == 0 { p.min } else { p.max };
                field.set_parameter(&p.name, value).unwrap();
            }
            for p in faces(surface, 40) {
                let (value, _) = field.value_and_gradient(p);
                assert!(value > 0.0, "{} with {:?}: {value} at {p}", surface.id, field.parameters());
            }
        }
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn closed_surfaces_have_the_genus_they_claim() {
    for surface in SURFACES.iter() {
        let Some(genus) = surface.genus else { continue };
        assert!(surface.closed, "{}", surface.id);
        let euler = euler_on_grid(surface.field(), &surface.bounds, 96);
        assert_eq!(euler, 2 - 2 * i64::from(genus), "{}", surface.id);
    }
}

#[test]
fn every_surface_meets_its_box_and_is_positive_and_negative_there() {
    for surface in SURFACES.iter() {
        let field = surface.field();
        let (mut inside, mut outside) = (0, 0);
        for p in points(surface, 20_000) {
            let (value, _) = field.value_and_gradient(p);
            inside += usize::from(value < 0.0);
            outside += usize::from(value > 0.0);
        }
        println!("{}: {inside} inside, {outside} outside", surface.id);
        assert!(inside > 200 && outside > 200, "{}: {inside} inside, {outside} outside", surface.id);
    }
}

/// Point of the surface that Newton's method along the gradient finds from `p`.
fn on_surface(field: &dyn Field, mut p: DVec3) -> Option<DVec3> {
    for _ in 0..30 {
        let (value, gradient) = field.value_and_gradient(p);
        let step = gradient * (value / gradient.length_squared());
        if !step.is_finite() {
            return None;
        }
        p -= step;
        if step.length() < 1e-12 {
            return Some(p);
        }
    }
    None
}

#[test]
fn smooth_surfaces_have_a_gradient_everywhere_and_the_others_do_not() {
    for surface in SURFACES.iter() {
        let field = surface.field();
        let mut slopes = Vec::new();
        for p in points(surface, 4000) {
            let Some(p) = on_surface(&field, p) else { continue };
            if surface.bounds.contains(p.as_vec3()) {
                slopes.push(field.value_and_gradient(p).1.length());
            }
        }
        let least = slopes.iter().copied().fold(f64::INFINITY, f64::min);
        let mean = slopes.iter().sum::<f64>() / slopes.len() as f64;
        println!("{}: slope {least:.3e} … mean {mean:.3e}, {} points", surface.id, slopes.len());
        assert!(slopes.len() > 1000, "{}: {} points only", surface.id, slopes.len());
        if surface.smooth {
            assert!(least > 0.02 * mean, "{}: slope {least} of mean {mean}", surface.id);
        } else {
            assert!(least < 0.25 * mean, "{}: slope {least} of mean {mean}", surface.id);
        }
    }
}

#[test]
fn every_surface_and_model_has_its_picture_and_every_picture_its_surface() {
    let folder = checkout().join("www/public/gallery");
    let files =
        std::fs::read_dir(&folder).expect("the folder of the pictures").map(|entry| entry.expect("an entry"));
    let pictures: BTreeSet<String> =
        files.map(|file| file.file_name().to_string_lossy().into_owned()).collect();
    let ids = SURFACES.iter().map(|surface| surface.id).chain(MODELS.iter().map(|model| model.id));
    // The page computes images, too, and names them.
    let scans = std::fs::read_to_string(checkout().join("www/src/engine/scans.js")).expect("the scans");
    let scans = scans.split("id: '").skip(1).filter_map(|rest| rest.split('\'').next());
    let wanted: BTreeSet<String> = ids.chain(scans).map(|id| format!("{id}.webp")).collect();
    let missing: Vec<_> = wanted.difference(&pictures).collect();
    assert!(missing.is_empty(), "{missing:?} are missing: `npm run pictures -- ID …` in www draws them");
    let left_over: Vec<_> = pictures.difference(&wanted).collect();
    assert!(left_over.is_empty(), "{left_over:?} show no surface, no model and no scan");
}

#[test]
fn stories_are_two_sentences() {
    for surface in SURFACES.iter() {
        let sentences = surface.story.matches(". ").count() + usize::from(surface.story.ends_with('.'));
        assert_eq!(sentences, 2, "{}: {}", surface.id, surface.story);
        assert!(!surface.story.contains("  "), "{}", surface.id);
    }
}

#[test]
fn gradients_side_by_side_have_the_bits_of_those_of_single_points() {
    for surface in SURFACES.iter() {
        let field = surface.field();
        for origin in [DVec3::ZERO, DVec3::new(0.25, -0.125, 0.5)] {
            let field = &mut *field.evaluator(Frame { scale: 0.5, ..Frame::around(origin) });
            // The last ones of 19 do not fill their block.
            let points: Vec<Vec3> = points(surface, 19).iter().map(|p| (*p - origin).as_vec3()).collect();
            let (mut value, mut gradient) = (vec![0.0; points.len()], vec![DVec3::ZERO; points.len()]);
            field.exact_gradients(&points, &mut value, &mut gradient);
            for (k, p) in points.iter().enumerate() {
                let (one, slope) = field.value_and_gradient(p.as_dvec3());
                assert_eq!(value[k].to_bits(), one.to_bits(), "{} at {p}", surface.id);
                let bits = |slope: DVec3| slope.to_array().map(f64::to_bits);
                assert_eq!(bits(gradient[k]), bits(slope), "{} at {p}", surface.id);
            }
        }
    }
}

#[test]
fn everyday_words_find_a_surface() {
    // As the page's search has it: in what is said of a surface.
    let finds = |word: &str| {
        SURFACES.iter().any(|surface| {
            let text = [surface.name, surface.words, surface.story, surface.formula].join(" ");
            text.to_lowercase().contains(word)
        })
    };
    for word in
        ["donut", "screw", "nut", "knot", "infill", "bone", "egg", "pipe", "foam", "star", "ball", "ring"]
    {
        assert!(finds(word), "{word}");
    }
    for surface in SURFACES.iter() {
        assert!(!surface.words.is_empty(), "{}", surface.id);
        for word in surface.words.split(' ') {
            assert!(!word.is_empty() && word == word.to_lowercase(), "{}: {word}", surface.id);
            assert!(gallery::by_word(word).any(|found| found.id == surface.id), "{}: {word}", surface.id);
        }
    }
}
