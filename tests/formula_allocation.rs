//! Test that a warm evaluator does not allocate.
#![allow(unsafe_code, reason = "counting what is allocated takes an allocator")]

use glam::{DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::field::Sym3;
use marching_particles::field::gallery::SURFACES;
use marching_particles::field::{Enclosure, Field, Frame};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// The system's allocator, which counts the allocations of each thread.
struct Counting;

thread_local! {
    static CALLS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        CALLS.set(CALLS.get() + 1);
        // SAFETY: as promised by our own caller.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as promised by our own caller.
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_warm_evaluator_does_not_allocate() {
    let points: Vec<Vec3> = (0..777).map(|k| Vec3::new(0.001, 0.002, -0.001) * k as f32).collect();
    let mut value = vec![0.0; points.len()];
    let mut gradient = vec![Vec3::ZERO; points.len()];
    let mut hessian = vec![Sym3::default(); points.len()];
    let mut enclosure = [Enclosure::UNKNOWN];
    for surface in SURFACES.iter() {
        let field = surface.field();
        let mut field = field.evaluator(Frame::default());
        let mut work = || {
            field.values(&points, &mut value);
            field.gradients(&points, &mut value, &mut gradient);
            field.hessians(&points, &mut value, &mut gradient, &mut hessian);
            field.jet(DVec3::splat(0.3));
            field.bounded().expect("a formula has bounds").enclose(0, &[Bounds::cube(0.3)], &mut enclosure);
        };
        work();
        let before = CALLS.get();
        work();
        assert_eq!(CALLS.get() - before, 0, "{}", surface.id);
    }
}
