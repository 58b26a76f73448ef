//! Meshes of surfaces with creases: closed over all patches, with the creases as edges.

use crate::creased::{Creased, cuboid, drilled_cube, prism, two_spheres};
use glam::DVec3;
use marching_particles::mesh::Topology;
use marching_particles::mesh::triangulation::{Triangulation, triangulate};
use marching_particles::particles::Particles;
use marching_particles::{Bounds, Formula, Settings, sample};

/// The mesh of a closed surface, held to what is promised: one closed manifold of this Euler number
/// and about this area, with every segment of a crease as an edge between two patches.
#[track_caller]
fn assert_closed(name: &str, solid: &Creased, euler: i64, flatness: f64) {
    let particles = solid.particles();
    let mesh = triangulate(&particles, None);
    let told = format!("{name}, {} particles", particles.count());
    assert!(mesh.left_out.is_empty() && mesh.unfilled.is_empty(), "{told}: {mesh:?}");
    assert!(mesh.topology.is_closed(), "{told}: {:?}", mesh.topology.borders);
    assert_eq!(
        Topology::new(&mesh.triangles, particles.len()),
        mesh.topology,
        "{told}: the buffers are joined"
    );
    assert_eq!((mesh.topology.components.len(), mesh.topology.euler()), (1, euler), "{told}");
    let area = area(&particles, &mesh);
    assert!((area / solid.area - 1.0).abs() <= flatness, "{told}: area {area} instead of {}", solid.area);
    for triangle in mesh.corners() {
        let [p, q, r] = triangle.map(|row| particles.place(row as usize));
        let normal = (q - p).cross(r - p);
        for row in triangle.map(|row| row as usize) {
            assert!(normal.dot(particles.normal[row].as_dvec3()) > 0.0, "{told}: {triangle:?} faces inward");
            assert_eq!(particles.patch[row], particles.patch[triangle[0] as usize], "{told}");
        }
    }
    for &[a, b] in &particles.segments {
        let sides = mesh.corners().iter().filter(|triangle| {
            let first = triangle.map(|row| particles.first_row(row as usize) as u32);
            first.contains(&a) && first.contains(&b)
        });
        let patches: Vec<u32> = sides.map(|triangle| particles.patch[triangle[0] as usize]).collect();
        assert!(patches.len() == 2 && patches[0] != patches[1], "{told}: patches {patches:?} at a segment");
    }
}

fn area(particles: &Particles, mesh: &Triangulation) -> f64 {
    let of = |triangle: &[u32; 3]| {
        let [p, q, r]: [DVec3; 3] = triangle.map(|row| particles.place(row as usize));
        0.5 * (q - p).cross(r - p).length()
    };
    mesh.triangles.iter().map(of).sum()
}

#[test]
fn a_box_is_closed_with_its_edges() {
    for spacing in [0.8, 0.31, 0.1] {
        assert_closed("cube", &cuboid([1.0; 3], spacing), 2, 1e-6);
        assert_closed("box", &cuboid([2.0, 0.7, 0.33], spacing), 2, 1e-6);
    }
    // Thinner than the spacing.
    assert_closed("plate", &cuboid([2.0, 1.5, 0.02], 0.1), 2, 1e-6);
}

#[test]
fn no_chord_between_creases_is_of_two_patches() {
    // Faces of the box that the surface nearly touches: three particles that follow each other
    // there are a triangle of either.
    let quarter = core::f64::consts::FRAC_PI_4;
    let gyroid = Bounds { min: [-3.0 * quarter; 3], max: [5.0 * quarter; 3] };
    let sheets = Bounds { min: [0.1623, -0.6704, -1.5473], max: [3.5162, 1.6861, 1.5419] };
    for (text, bounds, count) in [
        ("sin(x)cos(y) + sin(y)cos(z) + sin(z)cos(x)", gyroid, 2900),
        ("sin(2x) + cos(3y)sin(z) = z/2", sheets, 2500),
    ] {
        let solid = Formula::parse(text).expect("a formula").closed_by(&bounds);
        let sample = sample(solid, &Settings::with_count(count)).expect("there is a surface");
        let topology = &sample.mesh().topology;
        assert!(topology.encloses(), "{text}: {:?} {:?}", topology.crowded_edges, topology.borders);
        assert!(sample.volume().is_some_and(|volume| volume > 0.0), "{text}");
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn bodies_that_share_a_plane_have_no_wall_between_them() {
    // A small cube in the middle of a face, one that covers the face, and one that covers a part of
    // it.
    for (other, area, volume) in [
        ("max(abs(x-1.5),abs(y),abs(z))-0.5", 28.0, 9.0),
        ("max(abs(x-2),abs(y),abs(z))-1", 40.0, 16.0),
        ("max(abs(x-2),abs(y-0.5),abs(z-0.5))-1", 43.5, 16.0),
    ] {
        let text = format!("min(max(abs(x),abs(y),abs(z))-1,{other})");
        for count in [800, 3000] {
            let solid = Formula::parse(&text).expect("a formula");
            let sample = sample(solid, &Settings::with_count(count)).expect("there is a surface");
            let (mesh, told) = (sample.mesh(), format!("{text}, {count} particles"));
            assert!(mesh.topology.is_closed() && mesh.left_out.is_empty(), "{told}: {:?}", mesh.topology);
            assert_eq!((mesh.topology.components.len(), mesh.topology.euler()), (1, 2), "{told}");
            let found = self::area(sample.particles(), mesh);
            assert!((found / area - 1.0).abs() < 1e-3, "{told}: area {found} instead of {area}");
            let found = sample.volume().expect("a closed mesh");
            assert!((found / volume - 1.0).abs() < 1e-3, "{told}: volume {found} instead of {volume}");
        }
    }
}

#[test]
fn a_strip_beside_a_larger_part_of_its_patch_is_filled() {
    // Its only particles are those of its creases, and the nearest others of the patch lie beyond a
    // slot.
    let comb =
        [[0.0, 0.0], [1.16, 0.0], [1.16, 1.0], [1.07, 1.0], [1.07, 0.5], [1.0, 0.5], [1.0, 1.0], [0.0, 1.0]];
    assert_closed("comb", &prism(&[&comb], 0.9, 0.1), 2, 1e-6);
}

#[test]
fn no_triangle_spans_the_outside_of_a_patch() {
    for spacing in [0.5, 0.17, 0.06] {
        let ell = [[0.0, 0.0], [2.0, 0.0], [2.0, 0.6], [0.7, 0.6], [0.7, 1.8], [0.0, 1.8]];
        assert_closed("L", &prism(&[&ell], 0.9, spacing), 2, 1e-6);
        // The ends of both arms lie in one plane, nearer to each other than the particles are.
        let slot = [
            [0.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [1.04, 1.0],
            [1.04, 0.3],
            [1.0, 0.3],
            [1.0, 1.0],
            [0.0, 1.0],
        ];
        assert_closed("slot", &prism(&[&slot], 0.5, spacing), 2, 1e-6);
        let outside = [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [0.0, 2.0]];
        let hole = [[1.0, 1.0], [1.0, 1.5], [1.5, 1.5], [1.5, 1.0]];
        assert_closed("frame", &prism(&[&outside, &hole], 0.4, spacing), 0, 1e-6);
    }
}

#[test]
fn a_sharp_wedge_is_closed() {
    for spacing in [0.3, 0.1, 0.05] {
        let (sine, cosine) = libm::sincos(10.0_f64.to_radians());
        assert_closed("wedge", &prism(&[&[[0.0, 0.0], [1.0, 0.0], [cosine, sine]]], 1.0, spacing), 2, 1e-6);
    }
}

#[test]
fn curved_patches_meet_at_their_crease() {
    for spacing in [0.4, 0.15] {
        assert_closed("two spheres", &two_spheres(spacing), 2, 0.2 * spacing);
        assert_closed("drilled cube", &drilled_cube(0.5, spacing), 0, 0.2 * spacing);
    }
    // Fewer edges around the hole than a hole that would be filled.
    assert_closed("pierced cube", &drilled_cube(0.1, 0.1), 0, 0.02);
}

/// Which branch gives f does not depend on how steep its formula is, up to a million times as steep
/// as another one.
#[test]
fn branches_of_very_different_slopes_meet_in_a_crease() {
    for steep in ["1", "1000", "100000"] {
        for (text, creases) in [
            ("max(K*(z + 0.2*x*x - 0.1), x^2 + y^2 + z^2 - 1)", 1),
            ("max(x^2 + y^2 + z^2 - 1, K*(x + y + z - 0.3), y - 0.2)", 3),
            ("min(K*((x - 1)^2 + y^2 + z^2 - 0.5), x^2 + y^2 + z^2 - 1)", 1),
        ] {
            let text = text.replace('K', steep);
            let field = Formula::parse(&text).expect("a formula");
            let sample = sample(field, &Settings::with_count(2_000)).expect("a sample");
            assert_eq!(sample.report().proof.creases, Some(creases), "{text}");
            assert!(sample.mesh().topology.is_closed(), "{text}");
        }
    }
}
