//! Clipping and surgery along the border are held to the invariants of the mesh and of the walls.

use super::super::net::{Ground, MovedBlock, Net, Springs};
use super::super::surgery::{Aim, Surgeon};
use super::super::tally::Tally;
use super::super::walls::{Planes, Walls};
use super::{clip, grown};
use crate::field::formula::Formula;
use crate::field::{Evaluator, Field, Frame};
use crate::math::{Bounds, NONE};
use crate::mesh::half_edge::HalfEdges;
use crate::particles::Slots;
use crate::sampler::probe::{Probe, ProbeMemory};
use glam::Vec3;
use proptest::prelude::*;

const SPACING: f32 = 0.2;

fn saddle() -> Formula {
    Formula::as_written("z = 0.3*x*y", &[]).expect("a formula")
}

/// A hexagonal grid over z = 0.3xy that reaches beyond the box, moved by `shift`.
fn grid(field: &mut dyn Evaluator, bounds: &Bounds, shift: [f32; 2]) -> Net {
    const COLUMNS: u32 = 22;
    let point = |k: u32| {
        let (i, j) = ((k % COLUMNS) as f32, (k / COLUMNS) as f32);
        let x = (i - 11.0 + 0.5 * (j % 2.0)) * SPACING + shift[0] * SPACING;
        let y = (j - 11.0) * 0.866 * SPACING + shift[1] * SPACING;
        Vec3::new(x, y, 0.3 * x * y)
    };
    let position: Vec<Vec3> = (0..COLUMNS * COLUMNS).map(point).collect();
    let (mut value, mut gradient) = (vec![0.0; position.len()], vec![Vec3::ZERO; position.len()]);
    field.gradients(&position, &mut value, &mut gradient);
    let squares = (0..COLUMNS - 1).flat_map(|j| (0..COLUMNS - 1).map(move |i| (i, j)));
    let triangles: Vec<[u32; 3]> = squares
        .flat_map(|(i, j)| {
            let a = j * COLUMNS + i;
            let (b, c, d) = (a + 1, a + COLUMNS, a + COLUMNS + 1);
            if j % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, b, d], [a, d, c]] }
        })
        .collect();
    let mut net = Net {
        mesh: HalfEdges::from_triangles(position.len(), &triangles).expect("a grid is a surface"),
        normal: gradient.iter().map(|g| g.normalize_or_zero()).collect(),
        slots: vec![Slots::default(); position.len()],
        size: Vec::new(),
        walls: Walls::new(bounds, &position, SPACING),
        on_crease: Vec::new(),
        is_born: Vec::new(),
        position,
    };
    // Formulas are moved to one side: which way is up depends on that.
    let mut tally = Tally::default();
    tally.inspect(&net, 0..triangles.len() as u32);
    if tally.inverted.is_some() {
        net.normal.iter_mut().for_each(|n| *n = -*n);
    }
    net
}

/// Holds a net to what the rest of the refinement relies on.
fn check(net: &Net, bounds: &Bounds) {
    net.mesh.check().expect("a manifold");
    assert_eq!(net.walls.planes.len(), net.position.len());
    for v in (0..net.position.len() as u32).filter(|&v| net.mesh.has_vertex(v)) {
        let (p, planes) = (net.position[v as usize], net.walls.planes(v));
        assert!(bounds.contains(p), "particle {v} at {p} is outside");
        assert_eq!(net.walls.pinned(p, planes), p, "particle {v} at {p} is off its planes");
        assert_eq!(net.mesh.is_border(v), !planes.is_inner(), "particle {v} at {p}: {planes:?}");
        assert!(!net.has_face_along_border(v), "particle {v} at {p} has a triangle along the border");
    }
    for h in net.mesh.edges().filter(|&h| net.mesh.twin(h) == NONE) {
        let [a, b] = [net.mesh.origin(h), net.mesh.target(h)].map(|v| net.walls.planes(v));
        assert!(!a.common(b).is_inner(), "a border edge runs between different planes");
    }
}

#[test]
fn the_box_of_a_coarse_front_is_three_spacings_larger() {
    let box_of_front = grown(&Bounds::cube(1.0), 0.1);
    assert!((box_of_front.max[0] - 1.6).abs() < 1e-12 && (box_of_front.min[2] + 1.6).abs() < 1e-12);
}

#[test]
fn a_frame_lies_in_a_box_that_single_precision_cannot_tell() {
    let bounds = Bounds { min: [0.1, -0.1, 1.0], max: [0.3, 0.7, 1.1] };
    let walls = Walls::new(&bounds, &[Vec3::ONE], 1.0);
    assert!(bounds.contains(walls.lo) && bounds.contains(walls.hi));
    let beyond = |x: f32, up: bool| if up { x.next_up() } else { x.next_down() };
    assert!(!bounds.contains(walls.lo.map(|x| beyond(x, false))));
    assert!(!bounds.contains(walls.hi.map(|x| beyond(x, true))));
}

#[test]
fn particles_slide_along_faces_and_corners_stay() {
    let walls = Walls::new(&Bounds::cube(1.0), &[Vec3::X], 0.1);
    let n = Vec3::new(0.6, 0.8, 0.0);
    let step = walls.along(Planes::of(1), n, Vec3::ONE);
    assert!(step.x == 0.0 && step.dot(n).abs() < 1e-6 && step.length() > 0.5, "{step}");
    assert_eq!(walls.along(Planes::of(1).joined(Planes::of(5)), n, Vec3::ONE), Vec3::ZERO);
    // The curve in the plane is where f = y − 0.25 vanishes.
    let landing = walls.landing(Planes::of(1), Vec3::new(1.0, 0.3, 0.2), 0.05, Vec3::Y, 0.1, false);
    assert_eq!(landing, Some(Vec3::new(1.0, 0.25, 0.2)));
    let too_far = walls.landing(Planes::of(1), Vec3::new(1.0, 0.3, 0.2), 0.05, Vec3::Y, 0.01, false);
    assert_eq!(too_far, None);
    let off_the_box = walls.landing(Planes::of(1), Vec3::new(1.0, 0.99, 0.2), -0.05, Vec3::Y, 0.1, false);
    assert_eq!(off_the_box, None);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn clipping_and_surgery_keep_the_invariants(
        shift in prop::array::uniform2(-0.5_f32..0.5),
        half in prop::array::uniform2(0.6_f64..1.3),
        places in prop::collection::vec((any::<u32>(), 0.7_f32..1.4), 1..40),
    ) {
        let bounds = Bounds::symmetric([half[0], half[1], 1.0]);
        let field = saddle();
        let field = &mut *field.evaluator(Frame::default());
        let mut net = grid(field, &bounds, shift);
        let mut block = MovedBlock::default();
        let mut memory = ProbeMemory::default();
        let mut probe = Probe::new(field, &mut memory);
        let mut ground = Ground { probe: &mut probe, block: &mut block };
        clip(&mut net, &mut ground, SPACING).expect("the saddle can be clipped");
        check(&net, &bounds);
        prop_assert_eq!(net.mesh.euler(), 1);
        let corners = |net: &Net| {
            let vertices = 0..net.position.len() as u32;
            vertices.filter(|&v| net.mesh.has_vertex(v) && net.walls.planes(v).is_corner()).count()
        };
        prop_assert_eq!(corners(&net), 4);

        let mut surgeon = Surgeon::default();
        for (place, size) in places {
            let springs = Springs { spacing: SPACING * size, theta: 0.8, omega: 1.5 };
            let faces = net.mesh.faces() as f32;
            let aim = Aim { springs, delta: 0.03, faces, loss: 0.0, stretch: 0.04 };
            let v = place % net.position.len() as u32;
            surgeon.mend(&mut net, &mut ground, aim, v);
            net.relax(&mut ground, springs, 0..v);
            net.flip(0..net.mesh.half_edge_slots() as u32);
        }
        check(&net, &bounds);
        prop_assert_eq!(net.mesh.euler(), 1);
        prop_assert_eq!(corners(&net), 4);

        // As if the particles were to be farther apart: most edges of the border are crowded.
        let far = 1.8 * SPACING;
        let crowded = |net: &Net| net.mesh.edges().filter(|&h| net.is_short_at_border(h, far)).count();
        let before = crowded(&net);
        prop_assert!(before > 0);
        net.thin(far);
        check(&net, &bounds);
        prop_assert_eq!(net.mesh.euler(), 1);
        prop_assert_eq!(corners(&net), 4);
        prop_assert!(crowded(&net) < before);
    }
}
