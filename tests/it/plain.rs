//! Plain surfaces: what is said of them is held to counts that share no code with the library.

use crate::cases;
use crate::fuzz::below;
use marching_particles::run::Severity;
use marching_particles::sampler::Method;
use marching_particles::{Bounds, Formula, Sample, Settings, Warning, sample};
use rand_core::SeedableRng;
use rand_pcg::Pcg32;
use std::collections::{BTreeMap, BTreeSet};

/// A number between two others, in hundredths.
fn between(random: &mut Pcg32, lo: f64, hi: f64) -> f64 {
    let steps = (100.0 * (hi - lo)) as usize;
    lo + 0.01 * below(random, steps + 1) as f64
}

/// What a list of triangles is, counted edge by edge.
#[derive(Debug, PartialEq)]
struct Counted {
    components: usize,
    euler: i64,
    /// Edges of one triangle.
    open: usize,
    /// Edges of more than two triangles, and vertices around which there is more than one fan.
    faults: usize,
    /// Sixth part of the sum of a · (b × c), to be trusted where nothing is open.
    volume: f64,
}

impl Counted {
    fn of(sample: &Sample) -> Self {
        let triangles = &sample.mesh().triangles;
        let mut on_edge: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
        for (k, &[a, b, c]) in triangles.iter().enumerate() {
            for [p, q] in [[a, b], [b, c], [c, a]] {
                on_edge.entry([p.min(q), p.max(q)]).or_default().push(k);
            }
        }
        let vertices: BTreeSet<u32> = triangles.iter().flatten().copied().collect();
        // Triangles that share an edge are of one component, and of one fan at its ends.
        let flood = |of: &[usize], holds: &dyn Fn(&[u32; 2]) -> bool| {
            let mut left: BTreeSet<usize> = of.iter().copied().collect();
            let mut parts = 0;
            while let Some(first) = left.pop_first() {
                parts += 1;
                let mut open = vec![first];
                while let Some(k) = open.pop() {
                    let [a, b, c] = triangles[k];
                    for [p, q] in [[a, b], [b, c], [c, a]] {
                        let edge = [p.min(q), p.max(q)];
                        open.extend(on_edge[&edge].iter().filter(|k| holds(&edge) && left.remove(k)));
                    }
                }
            }
            parts
        };
        let all: Vec<usize> = (0..triangles.len()).collect();
        let mut around: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (k, triangle) in triangles.iter().enumerate() {
            triangle.iter().for_each(|&v| around.entry(v).or_default().push(k));
        }
        let pinched = around.iter().filter(|(v, own)| flood(own, &|edge| edge.contains(v)) > 1).count();
        let place = |v: u32| sample.particles().place(v as usize);
        Self {
            components: flood(&all, &|_| true),
            euler: vertices.len() as i64 - on_edge.len() as i64 + triangles.len() as i64,
            open: on_edge.values().filter(|of_edge| of_edge.len() == 1).count(),
            faults: pinched + on_edge.values().filter(|of_edge| of_edge.len() > 2).count(),
            volume: triangles.iter().map(|t| t.map(place)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum(),
        }
    }
}

/// The sample of a formula that may be read.
#[track_caller]
fn sampled(formula: &str, settings: &Settings) -> Sample {
    let field = Formula::parse(formula).unwrap_or_else(|error| panic!("{formula}: {error}"));
    sample(field, settings).unwrap_or_else(|error| panic!("{formula}: {error}"))
}

/// Coordinates along random perpendicular axes, as formulas.
fn turned(random: &mut Pcg32) -> [String; 3] {
    let [a, b] = [0, 1].map(|_| between(random, 0.1, 1.4));
    let ((sin_a, cos_a), (sin_b, cos_b)) = (libm::sincos(a), libm::sincos(b));
    [
        format!("({cos_a}x+{sin_a}y)"),
        format!("({cos_b}({cos_a}y-{sin_a}x)+{sin_b}z)"),
        format!("({cos_b}z-{sin_b}({cos_a}y-{sin_a}x))"),
    ]
}

/// A surface of one component that a face of the box, or the cap of a solid, cuts at right angles,
/// so that its rim is a geodesic: three neighbours in a row there are in line.
fn cut_at_right_angles(random: &mut Pcg32) -> (String, Option<Bounds>) {
    let mut axes = ["x", "y", "z"];
    axes.rotate_left(below(random, 3));
    let (r, h) = (between(random, 0.4, 1.2), between(random, 1.5, 3.0));
    let half = |axis: &str| {
        let (mut min, mut max) = ([-h; 3], [h; 3]);
        match axis {
            "x" => min[0] = 0.0,
            "y" => max[1] = 0.0,
            _ => min[2] = 0.0,
        }
        Bounds { min, max }
    };
    let [u, v, w] = axes;
    match below(random, 7) {
        0 => (format!("{u}^2+{v}^2={}", r * r), Some(Bounds::cube(h))),
        1 => (format!("{w}={r}*{u}*{v}"), Some(Bounds::cube(h))),
        2 => (format!("{w}=sin({u})"), Some(Bounds::cube(h))),
        3 => (format!("{u}^2+{v}^2+{w}^2={}", r * r), Some(half(u))),
        4 => (format!("(hypot({u},{v})-1)^2+{w}^2=0.16"), Some(half(u))),
        5 => (format!("max(hypot({u},{v})-{r},abs({w})-{h})"), None),
        _ => {
            let [u, v, w] = turned(random);
            (format!("max(hypot({u},{v})-{r},abs({w})-{h})"), None)
        }
    }
}

#[test]
fn where_a_surface_is_cut_at_right_angles_no_particle_loses_its_neighbours() {
    for seed in cases::seeds(60) {
        let mut random = Pcg32::seed_from_u64(seed);
        let (formula, bounds) = cut_at_right_angles(&mut random);
        let mut settings = Settings::with_count(600 + below(&mut random, 900) as u32).seeded(seed);
        settings.bounds = bounds;
        if below(&mut random, 2) == 0 {
            settings = settings.refined();
        }
        let sample = sampled(&formula, &settings);
        let told = format!("{formula} in {bounds:?}, {} particles, seed {seed}", settings.count);
        let lonely = sample.measured().valence.iter().filter(|&&valence| valence == 0).count();
        assert_eq!(lonely, 0, "{told}");
        let figures = sample.report().measures.quality.expect("measured").connectivity;
        let counted = Counted::of(&sample);
        assert_eq!((figures.components, counted.components), (1, 1), "{told}: {counted:?}");
        assert_eq!(counted.faults, 0, "{told}: {counted:?}");
        let is_bad = |warning: &&Warning| warning.severity() == Severity::Fault;
        let warnings = [sample.report().warnings.clone(), sample.mesh_warnings()].concat();
        assert_eq!(warnings.iter().find(is_bad), None, "{told}");
    }
}

#[test]
fn bodies_that_touch_in_a_point_or_a_line_are_two() {
    for seed in cases::seeds(20) {
        let mut random = Pcg32::seed_from_u64(seed);
        let mut axes = ["x", "y", "z"];
        axes.rotate_left(below(&mut random, 3));
        let [u, v, w] = axes;
        let [r, s] = [0, 1].map(|_| between(&mut random, 0.6, 1.2));
        // Both begin at the plane u = 0; a cap cuts them.
        let (formula, volume) = match below(&mut random, 2) {
            0 => (
                format!("max(min(hypot({u}+{r},{v})-{r},hypot({u}-{s},{v})-{s}),abs({w})-1)"),
                2.0 * core::f64::consts::PI * (r * r + s * s),
            ),
            _ => (
                format!("max(min(hypot({u}+{r},{v},{w})-{r},hypot({u}-{s},{v},{w})-{s}),-{w})"),
                2.0 / 3.0 * core::f64::consts::PI * (r.powi(3) + s.powi(3)),
            ),
        };
        let sample = sampled(&formula, &Settings::with_count(2_500).seeded(seed).refined());
        let counted = Counted::of(&sample);
        let figures = sample.report().measures.quality.expect("measured").connectivity;
        assert_eq!((counted.components, counted.euler), (2, 4), "{formula}: {counted:?}");
        assert_eq!((counted.open, counted.faults), (0, 0), "{formula}: {counted:?}");
        assert_eq!((figures.components, figures.euler), (2, 4), "{formula}");
        assert!((counted.volume / volume - 1.0).abs() < 0.02, "{formula}: {counted:?}, not {volume}");
    }
}

/// Spheres around the points of a lattice that reach into each other's cells, by rounded
/// coordinates, so that nobody knows the edges where they meet.
#[test]
fn a_mesh_is_closed_only_where_it_is_the_solid() {
    let mut closed = 0;
    for seed in cases::seeds(20) {
        let mut random = Pcg32::seed_from_u64(seed);
        let r = between(&mut random, 0.3, 0.8);
        let cells = 1 + below(&mut random, 2);
        let cell = |axis: &str, most: usize| format!("{axis}-clamp(round({axis}),0,{most})");
        let [x, y, z] =
            [("x", 1), ("y", cells), ("z", below(&mut random, 2))].map(|(axis, most)| cell(axis, most));
        let formula = format!("hypot({x},{y},{z})-{r}");
        let method = if below(&mut random, 2) == 0 { Method::Front } else { Method::Refined };
        let settings = settings!(method, seed; ..Settings::with_count(1_500));
        let sample = sampled(&formula, &settings);
        let counted = Counted::of(&sample);
        for p in (0..sample.particles().len()).map(|row| sample.particles().place(row)) {
            let off = |c: f64, most: f64| c - c.round().clamp(0.0, most);
            let most = |text: &str| {
                if text.ends_with(",0)") {
                    0.0
                } else if text.ends_with(",1)") {
                    1.0
                } else {
                    2.0
                }
            };
            let f = glam::dvec3(off(p.x, most(&x)), off(p.y, most(&y)), off(p.z, most(&z))).length() - r;
            assert!(f.abs() < 1e-3, "{formula}, {method:?}: f = {f} at {p}");
        }
        if counted.open > 0 || counted.faults > 0 {
            continue;
        }
        closed += 1;
        // Balls that do not meet, or chains of them without a ring.
        let [nx, ny, nz] = [2, cells + 1, if z.ends_with(",1)") { 2 } else { 1 }];
        let balls = (nx * ny * nz) as i64;
        let contacts = ((nx - 1) * ny * nz + nx * (ny - 1) * nz + nx * ny * (nz - 1)) as i64;
        let wanted = if r <= 0.5 { 2 * balls } else { 2 * balls - 2 * contacts };
        // The opening between four balls has the radius √½ − r. Particles may close one that is
        // narrower than they are; beyond √½ there is none, and contacts do not count any more.
        if core::f64::consts::FRAC_1_SQRT_2 - r > sample.report().sizes.radius {
            assert_eq!(counted.euler, wanted, "{formula}, {method:?}: {counted:?}");
        }
    }
    assert!(closed > 0, "no mesh was closed");
}

#[test]
fn a_body_with_a_few_holes_in_its_mesh_faces_outward() {
    // Spikes that are too thin for the particles stay open.
    for (power, level) in [(2, 2000), (2, 4000)] {
        let formula = format!("10-(x^2+y^2+z^2-2)^3-{level}(x^{power}*y^2+x^2*z^2+y^2*z^2)");
        let sample = sampled(&formula, &Settings::with_count(2_000));
        let counted = Counted::of(&sample);
        assert!(counted.volume > 0.0, "{formula}: {counted:?}");
        assert!(
            sample.report().warnings.iter().any(|warning| matches!(warning, Warning::LargerInside(_))),
            "{formula}: {:?}",
            sample.report().warnings
        );
    }
}

#[test]
fn no_gap_is_told_of_a_mesh_that_is_closed() {
    let mut gaps = 0;
    for seed in cases::seeds(8) {
        let mut random = Pcg32::seed_from_u64(seed);
        // Rims that bend more than the particles can follow.
        let (width, level) = (between(&mut random, 1.2, 2.0), between(&mut random, 0.04, 0.12));
        let (p, q) = (format!("x*x+(y/{width})^2-1"), format!("(x/{width})^2+y*y-1"));
        let formula = format!("(({p})*({q}))^2+z*z/2={level}");
        let sample = sampled(&formula, &Settings::with_count(3_000).seeded(seed).refined());
        let counted = Counted::of(&sample);
        let warnings = [sample.report().warnings.clone(), sample.mesh_warnings()].concat();
        let told = warnings.iter().find(|warning| warning.severity() == Severity::Fault);
        gaps += usize::from(counted.open > 0);
        if counted.open == 0 && counted.faults == 0 {
            assert_eq!(told, None, "{formula}: {counted:?}");
            let figures = sample.report().measures.quality.expect("measured").connectivity;
            assert_eq!((figures.components, figures.euler), (counted.components, counted.euler), "{formula}");
        } else {
            assert!(told.is_some(), "{formula}: {counted:?} without a word");
        }
    }
    assert!(gaps < 8, "no mesh was closed");
}

/// Value noise: random numbers at the points of a lattice, blended smoothly in its cells.
fn value_noise(random: &mut Pcg32) -> String {
    let scale = between(random, 2.0, 4.0);
    let [a, b, c] = [0, 1, 2].map(|_| between(random, 10.0, 90.0));
    let hash = |corner: [usize; 3]| {
        let [i, j, k] =
            [0, 1, 2].map(|axis| format!("floor({scale}{})+{}", ["x", "y", "z"][axis], corner[axis]));
        format!("fract(sin(({i})*{a}+({j})*{b}+({k})*{c})*43758.5453)")
    };
    let blend = ["x", "y", "z"].map(|axis| {
        let t = format!("fract({scale}{axis})");
        format!("({t}^2*(3-2*{t}))")
    });
    let [u, v, w] = &blend;
    let along_x = |j, k| format!("mix({},{},{u})", hash([0, j, k]), hash([1, j, k]));
    let along_y = |k| format!("mix({},{},{v})", along_x(0, k), along_x(1, k));
    format!("mix({},{},{w})", along_y(0), along_y(1))
}

#[test]
fn a_planet_of_value_noise_has_no_edge() {
    for seed in cases::seeds(20) {
        let mut random = Pcg32::seed_from_u64(seed);
        let noise = value_noise(&mut random);
        let formula = format!("hypot(x,y,z)-1-{}*({noise})", between(&mut random, 0.05, 0.2));
        let sample = sampled(&formula, &Settings::with_count(2_000).seeded(seed).refined());
        assert_eq!(sample.report().proof.creases, None, "seed {seed}: {formula}");
        let Counted { components, euler, open, faults, .. } = Counted::of(&sample);
        // Some bend too much for particles of this size, which is said, and are open in places.
        let is_refined = sample.report().growth.refined_levels.is_some();
        let wanted = if is_refined { (1, 2, 0, 0) } else { (1, euler, open, 0) };
        assert_eq!((components, euler, open, faults), wanted, "seed {seed}: {formula}");
    }
}
