//! Measures the time of a frame of the page's first surface, natively: discs, spheres and the mesh.
//!
//! `cargo bench -p marching-particles-render --features vulkan --bench frames` draws 100,000
//! particles and a million; `-- COUNT…` draws other numbers. The executable needs only a Vulkan
//! driver.
#![allow(clippy::disallowed_methods, reason = "a bench measures time")]

#[path = "../tests/pictures/stage.rs"]
#[allow(dead_code, reason = "the pictures use the rest")]
mod stage;

use marching_particles::Bounds;
use marching_particles::{Run, Settings, gallery};
use marching_particles_render::style::{Drawing, Style};
use marching_particles_render::{OffScreen, Renderer};
use stage::{Camera, LEVELS, Shape, Theme, ramp};
use std::time::{Duration, Instant};

/// Numbers of particles.
const COUNTS: [u32; 2] = [100_000, 1_000_000];
/// Size of a frame in pixels, like the window of a notebook.
const SIZE: [u32; 2] = [1440, 900];
/// Frames before the measurement, in which pipelines are compiled and buffers created.
const UNTIMED: usize = 3;
/// Frames whose median is taken. After [`LONGEST`] fewer are enough, but at least [`LEAST`].
const FRAMES: usize = 100;
const LEAST: usize = 5;
const LONGEST: Duration = Duration::from_secs(10);

/// The sampled surface, with its mesh.
fn sampled(count: u32) -> (Shape, Bounds) {
    let surface = gallery::find("ellipsoid").expect("the gallery has the ellipsoid");
    let mut settings = Settings::with_count(count).in_box(surface.bounds);
    settings.max_particles = count + count / 10;
    let mut run = Run::start(surface.field(), &settings).expect("valid settings");
    while run.step(1 << 16).stop_reason.is_none() {}
    while run.join(1 << 16).is_none() {}
    let particles = run.particles();
    let last = f64::from(particles.level.iter().copied().max().unwrap_or(1));
    let shape = Shape {
        positions: particles.local.iter().map(|p| p.to_array()).collect(),
        normals: particles.normal.iter().map(|n| n.to_array()).collect(),
        radii: particles.radius.clone(),
        levels: particles.level.clone(),
        colours: particles.level.iter().map(|&level| ramp(&LEVELS, f64::from(level) / last)).collect(),
        faces: run.triangles().to_vec(),
    };
    (shape, surface.bounds)
}

/// Draws frames. Returns their number and the median seconds per frame: on the device, if it has a
/// clock, and in total until the frame is drawn, including the processor's work.
fn times(off_screen: &mut OffScreen, renderer: &mut Renderer) -> (usize, Option<f64>, f64) {
    for _ in 0..UNTIMED {
        off_screen.draw(renderer, 0.0);
    }
    let (mut of_device, mut whole) = (Vec::new(), Vec::new());
    let begun = Instant::now();
    while whole.len() < FRAMES && (whole.len() < LEAST || begun.elapsed() < LONGEST) {
        let frame = Instant::now();
        of_device.extend(off_screen.draw(renderer, 0.0));
        whole.push(frame.elapsed().as_secs_f64());
    }
    let median = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 2).copied()
    };
    (whole.len(), median(of_device), median(whole).expect("frames were drawn"))
}

fn main() {
    // cargo bench passes options of its own.
    let asked: Vec<u32> = std::env::args().skip(1).filter_map(|argument| argument.parse().ok()).collect();
    let counts = if asked.is_empty() { COUNTS.to_vec() } else { asked };
    let (mut off_screen, mut renderer) = stage::open(SIZE);
    println!("median times of a frame of {} × {} pixels, in ms\n", SIZE[0], SIZE[1]);
    println!("| particles | drawn as | on the device | until drawn | frames |");
    println!("|--:|---|--:|--:|--:|");
    for count in counts {
        let (shape, bounds) = sampled(count);
        let style = Theme::Light.style(bounds, false);
        renderer.set_view(Camera { distance: 4.0, ..Camera::HOME }.view(SIZE, bounds.diagonal() / 2.0));
        shape.write(&mut renderer, f64::NEG_INFINITY);
        renderer.set_faces(0, 0);
        let drawings = [
            ("discs", style.clone()),
            ("spheres", Style { spheres: true, disc_scale: 1.0, dim_backfaces: 0.5, ..style.clone() }),
            (
                "mesh",
                Style {
                    drawing: Drawing::Faces { flat: false, edge_px: 1.0 },
                    dim_backfaces: 0.25,
                    ..style.clone()
                },
            ),
        ];
        for (name, style) in drawings {
            if style.drawing != Drawing::Discs {
                shape.write_faces(&mut renderer, 0, 0);
            }
            renderer.set_style(style);
            let (frames, of_device, whole) = times(&mut off_screen, &mut renderer);
            let of_device = of_device.map_or("no clock".to_owned(), |time| format!("{:.2}", 1e3 * time));
            println!("| {} | {name} | {of_device} | {:.2} | {frames} |", shape.count(), 1e3 * whole);
        }
    }
}
