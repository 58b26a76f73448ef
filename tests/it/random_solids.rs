//! Random solids: bodies with centres on a grid, so that they touch, cut and cross each other in
//! special places, sampled and joined to a mesh.

use crate::cases;
use crate::fuzz::{below, harness};
use marching_particles::Bounds;
use marching_particles::Warning;
use marching_particles::internal::session::{BoxFaces, FieldRequest, Session, SolidSettings};
use marching_particles::mesh::Topology;
use marching_particles::sampler::{Method, Sampling, Settings};
use rand_core::SeedableRng;
use rand_pcg::Pcg32;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

fn one_of<T: Copy>(random: &mut Pcg32, choices: &[T]) -> T {
    choices[below(random, choices.len())]
}

/// A body along any axis.
fn body(random: &mut Pcg32) -> String {
    let mut axes = ["x", "y", "z"];
    axes.rotate_left(below(random, 3));
    let [u, v, w] = axes.map(|axis| match one_of(random, &["", "", "", "-0.5", "+0.5", "-1", "+1"]) {
        "" => axis.to_owned(),
        offset => format!("({axis}{offset})"),
    });
    let size = one_of(random, &["0.5", "1"]);
    match below(random, 9) {
        0 => format!("({u}^2+{v}^2+{w}^2-{size})"),
        1 => format!("(max(abs({u}),abs({v}),abs({w}))-{size})"),
        2 => format!("max(hypot({u},{v})-{size},abs({w})-0.5)"),
        3 => format!("({u}{})", one_of(random, &["", "-0.25", "+0.25"])),
        4 => format!("(abs({u})+abs({v})+abs({w})-{size})"),
        5 => format!("max(hypot({u},{v})-({size}-{w}),-{w})"),
        6 => format!("(hypot({u},{v})-abs({w}))"),
        7 => format!("((hypot({u},{v})-{size})^2+{w}^2-1/16)"),
        _ => format!("({u}*{v}-{w})"),
    }
}

/// A body, or two solids joined.
fn solid(random: &mut Pcg32, depth: usize) -> String {
    if depth == 0 {
        return body(random);
    }
    let rest = below(random, depth);
    let [a, b] = [depth - 1, rest].map(|depth| solid(random, depth));
    match below(random, 8) {
        0 | 1 => format!("min({a},{b})"),
        2 | 3 => format!("max({a},{b})"),
        4 => format!("max({a},-{b})"),
        5 => format!("{a}*{b}"),
        6 => format!("smin({a},{b},0.25)"),
        _ => format!("(abs({a})-0.125)"),
    }
}

/// Samples and joins a random solid, and checks what there is of it. Returns whether all of its
/// particles are joined to one oriented surface.
fn check(seed: u64) -> bool {
    let mut random = Pcg32::seed_from_u64(seed);
    let depth = 1 + below(&mut random, 3);
    let formula = solid(&mut random, depth);
    let uneven = Bounds { min: [0.0, -2.0, -1.0], max: [2.0, 2.0, 1.0] };
    let boxes = [None, Some(Bounds::cube(0.5)), Some(Bounds::cube(1.0)), Some(uneven)];
    let bounds = one_of(&mut random, &boxes);
    let choice = SolidSettings {
        box_faces: one_of(&mut random, &[BoxFaces::Open, BoxFaces::Closed]),
        thickness: one_of(&mut random, &[0.0, 0.0, 0.0, 0.1]).into(),
        ..SolidSettings::default()
    };
    let settings = settings!(radius_share: one_of(&mut random, &[0.02, 0.05]),
        sampling: one_of(&mut random, &[Sampling::Uniform, Sampling::Adaptive]),
        method: one_of(&mut random, &[Method::Front, Method::Refined]),
        relax_steps: one_of(&mut random, &[0, 2]),
        chord_error: 1e-3,
        radius_min_share: 0.01,
        max_particles: 1_500,
        seed; ..Settings::default());
    println!("{seed}: {formula} {bounds:?} {choice:?} {settings:?}");
    let mut session = Session::new();
    session.choose(choice).expect("a thickness in its range");
    let request = FieldRequest { formula: Some(formula), bounds, ..FieldRequest::default() };
    if harness::run(&mut session, &request, &settings, 20_000).is_none() {
        return false;
    }
    while session.run.join(u32::MAX).is_none() {}
    let warnings = session.report().warnings;
    let (run, mut field) = (&session.run, session.run.evaluator());
    let particles = run.particles();
    // Where f touches zero, both sides of the surface are sampled.
    let is_double = warnings.contains(&Warning::Touches);
    let mut at: BTreeMap<[u32; 3], usize> = BTreeMap::new();
    for (i, residual) in run.measured().residual.iter().enumerate() {
        let (place, first) = (particles.place(i), particles.first_row(i));
        let known = *at.entry(particles.local[i].to_array().map(f32::to_bits)).or_insert(first);
        assert!(known == first || is_double, "two particles at {place}: {warnings:?}");
        assert!(run.bounds().holds(place), "{place} is not in {:?}", run.bounds());
        let value = field.on(particles.patch_of(i)).value_and_gradient(particles.local[i].as_dvec3()).0;
        assert!(!value.is_finite() || residual.is_finite(), "{residual} at {place}, where f is {value}");
    }
    // The mesh of each patch is a manifold, also where patches cross or touch.
    let mesh = run.mesh().expect("a mesh");
    let crowded = Topology::new(mesh.corners(), particles.len()).crowded_edges;
    assert_eq!(crowded, [[0; 2]; 0], "two triangles on a side of an edge: {warnings:?}");
    Topology::new(&mesh.triangles, particles.len()).crowded_edges.is_empty()
        && !warnings.iter().any(|warning| matches!(warning, Warning::Open { .. }))
}

#[test]
fn random_solids_have_whole_particles_and_meshes_of_surfaces() {
    const ALL: u64 = 24;
    /// The share that was usual when the test was written.
    const WHOLE: f64 = 0.6;
    let (mut failed, mut whole) = (Vec::new(), 0);
    for seed in cases::seeds(ALL) {
        match catch_unwind(AssertUnwindSafe(|| check(seed))) {
            Ok(is_whole) => whole += u64::from(is_whole),
            Err(_) => failed.push(seed),
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
    cases::assert_share(whole, cases::count(ALL), WHOLE, "whole solids");
}
