//! Triangle meshes, sampled anew. The oracles are exact solids and distances from all triangles.

use crate::remesh_shapes::{
    Shape, bracket, check, cuboid, distance, drilled, fan, field_of, joined, moved, off_shape, off_torus,
    prism, regular, remeshed, solid_of, torus, turned,
};
use core::f64::consts::PI;
use glam::{DVec2, DVec3, dvec3};
use marching_particles::export::Vertices;
use marching_particles::field::{Field, Frame};
use marching_particles::remesh::{MAX_TRIANGLES, MeshEdges, MeshError, MeshField, MeshKind, MeshOptions};
use marching_particles::sampler::Search;
use marching_particles::{Formula, Sample, Settings, TriangleMesh, difference, offset, sample};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

#[test]
fn parts_with_planes_keep_every_edge_and_stay_where_they_are() {
    let hollow = joined(
        cuboid([2.0, 1.5, 1.0]),
        &turned(&moved(&cuboid([1.9, 1.4, 0.9]), |p| p + DVec3::splat(0.05))),
    );
    let shapes = [
        ("box", cuboid([1.0, 2.0, 3.0]), 2, 12, 6.0),
        ("bracket", bracket(), 2, 18, 1.75),
        ("hexagonal prism", regular(6), 2, 18, 3.0 * 3.0_f64.sqrt()),
        ("thin-walled box", hollow, 4, 24, 3.0 - 1.9 * 1.4 * 0.9),
    ];
    for (what, shape, euler, creases, volume) in shapes {
        let (field, made) = remeshed(&shape, 3_000, what);
        check(&made, (euler, creases, volume), 1e-6, what);
        assert!((made.particles().count() as f64 / 3_000.0 - 1.0).abs() < 0.03, "{what}");
        let new = made.buffers(Vertices::Joined);
        let most = new.positions.iter().map(|&p| off_shape(p, &shape)).fold(0.0, f64::max);
        assert!(most < 1e-6, "{what}: {most}");
        let change = field.compare(&new.positions, &new.triangles);
        assert!(change.edges.is_some_and(|edges| edges < 1e-6), "{what}: {change:?}");
        assert!(change.to_new.largest < 1e-6 && change.to_old.largest < 1e-6, "{what}: {change:?}");
        let obtuse = made.report().measures.quality.as_ref().map(|quality| quality.angles.triangles_above_90);
        assert!(obtuse.is_none_or(|share| share < 0.01), "{what}: {obtuse:?}");
    }
}

#[test]
fn drilled_block_keeps_its_edges_and_its_hole_is_round() {
    let shape = drilled(64);
    let (field, made) = remeshed(&shape, 6_000, "drilled block");
    check(&made, (0, 14, 4.0 - 0.16 * PI), 1e-3, "drilled block");
    let MeshKind::Parts { patches: 7, corners: 8, faded: 0, .. } = field.kind() else {
        panic!("{:?}", field.kind())
    };
    // The sides of the hole have an arc of 0.0005 over their chords.
    let inner = made.buffers(Vertices::Joined).positions.into_iter();
    let inner = inner.map(|p| p.truncate().length()).filter(|&radius| radius < 0.41);
    let off: Vec<f64> = inner.map(|radius| (radius - 0.4).abs()).collect();
    assert!(
        off.len() > 200 && off.iter().all(|&off| off < 2e-4),
        "{:?}",
        off.iter().copied().reduce(f64::max)
    );
}

#[test]
fn planes_beside_a_fillet_stay_flat() {
    // A block with two edges rounded by eight steps each.
    let arc = |x: f64, from: f64| {
        (0..=8)
            .map(move |k| from + 0.5 * PI * f64::from(k) / 8.0)
            .map(move |t| [x + 0.3 * libm::cos(t), 0.7 + 0.3 * libm::sin(t)])
    };
    let mut outline = vec![[0.0, 0.0], [2.0, 0.0]];
    outline.extend(arc(1.7, 0.0).chain(arc(0.3, 0.5 * PI)));
    let shape = prism(&outline, &fan(outline.len() as u32), 1.0);
    let (_, made) = remeshed(&shape, 4_000, "fillet");
    check(&made, (2, 0, 2.0 - 2.0 * 0.09 * (1.0 - 0.25 * PI)), 5e-4, "fillet");
    for p in made.buffers(Vertices::Joined).positions {
        if (0.4..1.6).contains(&p.x) && p.y > 0.5 {
            assert!(p.y < 1.0 + 1e-6, "{p}");
        }
    }
}

#[test]
fn a_lone_bend_between_planes_is_an_edge_whatever_its_angle() {
    // A roof of 14°.
    let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.25], [0.0, 1.0]];
    let (_, made) = remeshed(&prism(&outline, &fan(5), 2.0), 3_000, "roof");
    check(&made, (2, 15, 4.5), 1e-6, "roof");
}

/// Each patch has a continuous gradient across its inner edges and beyond its border: it turns
/// along a line by no more than the curvature and the spread of the facets tell.
#[test]
fn gradients_of_patches_are_continuous_within_and_beyond_them() {
    let field = field_of(&regular(48));
    let mut evaluator = field.evaluator(Frame::default());
    let label = evaluator.label(dvec3(0.99, 0.1, 1.0));
    let side = evaluator.on(Some(label));
    let diagonal = 12.0_f64.sqrt();
    for height in [0.02, 0.5, 1.3, 2.0, 2.0 + 0.02 * diagonal, 2.0 + 0.06 * diagonal] {
        for radius in [0.95, 1.0, 1.05] {
            let place = |k: u32| {
                let t = 0.3 * f64::from(k) / 2_000.0;
                dvec3(radius * libm::cos(t), radius * libm::sin(t), height)
            };
            let mut last = side.value_and_gradient(place(0));
            for k in 1..=2_000 {
                let (p, q) = (place(k - 1), place(k));
                let (value, gradient) = side.value_and_gradient(q);
                let turn = gradient.distance(last.1);
                assert!(turn < 20.0 * p.distance(q), "{q}: {turn} over {}", p.distance(q));
                let mean = 0.5 * (gradient + last.1);
                assert!((value - last.0 - mean.dot(q - p)).abs() < 1e-6, "{q}");
                assert!((gradient.length() - 1.0).abs() < 0.02, "{q}: {gradient}");
                assert!((value - (radius - 1.0)).abs() < 3e-3, "{q}: {value}");
                last = (value, gradient);
            }
        }
    }
    // Along the axis, over the border, as well.
    let mut last = side.value_and_gradient(dvec3(1.0, 0.01, 1.5));
    for k in 1..=1_000 {
        let q = dvec3(1.0, 0.01, 1.5 + 1e-3 * f64::from(k));
        let own = side.value_and_gradient(q);
        assert!(own.1.distance(last.1) < 0.02, "{q}");
        last = own;
    }
}

#[test]
fn smooth_scan_is_closed_and_near_its_shape() {
    let (field, made) = remeshed(&torus(120, 50, 0.0), 5_000, "torus");
    assert!(matches!(field.kind(), MeshKind::Scan { .. }));
    check(&made, (0, 0, 2.0 * PI * PI * 0.16), 8e-3, "torus");
    let most = made.buffers(Vertices::Joined).positions.into_iter().map(off_torus).fold(0.0, f64::max);
    assert!(most < 3e-3, "{most}");
    assert_eq!(made.report().proof.search, Search::Searched, "a distance on a grid proves nothing");
}

#[test]
fn noisy_scan_is_closed_and_smoother_than_its_noise() {
    let noise = 0.006;
    let (field, made) = remeshed(&torus(120, 50, noise), 4_000, "noisy torus");
    assert!(matches!(field.kind(), MeshKind::Scan { .. }), "{:?}", field.kind());
    check(&made, (0, 0, 2.0 * PI * PI * 0.16), 0.02, "noisy torus");
    let new = made.buffers(Vertices::Joined).positions;
    let square: f64 = new.iter().map(|&p| off_torus(p).powi(2)).sum::<f64>() / new.len() as f64;
    assert!(square.sqrt() < 0.7 * noise, "{}", square.sqrt());
}

#[test]
fn hole_of_a_scan_is_closed_smoothly() {
    let (vertices, faces) = torus(120, 50, 0.0);
    let is_kept = |face: &[u32; 3]| vertices[face[0] as usize].distance(dvec3(1.4, 0.0, 0.0)) > 0.2;
    let kept: Vec<[u32; 3]> = faces.iter().copied().filter(is_kept).collect();
    let shape = (vertices, kept);
    let solid = solid_of(&shape);
    assert!(solid.border_edges() > 10 && !solid.is_closed());
    let (_, made) = remeshed(&shape, 4_000, "torus with a hole");
    check(&made, (0, 0, 2.0 * PI * PI * 0.16), 0.02, "torus with a hole");
    let refused = solid.field(&MeshOptions::with_edges(MeshEdges::Angle(30.0)));
    assert!(matches!(refused, Err(MeshError::Open { fans: 0, .. })), "{refused:?}");
}

/// The vertices of the borders of a new mesh, and the number of closed curves that they form.
fn borders_of(made: &Sample) -> (Vec<DVec3>, usize) {
    let new = made.buffers(Vertices::Joined);
    let sides = new.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let sides: std::collections::BTreeSet<[u32; 2]> = sides.collect();
    let mut next: std::collections::BTreeMap<u32, u32> =
        sides.iter().filter(|&&[a, b]| !sides.contains(&[b, a])).map(|&[a, b]| (a, b)).collect();
    let places = next.keys().map(|&k| new.positions[k as usize]).collect();
    let mut loops = 0;
    while let Some((start, mut at)) = next.pop_first() {
        loops += 1;
        while at != start {
            at = next.remove(&at).expect("a border is a closed curve");
        }
    }
    (places, loops)
}

/// The faces of a shape whose corners are all kept.
fn part_of((vertices, faces): &Shape, is_kept: impl Fn(DVec3) -> bool) -> Shape {
    let is_kept = |face: &&[u32; 3]| face.iter().all(|&corner| is_kept(vertices[corner as usize]));
    (vertices.clone(), faces.iter().filter(is_kept).copied().collect())
}

/// A grid of n × n squares over −1 ≤ x, y ≤ 1 with these heights.
fn terrain(n: u32, height: impl Fn(f64, f64) -> f64) -> Shape {
    let at = |k: u32| 2.0 * f64::from(k) / f64::from(n) - 1.0;
    let places = (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j)));
    let vertices = places.map(|(i, j)| dvec3(at(i), at(j), height(at(i), at(j)))).collect();
    let squares = (0..n).flat_map(|j| (0..n).map(move |i| i + j * (n + 1)));
    let faces = squares.flat_map(|k| [[k, k + 1, k + n + 2], [k, k + n + 2, k + n + 1]]);
    (vertices, faces.collect())
}

fn sheet(shape: &Shape, count: u32, (what, loops, area): (&str, usize, f64)) -> (MeshField, Sample) {
    let (field, made) = remeshed(shape, count, what);
    let MeshKind::Parts { rim: Some(rim), .. } = field.kind() else { panic!("{what}: {:?}", field.kind()) };
    assert_eq!((rim.loops, rim.edges), (loops, field.solid().border_edges()), "{what}");
    let (places, found) = borders_of(&made);
    assert_eq!(found, loops, "{what}: {:?}", made.report().warnings);
    assert_eq!(made.mesh().topology.components.len(), 1, "{what}");
    // The new border is that of the mesh.
    let solid = field.solid();
    let sides = solid.mesh().faces().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let sides: std::collections::BTreeSet<[u32; 2]> = sides.collect();
    let border: Vec<[DVec3; 3]> = sides
        .iter()
        .filter(|&&[a, b]| !sides.contains(&[b, a]))
        .map(|side| side.map(|k| solid.mesh().vertices()[k as usize]))
        .map(|[a, b]| [a, b, b])
        .collect();
    let off = |p: &DVec3| border.iter().map(|side| distance(*p, *side)).fold(f64::INFINITY, f64::min);
    let most = places.iter().map(off).fold(0.0, f64::max);
    assert!(most < 2e-3, "{what}: {most}");
    let new = made.buffers(Vertices::Joined);
    let found = TriangleMesh::new(new.positions, new.triangles).expect("a mesh").area();
    assert!((found / area - 1.0).abs() < 0.01, "{what}: {found} of {area}");
    assert!((made.particles().count() as f64 / f64::from(count) - 1.0).abs() < 0.06, "{what}");
    (field, made)
}

#[test]
fn open_surfaces_end_at_their_borders() {
    sheet(&terrain(12, |_, _| 0.3), 2_000, ("square", 1, 4.0));
    let ball = |n: u32| {
        // The upper half of a sphere: rings from the border to the pole.
        let place = |i: u32, j: u32| {
            let [u, v] = [f64::from(i) / f64::from(4 * n), f64::from(j) / f64::from(n)];
            let (s, c) = libm::sincos(0.5 * PI * v);
            dvec3(c * libm::cos(2.0 * PI * u), c * libm::sin(2.0 * PI * u), s)
        };
        let vertices = (0..=n).flat_map(|j| (0..4 * n).map(move |i| place(i, j))).collect();
        let at = |i: u32, j: u32| i % (4 * n) + 4 * n * j;
        let squares = (0..n).flat_map(|j| (0..4 * n).map(move |i| (i, j)));
        let faces = squares.flat_map(|(i, j)| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        });
        (vertices, faces.collect::<Vec<_>>())
    };
    let half = ball(16);
    let (_, made) = sheet(&half, 3_000, ("half a sphere", 1, 2.0 * PI));
    for p in made.buffers(Vertices::Joined).positions {
        assert!((p.length() - 1.0).abs() < 1e-3 && p.z > -1e-3, "{p}");
    }
    sheet(&turned(&half), 2_000, ("half a sphere inside out", 1, 2.0 * PI));
    let hills = terrain(40, |x, y| 0.2 * libm::sin(3.0 * x) * libm::cos(4.0 * y));
    let area = TriangleMesh::new(hills.0.clone(), hills.1.clone()).expect("a mesh").area();
    sheet(&hills, 3_000, ("terrain", 1, area));
    let ring = part_of(&terrain(40, |_, _| 0.0), |p| p.abs().max_element() > 0.49);
    sheet(&ring, 3_000, ("square with a square hole", 2, 3.0));
}
#[test]
fn borders_of_solids_are_kept_if_asked_for() {
    let mut open = cuboid([2.0, 2.0, 1.0]);
    let is_top = |face: &[u32; 3]| face.iter().all(|&corner| open.0[corner as usize].z == 1.0);
    open.1.retain(|face| !is_top(face));
    let mut options = MeshOptions::default();
    options.borders = Some(true);
    let field = solid_of(&open).field(&options).expect("a field");
    let MeshKind::Parts { patches: 5, edges: 8, corners: 4, .. } = field.kind() else {
        panic!("{:?}", field.kind())
    };
    let made = sample(field, &Settings::with_count(3_000).refined()).expect("a sample");
    let (places, loops) = borders_of(&made);
    assert!(loops == 1 && places.iter().all(|p| (p.z - 1.0).abs() < 1e-5), "{loops}");
    let new = made.buffers(Vertices::Joined);
    let area = TriangleMesh::new(new.positions, new.triangles).expect("a mesh").area();
    assert!((area - 12.0).abs() < 0.02, "{area}");
}

#[test]
fn mended_mesh_is_sampled_as_one_that_is_whole() {
    let whole = drilled(32);
    // Three vertices of their own for each face, as in STL; some faces twice, some turned.
    let mut soup = (Vec::new(), Vec::new());
    for (k, face) in whole.1.iter().enumerate() {
        let first = soup.0.len() as u32;
        soup.0.extend(face.map(|corner| whole.0[corner as usize]));
        let own = if k % 20 == 7 { [first, first + 2, first + 1] } else { [first, first + 1, first + 2] };
        soup.1.push(own);
        if k % 20 == 3 {
            soup.1.push([own[1], own[0], own[2]]);
        }
    }
    let solid = solid_of(&soup);
    let repairs = solid.repairs();
    assert_eq!((repairs.merged, repairs.doubled, repairs.turned), (3 * 256 - 128, 13, 13), "{repairs:?}");
    assert_eq!(repairs.words().len(), 3);
    assert_eq!((solid.is_closed(), solid.pieces(), solid.mesh().faces().len()), (true, 1, 256));
    check(&remeshed(&soup, 5_000, "soup").1, (0, 14, 4.0 - 0.16 * PI), 3e-3, "soup");
    let inside_out = solid_of(&turned(&whole));
    assert_eq!(inside_out.repairs().turned, 256);
    assert!((inside_out.mesh().volume() - solid_of(&whole).mesh().volume()).abs() < 1e-12);
    let (_, made) = remeshed(&turned(&whole), 5_000, "inside out");
    check(&made, (0, 14, 4.0 - 0.16 * PI), 3e-3, "inside out");
}

#[test]
fn faces_are_divided_at_vertices_on_their_sides() {
    // The top of a box has a vertex in the middle of a side, and the side below it has not.
    let (mut vertices, mut faces) = cuboid([1.0, 1.0, 1.0]);
    vertices.push(dvec3(0.5, 0.0, 1.0));
    let at = faces.iter().position(|face| face.contains(&4) && face.contains(&5) && face.contains(&6));
    faces.swap_remove(at.expect("the top has the side 4, 5"));
    faces.extend([[4, 8, 6], [8, 5, 6]]);
    let solid = solid_of(&(vertices, faces));
    assert_eq!(solid.repairs().divided, 1);
    assert!(solid.is_closed());
    assert!((solid.mesh().volume() - 1.0).abs() < 1e-12);
}

#[test]
fn hollows_stay_hollow_and_go_with_what_is_around_them() {
    let hollow = |inner: &Shape| joined(cuboid([3.0; 3]), &moved(inner, |p| p + DVec3::ONE));
    let shape = hollow(&turned(&cuboid([1.0; 3])));
    for (shape, volume) in [(&shape, 26.0), (&turned(&shape), 26.0), (&hollow(&cuboid([1.0; 3])), 28.0)] {
        assert!((solid_of(shape).mesh().volume() - volume).abs() < 1e-9);
    }
}

#[test]
fn boxes_far_from_the_origin_keep_their_edges_and_farther_ones_are_refused() {
    let far = |by: f64| moved(&cuboid([2.0, 3.0, 1.0]), |p| p + by * dvec3(3.0, -2.0, 1.0));
    let (_, made) = remeshed(&far(1e3), 1_500, "far box");
    check(&made, (2, 12, 6.0), 1e-4, "far box");
    let (vertices, faces) = far(1e6);
    let refused = TriangleMesh::new(vertices, faces).expect("a mesh").solid();
    assert!(matches!(refused, Err(MeshError::Far)), "{refused:?}");
}

#[test]
fn bodies_that_intersect_or_touch_are_united() {
    let and_moved = |by: DVec3| joined(cuboid([1.0; 3]), &moved(&cuboid([1.0; 3]), |p| p + by));
    let hollow = joined(cuboid([1.0; 3]), &turned(&moved(&cuboid([0.6; 3]), |p| p + DVec3::splat(0.2))));
    let rod = moved(&cuboid([0.2, 0.2, 2.0]), |p| p + dvec3(0.4, 0.4, -0.5));
    // A rod through a hollow box leaves a ring of a room.
    let shapes = [
        ("boxes that cross", and_moved(DVec3::splat(0.6)), 2, 30, 2.0 - 0.4_f64.powi(3)),
        ("boxes with a part of a face in common", and_moved(dvec3(1.0, 0.3, 0.2)), 2, 28, 2.0),
        ("hollow box with a rod", joined(hollow, &rod), 2, 60, 1.0 - 0.216 + 0.04 * (1.0 + 0.6)),
    ];
    for (what, shape, euler, creases, volume) in shapes {
        let (field, made) = remeshed(&shape, 3_000, what);
        let MeshKind::Union { bodies: 2, .. } = field.kind() else { panic!("{what}: {:?}", field.kind()) };
        check(&made, (euler, creases, volume), 1e-3, what);
        let new = made.buffers(Vertices::Joined);
        let change = field.compare(&new.positions, &new.triangles);
        assert!(
            change.to_new.largest < 1e-3 && change.edges.is_some_and(|far| far < 1e-6),
            "{what}: {change:?}"
        );
        assert!((change.volume[0] / volume - 1.0).abs() < 0.005, "{what}: {change:?}");
        assert!((change.area[0] / change.area[1] - 1.0).abs() < 0.005, "{what}: {change:?}");
    }
    // They share the particles of the edge that they have in common.
    let (_, made) = remeshed(&and_moved(dvec3(1.0, 1.0, 0.0)), 3_000, "boxes with one edge in common");
    assert_eq!((made.report().proof.creases, made.mesh().left_out.len()), (Some(23), 0));
}

#[test]
fn bodies_that_share_whole_faces_are_united_with_their_edges() {
    let cube = cuboid([1.0; 3]);
    // The top and the bottom of the helper's boxes have other diagonals than a turned box.
    let turned_over = moved(&cube, |p| dvec3(p.z, p.x, p.y));
    let beside = |shape: &Shape, by: DVec3| moved(shape, |p| p + by);
    for way in DVec3::AXES {
        for other in [&cube, &turned_over, &moved(&cube, |p| dvec3(1.0 - p.x, 1.0 - p.y, p.z))] {
            let what = format!("cubes beside each other along {way}");
            let (field, made) = remeshed(&joined(cube.clone(), &beside(other, way)), 2_000, &what);
            assert!(matches!(field.kind(), MeshKind::Union { bodies: 2, .. }), "{what}: {:?}", field.kind());
            check(&made, (2, 12, 2.0), 1e-4, &what);
        }
    }
    let corner =
        joined(joined(cube.clone(), &beside(&turned_over, DVec3::X)), &beside(&turned_over, DVec3::Y));
    let (_, made) = remeshed(&corner, 2_000, "three cubes around an edge");
    check(&made, (2, 18, 3.0), 1e-4, "three cubes around an edge");
    // Two sides of one surface are no wall between bodies.
    let two_sided = joined(cube.clone(), &turned(&cube));
    assert_eq!(solid_of(&two_sided).repairs().doubled, 12);
}

#[test]
fn coarse_models_keep_their_facets() {
    // A ball of 32 faces with a rough surface: its angles lie below and above those of edges, and
    // hollows and bulges meet at its corners.
    let axes = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
    let mut vertices = axes.to_vec();
    let mut faces = Vec::new();
    let mut middles = Vec::new();
    let mut between = |a: u32, b: u32, vertices: &mut Vec<DVec3>| {
        let key = (a.min(b), a.max(b));
        let known = middles.iter().position(|&own| own == key);
        known.unwrap_or_else(|| {
            middles.push(key);
            vertices.push((vertices[a as usize] + vertices[b as usize]).normalize_or_zero());
            middles.len() - 1
        }) as u32
            + 6
    };
    for (x, y, z) in (0..8).map(|k| (3 * (k & 1), 1 + 3 * (k >> 1 & 1), 2 + 3 * (k >> 2))) {
        let is_odd = [x, y, z].iter().filter(|&&corner| corner > 2).count() % 2 == 1;
        let [a, b, c] = if is_odd { [x, z, y] } else { [x, y, z] };
        let [d, e, f] = [(a, b), (b, c), (c, a)].map(|(from, to)| between(from, to, &mut vertices));
        faces.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]);
    }
    let rough = |(k, p): (usize, &DVec3)| *p * (1.0 + 0.14 * libm::sin(5.0 * k as f64));
    let shape: Shape = (vertices.iter().enumerate().map(rough).collect(), faces);
    let volume = solid_of(&shape).mesh().volume();
    let (field, made) = remeshed(&shape, 3_000, "coarse ball");
    assert!(matches!(field.kind(), MeshKind::Parts { patches: 32, edges: 48, .. }), "{:?}", field.kind());
    check(&made, (2, 48, volume), 1e-4, "coarse ball");
}

#[test]
fn a_body_that_intersects_itself_is_rounded() {
    // A corner of a box is drawn out through the opposite side.
    let folded = moved(&cuboid([1.0; 3]), |p| if p == DVec3::ONE { dvec3(0.4, 0.3, -0.5) } else { p });
    let solid = solid_of(&folded);
    let edged = solid.field(&MeshOptions::with_edges(MeshEdges::Angle(30.0)));
    assert!(matches!(edged, Err(MeshError::Intersects { .. })), "{edged:?}");
    let field = solid.field(&MeshOptions::default()).expect("a scan");
    assert!(matches!(field.kind(), MeshKind::Scan { .. }));
}

#[test]
fn meshes_are_operands_and_have_offsets() {
    let block = field_of(&moved(&cuboid([2.0, 2.0, 1.0]), |p| p - dvec3(1.0, 1.0, 0.5)));
    let hole = Formula::parse("x^2 + y^2 - 0.25").expect("a formula");
    let settings = Settings::with_count(4_000).refined();
    let made = sample(difference(block.clone(), hole), &settings).expect("a sample");
    check(&made, (0, 14, 4.0 - 0.25 * PI), 2e-3, "drilled mesh");
    let made = sample(offset(block, 0.1), &settings).expect("a sample");
    check(&made, (2, 12, 2.2 * 2.2 * 1.2), 1e-4, "larger mesh");
}

#[test]
fn compared_distances_are_those_of_all_triangles() {
    let shape = bracket();
    let field = field_of(&shape);
    // Moved aside, each point of it is at most so far away.
    let other = moved(&shape, |p| p + dvec3(0.03, 0.0, 0.0));
    let change = field.compare(&other.0, &other.1);
    assert!((change.to_old.largest - 0.03).abs() < 1e-12 && (change.to_new.largest - 0.03).abs() < 1e-12);
    assert!((change.volume[0] - 1.75).abs() < 1e-12 && (change.volume[1] - 1.75).abs() < 1e-12);
    assert!((change.area[0] - change.area[1]).abs() < 1e-12 && (change.area[0] - 11.5).abs() < 1e-12);
    assert!(change.edges.is_some_and(|edges| (edges - 0.03).abs() < 1e-12));
    let most = other.0.iter().map(|&p| off_shape(p, &shape)).fold(0.0, f64::max);
    assert!((change.to_old.largest - most).abs() < 1e-12);
}

#[test]
fn every_format_of_a_mesh_is_read() {
    let (vertices, faces) = bracket();
    let corner = |index: &u32| vertices[*index as usize];
    let lines = |text: &mut String, word: &str| {
        for p in &vertices {
            *text += &format!("{word}{} {} {}\n", p.x, p.y, p.z);
        }
    };
    let mut stl = vec![0; 80];
    stl.extend((faces.len() as u32).to_le_bytes());
    let mut solid = "solid s\n".to_owned();
    for face in &faces {
        stl.extend([0; 12]);
        solid += "facet normal 0 0 0\nouter loop\n";
        for p in face.iter().map(corner) {
            stl.extend(p.to_array().iter().flat_map(|x| (*x as f32).to_le_bytes()));
            solid += &format!("vertex {} {} {}\n", p.x, p.y, p.z);
        }
        stl.extend([0; 2]);
        solid += "endloop\nendfacet\n";
    }
    let (mut obj, mut off, mut ply) = (
        String::new(),
        format!("OFF\n{} {} 0\n", vertices.len(), faces.len()),
        format!(
            "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {}\n\
             property list uchar int vertex_indices\nend_header\n",
            vertices.len(),
            faces.len()
        ),
    );
    lines(&mut obj, "v ");
    lines(&mut off, "");
    lines(&mut ply, "");
    for [a, b, c] in &faces {
        obj += &format!("f {} {} {}\n", a + 1, b + 1, c + 1);
        off += &format!("3 {a} {b} {c}\n");
        ply += &format!("3 {a} {b} {c}\n");
    }
    let files = [
        ("a.stl", stl),
        ("b.stl", solid.into_bytes()),
        ("c.obj", obj.into_bytes()),
        ("d.off", off.into_bytes()),
        ("e.ply", ply.into_bytes()),
    ];
    for (name, bytes) in files {
        let mesh = TriangleMesh::read(name, bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        let solid = mesh.solid().expect("a solid");
        assert_eq!((solid.mesh().faces().len(), solid.mesh().vertices().len()), (20, 12), "{name}");
        assert!((solid.mesh().volume() - 1.75).abs() < 1e-6, "{name}");
    }
}

/// A tetrahedron in inches, whose object is a component of another one that mirrors and moves it.
#[test]
fn objects_of_a_3mf_file_are_read_where_it_builds_them() {
    for bytes in
        [&include_bytes!("../../fuzz/seeds/mesh/3mf")[..], include_bytes!("../../fuzz/seeds/mesh/3mf-packed")]
    {
        let mesh = TriangleMesh::read("a.3mf", bytes.to_vec()).expect("a mesh");
        assert_eq!(mesh.notes(), ["The unit of this file is the inch."]);
        assert_eq!((mesh.vertices().len(), mesh.faces().len()), (4, 4));
        let bounds = mesh.bounds();
        assert_eq!((bounds.lo(), bounds.hi()), (dvec3(0.0, 0.0, 2.0), dvec3(1.0, 1.0, 3.0)));
        // A mirrored object still faces outward.
        assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-12, "{}", mesh.volume());
        for cut in [10, bytes.len() / 2, bytes.len() - 30] {
            let error = TriangleMesh::read("a.3mf", bytes[..cut].to_vec()).expect_err("cut off");
            assert!(error.to_string().contains("cut off"), "{error}");
        }
    }
    // What this program writes.
    let made = sample(field_of(&bracket()), &Settings::with_count(400)).expect("a sample");
    let path = std::env::temp_dir().join("marching-particles-bracket.3mf");
    made.save(&path).expect("written");
    let again = TriangleMesh::read("a.3mf", std::fs::read(&path).expect("the file")).expect("a mesh");
    assert_eq!(again.faces().len(), made.buffers(Vertices::Joined).triangles.len());
    assert!((again.volume() - 1.75).abs() < 1e-3 && again.notes().is_empty());
}

#[test]
fn what_is_no_solid_is_refused_with_what_to_do() {
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let one = || TriangleMesh::new(corners.clone(), vec![[0, 1, 2]]).expect("a mesh");
    let refused =
        |result: Result<_, MeshError>| result.err().map(|error| error.to_string()).unwrap_or_default();
    assert!(refused(TriangleMesh::new(corners.clone(), vec![])).contains("there are no faces"));
    assert!(refused(TriangleMesh::new(corners.clone(), vec![[0, 1, 3]])).contains("face 0 has a corner 3"));
    assert!(refused(TriangleMesh::new(vec![DVec3::NAN], vec![[0, 0, 0]])).contains("vertex 0"));
    let many = vec![[0, 1, 2]; MAX_TRIANGLES + 1];
    assert!(refused(TriangleMesh::new(corners.clone(), many)).contains("10,000,001 triangles"));
    assert!(refused(TriangleMesh::read("a.stl", Vec::new())).contains("the file is empty"));
    assert!(refused(TriangleMesh::read("a.xyz", b"0 0 0\n1 0 0\n".to_vec())).contains("only points"));
    let refused = |mesh: TriangleMesh| mesh.solid().err().map(|error| error.to_string()).unwrap_or_default();
    assert!(one().solid().is_ok_and(|solid| solid.is_sheet()));
    let fan = [[0, 1, 2], [0, 1, 3], [0, 1, 4]];
    let places = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, -DVec3::Y];
    let fan = TriangleMesh::new(places, fan.to_vec()).expect("a mesh").solid().expect("a sheet");
    let message = |error: Option<MeshError>| error.map(|error| error.to_string()).unwrap_or_default();
    assert!(message(fan.field(&MeshOptions::default()).err()).contains("1 edge with more than two faces"));
    // A Möbius strip.
    let place = |k: u32| {
        let (turn, side) = (f64::from(k / 2) * PI / 8.0, if k.is_multiple_of(2) { 0.3 } else { -0.3 });
        let radius = 1.0 + side * libm::cos(0.5 * turn);
        dvec3(radius * libm::cos(turn), radius * libm::sin(turn), side * libm::sin(0.5 * turn))
    };
    let at = |k: u32| if k < 32 { k } else { (k - 32) ^ 1 };
    let strip =
        (0..16).flat_map(|k| [[2 * k, at(2 * k + 2), 2 * k + 1], [2 * k + 1, at(2 * k + 2), at(2 * k + 3)]]);
    let strip = TriangleMesh::new((0..32).map(place).collect(), strip.collect()).expect("a mesh").solid();
    assert_eq!(strip.expect("a sheet").field(&MeshOptions::default()).err(), Some(MeshError::OneSided));
    let flat = TriangleMesh::new(vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::X], vec![[0, 1, 2], [1, 1, 2]]);
    assert!(refused(flat.expect("a mesh")).contains("no face of the mesh has an area"));
    let solid = solid_of(&cuboid([1.0; 3]));
    for (edges, smooth) in
        [(MeshEdges::Angle(0.5), None), (MeshEdges::Auto, Some(11.0)), (MeshEdges::Angle(30.0), Some(1.0))]
    {
        let mut options = MeshOptions::with_edges(edges);
        options.smooth = smooth;
        assert!(solid.field(&options).is_err(), "{options:?}");
    }
}

/// A mesh with damages that random numbers choose.
fn damaged(random: &mut Pcg32) -> (Shape, Vec<&'static str>) {
    let mut below = |count: usize| random.next_u32() as usize % count;
    let mut shape = match below(5) {
        0 => cuboid([1.0, 2.0, 3.0]),
        1 => bracket(),
        2 => drilled(16),
        3 => torus(12, 8, 0.0),
        _ => terrain(6, |x, y| 0.3 * x * y),
    };
    let mut done = Vec::new();
    for _ in 0..1 + below(3) {
        let (count, vertices) = (shape.1.len(), shape.0.len());
        let (face, vertex) = (below(count), below(vertices));
        let what = match below(11) {
            0 => {
                shape.1[face].swap(0, 1);
                "a flipped face"
            }
            1 => {
                let [a, b, c] = shape.1[face];
                shape.1.push([c, b, a]);
                "a doubled face"
            }
            2 => {
                shape.1.swap_remove(face);
                "a hole"
            }
            3 => {
                let [a, b, _] = shape.1[face];
                shape.0.push(shape.0[a as usize].lerp(shape.0[b as usize], 0.5) + dvec3(0.4, 0.3, 0.2));
                shape.1.push([a, b, vertices as u32]);
                "a fan"
            }
            4 => {
                let [a, b, c] = shape.1[face];
                shape.0.push(shape.0[a as usize].midpoint(shape.0[b as usize]));
                shape.1[face] = [a, vertices as u32, c];
                shape.1.push([vertices as u32, b, c]);
                "a T-junction"
            }
            5 => {
                let [a, ..] = shape.1[face];
                shape.0[vertex] = shape.0[a as usize];
                "an edge without length"
            }
            6 => {
                let by = [0.3, 1.0, 2.0][below(3)] * dvec3(1.0, 0.5, 0.25);
                let other = moved(&shape, |p| p + by);
                shape = joined(shape, &other);
                "a copy aside"
            }
            7 => {
                shape = turned(&shape);
                "all faces turned"
            }
            8 => {
                let by = [1e2, 1e4, 1e7][below(3)];
                shape = moved(&shape, |p| p + by * dvec3(1.0, -2.0, 3.0));
                "a place far away"
            }
            9 => {
                shape.0[vertex] *= 3.0;
                "a spike"
            }
            _ => {
                shape = moved(&shape, |p| dvec3(p.x, p.y, 1e-9 * p.z));
                "no thickness"
            }
        };
        done.push(what);
        if shape.1.is_empty() {
            break;
        }
    }
    (shape, done)
}

#[test]
fn damaged_meshes_are_sampled_or_refused_in_words() {
    let mut sampled = 0;
    for seed in crate::cases::seeds(100) {
        let mut random = Pcg32::seed_from_u64(seed);
        let ((vertices, faces), what) = damaged(&mut random);
        let edges =
            [MeshEdges::Auto, MeshEdges::Angle(30.0), MeshEdges::Rounded][random.next_u32() as usize % 3];
        let mut options = MeshOptions::with_edges(edges);
        options.borders = [None, Some(true), Some(false)][random.next_u32() as usize % 3];
        let mesh = TriangleMesh::new(vertices, faces);
        let field = mesh.and_then(|mesh| mesh.solid()).and_then(|solid| solid.field(&options));
        let field = match field {
            Ok(field) => field,
            Err(error) => {
                assert!(error.to_string().len() > 20, "seed {seed}, {what:?}: {error:?}");
                continue;
            }
        };
        match sample(field.clone(), &Settings::with_count(400)) {
            Ok(made) => {
                let new = made.buffers(Vertices::Joined);
                let bounds = field.solid().mesh().bounds();
                let bounds = bounds.enlarged(0.5 * bounds.diagonal()).relative_to(-field.solid().origin());
                assert!(new.positions.iter().all(|&p| bounds.holds(p)), "seed {seed}, {what:?}");
                sampled += 1;
            }
            Err(error) => assert!(error.to_string().len() > 20, "seed {seed}, {what:?}: {error:?}"),
        }
    }
    assert!(sampled > 0);
}

#[test]
fn edges_along_given_lines_are_kept_whatever_their_angle() {
    // The sides of the prism meet at 15°.
    let shape = regular(24);
    let upright = |k: usize| [shape.0[k], shape.0[24 + k]];
    let field = |lines: &[[DVec3; 2]], edges| {
        let solid = solid_of(&shape).with_edges_along(lines);
        solid.field(&MeshOptions::with_edges(edges)).expect("a field")
    };
    let patches = |field: &MeshField| match field.kind() {
        MeshKind::Parts { patches, faded, .. } => (patches, faded),
        kind => panic!("{kind:?}"),
    };
    assert_eq!(patches(&field(&[], MeshEdges::Auto)), (3, 0));
    assert_eq!(patches(&field(&[upright(0)], MeshEdges::Auto)), (3, 1), "it does not divide the side");
    let marked = field(&[upright(0), upright(9)], MeshEdges::Auto);
    assert_eq!(patches(&marked), (4, 0));
    let made = sample(marked, &Settings::with_count(3_000).refined()).expect("a sample");
    check(&made, (2, 6, 12.0 * libm::sin(PI / 12.0) * 2.0), 2e-2, "marked prism");
}

/// A cap of a sphere that is cut along its triangles, as a scan is: its border zigzags.
#[test]
fn a_zigzagging_border_leaves_no_pieces_beside_the_surface() {
    for (n, count) in [(24, 1_500), (40, 3_000)] {
        let cap = terrain(n, |x, y| libm::sqrt(2.25 - x * x - y * y));
        let shape = part_of(&cap, |p| (p.truncate() - DVec2::new(0.03, -0.05)).length() < 0.8);
        let (field, made) = remeshed(&shape, count, "cap");
        let MeshKind::Parts { rim: Some(rim), .. } = field.kind() else { panic!("{:?}", field.kind()) };
        assert!(rim.is_smoothed && rim.loops == 1, "{rim:?}");
        assert_eq!(made.mesh().topology.components.len(), 1, "{n}: {:?}", made.report().warnings);
        assert_eq!((borders_of(&made).1, made.mesh().topology.euler()), (1, 1), "{n}");
        let edge = 2.0 / f64::from(n);
        for p in made.buffers(Vertices::Joined).positions {
            assert!((p.length() - 1.5).abs() < 0.5 * edge * edge, "{n}: {p}");
            assert!(off_shape(p, &shape) < 0.5 * edge, "{n}: {p}");
        }
    }
}
