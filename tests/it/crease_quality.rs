//! Figures of particles on surfaces with creases: neighbours are those of one patch, and the
//! patches are one surface.

use crate::creased::{Creased, cuboid, drilled_cube, prism, two_spheres};
use glam::{DVec3, Vec3};
use marching_particles::particles::Particles;
use marching_particles::quality::{MeasureOptions, Measurements, measure};

fn measured(particles: &Particles, solid: Creased) -> Measurements {
    let options = MeasureOptions { rows: Some(particles), ..MeasureOptions::default() };
    measure(&particles.local, &particles.normal, &solid.field(), None, &options)
}

/// The figures of a closed surface of patches, held to what is known of it.
#[track_caller]
fn figures(name: &str, solid: Creased, euler: i64, flatness: f64) -> Measurements {
    let (particles, known) = (solid.particles(), solid.area);
    let measured = measured(&particles, solid);
    let figures = measured.figures;
    let told = format!("{name}, {} particles: {figures:?}", particles.count());
    let connectivity = figures.connectivity;
    assert_eq!((connectivity.components, connectivity.euler), (1, euler), "{told}");
    assert_eq!(connectivity.triangle_share, 1.0, "{told}");
    assert_eq!((figures.duplicates, figures.not_finite, figures.boundary_excluded), (0, 0, 0), "{told}");
    assert!((figures.area / known - 1.0).abs() < flatness, "{told}");
    assert!(figures.accuracy.error_max < 1e-5 && figures.accuracy.normal_error_max < 0.01, "{told}");
    let spacing = (2.0 * figures.area / (3.0_f64.sqrt() * particles.count() as f64)).sqrt();
    assert!((figures.ideal_spacing / spacing - 1.0).abs() < 1e-12, "{told}");
    // No edge leads across a hole of a patch.
    assert!(figures.edges.edge_variation < 0.4, "{told}");
    // The nearest of all particles, of whatever patch.
    let once: Vec<usize> = (0..particles.len()).filter(|&i| particles.first_row(i) == i).collect();
    for i in 0..particles.len() {
        let others = once.iter().filter(|&&j| j != particles.first_row(i));
        let distance = |&j: &usize| particles.local[i].distance(particles.local[j]);
        let nearest = others.map(distance).fold(f32::INFINITY, f32::min);
        assert!(
            (measured.nearest[i] - nearest).abs() < 1e-6,
            "{told}: {} not {nearest}",
            measured.nearest[i]
        );
    }
    let counted: u32 = measured.histogram.bins.iter().sum();
    assert_eq!(counted as usize, particles.count(), "{told}");
    assert!(measured.component.iter().all(|&component| component == 0), "{told}");
    measured
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn edges_of_a_solid_are_no_defects() {
    for (name, solid) in [("cube", cuboid([1.0; 3], 0.07)), ("plate", cuboid([2.0, 1.5, 0.03], 0.05))] {
        let figures = figures(name, solid, 2, 1e-5).figures;
        // The lattice has six neighbours but beside the edges, and its holes there are less than a
        // particle wide.
        assert!(figures.order.six_neighbours > 0.6 && figures.order.open == 0, "{name}: {figures:?}");
        assert!(figures.coverage.cover < 1.6, "{name}: {figures:?}");
    }
    let ell = [[0.0, 0.0], [2.0, 0.0], [2.0, 0.6], [0.7, 0.6], [0.7, 1.8], [0.0, 1.8]];
    figures("L", prism(&[&ell], 0.9, 0.09), 2, 1e-5);
    let (sine, cosine) = libm::sincos(10.0_f64.to_radians());
    figures("wedge", prism(&[&[[0.0, 0.0], [1.0, 0.0], [cosine, sine]]], 1.0, 0.06), 2, 1e-5);
    figures("two spheres", two_spheres(0.1), 2, 0.02);
    figures("drilled cube", drilled_cube(0.5, 0.1), 0, 0.02);
}

#[test]
fn a_hole_beside_an_edge_is_found_where_it_is() {
    let mut solid = cuboid([1.0; 3], 0.07);
    let whole = measured(&solid.particles(), cuboid([1.0; 3], 0.07)).figures;
    // The middle of a disc that touches the edge from the top.
    let middle = Vec3::new(0.5, 0.15, 1.0);
    solid.inner.retain(|(_, p)| p.as_vec3().distance(middle) > 0.15);
    let particles = solid.particles();
    let found = measured(&particles, solid);
    assert_eq!((found.figures.connectivity.components, found.figures.connectivity.euler), (1, 2));
    assert!(found.figures.coverage.cover > 2.0 * whole.coverage.cover, "{:?}", found.figures.coverage);
    let hole = found.places.holes[0];
    assert!(Vec3::from(hole.position).distance(middle) < 0.05, "{hole:?}");
    assert!((hole.radius / 0.15 - 1.0).abs() < 0.3, "{hole:?}");
}

#[test]
fn pairs_at_an_edge_are_crowded_and_counted_once() {
    // Two particles near each other, on either side of the edge between the front and the top.
    let [on_front, on_top] = [DVec3::new(0.55, 0.0, 0.97), DVec3::new(0.55, 0.03, 1.0)];
    let mut solid = cuboid([1.0; 3], 0.1);
    let front = (solid.nearest)(DVec3::new(0.5, 0.0, 0.5));
    let top = (solid.nearest)(DVec3::new(0.5, 0.5, 1.0));
    solid.inner.retain(|(_, p)| p.distance(DVec3::new(0.55, 0.0, 1.0)) > 0.1);
    solid.inner.extend([(front, on_front), (top, on_top)]);
    let particles = solid.particles();
    let pairs = measured(&particles, solid).places.pairs;
    let last = particles.len() as u32 - 1;
    assert_eq!(pairs[0].particles, [last - 1, last], "{pairs:?}");
    // Each is also near two particles on the edge, and each of these has two rows.
    let near: Vec<[u32; 2]> =
        pairs.iter().map(|pair| pair.particles).filter(|pair| pair[1] + 1 >= last).collect();
    assert_eq!(near.len(), 5, "{pairs:?}");
    assert!(
        pairs.iter().all(|pair| pair.particles.iter().all(|&i| particles.first_row(i as usize) as u32 == i))
    );
}
