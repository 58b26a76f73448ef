//! Triangles over particles: one closed oriented manifold of the right genus over each smooth
//! surface, one with border where the box cuts, and for any other set of points a manifold and a
//! list of what is not in it.

use crate::runs::of_gallery;
use glam::{DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::field::gallery::{self, Surface};
use marching_particles::mesh::Component;
use marching_particles::mesh::triangulation::{Triangulation, triangulate};
use marching_particles::particles::Particles;
use marching_particles::sampler::{Settings, SizeMode};

fn of_count(count: u32, seed: u64, match_tolerance: f64, relax_steps: u32) -> Settings {
    settings!(size_mode: SizeMode::Count, count, seed, match_tolerance, relax_steps; ..Settings::default())
}

/// The triangles of a set of points, held to what is promised of every set.
#[track_caller]
fn mesh(position: &[Vec3], normal: &[Vec3], bounds: Option<&Bounds>) -> Triangulation {
    let points = Particles { local: position.to_vec(), normal: normal.to_vec(), ..Particles::default() };
    let mesh = triangulate(&points, bounds);
    assert!(mesh.topology.is_manifold(), "{:?}", mesh.topology);
    let mut is_used = vec![false; position.len()];
    for &[a, b, c] in &mesh.triangles {
        let [p, q, r] = [a, b, c].map(|v| position[v as usize].as_dvec3());
        let area = (q - p).cross(r - p);
        let mean: DVec3 = [a, b, c].iter().map(|&v| normal[v as usize].normalize_or_zero().as_dvec3()).sum();
        assert!(area.dot(mean) > 0.0, "triangle {:?} faces against its normals", [a, b, c]);
        [a, b, c].iter().for_each(|&v| is_used[v as usize] = true);
    }
    let unused: Vec<u32> = (0..position.len() as u32).filter(|&v| !is_used[v as usize]).collect();
    assert_eq!(mesh.left_out, unused);
    assert!(mesh.unfilled.iter().all(|hole| mesh.topology.borders.contains(hole)));
    mesh
}

/// Checks that the mesh is closed and connected and has the surface's Euler number.
#[track_caller]
fn assert_closed(surface: &Surface, settings: &Settings) {
    let particles = of_gallery(surface.id, settings).particles().clone();
    let mesh = mesh(&particles.local, &particles.normal, Some(&surface.bounds));
    let genus = i64::from(surface.genus.expect("a closed surface"));
    let told = format!("{}, {} particles, {settings:?}", surface.id, particles.len());
    assert!(mesh.topology.is_closed(), "{told}: borders {:?}", mesh.topology.borders);
    assert_eq!(mesh.topology.components.len(), 1, "{told}");
    assert_eq!(mesh.topology.euler(), 2 - 2 * genus, "{told}");
    let most = particles.len() / 500;
    assert!(mesh.left_out.len() <= most, "{told}: {} left out", mesh.left_out.len());
}

fn closed_surfaces() -> impl Iterator<Item = &'static Surface> {
    gallery::SURFACES.iter().filter(|surface| surface.smooth && surface.genus.is_some())
}

#[test]
fn smooth_closed_surfaces_have_their_euler_number() {
    assert!(closed_surfaces().count() >= 10);
    for surface in closed_surfaces() {
        for seed in 0..2 {
            assert_closed(surface, &of_count(4000, seed, 0.7, 10));
            assert_closed(surface, &of_count(4000, seed, 0.8, 0));
        }
        assert_closed(surface, &of_count(14_000, 2, 0.7, 0));
        assert_closed(surface, &of_count(14_000, 3, 0.8, 10));
    }
}

#[test]
fn sets_of_varying_size_are_closed_too() {
    let settings = Settings::with_count(6_000).adaptive();
    for surface in closed_surfaces() {
        assert_closed(surface, &settings);
    }
}

#[test]
fn surfaces_that_the_box_cuts_have_borders_at_the_box_alone() {
    for id in ["gyroid", "schwarz-p", "schwarz-d", "clebsch"] {
        let surface = gallery::find(id).expect("a surface of the gallery");
        for (seed, relax_steps) in [(0, 10), (1, 0), (2, 10)] {
            let particles =
                of_gallery(surface.id, &of_count(14_000, seed, 0.75, relax_steps)).particles().clone();
            let mesh = mesh(&particles.local, &particles.normal, Some(&surface.bounds));
            let told = format!("{id}, seed {seed}");
            assert_eq!(mesh.unfilled, [[0_u32; 0]; 0], "{told}");
            assert!(!mesh.topology.borders.is_empty(), "{told}");
            // A front comes within a spacing of the box, the steps of its rows within another.
            let reach = f64::from(4.0 * particles.radius[0]);
            for &v in mesh.topology.borders.iter().flatten() {
                let p = particles.local[v as usize].as_dvec3();
                let depth = (p - surface.bounds.lo()).min(surface.bounds.hi() - p).min_element();
                assert!(depth <= reach, "{told}: a border at {p}, {depth} from the box");
            }
            assert!(mesh.left_out.len() <= 14, "{told}: {} left out", mesh.left_out.len());
        }
    }
}

#[test]
fn a_tube_that_the_box_cuts_stays_open_however_few_points_are_round_it() {
    let surface = gallery::find("schwarz-p").expect("a surface of the gallery");
    let particles = of_gallery(surface.id, &of_count(3000, 0, 0.7, 10)).particles().clone();
    for bounds in [None, Some(&surface.bounds)] {
        let mesh = mesh(&particles.local, &particles.normal, bounds);
        assert_eq!(mesh.topology.borders.len(), 24);
        assert!(mesh.topology.borders.iter().all(|border| border.len() < 24));
        assert_eq!(mesh.unfilled.len(), 0);
    }
}

/// A spiral of `n` evenly spread points on the unit sphere.
fn spiral(n: usize) -> Vec<Vec3> {
    let turn = core::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let point = |i: usize| {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / n as f64;
        let (sine, cosine) = libm::sincos(turn * i as f64);
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cosine, r * sine, z).as_vec3()
    };
    (0..n).map(point).collect()
}

/// A few numbers between −1 and 1, the same ones each time.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }
}

#[test]
fn sheets_that_face_the_same_way_are_not_joined() {
    // Four spheres of 5,000 points and more, a third of a spacing apart.
    let (mut position, mut normal) = (Vec::new(), Vec::new());
    for k in 0..4 {
        let sphere = spiral(5000 + 150 * k);
        position.extend(sphere.iter().map(|&n| n * (1.0 + 0.0165 * k as f32)));
        normal.extend(sphere);
    }
    let mesh = mesh(&position, &normal, None);
    assert!(mesh.topology.is_closed());
    let euler: Vec<i64> = mesh.topology.components.iter().map(Component::euler).collect();
    assert_eq!(euler, [2; 4]);
}

#[test]
fn lattices_on_which_no_diagonal_is_the_better_one_are_joined() {
    // A torus of 60 × 60 points.
    let circle = |i: i32| libm::sincos(core::f64::consts::TAU * f64::from(i) / 60.0);
    let (mut position, mut normal) = (Vec::new(), Vec::new());
    for i in 0..60 {
        for j in 0..60 {
            let ((s, c), (up, out)) = (circle(i), circle(j));
            normal.push(DVec3::new(c * out, s * out, up).as_vec3());
            position.push(DVec3::new(c * (1.0 + 0.5 * out), s * (1.0 + 0.5 * out), 0.5 * up).as_vec3());
        }
    }
    let torus = mesh(&position, &normal, None);
    assert!(torus.topology.is_closed());
    assert_eq!((torus.topology.euler(), torus.left_out.len()), (0, 0));
    // A square of 50 × 50, whose border is its outline. Its normals need not be units.
    let position: Vec<Vec3> = (0..2500).map(|k| Vec3::new((k % 50) as f32, (k / 50) as f32, 1.0)).collect();
    let square = mesh(&position, &vec![Vec3::Z * 7.0; 2500], None);
    assert_eq!(square.triangles.len(), 2 * 49 * 49);
    assert_eq!(square.topology.borders.len(), 1);
    assert_eq!(square.topology.borders[0].len(), 4 * 49);
}

#[test]
fn random_points_are_joined() {
    for seed in 0..4 {
        let mut noise = Noise(seed);
        let normal: Vec<Vec3> = (0..3000)
            .map(|_| {
                loop {
                    let v = noise.vector();
                    if (0.01..1.0).contains(&v.length_squared()) {
                        return (v / v.length()).as_vec3();
                    }
                }
            })
            .collect();
        let mesh = mesh(&normal, &normal, None);
        assert!(mesh.topology.is_closed(), "seed {seed}: {:?}", mesh.topology.borders);
        assert_eq!(mesh.topology.euler(), 2, "seed {seed}");
    }
}

#[test]
fn a_hole_in_the_points_is_a_border_and_a_small_one_is_filled() {
    for (top, borders) in [(0.9, 1), (0.995, 0)] {
        let position: Vec<Vec3> = spiral(8000).into_iter().filter(|p| p.z < top).collect();
        let mesh = mesh(&position, &position, None);
        assert_eq!(mesh.topology.borders.len(), borders, "up to {top}");
        assert_eq!(mesh.unfilled.len(), 0);
    }
}

#[test]
fn size_and_place_of_the_whole_do_not_matter() {
    let normal = spiral(2000);
    for scale in [1e-12_f32, 1e-6, 1e6, 1e12] {
        for shift in [0.0, 100.0] {
            let position: Vec<Vec3> = normal.iter().map(|&n| (n + shift) * scale).collect();
            let mesh = mesh(&position, &normal, None);
            assert!(mesh.topology.is_closed(), "scale {scale:e}");
            assert_eq!(mesh.topology.euler(), 2, "scale {scale:e}");
        }
    }
}

#[test]
fn points_that_cannot_be_joined_are_left_out_and_named() {
    let normal = spiral(2000);
    let (mut position, mut bad_normal) = (normal.clone(), normal.clone());
    position[7] = Vec3::NAN;
    position[900] = Vec3::INFINITY;
    position[1000] = position[400];
    bad_normal[20] = Vec3::ZERO;
    bad_normal[30] = Vec3::NAN;
    let sphere = mesh(&position, &bad_normal, None);
    assert_eq!(sphere.left_out.len(), 5);
    for bad in [7, 20, 30, 900] {
        assert!(sphere.left_out.contains(&bad), "{:?}", sphere.left_out);
    }
    // One of the two at one place.
    assert!(sphere.left_out.contains(&400) != sphere.left_out.contains(&1000));
    assert!(sphere.topology.is_closed());
    // No mesh at all, then a triangle.
    for (count, triangles) in [(0, 0), (1, 0), (2, 0), (3, 1)] {
        let few = mesh(&normal[..count], &normal[..count], None);
        assert_eq!(few.triangles.len(), triangles, "{count} points");
    }
    let line: Vec<Vec3> = (0..500).map(|i| Vec3::X * i as f32).collect();
    assert_eq!(mesh(&line, &vec![Vec3::Z; 500], None).left_out.len(), 500);
    assert_eq!(mesh(&vec![Vec3::ONE; 50_000], &vec![Vec3::Z; 50_000], None).left_out.len(), 50_000);
}

#[test]
fn nonsense_gives_a_manifold_in_linear_time() {
    let mut noise = Noise(1);
    let position: Vec<Vec3> = (0..10_000).map(|_| noise.vector().as_vec3()).collect();
    let normal: Vec<Vec3> = (0..10_000).map(|_| noise.vector().as_vec3()).collect();
    mesh(&position, &normal, None);
    mesh(&position, &vec![Vec3::Z; 10_000], None);
    // Normals that lie in the surface, and a fiftieth of the normals turned over.
    let sphere = spiral(4000);
    let turned: Vec<Vec3> =
        sphere.iter().enumerate().map(|(i, &n)| if i % 50 == 0 { -n } else { n }).collect();
    mesh(&sphere, &vec![Vec3::X; 4000], None);
    let mesh = mesh(&sphere, &turned, None);
    assert!(mesh.triangles.len() > 7500);
}
