use super::*;
use crate::field::edges::KnownPieces;
use crate::field::formula::Formula;
use crate::field::{Field, Frame, Piecewise};
use crate::particles::Particles;
use crate::sampler::probe::ProbeMemory;
use crate::sampler::{FoundCreases, find_creases};
use crate::slices::complete;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The creases of a formula in the box from −`half` to `half`.
fn creases(text: &str, half: f64) -> (Arc<dyn Piecewise>, Creases) {
    let field = Formula::as_written(text, &[]).expect("a formula");
    let FoundCreases { creases, known } =
        complete(find_creases(&field, DVec3::ZERO, &Bounds::cube(half), None));
    let Some(KnownPieces::Own(own)) = known else { panic!("a formula has pieces of its own") };
    (own, creases)
}

/// Numbers of creases, and of corners at which more than two of them meet.
fn counts(creases: &Creases) -> [usize; 2] {
    let ends = |corner: usize| {
        creases.curves.iter().flat_map(|curve| curve.corners).filter(|&end| end == Some(corner)).count()
    };
    [creases.curves.len(), (0..creases.corners.len()).filter(|&corner| ends(corner) > 2).count()]
}

#[test]
fn creases_that_touch_meet_at_corners_wherever_the_cells_lie() {
    let cube = "max(abs(x), abs(y), abs(z)) - 1";
    let block = "max(abs(x) - 1, abs(y) - 0.7, abs(z) - 1.5)";
    let octahedron = "abs(x) + abs(y) + abs(z) - 1";
    for (body, ball, union, intersection, difference) in [
        // A circle on each face, which touches its edges in their middles.
        (cube, "hypot(x, y, z) - sqrt(2)", [48, 20], [24, 12], [48, 20]),
        (octahedron, "hypot(x, y, z) - sqrt(1/2)", [48, 18], [24, 12], [48, 18]),
        // One edge is touched, and four.
        (cube, "hypot(x - 0.5, y, z - 0.5) - sqrt(1/2)", [15, 9], [2, 1], [15, 9]),
        (block, "hypot(x, y, z) - hypot(1, 0.7)", [24, 12], [8, 4], [24, 12]),
    ] {
        for (operation, expected) in [
            (format!("min({ball}, {body})"), union),
            (format!("max({ball}, {body})"), intersection),
            (format!("max({body}, -({ball}))"), difference),
        ] {
            for half in [1.83, 1.9, 2.0] {
                let (_, creases) = creases(&operation, half);
                assert_eq!(counts(&creases), expected, "{operation} in a cube of half-width {half}");
            }
        }
    }
}

#[test]
fn the_creases_of_solids_are_counted() {
    for (name, text, half, expected) in [
        ("sphere", "x^2+y^2+z^2-1", 1.3, [0, 0]),
        ("cube", "max(abs(x),abs(y),abs(z))-1", 1.3, [12, 8]),
        (
            "turned cube",
            "max(abs(0.36*x+0.48*y-0.8*z),abs(-0.8*x+0.6*y),abs(0.48*x+0.64*y+0.6*z))-1",
            1.9,
            [12, 8],
        ),
        // The distance from its edges is zero on them alone, and no patch.
        (
            "distance to a turned box",
            "hypot(max(abs(0.8*x+0.6*y)-0.7,0), max(abs(0.8*y-0.6*x)-0.5,0), max(abs(z)-0.4,0))
                + min(max(abs(0.8*x+0.6*y)-0.7,abs(0.8*y-0.6*x)-0.5,abs(z)-0.4),0)",
            1.2,
            [12, 8],
        ),
        (
            "distance to a cone, cut",
            "hypot(max(hypot(x,y)-0.5+0.3*z,0),max(abs(z)-0.5,0)) + min(max(hypot(x,y)-0.5+0.3*z,abs(z)-0.5),0)",
            1.0,
            [2, 0],
        ),
        ("octahedron", "abs(x)+abs(y)+abs(z)-1", 1.2, [12, 6]),
        ("cylinder", "max(x^2+y^2-1,abs(z)-1)", 1.4, [2, 0]),
        ("union of spheres", "min((x-0.5)^2+y^2+z^2-1,(x+0.5)^2+y^2+z^2-1)", 1.7, [1, 0]),
        ("drilled block", "max(abs(x)-1,abs(y)-1,abs(z)-0.4,0.16-x^2-y^2)", 1.3, [14, 8]),
        // Eight triples of cylinders meet on the diagonals of the cube, and six pairs where the
        // third has its axis.
        ("three cylinders", "max(x^2+y^2,y^2+z^2,z^2+x^2)-1", 1.3, [24, 14]),
        ("wedge", "max(z,0.176327*x-z,abs(y)-1,-x-1.5)", 2.0, [9, 6]),
        // An edge of a cube touches the rim of a cone whose base stands in it, at a corner.
        (
            "cone in a cube",
            "min(max(hypot(y,z)-(1-x),0.5-x),max(abs(x-1),abs(y+1),abs(z-0.5))-1)",
            2.3,
            [17, 10],
        ),
        // The plane between the cubes is no surface where they touch.
        ("two cubes", "min(max(abs(x),abs(y),abs(z))-1,max(abs(x-1.5),abs(y),abs(z))-0.5)", 2.3, [24, 16]),
        // Curves on which four patches meet.
        ("crossing spheres", "((x-0.5)^2+y^2+z^2-1)*((x+0.5)^2+y^2+z^2-1)", 1.7, [1, 0]),
        ("three planes", "x*y*z", 1.3, [6, 1]),
        ("touching spheres", "((x-1)^2+y^2+z^2-1)*((x+1)^2+y^2+z^2-1)", 2.2, [0, 0]),
        ("smooth contact", "max(x,0)^2+y^2+z^2-1", 1.2, [0, 0]),
    ] {
        assert_eq!(counts(&creases(text, half).1), expected, "{name}: {text}");
    }
}

#[test]
fn a_corner_on_a_face_of_the_box_is_one() {
    // A tip of the octahedron lies on the face, and two of its edges do.
    let (_, creases) = creases("abs(x+1)+abs(y)+abs(z)-0.5", 1.0);
    let tip = DVec3::new(-1.0, 0.5, 0.0);
    let mut ends = Vec::new();
    for curve in &creases.curves {
        let places = [curve.points[0], curve.points[curve.points.len() - 1]];
        let here = places.into_iter().zip(curve.corners).filter(|(place, _)| place.distance(tip) < 1e-9);
        ends.extend(here.map(|(_, corner)| corner));
    }
    assert_eq!(ends.len(), 3, "{ends:?}");
    assert!(ends[0].is_some() && ends.iter().all(|&end| end == ends[0]), "{ends:?}");
}

#[test]
fn creases_that_end_at_one_point_of_the_box_share_a_particle() {
    // A circle and hyperbolas touch on the lower face across x.
    let text = "max(hypot(x+1,y)-abs(z),0.5-max(abs(x+1),abs(y),abs(z-1)))";
    let (field, creases) = creases(text, 1.0);
    let mut memory = ProbeMemory::default();
    let filled = creases.fill(
        &mut Probe::new(&mut *field.evaluator(Frame::default()), &mut memory),
        0,
        f64::round,
        |_, _| 0.05,
    );
    let at = |place: Vec3| filled.list.iter().filter(move |p| p.position.distance(place) < 1e-4);
    for y in [-0.5, 0.5] {
        let [particle] = at(Vec3::new(-1.0, y, 0.5)).collect::<Vec<_>>()[..] else { panic!("two at {y}") };
        assert_eq!(particle.patches.len(), 3, "{particle:?}");
    }
    for particle in &filled.list {
        assert_eq!(at(particle.position).count(), 1, "{particle:?}");
    }
}

#[test]
fn a_small_particle_where_a_factor_touches_another_has_a_normal() {
    // A torus on a plane. Neither factor has a gradient in the product where they touch.
    let text = "((hypot(x-1,y-1)-1)^2+(z-1.25)^2-1/16)*(1-z)";
    let field = Formula::as_written(text, &[]).expect("a formula");
    let mut memory = ProbeMemory::default();
    let mut evaluator = field.evaluator(Frame::default());
    let probe = &mut Probe::new(&mut *evaluator, &mut memory);
    let (position, radius) = (Vec3::new(2.0, 1.0, 1.0), 1e-6);
    let particle = fill::CreaseParticle { position, radius, tangent: Vec3::Y, patches: Vec::new() };
    let normal = particle.normal(probe).expect("a normal");
    assert!((normal.length() - 1.0).abs() < 1e-6, "{normal}");
}

#[test]
fn a_crease_lies_where_both_branches_are_zero() {
    let (field, creases) = creases("min((x-0.5)^2+y^2+z^2-1,(x+0.5)^2+y^2+z^2-1)", 1.7);
    let [curve] = &creases.curves[..] else { panic!("{creases:?}") };
    assert!(curve.is_closed);
    let exact = core::f64::consts::TAU * 0.75_f64.sqrt();
    assert!((curve.length() / exact - 1.0).abs() < 1e-3, "{} for {exact}", curve.length());
    let mut evaluator = field.evaluator(Frame::default());
    for &p in &curve.points {
        for &patch in &curve.patches {
            let (value, gradient) = evaluator.on(Some(patch)).value_and_gradient(p);
            assert!(value.abs() < 1e-9 * gradient.length(), "{p}: {value}");
        }
    }
}

#[test]
fn particles_on_creases_are_evenly_spaced_and_have_a_row_for_each_patch() {
    let (field, creases) = creases("max(abs(x),abs(y),abs(z))-1", 1.3);
    let mut memory = ProbeMemory::default();
    let mut evaluator = field.evaluator(Frame::default());
    let probe = &mut Probe::new(&mut *evaluator, &mut memory);
    let filled = creases.fill(probe, 0, f64::round, |_, _| 0.0493);
    // An edge of length 2 has room for 20 particles at a distance of 0.1.
    assert_eq!(filled.list.len(), 8 + 12 * 19);
    assert_eq!(filled.segments.len(), 12 * 20);
    for pair in &filled.segments {
        let [a, b] = pair.map(|i| filled.list[i as usize].position);
        assert!((a.distance(b) - 0.1).abs() < 1e-5, "{a} {b}");
    }
    let mut particles = Particles::default();
    let along = filled.add_rows(probe, &mut particles);
    assert_eq!(particles.len(), 8 * 3 + 12 * 19 * 2);
    assert_eq!((particles.count(), along.len()), (filled.list.len(), particles.len()));
    for i in 0..particles.len() {
        let first = particles.first_row(i);
        assert_eq!(particles.local[i], particles.local[first]);
        assert!(first == i || particles.normal[i].dot(particles.normal[first]).abs() < 1e-6);
    }
}

#[test]
fn every_level_of_a_ladder_halves_the_ways_along_the_creases() {
    let (field, creases) = creases("min((x-0.5)^2+y^2+z^2-1,(x+0.5)^2+y^2+z^2-1)", 1.8);
    let mut memory = ProbeMemory::default();
    let mut evaluator = field.evaluator(Frame::default());
    let probe = &mut Probe::new(&mut *evaluator, &mut memory);
    let filled = creases.fill(probe, 3, f64::round, |_, _| 0.2);
    let mut rows = Particles::default();
    filled.add_rows(probe, &mut rows);
    let ladder = filled.into_ladder(&rows, None);
    // The circle of circumference 2π √¾ has room for 14 particles at a distance of 0.4.
    let mut place: BTreeMap<u32, Vec3> =
        (0..).zip(&rows.local).map(|(row, &p)| (rows.first_row(row) as u32, p)).collect();
    for to_come in (0..3).rev() {
        for ([a, b], _) in ladder.pairs(to_come + 1) {
            let (number, middle) = ladder.middle(a, b).expect("the middle of a pair");
            assert_eq!(ladder.middle(b, a), Some((number, middle)));
            place.insert(number, middle);
        }
        let parts = 14 << (3 - to_come);
        assert_eq!((ladder.pairs(to_come).count(), place.len()), (parts, parts));
        let chord = 2.0 * 0.75_f32.sqrt() * libm::sinf(core::f32::consts::PI / parts as f32);
        for (pair, _) in ladder.pairs(to_come) {
            let [p, q] = pair.map(|number| place[&number]);
            assert!((p.distance(q) / chord - 1.0).abs() < 1e-3, "{p} {q}: not {chord} apart");
        }
    }
    assert_eq!((ladder.len(), ladder.ambiguous()), (rows.len() + 14 * 7, None));
    assert!(ladder.pairs(0).all(|([a, b], _)| ladder.middle(a, b).is_none() && !ladder.is_corner(a)));
}

#[test]
fn a_crease_of_more_steps_than_a_walk_takes_is_divided_and_no_part_is_lost() {
    // Two helices of which each is 400 long, and the rims of the half disks at their ends.
    let text = "max(x^2 + y^2 - 1, x*sin(100*z) - y*cos(100*z), abs(z) - 2)";
    let (_, found) = creases(text, 2.2);
    let step = 0.5 * Creases::width(&Bounds::cube(2.2));
    let longest = found.curves.iter().map(|curve| curve.points.len()).max();
    assert!(longest.is_some_and(|most| most > 2_000 && most <= trace::MOST_STEPS + 1), "{longest:?}");
    let exact = 2.0 * 400.0 + 2.0 * (core::f64::consts::PI + 2.0);
    let length: f64 = found.curves.iter().map(Crease::length).sum();
    assert!((length / exact - 1.0).abs() < 0.01, "{length} for {exact}");
    for curve in &found.curves {
        assert!(curve.corners.iter().all(Option::is_some), "an end at {:?}", curve.points.last());
        assert!(curve.chords().all(|[a, b]| a.distance(b) <= LONGEST * step));
    }
}

#[test]
fn creases_beyond_the_box_are_cut_at_its_faces() {
    for (text, half, [pieces, inside]) in [
        ("abs(x)+z", 1.0, [3, 1]),
        // A circle of radius √¾ around the x axis, which passes four faces twice.
        ("min((x-0.5)^2+y^2+z^2-1,(x+0.5)^2+y^2+z^2-1)", 0.8, [8, 4]),
        // Its creases do not run to the box.
        ("max(abs(x),abs(y),abs(z))-0.5", 0.8, [0, 0]),
    ] {
        let (field, own) = creases(text, half);
        let mut memory = ProbeMemory::default();
        let mut evaluator = field.evaluator(Frame::default());
        let probe = &mut Probe::new(&mut *evaluator, &mut memory);
        let bounds = Bounds::cube(half);
        let cut = own.beyond(probe, &bounds, &Bounds::cube(2.0 * half)).unwrap_or_default();
        let is_inside = |curve: &&Crease| bounds.holds(curve.points[curve.points.len() / 2]);
        let kept: Vec<&Crease> = cut.curves.iter().filter(is_inside).collect();
        assert_eq!([cut.curves.len(), kept.len()], [pieces, inside], "{text}");
        for corner in kept.iter().flat_map(|curve| curve.corners) {
            let Corner { position, .. } = cut.corners[corner.expect("an end on a face")];
            assert_eq!(position.as_vec3().abs().max_element(), bounds.single()[1].x, "{text}: {position}");
        }
        let [all, whole] =
            [&cut.curves, &own.curves].map(|curves| curves.iter().map(Crease::length).sum::<f64>());
        assert!(pieces == 0 || all > whole, "{text}: {all} after {whole}");
    }
}

#[test]
fn a_corner_at_the_tip_of_a_cone_has_a_normal() {
    let field = Formula::as_written("hypot(x, y) + z - 1", &[]).expect("a formula");
    let mut memory = ProbeMemory::default();
    let mut evaluator = field.evaluator(Frame::default());
    let probe = &mut Probe::new(&mut *evaluator, &mut memory);
    let ray = Vec3::new(1.0, 0.0, -1.0).normalize_or_zero();
    for (tangent, normal) in [
        (ray, Vec3::new(1.0, 0.0, 1.0)),
        (-ray, Vec3::new(-1.0, 0.0, 1.0)),
        (Vec3::ZERO, Vec3::new(1.0, 0.0, 1.0)),
    ] {
        let corner = fill::CreaseParticle { position: Vec3::Z, radius: 0.1, tangent, patches: Vec::new() };
        let found = corner.normal(probe).expect("a normal beside the tip");
        assert!(found.distance(normal.normalize_or_zero()) < 1e-6, "{found} along {tangent}");
    }
}
