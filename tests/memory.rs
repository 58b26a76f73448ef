//! Test of the memory that a run takes beyond its particles.
#![allow(unsafe_code, reason = "counting what is allocated takes an allocator")]

#[path = "it/settings.rs"]
#[macro_use]
mod settings;

use marching_particles::field::{Field, gallery};
use marching_particles::sampler::{Creases, Method, Sampler, Sampling, Settings, SettingsError, SizeMode};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The system's allocator, which counts the bytes in use and their peak.
struct Counting;

static USED: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let used = USED.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        PEAK.fetch_max(used, Ordering::Relaxed);
        // SAFETY: as promised by our own caller.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        USED.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as promised by our own caller.
        unsafe { System.dealloc(memory, layout) }
    }

    // The system grows a large block in place or moves its pages, so the old and the new block are
    // not both in use.
    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let used = USED.fetch_add(size, Ordering::Relaxed) + size - layout.size();
        USED.fetch_sub(layout.size(), Ordering::Relaxed);
        PEAK.fetch_max(used, Ordering::Relaxed);
        // SAFETY: as promised by our own caller.
        unsafe { System.realloc(memory, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Maximum number of bytes per particle beyond the output. The front takes them for the neighbour
/// lists, the grid and the reserve for a denser packing; the relaxation takes them for the lists,
/// the forces, the positions before the step and a smaller grid.
const MOST: f64 = 60.0;

/// The same for adaptive sampling, which also keeps the radii before the step and the displacements
/// since their last update.
const MOST_ADAPTIVE: f64 = 64.0;

/// The same for refined runs. While the particles of the last level are handed on, there are also
/// its mesh, with positions and normals of its own, the walk that orders them, and the level
/// before; where sizes differ, also those that are wanted.
const MOST_REFINED: f64 = 110.0;

/// How far what a run is expected to take may be off, in either direction.
const ESTIMATE: f64 = 0.1;

/// Bytes of a particle's columns: position, normal, radius, parent, level, slots.
const COLUMNS: usize = 12 + 12 + 4 + 4 + 4 + 4;

/// Number of particles of a run, and its peak memory in bytes.
fn peak_of(settings: Settings) -> (usize, usize) {
    let surface = gallery::find("ellipsoid").expect("the gallery has the ellipsoid");
    let field: Arc<dyn Field> = Arc::new(surface.field());
    let settings = settings!(max_particles: 4_000_000; ..settings);
    let before = USED.load(Ordering::Relaxed);
    PEAK.store(before, Ordering::Relaxed);
    let mut sampler = Sampler::default();
    let smooth = Some(Creases::default());
    sampler
        .begin(&field, glam::DVec3::ZERO, &surface.bounds, &settings, smooth)
        .expect("room for the particles");
    while sampler.step(65_536).stop_reason.is_none() {}
    (sampler.particles().len(), PEAK.load(Ordering::Relaxed) - before)
}

/// Holds the memory that a run is expected to take to what it does take, `bytes` per particle.
fn assert_expected(settings: Settings, bytes: f64) {
    let surface = gallery::find("ellipsoid").expect("the gallery has the ellipsoid");
    let field: Arc<dyn Field> = Arc::new(surface.field());
    let settings = settings!(size_mode: SizeMode::Count, count: 40_000; ..settings);
    for (limit, is_refused) in [(1.0 - ESTIMATE, true), (1.0 + ESTIMATE, false)] {
        let mut sampler = Sampler::default();
        sampler.limit_memory((f64::from(settings.count) * bytes * limit) as usize);
        let refused = matches!(
            sampler.begin(&field, glam::DVec3::ZERO, &surface.bounds, &settings, Some(Creases::default())),
            Err(SettingsError::Memory { particles: 40_000 })
        );
        assert_eq!(
            refused, is_refused,
            "with {limit} times the {bytes:.1} bytes that a particle takes: {settings:?}"
        );
    }
}

/// Bytes per particle beyond the output, in the worst of the runs. The memory of the survey, which
/// does not grow with the number of particles, cancels against that of the `small` run.
fn beyond(small: Settings, runs: &[Settings]) -> f64 {
    let (few, fixed) = peak_of(small);
    runs.iter().fold(0.0, |worst, &settings| {
        let (many, peak) = peak_of(settings);
        let beyond = (peak - fixed) as f64 / (many - few) as f64 - COLUMNS as f64;
        println!("{many} particles: {beyond:.1} bytes each beyond the {COLUMNS} of the output");
        beyond.max(worst)
    })
}

// This binary has one test, because the allocations of concurrent tests would be counted too.
#[test]
fn run_takes_few_bytes_per_particle_beyond_its_output_and_as_many_as_expected() {
    const RADII: [f64; 6] = [0.004, 0.0035, 0.003, 0.0025, 0.0022, 0.0019];
    const CHORD_ERRORS: [f64; 5] = [1.5e-5, 1e-5, 7e-6, 5e-6, 3.5e-6];
    for (method, most, most_adaptive) in
        [(Method::Front, MOST, MOST_ADAPTIVE), (Method::Refined, MOST_REFINED, MOST_REFINED)]
    {
        let uniform = |radius_share| settings!(method, radius_share; ..Settings::default());
        let adaptive = |chord_error| {
            settings!(method,
            sampling: Sampling::Adaptive,
            chord_error; ..Settings::default())
        };
        let worst = beyond(uniform(0.02), &RADII.map(uniform));
        assert!(worst <= most, "{worst:.1} bytes per particle, {method:?}");
        assert_expected(uniform(0.02), worst + COLUMNS as f64);
        let worst = beyond(adaptive(5e-4), &CHORD_ERRORS.map(adaptive));
        assert!(worst <= most_adaptive, "{worst:.1} bytes per adaptive particle, {method:?}");
        assert_expected(adaptive(5e-4), worst + COLUMNS as f64);
    }
}
