//! Tests of merging, thinning, farthest-point sampling and normal estimation.
#![allow(clippy::disallowed_methods, reason = "made-up points need no equal bits")]

use glam::DVec3;
use marching_particles::internal::slices::complete;
use marching_particles::pointcloud::normals::settle;
use marching_particles::pointcloud::thin::{KEPT, check_spread, merge, spread, thin};
use marching_particles::pointcloud::{Cloud, CloudError, NormalSource};

fn merged(cloud: Cloud) -> Cloud {
    complete(merge(cloud, |_| {})).expect("memory enough")
}

fn thinned(cloud: Cloud) -> Cloud {
    complete(thin(cloud)).expect("memory enough")
}

fn estimated(cloud: &mut Cloud) -> Vec<String> {
    complete(settle(cloud, |_| {})).warnings
}

/// Points of a Fibonacci spiral on the unit sphere.
fn sphere(count: usize) -> Vec<DVec3> {
    let turn = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let point = |i: usize| {
        let z = 1.0 - (2 * i + 1) as f64 / count as f64;
        let (sin, cos) = (turn * i as f64).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos, r * sin, z)
    };
    (0..count).map(point).collect()
}

/// Evenly spread points on the torus of radii 1 and 0.4 about z, with their normals.
fn torus(count: usize) -> (Vec<DVec3>, Vec<DVec3>) {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let tau = std::f64::consts::TAU;
    let (mut position, mut normal) = (Vec::new(), Vec::new());
    let mut k = 0;
    while position.len() < count {
        k += 1;
        let (u, v) = (
            tau * (f64::from(k) * golden).fract(),
            tau * (f64::from(k) * golden * golden * 0.754_877).fract(),
        );
        // On the inner side, where the same angles take less area, there are fewer points.
        if 1.0 + 0.4 * v.cos() < 1.4 * (f64::from(k) * 0.569_840).fract() {
            continue;
        }
        let n = DVec3::new(u.cos() * v.cos(), u.sin() * v.cos(), v.sin());
        position.push(DVec3::new(u.cos(), u.sin(), 0.0) + 0.4 * n);
        normal.push(n);
    }
    (position, normal)
}

#[test]
fn estimated_normals_of_sphere_and_torus_are_right_and_outward() {
    for (count, worst_deg, mean_deg) in [(1000, 14.0, 4.0), (5_000, 10.0, 2.0), (20_000, 3.0, 0.8)] {
        let on_sphere = sphere(count);
        let shapes = [("sphere", on_sphere.clone(), on_sphere), {
            let (position, normal) = torus(count);
            ("torus", position, normal)
        }];
        for (name, position, normal) in shapes {
            for (scale, offset) in
                [(1.0, DVec3::ZERO), (1e-3, DVec3::new(5.0, -3.0, 1.0)), (1e6, DVec3::splat(1e7))]
            {
                let placed: Vec<DVec3> = position.iter().map(|p| *p * scale + offset).collect();
                let mut cloud =
                    Cloud { position: placed, normal: Vec::new(), source: NormalSource::Estimated };
                let warnings = estimated(&mut cloud);
                assert_eq!(warnings.len(), 1, "{name}: {warnings:?}");
                let angles = cloud
                    .normal
                    .iter()
                    .zip(&normal)
                    .map(|(n, m)| n.dot(*m).clamp(-1.0, 1.0).acos().to_degrees());
                let (mut worst, mut sum) = (0.0_f64, 0.0);
                for angle in angles {
                    worst = worst.max(angle);
                    sum += angle;
                }
                let mean = sum / position.len() as f64;
                println!("{name}, {count} points at {scale:e}: worst {worst:.2}°, mean {mean:.2}°");
                assert!(worst < worst_deg && mean < mean_deg, "{name}, {count}: {worst}°, {mean}°");
            }
        }
    }
}

#[test]
fn estimated_normals_of_thin_shapes_point_outward() {
    // The shapes are a leaf, whose thickness is a twentieth of its length, and a needle. The points
    // do not resolve the curvature at the rim of the leaf.
    for axes in [DVec3::new(1.0, 0.7, 0.05), DVec3::new(1.0, 0.05, 0.05)] {
        let position: Vec<DVec3> = sphere(5000).iter().map(|p| *p * axes).collect();
        let mut cloud = Cloud { position, normal: Vec::new(), source: NormalSource::Estimated };
        estimated(&mut cloud);
        let inward = cloud
            .normal
            .iter()
            .zip(&cloud.position)
            .filter(|(n, p)| n.dot(**p / (axes * axes)) < 0.0)
            .count();
        println!("{axes}: {inward} of 5000 point inward");
        assert!(inward <= 100, "{axes}: {inward} of 5000 point inward");
    }
}

#[test]
fn separate_components_are_each_oriented_outward_with_a_warning() {
    let ball = sphere(300);
    let mut position: Vec<DVec3> = ball.clone();
    position.extend(ball.iter().map(|p| *p + DVec3::new(5.0, 0.0, 0.0)));
    let mut cloud = Cloud { position, normal: Vec::new(), source: NormalSource::Estimated };
    let warnings = estimated(&mut cloud);
    assert!(warnings.iter().any(|w| w.to_string().contains("2 components")), "{warnings:?}");
    assert!(cloud.normal.iter().zip(ball.iter().chain(&ball)).all(|(n, p)| n.dot(*p) > 0.9));
}

#[test]
fn degenerate_points_are_refused() {
    let (a, b) = (DVec3::new(1.0, 2.0, -1.0), DVec3::new(0.3, -1.0, 0.5));
    let at = DVec3::new(10.0, -4.0, 3.0);
    let one = vec![at; 10];
    let line: Vec<DVec3> = (0..50).map(|i| at + a * f64::from(i)).collect();
    let plane: Vec<DVec3> = (0..400).map(|i| at + a * f64::from(i / 20) + b * f64::from(i % 20)).collect();
    for scale in [1e-9, 1.0, 1e9] {
        let checked = |points: &[DVec3]| check_spread(&points.iter().map(|p| *p * scale).collect::<Vec<_>>());
        assert_eq!(checked(&one), Err(CloudError::OnePlace));
        assert_eq!(checked(&line), Err(CloudError::Line));
        assert_eq!(checked(&plane), Err(CloudError::Plane));
        assert_eq!(checked(&sphere(50)), Ok(()));
    }
    assert_eq!(check_spread(&[DVec3::ZERO; 3]), Err(CloudError::OnePlace));
    assert_eq!(check_spread(&[]), Err(CloudError::OnePlace));
}

#[test]
fn equal_points_become_one_with_the_mean_of_their_normals() {
    let position = vec![DVec3::ZERO, DVec3::X, DVec3::NEG_X * 0.0, DVec3::Y, DVec3::Y];
    let normal = vec![DVec3::X, DVec3::Z, DVec3::Y, DVec3::X, DVec3::NEG_X];
    let cloud = merged(Cloud { position, normal, source: NormalSource::Given });
    // The normals of the two points at Y cancel.
    assert_eq!(cloud.position, [DVec3::ZERO, DVec3::X]);
    assert!((cloud.normal[0] - DVec3::new(0.5_f64.sqrt(), 0.5_f64.sqrt(), 0.0)).length() < 1e-15);
}

#[test]
fn a_million_points_are_thinned_evenly_despite_an_outlier() {
    let mut position = sphere(1_000_000);
    // The outlier is a thousand diameters away.
    position.push(DVec3::new(2000.0, 0.0, 0.0));
    let normal = position.clone();
    let cloud = thinned(Cloud { position, normal, source: NormalSource::Given });
    println!("{} kept", cloud.len());
    assert!((KEPT * 3 / 10..=KEPT).contains(&cloud.len()), "{} kept", cloud.len());
    assert_eq!(cloud.normal.len(), cloud.len());
    // There is no hole: every point of the sphere is within a few cells of a kept one.
    let spacing = (4.0 * std::f64::consts::PI / cloud.len() as f64).sqrt();
    for p in sphere(500) {
        let nearest = cloud.position.iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min);
        assert!(nearest < 2.0 * spacing, "{nearest} from {p}, {spacing} apart");
    }
    let few = Cloud { position: sphere(500), normal: Vec::new(), source: NormalSource::Estimated };
    assert_eq!(thinned(few.clone()), few);
}

#[test]
fn centres_are_spread_evenly_and_reproducibly() {
    let points = sphere(20_000);
    let spread_of = |wanted: usize| complete(spread(&points, wanted, |_| {}));
    for wanted in [100, 200, 800] {
        let chosen = spread_of(wanted);
        assert_eq!(chosen.len(), wanted);
        assert_eq!(chosen, spread_of(wanted));
        // A smaller choice is the beginning of a larger one.
        assert_eq!(chosen[..100], spread_of(100));
        let distance = |i: u32, j: u32| points[i as usize].distance(points[j as usize]);
        let nearest_pair = (0..wanted)
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .map(|(i, j)| distance(chosen[i], chosen[j]))
            .fold(f64::INFINITY, f64::min);
        let hole = (0..points.len() as u32)
            .map(|i| chosen.iter().map(|&j| distance(i, j)).fold(f64::INFINITY, f64::min))
            .fold(0.0, f64::max);
        // Hexagonal spacing of as many points on the sphere.
        let hexagonal = (8.0 * std::f64::consts::PI / (3.0_f64.sqrt() * wanted as f64)).sqrt();
        println!(
            "{wanted}: pairs {:.3}, holes {:.3} of the hexagonal distance",
            nearest_pair / hexagonal,
            hole / hexagonal
        );
        assert!(nearest_pair >= hole, "what the method promises");
        assert!(nearest_pair > 0.7 * hexagonal, "{nearest_pair} for {hexagonal}");
    }
    // There are fewer points than wanted, and some occur twice.
    let mut few = sphere(30);
    few.extend(sphere(30).iter().map(|p| *p * (1.0 + 1e-6)));
    assert_eq!(complete(spread(&few, 200, |_| {})).len(), 30);
}
