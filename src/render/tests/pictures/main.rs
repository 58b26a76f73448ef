//! Pictures of the renderer, drawn natively and compared with kept ones.
//!
//! `cargo test -p marching-particles-render --features vulkan --test pictures -- --nocapture`
//! prints how far each is from the one that is kept, and writes what was drawn to
//! `target/tmp/pictures`. `UPDATE_GOLDEN=1` keeps what is drawn, after a change that is meant to
//! alter it. Where the executable runs without its sources, `PICTURES_KEPT` and `PICTURES_DRAWN`
//! name the two folders.

mod shapes;
mod stage;

use glam::DVec3;
use marching_particles::Bounds;
use marching_particles_render::style::{ClipBoxStyle, CuttingPlane, Drawing, Style};
use marching_particles_render::{OffScreen, Renderer};
use shapes::{cube, sphere, torus, torus_by_curvature};
use stage::{Camera, Shape, Theme, packed};
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Size of the pictures in pixels.
const SIZE: [u32; 2] = [400, 300];
/// Radius of a ball around the origin in which all shapes lie.
const BALL: f64 = 1.8;

/// What is set before a picture is drawn.
struct State {
    shape: Shape,
    style: Style,
    camera: Camera,
    is_transparent: bool,
    /// What else is written.
    more: fn(&State, &mut Renderer),
}

impl State {
    /// A shape as the page shows it first.
    fn new(shape: Shape, theme: Theme) -> Self {
        let style = theme.style(bounds(), false);
        Self { shape, style, camera: Camera::HOME, is_transparent: false, more: |_, _| () }
    }

    fn styled(mut self, change: fn(&mut Style)) -> Self {
        change(&mut self.style);
        self
    }

    /// Draws the picture and returns its pixels.
    fn draw(&self, off_screen: &OffScreen, renderer: &mut Renderer) -> Vec<u8> {
        self.shape.write(renderer, f64::NEG_INFINITY);
        renderer.set_faces(0, 0);
        renderer.write_lines(&[], &[]);
        renderer.set_style(self.style.clone());
        renderer.set_view(self.camera.view(SIZE, BALL));
        (self.more)(self, renderer);
        off_screen.read(renderer, self.is_transparent, 0.0).expect("the device is not lost")
    }
}

/// The box of all shapes.
fn bounds() -> Bounds {
    Bounds::new(DVec3::splat(-1.6), DVec3::splat(1.6))
}

/// Writes the faces of a shape, drawn instead of particles, and a few marks.
fn write_faces(state: &State, renderer: &mut Renderer) {
    state.shape.write_faces(renderer, 12, packed([0.85, 0.15, 0.1]));
}

/// The states, with the names of their pictures.
fn states() -> Vec<(&'static str, State)> {
    let light = |shape| State::new(shape, Theme::Light);
    let dark = |shape| State::new(shape, Theme::Dark);
    vec![
        ("discs", light(sphere(1_500))),
        (
            // The second half appears, a sixth of it after the other.
            "appearing",
            State {
                more: |state, renderer| {
                    let (count, fade_s) = (state.shape.count(), f64::from(state.style.fade_s));
                    for k in 0..6 {
                        let rows = count / 2 + k * count / 12..count;
                        state.shape.write_rows(renderer, rows, fade_s * (f64::from(k) / 5.0 - 1.0));
                    }
                    renderer.set_count(count, 0);
                },
                ..light(sphere(1_500))
            },
        ),
        ("spheres", light(torus(56)).styled(|style| (style.spheres, style.disc_scale) = (true, 1.0))),
        ("levels", light(torus(56)).styled(|style| style.level = Some(9))),
        ("curvature", dark(torus_by_curvature(56))),
        (
            "mesh",
            State { more: write_faces, ..light(torus_by_curvature(48)) }.styled(|style| {
                style.drawing = Drawing::Faces { flat: false, edge_px: 1.0 };
                style.dim_backfaces = 0.25;
            }),
        ),
        (
            "cut-mesh",
            State { more: write_faces, ..dark(torus(48)) }.styled(|style| {
                style.drawing = Drawing::Faces { flat: true, edge_px: 0.0 };
                style.dim_backfaces = 0.25;
                style.plane = Some(CuttingPlane { normal: [0.6, 0.4, 0.7], offset: 0.2 });
            }),
        ),
        (
            "creases",
            State {
                more: |_, renderer| {
                    let (_, ends) = cube(15);
                    renderer.write_lines(&ends, &vec![packed([0.3; 3]); ends.len() / 8]);
                },
                camera: Camera { distance: 6.5, ..Camera::HOME },
                ..light(cube(15).0)
            },
        ),
        (
            "cut",
            light(sphere(1_500)).styled(|style| {
                style.plane = Some(CuttingPlane { normal: [1.0, 0.3, 0.2], offset: 0.36 });
                let (min, max) = ([-1.3; 3], [1.3; 3]);
                style.clip_box = Some(ClipBoxStyle { min, max, colour: [0.5, 0.5, 0.52, 0.9] });
            }),
        ),
        (
            // The sixth part of the run: the body shows what is still to come.
            "partly-grown",
            State {
                more: |state, renderer| renderer.set_count(state.shape.count() / 6, state.shape.count()),
                ..dark(torus(56))
            },
        ),
        (
            "inside",
            State {
                style: Theme::Light.style(bounds(), true),
                camera: Camera { target: [0.0, 0.0, -0.3], pitch_rad: 0.95, ..Camera::HOME },
                ..light(sphere(1_800).below(0.5))
            },
        ),
        ("points", light(sphere(60_000)).styled(|style| (style.body, style.occlusion) = (None, 0.0))),
        // More than one chunk of records.
        ("many", light(sphere(300_000))),
        (
            "marked",
            State { camera: Camera { is_parallel: true, ..Camera::HOME }, ..dark(sphere(400)) }
                .styled(|style| (style.outline, style.dim) = (Some(3), 0.4)),
        ),
        ("transparent", State { is_transparent: true, ..light(torus(40)) }),
    ]
}

/// The difference between two pictures, in steps of 255. Drivers place edges differently by a part
/// of a pixel, which cancels out in the mean of a block; a light, a colour or a radius changes it.
#[derive(Clone, Copy, Debug)]
struct Difference {
    /// Mean over all pixels and channels.
    pixels: f64,
    /// Mean over all blocks, of their means.
    blocks: f64,
    /// That of the block and channel which differ most.
    worst: f64,
}

impl Difference {
    /// Pixels of a block each way.
    const BLOCK: usize = 20;
    /// The largest difference at which two pictures count as equal. The software drivers Mesa
    /// (LLVM) and SwiftShader differ by 0.33, 0.13 and 1.9; the second test has changes that are
    /// larger.
    const MOST: Self = Self { pixels: 0.6, blocks: 0.2, worst: 4.0 };

    fn between(a: &[u8], b: &[u8]) -> Self {
        let [width, height] = SIZE.map(|side| side as usize);
        assert_eq!([a.len(), b.len()], [4 * width * height; 2], "bytes of the pictures");
        let across = width / Self::BLOCK;
        let mut sums = vec![[0_i32; 4]; across * (height / Self::BLOCK)];
        let mut sum = 0_u64;
        for (k, (a, b)) in a.iter().zip(b).enumerate() {
            let (x, y) = (k / 4 % width / Self::BLOCK, k / 4 / width / Self::BLOCK);
            sums[y * across + x][k % 4] += i32::from(*a) - i32::from(*b);
            sum += u64::from(a.abs_diff(*b));
        }
        let apart = || sums.as_flattened().iter().map(|sum| f64::from(sum.abs()));
        let area = (Self::BLOCK * Self::BLOCK) as f64;
        Self {
            pixels: sum as f64 / a.len() as f64,
            blocks: apart().sum::<f64>() / a.len() as f64,
            worst: apart().fold(0.0, f64::max) / area,
        }
    }

    fn is_small(self) -> bool {
        let Self { pixels, blocks, worst } = Self::MOST;
        self.pixels <= pixels && self.blocks <= blocks && self.worst <= worst
    }
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { pixels, blocks, worst } = self;
        write!(f, "pixels {pixels:.3}, blocks {blocks:.3}, worst block {worst:.2}")
    }
}

/// A folder that the environment names, or else this one.
fn folder(variable: &str, or: &[&str]) -> PathBuf {
    std::env::var_os(variable).map_or_else(|| or.iter().collect(), PathBuf::from)
}

fn write(file: &Path, pixels: &[u8]) {
    let file =
        File::create(file).unwrap_or_else(|error| panic!("could not write {}: {error}", file.display()));
    let mut encoder = png::Encoder::new(file, SIZE[0], SIZE[1]);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().expect("a picture can be written");
    writer.write_image_data(pixels).expect("a picture can be written");
}

fn read(file: &Path) -> Vec<u8> {
    let faulty = |error: &dyn std::fmt::Display| -> ! {
        panic!(
            "{}: {error}. UPDATE_GOLDEN=1 cargo test -p marching-particles-render --features vulkan --test pictures writes it",
            file.display()
        )
    };
    let open = File::open(file).unwrap_or_else(|error| faulty(&error));
    let mut reader =
        png::Decoder::new(BufReader::new(open)).read_info().unwrap_or_else(|error| faulty(&error));
    let mut pixels = vec![0; (4 * SIZE[0] * SIZE[1]) as usize];
    let info = reader.next_frame(&mut pixels).unwrap_or_else(|error| faulty(&error));
    assert_eq!([info.width, info.height], SIZE, "size of {}", file.display());
    pixels
}

#[test]
fn pictures_are_as_they_were_kept() {
    let kept = folder("PICTURES_KEPT", &[env!("CARGO_MANIFEST_DIR"), "tests/pictures/kept"]);
    let drawn = folder("PICTURES_DRAWN", &[env!("CARGO_TARGET_TMPDIR"), "pictures"]);
    let is_update = std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1");
    let into = if is_update { &kept } else { &drawn };
    fs::create_dir_all(into).unwrap_or_else(|error| panic!("could not make {}: {error}", into.display()));
    let (off_screen, mut renderer) = stage::open(SIZE);
    let mut faults = Vec::new();
    for (name, state) in states() {
        let file = format!("{name}.png");
        let pixels = state.draw(&off_screen, &mut renderer);
        write(&into.join(&file), &pixels);
        if is_update {
            continue;
        }
        let difference = Difference::between(&pixels, &read(&kept.join(&file)));
        println!("{name}: {difference}");
        if !difference.is_small() {
            faults.push(format!("{name}: {difference}"));
        }
    }
    assert!(
        faults.is_empty(),
        "\nThese pictures of {} differ from those in {}:\n{}\nIf that was meant: UPDATE_GOLDEN=1 cargo test \
         --features vulkan --test pictures\n",
        drawn.display(),
        kept.display(),
        faults.join("\n")
    );
}

/// The tolerance is smaller than what a change of a light, a ramp or a radius does.
#[test]
fn a_small_change_is_told_from_none() {
    let (off_screen, mut renderer) = stage::open(SIZE);
    let mut told = |what: &str, name: &str, change: fn(&mut State)| {
        let mut state = states().into_iter().find(|state| state.0 == name).expect("a state of this name").1;
        let unchanged = state.draw(&off_screen, &mut renderer);
        change(&mut state);
        let difference = Difference::between(&unchanged, &state.draw(&off_screen, &mut renderer));
        println!("{what}: {difference}");
        assert_eq!(difference.is_small(), what == "nothing", "{what}: {difference}");
    };
    told("nothing", "inside", |_| ());
    told("the key light, turned by 2°", "discs", |state| state.style.key_light_view = [-0.48, 0.72, 0.58]);
    told("three quarters of the occlusion", "inside", |state| state.style.occlusion *= 0.75);
    told("half of the warmth", "discs", |state| state.style.warmth *= 0.5);
    told("a radius larger by 2 %", "discs", |state| state.style.disc_scale *= 1.02);
    told("colours darker by a hundredth", "levels", |state| {
        for colour in &mut state.shape.colours {
            *colour = packed([0, 8, 16].map(|shift| f64::from(*colour >> shift & 255) / 255.0 - 0.01));
        }
    });
    told("the camera, turned by half a degree", "mesh", |state| {
        state.camera.yaw_rad += 0.5 * std::f64::consts::PI / 180.0;
    });
    told("no ring", "marked", |state| state.style.outline = None);
    told("no edges of the box", "cut", |state| state.style.clip_box = None);
}
