//! Tests of every quality figure, on point sets with known figures.
#![allow(clippy::disallowed_methods, reason = "made-up points need no equal bits")]

use glam::{DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::field::Sym3;
use marching_particles::field::{Field, Jet};
use marching_particles::particles::Particles;
use marching_particles::quality::{CROWDED, MeasureOptions, Measurements, measure};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// A field given by its jet alone.
struct Analytic<F: Fn(DVec3) -> Jet>(F);

impl<F: Fn(DVec3) -> Jet + Send + Sync> Field for Analytic<F> {
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        let jet = (self.0)(p);
        (jet.value, jet.gradient)
    }

    fn jet(&self, p: DVec3) -> Jet {
        (self.0)(p)
    }
}

fn plane() -> Analytic<impl Fn(DVec3) -> Jet + Send + Sync> {
    Analytic(|p| Jet { value: p.z, gradient: DVec3::Z, ..Jet::default() })
}

/// |p|² − 1.
fn sphere() -> Analytic<impl Fn(DVec3) -> Jet + Send + Sync> {
    Analytic(|p| Jet {
        value: p.length_squared() - 1.0,
        gradient: 2.0 * p,
        hessian: Sym3 { xx: 2.0, yy: 2.0, zz: 2.0, ..Sym3::default() },
    })
}

/// (√(x² + y²) − 1)² + z² − 1/4, without its Hessian.
fn torus() -> Analytic<impl Fn(DVec3) -> Jet + Send + Sync> {
    Analytic(|p| {
        let ring = p.truncate().length();
        let out = ring - 1.0;
        Jet {
            value: out * out + p.z * p.z - 0.25,
            gradient: DVec3::new(2.0 * out * p.x / ring, 2.0 * out * p.y / ring, 2.0 * p.z),
            ..Jet::default()
        }
    })
}

const HEXAGONAL: [f64; 2] = [0.5, 0.866_025_403_784_438_6];

/// Plane lattice spanned by (1, 0) and `second`, times `scale`, in the square of half-width `half`,
/// and that square as clip box.
fn lattice(second: [f64; 2], scale: f64, half: f64) -> (Vec<Vec3>, Bounds) {
    let steps = (4.0 * half / scale) as i32;
    let mut points = Vec::new();
    for j in -steps..=steps {
        for i in -steps..=steps {
            let x = scale * (f64::from(i) + f64::from(j) * second[0]);
            let y = scale * f64::from(j) * second[1];
            if x.abs() < half && y.abs() < half {
                points.push(DVec3::new(x, y, 0.0).as_vec3());
            }
        }
    }
    (points, Bounds::cube(half))
}

/// Options with the exact area of `n` points of a lattice with cells of area `cell`.
fn with_area<'a>(n: usize, cell: f64) -> MeasureOptions<'a> {
    MeasureOptions { area: Some(n as f64 * cell), ..MeasureOptions::default() }
}

/// `n` points of a Fibonacci spiral on the unit sphere.
fn fibonacci(n: usize) -> Vec<Vec3> {
    let turn = core::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..n)
        .map(|i| {
            let z = 1.0 - (2.0 * i as f64 + 1.0) / n as f64;
            let (s, c) = (turn * i as f64).sin_cos();
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * c, r * s, z).as_vec3()
        })
        .collect()
}

struct Random(Pcg32);

impl Random {
    fn new(seed: u64) -> Self {
        Self(Pcg32::seed_from_u64(seed))
    }

    fn unit(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / 4_294_967_296.0
    }

    /// Standard normal (Box–Muller).
    fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.unit()).ln()).sqrt() * (core::f64::consts::TAU * self.unit()).cos()
    }

    fn on_sphere(&mut self) -> Vec3 {
        DVec3::new(self.normal(), self.normal(), self.normal()).normalize().as_vec3()
    }
}

#[track_caller]
fn close(name: &str, value: f64, wanted: f64, tolerance: f64) {
    assert!((value - wanted).abs() <= tolerance, "{name} = {value}, not {wanted} ± {tolerance}");
}

const SPHERE_AREA: f64 = 4.0 * core::f64::consts::PI;

#[test]
fn hexagonal_lattice_is_perfect_in_every_figure() {
    let scale = 1.0 / 32.0;
    // No point lies exactly 4 spacings from a side.
    let half = 1.01;
    let (points, bounds) = lattice(HEXAGONAL, scale, half);
    let cell = scale * scale * HEXAGONAL[1];
    let normals = vec![Vec3::Z; points.len()];
    let discs = Particles { radius: vec![(0.5 * scale) as f32; points.len()], ..Particles::default() };
    let options = MeasureOptions { rows: Some(&discs), ..with_area(points.len(), cell) };
    let report = measure(&points, &normals, &plane(), Some(&bounds), &options);
    let f = report.figures;
    println!("{f:#?}");
    // Discs that touch cover π/(2√3) of the plane.
    close("uncovered", f.coverage.uncovered, 1.0 - core::f64::consts::PI / 12.0_f64.sqrt(), 3e-3);
    close("ideal_spacing", f.ideal_spacing, scale, 1e-9);
    close("area", f.area, cell * points.len() as f64, 1e-9);
    close("error_max", f.accuracy.error_max, 0.0, 0.0);
    close("nearest_min", f.spacing.nearest_min, 1.0, 1e-4);
    close("rho", f.spacing.rho, f.spacing.nearest_min, 0.0);
    close("nearest_percentile_1", f.spacing.nearest_percentile_1, 1.0, 1e-4);
    close("nearest_mean", f.spacing.nearest_mean, 1.0, 1e-4);
    close("spacing_variation", f.spacing.spacing_variation, 0.0, 1e-4);
    close("nearest_ratio", f.spacing.nearest_ratio, 1.0, 1e-4);
    close("cover", f.coverage.cover, 1.0, 1e-4);
    close("quantization_error", f.coverage.quantization_error, 1.0, 3e-3);
    close("six", f.order.six_neighbours, 1.0, 0.0);
    close("five_or_seven_neighbours", f.order.five_or_seven_neighbours, 0.0, 0.0);
    close("valence_deviation", f.order.valence_deviation, 0.0, 0.0);
    close("bond_order", f.order.bond_order, 1.0, 1e-4);
    close("triangle_share", f.connectivity.triangle_share, 1.0, 0.0);
    close("smallest_angle", f.angles.smallest_angle, 60.0, 1e-2);
    close("mean_smallest_angle", f.angles.mean_smallest_angle, 60.0, 1e-2);
    close("triangles_below_30", f.angles.triangles_below_30, 0.0, 0.0);
    close("triangles_above_90", f.angles.triangles_above_90, 0.0, 0.0);
    close("edge_variation", f.edges.edge_variation, 0.0, 1e-4);
    close("normal_error_max", f.accuracy.normal_error_max, 0.0, 0.0);
    assert_eq!((f.order.open, f.duplicates, f.accuracy.undefined, f.not_finite), (0, 0, 0, 0));
    assert_eq!((f.connectivity.euler, f.connectivity.components), (1, 1), "a disc");
    let inside = |p: &Vec3| f64::from(p.x.abs().max(p.y.abs())) < half - 4.0 * scale;
    let excluded = points.iter().filter(|p| !inside(p)).count() as f64;
    close("boundary_excluded", f.boundary_excluded as f64, excluded, 0.01 * excluded);
    for (i, p) in points.iter().enumerate().filter(|(_, p)| inside(p)) {
        assert_eq!(report.valence[i], 6, "valence at {p}");
        close("nearest", f64::from(report.nearest[i]), scale, 1e-6);
    }
}

#[test]
fn square_lattice_has_valence_four_and_half_right_angles() {
    // The scale is a power of two: all coordinates are exact, and the corners of each square are
    // exactly cocircular.
    let scale = 1.0 / 32.0;
    let (points, bounds) = lattice([0.0, 1.0], scale, 1.0);
    let report = measure(&points, &[], &plane(), Some(&bounds), &with_area(points.len(), scale * scale));
    let f = report.figures;
    println!("{f:#?}");
    let ideal_spacing = (2.0 / 3.0_f64.sqrt()).sqrt();
    close("nearest_min", f.spacing.nearest_min, 1.0 / ideal_spacing, 1e-9);
    close("six", f.order.six_neighbours, 0.0, 0.0);
    close("valence_deviation", f.order.valence_deviation, 0.0, 0.0);
    let centre = points.iter().position(|&p| p == Vec3::ZERO).expect("the origin is a lattice point");
    assert_eq!(report.valence[centre], 4);
    // exp(6iθ) of the four neighbours is 1, −1, 1, −1.
    close("bond_order", f.order.bond_order, 0.0, 1e-9);
    // A diagonal of each square makes two triangles, whichever it is.
    close("smallest_angle", f.angles.smallest_angle, 45.0, 1e-9);
    close("mean_smallest_angle", f.angles.mean_smallest_angle, 45.0, 1e-9);
}

#[test]
fn nearly_square_lattice_has_the_figures_of_the_square() {
    // A shear of 2 % decides the diagonal of every square.
    let scale = 1.0 / 32.0;
    let (points, bounds) = lattice([0.02, 1.0], scale, 1.0);
    let options = with_area(points.len(), scale * scale);
    let f = measure(&points, &[], &plane(), Some(&bounds), &options).figures;
    println!("{f:#?}");
    let ideal_spacing = (2.0 / 3.0_f64.sqrt()).sqrt();
    close("six", f.order.six_neighbours, 1.0, 0.0);
    close("smallest_angle", f.angles.smallest_angle, 45.0, 1.0);
    close("triangles_above_90", f.angles.triangles_above_90, 0.0, 0.0);
    close("triangle_share", f.connectivity.triangle_share, 1.0, 0.0);
    // The circumradius of a triangle of area 1/2 is half the product of its sides.
    let circumradius = 0.5 * (1.0_f64 + 0.02 * 0.02).sqrt() * (1.0_f64 + 0.98 * 0.98).sqrt();
    close("cover", f.coverage.cover, circumradius / (ideal_spacing / 3.0_f64.sqrt()), 1e-4);
    // The mean squared distance to the centre of a unit square is 1/6. The measured region cuts
    // through a row of cells.
    close(
        "quantization_error",
        f.coverage.quantization_error,
        (1.0 / 6.0) / (5.0 / (18.0 * 3.0_f64.sqrt())),
        0.01,
    );
}

#[test]
fn jittered_lattice_has_the_known_mean_angle() {
    let scale = 1.0 / 64.0;
    let (lattice, bounds) = lattice(HEXAGONAL, scale, 1.0);
    for (jitter, angle) in [(0.02, 58.0), (0.04, 56.0), (0.06, 54.1)] {
        let mut random = Random::new(7);
        let points: Vec<Vec3> = lattice
            .iter()
            .map(|p| {
                let step = DVec3::new(random.normal(), random.normal(), 0.0) * (jitter * scale);
                (p.as_dvec3() + step).as_vec3()
            })
            .collect();
        let options = with_area(points.len(), scale * scale * HEXAGONAL[1]);
        let f = measure(&points, &[], &plane(), Some(&bounds), &options).figures;
        println!("jitter {jitter}: {f:#?}");
        close("mean_smallest_angle", f.angles.mean_smallest_angle, angle, 0.15);
        // The length of an edge varies by √2 times the jitter.
        close("edge_variation", f.edges.edge_variation, jitter * 2.0_f64.sqrt(), 0.12 * jitter);
    }
}

#[test]
fn fibonacci_sphere_is_a_closed_manifold() {
    let n = 2000;
    let points = fibonacci(n);
    let options = MeasureOptions { area: Some(SPHERE_AREA), ..MeasureOptions::default() };
    let report = measure(&points, &points, &sphere(), None, &options);
    let f = report.figures;
    println!("{f:#?}");
    assert_eq!((f.connectivity.euler, f.connectivity.components), (2, 1));
    close("triangle_share", f.connectivity.triangle_share, 1.0, 2e-3);
    close("agree", f.connectivity.agree, 1.0, 3e-3);
    assert_eq!((f.order.open, f.boundary_excluded), (0, 0));
    // On a closed triangulation Σ (6 − valence) = 6χ. Near the poles four points are almost
    // cocircular; where both diagonals are accepted, there are two neighbours and two triangles too
    // many.
    let defect: i32 = report.valence.iter().map(|&v| 6 - i32::from(v)).sum();
    let surplus = (f.connectivity.triangle_share - 1.0) * (2 * n - 4) as f64;
    close("defect", f64::from(defect), 12.0 - surplus, 1e-6);
    // Rounding to single precision moves the points off the sphere.
    assert!(
        f.accuracy.error_max * f.ideal_spacing < 2e-7 && f.accuracy.error_max > 0.0,
        "error_max = {}",
        f.accuracy.error_max
    );
    assert!(f.accuracy.normal_error_max < 1e-4, "normal_error_max = {}", f.accuracy.normal_error_max);
    // The flat triangles have a little less area than the sphere.
    let flat = measure(&points, &points, &sphere(), None, &MeasureOptions::default()).figures;
    let missing = 1.0 - flat.area / SPHERE_AREA;
    assert!(missing > 0.0 && missing < 8.0 / n as f64, "missing {missing} of the area");
    assert!(f.coverage.cover > 1.0 && f.coverage.cover < 1.4, "cover = {}", f.coverage.cover);
    assert!(
        f.coverage.quantization_error > 1.0 && f.coverage.quantization_error < 1.1,
        "quantization_error = {}",
        f.coverage.quantization_error
    );
}

#[test]
fn torus_lattice_has_euler_number_zero() {
    let (around, through) = (160, 60);
    let mut points = Vec::new();
    for i in 0..around {
        for j in 0..through {
            let u = core::f64::consts::TAU * f64::from(i) / f64::from(around);
            let v = core::f64::consts::TAU * (f64::from(j) + 0.5 * f64::from(i % 2)) / f64::from(through);
            let ring = 1.0 + 0.5 * v.cos();
            points.push(DVec3::new(ring * u.cos(), ring * u.sin(), 0.5 * v.sin()).as_vec3());
        }
    }
    let f = measure(&points, &[], &torus(), None, &MeasureOptions::default()).figures;
    println!("{f:#?}");
    assert_eq!((f.connectivity.euler, f.connectivity.components, f.order.open), (0, 1, 0));
    close("triangle_share", f.connectivity.triangle_share, 1.0, 0.0);
    close("area", f.area, 2.0 * core::f64::consts::PI.powi(2), 0.05);
    assert!(f.accuracy.normal_error_mean.is_nan(), "no normals were given");
}

#[test]
fn white_noise_has_its_known_figures() {
    let mut random = Random::new(1);
    let n = 40_000;
    let points: Vec<Vec3> = (0..n).map(|_| random.on_sphere()).collect();
    let options = MeasureOptions { area: Some(SPHERE_AREA), ..MeasureOptions::default() };
    let f = measure(&points, &points, &sphere(), None, &options).figures;
    println!("{f:#?}");
    close("six", f.order.six_neighbours, 0.295, 0.008);
    close("quantization_error", f.coverage.quantization_error, 1.985, 0.03);
    close("nearest_mean", f.spacing.nearest_mean, 0.465, 0.005);
    // The nearest-neighbour distance of a Poisson process is Rayleigh distributed.
    close("spacing_variation", f.spacing.spacing_variation, (4.0 / core::f64::consts::PI - 1.0).sqrt(), 0.01);
    assert!(f.spacing.rho < 0.02, "rho = {}", f.spacing.rho);
    // The cumulative distribution of the distances is 1 − exp(−π N x²/A).
    let first = (-(1.0_f64 - 0.01).ln() * 3.0_f64.sqrt() / 2.0 / core::f64::consts::PI).sqrt();
    close("nearest_percentile_1", f.spacing.nearest_percentile_1, first, 0.1 * first);
    close("triangle_share", f.connectivity.triangle_share, 1.0, 0.01);
    assert_eq!(f.order.open, 0);
}

#[test]
fn hole_is_measured_as_a_hole() {
    let mut points = fibonacci(3000);
    let whole = measure(&points, &[], &sphere(), None, &MeasureOptions::default()).figures;
    let centre = points[1500];
    let radius = 2.5 * whole.ideal_spacing as f32;
    points.retain(|p| p.distance(centre) > radius);
    let f = measure(&points, &[], &sphere(), None, &MeasureOptions::default()).figures;
    // The largest empty disc is at least as large as the hole, and at most one spacing larger.
    let gap = f.coverage.cover * f.ideal_spacing / 3.0_f64.sqrt();
    assert!(gap >= f64::from(radius) && gap < f64::from(radius) + whole.ideal_spacing, "{gap} for {radius}");
    // The triangulation bridges the hole, so the sphere stays closed.
    assert_eq!((f.connectivity.euler, f.order.open), (2, 0));
    assert!(f.angles.triangles_above_90 > whole.angles.triangles_above_90);
}

#[test]
fn missed_component_and_missed_half_are_holes_too() {
    // The second of two unit spheres has no particles. Its far pole is at the distance 5 from the
    // first sphere.
    let pair = Analytic(|p| {
        let other = p - DVec3::X * 4.0;
        let centre = if p.x < 2.0 { p } else { other };
        Jet { value: centre.length_squared() - 1.0, gradient: 2.0 * centre, ..Jet::default() }
    });
    let points = fibonacci(2000);
    let bounds = Bounds { min: [-1.5, -1.5, -1.5], max: [5.5, 1.5, 1.5] };
    let options = MeasureOptions { area: Some(2.0 * SPHERE_AREA), ..MeasureOptions::default() };
    let f = measure(&points, &[], &pair, Some(&bounds), &options).figures;
    let hole = f.coverage.cover * f.ideal_spacing / 3.0_f64.sqrt();
    close("hole", hole, 4.0, 0.05);
    // Half of the area has the mean squared distance to the first sphere.
    let mean_sq = f.coverage.quantization_error * 5.0 / (18.0 * 3.0_f64.sqrt()) * f.area / 2000.0;
    assert!(mean_sq > 0.5 * 4.0 && mean_sq < 0.5 * 16.0, "mean square {mean_sq}");
    // On half a sphere, the far pole is at the distance √2 from the equator.
    let half: Vec<Vec3> = points.into_iter().filter(|p| p.z > 0.0).collect();
    let bounds = Bounds::cube(1.25);
    let f = measure(&half, &[], &sphere(), Some(&bounds), &MeasureOptions::default()).figures;
    close("hole", f.coverage.cover * f.ideal_spacing / 3.0_f64.sqrt(), 2.0_f64.sqrt(), 0.05);
}

#[test]
fn two_sheets_are_triangulated_apart_but_spaced_together() {
    // Two hexagonal patches with opposite normals are half a spacing apart.
    let scale = 1.0 / 16.0;
    let gap = 0.25 * scale;
    let (sheet, bounds) = lattice(HEXAGONAL, scale, 1.0);
    let mut points: Vec<Vec3> = sheet.iter().map(|&p| p + Vec3::Z * gap as f32).collect();
    points.extend(sheet.iter().map(|&p| p - Vec3::Z * gap as f32));
    let slab = Analytic(move |p: DVec3| Jet {
        value: p.z * p.z - gap * gap,
        gradient: DVec3::Z * (2.0 * p.z),
        hessian: Sym3 { zz: 2.0, ..Sym3::default() },
    });
    let options = with_area(points.len(), scale * scale * HEXAGONAL[1]);
    let f = measure(&points, &[], &slab, Some(&bounds), &options).figures;
    println!("{f:#?}");
    close("six", f.order.six_neighbours, 1.0, 0.0);
    close("nearest_mean", f.spacing.nearest_mean, 0.5, 1e-4);
    assert_eq!((f.connectivity.components, f.connectivity.euler), (2, 2));
}

#[test]
fn known_displacement_is_the_residual_and_tilted_normals_are_seen() {
    let scale = 1.0 / 16.0;
    let (mut points, bounds) = lattice(HEXAGONAL, scale, 1.0);
    for (i, p) in points.iter_mut().enumerate() {
        p.z = if i % 2 == 0 { 0.0 } else { 0.01 * scale as f32 };
    }
    let tilt = 5.0_f32.to_radians();
    let normals = vec![Vec3::new(tilt.sin(), 0.0, -tilt.cos()); points.len()];
    let options = with_area(points.len(), scale * scale * HEXAGONAL[1]);
    let report = measure(&points, &normals, &plane(), Some(&bounds), &options);
    let f = report.figures;
    close("error_max", f.accuracy.error_max, 0.01, 1e-8);
    close("error_mean", f.accuracy.error_mean, 0.005, 1e-5);
    close("residual", f64::from(report.residual[1]), 0.01 * scale, 1e-9);
    // The sign of the normal does not matter.
    close("normal_error_mean", f.accuracy.normal_error_mean, 5.0, 1e-4);
    close("normal_error_max", f.accuracy.normal_error_max, 5.0, 1e-4);
}

#[test]
fn touching_the_box_from_inside_is_no_border_and_crossing_it_is() {
    let points = fibonacci(4000);
    let touching = Bounds::cube(1.0);
    let f = measure(&points, &[], &sphere(), Some(&touching), &MeasureOptions::default()).figures;
    assert_eq!(f.boundary_excluded, 0);

    let cut = Bounds { min: [-2.0, -2.0, -2.0], max: [2.0, 2.0, 0.5] };
    let points: Vec<Vec3> = points.into_iter().filter(|&p| cut.contains(p)).collect();
    // The part of the sphere below z = 1/2 has the area 2π · 3/2.
    let area = 3.0 * core::f64::consts::PI;
    let options = MeasureOptions { area: Some(area), ..MeasureOptions::default() };
    let f = measure(&points, &[], &sphere(), Some(&cut), &options).figures;
    println!("{f:#?}");
    // The zone extends from the border, 60° from the pole, to where the chord to the border is 4
    // ideal_spacing.
    let arc = 2.0 * (2.0 * f.ideal_spacing).asin();
    let zone = core::f64::consts::TAU * (0.5 - (60.0_f64.to_radians() + arc).cos());
    let wanted = zone / area * points.len() as f64;
    close("boundary_excluded", f.boundary_excluded as f64, wanted, 0.03 * wanted);
    close("triangle_share", f.connectivity.triangle_share, 1.0, 1e-3);
    assert_eq!((f.order.open, f.connectivity.euler), (0, 1));
    assert!(f.coverage.cover < 1.4, "cover = {}", f.coverage.cover);
    assert!(f.angles.smallest_angle > 25.0, "smallest_angle = {}", f.angles.smallest_angle);
}

#[test]
fn edges_are_compared_with_the_wanted_radii() {
    let scale = 1.0 / 32.0;
    let (points, bounds) = lattice(HEXAGONAL, scale, 1.0);
    let measured = |radii: Option<&[f32]>| {
        let options = MeasureOptions { radii, ..with_area(points.len(), scale * scale * HEXAGONAL[1]) };
        measure(&points, &[], &plane(), Some(&bounds), &options).figures.edges.size_variation
    };
    let equal = vec![0.5 * scale as f32; points.len()];
    close("equal radii", measured(Some(&equal)), 0.0, 1e-4);
    assert!(measured(None).is_nan());
    // The sum of radii is 6 in one half and 2 in the other, so |P − Q| / sum has the values s/6 and
    // s/2.
    let unequal: Vec<f32> = points.iter().map(|p| if p.x > 0.0 { 3.0 } else { 1.0 }).collect();
    close("two sizes", measured(Some(&unequal)), 0.5, 0.03);
    // With equal radii, the variation is that of the edges themselves.
    let points = fibonacci(2000);
    let options = MeasureOptions { radii: Some(&[1.0; 2000]), ..MeasureOptions::default() };
    let f = measure(&points, &[], &sphere(), None, &options).figures;
    close("size_variation", f.edges.size_variation, f.edges.edge_variation, 1e-6);
}

/// Conformal image, under exp, of a hexagonal lattice: the spacing is proportional to the distance
/// from the origin, and each point has six neighbours. Returns the points in the square from 0.55
/// to 1.35 and their radii, which are half the distance of neighbours to first order in `step`.
fn growing_lattice(step: f64) -> (Vec<Vec3>, Vec<f32>) {
    let (mut points, mut radii) = (Vec::new(), Vec::new());
    let reach = (1.0 / step) as i64 + 2;
    for row in -reach..=4 * reach {
        for column in -3 * reach..=2 * reach {
            let logarithm = step * (column as f64 + 0.5 * (row & 1) as f64);
            let angle = step * 0.5 * 3.0_f64.sqrt() * row as f64;
            let size = logarithm.exp();
            let (x, y) = (size * angle.cos(), size * angle.sin());
            if angle.abs() < 2.0 && x > 0.55 && x < 1.35 && y > 0.55 && y < 1.35 {
                points.push(Vec3::new(x as f32, y as f32, 0.0));
                radii.push((0.5 * step * size) as f32);
            }
        }
    }
    (points, radii)
}

#[test]
fn smoothly_growing_particles_are_measured_against_their_own_size() {
    let step = 0.02;
    let (points, radii) = growing_lattice(step);
    let bounds = Bounds { min: [0.55, 0.55, -0.5], max: [1.35, 1.35, 0.5] };
    let options = MeasureOptions { area: Some(0.64), radii: Some(&radii), ..MeasureOptions::default() };
    let f = measure(&points, &[], &plane(), Some(&bounds), &options).figures;
    println!("{} points: {f:#?}", points.len());
    // A neighbour at δ = step · exp(iθ) in the logarithm is 2 |sinh(δ/2)| / (step cosh(Re δ/2))
    // sums of radii away.
    let ratios = [0.0, 60.0_f64, 120.0].map(|angle| {
        let (re, im) = (0.5 * step * angle.to_radians().cos(), 0.5 * step * angle.to_radians().sin());
        let sinh_sq = re.sinh() * re.sinh() + im.sin() * im.sin();
        2.0 * sinh_sq.sqrt() / (step * re.cosh())
    });
    let mean = ratios.iter().sum::<f64>() / 3.0;
    let variation = (ratios.iter().map(|r| (r - mean) * (r - mean)).sum::<f64>() / 3.0).sqrt() / mean;
    close("size_variation", f.edges.size_variation, variation, 1e-5);
    close("overlap_min", f.edges.overlap_min, ratios.into_iter().fold(1.0, f64::min), 1e-4);
    // The cells fill the square, except for those that its edge cuts.
    close("cover_local", f.coverage.cover_local, 1.0, 0.03);
    assert!(
        f.edges.edge_variation > 0.1 && f.coverage.cover > 1.2,
        "the sizes differ: {} {}",
        f.edges.edge_variation,
        f.coverage.cover
    );
    assert_eq!(f.order.six_neighbours, 1.0);
}

#[test]
fn a_missing_particle_is_a_hole_of_its_own_size() {
    let step = 0.02;
    let (points, radii) = growing_lattice(step);
    let bounds = Bounds { min: [0.55, 0.55, -0.5], max: [1.35, 1.35, 0.5] };
    let hole_at = |middle: Vec3| {
        let nearest = |a: &&usize, b: &&usize| {
            (points[**a] - middle).length().total_cmp(&(points[**b] - middle).length())
        };
        let all: Vec<usize> = (0..points.len()).collect();
        let gone = *all.iter().min_by(nearest).expect("a point");
        let kept = || all.iter().filter(|&&i| i != gone);
        let position: Vec<Vec3> = kept().map(|&i| points[i]).collect();
        let radius: Vec<f32> = kept().map(|&i| radii[i]).collect();
        let options = MeasureOptions { area: Some(0.64), radii: Some(&radius), ..MeasureOptions::default() };
        measure(&position, &[], &plane(), Some(&bounds), &options).figures
    };
    // The six points around a missing one are a spacing away from its position, √3 times as far as
    // from the centre of an ideal triangle.
    let root_3 = 3.0_f64.sqrt();
    let small = hole_at(Vec3::new(0.72, 0.72, 0.0));
    close("cover_local, small", small.coverage.cover_local, root_3, 0.05);
    let large = hole_at(Vec3::new(1.15, 1.15, 0.0));
    close("cover_local, large", large.coverage.cover_local, root_3, 0.05);
    assert!(
        large.coverage.cover > 1.4 * small.coverage.cover,
        "{} {}",
        large.coverage.cover,
        small.coverage.cover
    );
}

#[test]
fn equal_radii_make_the_local_hole_the_hole() {
    let points = fibonacci(3000);
    let radii = vec![0.7; points.len()];
    let options = MeasureOptions { radii: Some(&radii), ..MeasureOptions::default() };
    let f = measure(&points, &[], &sphere(), Some(&Bounds::cube(1.5)), &options).figures;
    close("cover_local", f.coverage.cover_local, f.coverage.cover, 1e-5);
    close("overlap_min", f.edges.overlap_min, f.spacing.nearest_min * f.ideal_spacing / 1.4, 1e-5);
    let f = measure(&points, &[], &sphere(), None, &MeasureOptions::default()).figures;
    assert!(f.coverage.cover_local.is_nan() && f.edges.overlap_min.is_nan());
}

#[test]
fn duplicates_are_counted_and_do_not_break_the_triangulation() {
    let points = fibonacci(500);
    let clean = measure(&points, &points, &sphere(), None, &MeasureOptions::default());
    let mut doubled = points.clone();
    doubled.extend([points[17], points[17], points[3]]);
    let report = measure(&doubled, &doubled, &sphere(), None, &MeasureOptions::default());
    let f = report.figures;
    assert_eq!((f.duplicates, f.connectivity.euler), (3, 2));
    close("rho", f.spacing.rho, 0.0, 0.0);
    assert_eq!((report.nearest[17], report.nearest[500]), (0.0, 0.0));
    assert_eq!(report.valence[500], 0);
    assert_eq!(report.valence[..500], clean.valence[..]);
    // A duplicate is a crowded pair with the particle that it equals.
    assert_eq!(f.spacing.crowded, clean.figures.spacing.crowded.map(|crowded| crowded + 3));
    let [a, b, c] = [0, 1, 2].map(|k| report.places.pairs[k]);
    assert_eq!([a.ratio, b.ratio, c.ratio], [0.0; 3]);
    assert_eq!([a.particles, b.particles, c.particles], [[3, 502], [17, 500], [17, 501]]);
}

#[test]
fn crowded_pairs_are_those_of_a_search_of_all_pairs() {
    let mut random = Random::new(5);
    let points: Vec<Vec3> = (0..700).map(|_| random.on_sphere()).collect();
    let report = measure(&points, &[], &sphere(), None, &MeasureOptions::default());
    let limit = CROWDED * report.figures.ideal_spacing;
    let mut pairs: Vec<(f64, [u32; 2])> = Vec::new();
    for j in 0..points.len() {
        for i in 0..j {
            let distance = (points[i].as_dvec3() - points[j].as_dvec3()).length();
            if distance < limit {
                pairs.push((distance, [i as u32, j as u32]));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(pairs.len() > 64, "{} pairs", pairs.len());
    assert_eq!(report.figures.spacing.crowded, Some(pairs.len()));
    assert_eq!(report.places.pairs.len(), 64);
    for (told, (distance, particles)) in report.places.pairs.iter().zip(&pairs) {
        assert_eq!(told.particles, *particles);
        close("ratio", told.ratio, distance / report.figures.ideal_spacing, 1e-6);
    }
}

#[test]
fn the_energy_is_one_in_a_lattice_less_beside_a_hole_and_more_in_a_crowd() {
    let (whole, bounds) = lattice(HEXAGONAL, 1.0 / 32.0, 0.5);
    let middle = (0..whole.len())
        .min_by(|&a, &b| whole[a].length_squared().total_cmp(&whole[b].length_squared()))
        .expect("a point");
    let radii = vec![1.0 / 64.0; whole.len()];
    let energy_of = |points: &[Vec3], p: usize, radii: Option<&[f32]>| {
        let options = MeasureOptions { radii, ..with_area(whole.len(), HEXAGONAL[1] / 1024.0) };
        measure(points, &[], &plane(), Some(&bounds), &options).energy[p]
    };
    let neighbour = (0..whole.len())
        .find(|&i| i != middle && whole[i].distance(whole[middle]) < 1.1 / 32.0)
        .expect("a neighbour");
    for sizes in [None, Some(&radii[..])] {
        close("lattice", f64::from(energy_of(&whole, middle, sizes)), 1.0, 1e-4);
        // Half a spacing nearer: exp(−1/2) instead of exp(−2) from one of six, and less from
        // others.
        let mut crowd = whole.clone();
        crowd[neighbour] = 0.5 * (whole[neighbour] + whole[middle]);
        let energy = energy_of(&crowd, middle, sizes);
        assert!((1.2..1.8).contains(&energy), "{sizes:?}: {energy}");
    }
    let mut gap = whole.clone();
    gap.remove(middle);
    let beside = neighbour - usize::from(neighbour > middle);
    let energy = energy_of(&gap, beside, None);
    assert!((0.8..0.95).contains(&energy), "{energy}");
}

#[test]
fn a_missing_and_a_moved_particle_are_found_where_they_are() {
    let (whole, bounds) = lattice(HEXAGONAL, 1.0 / 32.0, 0.5);
    let of = |points: &[Vec3], radii: Option<&[f32]>| {
        let options = MeasureOptions { radii, ..with_area(whole.len(), HEXAGONAL[1] / 1024.0) };
        measure(points, &[], &plane(), Some(&bounds), &options)
    };
    let perfect = of(&whole, None);
    assert_eq!((perfect.figures.spacing.crowded, perfect.figures.coverage.wide_holes), (Some(0), Some(0)));
    // Of a perfect lattice one place of each kind is told.
    assert_eq!((perfect.places.pairs.len(), perfect.places.holes.len()), (1, 1));

    let at = |p: Vec3| {
        let from = |i: &usize| whole[*i].distance(p);
        (0..whole.len()).min_by(|a, b| from(a).total_cmp(&from(b))).expect("a point")
    };
    let (moved, still) = (at(Vec3::new(-0.2, -0.2, 0.0)), at(Vec3::new(-0.2 + 1.0 / 32.0, -0.2, 0.0)));
    let mut points = whole.clone();
    points[moved] = 0.4 * whole[moved] + 0.6 * whole[still];
    // Of the two that are missing, one is near the border, where nothing is measured.
    let gone = [at(Vec3::new(0.1, 0.2, 0.0)), at(Vec3::new(0.2, -0.1, 0.0)), at(Vec3::new(0.49, 0.0, 0.0))];
    let holes = [gone[0], gone[1]].map(|i| whole[i]);
    let kept: Vec<usize> = (0..points.len()).filter(|i| !gone.contains(i)).collect();
    let position: Vec<Vec3> = kept.iter().map(|&i| points[i]).collect();
    let radii = vec![1.0 / 64.0; position.len()];
    for sizes in [None, Some(&radii[..])] {
        let report = of(&position, sizes);
        assert_eq!(
            (report.figures.spacing.crowded, report.figures.coverage.wide_holes),
            (Some(1), Some(2)),
            "{sizes:?}"
        );
        let [pair] = report.places.pairs[..] else { panic!("{:?}", report.places.pairs) };
        let mut particles = pair.particles.map(|i| kept[i as usize]);
        particles.sort_unstable();
        assert_eq!(particles, [moved.min(still), moved.max(still)]);
        close("pair", pair.ratio, 0.4, 0.01);
        for hole in &report.places.holes {
            let middle = Vec3::from(hole.position);
            assert!(holes.iter().any(|p| p.distance(middle) < 1e-3), "{middle}");
            close("hole", hole.ratio, 3.0_f64.sqrt(), 0.02);
            close("radius", hole.radius, 1.0 / 32.0, 1e-4);
        }
    }
}

fn degenerate(points: &[Vec3], normals: &[Vec3]) -> Measurements {
    let report = measure(points, normals, &sphere(), Some(&Bounds::cube(0.9)), &MeasureOptions::default());
    assert_eq!(report.valence.len(), points.len());
    assert_eq!(report.nearest.len(), points.len());
    assert_eq!(report.residual.len(), points.len());
    report
}

#[test]
fn degenerate_input_gives_undefined_figures_and_no_panic() {
    assert!(degenerate(&[], &[]).figures.ideal_spacing.is_nan());
    let one = degenerate(&[Vec3::X], &[]);
    assert!(
        one.figures.spacing.nearest_min.is_nan() && one.nearest[0] == f32::INFINITY && one.valence[0] == 0
    );
    let two = degenerate(&[Vec3::X, Vec3::Y], &[Vec3::NAN, Vec3::ZERO]);
    assert_eq!(two.nearest, [2.0_f32.sqrt(); 2]);
    assert!(two.figures.angles.smallest_angle.is_nan());
    degenerate(&[Vec3::ZERO, Vec3::ZERO], &[Vec3::NAN]);
    let same = degenerate(&vec![Vec3::X; 5000], &[]);
    assert_eq!(same.figures.duplicates, 4999);
    let bad = degenerate(&[Vec3::X, Vec3::NAN, Vec3::Y, Vec3::INFINITY, Vec3::MAX, Vec3::Z], &[]);
    assert_eq!(bad.figures.not_finite, 2);
    // A row, a plane through the sphere and a solid cube do not sample the surface.
    degenerate(&(0..300).map(|i| Vec3::X * (i as f32 * 1e-3)).collect::<Vec<_>>(), &[]);
    let (flat, _) = lattice([0.0, 1.0], 0.125, 1.0);
    degenerate(&flat, &vec![Vec3::NAN; flat.len()]);
    let mut random = Random::new(3);
    let cloud: Vec<Vec3> =
        (0..3000).map(|_| DVec3::new(random.unit(), random.unit(), random.unit()).as_vec3()).collect();
    degenerate(&cloud, &cloud);
    for scale in [1e-30, 1e-20, 1e-8, 1e18, 1e30] {
        let scaled: Vec<Vec3> = fibonacci(300).iter().map(|&p| p * scale).collect();
        degenerate(&scaled, &scaled);
    }
}

#[test]
fn undefined_field_is_counted_and_given_normals_take_its_place() {
    let points = fibonacci(400);
    let nowhere = Analytic(|_| Jet { value: f64::NAN, gradient: DVec3::NAN, ..Jet::default() });
    let f = measure(&points, &points, &nowhere, None, &MeasureOptions::default()).figures;
    assert_eq!(f.accuracy.undefined, 400);
    assert!(f.accuracy.error_max.is_nan());
    assert_eq!((f.connectivity.euler, f.connectivity.components), (2, 1));
}

#[test]
fn the_distance_of_a_point_without_a_gradient_is_that_along_its_normal() {
    // A cone, on its axis.
    let cone = Analytic(|p| {
        let out = p.truncate().length();
        Jet { value: out + p.z, gradient: (p.truncate() / out).extend(1.0), ..Jet::default() }
    });
    let report = measure(&[Vec3::Z * 1e-3; 2], &[Vec3::Z; 2], &cone, None, &MeasureOptions::default());
    assert_eq!(report.figures.accuracy.undefined, 0);
    for residual in report.residual {
        close("residual", f64::from(residual), 1e-3, 1e-6);
    }
}

#[test]
fn order_of_the_points_does_not_matter() {
    let points = fibonacci(1000);
    let reversed: Vec<Vec3> = points.iter().rev().copied().collect();
    let one = measure(&points, &[], &sphere(), None, &MeasureOptions::default());
    let mut other = measure(&reversed, &[], &sphere(), None, &MeasureOptions::default());
    other.valence.reverse();
    other.nearest.reverse();
    assert_eq!(one.valence, other.valence);
    assert_eq!(one.nearest, other.nearest);
    close("six", one.figures.order.six_neighbours, other.figures.order.six_neighbours, 0.0);
    close("cover", one.figures.coverage.cover, other.figures.coverage.cover, 1e-4);
}

#[test]
fn histogram_counts_every_particle_once() {
    let points = fibonacci(1000);
    let report = measure(&points, &[], &sphere(), None, &MeasureOptions::default());
    let h = &report.histogram;
    assert_eq!(h.bins.iter().sum::<u32>(), 1000);
    let bin = (report.figures.spacing.nearest_mean - h.min) / (h.max - h.min) * h.bins.len() as f64;
    let near: u32 = h.bins[bin as usize - 8..bin as usize + 9].iter().sum();
    assert!(near > 900, "{near} of 1000 near the mean");
}

#[test]
fn icosahedron_has_five_neighbours_everywhere() {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut points = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        for p in [DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)] {
            points.push((p / (1.0 + golden * golden).sqrt()).as_vec3());
        }
    }
    let report = measure(&points, &points, &sphere(), None, &MeasureOptions::default());
    let f = report.figures;
    assert_eq!(report.valence, [5; 12]);
    assert_eq!((f.connectivity.euler, f.connectivity.components, f.order.open), (2, 1, 0));
    close("triangle_share", f.connectivity.triangle_share, 1.0, 0.0);
    close("smallest_angle", f.angles.smallest_angle, 60.0, 1e-4);
    close("five_or_seven_neighbours", f.order.five_or_seven_neighbours, 1.0, 0.0);
    close("edge_variation", f.edges.edge_variation, 0.0, 1e-6);
    // |mean of exp(6i·72°k)| over five directions is 0.
    close("bond_order", f.order.bond_order, 0.0, 1e-5);
}
