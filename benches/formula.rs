//! Benchmark of formula evaluation, by formula and kind of result, in points per second.
//!
//! `cargo bench -p benches --bench formula`

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use marching_particles::field::Sym3;
use marching_particles::field::formula::Formula;
use marching_particles::field::gallery;
use marching_particles::field::{Field, Frame};
use rand_core::Rng;
use std::hint::black_box;

/// Number of points in a batch, that of a large generation level.
const POINTS: usize = 4096;

fn field(id: &str) -> Formula {
    gallery::find(id).unwrap_or_else(|| panic!("no surface {id}")).field()
}

fn evaluation(criterion: &mut Criterion) {
    let mut random = rand_pcg::Pcg32::new(1, 2);
    let mut unit = || random.next_u32() as f32 / u32::MAX as f32 * 2.0 - 1.0;
    let points: Vec<Vec3> = (0..POINTS).map(|_| Vec3::new(unit(), unit(), unit())).collect();
    let mut value = vec![0.0; POINTS];
    let mut gradient = vec![Vec3::ZERO; POINTS];
    let mut hessian = vec![Sym3::default(); POINTS];
    let mut group = criterion.benchmark_group("formula");
    group.throughput(Throughput::Elements(POINTS as u64));
    group.sample_size(20);
    group.warm_up_time(std::time::Duration::from_millis(200));
    group.measurement_time(std::time::Duration::from_millis(600));
    for id in ["ellipsoid", "tanglecube", "barth-sextic", "gyroid"] {
        let field = field(id);
        let mut field = field.evaluator(Frame::default());
        group.bench_function(BenchmarkId::new("values", id), |bench| {
            bench.iter(|| field.values(black_box(&points), &mut value));
        });
        group.bench_function(BenchmarkId::new("gradients", id), |bench| {
            bench.iter(|| field.gradients(black_box(&points), &mut value, &mut gradient));
        });
        group.bench_function(BenchmarkId::new("hessians", id), |bench| {
            bench.iter(|| field.hessians(black_box(&points), &mut value, &mut gradient, &mut hessian));
        });
    }
    let text = gallery::find("barth-sextic").map_or("x", |surface| surface.formula);
    group.bench_function("parse/barth-sextic", |bench| {
        bench.iter(|| Formula::as_written(black_box(text), &[]));
    });
    group.finish();
}

criterion_group!(benches, evaluation);
criterion_main!(benches);
