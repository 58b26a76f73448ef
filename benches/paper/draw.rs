//! Pictures of particles: discs seen from far away, over a darker ground that hides what is behind.

use crate::runs::Set;
use glam::{Vec2, Vec3};
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

/// Samples of a pixel along each axis.
const SAMPLES: usize = 3;

/// Radius of a disc as drawn, over that of its particle, so that neighbours stay apart.
const SHOWN: f32 = 0.93;

/// The ground: discs this much wider, and so far below, in radii. Together they leave no gap
/// between neighbours.
const GROUND: [f32; 2] = [1.6, 0.3];

/// Contents and camera of a picture.
pub(crate) struct View {
    /// Middle of the picture.
    pub(crate) target: Vec3,
    /// Direction towards the eye.
    pub(crate) back: Vec3,
    pub(crate) up: Vec3,
    /// Half the side of what is seen.
    pub(crate) half: f32,
}

impl View {
    /// All of a set, seen from a direction, with `up` upwards.
    pub(crate) fn of(set: &Set, back: Vec3, up: Vec3) -> Self {
        let infinite = Vec3::splat(f32::INFINITY);
        let lo = set.position.iter().fold(infinite, |lo, &p| lo.min(p));
        let hi = set.position.iter().fold(-infinite, |hi, &p| hi.max(p));
        let mut view = Self { target: 0.5 * (lo + hi), back: back.normalize_or(Vec3::Z), up, half: 1.0 };
        let (right, up) = view.axes();
        let flat: Vec<Vec2> = set.position.iter().map(|&p| Vec2::new(p.dot(right), p.dot(up))).collect();
        let lo = flat.iter().copied().fold(Vec2::INFINITY, Vec2::min);
        let hi = flat.iter().copied().fold(Vec2::NEG_INFINITY, Vec2::max);
        let middle = 0.5 * (lo + hi) - Vec2::new(view.target.dot(right), view.target.dot(up));
        view.target += right * middle.x + up * middle.y;
        let most = set.radius.iter().copied().fold(0.0, f32::max);
        view.half = (0.5 * (hi - lo)).max_element() + 1.5 * most;
        view
    }

    fn axes(&self) -> (Vec3, Vec3) {
        let right = self.up.cross(self.back).normalize_or(Vec3::X);
        (right, self.back.cross(right))
    }
}

/// Colouring of a set.
#[derive(Clone, Copy)]
pub(crate) enum Colour {
    Plain,
    /// Each generation level in another colour.
    Level,
    /// By radius, from the smallest to the largest.
    Radius,
}

/// A hue of even lightness for a share of the circle, as linear light.
fn hue(share: f32) -> Vec3 {
    let turn = |offset: f32| 0.5 + 0.5 * (core::f32::consts::TAU * (share + offset)).cos();
    (Vec3::new(turn(0.0), turn(-1.0 / 3.0), turn(1.0 / 3.0)) * 0.62 + 0.14).powf(1.5)
}

impl Colour {
    fn all(self, set: &Set) -> Vec<Vec3> {
        let least = set.radius.iter().copied().fold(f32::INFINITY, f32::min);
        let most = set.radius.iter().copied().fold(0.0, f32::max);
        let of = |i: usize| match self {
            Self::Plain => Vec3::new(0.62, 0.67, 0.74),
            // The golden ratio tells neighbours apart.
            Self::Level => hue((0.618_034 * set.level[i] as f32).fract()),
            Self::Radius => hue(0.62 - 0.6 * ((set.radius[i] - least) / (most - least).max(1e-12))),
        };
        (0..set.position.len()).map(of).collect()
    }
}

/// A square picture: linear light and coverage of every sample.
struct Canvas {
    side: usize,
    depth: Vec<f32>,
    light: Vec<Vec3>,
}

impl Canvas {
    /// Draws a disc given in the view's axes, in samples.
    fn disc(&mut self, centre: Vec3, normal: Vec3, radius: f32, light: Vec3) {
        let last = self.side as f32 - 1.0;
        let range = |middle: f32| {
            let (first, end) = (middle - radius, middle + radius);
            (end >= 0.0 && first <= last).then(|| first.max(0.0).ceil() as usize..=end.min(last) as usize)
        };
        let (Some(columns), Some(rows)) = (range(centre.x), range(centre.y)) else { return };
        for y in rows {
            for x in columns.clone() {
                let flat = Vec2::new(x as f32, y as f32) - centre.truncate();
                let rise = -normal.truncate().dot(flat) / normal.z;
                if flat.length_squared() + rise * rise > radius * radius {
                    continue;
                }
                let (k, depth) = (y * self.side + x, centre.z + rise);
                if depth > self.depth[k] {
                    (self.depth[k], self.light[k]) = (depth, light);
                }
            }
        }
    }
}

/// Draws a set as a square of `side` pixels: red, green, blue and coverage of each, rows from the
/// top.
pub(crate) fn draw(set: &Set, view: &View, colour: Colour, side: usize) -> Vec<u8> {
    let samples = side * SAMPLES;
    let mut canvas = Canvas {
        side: samples,
        depth: vec![f32::NEG_INFINITY; samples * samples],
        light: vec![Vec3::ZERO; samples * samples],
    };
    let (right, up) = view.axes();
    let scale = 0.5 * samples as f32 / view.half;
    let half = 0.5 * samples as f32;
    let axes = |v: Vec3| Vec3::new(v.dot(right), -v.dot(up), v.dot(view.back));
    for (i, colour) in colour.all(set).into_iter().enumerate() {
        let normal = axes(set.normal[i]);
        // A disc seen from behind or from its edge.
        if normal.z < 0.02 {
            continue;
        }
        let centre = axes(set.position[i] - view.target) * scale + Vec3::new(half, half, 0.0);
        let radius = set.radius[i] * scale;
        // Light from above the left shoulder.
        let facing = axes_of_light().dot(normal).max(0.0);
        let light = colour * (0.32 + 0.68 * facing);
        canvas.disc(centre, normal, SHOWN * radius, light);
        let [wider, below] = GROUND;
        canvas.disc(centre - normal * (below * radius), normal, wider * radius, light * 0.22);
    }
    average(&canvas, side)
}

fn axes_of_light() -> Vec3 {
    Vec3::new(-0.35, -0.5, 0.79).normalize_or(Vec3::Z)
}

/// The pixels of a canvas.
fn average(canvas: &Canvas, side: usize) -> Vec<u8> {
    let mut pixels = Vec::with_capacity(4 * side * side);
    for y in 0..side {
        for x in 0..side {
            let (mut light, mut covered) = (Vec3::ZERO, 0.0);
            for k in 0..SAMPLES * SAMPLES {
                let at = (y * SAMPLES + k / SAMPLES) * canvas.side + x * SAMPLES + k % SAMPLES;
                if canvas.depth[at] > f32::NEG_INFINITY {
                    light += canvas.light[at];
                    covered += 1.0;
                }
            }
            let shown = (light / f32::max(covered, 1.0)).powf(1.0 / 2.2).clamp(Vec3::ZERO, Vec3::ONE);
            let coverage = covered / (SAMPLES * SAMPLES) as f32;
            pixels.extend(shown.extend(coverage).to_array().map(|share| (share * 255.0).round() as u8));
        }
    }
    pixels
}

/// Writes squares side by side, uncompressed: a line with width and height, then the pixels.
pub(crate) fn write_row(path: &Path, squares: &[Vec<u8>], side: usize) -> io::Result<()> {
    let mut out = io::BufWriter::new(File::create(path)?);
    writeln!(out, "{} {side}", side * squares.len())?;
    for y in 0..side {
        for square in squares {
            out.write_all(&square[4 * y * side..4 * (y + 1) * side])?;
        }
    }
    out.flush()
}
