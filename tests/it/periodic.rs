//! Unit cells: opposite faces of the box are the same bit for bit but for the shift, and copies of
//! the mesh join across them.

use glam::DVec3;
use marching_particles::Bounds;
use marching_particles::field::formula::Formula;
use marching_particles::internal::extent;
use marching_particles::mesh::Topology;
use marching_particles::{Field, Method, Report, Run, Sample, Settings};
use std::collections::BTreeSet;

const GYROID: &str = "sin(x)cos(y) + sin(y)cos(z) + sin(z)cos(x)";
const SCHWARZ_P: &str = "cos(x) + cos(y) + cos(z)";
const SCHWARZ_D: &str = "cos(x)cos(y)cos(z) - sin(x)sin(y)sin(z)";

fn formula(text: &str) -> Formula {
    Formula::parse(text).unwrap_or_else(|error| panic!("{text}: {error:?}"))
}

/// The box of one period that the command line takes.
fn one_period(field: &mut Formula) -> Bounds {
    let periods = field.surface_periods();
    extent::unit_cell(field, periods, &Bounds::cube(4.0))
}

fn sampled(field: Formula, count: u32, method: Method) -> Sample {
    let mut settings = Settings::with_count(count);
    settings.method = method;
    let mut run = Run::start(field, &settings).expect("the settings are valid");
    while run.step(u32::MAX).stop_reason.is_none() {}
    run.finish().expect("there is a surface")
}

/// The topology of the surface without the faces across these axes, once it is joined to itself
/// there.
fn glued(sample: &Sample) -> Topology {
    let particles = sample.particles();
    let is_face = |row: u32| {
        let patch = particles.patch[row as usize];
        particles.opposite.iter().any(|faces| faces.patches.contains(&patch))
    };
    let mesh = sample.mesh().corners();
    let triangles: Vec<[u32; 3]> = (mesh.iter().filter(|triangle| !is_face(triangle[0])))
        .map(|triangle| triangle.map(|row| particles.periodic[row as usize]))
        .collect();
    Topology::new(&triangles, particles.len())
}

/// Checks that opposite faces have the same rows and triangles, and returns the number of pairs of
/// particles.
fn check_faces(sample: &Sample, bounds: &Bounds, axes: &[u8], what: &str) -> usize {
    let particles = sample.particles();
    let own: Vec<u8> = particles.opposite.iter().map(|faces| faces.axis).collect();
    assert_eq!(own, axes, "{what}");
    let mut pairs = 0;
    for faces in &particles.opposite {
        let axis = usize::from(faces.axis);
        let tangential = |row: u32| {
            let mut bits = particles.local[row as usize].to_array().map(f32::to_bits);
            bits[axis] = 0;
            bits
        };
        let mut sides = [BTreeSet::new(), BTreeSet::new()];
        for rows in &faces.rows {
            assert_eq!(tangential(rows[0]), tangential(rows[1]), "{what}, axis {axis}, rows {rows:?}");
            assert_eq!(particles.radius[rows[0] as usize], particles.radius[rows[1] as usize], "{what}");
            let [master, image] = rows.map(|row| particles.periodic[row as usize]);
            assert_eq!(master, image, "{what}");
            let at = [bounds.lo()[axis], bounds.hi()[axis]];
            for (side, (&row, at)) in rows.iter().zip(at).enumerate() {
                assert_eq!(particles.local[row as usize][axis], at as f32, "{what}");
                assert_eq!(particles.patch[row as usize], faces.patches[side], "{what}");
                sides[side].insert(row);
            }
        }
        for (side, rows) in sides.iter().enumerate() {
            let of_patch = (0..particles.len() as u32)
                .filter(|&row| particles.patch[row as usize] == faces.patches[side])
                .count();
            assert_eq!(rows.len(), of_patch, "{what}: every row of a face has its image");
        }
        let key = |triangle: &[u32; 3]| {
            let mut corners = triangle.map(tangential);
            corners.sort_unstable();
            corners
        };
        let [lower, upper] = faces.patches.map(|patch| {
            let is_on = |triangle: &&[u32; 3]| particles.patch[triangle[0] as usize] == patch;
            sample.mesh().corners().iter().filter(is_on).map(key).collect::<BTreeSet<_>>()
        });
        assert!(!lower.is_empty() && lower == upper, "{what}: the triangles of both faces are the same");
        pairs += faces.rows.len();
    }
    assert_eq!(sample.report().pairs, Some(pairs), "{what}");
    pairs
}

/// Checks that the mesh is closed, and nothing is warned of the faces.
fn check_mesh(sample: &Sample, what: &str) {
    let Report { warnings, .. } = sample.report();
    assert!(warnings.is_empty(), "{what}: {warnings:?}");
    assert!(sample.mesh().topology.is_closed() && sample.mesh_warnings().is_empty(), "{what}");
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn unit_cells_have_the_same_opposite_faces_and_join_across_them() {
    // Of genus 3 in the cell that repeats (Schwarz; Schoen 1970), of which the box of 2π holds two,
    // one and four.
    for (text, euler) in [(GYROID, -8), (SCHWARZ_P, -4), (SCHWARZ_D, -16)] {
        let bounds = one_period(&mut formula(text));
        for (count, method) in [(1500, Method::Front), (4000, Method::Front), (4000, Method::Refined)] {
            let what = format!("{text}, {count} particles, {method:?}");
            let sample = sampled(formula(text).repeated_in(&bounds), count, method);
            check_mesh(&sample, &what);
            let pairs = check_faces(&sample, &bounds, &[0, 1, 2], &what);
            assert!(pairs > count as usize / 8, "{what}: {pairs} pairs");
            assert_eq!(sample.report().growth.refined_levels.is_some(), method == Method::Refined, "{what}");
            let joined = glued(&sample);
            assert!(joined.is_closed(), "{what}: copies of the mesh join");
            assert_eq!((joined.components.len(), joined.euler()), (1, euler), "{what}");
            // The surface and its complement are the same but for a motion.
            let half = 0.5 * bounds.size().element_product();
            let volume = sample.volume().expect("the mesh is closed");
            assert!((volume / half - 1.0).abs() < 0.01, "{what}: {volume} of {half}");
        }
    }
}

#[test]
fn shells_and_solids_with_creases_of_their_own_repeat() {
    // A wall has two sides. The cubes are around the corners of the box, which its faces cut, and
    // the hollows within it.
    let cell = Bounds::cube(core::f64::consts::PI);
    for (field, euler, what) in [
        (formula(GYROID).thickened(0.6), -16, "a gyroid's wall"),
        (formula("max(cos(x), cos(y), cos(z)) - 0.3"), 2, "cubes"),
        (formula("min(cos(x), cos(y), cos(z)) - 0.3"), 2, "hollow cubes"),
    ] {
        for method in [Method::Front, Method::Refined] {
            let sample = sampled(field.clone().repeated_in(&cell), 6000, method);
            check_faces(&sample, &cell, &[0, 1, 2], what);
            assert!(sample.mesh().topology.is_closed(), "{what}");
            let joined = glued(&sample);
            assert!(joined.is_closed(), "{what}");
            assert_eq!(joined.euler(), euler, "{what}");
        }
    }
}

#[test]
fn faces_repeat_along_the_axes_on_which_the_box_is_whole() {
    let size = DVec3::new(4.0 * core::f64::consts::PI, 3.0, 2.0 * core::f64::consts::PI);
    let middle = DVec3::new(0.3, 0.4, 0.5);
    let bounds = Bounds::new(middle - 0.5 * size, middle + 0.5 * size);
    let field = formula(GYROID).repeated_in(&bounds);
    assert_eq!(field.facts().unit_cell.expect("a cell").repeats, [true, false, true]);
    let sample = sampled(field, 3000, Method::Front);
    check_faces(&sample, &bounds, &[0, 2], "a box of two periods");
    let told = sample.report().warnings.iter().map(ToString::to_string).collect::<Vec<_>>();
    assert!(told.len() == 1 && told[0].contains("across y are closed, but not the same"), "{told:?}");
    // Seven digits of a period are enough, four are not.
    for (periods, is_whole) in [(1.0 + 1e-7, true), (2.0 - 1e-7, true), (0.9995, false), (0.5, false)] {
        let half = periods * core::f64::consts::PI;
        let cell = formula(GYROID).repeated_in(&Bounds::cube(half)).facts().unit_cell.expect("a cell");
        assert_eq!(cell.repeats, [is_whole; 3], "{periods} periods");
    }
    assert_eq!(formula(GYROID).closed_by(&bounds).facts().unit_cell, None);
}

#[test]
fn relaxing_further_keeps_opposite_faces_the_same() {
    let bounds = one_period(&mut formula(SCHWARZ_P));
    let mut run = Run::start(formula(SCHWARZ_P).repeated_in(&bounds), &Settings::with_count(2000))
        .expect("the settings are valid");
    for _ in 0..2 {
        while run.step(5000).stop_reason.is_none() {}
        assert!(run.relax(3));
    }
    while run.step(5000).stop_reason.is_none() {}
    let sample = run.finish().expect("there is a surface");
    check_mesh(&sample, "relaxed further");
    check_faces(&sample, &bounds, &[0, 1, 2], "relaxed further");
}
