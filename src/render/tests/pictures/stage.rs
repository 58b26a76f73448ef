//! The stage of the pictures: a device, a camera, the page's look, and shapes to draw.

use glam::DVec3;
use glam::dcamera::rh::{proj::directx, view::look_to_mat4};
use marching_particles::Bounds;
use marching_particles_render::style::{BodyStyle, Style};
use marching_particles_render::view::View;
use marching_particles_render::{Callbacks, Columns, OffScreen, Renderer};
use std::ops::Range;
use std::sync::Arc;

/// Opens a device and a texture of this size.
///
/// # Panics
///
/// If there is no Vulkan driver, with what to install.
pub(crate) fn open(size: [u32; 2]) -> (OffScreen, Renderer) {
    let callbacks = Callbacks {
        on_lost: Arc::new(|reason, message| eprintln!("the graphics device is lost: {reason}, {message}")),
        on_error: Arc::new(|message| panic!("the graphics device refused a call: {message}")),
    };
    let opened = pollster::block_on(OffScreen::open(size, callbacks));
    let (off_screen, renderer) = opened.unwrap_or_else(|error| {
        panic!(
            "No picture can be drawn on this machine: {error}.\nInstall a Vulkan driver: that of the graphics \
             card, or Debian's package mesa-vulkan-drivers, which needs none."
        )
    });
    println!("drawn by {} ({})", renderer.adapter(), renderer.backend());
    (off_screen, renderer)
}

/// A camera that orbits a target, as that of the page: z is up.
#[derive(Clone, Copy)]
pub(crate) struct Camera {
    pub(crate) target: [f64; 3],
    pub(crate) distance: f64,
    pub(crate) yaw_rad: f64,
    pub(crate) pitch_rad: f64,
    pub(crate) is_parallel: bool,
}

/// Angle of view from top to bottom.
const FIELD_OF_VIEW_RAD: f64 = 30.0 * std::f64::consts::PI / 180.0;

impl Camera {
    /// The page's first camera.
    pub(crate) const HOME: Self =
        Self { target: [0.0; 3], distance: 5.0, yaw_rad: 0.62, pitch_rad: 0.42, is_parallel: false };

    /// The camera for a picture of this size. `radius` is that of a ball around the origin in which
    /// everything lies.
    pub(crate) fn view(self, size: [u32; 2], radius: f64) -> View {
        let (target, distance) = (DVec3::from(self.target), self.distance);
        let ((sy, cy), (sp, cp)) = (libm::sincos(self.yaw_rad), libm::sincos(self.pitch_rad));
        let forward = -DVec3::new(cy * cp, sy * cp, sp);
        let eye = target - forward * distance;
        let depth = -eye.dot(forward);
        let (near, far) = ((depth - radius).max(1e-3 * (depth + radius)), depth + radius);
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        let half = distance * libm::tan(0.5 * FIELD_OF_VIEW_RAD);
        let clip_from_view = if self.is_parallel {
            directx::orthographic(-half * aspect, half * aspect, -half, half, near, far)
        } else {
            directx::perspective(FIELD_OF_VIEW_RAD, aspect, near, far)
        };
        let clip_from_world = clip_from_view * look_to_mat4(eye, forward, DVec3::Z);
        View {
            clip_from_world: clip_from_world.as_mat4().to_cols_array(),
            eye: eye.as_vec3().to_array(),
            direction: forward.as_vec3().to_array(),
        }
    }
}

/// Theme of the page.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Theme {
    Light,
    Dark,
}

impl Theme {
    /// The look of the page's first picture: discs on a body that takes light from itself.
    pub(crate) fn style(self, bounds: Bounds, is_open: bool) -> Style {
        let (background, body, occlusion) = match self {
            Self::Light => ([0.966, 0.968, 0.972], [0.57, 0.64, 0.69], 0.65),
            Self::Dark => ([0.067, 0.072, 0.078], [0.33, 0.40, 0.46], 0.8),
        };
        let bounds = [bounds.lo(), bounds.hi()].map(|corner| corner.as_vec3().to_array());
        let [r, g, b] = background;
        Style {
            background: [r, g, b, 1.0],
            body: Some(BodyStyle { colour: body, is_open, bounds }),
            occlusion,
            warmth: 0.12,
            ..Style::default()
        }
    }
}

/// Particles with their colours, and faces between them.
#[derive(Clone, Default)]
pub(crate) struct Shape {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) normals: Vec<[f32; 3]>,
    pub(crate) radii: Vec<f32>,
    pub(crate) levels: Vec<u32>,
    pub(crate) colours: Vec<u32>,
    pub(crate) faces: Vec<[u32; 3]>,
}

/// Faces that are written at a time, like on the page.
const SLICE: usize = 1 << 15;

impl Shape {
    /// Number of particles.
    pub(crate) fn count(&self) -> u32 {
        self.radii.len() as u32
    }

    /// Draws these particles from now on, and all of them as the body. They begin to appear at
    /// `birth_s`.
    pub(crate) fn write(&self, renderer: &mut Renderer, birth_s: f64) {
        self.write_rows(renderer, 0..self.count(), birth_s);
        renderer.set_count(self.count(), self.count());
    }

    /// Writes these particles, which begin to appear at `birth_s`.
    pub(crate) fn write_rows(&self, renderer: &mut Renderer, rows: Range<u32>, birth_s: f64) {
        let first = rows.start;
        let rows = rows.start as usize..rows.end as usize;
        let columns = Columns {
            positions: self.positions[rows.clone()].as_flattened(),
            normals: self.normals[rows.clone()].as_flattened(),
            radii: &self.radii[rows.clone()],
            levels: &self.levels[rows.clone()],
            colours: &self.colours[rows],
        };
        renderer.write(first, columns, birth_s);
    }

    /// Draws these faces from now on, in the place of the particles, with marks of this colour on
    /// the first `marked` particles.
    pub(crate) fn write_faces(&self, renderer: &mut Renderer, marked: u32, mark: u32) {
        for (slice, faces) in self.faces.chunks(SLICE).enumerate() {
            let mut corners = Self::default();
            let mut marks = Vec::new();
            for row in faces.as_flattened().iter().map(|&row| row as usize) {
                corners.positions.push(self.positions[row]);
                corners.normals.push(self.normals[row]);
                corners.radii.push(self.radii[row]);
                corners.levels.push(self.levels[row]);
                corners.colours.push(self.colours[row]);
                marks.push(if row < marked as usize { mark } else { 0 });
            }
            let Self { positions, normals, radii, levels, colours, .. } = &corners;
            let (positions, normals) = (positions.as_flattened(), normals.as_flattened());
            let columns = Columns { positions, normals, radii, levels, colours };
            renderer.write_faces((slice * SLICE) as u32, columns, &marks);
        }
        renderer.set_faces(self.faces.len() as u32, self.count());
    }
}

/// A colour, sRGB with components from 0 to 1, as 0xAABBGGRR.
pub(crate) fn packed(colour: [f64; 3]) -> u32 {
    let [r, g, b] = colour.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u32);
    0xff00_0000 | b << 16 | g << 8 | r
}

/// Colour at a place from 0 to 1 on a ramp of colours at equal distances.
pub(crate) fn ramp(stops: &[[f64; 3]], place: f64) -> u32 {
    let place = place.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
    let k = (place as usize).min(stops.len() - 2);
    let share = place - k as f64;
    packed(std::array::from_fn(|c| stops[k][c] + share * (stops[k + 1][c] - stops[k][c])))
}

/// From blue through teal to sand, for levels.
pub(crate) const LEVELS: [[f64; 3]; 4] =
    [[0.55, 0.68, 0.95], [0.42, 0.74, 0.82], [0.52, 0.80, 0.62], [0.86, 0.80, 0.60]];
