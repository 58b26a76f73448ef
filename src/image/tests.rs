//! Fields of images, held to the functions that the images were made from.

use super::{Image, ImageChoice, ImageError, ImageField, Section};
use crate::extent::{self, Reach};
use crate::field::{Enclosure, Field, Frame};
use crate::math::{Bounds, Interval, Sym3};
use crate::run::{Report, sample};
use crate::sampler::{Method, Search, Settings};
use crate::slices;
use glam::{DVec3, Vec3, dvec3};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// The image of a function of the indices.
fn image_of(size: [usize; 3], f: impl Fn(DVec3) -> f64) -> Image {
    let mut voxels = Vec::new();
    for k in 0..size[2] {
        for j in 0..size[1] {
            for i in 0..size[0] {
                voxels.push(f(dvec3(i as f64, j as f64, k as f64)) as f32);
            }
        }
    }
    Image::new(size, voxels).expect("an image")
}

/// A solid with the signed distance `d`, bright in the dark, with an edge that is blurred as by a
/// scanner: the sigmoid is as steep as a Gaussian of 0.8 voxels.
fn blurred(d: f64) -> f64 {
    900.0 / (1.0 + libm::exp(2.0 * d))
}

fn torus(p: DVec3, middle: DVec3, [big, small]: [f64; 2]) -> f64 {
    let p = p - middle;
    let around = p.truncate().length() - big;
    libm::sqrt(around * around + p.z * p.z) - small
}

/// A function of the value of each voxel.
fn mapped<T>(image: &Image, of: impl Fn(f64) -> T) -> Vec<T> {
    (0..image.size().iter().product()).map(|at| of(image.voxels.at(at))).collect()
}

fn random_images() -> impl Iterator<Item = ImageField> {
    let mut random = Pcg32::seed_from_u64(11);
    [[12, 9, 10], [5, 21, 8], [2, 3, 30]].into_iter().map(move |size| {
        let count: usize = size.iter().product();
        let noise: Vec<i16> = (0..count).map(|_| (random.next_u32() % 1000) as i16).collect();
        let image = Image::new(size, noise).expect("an image");
        let rows = [[0.4, 0.1, 0.0, -3.0], [-0.2, 0.7, 0.0, 2.0], [0.0, 0.3, -1.5, 50.0]];
        image.with_affine(rows).expect("an affine map").at(480.5).expect("a surface")
    })
}

fn between(random: &mut Pcg32, lo: f64, hi: f64) -> f64 {
    lo + (hi - lo) * f64::from(random.next_u32()) / 4_294_967_296.0
}

/// A point among the voxels.
fn point_in(field: &ImageField, random: &mut Pcg32) -> DVec3 {
    let size = field.image().size();
    let index = DVec3::from_array([0, 1, 2].map(|a| between(random, -0.9, size[a] as f64 - 0.1)));
    field.image().placement().point(index)
}

#[test]
fn the_spline_has_the_value_of_each_voxel() {
    for field in random_images() {
        let image = field.image();
        let size = image.size();
        for at in 0..size.iter().product() {
            let index = [at % size[0], at / size[0] % size[1], at / size[0] / size[1]];
            let p = image.placement().point(DVec3::from_array(index.map(|i| i as f64)));
            let (found, wanted) = (field.value(p), 480.5 - image.voxel(index));
            assert!((found - wanted).abs() < 2e-3, "{size:?} {index:?}: {found} {wanted}");
        }
    }
}

#[test]
fn derivatives_are_those_of_the_value() {
    let mut random = Pcg32::seed_from_u64(5);
    for field in random_images() {
        for _ in 0..300 {
            let p = point_in(&field, &mut random);
            let (h, jet) = (1e-4, field.jet(p));
            for (axis, unit) in DVec3::AXES.into_iter().enumerate() {
                let (ahead, behind) = (field.jet(p + h * unit), field.jet(p - h * unit));
                let slope = (ahead.value - behind.value) / (2.0 * h);
                assert!((jet.gradient[axis] - slope).abs() < 1e-2, "{p}: {jet:?} {slope}");
                let bend = (ahead.gradient - behind.gradient) / (2.0 * h);
                for other in 0..3 {
                    // The third derivatives jump between cells.
                    assert!((jet.hessian.at(axis, other) - bend[other]).abs() < 3.0, "{p}: {jet:?} {bend}");
                }
            }
        }
    }
}

#[test]
fn batches_are_the_single_points_rounded() {
    let mut random = Pcg32::seed_from_u64(6);
    for field in random_images() {
        let origin = field.image().placement().point(dvec3(1.0, 1.0, 1.0));
        let mut evaluator = field.evaluator(Frame::around(origin));
        let points: Vec<Vec3> =
            (0..100).map(|_| (point_in(&field, &mut random) - origin).as_vec3()).collect();
        let (mut value, mut gradient) = (vec![0.0; 100], vec![Vec3::ZERO; 100]);
        let mut hessian = vec![Sym3::default(); 100];
        evaluator.hessians(&points, &mut value, &mut gradient, &mut hessian);
        for (k, p) in points.iter().enumerate() {
            let exact = evaluator.jet(p.as_dvec3());
            assert!((f64::from(value[k]) - exact.value).abs() < 2e-2, "{p}: {} {exact:?}", value[k]);
            assert!(
                (gradient[k].as_dvec3() - exact.gradient).length() < 5e-2,
                "{p}: {} {exact:?}",
                gradient[k]
            );
            for (a, b) in hessian[k].entries().into_iter().zip(exact.hessian.entries()) {
                assert!((f64::from(a) - b).abs() < 0.5, "{p}: {a} {b}");
            }
        }
    }
}

/// Bounds of all orders over a box.
fn bounds_over(field: &ImageField, bounds: &Bounds) -> (Enclosure, Sym3<Interval>) {
    let mut evaluator = field.evaluator(Frame::default());
    let bounded = evaluator.bounded().expect("an image has bounds");
    let mut known = [Enclosure::UNKNOWN];
    let mut second = [Sym3::splat(Interval::EVERYTHING)];
    bounded.enclose(0, &[*bounds], &mut known);
    bounded.enclose_second(0, &[*bounds], &mut second);
    (known[0], second[0])
}

#[test]
fn bounds_hold_what_is_in_the_box() {
    let mut random = Pcg32::seed_from_u64(8);
    let smooth = image_of([40, 33, 28], |p| 16.0 - (p - dvec3(19.0, 15.0, 14.0)).length()).at(6.0);
    let fields: Vec<ImageField> = random_images().chain([smooth.expect("a surface")]).collect();
    let mut proven = 0;
    for field in &fields {
        for _ in 0..2_000 {
            let (p, q) = (point_in(field, &mut random), point_in(field, &mut random));
            let share = libm::exp(between(&mut random, -8.0, 0.0));
            let q = p + share * (q - p);
            let bounds = Bounds::new(p.min(q), p.max(q));
            let (known, second) = bounds_over(field, &bounds);
            proven += usize::from(known.value.excludes_zero());
            for corner in 0..8 {
                let share = DVec3::from_array([0, 1, 2].map(|a| f64::from(corner >> a & 1)));
                let at =
                    (bounds.lo() + share * bounds.size() * between(&mut random, 0.0, 1.0)).min(bounds.hi());
                let jet = field.jet(at);
                if jet.value.is_nan() {
                    assert!(!known.defined, "{at} {bounds:?}");
                    continue;
                }
                // Away from the surface f is another function of the same sign.
                let indices = field.image().placement().index(at);
                if !is_near(field, indices) {
                    assert!(
                        known.value.lo < 0.0 && jet.value < 0.0 || known.value.hi > 0.0 && jet.value > 0.0
                    );
                    continue;
                }
                assert!(known.value.holds(jet.value), "{at} {bounds:?}: {jet:?} {known:?}");
                for axis in 0..3 {
                    assert!(
                        known.gradient[axis].holds(jet.gradient[axis]),
                        "{at} {bounds:?}: {jet:?} {known:?}"
                    );
                }
                for (bounds, entry) in second.entries().into_iter().zip(jet.hessian.entries()) {
                    assert!(bounds.widened(1e-9).holds(entry), "{at}: {entry} {bounds:?}");
                }
            }
        }
    }
    assert!(proven > 500, "{proven}");
}

/// Whether the spline is kept in the block around these indices.
fn is_near(field: &ImageField, indices: DVec3) -> bool {
    let block = (indices + 1.0).to_array().map(|i| i.max(0.0) as usize / super::bricks::SIDE);
    field.bricks.brick(block).is_some()
}

#[test]
fn bounds_of_a_point_are_tight() {
    let mut random = Pcg32::seed_from_u64(9);
    for field in random_images() {
        for _ in 0..200 {
            let p = point_in(&field, &mut random);
            let (known, _) = bounds_over(&field, &Bounds::point(p));
            assert!(known.value.hi - known.value.lo < 1e-8, "{p}: {known:?}");
        }
    }
}

#[test]
fn coefficients_do_not_depend_on_what_is_far_away() {
    // An image and a part of it that holds its extremes, so that values are counted from the same
    // number.
    let f = |p: DVec3| blurred((p - dvec3(30.0, 31.0, 29.0)).length() - 9.3);
    let whole = image_of([60, 60, 60], f);
    let corner = dvec3(3.0, 2.0, 4.0);
    let mut voxels = Vec::new();
    let size = [54, 55, 53];
    for k in 0..size[2] {
        for j in 0..size[1] {
            for i in 0..size[0] {
                voxels.push(whole.voxel([i + 3, j + 2, k + 4]) as f32);
            }
        }
    }
    let (bright, dark) = (whole.range()[1] as f32, whole.range()[0] as f32);
    (voxels[0], voxels[1]) = (bright, dark);
    let part = Image::new(size, voxels).expect("an image");
    assert_eq!(part.range(), whole.range());
    let (whole, part) = (whole.at(400.0).expect("a surface"), part.at(400.0).expect("a surface"));
    let mut random = Pcg32::seed_from_u64(4);
    for _ in 0..500 {
        let offset = dvec3(between(&mut random, -9.0, 9.0), between(&mut random, -9.0, 9.0), 0.25);
        let p = (dvec3(30.0, 31.0, 29.0) + offset * 64.0).round() / 64.0 + offset.round();
        if is_near(&whole, p) && is_near(&part, p - corner) {
            assert_eq!(whole.value(p).to_bits(), part.value(p - corner).to_bits(), "{p}");
        }
    }
}

/// The report on a field, proven to have this many components.
fn proven(field: ImageField, count: u32, components: usize) -> Report {
    let sample = sample(field, &Settings::with_count(count)).expect("a sample");
    let report = sample.report().clone();
    assert_eq!(report.proof.search, Search::Proven, "{:?}", report.proof);
    assert_eq!(report.proof.components, components);
    report
}

#[test]
fn surfaces_of_images_are_those_of_their_functions() {
    let middle = dvec3(31.6, 31.2, 31.7);
    let ball = |p: DVec3| (p - middle).length() - 24.0;
    let ring = |p: DVec3| torus(p, middle, [18.0, 8.0]);
    let shapes: [(&dyn Fn(DVec3) -> f64, i64); 2] = [(&ball, 2), (&ring, 0)];
    for (distance, euler) in shapes {
        let field = image_of([64, 64, 64], |p| blurred(distance(p))).at(450.0).expect("a surface");
        let sample = sample(field, &Settings::with_count(4_000)).expect("a sample");
        assert_eq!(sample.report().proof.search, Search::Proven, "{:?}", sample.report().proof);
        assert!(sample.mesh().topology.is_closed());
        assert_eq!(sample.mesh().topology.euler(), euler);
        let mut worst = [0.0_f64; 2];
        for (k, n) in sample.particles().normal.iter().enumerate() {
            let (p, h) = (sample.particles().place(k), 1e-4);
            let slope = |unit: DVec3| (distance(p + h * unit) - distance(p - h * unit)) / (2.0 * h);
            let gradient = DVec3::from_array(DVec3::AXES.map(slope));
            worst[0] = worst[0].max(distance(p).abs());
            worst[1] = worst[1].max(libm::acos(gradient.dot(n.as_dvec3()).min(1.0)).to_degrees());
        }
        // In voxels, and in degrees.
        assert!(worst[0] < 0.02 && worst[1] < 3.0, "{euler}: {worst:?}");
    }
}

#[test]
fn many_parts_are_found_with_proof() {
    let mut random = Pcg32::seed_from_u64(20);
    let balls: Vec<(DVec3, f64)> = (0..27)
        .map(|k| {
            let cell = dvec3((k % 3) as f64, (k / 3 % 3) as f64, (k / 9) as f64);
            let mut off = || between(&mut random, -2.0, 2.0);
            (20.0 * cell + 11.0 + dvec3(off(), off(), off()), 3.0 + (k % 5) as f64)
        })
        .collect();
    let nearest = |p: DVec3| balls.iter().map(|(c, r)| (p - *c).length() - r).fold(f64::INFINITY, f64::min);
    let field = image_of([64, 64, 64], |p| blurred(nearest(p))).at(450.0).expect("a surface");
    proven(field, 20_000, 27);
}

#[test]
fn a_flip_keeps_outside_outside() {
    let ball = image_of([24, 24, 24], |p| 9.0 - (p - dvec3(11.0, 12.0, 11.5)).length());
    let rows = [[0.0, -1.0, 0.0, 5.0], [-2.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0]];
    let ball = ball.with_affine(rows).expect("an affine map").at(0.0).expect("a surface");
    let middle = ball.image().placement().point(dvec3(11.0, 12.0, 11.5));
    for field in [ball.clone(), ball.inverted()] {
        let outward = if field.is_inverted() { -1.0 } else { 1.0 };
        assert_eq!(field.value(middle) < 0.0, outward > 0.0);
        let (_, gradient) = field.value_and_gradient(middle + dvec3(8.0, 0.0, 0.0));
        assert!(outward * gradient.x > 0.0);
    }
}

#[test]
fn the_box_is_that_of_the_surface_or_of_the_image_that_cuts_it() {
    let ball = image_of([40, 40, 40], |p| 6.0 - (p - dvec3(12.0, 20.0, 25.0)).length()).at(0.0);
    let extent = extent::find(&ball.expect("a surface"));
    assert_eq!(extent.reach, Reach::Bounded);
    let around = Bounds::new(dvec3(6.0, 14.0, 19.0), dvec3(18.0, 26.0, 31.0));
    assert!(extent.bounds.enlarged(1e-9).holds_inside(&around), "{extent:?}");
    assert!(around.enlarged(2.5).holds_inside(&extent.bounds), "{extent:?}");

    let rod = image_of([40, 30, 20], |p| 6.0 - (p - dvec3(20.0, 15.0, 0.0)).truncate().length()).at(0.0);
    let rod = rod.expect("a surface");
    let extent = extent::find(&rod);
    assert_eq!((extent.reach, extent.bounds.min[2], extent.bounds.max[2]), (Reach::Endless, 0.0, 19.0));
    let sample = sample(rod, &Settings::with_count(1_500)).expect("a sample");
    let topology = &sample.mesh().topology;
    assert_eq!((topology.euler(), topology.borders.len()), (0, 2));
    assert_eq!(sample.report().proof.search, Search::Proven, "{:?}", sample.report().proof);
}

#[test]
fn batches_can_continue_beyond_the_border() {
    let image = image_of([9, 8, 10], |p| (p - dvec3(1.0, 7.0, 4.0)).length_squared());
    let image = image.with_spacing([1.0, 0.5, 2.0]).expect("spacings");
    let field = image.at(16.0).expect("a surface");
    let beyond = [Vec3::new(-4.0, 2.0, 8.0), Vec3::new(13.0, -2.0, 8.0), Vec3::new(20.0, 9.0, -7.0)];
    let (mut value, mut gradient) = ([0.0; 3], [Vec3::ZERO; 3]);
    let mut evaluator = field.evaluator(Frame::default());
    evaluator.gradients(&beyond, &mut value, &mut gradient);
    assert!(value.iter().all(|value| value.is_nan()), "{value:?}");
    evaluator.continue_beyond();
    let mut evaluator = evaluator.another();
    evaluator.gradients(&beyond, &mut value, &mut gradient);
    let (mut same, mut hessian) = ([0.0; 3], [Sym3::default(); 3]);
    evaluator.values(&beyond, &mut same);
    assert_eq!(value, same);
    let mut slope = [Vec3::ZERO; 3];
    evaluator.hessians(&beyond, &mut same, &mut slope, &mut hessian);
    assert_eq!((value, gradient), (same, slope));
    let size = field.image().size();
    for (k, p) in beyond.iter().enumerate() {
        // Along a straight line across the border f rises evenly.
        let placement = field.image().placement();
        let last = DVec3::from_array(size.map(|n| n as f64 - 1.0));
        let nearest = placement.point(placement.index(p.as_dvec3()).clamp(DVec3::ZERO, last));
        let way = p.as_dvec3() - nearest;
        let jet = field.jet(nearest);
        let wanted = jet.value + way.dot(jet.gradient + 0.5 * jet.hessian.apply(way));
        assert!((f64::from(value[k]) - wanted).abs() < 1e-4 * wanted.abs(), "{p}: {} {wanted}", value[k]);
        assert!((gradient[k].as_dvec3() - jet.gradient).dot(way).abs() < 1e-3 * way.length_squared());
    }
}

#[test]
fn a_surface_that_the_border_cuts_at_all_angles_is_refined() {
    let middle = DVec3::splat(31.685);
    let waves = |p: DVec3| {
        let a = (p - middle) * (core::f64::consts::TAU * 2.2 / 64.0);
        let [sines, cosines] = [a.map(libm::sin), a.map(libm::cos)];
        let gradient = dvec3(
            cosines.x * cosines.y - sines.z * sines.x,
            cosines.y * cosines.z - sines.x * sines.y,
            cosines.z * cosines.x - sines.y * sines.z,
        );
        let value = sines.x * cosines.y + sines.y * cosines.z + sines.z * cosines.x;
        value / (gradient.length() * core::f64::consts::TAU * 2.2 / 64.0).max(1e-9)
    };
    let image = image_of([64; 3], |p| blurred(waves(p)));
    for count in [5_000, 20_000] {
        let settings = Settings { method: Method::Refined, ..Settings::with_count(count) };
        let sample = sample(image.at(450.0).expect("a surface"), &settings).expect("a sample");
        assert!(sample.report().warnings.is_empty(), "{count}: {:?}", sample.report().warnings);
        // As marching cubes count on the voxels.
        assert_eq!(sample.mesh().topology.euler(), -51, "{count}");
    }
}

#[test]
fn otsu_parts_two_peaks_in_their_middle() {
    let two = image_of([8, 8, 8], |p| if p.x < 4.0 { 10.0 } else { 30.0 });
    assert!((two.otsu() - 20.0).abs() < 0.2, "{}", two.otsu());
}

#[test]
fn noise_is_measured_and_its_gaussian_chosen() {
    let mut random = Pcg32::seed_from_u64(2);
    // A sum of twelve uniform numbers is all but normal.
    let mut normal = move || (0..12).map(|_| between(&mut random, 0.0, 1.0)).sum::<f64>() - 6.0;
    let ball = |p: DVec3| blurred((p - 23.5).length() - 15.0);
    let clean = image_of([48, 48, 48], ball);
    assert!(clean.noise() < 1.0, "{}", clean.noise());
    assert_eq!(clean.width_against_noise(450.0), 0.0);
    let count = 48 * 48 * 48;
    let noise: Vec<f64> = (0..count).map(|_| 54.0 * normal()).collect();
    let noisy = image_of([48, 48, 48], |p| {
        let at = p.x as usize + 48 * (p.y as usize + 48 * p.z as usize);
        ball(p) + noise[at]
    });
    assert!((noisy.noise() / 54.0 - 1.0).abs() < 0.05, "{}", noisy.noise());
    let width = noisy.width_against_noise(450.0);
    assert!((0.8..1.2).contains(&width), "{width}");
    let smoothed = noisy.smoothed(width).expect("an image");
    proven(smoothed.at(450.0).expect("a surface"), 2_000, 1);
}

#[test]
fn whole_numbers_of_shallow_slope_make_smooth_surfaces() {
    let mut random = Pcg32::seed_from_u64(30);
    for step in [0.5, 1.0, 3.0, 10.0, 14.0, 20.0, 60.0] {
        let balls: Vec<(DVec3, f64)> = (0..4)
            .map(|_| {
                let mut at = || between(&mut random, 16.0, 31.0);
                (dvec3(at(), at(), at()), between(&mut random, 7.0, 12.0))
            })
            .collect();
        // A smooth union, whose slope is 1 for each voxel nearly everywhere.
        let distance = |p: DVec3| {
            let sum: f64 = balls.iter().map(|(c, r)| libm::exp(-((p - *c).length() - r) / 2.0)).sum();
            -2.0 * libm::log(sum)
        };
        let exact = image_of([48; 3], |p| -step * distance(p));
        let voxels: Vec<i16> = (0..48 * 48 * 48)
            .map(|at| exact.voxel([at % 48, at / 48 % 48, at / 48 / 48]).round() as i16)
            .collect();
        let image = Image::new([48; 3], voxels).expect("an image");
        let width = image.width_against_noise(0.25 * step);
        assert!((0.29 / step > 0.02) == (width > 0.0) && width <= 1.0, "{step}: {width}");
        // A surface within the smoothest of them, so that the border of the image cuts none.
        let choice = ImageChoice { iso: Some(0.25 * step), ..ImageChoice::default() };
        let surface = image.surface(&choice, None).expect("a surface");
        let settings = Settings::with_count(3_000);
        let sample = sample(surface.field().clone(), &settings).expect("a sample");
        let report = sample.report();
        let lost = report.growth.fates.not_converged;
        assert!(lost < 20, "{step}, {width}: {lost}");
        assert!(sample.mesh().topology.is_closed(), "{step}");
        let off = |k: usize| (distance(sample.particles().place(k)) + 0.25).abs();
        let worst = (0..sample.particles().len()).map(off).fold(0.0, f64::max);
        // Half a step is a distance of 0.5 / step.
        assert!(worst < (0.05 + 0.5 / step).min(0.6), "{step}: {worst}");
    }
}

#[test]
fn a_mask_is_smoothed_no_more_than_a_label() {
    let mask: Vec<u8> = (0..32_768)
        .map(|at| dvec3((at % 32) as f64, (at / 32 % 32) as f64, (at / 1024) as f64))
        .map(|p| u8::from((p - 15.3).length() < 10.0))
        .collect();
    let mask = Image::new([32; 3], mask).expect("an image");
    assert_eq!(mask.width_against_noise(0.5), 1.0);
    for (spacing, width) in [([0.7; 3], 1.0), ([1.0, 1.0, 3.0], 1.9), ([3.0, 1.0, 2.0], 1.1)] {
        let thick = mask.clone().with_spacing(spacing).expect("spacings");
        assert_eq!(thick.width_against_steps(), width, "{spacing:?}");
        assert!(thick.width_against_noise(0.5) <= width, "{spacing:?}");
    }
    // An edge that is steep for the step between two values needs none.
    let steep = image_of([32; 3], |p| (blurred((p - 15.3).length() - 10.0) / 9.0).round());
    let voxels: Vec<u8> =
        (0..32_768).map(|at| steep.voxel([at % 32, at / 32 % 32, at / 1024]) as u8).collect();
    let steep = Image::new([32; 3], voxels).expect("an image");
    assert_eq!(steep.width_against_noise(50.0), 0.0);
}

#[test]
fn a_surface_does_not_depend_on_the_one_before_it() {
    let ball = image_of([24; 3], |p| blurred((p - 11.4).length() - 7.0));
    let choice = |iso: f64, smooth: f64| ImageChoice {
        iso: Some(iso),
        smooth: Some(smooth),
        ..ImageChoice::default()
    };
    let mut before = None;
    for (iso, smooth) in [(200.0, 1.0), (450.0, 1.0), (450.0, 0.0), (700.0, 0.0), (300.0, 1.0)] {
        let surface = ball.surface(&choice(iso, smooth), before.as_ref()).expect("a surface");
        let alone = ball.clone().surface(&choice(iso, smooth), None).expect("a surface");
        for k in 0..200 {
            let p = dvec3(4.0 + 0.08 * f64::from(k), 11.0, 12.3);
            assert_eq!(surface.field().value(p).to_bits(), alone.field().value(p).to_bits(), "{iso} {p}");
        }
        before = Some(surface);
    }
}

#[test]
fn labels_become_smooth_closed_surfaces() {
    let (big, small) = (dvec3(24.0, 24.0, 24.0), dvec3(8.0, 8.0, 9.0));
    let voxels: Vec<u8> = (0..48 * 48 * 48)
        .map(|at| {
            let p = dvec3((at % 48) as f64, (at / 48 % 48) as f64, (at / 48 / 48) as f64);
            if (p - small).length() < 6.0 { 7 } else { u8::from((p - big).length() < 15.0) * 3 }
        })
        .collect();
    let image = Image::new([48, 48, 48], &voxels).expect("an image");
    let values: Vec<f64> = image.labels().iter().map(|label| label.value).collect();
    assert_eq!(values, [0.0, 3.0, 7.0]);
    let total: u64 = image.labels().iter().map(|label| label.voxels).sum();
    assert_eq!(total, 48 * 48 * 48);
    for (label, middle, radius) in [(3.0, big, 15.0), (7.0, small, 6.0)] {
        let surface = image.label(label, 1.0).expect("a label").at(0.0).expect("a surface");
        let sample = sample(surface, &Settings::with_count(2_000)).expect("a sample");
        assert_eq!(sample.report().proof.search, Search::Proven, "{:?}", sample.report().proof);
        assert_eq!(sample.mesh().topology.euler(), 2);
        let places = (0..sample.particles().len()).map(|k| sample.particles().place(k));
        let distances = places.map(|p| (p - middle).length() - radius);
        let worst = distances.fold(0.0_f64, |worst, d| worst.max(d.abs()));
        assert!(worst < 0.75, "{label}: {worst}");
    }
    assert!(matches!(image.label(5.0, 1.0), Err(ImageError::NoLabel { count: 0, .. })));
    let sheet: Vec<u8> = (0..1000).map(|at| u8::from(at / 100 == 5)).collect();
    let sheet = Image::new([10, 10, 10], &sheet).expect("an image");
    assert!(matches!(sheet.label(1.0, 2.0), Err(ImageError::Thin { .. })), "{:?}", sheet.label(1.0, 2.0));
}

#[test]
fn what_is_no_image_is_refused_by_its_fault() {
    let refused = |size, voxels: &[f32]| Image::new(size, voxels).expect_err("no image");
    assert!(matches!(refused([2, 2, 2], &[0.0; 7]), ImageError::Size { wanted: 8, found: 7, .. }));
    assert!(matches!(refused([usize::MAX, 2, 2], &[0.0; 7]), ImageError::Size { .. }));
    assert!(matches!(refused([4, 2, 1], &[0.0; 8]), ImageError::Flat { .. }));
    assert!(matches!(refused([2, 2, 2], &[3.0; 8]), ImageError::Constant { value: 3.0 }));
    let mut voxels = [0.0; 8];
    (voxels[3], voxels[6]) = (f32::NAN, f32::INFINITY);
    assert_eq!(refused([2, 2, 2], &voxels), ImageError::NotFinite { count: 2, first: [1, 1, 0] });
    let image = image_of([3, 3, 3], |p| p.x);
    for iso in [-1.0, 0.0, 2.0, 3.0, f64::NAN] {
        assert!(matches!(image.at(iso), Err(ImageError::Outside { .. })), "{iso}");
    }
    for spacing in [[0.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, f64::NAN], [1.0, f64::INFINITY, 1.0]] {
        assert!(
            matches!(image.clone().with_spacing(spacing), Err(ImageError::Singular { .. })),
            "{spacing:?}"
        );
    }
    let flat = [[1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 0.0, 0.0]];
    assert!(matches!(image.with_affine(flat), Err(ImageError::Singular { .. })));
}

#[test]
fn a_gaussian_is_the_sum_of_its_definition() {
    let mut random = Pcg32::seed_from_u64(5);
    let size = [7, 5, 6];
    let voxels: Vec<f64> = (0..7 * 5 * 6).map(|_| between(&mut random, -1.0, 1.0)).collect();
    let image = Image::new(size, voxels).expect("an image");
    // Spacings along the axes; the width counts in voxels of the second smallest.
    for spacing in [[1.0; 3], [0.5, 1.0, 3.0]] {
        let image = image.clone().with_spacing(spacing).expect("spacings");
        let smooth = image.smoothed(0.9).expect("an image");
        let weight = |axis: usize, steps: i64| {
            let deviation = 0.9 / spacing[axis];
            libm::exp(-0.5 * (steps as f64 / deviation) * (steps as f64 / deviation))
        };
        let reach = |axis: usize| libm::ceil(4.0 * 0.9 / spacing[axis]) as i64;
        let total = |axis: usize| (-reach(axis)..=reach(axis)).map(|s| weight(axis, s)).sum::<f64>();
        let totals = [total(0), total(1), total(2)];
        let mut at = [0_i64; 3];
        for index in 0..size.iter().product::<usize>() {
            at = [index % size[0], index / size[0] % size[1], index / size[0] / size[1]].map(|i| i as i64);
            let mut sum = 0.0;
            for i in -reach(0)..=reach(0) {
                for j in -reach(1)..=reach(1) {
                    for k in -reach(2)..=reach(2) {
                        let steps = [i, j, k];
                        let place: [usize; 3] = core::array::from_fn(|a| {
                            (at[a] + steps[a]).clamp(0, size[a] as i64 - 1) as usize
                        });
                        let weights: f64 = (0..3).map(|a| weight(a, steps[a]) / totals[a]).product();
                        sum += weights * image.voxel(place);
                    }
                }
            }
            let found = smooth.voxel(at.map(|i| i as usize));
            assert!((found - sum).abs() < 1e-5, "{spacing:?} {at:?}: {found} {sum}");
        }
        assert_eq!(at, size.map(|n| n as i64 - 1));
    }
}

#[test]
fn a_surface_made_in_slices_has_the_same_bits() {
    let ball = image_of([40, 36, 44], |p| blurred((p - 18.3).length() - 12.0));
    let labels = Image::new([40, 36, 44], mapped(&ball, |value| u8::from(value > 450.0))).expect("labels");
    let grey = ImageChoice { smooth: Some(0.8), ..ImageChoice::default() };
    let label = ImageChoice { label: Some(1.0), ..ImageChoice::default() };
    for (image, choice) in [(ball, grey), (labels, label)] {
        let whole = image.surface(&choice, None).expect("a surface");
        let mut work = Box::pin(image.clone().surface_in_slices(choice, None));
        let mut slices = 0;
        let sliced = loop {
            slices += 1;
            if let Some(made) = slices::advance(work.as_mut(), 1) {
                break made.expect("a surface");
            }
        };
        // The estimate is a guide for a bar.
        let expected = image.slices_of(&choice);
        assert!((expected / 3..3 * expected).contains(&slices), "{slices} {expected}");
        let mut random = Pcg32::seed_from_u64(1);
        for _ in 0..500 {
            let p = point_in(whole.field(), &mut random);
            assert_eq!(sliced.field().value(p).to_bits(), whole.field().value(p).to_bits(), "{p}");
        }
    }
}

#[test]
fn a_surface_that_the_border_cuts_can_be_closed_there() {
    // A rod along z, and a ball in a corner of an image whose axes are turned.
    let rod = image_of([32, 30, 20], |p| blurred((p - dvec3(16.0, 15.0, 0.0)).truncate().length() - 7.0));
    let ball = image_of([30, 30, 30], |p| blurred((p - dvec3(2.0, 4.0, 3.0)).length() - 14.0));
    let rows = [[0.8, -0.6, 0.0, 3.0], [0.6, 0.8, 0.0, 1.0], [0.0, 0.0, 1.5, -2.0]];
    let ball = ball.with_affine(rows).expect("an affine map");
    let dark = Image::new(rod.size(), mapped(&rod, |value| -value as f32)).expect("an image");
    for (image, is_dark_inside) in [(rod, false), (ball, false), (dark, true)] {
        let iso = if is_dark_inside { -450.0 } else { 450.0 };
        let choice = ImageChoice {
            iso: Some(iso),
            smooth: Some(0.0),
            is_dark_inside,
            is_closed: true,
            ..ImageChoice::default()
        };
        let surface = image.surface(&choice, None).expect("a surface");
        let open =
            image.surface(&ImageChoice { is_closed: false, ..choice }, Some(&surface)).expect("a surface");
        let sample = sample(surface.field().clone(), &Settings::with_count(3_000)).expect("a sample");
        let topology = &sample.mesh().topology;
        assert!(topology.is_closed(), "{topology:?}");
        assert_eq!(topology.euler(), 2);
        let last = image.size().map(|n| n as f64 - 1.0);
        for k in 0..sample.particles().len() {
            let p = sample.particles().place(k);
            let index = image.placement().index(p).to_array();
            let beyond = (0..3).map(|a| (-index[a]).max(index[a] - last[a])).fold(f64::MIN, f64::max);
            // Within the image the surface is the same, but for what the border adds to the spline;
            // beyond it there is the cap at half a voxel, to a tenth of one, with rounded edges.
            assert!(beyond < 0.7, "{index:?}");
            if beyond < -3.0 {
                let (value, gradient) = open.field().value_and_gradient(p);
                assert!(value.abs() / gradient.length() < 0.01, "{index:?}: {value}");
            }
            let inner = (0..3).filter(|&a| index[a] > 2.0 && index[a] < last[a] - 2.0).count();
            let depth = open.field().value(
                image.placement().point(DVec3::from_array([0, 1, 2].map(|a| index[a].clamp(0.0, last[a])))),
            );
            if beyond > 0.3 && inner == 2 && depth < -300.0 {
                assert!((beyond - 0.5).abs() < 0.1, "{index:?}");
            }
        }
    }
}

#[test]
fn a_section_holds_the_voxels_in_a_plane() {
    // A linear function is interpolated exactly.
    let f = |p: DVec3| 3.0 * p.x - 2.0 * p.y + 0.5 * p.z + 1.0;
    let image = image_of([9, 8, 7], f);
    let rows = [[0.5, 0.1, 0.0, 2.0], [0.0, -0.5, 0.0, 1.0], [0.0, 0.0, 2.0, -3.0]];
    let image = image.with_affine(rows).expect("an affine map");
    let place = image.placement();
    let corner = place.point(dvec3(-1.0, 0.3, 2.2));
    let steps = [dvec3(0.4, 0.2, 0.1), dvec3(0.1, 0.7, 0.3)].map(|step| place.matrix() * step);
    let section = Section { corner, steps, size: [30, 14] };
    let linear = image.section(&section, true);
    let nearest = image.section(&section, false);
    assert_eq!(linear.len(), 30 * 14);
    let mut inside = 0;
    for (at, (linear, nearest)) in linear.iter().zip(&nearest).enumerate() {
        let (i, j) = ((at % 30) as f64, (at / 30) as f64);
        let index = dvec3(-1.0, 0.3, 2.2) + i * dvec3(0.4, 0.2, 0.1) + j * dvec3(0.1, 0.7, 0.3);
        let far = (index - dvec3(4.0, 3.5, 3.0)).abs() - dvec3(4.5, 4.0, 3.5);
        if far.max_element().abs() < 1e-9 {
            continue;
        }
        assert_eq!(linear.is_nan(), far.max_element() > 0.0, "{index}");
        assert_eq!(nearest.is_nan(), linear.is_nan());
        if linear.is_nan() {
            continue;
        }
        inside += 1;
        let held = index.clamp(DVec3::ZERO, dvec3(8.0, 7.0, 6.0));
        assert!((f64::from(*linear) - f(held)).abs() < 1e-4, "{index}: {linear}");
        assert!((f64::from(*nearest) - f(held)).abs() <= 0.5 * (3.0 + 2.0 + 0.5) + 1e-4, "{index}");
        assert_eq!(f64::from(*nearest) * 2.0, libm::round(f64::from(*nearest) * 2.0));
    }
    assert!(inside > 50);
}

#[test]
fn labels_are_counted_whatever_their_order() {
    let mut random = Pcg32::seed_from_u64(9);
    let voxels: Vec<i32> =
        (0..1000).map(|_| [-5, 0, 7, 614_454_277][random.next_u32() as usize % 4]).collect();
    let image = Image::new([10, 10, 10], &voxels).expect("an image");
    let found: Vec<(f64, u64)> = image.labels().iter().map(|label| (label.value, label.voxels)).collect();
    let count = |value: i32| voxels.iter().filter(|own| **own == value).count() as u64;
    let wanted = [-5, 0, 7, 614_454_277].map(|value| (f64::from(value), count(value)));
    assert_eq!(found, wanted);
    let many: Vec<u16> = (0..8000).collect();
    assert!(Image::new([20, 20, 20], &many).expect("an image").labels().is_empty());
    let broken: Vec<f32> = (0..1000).map(|at| if at == 999 { 0.5 } else { 1.0 }).collect();
    assert!(Image::new([10, 10, 10], &broken).expect("an image").labels().is_empty());
}

#[test]
fn a_coarser_image_has_the_first_of_some_voxels_in_the_same_places() {
    let voxels: Vec<i16> = (0..7 * 6 * 5).map(|at| ((at * 37) % 101) as i16).collect();
    let rows = [[0.5, 0.1, 0.0, 2.0], [0.0, -0.5, 0.0, 1.0], [0.0, 0.0, 2.0, -3.0]];
    let image = Image::new([7, 6, 5], &voxels).expect("an image").with_affine(rows).expect("an affine map");
    let coarser = image.coarser(2).expect("an image");
    assert_eq!((coarser.size(), coarser.voxel_type()), ([4, 3, 3], image.voxel_type()));
    assert_eq!(coarser.bytes(), 2 * 4 * 3 * 3);
    for k in 0..3 {
        for j in 0..3 {
            for i in 0..4 {
                let fine = [2 * i, 2 * j, 2 * k];
                assert_eq!(
                    coarser.voxel([i, j, k]),
                    f64::from(voxels[fine[0] + 7 * (fine[1] + 6 * fine[2])])
                );
                let point = |image: &Image, at: [usize; 3]| {
                    image.placement().point(DVec3::from_array(at.map(|n| n as f64)))
                };
                assert!(point(&coarser, [i, j, k]).distance(point(&image, fine)) < 1e-12);
            }
        }
    }
    assert!(coarser.notes()[0].contains("one in 2"), "{:?}", coarser.notes());
    assert!(matches!(image.coarser(5), Err(ImageError::Flat { size: [2, 2, 1] })));
}
