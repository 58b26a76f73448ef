//! Shapes in closed form, so that no change of the sampler changes a picture.

use crate::stage::{LEVELS, Shape, ramp};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// From blue over grey to orange, for numbers that are negative or positive.
const SIGNED: [[f64; 3]; 3] = [[0.15, 0.40, 0.75], [0.80, 0.80, 0.80], [0.80, 0.35, 0.10]];

impl Shape {
    /// Adds a particle, which gets its colour from [`Shape::colour_by_level`].
    fn push(&mut self, position: DVec3, normal: DVec3, radius: f64, level: u32) {
        self.positions.push(position.as_vec3().to_array());
        self.normals.push(normal.as_vec3().to_array());
        self.radii.push(radius as f32);
        self.levels.push(level);
        self.colours.push(0);
    }

    /// Sorts the particles by level, as a front places them, and colours them by it.
    fn in_levels(mut self) -> Self {
        let mut order: Vec<usize> = (0..self.radii.len()).collect();
        order.sort_by_key(|&row| self.levels[row]);
        let mut places = vec![0; order.len()];
        for (place, &row) in (0..).zip(&order) {
            places[row] = place;
        }
        let last = f64::from(self.levels.iter().copied().max().unwrap_or(1));
        self.positions = order.iter().map(|&row| self.positions[row]).collect();
        self.normals = order.iter().map(|&row| self.normals[row]).collect();
        self.radii = order.iter().map(|&row| self.radii[row]).collect();
        self.levels = order.iter().map(|&row| self.levels[row]).collect();
        self.colours = self.levels.iter().map(|&level| ramp(&LEVELS, f64::from(level) / last)).collect();
        for row in self.faces.as_flattened_mut() {
            *row = places[*row as usize];
        }
        self
    }

    /// The particles that lie below a height.
    pub(crate) fn below(mut self, height: f32) -> Self {
        let kept: Vec<usize> = (0..self.radii.len()).filter(|&row| self.positions[row][2] < height).collect();
        self.positions = kept.iter().map(|&row| self.positions[row]).collect();
        self.normals = kept.iter().map(|&row| self.normals[row]).collect();
        self.radii = kept.iter().map(|&row| self.radii[row]).collect();
        self.levels = kept.iter().map(|&row| self.levels[row]).collect();
        self.colours = kept.iter().map(|&row| self.colours[row]).collect();
        self.faces = Vec::new();
        self
    }
}

/// Radius of the sphere.
const SPHERE: f64 = 1.2;

/// A sphere: the spiral of Fibonacci, which is even (R. Swinbank, R. J. Purser, "Fibonacci
/// grids", 2006). The front starts in the direction of the eye.
pub(crate) fn sphere(count: u32) -> Shape {
    let mut shape = Shape::default();
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    // That of a hexagonal packing: a particle takes 2√3 r² of the area.
    let radius = SPHERE * (4.0 * PI / (f64::from(count) * 2.0 * 3.0_f64.sqrt())).sqrt();
    let seed = DVec3::new(0.74, 0.53, 0.41).normalize_or_zero();
    for k in 0..count {
        let z = 1.0 - 2.0 * (f64::from(k) + 0.5) / f64::from(count);
        let (sin, cos) = libm::sincos(golden * f64::from(k));
        let flat = (1.0 - z * z).sqrt();
        let n = DVec3::new(flat * cos, flat * sin, z);
        shape.push(SPHERE * n, n, radius, (SPHERE * n.angle_between(seed) / (2.0 * radius)) as u32);
    }
    shape.in_levels()
}

/// Radii of the torus: of the circle in its middle, and of the tube.
const TORUS: [f64; 2] = [1.0, 0.45];

/// A torus around z with this number of particles around it, larger ones outside, and faces.
pub(crate) fn torus(columns: u32) -> Shape {
    let [large, small] = TORUS;
    let spacing = TAU * large / f64::from(columns);
    let rows = 2 * (TAU * small / (spacing * 3.0_f64.sqrt())).round() as u32;
    let mut shape = Shape::default();
    for j in 0..rows {
        let (sv, cv) = libm::sincos(TAU * f64::from(j) / f64::from(rows));
        for i in 0..columns {
            let u = TAU * (f64::from(i) + 0.5 * f64::from(j % 2)) / f64::from(columns);
            let (su, cu) = libm::sincos(u);
            let normal = DVec3::new(cv * cu, cv * su, sv);
            let middle = large * DVec3::new(cu, su, 0.0);
            let (du, dv) =
                (u.min(TAU - u) * large, f64::from(j.min(rows - j)) * TAU * small / f64::from(rows));
            let radius = 0.5 * spacing * (large + small * cv) / large;
            shape.push(middle + small * normal, normal, radius, (libm::hypot(du, dv) / spacing) as u32);
            let at = |i: u32, j: u32| (j % rows) * columns + i % columns;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1));
            shape.faces.extend(if j % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, d, c], [a, b, d]] });
        }
    }
    shape.in_levels()
}

/// A torus that is coloured by its Gaussian curvature, which is negative inside.
pub(crate) fn torus_by_curvature(columns: u32) -> Shape {
    let mut shape = torus(columns);
    let [large, small] = TORUS;
    for (position, colour) in shape.positions.iter().zip(&mut shape.colours) {
        let [x, y, _] = position.map(f64::from);
        let out = libm::hypot(x, y);
        let curvature = (out - large) / (small * small * out);
        *colour = ramp(&SIGNED, 0.5 + 0.25 * curvature);
    }
    shape
}

/// The cube from −1 to 1 with so many particles along an edge, those on its edges as dots, and the
/// pieces of its edges as the renderer takes them.
pub(crate) fn cube(along: u32) -> (Shape, Vec<f32>) {
    let last = along - 1;
    let place = |k: u32| 2.0 * f64::from(k) / f64::from(last) - 1.0;
    let radius = 1.0 / f64::from(last);
    let mut shape = Shape::default();
    let mut ends = Vec::new();
    for x in 0..along {
        for y in 0..along {
            for z in 0..along {
                let p = DVec3::new(place(x), place(y), place(z));
                let sides = [x, y, z].map(|k| k == 0 || k == last);
                let rim = [x, y, z].map(|k| k.min(last - k));
                let level = rim.iter().sum::<u32>() - rim.iter().min().copied().unwrap_or(0);
                let normal = DVec3::from(std::array::from_fn(|k| if sides[k] { p[k] } else { 0.0 }));
                match sides.iter().filter(|&&is| is).count() {
                    0 => {}
                    1 => shape.push(p, normal, radius, level),
                    _ => shape.push(p, normal, -radius, level),
                }
                // The edge that goes on from here along an axis.
                for axis in 0..3 {
                    let is_edge = (0..3).all(|k| k == axis || sides[k]) && [x, y, z][axis] < last;
                    if is_edge {
                        let mut next = p;
                        next[axis] += 2.0 * radius;
                        for end in [p, next] {
                            ends.extend(end.as_vec3().to_array());
                            ends.push(radius as f32);
                        }
                    }
                }
            }
        }
    }
    (shape.in_levels(), ends)
}
